//! Balls and rods that hit: Hertz's impact, Newton's cradle, from sliding to rolling
//! (K. L. Johnson, *Contact Mechanics*, 1985, 4.2 and 11.4).

use super::super::specimen::{
    GRAVITY_M_S2, ball_mesh, body, box_mesh, fixed, heavy_world, material, quiet_world, window_peak_n,
};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity, Scale};
use crate::sim::World;
use glam::DVec3;

/// Equal rods in a row, the first of which flies: each passes its whole momentum on (one-dimensional wave theory:
/// `v_i' = 2 v_c - v_i` with equal impedances).
pub(in crate::verify) fn measure_cradle(effort: &Effort) -> Result<Outcome, CaseError> {
    const LENGTH_M: f64 = 0.2;
    const WIDTH_M: f64 = 0.02;
    const GAP_M: f64 = 1e-4;
    const SPEED_M_S: f64 = 1.0;
    let (density, young_pa) = (7844.0, 206.82e9);
    let along = if effort.quick { 10 } else { 20 };
    let mut bodies = Vec::new();
    for i in 0..3 {
        let centre = DVec3::X * f64::from(i) * (LENGTH_M + GAP_M);
        let mesh = box_mesh(DVec3::new(LENGTH_M, WIDTH_M, WIDTH_M), [along, 2, 2], centre)?;
        bodies.push(body(&format!("rod {}", i + 1), mesh, material(density, young_pa, 0.0)));
    }
    bodies[0].velocity_m_s = DVec3::X * SPEED_M_S;
    let mut setup = quiet_world(bodies);
    setup.time.cfl = 0.3;
    let mut world = World::new(setup)?;
    let start = world.sample();
    // Two collisions, each of some 1e-4 s, and the flight through two gaps.
    effort.run(&mut world, 3.0 * GAP_M / SPEED_M_S + 4e-4, |_, _| {})?;
    let names = ["first rod", "second rod", "third rod"];
    let mut all = Vec::new();
    for (index, (name, expected)) in names.into_iter().zip([0.0, 0.0, SPEED_M_S]).enumerate() {
        let velocity_m_s = world.body_momentum_kg_m_s(index).x / world.mass_kg(index);
        all.push(
            Quantity::absolute(
                format!("{name}: velocity after / v"),
                "",
                velocity_m_s / SPEED_M_S,
                expected / SPEED_M_S,
            )
            .by("equal impedances exchange velocities (Goldsmith, Impact, 1960, 3.1)")
            .within(0.025, "as in rods: what vibration keeps"),
        );
    }
    let end = world.sample();
    all.push(
        Quantity::absolute(
            "change of energy / initial",
            "",
            (end.kinetic_j + end.strain_j) / start.kinetic_j - 1.0,
            0.0,
        )
        .by("conservation of energy")
        .within(0.01, "as in rods"),
    );
    Ok(all.into())
}

const BALL_M: f64 = 0.05;
const BALL_DENSITY: f64 = 1100.0;
const BALL_YOUNG_PA: f64 = 2e6;
const BALL_POISSON: f64 = 0.3;

/// Duration and peak force of a ball's impact on a rigid plane by Hertz: `F = k d^(3/2)`, `k = (4/3) E/(1 - nu^2) sqrt(R)`;
/// deepest `d = (5 m v^2/4k)^(2/5)`, duration `2.943 d/v` (Johnson 1985, 11.4).
fn hertz(mass_kg: f64, speed_m_s: f64) -> (f64, f64) {
    let k = 4.0 / 3.0 * BALL_YOUNG_PA / (1.0 - BALL_POISSON * BALL_POISSON) * BALL_M.sqrt();
    let depth_m = (5.0 * mass_kg * speed_m_s * speed_m_s / (4.0 * k)).powf(0.4);
    (2.943_3 * depth_m / speed_m_s, k * depth_m.powf(1.5))
}

