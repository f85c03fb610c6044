//! Large pictures to look at, and what they cost.

use crate::shapes::{ball, block, colored, frame, ground, hammer, joined, turned};
use glam::{Quat, Vec3};
use hammerfall::export::gif::GifWriter;
use hammerfall::export::png::write_png;
use hammerfall::frame::{BodyFrame, Frame, VertexFields};
use hammerfall::render::*;
use std::path::PathBuf;
use std::time::Instant;

fn stress(mut body: BodyFrame) -> BodyFrame {
    let wave = |p: &[f32; 3]| (p[0] * 25.0).sin() * (p[2] * 18.0 + p[1] * 9.0).cos();
    let values: Vec<f32> = body.positions_m.iter().map(wave).collect();
    body.fields = VertexFields {
        von_mises_pa: values.iter().map(|v| v.abs() * 2.4e8).collect(),
        max_principal_pa: values.iter().map(|v| v * 2.4e8).collect(),
        speed_m_s: values.iter().map(|v| v.abs() * 12.0).collect(),
        ..Default::default()
    };
    body
}

/// Processor time that this process has used, milliseconds; 0 where Linux does not tell it. Other
/// programs disturb it less than they disturb the clock.
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> = stat.split_whitespace().map(|field| field.parse().unwrap_or_default()).collect();
    fields.get(13..15).map_or(0.0, |ticks| 10.0 * (ticks[0] + ticks[1]))
}

fn still_life(fine: u32) -> Frame {
    let blocks = [
        block(Vec3::new(0.16, -0.10, 0.0), Vec3::new(0.30, 0.04, 0.14), [2 * fine; 3]),
        block(Vec3::new(-0.34, 0.02, 0.0), Vec3::new(-0.20, 0.16, 0.14), [2 * fine; 3]),
    ];
    let [red, blue] = blocks;
    let tilted = turned(
        block(Vec3::new(0.15, -0.09, 0.145), Vec3::new(0.27, 0.03, 0.265), [2 * fine; 3]),
        Vec3::new(0.21, -0.03, 0.2),
        Quat::from_rotation_z(0.6),
    );
    let tilted = colored(tilted, [0.93, 0.75, 0.30]);
    let ball = ball(Vec3::new(-0.18, -0.16, 0.075), 0.075, 6 * fine);
    let mut hammer = hammer(fine);
    for p in &mut hammer.positions_m {
        p[2] += 0.14;
    }
    frame(vec![
        ground(),
        stress(hammer),
        stress(colored(red, [0.80, 0.30, 0.26])),
        stress(colored(blue, [0.28, 0.45, 0.70])),
        stress(tilted),
        stress(colored(ball, [0.35, 0.62, 0.50])),
    ])
}

/// Draws large pictures to look at: `HAMMERFALL_GALLERY=folder cargo test --test pictures
/// gallery -- --ignored --nocapture`.
#[test]
#[ignore = "for eyes only"]
fn gallery() {
    let folder = PathBuf::from(std::env::var("HAMMERFALL_GALLERY").expect("a folder"));
    let gpu = Gpu::headless().unwrap();
    let mut screen = OffScreen::new(&gpu).unwrap();
    let size = [960, 540];
    let scene = still_life(4);
    let triangles: usize = scene.bodies.iter().map(|b| b.surface.triangles.len()).sum();
    println!("{triangles} triangles on {}", gpu.info.name);
    let framing = Framing::of(&scene);
    let view = View {
        ground: Ground::At(framing.floor().unwrap()),
        caption: Some(Caption {
            show_time: true,
            slow_motion: Some(200.0),
            text: "Forward Lagrange contact".into(),
        }),
        ..View::for_size(size)
    };
    let pictures = [
        ("light", NamedView::ThreeQuarter, view.clone()),
        ("dark", NamedView::ThreeQuarter, View { background: Background::Dark, ..view.clone() }),
        ("stress", NamedView::ThreeQuarter, View { color_by: ColorBy::VonMises, ..view.clone() }),
        (
            "signed",
            NamedView::Right,
            View { color_by: ColorBy::MaxPrincipal, background: Background::Dark, ..view.clone() },
        ),
        ("wire", NamedView::ThreeQuarter, View { wireframe: true, ..view.clone() }),
        ("front", NamedView::Front, View { color_by: ColorBy::Body, ..view.clone() }),
        ("top", NamedView::Top, view.clone()),
        ("high", NamedView::High, view.clone()),
        ("low", NamedView::Low, view.clone()),
    ];
    for (name, named, view) in pictures {
        let camera = framing.camera(named, 960.0 / 540.0);
        let picture = screen.render(size, &scene, &camera, &view).unwrap();
        write_png(&folder.join(format!("{name}.png")), &picture).unwrap();
    }
    let camera = framing.camera(NamedView::ThreeQuarter, 960.0 / 540.0);
    let small = still_life(3);
    let variants = [
        ("as is", scene.clone(), view.clone()),
        ("fewer triangles", small.clone(), view.clone()),
        ("wireframe", small.clone(), View { wireframe: true, ..view.clone() }),
        ("stress", small.clone(), View { color_by: ColorBy::VonMises, ..view.clone() }),
        ("tiny", small.clone(), view.clone()),
        ("no floor", frame(small.bodies[1..].to_vec()), View { ground: Ground::Hidden, ..view.clone() }),
        ("nothing", frame(vec![ground()]), View { ground: Ground::Hidden, ..view.clone() }),
    ];
    for (name, scene, view) in variants {
        let size = if name == "tiny" { [96, 54] } else { size };
        let triangles: usize = scene.bodies.iter().map(|b| b.surface.triangles.len()).sum();
        screen.render(size, &scene, &camera, &view).unwrap();
        let before = cpu_ms();
        let time = |_| {
            let start = Instant::now();
            screen.render(size, &scene, &camera, &view).unwrap();
            start.elapsed().as_secs_f64() * 1e3
        };
        let mut times: Vec<f64> = (0..15).map(time).collect();
        times.sort_by(f64::total_cmp);
        let cpu = (cpu_ms() - before) / 15.0;
        println!(
            "{name}: {triangles} triangles, best {:.1} ms, median {:.1} ms, processor {cpu:.1} ms",
            times[0], times[7]
        );
    }
}

