//! How a pressed pile fails (METHOD 8, F2): the planes on which it starts to, the band that goes through it by Mohr and
//! Coulomb's law, the crack that runs along it by tension.

use super::super::cracks::{Cracks, PlaneWatch, steepness_deg};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity};
use super::fracture::{crack_place_m, run_to_crack};
use crate::scene::Scene;
use crate::sim::World;
use glam::DVec3;

/// Where the expected angles of Mohr and Coulomb's planes come from.
const PLANE_LAW: &str = "45 + phi/2 (METHOD 8, F2)";

/// Mean steepness of the planes of all elements that fail up to the first crack of the shipped pile, degrees.
fn first_planes_deg(effort: &Effort, fracture: &str) -> Result<f64, CaseError> {
    const EVERY_S: f64 = 1e-4;
    const END_S: f64 = 0.2;
    const PILE: usize = 1;
    let scene = Scene::load("pile-press", &[format!("materials.concrete.fracture={fracture}")])?;
    let mut planes = PlaneWatch::new(&scene, PILE)?;
    let mut world = World::new(scene.setup)?;
    let mut next_s = EVERY_S;
    effort.run_while(
        &mut world,
        |world, report| {
            let has_broken = world.sample().crack_area_m2 > 0.0;
            if has_broken || report.time_s >= next_s {
                next_s = report.time_s + EVERY_S;
                planes.look(world);
            }
            !has_broken && world.time_s() < END_S
        },
        END_S,
    )?;
    let failed_deg = planes.seen_deg()?;
    if failed_deg.is_empty() {
        return Err(CaseError::Unmeasured("no element of the pile failed".to_owned()));
    }
    Ok(failed_deg.iter().map(|(_, plane_deg)| plane_deg).sum::<f64>() / failed_deg.len() as f64)
}

/// Mean steepness of the first cracks of the shipped pile, by their area, degrees.
fn crack_steepness_deg(effort: &Effort, fracture: &str) -> Result<f64, CaseError> {
    const PILE: usize = 1;
    let scene = Scene::load("pile-press", &[format!("materials.concrete.fracture={fracture}")])?;
    let mut world = World::new(scene.setup)?;
    run_to_crack(effort, &mut world, scene.description.duration_s, "the pile")?;
    Ok(Cracks::of(&world, PILE).mean_steepness_deg())
}

