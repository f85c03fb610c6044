//! Patch test: an affine motion of an irregular mesh gives one stress everywhere and no force on inner nodes
//! (B. M. Irons, A. Razzaque, 1972; O. C. Zienkiewicz, R. L. Taylor, *The Finite Element Method*, volume 1).

use super::super::specimen::box_mesh;
use super::super::{CaseError, Effort, Outcome, Quantity};
use crate::fem::{ElasticConstants, ElementBatches, ElementKinematics, ForceScratch};
use crate::math::{rotation_from_vector, symmetric_eigen};
use crate::mesh::TetMesh;
use glam::{DMat3, DVec3};

const YOUNG_PA: f64 = 206.82e9;
const POISSON: f64 = 0.3;
const CELLS: [u32; 3] = [5, 4, 6];
/// Inner nodes are moved by up to this share of a cell.
const JITTER: f64 = 0.2;

/// Round-off of some ten operations a component, times the condition of the distorted elements.
const ROUND_OFF: f64 = 1e-12;

pub(in crate::verify) fn measure(_: &Effort) -> Result<Outcome, CaseError> {
    let mesh = irregular_cube()?;
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    let constants = ElasticConstants { lambda_pa, mu_pa, density_kg_m3: 7844.0 };
    let elements = ElementBatches::new(&mesh.nodes_m, &mesh.tets, &vec![constants; mesh.tets.len()])
        .map_err(|error| CaseError::Unmeasured(error.to_string()))?;
    let rotation = DMat3::from_quat(rotation_from_vector(DVec3::new(0.5, -1.2, 0.8)));
    let f = DMat3::from_cols_array(&[1.02, 0.01, -0.02, 0.03, 0.97, 0.01, 0.0, -0.01, 1.01]);
    let hooke = |strain: DMat3| {
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        DMat3::IDENTITY * (lambda_pa * trace) + strain * (2.0 * mu_pa)
    };
    // Cauchy stress of Hooke's law in Green-Lagrange strain, and of the linear law in a turned frame.
    let green =
        f * hooke((f.transpose() * f - DMat3::IDENTITY) * 0.5) * f.transpose() * f.determinant().recip();
    let linear = rotation * hooke((f + f.transpose()) * 0.5 - DMat3::IDENTITY) * rotation.transpose();
    let cauchy = |first_piola: DMat3| {
        rotation * first_piola * f.transpose() * rotation.transpose() * f.determinant().recip()
    };
    let corotated = cauchy(corotated_piola_pa(&f, hooke));
    let neo_hookean = cauchy(neo_hookean_piola_pa(&f, lambda_pa, mu_pa));
    let mut quantities = Vec::new();
    for (name, kinematics, expected, turn) in [
        ("green", ElementKinematics::Green, rotation * green * rotation.transpose(), rotation),
        ("body-frame", ElementKinematics::BodyFrame { rotation }, linear, rotation),
        ("corotated", ElementKinematics::Corotated, corotated, rotation),
        ("neo-hookean", ElementKinematics::NeoHookean, neo_hookean, rotation),
    ] {
        let moved: Vec<DVec3> = mesh.nodes_m.iter().map(|x| turn * (f * *x)).collect();
        let stresses = elements.cauchy_stresses_pa(&moved, kinematics);
        let worst = stresses.iter().map(|s| largest_entry(*s - expected)).fold(0.0, f64::max);
        quantities.push(
            Quantity::absolute(
                format!("{name}: stress error / largest stress"),
                "",
                worst / largest_entry(expected),
                0.0,
            )
            .by(match kinematics {
                ElementKinematics::Corotated => {
                    "sigma = R T F^T / J, T = lambda tr(S - I) I + 2 mu (S - I), F = R S"
                }
                ElementKinematics::NeoHookean => {
                    "sigma = P F^T / J (Smith, de Goes, Kim 2018, equations 14 and 15)"
                }
                _ => "sigma = F S F^T / J with S = lambda tr(E) I + 2 mu E (METHOD 1)",
            })
            .within(ROUND_OFF, "round-off: the elements hold a uniform strain exactly"),
        );
        let mut forces_n = vec![DVec3::ZERO; moved.len()];
        elements.forces(&mut ForceScratch::default(), &moved, kinematics, &mut forces_n);
        // Mean stress by the forces: -sum f X^T = V P, and P F^T = J sigma.
        let virial_j = mesh.nodes_m.iter().zip(&forces_n).map(|(x, f)| outer_product(*f, *x)).sum::<DMat3>();
        let stretch = turn * f;
        let linear_piola = expected * turn;
        let first_piola = match kinematics {
            ElementKinematics::BodyFrame { .. } => linear_piola,
            _ => expected * stretch.inverse().transpose() * f.determinant(),
        };
        let error_pa = largest_entry(virial_j * -1.0 - first_piola) / largest_entry(first_piola);
        quantities.push(
            Quantity::absolute(format!("{name}: stress that the nodal forces stand for"), "", error_pa, 0.0)
                .by("-sum f X^T = V P, P = F S, of a unit cube (virial theorem)")
                .within(ROUND_OFF, "round-off"),
        );
        let (inner, outer) = inner_and_outer(&mesh, &forces_n);
        quantities.push(
            Quantity::absolute(
                format!("{name}: force on inner nodes / on outer ones"),
                "",
                inner / outer,
                0.0,
            )
            .by("equilibrium of a uniform stress: div sigma = 0")
            .within(ROUND_OFF, "round-off"),
        );
    }
    Ok(quantities.into())
}

