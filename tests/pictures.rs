//! Pictures of small hand-made frames, compared with stored ones.
//!
//! Every picture also has an assertion that needs no reference. References are drawn on a
//! software rasterizer; after a wanted change, write them anew and look at each one:
//!
//! ```sh
//! HAMMERFALL_WRITE_PICTURES=1 cargo test --test pictures
//! ```
//!
//! Without any graphics driver the tests say so and pass, except where the variable `CI` is
//! set: there a missing driver is a failure.

use glam::{Quat, Vec3};
use hammerfall::frame::{BodyFrame, BodyRole, Frame, SurfaceTopology, VertexFields};
use std::collections::BTreeMap;
use std::sync::Arc;

// ---------------------------------------------------------------- shapes

/// A box of `cells` squares along each axis.
fn block(low: Vec3, high: Vec3, cells: [u32; 3]) -> BodyFrame {
    let mut body = Builder::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in 0..2 {
            body.side(cells, axis, u, v, side == 1);
        }
    }
    let size = high - low;
    let counts = Vec3::from(cells.map(|n| n as f32));
    body.finish(|grid| low + size * grid / counts)
}

/// A ball: a cube's surface blown up.
fn ball(center: Vec3, radius: f32, cells: u32) -> BodyFrame {
    let mut body = block(Vec3::splat(-1.0), Vec3::ONE, [cells; 3]);
    for p in &mut body.positions_m {
        // Tangents even out the cells.
        let cube = Vec3::from(*p) * std::f32::consts::FRAC_PI_4;
        let direction = Vec3::new(cube.x.tan(), cube.y.tan(), cube.z.tan()).normalize();
        *p = (center + radius * direction).to_array();
    }
    body
}

/// Grid points of box surfaces, each once.
#[derive(Default)]
struct Builder {
    index: BTreeMap<[u32; 3], u32>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn side(&mut self, cells: [u32; 3], axis: usize, u: usize, v: usize, far: bool) {
        for i in 0..cells[u] {
            for j in 0..cells[v] {
                let mut corner = |du, dv| {
                    let mut at = [0; 3];
                    at[axis] = if far { cells[axis] } else { 0 };
                    at[u] = i + du;
                    at[v] = j + dv;
                    let next = self.index.len() as u32;
                    *self.index.entry(at).or_insert(next)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let pair = if far { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                self.triangles.extend(pair);
            }
        }
    }

    fn finish(self, place: impl Fn(Vec3) -> Vec3) -> BodyFrame {
        let mut positions_m = vec![[0.0; 3]; self.index.len()];
        for (grid, index) in self.index {
            let grid = Vec3::from(grid.map(|n| n as f32));
            positions_m[index as usize] = place(grid).to_array();
        }
        BodyFrame {
            palette_srgb: Arc::new([[0.72, 0.74, 0.78]]),
            surface: Arc::new(SurfaceTopology { triangles: self.triangles, ..Default::default() }),
            positions_m,
            ..Default::default()
        }
    }
}

fn colored(mut body: BodyFrame, srgb: [f32; 3]) -> BodyFrame {
    body.palette_srgb = Arc::new([srgb]);
    body
}

fn turned(mut body: BodyFrame, about: Vec3, turn: Quat) -> BodyFrame {
    for p in &mut body.positions_m {
        *p = (about + turn * (Vec3::from(*p) - about)).to_array();
    }
    body
}

fn fixed(mut body: BodyFrame) -> BodyFrame {
    body.role = BodyRole::Fixed;
    body
}

/// Two bodies in one, with a colour each.
fn joined(a: BodyFrame, b: BodyFrame) -> BodyFrame {
    let shift = a.positions_m.len() as u32;
    let (na, nb) = (a.surface.triangles.len(), b.surface.triangles.len());
    let moved = b.surface.triangles.iter().map(|t| t.map(|v| v + shift));
    BodyFrame {
        palette_srgb: Arc::new([a.palette_srgb[0], b.palette_srgb[0]]),
        surface: Arc::new(SurfaceTopology {
            triangles: a.surface.triangles.iter().copied().chain(moved).collect(),
            triangle_material: [vec![0; na], vec![1; nb]].concat(),
            ..Default::default()
        }),
        positions_m: [a.positions_m, b.positions_m].concat(),
        ..Default::default()
    }
}

fn frame(bodies: Vec<BodyFrame>) -> Frame {
    Frame { time_s: 0.00125, bodies, ..Default::default() }
}

/// A floor that the framing recognizes.
fn ground() -> BodyFrame {
    fixed(block(Vec3::new(-5.0, -5.0, -0.2), Vec3::new(5.0, 5.0, 0.0), [1, 1, 1]))
}

/// A hammer, its head down, a little above the floor.
fn hammer(fine: u32) -> BodyFrame {
    let handle = block(Vec3::new(-0.018, -0.014, 0.0), Vec3::new(0.018, 0.014, 0.30), [fine, fine, 8 * fine]);
    let head = block(
        Vec3::new(-0.075, -0.025, 0.285),
        Vec3::new(0.075, 0.025, 0.345),
        [5 * fine, 2 * fine, 2 * fine],
    );
    let whole = joined(colored(handle, [0.76, 0.53, 0.31]), colored(head, [0.50, 0.54, 0.60]));
    turned(whole, Vec3::new(0.0, 0.0, 0.2), Quat::from_rotation_x(2.2) * Quat::from_rotation_z(0.5))
}

mod gallery {
    use super::*;
    use hammerfall::export::png::write_png;
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

    fn cpu_ms() -> f64 {
        let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
        let fields: Vec<&str> = stat.split_whitespace().collect();
        (fields[13].parse::<f64>().unwrap() + fields[14].parse::<f64>().unwrap()) * 10.0
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
        ];
        for (name, named, view) in pictures {
            let camera = framing.camera(named, 960.0 / 540.0);
            let picture = screen.render(size, &scene, &camera, &view).unwrap();
            write_png(&folder.join(format!("{name}.png")), &picture).unwrap();
        }
        let camera = framing.camera(NamedView::ThreeQuarter, 960.0 / 540.0);
        let small = still_life(2);
        let variants = [
            ("as is", scene.clone(), view.clone()),
            ("fewer triangles", small.clone(), view.clone()),
            ("wireframe", small.clone(), View { wireframe: true, ..view.clone() }),
            ("stress", small.clone(), View { color_by: ColorBy::VonMises, ..view.clone() }),
            ("no floor", frame(small.bodies[1..].to_vec()), View { ground: Ground::Hidden, ..view.clone() }),
            ("nothing", frame(vec![ground()]), View { ground: Ground::Hidden, ..view.clone() }),
        ];
        for (name, scene, view) in variants {
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
}
