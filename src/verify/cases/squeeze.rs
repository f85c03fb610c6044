//! A block pressed slowly, its sides free or held (S. Timoshenko, J. N. Goodier, *Theory of Elasticity*, 3rd edition, 1.7).

use super::super::specimen::{body, box_mesh, held, material, moved, nodes_where, quiet_world};
use super::super::{CaseError, Effort, Outcome, Quantity};
use super::patch::lame_pa;
use crate::sim::World;
use glam::DVec3;

const DENSITY: f64 = 1000.0;
const YOUNG_PA: f64 = 1e7;
const POISSON: f64 = 0.3;
const SIDE_M: f64 = 0.1;
const STRAIN: f64 = 1e-4;
/// Times a wave crosses the block while it is pressed: inertia adds one over this to the stress.
const CROSSINGS: f64 = 2000.0;

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    const SLOW: &str = "large strain adds 2.1 times the strain of 1e-4, inertia one over the 2000 times that a wave crosses meanwhile";
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    let free = press(effort, false)?;
    let confined = press(effort, true)?;
    let volume_m3 = SIDE_M.powi(3);
    Ok(vec![
        Quantity::relative("free sides: pressure / strain", "Pa", free.modulus_pa, YOUNG_PA)
            .by("sigma = E eps")
            .within(1e-3, SLOW),
        Quantity::relative("free sides: sideways strain / strain", "", free.sideways, POISSON)
            .by("eps_y = -nu eps_x")
            .within(1e-3, SLOW),
        Quantity::relative(
            "free sides: strain energy",
            "J",
            free.strain_j,
            0.5 * YOUNG_PA * STRAIN.powi(2) * volume_m3,
        )
        .by("U = E eps^2 V/2")
        .within(2e-3, "twice the error of the strain"),
        Quantity::relative(
            "free sides: work of the press / strain energy",
            "",
            free.work_j / free.strain_j,
            1.0,
        )
        .by("first law: work done slowly is stored")
        .within(2e-3, "kinetic energy and damping of the slow motion"),
        Quantity::relative(
            "held sides: pressure / strain",
            "Pa",
            confined.modulus_pa,
            lambda_pa + 2.0 * mu_pa,
        )
        .by("sigma = (lambda + 2 mu) eps")
        .within(1e-3, SLOW),
    ]
    .into())
}

struct Pressed {
    modulus_pa: f64,
    sideways: f64,
    strain_j: f64,
    work_j: f64,
}

fn press(effort: &Effort, is_confined: bool) -> Result<Pressed, CaseError> {
    let mesh = box_mesh(DVec3::splat(SIDE_M), [2, 2, 2], DVec3::ZERO)?;
    let half_m = 0.5 * SIDE_M;
    let face = |axis: usize, side: f64| nodes_where(&mesh, |x| side * x[axis] > half_m - 1e-9);
    let wave_m_s = (YOUNG_PA / DENSITY).sqrt();
    let duration_s = CROSSINGS * SIDE_M / wave_m_s;
    let speed_m_s = STRAIN * SIDE_M / duration_s;
    let only = |axis: usize| std::array::from_fn(|i| i == axis);
    let mut boundary =
        vec![held(face(2, -1.0), only(2)), moved(face(2, 1.0), DVec3::NEG_Z * speed_m_s, only(2))];
    for axis in [0, 1] {
        // Planes of symmetry where the sides are free.
        boundary.push(held(face(axis, -1.0), only(axis)));
        if is_confined {
            boundary.push(held(face(axis, 1.0), only(axis)));
        }
    }
    let mut stuff = material(DENSITY, YOUNG_PA, POISSON);
    stuff.damping_per_s = 0.1 * wave_m_s / SIDE_M;
    let right = face(0, 1.0)[0] as usize;
    let mut block = body("block", mesh, stuff);
    block.boundary = boundary;
    let mut world = World::new(quiet_world(vec![block]))?;
    effort.run(&mut world, duration_s, |_, _| {})?;
    let stresses = world.element_stresses(0);
    let mean_pa = stresses.iter().map(|s| s.cauchy_pa.z_axis.z).sum::<f64>() / stresses.len() as f64;
    let strain = speed_m_s * world.time_s() / SIDE_M;
    let widened_m = world.positions_m(0)[right].x - world.reference_positions_m(0)[right].x;
    let sample = world.sample();
    // The last step may end a little beyond the strain asked for.
    let scale = (STRAIN / strain).powi(2);
    Ok(Pressed {
        modulus_pa: -mean_pa / strain,
        sideways: widened_m / SIDE_M / strain,
        strain_j: sample.strain_j * scale,
        work_j: sample.external_work_j * scale,
    })
}
