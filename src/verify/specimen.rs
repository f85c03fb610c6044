//! Bodies and worlds that several cases start from.

use super::CaseError;
use crate::mesh::shapes::{Ball, BoxShape, Meshing, Resolution, Shape};
use crate::mesh::{TetMesh, signed_volume_m3};
use crate::sim::{BodyMotion, BodySetup, BoundaryAction, BoundaryCondition, Material, WorldSetup};
use glam::DVec3;

/// Standard gravity as the scenes take it, m/s2.
pub(super) const GRAVITY_M_S2: f64 = 9.81;

/// An undamped material that never breaks.
pub(super) fn material(density_kg_m3: f64, youngs_modulus_pa: f64, poisson_ratio: f64) -> Material {
    Material::elastic("specimen", density_kg_m3, youngs_modulus_pa, poisson_ratio)
}

/// A box of the given sizes (m) and cells around `centre_m`.
pub(super) fn box_mesh(size_m: DVec3, cells: [u32; 3], centre_m: DVec3) -> Result<TetMesh, CaseError> {
    mesh(&Shape::Box(BoxShape { size_m }), Resolution::Cells(cells), centre_m)
}

/// A ball of `radius_m` around `centre_m`, `refinement` times as fine as the coarsest.
pub(super) fn ball_mesh(radius_m: f64, refinement: u32, centre_m: DVec3) -> Result<TetMesh, CaseError> {
    mesh(&Shape::Ball(Ball { radius_m }), Resolution::Refinement(refinement), centre_m)
}

fn mesh(shape: &Shape, resolution: Resolution, centre_m: DVec3) -> Result<TetMesh, CaseError> {
    let meshing = Meshing { resolution, ..Meshing::default() };
    let mut mesh = shape.build(&meshing).map_err(|error| CaseError::Unmeasured(error.to_string()))?;
    mesh.nodes_m.iter_mut().for_each(|x| *x += centre_m);
    Ok(mesh)
}

/// A deformable body at rest.
pub(super) fn body(name: &str, mesh: TetMesh, material: Material) -> BodySetup {
    BodySetup::at_rest(name, mesh, material)
}

/// A body that never moves.
pub(super) fn fixed(name: &str, mesh: TetMesh) -> BodySetup {
    BodySetup { motion: BodyMotion::Fixed, ..body(name, mesh, material(7844.0, 206.82e9, 0.3)) }
}

/// A world without gravity and friction.
pub(super) fn quiet_world(bodies: Vec<BodySetup>) -> WorldSetup {
    let mut setup = WorldSetup { bodies, ..WorldSetup::default() };
    setup.contact.friction_coefficient = 0.0;
    setup.contact.self_collision = false;
    setup
}

/// A world with gravity along -z.
pub(super) fn heavy_world(bodies: Vec<BodySetup>) -> WorldSetup {
    WorldSetup { gravity_m_s2: DVec3::NEG_Z * GRAVITY_M_S2, ..quiet_world(bodies) }
}

/// The nodes of a mesh at which `inside` holds.
pub(super) fn nodes_where(mesh: &TetMesh, inside: impl Fn(DVec3) -> bool) -> Vec<u32> {
    let nodes = (0_u32..).zip(&mesh.nodes_m);
    nodes.filter(|(_, x)| inside(**x)).map(|(node, _)| node).collect()
}

/// Weights for the projection of a motion on a mode: its shape times each node's share of the volume, and so of the
/// mass. With those every other mode drops out.
pub(super) fn mode_weights(mesh: &TetMesh, shape: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let mut weights = vec![0.0; mesh.nodes_m.len()];
    for (index, tet) in mesh.tets.iter().enumerate() {
        let quarter_m3 = signed_volume_m3(&mesh.corners_m(index)) / 4.0;
        tet.iter().for_each(|node| weights[*node as usize] += quarter_m3);
    }
    weights.iter().zip(&mesh.nodes_m).map(|(weight, x)| weight * shape(*x)).collect()
}

/// Holds nodes along the axes marked true.
pub(super) fn held(nodes: Vec<u32>, axes: [bool; 3]) -> BoundaryCondition {
    BoundaryCondition { nodes, action: BoundaryAction::Fixed { axes } }
}

/// Loads nodes with a total force from the start on, N.
pub(super) fn loaded(nodes: Vec<u32>, total_n: DVec3) -> BoundaryCondition {
    BoundaryCondition { nodes, action: BoundaryAction::Force { total_n, ramp_s: 0.0 } }
}

/// Moves nodes at a velocity along one axis, m/s.
pub(super) fn moved(nodes: Vec<u32>, velocity_m_s: DVec3, axes: [bool; 3]) -> BoundaryCondition {
    BoundaryCondition { nodes, action: BoundaryAction::Velocity { velocity_m_s, axes } }
}

/// Observed order of convergence over three meshes, each `ratio` times as fine as the one before:
/// `p = log((a - b)/(b - c)) / log(ratio)` (P. J. Roache, *Verification and Validation in Computational Science and
/// Engineering*, 1998, chapter 5).
pub(super) fn observed_order([a, b, c]: [f64; 3], ratio: f64) -> f64 {
    ((a - b) / (b - c)).ln() / ratio.ln()
}

/// What three meshes point to in the limit: Richardson's extrapolation with the observed order (Roache, ibid.).
pub(super) fn extrapolated([a, b, c]: [f64; 3]) -> f64 {
    c + (c - b).powi(2) / ((b - a) - (c - b))
}

/// Times at which a sampled signal (time, value) crosses zero, interpolated linearly, s.
pub(super) fn crossings_s(signal: &[[f64; 2]]) -> Vec<f64> {
    let pairs = signal.windows(2).filter(|w| (w[0][1] < 0.0) != (w[1][1] < 0.0));
    pairs.map(|w| w[0][0] - w[0][1] * (w[1][0] - w[0][0]) / (w[1][1] - w[0][1])).collect()
}

/// Largest mean force over a window of time, of steps (length, force); N. Single nodes that meet make blows far shorter
/// than an impact.
pub(super) fn window_peak_n(steps: &[[f64; 2]], window_s: f64) -> f64 {
    let mut most_n = 0.0_f64;
    let (mut from, mut impulse_n_s, mut length_s) = (0, 0.0, 0.0);
    for [step_s, force_n] in steps {
        impulse_n_s += force_n * step_s;
        length_s += step_s;
        while length_s - steps[from][0] >= window_s {
            impulse_n_s -= steps[from][1] * steps[from][0];
            length_s -= steps[from][0];
            from += 1;
        }
        if length_s >= window_s {
            most_n = most_n.max(impulse_n_s / length_s);
        }
    }
    most_n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_limit_of_a_made_up_sequence() {
        let values = [1.0, 2.0, 4.0].map(|n: f64| 7.0 + 3.0 / (n * n));
        assert!((observed_order(values, 2.0) - 2.0).abs() < 1e-12);
        assert!((extrapolated(values) - 7.0).abs() < 1e-12);
    }

    #[test]
    fn crossings_of_a_straight_line() {
        assert_eq!(crossings_s(&[[0.0, -1.0], [1.0, 3.0], [2.0, 1.0]]), [0.25]);
    }
}
