//! A block on a slope, as Coulomb says (METHOD 9).

use super::super::specimen::{GRAVITY_M_S2, body, box_mesh, fixed, heavy_world, material};
use super::super::{CaseError, Effort, Outcome, Quantity};
use crate::sim::{World, WorldSetup};
use glam::{DQuat, DVec3};

/// Side of the block along the slope, m.
pub const SIDE_M: f64 = 0.2;

/// A block on an incline, and how the incline is turned. The block is the body with number 1.
///
/// # Errors
/// [`CaseError`] when there are no such meshes.
pub fn setup(friction_coefficient: f64, degrees: f64) -> Result<(WorldSetup, DQuat), CaseError> {
    let tilt = DQuat::from_rotation_y(degrees.to_radians());
    let mut ramp = fixed("ramp", box_mesh(DVec3::new(40.0, 2.0, 0.2), [1, 1, 1], DVec3::Z * -0.1)?);
    let place = DVec3::new(-10.0, 0.0, 0.05);
    let mut soft = material(1000.0, 1e7, 0.3);
    soft.damping_per_s = 200.0;
    let mut block = body("block", box_mesh(DVec3::new(SIDE_M, SIDE_M, 0.1), [2, 2, 1], place)?, soft);
    for b in [&mut ramp, &mut block] {
        b.mesh.nodes_m.iter_mut().for_each(|x| *x = tilt * *x);
    }
    let mut setup = heavy_world(vec![ramp, block]);
    setup.contact.friction_coefficient = friction_coefficient;
    // A block that falls asleep sticks too easily.
    setup.time.sleeping = false;
    Ok((setup, tilt))
}

/// Way down the slope, m, and speed, m/s, after `end_s`.
fn slide(effort: &Effort, friction: f64, degrees: f64, end_s: f64) -> Result<(f64, f64), CaseError> {
    let (setup, tilt) = setup(friction, degrees)?;
    let mut world = World::new(setup)?;
    let start = world.body_pose(1).1;
    effort.run(&mut world, end_s, |_, _| {})?;
    let down = tilt * DVec3::X;
    let speed_m_s = world.body_momentum_kg_m_s(1).dot(down) / world.mass_kg(1);
    Ok(((world.body_pose(1).1 - start).dot(down), speed_m_s))
}

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let end_s = if effort.quick { 0.4 } else { 1.0 };
    let (crept_m, _) = slide(effort, 0.5, 20.0, end_s)?;
    let mut all = vec![
        Quantity::absolute("20 degrees, mu = 0.5: creep / side", "", crept_m / SIDE_M, 0.0)
            .by("Coulomb: it sticks while tan a < mu (METHOD 9)")
            .within(1e-4, "the elastic give of the contact layer, rho g h/E = 1e-4"),
    ];
    for (degrees, mu) in [(30.0_f64, 0.3), (25.0, 0.1), (15.0, 0.0)] {
        let (_, speed_m_s) = slide(effort, mu, degrees, end_s)?;
        let (sin, cos) = degrees.to_radians().sin_cos();
        all.push(
            Quantity::relative(
                format!("{degrees} degrees, mu = {mu}: acceleration"),
                "m/s2",
                speed_m_s / end_s,
                GRAVITY_M_S2 * (sin - mu * cos),
            )
            .by("g (sin a - mu cos a) (METHOD 9)")
            .within(0.01, "the last step ends up to 0.2 % late; landing takes some steps"),
        );
    }
    Ok(all.into())
}
