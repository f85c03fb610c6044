//! Waves in a bar: their speed, and what a change of section does to them
//! (K. F. Graff, *Wave Motion in Elastic Solids*, 1975, chapter 2).

use super::super::specimen::{
    body, box_mesh, crossings_s, held, loaded, material, mode_weights, moved, nodes_where, observed_order,
    quiet_world,
};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity, Scale};
use super::patch::lame_pa;
use crate::mesh::TetMesh;
use crate::sim::{BodyMotion, Kinematics, World};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

const DENSITY: f64 = 7844.0;
const YOUNG_PA: f64 = 206.82e9;
const POISSON: f64 = 0.3;
const LENGTH_M: f64 = 1.0;

/// A kind of plane wave along x: which motions are held, and where the material points move to.
pub(super) struct Wave {
    pub name: &'static str,
    pub source: &'static str,
    pub held_axes: [bool; 3],
    pub along: DVec3,
    pub poisson_ratio: f64,
    pub speed_m_s: f64,
}

pub(super) fn kinds() -> [Wave; 3] {
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    [
        Wave {
            name: "thin bar (nu = 0)",
            source: "c = sqrt(E/rho) (Graff 1975, 2.1)",
            held_axes: [false; 3],
            along: DVec3::X,
            poisson_ratio: 0.0,
            speed_m_s: bar_speed_m_s(YOUNG_PA, DENSITY),
        },
        Wave {
            name: "pressure wave (sides held, nu = 0.3)",
            source: "c = sqrt((lambda + 2 mu)/rho) (METHOD 2)",
            held_axes: [false, true, true],
            along: DVec3::X,
            poisson_ratio: POISSON,
            speed_m_s: ((lambda_pa + 2.0 * mu_pa) / DENSITY).sqrt(),
        },
        Wave {
            name: "shear wave (nu = 0.3)",
            source: "c = sqrt(mu/rho) (Graff 1975, 5.1)",
            held_axes: [true, false, true],
            along: DVec3::Y,
            poisson_ratio: POISSON,
            speed_m_s: (mu_pa / DENSITY).sqrt(),
        },
    ]
}

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let cells = if effort.quick { [5, 10, 20] } else { [10, 20, 40] };
    let mut quantities = Vec::new();
    let mut plot =
        Plot::new("wave-speed", "Wave speed under refinement", ["elements along the bar", "relative error"])
            .scaled([Scale::Log, Scale::Log]);
    for wave in kinds() {
        let mut speeds_m_s = [0.0; 3];
        for (speed_m_s, cells) in speeds_m_s.iter_mut().zip(cells) {
            *speed_m_s = speed_of(effort, &wave, (cells, Kinematics::Green))?;
        }
        quantities.push(
            Quantity::relative(
                format!("{}, {} elements", wave.name, cells[2]),
                "m/s",
                speeds_m_s[2],
                wave.speed_m_s,
            )
            .by(wave.source)
            .within(
                1e-3,
                "(k h)^2/24 with k h = pi/40 is 2.6e-4 for lumped mass; four times that in three dimensions",
            ),
        );
        quantities.push(
            Quantity::absolute(format!("{}, observed order", wave.name), "", observed_order(speeds_m_s, 2.0), 2.0)
                .by("linear elements with lumped mass: error (k h)^2/24 (T. J. R. Hughes, The Finite Element Method, 9.1)")
                .within(0.2, "three meshes are not yet the limit"),
        );
        let points =
            cells.iter().zip(speeds_m_s).map(|(n, c)| [f64::from(*n), (c / wave.speed_m_s - 1.0).abs()]);
        plot = plot.with(wave.name, points.collect());
    }
    Ok(Outcome { quantities, plots: vec![plot] })
}

/// Speed of a wave by the fundamental frequency of a bar that is held at one end and suddenly loaded at the
/// other, `c = 4 L f`, m/s. The motion is projected on the mode `sin(pi x/2L)`.
pub(super) fn speed_of(
    effort: &Effort,
    wave: &Wave,
    (cells, kinematics): (u32, Kinematics),
) -> Result<f64, CaseError> {
    const STRAIN: f64 = 1e-5;
    let width_m = LENGTH_M / f64::from(cells) * 2.0;
    let mesh = box_mesh(DVec3::new(LENGTH_M, width_m, width_m), [cells, 2, 2], DVec3::X * 0.5 * LENGTH_M)?;
    let stiffness_pa = wave.speed_m_s.powi(2) * DENSITY;
    let ends = [0.0, LENGTH_M].map(|at_m| nodes_where(&mesh, |x| (x.x - at_m).abs() < 1e-9));
    let [fixed_end, free_end] = ends;
    let mut bar = body("bar", mesh, material(DENSITY, YOUNG_PA, wave.poisson_ratio));
    bar.motion = BodyMotion::Deformable(kinematics);
    bar.boundary = vec![
        held(fixed_end, [true; 3]),
        loaded(free_end, wave.along * (STRAIN * stiffness_pa * width_m * width_m)),
    ];
    if wave.held_axes != [false; 3] {
        bar.boundary.push(held(nodes_where(&bar.mesh, |_| true), wave.held_axes));
    }
    let shape = mode_weights(&bar.mesh, |x| (FRAC_PI_2 * x.x / LENGTH_M).sin());
    let period_s = 4.0 * LENGTH_M / wave.speed_m_s;
    let mut setup = quiet_world(vec![bar]);
    // The errors of time and of space have opposite signs: with short steps that of space stands alone.
    setup.time.cfl = 0.2;
    let mut world = World::new(setup)?;
    let mut signal = vec![[0.0, 0.0]];
    effort.run(&mut world, 2.2 * period_s, |world, report| {
        let nodes = world.positions_m(0).iter().zip(world.reference_positions_m(0)).zip(&shape);
        let amplitude_m = nodes.map(|((x, x0), shape)| (*x - *x0).dot(wave.along) * shape).sum();
        signal.push([report.time_s, amplitude_m]);
    })?;
    // The mode swings about its static value: half of the largest.
    let most_m = signal.iter().map(|[_, q]| *q).fold(0.0, f64::max);
    signal.iter_mut().for_each(|[_, q]| *q -= 0.5 * most_m);
    match crossings_s(&signal)[..] {
        // Whole periods between crossings of one direction do not hang on the level.
        [first, _, third, ..] => Ok(4.0 * LENGTH_M / (third - first)),
        _ => Err(CaseError::Unmeasured(format!("the bar does not swing ({})", wave.name))),
    }
}

