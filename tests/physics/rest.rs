//! Resting, sliding, bouncing.

use crate::build::{body, box_mesh, fixed, material, rubber, run};
use glam::{DQuat, DVec3};
use hammerfall::sim::{World, WorldSetup};

const G: f64 = 9.81;

fn ground() -> hammerfall::sim::BodySetup {
    fixed("ground", box_mesh(DVec3::new(4.0, 4.0, 0.2), [1, 1, 1], DVec3::new(0.0, 0.0, -0.1)))
}

fn world(bodies: Vec<hammerfall::sim::BodySetup>) -> WorldSetup {
    WorldSetup { bodies, gravity_m_s2: DVec3::NEG_Z * G, ..WorldSetup::default() }
}

#[test]
fn a_dropped_rubber_cube_balances() {
    let mut cube = body("cube", box_mesh(DVec3::splat(0.1), [2, 2, 2], DVec3::Z * 0.3), rubber());
    cube.spin_rad_s = DVec3::new(1.0, 2.0, 0.5);
    let mut world = World::new(world(vec![ground(), cube])).unwrap();
    let start = world.sample().balance_j();
    let clock = std::time::Instant::now();
    let mut worst: f64 = 0.0;
    let mut next = 0.0;
    run(&mut world, 1.0, |w, s| {
        worst = worst.max((s.balance_j() - start).abs());
        if w.time_s() >= next {
            next += 0.05;
            println!(
                "t {:.3} {:?} ke {:.4} se {:.4} pe {:.4} dis {:.4} bal {:.5} pairs {} pass {} pen {:.2e}",
                w.time_s(),
                s.step.stage,
                s.kinetic_j,
                s.strain_j,
                s.potential_j,
                s.dissipated_j,
                s.balance_j() - start,
                s.step.contact_pairs,
                s.step.passes,
                s.step.max_penetration_ratio
            );
        }
    });
    println!(
        "steps {} wall {:?} worst {worst} pen {}",
        world.steps(),
        clock.elapsed(),
        world.largest_penetration_ratio()
    );
}

#[test]
fn incline() {
    for (mu, degrees) in [(0.5, 20.0_f64), (0.3, 30.0)] {
        let angle = degrees.to_radians();
        let tilt = DQuat::from_rotation_y(angle);
        let mut ramp = fixed("ramp", box_mesh(DVec3::new(40.0, 2.0, 0.2), [1, 1, 1], DVec3::Z * -0.1));
        let mut block =
            body("block", box_mesh(DVec3::new(0.2, 0.2, 0.1), [2, 2, 1], DVec3::new(-10.0, 0.0, 0.05)), {
                let mut m = material(1000.0, 1e7, 0.3);
                m.damping_per_s = 200.0;
                m
            });
        for b in [&mut ramp, &mut block] {
            b.mesh.nodes_m.iter_mut().for_each(|x| *x = tilt * *x);
        }
        let mut setup = world(vec![ramp, block]);
        setup.contact.friction_coefficient = mu;
        setup.time.sleeping = false;
        let mut world = World::new(setup).unwrap();
        let start = world.body_pose(1).1;
        let clock = std::time::Instant::now();
        run(&mut world, 1.0, |_, _| {});
        let down = tilt * DVec3::X;
        let moved = (world.body_pose(1).1 - start).dot(down);
        let speed = world.body_momentum_kg_m_s(1).dot(down) / world.mass_kg(1);
        let a = G * (angle.sin() - mu * angle.cos()).max(0.0);
        println!(
            "incline mu {mu} {degrees}: moved {moved:e} speed {speed} theory v {a} x {} steps {} {:?}",
            a / 2.0,
            world.steps(),
            clock.elapsed()
        );
    }
}

#[test]
fn stack() {
    for (cfl, cons) in [(0.8, false), (0.5, true), (0.5, false), (0.25, true)] {
        println!("t cfl {cfl} {cons}");
        let bodies = (0..10).map(|i| {
            let mut m = material(1000.0, 1e6, 0.3);
            m.damping_per_s = 50.0;
            body(
                &format!("cube{i}"),
                box_mesh(DVec3::splat(0.1), [2, 2, 2], DVec3::Z * (0.05 + 0.1 * i as f64)),
                m,
            )
        });
        let mut setup = world(std::iter::once(ground()).chain(bodies).collect());
        setup.contact.friction_coefficient = 0.5;
        setup.time.cfl = cfl;
        setup.contact.method = hammerfall::sim::ContactMethod::Lagrange {
            passes: 3,
            tolerance: 1e-4,
            conserve_impact_energy: cons,
        };
        let mut world = World::new(setup).unwrap();
        let clock = std::time::Instant::now();
        let mut next = 0.0;
        run(&mut world, 1.5, |w, s| {
            if w.time_s() >= next {
                next += 0.3;
                println!(
                    "t {:.3} {:?} ke {:.3e} se {:.4} pe {:.4} dis {:.4} pairs {} pass {} pen {:.2e} top {}",
                    w.time_s(),
                    s.step.stage,
                    s.kinetic_j,
                    s.strain_j,
                    s.potential_j,
                    s.dissipated_j,
                    s.step.contact_pairs,
                    s.step.passes,
                    s.step.max_penetration_ratio,
                    w.body_pose(10).1
                );
            }
        });
        println!("steps {} wall {:?}", world.steps(), clock.elapsed());
    }
}
