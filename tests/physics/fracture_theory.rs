//! Where, when and how cracks start, against beam theory and Mohr and Coulomb's planes (METHOD 8, F1 and F2).

use glam::DVec3;
use hammerfall::fracture::PrincipalStress;
use hammerfall::scene::Scene;
use hammerfall::sim::{BoundaryAction, World};

/// Of the shipped notched beams: reach of the load beyond the corner nearer to the clamp, where its arc meets the
/// notch's floor; height below the notch; place of the corner along the beam, m.
const ARM_M: f64 = 0.6;
const WEB_M: f64 = 0.1;
const CORNER_M: f64 = -0.1;
const STRENGTH_PA: f64 = 2e5;

/// Reference positions of the corners of a body's crack faces, m.
fn crack_faces_m(world: &World, body: usize) -> Vec<[DVec3; 3]> {
    let reference_m = world.reference_positions_m(body);
    world.crack_faces(body).map(|face| face.nodes.map(|n| reference_m[n as usize])).collect()
}

fn middle_m(corners_m: &[DVec3; 3]) -> DVec3 {
    corners_m.iter().sum::<DVec3>() / 3.0
}

/// Angle between a plane and the horizontal, degrees.
fn steepness_deg(normal: DVec3) -> f64 {
    normal.z.abs().min(1.0).acos().to_degrees()
}

/// A shipped notched beam of another width, its load in proportion, up to its first crack: the load over the one of
/// beam theory, `sigma = M y / I` in the section below the corner, and the mean place of the crack along the beam, m.
fn first_crack(scene: &str, width_m: f64) -> (f64, f64) {
    let overrides = [format!("bodies.beam.shape.width={width_m}")];
    let mut setup = Scene::load(scene, &overrides).unwrap().setup;
    let mut load_n_s = 0.0;
    for condition in &mut setup.bodies[0].boundary {
        if let BoundaryAction::Force { total_n, ramp_s } = &mut condition.action {
            *total_n *= width_m / 0.2;
            load_n_s = total_n.length() / *ramp_s;
        }
    }
    let mut world = World::new(setup).unwrap();
    while world.sample().crack_area_m2 == 0.0 {
        world.step(6.0).expect("the run stays finite");
        assert!(world.time_s() < 6.0, "{scene} never breaks");
    }
    let theory_n = STRENGTH_PA * width_m * WEB_M.powi(2) / 6.0 / ARM_M;
    let faces_m = crack_faces_m(&world, 0);
    let place_m = faces_m.iter().map(|face| middle_m(face).x).sum::<f64>() / faces_m.len() as f64;
    (world.time_s() * load_n_s / theory_n, place_m)
}

#[test]
fn a_notched_beam_cracks_at_the_load_and_place_of_beam_theory() {
    let (load, place_m) = first_crack("beam-notch-fine", 0.02);
    assert!((load - 1.0).abs() < 0.15, "{load} of the load of beam theory");
    assert!((place_m - CORNER_M).abs() < WEB_M / 2.0, "first crack at {place_m} m");
}

#[test]
fn the_coarsest_notched_beam_cracks_on_the_side_of_its_clamp() {
    // One layer of elements of constant strain hardly bends: the load is no measure here.
    let (_, place_m) = first_crack("beam-notch", 0.2);
    assert!(place_m < 0.0, "first crack at {place_m} m");
}

#[test]
fn a_pressed_pile_fails_on_the_planes_of_mohr_and_coulomb() {
    for friction_angle_deg in [0.0, 10.0, 20.0, 30.0] {
        let fracture = format!(
            "materials.concrete.fracture={{criterion=\"mohr-coulomb\",cohesion=1e6,friction_angle={friction_angle_deg}}}"
        );
        let failed_deg = first_planes_deg(&[fracture]);
        let expected_deg = 45.0 + friction_angle_deg / 2.0;
        assert!((failed_deg - expected_deg).abs() < 3.0, "{friction_angle_deg}: {failed_deg}");
    }
}

/// Mean steepness of the planes of all elements that fail up to the first crack of the shipped pile, degrees.
fn first_planes_deg(overrides: &[String]) -> f64 {
    const EVERY_S: f64 = 1e-4;
    let scene = Scene::load("pile-press", overrides).unwrap();
    let criterion = scene.setup.bodies[1].materials[0].fracture.clone().unwrap();
    let mut world = World::new(scene.setup).unwrap();
    let mut failed_deg = Vec::new();
    while world.sample().crack_area_m2 == 0.0 {
        let next_s = world.time_s() + EVERY_S;
        while world.time_s() < next_s && world.sample().crack_area_m2 == 0.0 {
            world.step(next_s).expect("the run stays finite");
        }
        assert!(world.time_s() < 0.2, "the pile never breaks");
        for element in world.element_stresses(1) {
            let stress = PrincipalStress::of(&element.cauchy_pa);
            let found = criterion.assess(&stress.measures()).unwrap();
            if found.fails() {
                failed_deg.push(steepness_deg(criterion.normal(found.rule, &stress, None)));
            }
        }
    }
    failed_deg.iter().sum::<f64>() / failed_deg.len() as f64
}
