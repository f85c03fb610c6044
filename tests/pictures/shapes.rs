//! Small bodies made by hand.

use glam::{Quat, Vec3};
use hammerfall::frame::{
    BodyFrame, BodyRole, Frame, Interior, InteriorTopology, SurfaceTopology, VertexFields,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A box of `cells` squares along each axis.
pub fn block(low: Vec3, high: Vec3, cells: [u32; 3]) -> BodyFrame {
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
pub fn ball(center: Vec3, radius: f32, cells: u32) -> BodyFrame {
    let mut body = block(Vec3::splat(-1.0), Vec3::ONE, [cells; 3]);
    for p in &mut body.positions_m {
        // Tangents even out the cells.
        let cube = Vec3::from(*p) * std::f32::consts::FRAC_PI_4;
        let direction = Vec3::new(cube.x.tan(), cube.y.tan(), cube.z.tan()).normalize();
        *p = (center + radius * direction).to_array();
    }
    body
}

/// A box with tetrahedra inside, six in each cell. Its speed is the distance from its middle over half its size, and
/// its stress pulls along x and pushes half as hard along z.
pub fn solid_block(low: Vec3, high: Vec3, cells: [u32; 3]) -> BodyFrame {
    let mut body = block(low, high, cells);
    let counts = cells.map(|n| n + 1);
    let node = |at: [u32; 3]| (at[0] * counts[1] + at[1]) * counts[2] + at[2];
    let mut positions_m = Vec::new();
    let mut tets = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                let share = Vec3::new(i as f32, j as f32, k as f32) / Vec3::from(cells.map(|n| n as f32));
                positions_m.push((low + (high - low) * share).to_array());
                if i == cells[0] || j == cells[1] || k == cells[2] {
                    continue;
                }
                for [a, b] in [[0, 1], [1, 0], [1, 2], [2, 1], [2, 0], [0, 2]] {
                    let mut at = [i, j, k];
                    let mut tet = [node(at), 0, 0, node([i + 1, j + 1, k + 1])];
                    at[a] += 1;
                    tet[1] = node(at);
                    at[b] += 1;
                    tet[2] = node(at);
                    tets.push(tet);
                }
            }
        }
    }
    let speed = |p: &[f32; 3]| (Vec3::from(*p) - 0.5 * (low + high)).length() / (0.5 * (high - low).x);
    let fields = |positions_m: &[[f32; 3]]| VertexFields {
        speed_m_s: positions_m.iter().map(speed).collect(),
        ..VertexFields::default()
    };
    body.fields = fields(&body.positions_m);
    let surface = Arc::make_mut(&mut body.surface);
    surface.triangle_element = (0..surface.triangles.len() as u32).map(|t| t % tets.len() as u32).collect();
    body.interior = Some(Arc::new(Interior {
        fields: fields(&positions_m),
        stress_pa: vec![[2e6, 0.0, -1e6, 0.0, 0.0, 0.0]; tets.len()],
        topology: Arc::new(InteriorTopology { tets, ..InteriorTopology::default() }),
        positions_m,
    }));
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

pub fn colored(mut body: BodyFrame, srgb: [f32; 3]) -> BodyFrame {
    body.palette_srgb = Arc::new([srgb]);
    body
}

pub fn turned(mut body: BodyFrame, about: Vec3, turn: Quat) -> BodyFrame {
    for p in &mut body.positions_m {
        *p = (about + turn * (Vec3::from(*p) - about)).to_array();
    }
    body
}

pub fn fixed(mut body: BodyFrame) -> BodyFrame {
    body.role = BodyRole::Fixed;
    body
}

/// Two bodies in one, with a colour each.
pub fn joined(a: BodyFrame, b: BodyFrame) -> BodyFrame {
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

pub fn frame(bodies: Vec<BodyFrame>) -> Frame {
    Frame { time_s: 0.00125, bodies, ..Default::default() }
}

/// A floor that the framing recognizes.
pub fn ground() -> BodyFrame {
    fixed(block(Vec3::new(-5.0, -5.0, -0.2), Vec3::new(5.0, 5.0, 0.0), [1, 1, 1]))
}

/// A hammer, its head down, a little above the floor.
pub fn hammer(fine: u32) -> BodyFrame {
    let handle = block(Vec3::new(-0.018, -0.014, 0.0), Vec3::new(0.018, 0.014, 0.30), [fine, fine, 8 * fine]);
    let head = block(
        Vec3::new(-0.075, -0.025, 0.285),
        Vec3::new(0.075, 0.025, 0.345),
        [5 * fine, 2 * fine, 2 * fine],
    );
    let whole = joined(colored(handle, [0.76, 0.53, 0.31]), colored(head, [0.50, 0.54, 0.60]));
    turned(whole, Vec3::new(0.0, 0.0, 0.2), Quat::from_rotation_x(2.2) * Quat::from_rotation_z(0.5))
}
