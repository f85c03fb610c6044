//! Bodies that are thrown or dropped into a running scene, in its own size and material.
//!
//! They are first written down as the scene file would have them and then built from that text: what is thrown here
//! and what a saved scene throws are the same to the last digit.

use crate::frame::Frame;
use crate::math::{to_digits, vector_to_digits_of};
use crate::mesh::shapes::Hammer;
use crate::scene::{Arrival, Newcomer, Scene};
use crate::sim::{BodyMotion, BodySetup, Entrance, Material, World, WorldSetup};
use glam::{DQuat, DVec3, EulerRot, Vec3};

/// Size of a thrown hammer's length, as a share of the scene's typical body.
const SIZE_SHARE: f64 = 0.9;
/// Size of a typical body where the scene has none that moves, m.
const DEFAULT_SIZE_M: f64 = 0.3;
/// What is dropped falls so far beside the middle, in sizes.
const OFF_SHARE: f64 = 0.12;
/// Free height above what is there, in sizes.
const HEIGHT_SHARE: f64 = 0.6;
/// One after the other, so that a heap stays readable; sRGB.
const COLORS_SRGB: [[f32; 3]; 5] =
    [[0.85, 0.40, 0.31], [0.27, 0.56, 0.73], [0.91, 0.69, 0.29], [0.42, 0.65, 0.42], [0.58, 0.47, 0.70]];
/// Beginning of the names of thrown bodies.
const THROWN: &str = "thrown-";
/// Name of the material that never breaks, made from the scene's own.
pub const TOOL: &str = "tool";
/// Density of it over that of the scene's own: a tool hits harder, and its elastic step is longer for it.
const TOOL_DENSITY: f64 = 3.0;

/// What can be thrown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ThrowKind {
    /// A hammer with head and handle.
    Hammer,
    /// A cube.
    Cube,
    /// A ball.
    Ball,
    /// The same as a body of the scene.
    CopyOf(String),
}

/// From where and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placing {
    /// Falls from above the middle of what moves.
    Above {
        /// Height of the upper edge of the picture there, m: from below it, it is seen to fall.
        top_m: Option<f64>,
    },
    /// Flies from a point.
    From {
        /// m.
        position_m: DVec3,
        /// m/s.
        velocity_m_s: DVec3,
        /// rad/s.
        spin_rad_s: DVec3,
    },
}

/// A throw.
#[derive(Clone, Debug, PartialEq)]
pub struct Throw {
    /// What.
    pub kind: ThrowKind,
    /// Of which material of the scene; [`TOOL`] makes the one that never breaks. A copy has its own.
    pub material: String,
    /// Size over that which suits the scene. A copy has its own.
    pub scale: f64,
    /// From where.
    pub placing: Placing,
}

impl ThrowKind {
    /// Those with a shape of their own, in the order of the buttons.
    pub const SHAPES: [Self; 3] = [Self::Hammer, Self::Cube, Self::Ball];

    /// The word on the button.
    #[must_use]
    pub fn label(&self) -> &str {
        match self {
            Self::Hammer => "Hammer",
            Self::Cube => "Cube",
            Self::Ball => "Ball",
            Self::CopyOf(name) => name,
        }
    }

    /// How far it reaches from its middle, as a share of a thrown hammer's length.
    fn reach_share(&self) -> f64 {
        match self {
            Self::Hammer => 0.75,
            Self::Cube => 0.34,
            Self::Ball => 0.2,
            Self::CopyOf(_) => 0.6,
        }
    }

    /// Whether it has the material and the size of a body of the scene.
    #[must_use]
    pub fn is_copy(&self) -> bool {
        matches!(self, Self::CopyOf(_))
    }

    /// Length of a hammer that goes with it, m, in a scene of bodies of such a size.
    fn size_m(&self, scale: f64, typical_m: f64) -> f64 {
        SIZE_SHARE * typical_m * if self.is_copy() { 1.0 } else { scale }
    }

