//! Two steel rods collide head-on, against one-dimensional wave theory (METHOD 8, V1).

use crate::build::{body, box_mesh, material, quiet_world, run};
use glam::DVec3;
use hammerfall::sim::{BodyMotion, Kinematics, World, WorldSetup};

const LENGTH_M: f64 = 0.254;
const WIDTH_M: f64 = 0.0254;
const HEIGHTS_M: [f64; 2] = [0.0254, 0.0224];
const GAP_M: f64 = 2.54e-5;
const SPEED_M_S: f64 = 5.1359;
const DENSITY: f64 = 7844.0;
const YOUNG_PA: f64 = 206.82e9;

fn setup(cells: [[u32; 3]; 2], kinematics: Kinematics, cfl: f64) -> WorldSetup {
    let bodies = [0, 1].map(|i| {
        let side = [-1.0, 1.0][i];
        let centre = DVec3::X * side * 0.5 * (LENGTH_M + GAP_M);
        let mesh = box_mesh(DVec3::new(LENGTH_M, WIDTH_M, HEIGHTS_M[i]), cells[i], centre);
        let mut rod = body(["left", "right"][i], mesh, material(DENSITY, YOUNG_PA, 0.0));
        rod.velocity_m_s = DVec3::X * -side * SPEED_M_S;
        rod.motion = BodyMotion::Deformable(kinematics);
        rod
    });
    let mut setup = quiet_world(bodies.into());
    setup.time.cfl = cfl;
    setup
}

#[derive(Debug)]
struct Outcome {
    duration_error: f64,
    end_error: f64,
    pulse_error: f64,
    last_change: f64,
    n: usize,
    momentum_error: f64,
    energy_error: f64,
    impulse_errors: [f64; 2],
    /// Largest of the first passes' counts and last changes, for the message of a failure.
    passes: u32,
    velocities: [f64; 2],
}

fn collide(setup: WorldSetup) -> Outcome {
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    let before: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b)).collect();
    let (mut momentum_error, mut energy_error, mut passes) = (0.0_f64, 0.0_f64, 0);
    let mut last_change = 0.0_f64;
    let scale = before[0].length();
    run(&mut world, 2.0e-4, |_, sample| {
        let momentum = (sample.linear_momentum_kg_m_s - start.linear_momentum_kg_m_s).length() / scale;
        momentum_error = momentum_error.max(momentum);
        let energy = (sample.kinetic_j + sample.strain_j) / start.kinetic_j - 1.0;
        energy_error = energy_error.max(energy.abs());
        passes = passes.max(sample.step.passes);
        last_change = last_change.max(sample.step.last_change);
    });
    let episodes = world.contact_episodes();
    let theory_s = 2.0 * LENGTH_M * (DENSITY / YOUNG_PA).sqrt();
    let impulse: DVec3 = episodes.iter().map(|e| e.impulse_n_s).sum();
    let changes: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b) - before[b]).collect();
    Outcome {
        duration_error: (episodes.last().unwrap().impulse_end_s - episodes[0].begin_s) / theory_s - 1.0,
        end_error: (episodes.last().unwrap().end_s - episodes[0].begin_s) / theory_s - 1.0,
        pulse_error: episodes[0].pulse_length_s / theory_s - 1.0,
        last_change,
        n: episodes.len(),
        momentum_error,
        energy_error,
        impulse_errors: [
            (impulse - changes[0]).length() / impulse.length(),
            (impulse + changes[1]).length() / impulse.length(),
        ],
        passes,
        velocities: [0, 1].map(|b| world.body_momentum_kg_m_s(b).x / world.mass_kg(b)),
    }
}

/// Bounds of the collision's length and of the energy.
fn check(outcome: &Outcome, length: f64, energy: f64) {
    assert!(outcome.passes > 0 && outcome.velocities[0] < 0.0, "{outcome:?}");
    assert!(outcome.duration_error.abs() < length, "{outcome:?}");
    assert!(outcome.momentum_error < 1e-9, "{outcome:?}");
    assert!(outcome.energy_error < energy, "{outcome:?}");
    assert!(outcome.impulse_errors.iter().all(|e| *e < 1e-3), "{outcome:?}");
}

/// With ten elements along, the last bounce of the contact nodes scatters the end of the collision by some percent
/// with mesh and step; the elements are a tenth of the wave's way long.
const COARSE_LENGTH: f64 = 0.05;

#[test]
fn ten_elements_along_agree_with_wave_theory() {
    for kinematics in [Kinematics::Green, Kinematics::BodyFrame] {
        check(&collide(setup([[10, 2, 2], [10, 2, 2]], kinematics, 0.2)), COARSE_LENGTH, 0.01);
    }
    check(&collide(setup([[10, 1, 1], [10, 1, 1]], Kinematics::Green, 0.2)), COARSE_LENGTH, 0.01);
}

#[test]
fn meshes_whose_nodes_do_not_meet_do_as_well() {
    for kinematics in [Kinematics::Green, Kinematics::BodyFrame] {
        check(&collide(setup([[10, 2, 2], [10, 3, 3]], kinematics, 0.2)), COARSE_LENGTH, 0.01);
    }
}

#[test]
fn forty_elements_along_agree_better() {
    check(&collide(setup([[40, 4, 4], [40, 5, 5]], Kinematics::Green, 0.2)), 0.015, 0.005);
}

#[test]
fn zz_sweep() {
    let cases: Vec<[[u32; 3]; 2]> = vec![
        [[10, 1, 1], [10, 1, 1]],
        [[10, 2, 2], [10, 2, 2]],
        [[10, 2, 2], [10, 3, 3]],
        [[10, 1, 1], [10, 2, 2]],
        [[10, 1, 1], [8, 2, 3]],
        [[10, 3, 2], [12, 3, 4]],
    ];
    for cells in cases {
        for cfl in [0.3, 0.6] {
            for k in [Kinematics::Green] {
                let o = collide(setup(cells, k, cfl));
                println!(
                    "{cells:?} {cfl} {k:?} end={:.2} pulse={:.2} dE={:.2} passes={} ch={:.1e} v={:.4} {:.4} n={}",
                    100.0 * o.end_error,
                    100.0 * o.pulse_error,
                    100.0 * o.energy_error,
                    o.passes,
                    o.last_change,
                    o.velocities[0],
                    o.velocities[1],
                    o.n
                );
            }
        }
    }
}
#[test]
fn zz_one() {
    let mut world = World::new(setup([[10, 2, 2], [10, 2, 2]], Kinematics::Green, 0.3)).unwrap();
    let mut n = 0;
    run(&mut world, 2.0e-4, |_, s| {
        n += 1;
        println!(
            "S {n} t={:.3} dis={:.5} strain={:.4} kin={:.4} F={:.3e} pairs={} passes={} ch={:.1e}",
            s.step.time_s / 9.89e-5,
            s.dissipated_j,
            s.strain_j,
            s.kinetic_j,
            s.step.contact_force_n,
            s.step.contact_pairs,
            s.step.passes,
            s.step.last_change
        );
    });
}
