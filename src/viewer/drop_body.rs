//! Bodies that are dropped into a running scene, in its own size and material.

use crate::mesh::TetMesh;
use crate::mesh::shapes::{Ball, BoxShape, Hammer, Meshing, Resolution, Shape, ShapeError};
use crate::sim::{BodyMotion, BodySetup, Kinematics, Material, World, WorldSetup};
use glam::{DQuat, DVec3, EulerRot};

/// Size of a dropped hammer's length, as a share of the scene's typical body.
const SIZE_SHARE: f64 = 0.9;
/// Size of a typical body where the scene has none that moves, m.
const DEFAULT_SIZE_M: f64 = 0.3;
/// Free height above what is there, in sizes.
const HEIGHT_SHARE: f64 = 0.6;
/// One after the other, so that a heap stays readable; sRGB.
const COLORS_SRGB: [[f32; 3]; 5] =
    [[0.85, 0.40, 0.31], [0.27, 0.56, 0.73], [0.91, 0.69, 0.29], [0.42, 0.65, 0.42], [0.58, 0.47, 0.70]];
const HANDLE_SRGB: [f32; 3] = [0.79, 0.54, 0.29];
const HEAD_SRGB: [f32; 3] = [0.29, 0.33, 0.41];

/// What can be dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DropKind {
    /// A hammer with head and handle.
    Hammer,
    /// A cube.
    Cube,
    /// A ball.
    Ball,
}

impl DropKind {
    /// All of them, in the order of the buttons.
    pub const ALL: [Self; 3] = [Self::Hammer, Self::Cube, Self::Ball];

    /// The word on the button.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Hammer => "Hammer",
            Self::Cube => "Cube",
            Self::Ball => "Ball",
        }
    }

    fn shape(self, size_m: f64) -> (Shape, Resolution) {
        match self {
            Self::Hammer => {
                let default = Hammer::default();
                let scale = size_m / (default.head_width_m + default.handle_length_m);
                let hammer = Hammer {
                    head_length_m: default.head_length_m * scale,
                    head_width_m: default.head_width_m * scale,
                    handle_length_m: default.handle_length_m * scale,
                    handle_width_m: default.handle_width_m * scale,
                };
                (Shape::Hammer(hammer), Resolution::Refinement(1))
            }
            Self::Cube => {
                let cube = BoxShape { size_m: DVec3::splat(0.38 * size_m) };
                (Shape::Box(cube), Resolution::Cells([3; 3]))
            }
            Self::Ball => (Shape::Ball(Ball { radius_m: 0.2 * size_m }), Resolution::Refinement(2)),
        }
    }
}

/// The `number`-th dropped body (from 1), above the middle of what moves in `world`.
///
/// # Errors
/// [`ShapeError`] when the scene is so small or large that the shape cannot be made.
pub fn body_to_drop(kind: DropKind, number: usize, world: &World) -> Result<BodySetup, ShapeError> {
    let setup = world.setup();
    let (shape, resolution) = kind.shape(SIZE_SHARE * typical_size_m(setup));
    let mut mesh = shape.build(&Meshing { resolution, ..Meshing::default() })?;
    // Each falls a little differently.
    let turn = number as f64 * 2.4;
    let rotation = DQuat::from_euler(EulerRot::ZXY, turn, 0.3, 0.5);
    mesh.nodes_m.iter_mut().for_each(|x| *x = rotation * *x);
    place_above(&mut mesh, world, turn);
    let materials = materials(kind, number, setup, &mesh);
    Ok(BodySetup {
        name: format!("dropped-{}-{number}", kind.label().to_lowercase()),
        element_material: mesh.regions.iter().map(|r| (*r).min(materials.len() as u32 - 1)).collect(),
        materials,
        mesh,
        motion: BodyMotion::Deformable(Kinematics::default()),
        velocity_m_s: DVec3::ZERO,
        spin_rad_s: DVec3::new(0.6 * turn.sin(), 0.6 * turn.cos(), 0.4),
        boundary: Vec::new(),
        mass_scaling_max_share: 0.0,
    })
}

/// The median of the longest sides of the bodies that deform, m.
fn typical_size_m(setup: &WorldSetup) -> f64 {
    let sizes = deformable(setup).filter_map(|body| body.mesh.bounds_m());
    let mut sizes: Vec<f64> = sizes.map(|(low, high)| (high - low).max_element()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or(DEFAULT_SIZE_M)
}

fn deformable(setup: &WorldSetup) -> impl Iterator<Item = &BodySetup> {
    setup.bodies.iter().filter(|body| matches!(body.motion, BodyMotion::Deformable(_)))
}

/// Moves the mesh above the middle of everything that deforms, a little off it.
fn place_above(mesh: &mut TetMesh, world: &World, turn: f64) {
    let nodes = (0..world.body_count())
        .filter(|b| matches!(world.setup().bodies[*b].motion, BodyMotion::Deformable(_)))
        .flat_map(|b| world.positions_m(b));
    let bounds = nodes.fold(None, |bounds: Option<(DVec3, DVec3)>, x| {
        let (low, high) = bounds.unwrap_or((*x, *x));
        Some((low.min(*x), high.max(*x)))
    });
    let (low, high) = bounds.unwrap_or_default();
    let Some((own_low, own_high)) = mesh.bounds_m() else { return };
    let size_m = (own_high - own_low).max_element();
    let off = DVec3::new(turn.cos(), turn.sin(), 0.0) * (0.12 * size_m);
    let above = low.midpoint(high).with_z(high.z + HEIGHT_SHARE * size_m - own_low.z);
    mesh.nodes_m.iter_mut().for_each(|x| *x += above + off);
}

/// The scene's own material in new colours: the elastic step stays what it was.
fn materials(kind: DropKind, number: usize, setup: &WorldSetup, mesh: &TetMesh) -> Vec<Material> {
    let base = deformable(setup).find_map(|body| body.materials.first().cloned()).unwrap_or_else(rubber);
    let painted =
        |name: &str, color_srgb| Material { name: format!("dropped-{name}"), color_srgb, ..base.clone() };
    if kind != DropKind::Hammer {
        return vec![painted("body", COLORS_SRGB[number % COLORS_SRGB.len()])];
    }
    let color = |region: &String| if region == "handle" { HANDLE_SRGB } else { HEAD_SRGB };
    mesh.region_names.iter().map(|region| painted(region, color(region))).collect()
}

fn rubber() -> Material {
    Material {
        name: "rubber".to_owned(),
        density_kg_m3: 1100.0,
        youngs_modulus_pa: 5e6,
        poisson_ratio: 0.4,
        damping_per_s: 10.0,
        stiffness_damping_s: 0.0,
        color_srgb: COLORS_SRGB[0],
        fracture: None,
    }
}
