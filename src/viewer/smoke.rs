//! A scripted run of the window for tests: so many frames, with two changes of size on the way.

use super::snapshot::Snapshot;
use std::collections::BTreeSet;
use std::time::Instant;
use winit::dpi::PhysicalSize;
use winit::window::Window;

/// Sizes that the window takes on after each third of the frames, pixels.
const SIZES: [PhysicalSize<u32>; 2] = [PhysicalSize::new(900, 600), PhysicalSize::new(1100, 700)];

/// Counts what was shown.
pub struct SmokeRun {
    frames: u64,
    shown: u64,
    sizes: BTreeSet<(u32, u32)>,
    simulated_s: f64,
    started: Instant,
}

impl SmokeRun {
    /// A run of so many frames, at least three.
    #[must_use]
    pub fn new(frames: u64) -> Self {
        Self {
            frames: frames.max(3),
            shown: 0,
            sizes: BTreeSet::new(),
            simulated_s: 0.0,
            started: Instant::now(),
        }
    }

    /// A frame came onto the screen.
    pub fn frame_shown(&mut self, window: &Window, snapshot: &Snapshot) {
        let size = window.inner_size();
        self.sizes.insert((size.width, size.height));
        self.simulated_s = self.simulated_s.max(snapshot.frame.time_s);
        self.shown += 1;
        let third = self.frames / 3;
        if self.shown.is_multiple_of(third)
            && let Some(size) =
                usize::try_from(self.shown / third - 1).ok().and_then(|index| SIZES.get(index))
        {
            // The new size comes with a later event.
            let _ = window.request_inner_size(*size);
        }
    }

    /// Whether all frames were shown.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.shown >= self.frames
    }

    /// Says on stdout what was shown.
    pub fn report(&self) {
        let wall_s = self.started.elapsed().as_secs_f64();
        println!(
            "{} frames in {wall_s:.2} s ({:.1} a second), {} sizes, simulated {:.6} s",
            self.shown,
            self.shown as f64 / wall_s.max(1e-9),
            self.sizes.len(),
            self.simulated_s
        );
    }
}
