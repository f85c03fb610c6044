//! A free spinning box: angular momentum, energy, strain (METHOD 9).

use crate::build::{body, box_mesh, quiet_world, run, steel};
use glam::DVec3;
use hammerfall::sim::{BodyMotion, Kinematics, World};
use std::f64::consts::{PI, TAU};

const SPIN_RAD_S: f64 = 2000.0;

#[derive(Debug, Default)]
struct Spun {
    angular_momentum_error: f64,
    energy_error: f64,
    strain_share: f64,
    turns: f64,
}

/// Ten revolutions of a steel box about its short axis, elastic all the while.
fn spin(kinematics: Kinematics) -> Spun {
    let mut cube = body("box", box_mesh(DVec3::new(0.1, 0.06, 0.04), [3, 2, 2], DVec3::ZERO), steel());
    cube.motion = BodyMotion::Deformable(kinematics);
    cube.spin_rad_s = DVec3::Z * SPIN_RAD_S;
    let mut setup = quiet_world(vec![cube]);
    setup.time.free_travel = false;
    setup.contact.self_collision = false;
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    let mut spun = Spun::default();
    let mut last = 0.0;
    run(&mut world, 10.0 * TAU / SPIN_RAD_S, |world, s| {
        let change = (s.angular_momentum_kg_m2_s - start.angular_momentum_kg_m2_s).length();
        let relative = change / start.angular_momentum_kg_m2_s.length();
        spun.angular_momentum_error = spun.angular_momentum_error.max(relative);
        let energy = (s.kinetic_j + s.strain_j) / start.kinetic_j - 1.0;
        spun.energy_error = spun.energy_error.max(energy.abs());
        spun.strain_share = spun.strain_share.max(s.strain_j / start.kinetic_j);
        let axis = world.body_pose(0).0 * DVec3::X;
        let angle = axis.y.atan2(axis.x);
        spun.turns += ((angle - last + PI).rem_euclid(TAU) - PI) / TAU;
        last = angle;
    });
    spun
}

/// Strain over kinetic energy of a bar of half length `a` in equilibrium with its centrifugal force is
/// `(2/5) (omega a / c)^2`: stress `rho omega^2 (a^2 - x^2)/2`, energy `integral of stress^2/2E`, over `rho omega^2 a^3/3`
/// per area. A load put on at once swings to twice the displacement, four times the energy.
fn most_centrifugal_share() -> f64 {
    let c2 = 206.82e9 / 7844.0;
    4.0 * 0.4 * (SPIN_RAD_S * 0.05).powi(2) / c2
}

#[test]
fn green_keeps_momentum_to_round_off_and_energy() {
    let spun = spin(Kinematics::Green);
    assert!(spun.angular_momentum_error < 1e-9, "{spun:?}");
    assert!(spun.energy_error < 1e-4, "{spun:?}");
    assert!((spun.turns - 10.0).abs() < 0.01, "{spun:?}");
    assert!(spun.strain_share < most_centrifugal_share(), "{spun:?}");
}

#[test]
fn body_frame_keeps_momentum_and_energy_nearly() {
    let spun = spin(Kinematics::BodyFrame);
    assert!(spun.angular_momentum_error < 1e-4, "{spun:?}");
    assert!(spun.energy_error < 1e-4, "{spun:?}");
    assert!((spun.turns - 10.0).abs() < 0.01, "{spun:?}");
    assert!(spun.strain_share < most_centrifugal_share(), "{spun:?}");
}
