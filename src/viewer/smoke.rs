//! A scripted run of the window for tests: so many frames, with changes of size on the way and, if asked for, all that
//! systems do to windows.

use super::frame_times::FrameTimes;
use super::snapshot::Snapshot;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};
use winit::dpi::PhysicalSize;
use winit::window::Window;

/// What is done to the window after equal shares of the frames.
const GENTLE: [Deed; 2] = [Deed::Resize(900, 600), Deed::Resize(1100, 700)];
const ROUGH: [Deed; 6] = [
    Deed::Resize(900, 600),
    Deed::Resize(1, 1),
    Deed::Hide,
    Deed::Resize(1100, 700),
    Deed::LoseDevice,
    Deed::LoseDevice,
];
/// How long a new size is waited for: some window managers do as they like.
const LONGEST_RESIZE: Duration = Duration::from_secs(5);
/// Layouts after which a hidden window is shown again.
const HIDDEN_LAYOUTS: u32 = 5;

/// Something done to the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deed {
    /// Width and height, pixels.
    Resize(u32, u32),
    /// Minimised and taken off the screen, for a while.
    Hide,
    /// The graphics device goes away.
    LoseDevice,
}

/// Counts what was shown.
pub struct SmokeRun {
    frames: u64,
    deeds: &'static [Deed],
    shown: u64,
    sizes: BTreeSet<(u32, u32)>,
    simulated_s: f64,
    started: Instant,
    times: FrameTimes,
    hidden_for: Option<u32>,
    /// The size that was asked for, until it comes, and when that was. Frames do not count meanwhile.
    awaited: Option<((u32, u32), Instant)>,
    recoveries: u32,
}

impl SmokeRun {
    /// A run of so many frames, at least as many as there is to do, roughly or not.
    #[must_use]
    pub fn new(frames: u64, is_rough: bool) -> Self {
        let deeds: &[Deed] = if is_rough { &ROUGH } else { &GENTLE };
        Self {
            frames: frames.max(deeds.len() as u64 + 1),
            deeds,
            shown: 0,
            sizes: BTreeSet::new(),
            simulated_s: 0.0,
            started: Instant::now(),
            times: FrameTimes::default(),
            hidden_for: None,
            awaited: None,
            recoveries: 0,
        }
    }

    /// A frame was laid out, whether it came onto the screen or not.
    pub fn laid_out(&mut self, window: &Window) {
        let Some(layouts) = &mut self.hidden_for else { return };
        *layouts += 1;
        if *layouts >= HIDDEN_LAYOUTS {
            self.hidden_for = None;
            window.set_visible(true);
            window.set_minimized(false);
        }
    }

    /// A frame came onto the screen; returns whether the device is to be taken away now.
    pub fn frame_shown(&mut self, window: &Window, snapshot: &Snapshot) -> bool {
        let size = window.inner_size();
        self.sizes.insert((size.width, size.height));
        self.simulated_s = self.simulated_s.max(snapshot.frame.time_s);
        let is_there = |(wanted, asked): ((u32, u32), Instant)| {
            wanted == (size.width, size.height) || asked.elapsed() > LONGEST_RESIZE
        };
        if !self.awaited.is_none_or(is_there) {
            return false;
        }
        self.awaited = None;
        self.shown += 1;
        let share = self.frames / (self.deeds.len() as u64 + 1);
        if !self.shown.is_multiple_of(share) {
            return false;
        }
        let deed = usize::try_from(self.shown / share - 1).ok().and_then(|index| self.deeds.get(index));
        match deed {
            // The new size comes with a later event.
            Some(Deed::Resize(width, height)) => {
                let _ = window.request_inner_size(PhysicalSize::new(*width, *height));
                self.awaited = Some(((*width, *height), Instant::now()));
            }
            Some(Deed::Hide) => {
                self.hidden_for = Some(0);
                window.set_minimized(true);
                window.set_visible(false);
            }
            Some(Deed::LoseDevice) => return true,
            None => {}
        }
        false
    }

    /// How long the last frame took, from its events to the finished picture.
    pub fn took(&mut self, time: Duration) {
        self.times.note(time);
    }

    /// The device was opened anew.
    pub fn recovered(&mut self) {
        self.recoveries += 1;
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
            "{} frames in {wall_s:.2} s ({:.1} a second), {} sizes, {} recoveries, simulated {:.6} s; {}",
            self.shown,
            self.shown as f64 / wall_s.max(1e-9),
            self.sizes.len(),
            self.recoveries,
            self.simulated_s,
            self.times
        );
    }
}