    /// How far it reaches from the middle of what it is dropped on, m, at this scale.
    #[must_use]
    pub fn room_m(&self, scale: f64, frame: &Frame) -> f64 {
        self.size_m(scale, typical_size_in(frame)) * (self.reach_share() + OFF_SHARE)
    }

    /// The `shape` of a scene file.
    fn shape(&self, size_m: f64) -> Option<String> {
        match self {
            Self::Hammer => {
                let default = Hammer::default();
                let scale = size_m / (default.head_width_m + default.handle_length_m);
                let [a, b, c, d] = [
                    default.head_length_m,
                    default.head_width_m,
                    default.handle_length_m,
                    default.handle_width_m,
                ]
                .map(|side_m| round(side_m * scale));
                Some(format!(
                    "{{ type = \"hammer\", head_length = {a:?}, head_width = {b:?}, handle_length = {c:?}, handle_width = {d:?} }}"
                ))
            }
            Self::Cube => {
                let side_m = round(0.38 * size_m);
                Some(format!(
                    "{{ type = \"box\", size = [{side_m:?}, {side_m:?}, {side_m:?}], cells = [3, 3, 3] }}"
                ))
            }
            Self::Ball => {
                Some(format!("{{ type = \"ball\", radius = {:?}, refinement = 2 }}", round(0.2 * size_m)))
            }
            Self::CopyOf(_) => None,
        }
    }
}

/// Three digits: nobody measures a thrown ball, and the text stays readable.
fn round(value: f64) -> f64 {
    to_digits(value, 3)
}

/// The scene with the `number`-th thrown body (from 1) coming in now, that body as built, and what was added to the
/// scene's text.
///
/// # Errors
/// Why it cannot be made, in words.
pub fn scene_with_throw(
    throw: &Throw,
    number: usize,
    scene: &Scene,
    world: &World,
) -> Result<(Scene, Entrance, String), String> {
    let size_m = throw.kind.size_m(throw.scale, typical_size_m(world));
    let kind = throw.kind.label().to_lowercase();
    // Each falls a little differently.
    let turn = number as f64 * 2.4;
    let (position_m, velocity_m_s, spin_rad_s) = match throw.placing {
        Placing::Above { top_m } => {
            let spin_rad_s = DVec3::new(0.6 * turn.sin(), 0.6 * turn.cos(), 0.4);
            let reach_m = throw.kind.reach_share() * size_m;
            (place_above([size_m, reach_m], top_m, world, turn), DVec3::ZERO, spin_rad_s)
        }
        Placing::From { position_m, velocity_m_s, spin_rad_s } => (position_m, velocity_m_s, spin_rad_s),
    };
    let (axis, angle_rad) = DQuat::from_euler(EulerRot::ZXY, turn, 0.3, 0.5).to_axis_angle();
    // Before it acts: what is saved in few digits gives the same bytes.
    let arrival = Arrival {
        name: free_name(&format!("{THROWN}{kind}"), number, scene, world),
        position_m: vector_to_digits_of(position_m, size_m, 5),
        axis: vector_to_digits_of(axis, 1.0, 4),
        angle_degrees: to_digits(angle_rad.to_degrees(), 4),
        velocity_m_s: vector_to_digits_of(velocity_m_s, velocity_m_s.length(), 5),
        spin_rad_s: vector_to_digits_of(spin_rad_s, spin_rad_s.length(), 5),
        time_s: world.time_s(),
    };
    let shape = throw.kind.shape(size_m);
    let with_tool;
    let mut tool = String::new();
    let mut scene = scene;
    if shape.is_some()
        && throw.material == TOOL
        && !scene.description.materials.iter().any(|m| m.name == TOOL)
    {
        // A material that no body is of is refused as an override, but not as text.
        tool = tool_text(world.setup());
        with_tool = scene.with_text(&tool).map_err(|error| error.to_string())?;
        scene = &with_tool;
    }
    let newcomer = match (shape, &throw.kind) {
        (Some(shape), _) => Newcomer::Shape {
            shape,
            material: throw.material.clone(),
            color_srgb: COLORS_SRGB[number % COLORS_SRGB.len()],
        },
        (None, kind) => Newcomer::CopyOf(kind.label().to_owned()),
    };
    let (scene, entrance, text) =
        scene.with_arrival(&newcomer, &arrival).map_err(|error| error.to_string())?;
    Ok((scene, entrance, format!("{tool}{text}")))
}

