//! Where and when cracks start: a notched beam (METHOD 8, F1), a bar under sudden tension.

use super::super::specimen::{body, box_mesh, material, moved, nodes_where, quiet_world};
use super::super::{CaseError, Effort, Outcome, Quantity};
use super::waves;
use crate::fracture::{Criterion, Strength};
use crate::scene::Scene;
use crate::sim::{BoundaryAction, World, WorldSetup};
use glam::DVec3;

/// Of the shipped notched beams: reach of the load beyond the corner nearer to the clamp, where its arc meets the
/// notch's floor; height below the notch; place of the corner along the beam, m.
const ARM_M: f64 = 0.6;
const WEB_M: f64 = 0.1;
const CORNER_M: f64 = -0.1;
const STRENGTH_PA: f64 = 2e5;

/// Steps until the first crack.
pub(super) fn run_to_crack(
    effort: &Effort,
    world: &mut World,
    end_s: f64,
    name: &str,
) -> Result<(), CaseError> {
    effort.run_while(
        world,
        |world, _| world.sample().crack_area_m2 == 0.0 && world.time_s() < end_s,
        end_s,
    )?;
    if world.sample().crack_area_m2 == 0.0 {
        return Err(CaseError::Unmeasured(format!("{name} never breaks")));
    }
    Ok(())
}

/// Mean place of a body's crack faces in its reference shape, m.
pub(super) fn crack_place_m(world: &World, body: usize) -> DVec3 {
    let reference_m = world.reference_positions_m(body);
    let faces: Vec<DVec3> = world
        .crack_faces(body)
        .map(|face| face.nodes.iter().map(|n| reference_m[*n as usize]).sum::<DVec3>() / 3.0)
        .collect();
    faces.iter().sum::<DVec3>() / faces.len() as f64
}

/// A shipped notched beam of another width, its load in proportion, and how fast the load grows, N/s.
fn notched(scene: &str, width_m: f64) -> Result<(WorldSetup, f64), CaseError> {
    let mut setup = Scene::load(scene, &[format!("bodies.beam.shape.width={width_m}")])?.setup;
    let mut load_n_s = 0.0;
    for condition in &mut setup.bodies[0].boundary {
        if let BoundaryAction::Force { total_n, ramp_s } = &mut condition.action {
            *total_n *= width_m / 0.2;
            load_n_s = total_n.length() / *ramp_s;
        }
    }
    Ok((setup, load_n_s))
}

pub(in crate::verify) fn measure_notch(effort: &Effort) -> Result<Outcome, CaseError> {
    const WIDTH_M: f64 = 0.02;
    const END_S: f64 = 6.0;
    let (setup, load_n_s) = notched("beam-notch-fine", WIDTH_M)?;
    let mut world = World::new(setup)?;
    run_to_crack(effort, &mut world, END_S, "beam-notch-fine")?;
    let load_n = world.time_s() * load_n_s;
    let place_m = crack_place_m(&world, 0).x;
    let (setup, _) = notched("beam-notch", 0.2)?;
    let mut coarse = World::new(setup)?;
    run_to_crack(effort, &mut coarse, END_S, "beam-notch")?;
    Ok(vec![
        Quantity::relative(
            "beam-notch-fine: load at the first crack",
            "N",
            load_n,
            STRENGTH_PA * WIDTH_M * WEB_M.powi(2) / 6.0 / ARM_M,
        )
        .by("sigma = M y/I below the corner nearer the clamp (METHOD 8, F1)")
        .within(
            0.15,
            "the arc concentrates stress by 1.13 or more, elements of constant strain see less of it",
        ),
        Quantity::absolute("beam-notch-fine: place of the first crack", "m", place_m, CORNER_M)
            .by("the corner nearer the clamp, which bears the larger moment (METHOD 8, F1)")
            .within(0.5 * WEB_M, "half the height below the notch; the other corner is 0.2 m away"),
        Quantity::absolute(
            "beam-notch: first crack beyond the middle",
            "m",
            crack_place_m(&coarse, 0).x.max(0.0),
            0.0,
        )
        .by("on the side of the clamp (METHOD 8, F1)")
        .within(0.0, "a side is a side"),
    ]
    .into())
}

/// A bar whose ends are pulled suddenly: each sends a tension of `rho c v`; where they meet, in the middle after
/// `L/2c`, there is twice that, and only that exceeds the strength (K. F. Graff, *Wave Motion in Elastic Solids*, 1975,
/// 2.1; H. Kolsky, *Stress Waves in Solids*, 1953, on spalling).
pub(in crate::verify) fn measure_spall(effort: &Effort) -> Result<Outcome, CaseError> {
    /// Above the overshoot of a front in a row of masses, 1.3, and below 2.
    const STRENGTH_OVER_STRESS: f64 = 1.4;
    const SPEED_M_S: f64 = 0.1;
    let along = if effort.quick { 80 } else { 160 };
    let (density, young_pa) = (2000.0, 2e9);
    let (length_m, width_m) = (1.0, 2.0 / f64::from(along));
    let c_m_s: f64 = waves::bar_speed_m_s(young_pa, density);
    let stress_pa = density * c_m_s * SPEED_M_S;
    let mesh = box_mesh(DVec3::new(length_m, width_m, width_m), [along, 2, 2], DVec3::ZERO)?;
    let ends = [-1.0, 1.0].map(|side| {
        let nodes = nodes_where(&mesh, |x| side * x.x > 0.5 * length_m - 1e-9);
        moved(nodes, DVec3::X * side * SPEED_M_S, [true, false, false])
    });
    let mut brittle = material(density, young_pa, 0.0);
    let strength = Strength::Tensile { tensile_strength_pa: STRENGTH_OVER_STRESS * stress_pa };
    brittle.fracture = Some(Criterion::single(strength).map_err(|e| CaseError::Unmeasured(e.to_string()))?);
    let mut bar = body("bar", mesh, brittle);
    bar.boundary = ends.into();
    let mut world = World::new(quiet_world(vec![bar]))?;
    let meeting_s = 0.5 * length_m / c_m_s;
    run_to_crack(effort, &mut world, 3.0 * meeting_s, "the bar")?;
    let element = 1.0 / f64::from(along);
    Ok(vec![
        Quantity::absolute(
            "place of the first crack / length",
            "",
            crack_place_m(&world, 0).x / length_m,
            0.0,
        )
        .by("the middle, where the two waves meet (Graff 1975, 2.1)")
        .within(2.5 * element.max(1.0 / 80.0), "two elements, about the width of the front"),
        Quantity::relative("time of the first crack", "s", world.time_s(), meeting_s)
            .by("L/2c, c = sqrt(E/rho)")
            .within(0.05, "the front of a row of masses is (x h^2/8)^(1/3) wide (Airy; Brillouin 1946): 2 to 4 % of the way"),
    ]
    .into())
}