pub(in crate::verify) fn measure_hertz(effort: &Effort) -> Result<Outcome, CaseError> {
    let refinement = if effort.quick { 4 } else { 8 };
    let speeds_m_s = [0.5, 1.0, 2.0];
    let mut all = Vec::new();
    let (mut found, mut theory) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for speed_m_s in speeds_m_s {
        let ball = body(
            "ball",
            ball_mesh(BALL_M, refinement, DVec3::Z * (BALL_M + 1e-4))?,
            material(BALL_DENSITY, BALL_YOUNG_PA, BALL_POISSON),
        );
        let plane = fixed("plane", box_mesh(DVec3::new(0.3, 0.3, 0.05), [1, 1, 1], DVec3::Z * -0.025)?);
        let mut bodies = vec![plane, ball];
        bodies[1].velocity_m_s = DVec3::NEG_Z * speed_m_s;
        let mut setup = quiet_world(bodies);
        setup.time.cfl = 0.4;
        let mut world = World::new(setup)?;
        let mass_kg = world.mass_kg(1);
        let (duration_s, peak_n) = hertz(mass_kg, speed_m_s);
        let mut force = Vec::new();
        effort.run(&mut world, 2.2 * duration_s + 1e-4 / speed_m_s, |_, report| {
            force.push([report.step_s, report.contact_force_n]);
        })?;
        let lasted_s = world.contact_episodes().last().map_or(0.0, |last| last.impulse_end_s)
            - world.contact_episodes().first().map_or(0.0, |first| first.begin_s);
        let largest_n = window_peak_n(&force, duration_s / 15.0);
        all.extend([
            Quantity::relative(format!("{speed_m_s} m/s: duration"), "s", lasted_s, duration_s)
                .by("2.943 d/v (Hertz; Johnson 1985, 11.4)")
                .within(
                    0.1,
                    "contact radius over element is 2 to 4; strains of 10 % are not small, as Hertz assumes",
                ),
            Quantity::relative(format!("{speed_m_s} m/s: peak force"), "N", largest_n, peak_n)
                .by("k d^(3/2) (Hertz; Johnson 1985, 11.4)")
                .within(0.1, "as the duration"),
        ]);
        found[0].push([speed_m_s, lasted_s]);
        found[1].push([speed_m_s, largest_n]);
        theory[0].push([speed_m_s, duration_s]);
        theory[1].push([speed_m_s, peak_n]);
    }
    let exponent =
        |points: &[[f64; 2]]| (points[2][1] / points[0][1]).ln() / (points[2][0] / points[0][0]).ln();
    all.extend([
        Quantity::absolute("exponent of the duration over speed", "", exponent(&found[0]), -0.2)
            .by("T ~ v^(-1/5) (Hertz)")
            .within(0.05, "finite elements and strains"),
        Quantity::absolute("exponent of the peak force over speed", "", exponent(&found[1]), 1.2)
            .by("F ~ v^(6/5) (Hertz)")
            .within(0.05, "finite elements and strains"),
    ]);
    let [durations, peaks] = found;
    let [theory_durations, theory_peaks] = theory;
    let logs = [Scale::Log, Scale::Log];
    let plots = vec![
        Plot::new("hertz-duration", "Hertz's impact: duration", ["speed, m/s", "duration, s"])
            .scaled(logs)
            .with("ball", durations)
            .with("Hertz", theory_durations),
        Plot::new("hertz-force", "Hertz's impact: peak force", ["speed, m/s", "force, N"])
            .scaled(logs)
            .with("ball", peaks)
            .with("Hertz", theory_peaks),
    ];
    Ok(Outcome { quantities: all, plots })
}

/// A ball thrown along the ground without spin slides until friction has made it roll: then it has
/// `v0/(1 + I/(m R^2))`, that is 5/7 of its speed (A. Sommerfeld, *Mechanics*, 1943, 27).
pub(in crate::verify) fn measure_rolling(effort: &Effort) -> Result<Outcome, CaseError> {
    const SPEED_M_S: f64 = 1.0;
    const FRICTION: f64 = 0.4;
    const REFINEMENT: u32 = 4;
    let mut stuff = material(BALL_DENSITY, 1e6, BALL_POISSON);
    stuff.damping_per_s = 100.0;
    let ground =
        fixed("ground", box_mesh(DVec3::new(4.0, 1.0, 0.1), [1, 1, 1], DVec3::new(1.0, 0.0, -0.05))?);
    let mut ball = body("ball", ball_mesh(BALL_M, REFINEMENT, DVec3::Z * BALL_M)?, stuff);
    ball.velocity_m_s = DVec3::X * SPEED_M_S;
    let mut setup = heavy_world(vec![ground, ball]);
    setup.contact.friction_coefficient = FRICTION;
    let mut world = World::new(setup)?;
    let sliding_s = 2.0 * SPEED_M_S / (7.0 * FRICTION * GRAVITY_M_S2);
    let mut speed = vec![[0.0, SPEED_M_S]];
    let (mut early, mut late) = ((1.0, DVec3::ZERO), Vec::new());
    effort.run(&mut world, 2.5 * sliding_s, |world, report| {
        let velocity_m_s = world.body_momentum_kg_m_s(1) / world.mass_kg(1);
        speed.push([report.time_s, velocity_m_s.x]);
        if report.time_s < 0.5 * sliding_s {
            early = (report.time_s, velocity_m_s);
        }
        if report.time_s > 1.5 * sliding_s {
            late.push(velocity_m_s.x);
        }
    })?;
    let mean_m_s = late.iter().sum::<f64>() / late.len().max(1) as f64;
    // What bears the ball also throws it up and down while it is set down.
    let (early_s, early_m_s) = early;
    let bearing_m_s2 = GRAVITY_M_S2 + early_m_s.z / early_s;
    let all = vec![
        Quantity::relative("speed once it rolls / v0", "", mean_m_s / SPEED_M_S, 5.0 / 7.0)
            .by("angular momentum about the point of contact: 5/7 v0 (Sommerfeld 1943, 27)")
            .within(0.02, "facets of a fourth of the radius: inertia and radius are off by a percent"),
        Quantity::relative(
            "mean deceleration while it slides",
            "m/s2",
            (SPEED_M_S - early_m_s.x) / early_s,
            FRICTION * bearing_m_s2,
        )
        .by("mu N/m, N/m = g + v_z/t by the vertical momentum")
        .within(0.01, "the deforming ball's contact creeps before it slides"),
    ];
    let plot = Plot::new("rolling", "A sliding ball comes to roll", ["time, s", "velocity, m/s"])
        .with("ball", speed)
        .with("5/7 v0", vec![[sliding_s, 5.0 / 7.0 * SPEED_M_S], [2.5 * sliding_s, 5.0 / 7.0 * SPEED_M_S]]);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}
