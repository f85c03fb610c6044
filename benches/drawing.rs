//! From a world to a picture: publishing the frame, and drawing it off-screen.
//!
//! `publish` goes with the elements, whose stresses it averages; `draw` with the pixels, on a software driver at least, and
//! with the triangles where there are many.

use crate::contact_step::{CELLS, elements_of, pressed_world};
use crate::machine::sample_shortly;
use criterion::{BenchmarkId, Criterion, Throughput};
use hammerfall::frame::{ColorBy, Frame};
use hammerfall::render::{Framing, Gpu, Ground, NamedView, OffScreen, Range, View};
use std::time::Duration;

/// How many of the sizes of `contact_step`: all but the largest.
const SIZES: usize = 3;
const SIZES_PX: [[u32; 2]; 3] = [[320, 180], [960, 540], [1920, 1080]];

/// A frame of a world that deforms.
pub fn publish(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("publish");
    sample_shortly(&mut group);
    for cells in CELLS.into_iter().take(SIZES) {
        let elements = elements_of(cells);
        group.throughput(Throughput::Elements(u64::from(elements)));
        group.bench_function(BenchmarkId::new("frame", elements), |bencher| {
            // Built only where somebody wants to measure it.
            let world = pressed_world(cells);
            bencher.iter(|| world.publish());
        });
    }
    group.finish();
}

/// One picture, from the frame to pixels in memory; left out where there is nothing to draw with.
pub fn draw(criterion: &mut Criterion) {
    let mut screen = match Gpu::headless().and_then(|gpu| OffScreen::new(&gpu)) {
        Ok(screen) => screen,
        Err(error) => return println!("draw is left out: {error}"),
    };
    let mut group = criterion.benchmark_group("draw");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    group.warm_up_time(Duration::from_millis(500));
    for cells in CELLS.into_iter().take(SIZES) {
        let mut built: Option<Frame> = None;
        // Two on each square of the six sides of both boxes.
        let triangles = 12 * (cells.pow(2) + (cells + 1).pow(2));
        for size_px in SIZES_PX {
            let pixels = u64::from(size_px[0]) * u64::from(size_px[1]);
            group.throughput(Throughput::Elements(pixels));
            let id = BenchmarkId::new(format!("per-pixel/{triangles}-triangles"), pixels);
            group.bench_function(id, |bencher| {
                let frame = built.get_or_insert_with(|| pressed_world(cells).publish());
                bencher.iter(|| picture(&mut screen, frame, size_px));
            });
        }
    }
    group.finish();
}

fn picture(screen: &mut OffScreen, frame: &Frame, size_px: [u32; 2]) -> hammerfall::render::Picture {
    let mut framing = Framing::default();
    framing.include(frame);
    let camera = framing.camera(NamedView::ThreeQuarter, size_px[0] as f32 / size_px[1] as f32);
    let color_by = ColorBy::VonMises;
    let view = View {
        color_by,
        range: Some(Range::of_frames(std::slice::from_ref(frame), color_by)),
        ground: framing.floor().map_or(Ground::Hidden, Ground::At),
        ..View::for_size(size_px)
    };
    screen.render(size_px, frame, &camera, &view).expect("the device draws")
}
