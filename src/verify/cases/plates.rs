//! How the cracks lie in a plate that a cube falls on (METHOD 8, F4 to F6).
//!
//! By tension they lie flat, one above the other: after the blow the plate springs back up while its bottom is held. By shear they run in
//! two families that cross, at 45 degrees to the pressure from above by Tresca's law and steeper by Mohr and Coulomb's.

use super::super::cracks::{Cracks, PlaneWatch};
use super::super::{CaseError, Effort, Outcome, Quantity};
use crate::scene::Scene;
use crate::sim::World;
use glam::DVec2;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Time between looks for elements that fail, s.
const EVERY_S: f64 = 1e-4;

/// How a plate has failed.
struct Pattern {
    /// By element that failed, of those that the mesh had at the start: steepness of its plane when it first did, degrees.
    planes_deg: Vec<f64>,
    cracks: Cracks,
    /// Where the cube lands.
    cube_m: DVec2,
}

impl Pattern {
    fn of(effort: &Effort, scene: &str) -> Result<Self, CaseError> {
        const PLATE: usize = 0;
        const CUBE: usize = 1;
        let scene = Scene::load(scene, &[])?;
        let mut planes = PlaneWatch::new(&scene, PLATE)?;
        let (low_m, high_m) = scene.setup.bodies[CUBE]
            .mesh
            .bounds_m()
            .ok_or_else(|| CaseError::Unmeasured("there is no cube".to_owned()))?;
        let elements = scene.setup.bodies[PLATE].mesh.tets.len();
        let mut world = World::new(scene.setup)?;
        let mut next_s = 0.0;
        effort.run(&mut world, scene.description.duration_s, |world, report| {
            if report.time_s >= next_s {
                next_s = report.time_s + EVERY_S;
                if world.crack_faces(PLATE).next().is_some() {
                    planes.look(world);
                }
            }
        })?;
        let mut first_deg = BTreeMap::new();
        for (element, plane_deg) in planes.seen_deg()?.into_iter().filter(|(element, _)| *element < elements)
        {
            first_deg.entry(element).or_insert(plane_deg);
        }
        let cube_m = 0.5 * (low_m + high_m).truncate();
        Ok(Self { planes_deg: first_deg.into_values().collect(), cracks: Cracks::of(&world, PLATE), cube_m })
    }
}

/// Share of the planes below 45 degrees, were their directions random.
const AT_RANDOM: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let scenes = ["plate-tensile-fine", "plate-mohr-coulomb-fine", "plate-tresca-fine"];
    let patterns: Result<Vec<Pattern>, CaseError> =
        scenes.par_iter().map(|scene| Pattern::of(effort, scene)).collect();
    let mut all = Vec::new();
    for (pattern, scene) in patterns?.iter().zip(scenes) {
        let is_torn = scene == scenes[0];
        let quantity =
            |of: &str, value: f64, all: f64| Quantity::absolute(format!("{scene}: {of}"), "", value, all);
        let flat = pattern.planes_deg.iter().filter(|plane_deg| **plane_deg < 45.0).count();
        let planes = quantity(
            "share of failing elements whose planes are below 45 degrees",
            flat as f64 / pattern.planes_deg.len() as f64,
            if is_torn { 1.0 } else { AT_RANDOM },
        );
        let area_m2 = pattern.cracks.area_m2();
        let lying = quantity(
            "share of crack area within 30 degrees of flat",
            pattern.cracks.at(0.0..30.0).area_m2() / area_m2,
            if is_torn { 1.0 } else { 0.0 },
        )
        .by("stacked, nearly parallel by tension only (METHOD 8, F4 to F6)");
        if is_torn {
            let reason = "around the cube the plate is torn upwards too";
            all.push(
                planes.by("stacked, nearly parallel (METHOD 8, F4); at random 0.29").within(0.2, reason),
            );
            let reason = "cracks prefer the faces of their mesh, and rings around the cube stand upright; at random 0.13";
            all.push(lying.within(0.65, reason));
            continue;
        }
        all.push(
            planes
                .by("as at random or fewer: pressure from above shears on planes at 45 degrees and steeper"),
        );
        all.push(lying.within(0.28, "at random 0.13; the cube's edges lift the top of the plate off"));
        let inclined = pattern.cracks.at(25.0..75.0);
        let sloping = quantity("share of crack area at 25 to 75 degrees", inclined.area_m2() / area_m2, 1.0);
        all.push(sloping.by("along the directions of largest shear (METHOD 8, F5 and F6)"));
        let away_m2 = inclined.falling_away_from(pattern.cube_m).area_m2();
        let family =
            quantity("share of those that fall away from the cube", away_m2 / inclined.area_m2(), 0.5);
        all.push(
            family
                .by("two families that cross (METHOD 8, F5 and F6)")
                .within(0.25, "either has at least a quarter"),
        );
    }
    Ok(all.into())
}