/// A hammer that turns while it falls.
fn falling(step: usize, count: usize) -> Frame {
    let share = step as f32 / count as f32;
    let mut body = stress(hammer(2));
    let turn = Quat::from_rotation_y(1.5 * share) * Quat::from_rotation_x(0.8 * share);
    body = turned(body, Vec3::new(0.0, 0.0, 0.2), turn);
    for p in &mut body.positions_m {
        p[2] += 0.5 * (1.0 - share * share);
    }
    let mut frame = frame(vec![ground(), body]);
    frame.time_s = 0.3 * f64::from(share);
    frame
}

/// As above, for an animation: look at `falling.gif`.
#[test]
#[ignore = "for eyes only"]
fn animation() {
    let folder = PathBuf::from(std::env::var("HAMMERFALL_GALLERY").expect("a folder"));
    let mut screen = OffScreen::new(&Gpu::headless().unwrap()).unwrap();
    let size = [960, 540];
    let frames: Vec<Frame> = (0..45).map(|step| falling(step, 45)).collect();
    let mut framing = Framing::default();
    frames.iter().for_each(|frame| framing.include(frame));
    let camera = framing.camera(NamedView::ThreeQuarter, 960.0 / 540.0);
    for (name, color_by) in [("material", ColorBy::Material), ("stress", ColorBy::VonMises)] {
        let view = View {
            color_by,
            ground: Ground::At(framing.floor().unwrap()),
            caption: Some(Caption { show_time: true, slow_motion: Some(5.0), text: String::new() }),
            range: color_by.has_values().then(|| Range::of_frames(&frames, color_by)),
            ..View::for_size(size)
        };
        let path = folder.join(format!("falling-{name}.gif"));
        let mut draw = |frame| screen.render(size, frame, &camera, &view).unwrap();
        let first = draw(&frames[0]);
        write_png(&folder.join(format!("falling-{name}.png")), &first).unwrap();
        let mut gif = GifWriter::create(&path, size, 30.0, &[&first]).unwrap();
        let mut spent = std::time::Duration::ZERO;
        for frame in &frames {
            let picture = draw(frame);
            let start = Instant::now();
            gif.push(&picture).unwrap();
            spent += start.elapsed();
        }
        gif.finish().unwrap();
        let bytes = std::fs::metadata(&path).unwrap().len();
        println!(
            "{name}: {} kB, {:.0} ms a picture for the file",
            bytes / 1000,
            spent.as_secs_f64() * 1e3 / frames.len() as f64
        );
    }
}

/// Four legs and a top.
fn table() -> BodyFrame {
    let leg = |x: f32, y: f32| {
        let foot = Vec3::new(x, y, 0.0);
        block(foot, foot + Vec3::new(0.05, 0.05, 0.6), [1, 1, 8])
    };
    let top = block(Vec3::new(-0.5, -0.3, 0.6), Vec3::new(0.5, 0.3, 0.65), [12, 8, 1]);
    let legs = [(-0.48, -0.28), (0.43, -0.28), (-0.48, 0.23), (0.43, 0.23)];
    legs.into_iter().fold(colored(top, [0.64, 0.44, 0.28]), |all, (x, y)| {
        let mut joint = joined(all.clone(), colored(leg(x, y), [0.64, 0.44, 0.28]));
        joint.palette_srgb = all.palette_srgb;
        joint
    })
}

/// Scenes like those that ship: `table.png`, `rods.png`, `coarse.png`.
#[test]
#[ignore = "for eyes only"]
fn likenesses() {
    let folder = PathBuf::from(std::env::var("HAMMERFALL_GALLERY").expect("a folder"));
    let mut screen = OffScreen::new(&Gpu::headless().unwrap()).unwrap();
    let size = [960, 540];
    let mut falling = hammer(1);
    for p in &mut falling.positions_m {
        p[2] += 0.62;
    }
    let rod = |from: f32| block(Vec3::new(from, -0.02, -0.02), Vec3::new(from + 0.6, 0.02, 0.02), [30, 2, 2]);
    let cup = colored(ball(Vec3::new(-0.5, 0.2, 0.2), 0.2, 3), [0.85, 0.85, 0.88]);
    let coarse = colored(ball(Vec3::new(0.2, 0.0, 0.25), 0.25, 2), [0.30, 0.50, 0.75]);
    let scenes = [
        ("table", vec![ground(), table(), falling]),
        ("rods", vec![stress(colored(rod(-0.62), [0.8, 0.3, 0.25])), stress(rod(0.0))]),
        ("coarse", vec![ground(), cup, coarse]),
    ];
    for (name, bodies) in scenes {
        let frame = frame(bodies);
        let camera = Framing::of(&frame).camera(NamedView::ThreeQuarter, 960.0 / 540.0);
        let view = View {
            color_by: if name == "rods" { ColorBy::MaxPrincipal } else { ColorBy::Material },
            wireframe: name == "rods",
            ..View::for_size(size)
        };
        let picture = screen.render(size, &frame, &camera, &view).unwrap();
        write_png(&folder.join(format!("{name}.png")), &picture).unwrap();
    }
}