fn free_name(stem: &str, number: usize, scene: &Scene, world: &World) -> String {
    let taken = |name: &String| {
        scene.entry_of(name).is_some() || world.setup().bodies.iter().any(|body| body.name == *name)
    };
    let names = (number..).map(|number| format!("{stem}-{number}"));
    names.into_iter().find(|name| !taken(name)).unwrap_or_else(|| stem.to_owned())
}

/// The scene's first material that deforms, heavier, and never breaking.
fn tool_text(setup: &WorldSetup) -> String {
    let base = deformable(setup).find_map(|body| body.materials.first().cloned()).unwrap_or_else(rubber);
    format!(
        "[materials.{TOOL}]\ndensity = {:?}\nyoungs_modulus = {:?}\npoisson_ratio = {:?}\ndamping = {:?}\nfracture = \"never\"\n",
        TOOL_DENSITY * base.density_kg_m3,
        base.youngs_modulus_pa,
        base.poisson_ratio,
        base.damping_per_s
    )
}

/// The median of the longest sides of the bodies that deform, m, but for what was thrown in: one hammer after the other has
/// the same size.
#[must_use]
pub fn typical_size_m(world: &World) -> f64 {
    let own = deformable(world.setup()).filter(|body| !body.name.starts_with(THROWN));
    let sizes = own.filter_map(|body| body.mesh.bounds_m());
    median(sizes.map(|(low, high)| (high - low).max_element()).collect())
}

/// The same of what is seen, m: for the aim, before anything is thrown.
#[must_use]
pub fn typical_size_in(frame: &Frame) -> f64 {
    let moving = frame.bodies.iter().filter(|body| body.role == crate::frame::BodyRole::Deformable);
    let size = |positions: &[[f32; 3]]| {
        let points = || positions.iter().map(|p| Vec3::from(*p));
        let (low, high) = points().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
        f64::from((high - low).max_element())
    };
    median(moving.filter(|b| !b.positions_m.is_empty()).map(|b| size(&b.positions_m)).collect())
}

fn median(mut sizes: Vec<f64>) -> f64 {
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or(DEFAULT_SIZE_M)
}

fn deformable(setup: &WorldSetup) -> impl Iterator<Item = &BodySetup> {
    setup.bodies.iter().filter(|body| matches!(body.motion, BodyMotion::Deformable(_)))
}

/// Above the middle of everything that deforms, a little off it, and where there is room for it below `top_m`.
fn place_above([size_m, reach_m]: [f64; 2], top_m: Option<f64>, world: &World, turn: f64) -> DVec3 {
    let nodes = (0..world.body_count())
        .filter(|b| matches!(world.setup().bodies[*b].motion, BodyMotion::Deformable(_)))
        .filter(|b| !world.is_removed(*b))
        .flat_map(|b| world.positions_m(b));
    let bounds = nodes.fold(None, |bounds: Option<(DVec3, DVec3)>, x| {
        let (low, high) = bounds.unwrap_or((*x, *x));
        Some((low.min(*x), high.max(*x)))
    });
    let (low, high) = bounds.unwrap_or_default();
    let off = DVec3::new(turn.cos(), turn.sin(), 0.0) * (OFF_SHARE * size_m);
    let highest_m = high.z + (HEIGHT_SHARE + 0.5) * size_m;
    // Whole in the picture, even if something beside it is higher: where there is no room it comes in higher.
    let in_sight_m = top_m.map_or(highest_m, |top_m| top_m - reach_m);
    low.midpoint(high).with_z(highest_m.min(in_sight_m)) + off
}

/// What is thrown where nothing deforms.
pub(super) fn rubber() -> Material {
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
