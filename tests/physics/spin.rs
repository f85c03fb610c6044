//! A free spinning box: angular momentum, energy, strain (METHOD 9).

use crate::build::{body, box_mesh, quiet_world, run, steel};
use glam::DVec3;
use hammerfall::sim::{BodyMotion, Kinematics, World};

#[derive(Debug)]
struct Spun {
    angular_momentum_error: f64,
    energy_error: f64,
    strain_energy_share: f64,
    drift_rad: f64,
    turns: f64,
}

fn spin(kinematics: Kinematics, revolutions: f64) -> Spun {
    // Slow enough for centrifugal strain to be small, fast enough for ten turns to be cheap.
    let spin = DVec3::new(0.0, 0.0, 2000.0);
    let mut cube = body("box", box_mesh(DVec3::new(0.1, 0.06, 0.04), [3, 2, 2], DVec3::ZERO), steel());
    cube.motion = BodyMotion::Deformable(kinematics);
    cube.spin_rad_s = spin;
    let mut setup = quiet_world(vec![cube]);
    setup.time.free_travel = false;
    setup.contact.self_collision = false;
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    let total = start.kinetic_j + start.strain_j;
    let mut spun = Spun {
        angular_momentum_error: 0.0,
        energy_error: 0.0,
        strain_energy_share: 0.0,
        drift_rad: 0.0,
        turns: 0.0,
    };
    let mut last = 0.0;
    let end_s = revolutions * std::f64::consts::TAU / spin.z;
    run(&mut world, end_s, |world, s| {
        let change = (s.angular_momentum_kg_m2_s - start.angular_momentum_kg_m2_s).length();
        spun.angular_momentum_error =
            spun.angular_momentum_error.max(change / start.angular_momentum_kg_m2_s.length());
        spun.energy_error = spun.energy_error.max(((s.kinetic_j + s.strain_j) / total - 1.0).abs());
        spun.strain_energy_share = spun.strain_energy_share.max(s.strain_j / total);
        let turn = world.body_pose(0).0 * glam::DVec3::X;
        let angle = turn.y.atan2(turn.x);
        spun.turns +=
            (angle - last + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        last = angle;
    });
    spun.turns /= std::f64::consts::TAU;
    spun.drift_rad = world.frame_drift_rad(0);
    spun
}

#[test]
fn ten_revolutions_keep_momentum_and_energy() {
    for kinematics in [Kinematics::Green, Kinematics::BodyFrame] {
        println!("{kinematics:?}: {:?}", spin(kinematics, 10.0));
    }
}