/// Sides of the thick and of the thin part of the stepped bar, m.
const SIDES_M: [f64; 2] = [0.08, 0.04];

/// A bar whose section shrinks to a quarter: of a step of velocity `v` that arrives, `2 Z1/(Z1 + Z2)` goes on, with
/// `Z = A sqrt(rho E)` (Graff 1975, 2.4).
pub(in crate::verify) fn measure_section(effort: &Effort) -> Result<Outcome, CaseError> {
    const SPEED_M_S: f64 = 1.0;
    /// Windows begin so late after the front, as a share of the time a wave needs for one half of the bar: the ringing behind it has calmed down.
    const WINDOW: [f64; 2] = [0.2, 0.8];
    let cells_along = if effort.quick { 100 } else { 200 };
    let bar_m = 2.0;
    let mesh = stepped(box_mesh(
        DVec3::new(2.0 * bar_m, SIDES_M[0], SIDES_M[0]),
        [2 * cells_along, 4, 4],
        DVec3::ZERO,
    )?);
    let pushed = nodes_where(&mesh, |x| x.x < -bar_m + 1e-9);
    let mut bar = body("bar", mesh, material(DENSITY, YOUNG_PA, 0.0));
    bar.boundary = vec![moved(pushed, DVec3::X * SPEED_M_S, [true, false, false])];
    let c_m_s = bar_speed_m_s(YOUNG_PA, DENSITY);
    let crossing_s = bar_m / c_m_s;
    let sections = [-0.1 * bar_m, 0.1 * bar_m].map(|at_m| {
        let near_m = 0.6 * bar_m / f64::from(cells_along);
        nodes_where(&bar.mesh, |x| (x.x - at_m).abs() < near_m)
    });
    let mut world = World::new(quiet_world(vec![bar]))?;
    let mut curves = [Vec::new(), Vec::new()];
    effort.run(&mut world, 1.95 * crossing_s, |world, report| {
        for (curve, nodes) in curves.iter_mut().zip(&sections) {
            let sum_m_s: f64 = nodes.iter().map(|n| world.velocities_m_s(0)[*n as usize].x).sum();
            curve.push([report.time_s, sum_m_s / nodes.len() as f64]);
        }
    })?;
    let areas_m2 = SIDES_M.map(|side_m| side_m * side_m);
    let expected_m_s = 2.0 * areas_m2[0] / (areas_m2[0] + areas_m2[1]) * SPEED_M_S;
    let mut quantities = Vec::new();
    for (curve, name) in
        curves.iter().zip(["reflected: velocity before the step", "transmitted: velocity behind the step"])
    {
        let arrival_s = 1.1 * crossing_s;
        let [from_s, to_s] = WINDOW.map(|share| arrival_s + share * crossing_s);
        let window: Vec<f64> =
            curve.iter().filter(|[t, _]| (from_s..to_s).contains(t)).map(|[_, v]| *v).collect();
        let mean_m_s = window.iter().sum::<f64>() / window.len() as f64;
        quantities.push(
            Quantity::relative(name, "m/s", mean_m_s, expected_m_s)
                .by("v = 2 Z1/(Z1 + Z2) v0, Z = A sqrt(rho E), areas 4 : 1 (Graff 1975, 2.4)")
                .within(0.01, "thickness over length of the window is 0.03; ringing is averaged"),
        );
    }
    let [before, behind] = curves;
    let plot = Plot::new("section", "A wave meets a change of section", ["time, s", "velocity, m/s"])
        .with("before the step", before)
        .with("behind the step", behind);
    Ok(Outcome { quantities, plots: vec![plot] })
}

/// The mesh without what lies outside the thin part at positive x.
fn stepped(mut mesh: TetMesh) -> TetMesh {
    let half_m = 0.5 * SIDES_M[1];
    let kept: Vec<[u32; 4]> = (0..mesh.tets.len())
        .filter(|&index| {
            let middle_m = mesh.corners_m(index).iter().sum::<DVec3>() / 4.0;
            middle_m.x < 0.0 || middle_m.y.abs().max(middle_m.z.abs()) < half_m
        })
        .map(|index| mesh.tets[index])
        .collect();
    let mut number = vec![u32::MAX; mesh.nodes_m.len()];
    let mut nodes_m = Vec::new();
    for node in kept.iter().flatten() {
        if number[*node as usize] == u32::MAX {
            number[*node as usize] = nodes_m.len() as u32;
            nodes_m.push(mesh.nodes_m[*node as usize]);
        }
    }
    mesh = TetMesh::with_one_region(nodes_m, kept);
    mesh.tets.iter_mut().flatten().for_each(|node| *node = number[*node as usize]);
    mesh
}

/// Speed of waves in a thin bar, `sqrt(E/rho)`, m/s.
pub(super) fn bar_speed_m_s(youngs_modulus_pa: f64, density_kg_m3: f64) -> f64 {
    (youngs_modulus_pa / density_kg_m3).sqrt()
}