/// `P = R T` with the stretch as the root of `F^T F`, Pa.
fn corotated_piola_pa(f: &DMat3, hooke: impl Fn(DMat3) -> DMat3) -> DMat3 {
    let squared = symmetric_eigen(&(f.transpose() * *f));
    let axes = squared.directions;
    let stretch = axes * DMat3::from_diagonal(squared.values.map(f64::sqrt)) * axes.transpose();
    *f * stretch.inverse() * hooke(stretch - DMat3::IDENTITY)
}

/// `P = mu' (1 - 1/(I_C + 1)) F + lambda' (J - alpha) J F^-T`, `alpha = 1 + 3 mu'/(4 lambda')`, with `mu' = 4/3 mu` and
/// `lambda' = lambda + 5/6 mu`, Pa (Smith, de Goes, Kim 2018).
pub(in crate::verify) fn neo_hookean_piola_pa(f: &DMat3, lambda_pa: f64, mu_pa: f64) -> DMat3 {
    let (mu, lambda) = (4.0 / 3.0 * mu_pa, lambda_pa + 5.0 / 6.0 * mu_pa);
    let squares: f64 = f.to_cols_array().iter().map(|x| x * x).sum();
    let jacobian = f.determinant();
    let pressure = lambda * (jacobian - 1.0 - 0.75 * mu / lambda);
    *f * (mu * (1.0 - 1.0 / (squares + 1.0))) + f.inverse().transpose() * (jacobian * pressure)
}

/// Lame's constants, Pa: `lambda = E nu/((1 + nu)(1 - 2 nu))`, `mu = E/(2(1 + nu))`.
pub(in crate::verify) fn lame_pa(youngs_modulus_pa: f64, nu: f64) -> [f64; 2] {
    [youngs_modulus_pa * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), youngs_modulus_pa / (2.0 * (1.0 + nu))]
}

/// A unit cube whose inner nodes are moved about, always in the same way.
fn irregular_cube() -> Result<TetMesh, CaseError> {
    let mut mesh = box_mesh(DVec3::ONE, CELLS, DVec3::splat(0.5))?;
    let cell_m = DVec3::from_array(CELLS.map(|n| 1.0 / f64::from(n)));
    for (index, x) in mesh.nodes_m.iter_mut().enumerate() {
        if is_inner(*x) {
            // Irrational multiples fill the cube evenly.
            let i = index as f64;
            let spread = DVec3::new(i * 0.754_877, i * 0.569_840, i * 0.430_159).fract() * 2.0 - 1.0;
            *x += spread * cell_m * JITTER;
        }
    }
    Ok(mesh)
}

fn is_inner(x_m: DVec3) -> bool {
    x_m.min_element() > 1e-9 && x_m.max_element() < 1.0 - 1e-9
}

/// `a b^T`.
pub(in crate::verify) fn outer_product(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Largest force on a node inside and on the surface, N.
fn inner_and_outer(mesh: &TetMesh, forces_n: &[DVec3]) -> (f64, f64) {
    mesh.nodes_m.iter().zip(forces_n).fold((0.0, 0.0), |(inner, outer), (x, force_n)| {
        if is_inner(*x) { (force_n.length().max(inner), outer) } else { (inner, force_n.length().max(outer)) }
    })
}

fn largest_entry(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().fold(0.0, |most, entry| entry.abs().max(most))
}