pub(in crate::verify) fn measure_planes(effort: &Effort) -> Result<Outcome, CaseError> {
    let mut all = Vec::new();
    let (mut found, mut theory) = (Vec::new(), Vec::new());
    for phi_deg in [0.0, 10.0, 20.0, 30.0] {
        let fracture = format!("{{criterion=\"mohr-coulomb\",cohesion=1e6,friction_angle={phi_deg}}}");
        let plane_deg = first_planes_deg(effort, &fracture)?;
        let expected_deg = 45.0 + phi_deg / 2.0;
        all.push(
            Quantity::absolute(
                format!("Mohr-Coulomb, phi = {phi_deg}: plane to the horizontal"),
                "degrees",
                plane_deg,
                expected_deg,
            )
            .by(PLANE_LAW)
            .within(
                3.0,
                "friction of the press and the waves of its blow tilt principal stresses by some degrees",
            ),
        );
        found.push([phi_deg, plane_deg]);
        theory.push([phi_deg, expected_deg]);
    }
    let tensile_deg = crack_steepness_deg(effort, "{criterion=\"tensile\",tensile_strength=1e4}")?;
    all.push(
        Quantity::absolute("tensile: plane to the horizontal", "degrees", tensile_deg, 90.0)
            .by("normals nearly horizontal, cracks run up the pile (METHOD 8, F2)")
            .within(15.0, "the thesis says \"nearly\"; friction holds the ends of the pile, which tilts the tension there"),
    );
    let plot = Plot::new(
        "failure-plane",
        "Failure plane of a pressed pile",
        ["friction angle, degrees", "plane to the horizontal, degrees"],
    )
    .with("first planes", found)
    .with("45 + phi/2", theory);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// Angles of friction, degrees, and cohesions, MPa, at which a pile has one strength under pressure, 2.4 MPa
/// (`2 c cos phi/(1 - sin phi)`).
const OF_ONE_STRENGTH: [[f64; 2]; 4] = [[0.0, 1.2], [10.0, 1.007], [20.0, 0.84], [30.0, 0.693]];

/// Cells of piles that differ in nothing else, the shipped one first. A band prefers the lines of its mesh, and where it runs
/// hangs on which of many elements at their limit fails first, so one pile alone says little.
const MESHES: [[u32; 3]; 3] = [[16, 1, 40], [20, 1, 40], [16, 1, 50]];

/// The band's steepness when it first reaches over nine tenths of the shipped pile's width, degrees.
fn band_deg(effort: &Effort, [phi_deg, cohesion_mpa]: [f64; 2], cells: [u32; 3]) -> Result<f64, CaseError> {
    const WIDTH_M: f64 = 0.4;
    const REACH: f64 = 0.9;
    /// The scene ends when its own pile has failed; others of the same strength may take a little longer.
    const LONGER: f64 = 1.05;
    let fracture =
        format!("{{criterion=\"mohr-coulomb\",cohesion={cohesion_mpa}e6,friction_angle={phi_deg}}}");
    let overrides =
        [format!("materials.concrete.fracture={fracture}"), format!("bodies.pile.shape.cells={cells:?}")];
    let scene = Scene::load("pile-press-fine", &overrides)?;
    let end_s = LONGER * scene.description.duration_s;
    let mut world = World::new(scene.setup)?;
    let (mut area_m2, mut found_deg) = (0.0, None);
    effort.run_while(
        &mut world,
        |world, _| {
            let now_m2 = world.sample().crack_area_m2;
            if now_m2 > area_m2 {
                area_m2 = now_m2;
                let across = Cracks::of(world, 0)
                    .largest()
                    .filter(|band| band.bounds_m[1].x - band.bounds_m[0].x >= REACH * WIDTH_M);
                found_deg = across.map(|band| steepness_deg(band.normal_across(DVec3::Y)));
            }
            found_deg.is_none() && world.time_s() < end_s
        },
        end_s,
    )?;
    found_deg
        .ok_or_else(|| CaseError::Unmeasured(format!("no band goes through the pile of phi = {phi_deg}")))
}

pub(in crate::verify) fn measure_band(effort: &Effort) -> Result<Outcome, CaseError> {
    let mut all = Vec::new();
    let (mut found, mut theory) = (Vec::new(), Vec::new());
    for [phi_deg, cohesion_mpa] in OF_ONE_STRENGTH {
        let expected_deg = 45.0 + phi_deg / 2.0;
        let of_mesh = |cells: &[u32; 3]| band_deg(effort, [phi_deg, cohesion_mpa], *cells);
        let bands_deg = MESHES.iter().map(of_mesh).collect::<Result<Vec<f64>, CaseError>>()?;
        all.push(
            Quantity::absolute(
                format!("pile-press-fine, phi = {phi_deg}: band to the horizontal, mean of three meshes"),
                "degrees",
                bands_deg.iter().sum::<f64>() / bands_deg.len() as f64,
                expected_deg,
            )
            .by(PLANE_LAW)
            .within(8.0, "a band of some elements' width that has to find its way through a mesh"),
        );
        for ([across, _, up], band_deg) in MESHES.iter().zip(bands_deg) {
            let of = format!("phi = {phi_deg}, {across} x {up} cells: band to the horizontal");
            all.push(Quantity::absolute(of, "degrees", band_deg, expected_deg).by(PLANE_LAW));
            found.push([phi_deg, band_deg]);
        }
        theory.push([phi_deg, expected_deg]);
    }
    let plot = Plot::new(
        "failure-band",
        "Band of failure through a pressed pile",
        ["friction angle, degrees", "band to the horizontal, degrees"],
    )
    .with("best-fit plane of the crack", found)
    .with("45 + phi/2", theory);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// A load on the middle of a pile's top spreads on its way down and pulls the pile apart across its axis (Y. Guyon,
/// *Prestressed Concrete*, 1953; K. T. S. R. Iyengar, J. ACI 59, 1962: the end blocks of prestressed beams).
pub(in crate::verify) fn measure_split(effort: &Effort) -> Result<Outcome, CaseError> {
    const WIDTH_M: f64 = 0.4;
    const CELL_M: f64 = WIDTH_M / 17.0;
    const RUN_S: f64 = 0.01;
    let scene = Scene::load("pile-split", &[])?;
    let mut world = World::new(scene.setup)?;
    run_to_crack(effort, &mut world, scene.description.duration_s, "pile-split")?;
    let start_m = crack_place_m(&world, 0);
    let end_s = world.time_s() + RUN_S;
    effort.run(&mut world, end_s, |_, _| {})?;
    let cracks = Cracks::of(&world, 0);
    let none = || CaseError::Unmeasured("the crack has closed".to_owned());
    let band = cracks.largest().ok_or_else(none)?;
    Ok(vec![
        Quantity::absolute(
            "pile-split: mean angle of the cracks' normals to the horizontal",
            "degrees",
            90.0 - cracks.mean_steepness_deg(),
            0.0,
        )
        .by("across the tension: cracks run up the pile (METHOD 8, F2)")
        .within(20.0, "the thesis says \"nearly\""),
        Quantity::absolute(
            "pile-split: plane of the largest crack to the horizontal",
            "degrees",
            steepness_deg(band.normal()),
            90.0,
        )
        .by("along the axis of the load (METHOD 8, F2)")
        .within(8.0, "as for bands of sliding"),
        Quantity::absolute("pile-split: first crack beside the axis", "m", start_m.x, 0.0)
            .by("by symmetry")
            .within(CELL_M, "an element"),
    ]
    .into())
}
