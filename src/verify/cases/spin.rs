//! A box that turns freely: angular momentum, energy, strain (METHOD 9).

use super::super::specimen::{body, box_mesh, material, quiet_world};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity};
use crate::sim::{BodyMotion, Kinematics, World};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const DENSITY: f64 = 7844.0;
const YOUNG_PA: f64 = 206.82e9;
const SPIN_RAD_S: f64 = 2000.0;
const SIZE_M: DVec3 = DVec3::new(0.1, 0.06, 0.04);

#[derive(Default)]
struct Spun {
    angular_momentum_error: f64,
    energy_error: f64,
    strain_share: f64,
    turns: f64,
    drift_rad: f64,
    strain: Vec<[f64; 2]>,
}

/// Turns a steel box about its short axis, elastic all the while.
fn spin(effort: &Effort, kinematics: Kinematics, turns: f64) -> Result<Spun, CaseError> {
    let mut cube = body("box", box_mesh(SIZE_M, [3, 2, 2], DVec3::ZERO)?, material(DENSITY, YOUNG_PA, 0.3));
    cube.motion = BodyMotion::Deformable(kinematics);
    cube.spin_rad_s = DVec3::Z * SPIN_RAD_S;
    let mut setup = quiet_world(vec![cube]);
    setup.time.free_travel = false;
    let mut world = World::new(setup)?;
    let start = world.sample();
    let mut spun = Spun::default();
    let mut last = 0.0;
    effort.run(&mut world, turns * TAU / SPIN_RAD_S, |world, report| {
        let s = world.sample();
        let change = (s.angular_momentum_kg_m2_s - start.angular_momentum_kg_m2_s).length();
        let relative = change / start.angular_momentum_kg_m2_s.length();
        spun.angular_momentum_error = spun.angular_momentum_error.max(relative);
        let energy = (s.kinetic_j + s.strain_j) / start.kinetic_j - 1.0;
        spun.energy_error = spun.energy_error.max(energy.abs());
        spun.strain_share = spun.strain_share.max(s.strain_j / start.kinetic_j);
        spun.strain.push([report.time_s, s.strain_j]);
        let axis = world.body_pose(0).0 * DVec3::X;
        let angle = axis.y.atan2(axis.x);
        spun.turns += ((angle - last + PI).rem_euclid(TAU) - PI) / TAU;
        last = angle;
    })?;
    spun.drift_rad = world.frame_drift_rad(0) / turns;
    Ok(spun)
}

/// Strain over kinetic energy of a bar of half length `a` in equilibrium with its centrifugal force is
/// `(2/5) (omega a/c)^2`: stress `rho omega^2 (a^2 - x^2)/2`, energy `integral of stress^2/2E`, over `rho omega^2 a^3/3`
/// per area. A load put on at once swings to twice the displacement, four times the energy.
fn most_centrifugal_share() -> f64 {
    4.0 * 0.4 * (SPIN_RAD_S * 0.5 * SIZE_M.x).powi(2) * DENSITY / YOUNG_PA
}

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let turns = if effort.quick { 2.0 } else { 10.0 };
    let mut all = Vec::new();
    let mut plot = Plot::new("spin", "Strain energy of a box that turns", ["time, s", "energy, J"]);
    for (name, kinematics, momentum_bound, reason) in [
        (
            "green",
            Kinematics::Green,
            1e-9,
            "round-off of all steps: forces act along the elements' own stresses",
        ),
        (
            "body-frame",
            Kinematics::BodyFrame,
            1e-4,
            "linear stiffness turns a stretched body by strain times its force (METHOD 5)",
        ),
        ("corotated", Kinematics::Corotated, 1e-9, "round-off: each element turns by itself"),
        ("neo-hookean", Kinematics::NeoHookean, 1e-9, "round-off: the energy knows no direction"),
    ] {
        let spun = spin(effort, kinematics, turns)?;
        all.extend([
            Quantity::absolute(
                format!("{name}: change of the angular momentum"),
                "",
                spun.angular_momentum_error,
                0.0,
            )
            .by("conservation of angular momentum (METHOD 5)")
            .within(momentum_bound, reason),
            Quantity::absolute(format!("{name}: error of the energy"), "", spun.energy_error, 0.0)
                .by("conservation of energy")
                .within(
                    1e-4,
                    "share of strain energy, 6e-4 of the whole, that central differences let swing",
                ),
            Quantity::relative(format!("{name}: revolutions"), "", spun.turns, turns)
                .by("omega t/2 pi")
                .within(
                    1e-3,
                    "centrifugal stretch of the box: strains of 2e-4 make it turn slower by twice that",
                ),
            Quantity::absolute(
                format!("{name}: strain / kinetic energy over the most a bar gets"),
                "",
                (spun.strain_share / most_centrifugal_share() - 1.0).max(0.0),
                0.0,
            )
            .by("4 (2/5) (omega a/c)^2: centrifugal load put on at once")
            .within(0.0, "pure rotation makes no strain"),
        ]);
        if kinematics == Kinematics::BodyFrame {
            all.push(
                Quantity::absolute(
                    "body-frame: frame against best fit, a revolution",
                    "rad",
                    spun.drift_rad,
                    0.0,
                )
                .by("METHOD 1: below 1e-6, or R is taken from the best fit, as it is here in every step"),
            );
        }
        plot = plot.with(name, spun.strain);
    }
    all.extend(tumble(effort)?);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// A box that tumbles about all its axes, by free travel and by elastic steps: two ways to the same motion.
fn tumble(effort: &Effort) -> Result<[Quantity; 2], CaseError> {
    const SPIN_RAD_S: DVec3 = DVec3::new(800.0, 1500.0, 600.0);
    const TURNS: f64 = 2.0;
    let end_s = TURNS * TAU / SPIN_RAD_S.length();
    let mut poses = Vec::new();
    let mut energy_error = 0.0;
    for free_travel in [true, false] {
        let mut cube =
            body("box", box_mesh(SIZE_M, [3, 2, 2], DVec3::ZERO)?, material(DENSITY, YOUNG_PA, 0.3));
        cube.spin_rad_s = SPIN_RAD_S;
        let mut setup = quiet_world(vec![cube]);
        setup.time.free_travel = free_travel;
        let mut world = World::new(setup)?;
        let start_j = world.sample().kinetic_j;
        effort.run(&mut world, end_s, |_, _| {})?;
        poses.push((world.body_pose(0).0, world.time_s()));
        if free_travel {
            energy_error = world.sample().kinetic_j / start_j - 1.0;
        }
    }
    // The last elastic step ends a little later.
    let late_rad = (poses[1].1 - poses[0].1) * SPIN_RAD_S.length();
    let apart_rad = (poses[1].0 * poses[0].0.inverse()).to_scaled_axis().length();
    Ok([
        Quantity::absolute("tumbling in free travel: change of energy", "", energy_error, 0.0)
            .by("torque-free motion keeps angular momentum and energy (METHOD 9)")
            .within(1e-6, "midpoint steps of at most 2e-3 rad: a twelfth of its square"),
        Quantity::absolute(
            "tumbling: free travel against elastic steps, two turns",
            "rad",
            apart_rad - late_rad,
            0.0,
        )
        .by("the same box, stiff: two ways to integrate Euler's equations")
        .within(0.01, "the elastic box stretches by 2e-4, over 4 pi rad, and its vibration"),
    ])
}
