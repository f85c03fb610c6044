//! The scenes that ship, and what building makes of a sound one.

use super::*;

#[test]
fn every_shipped_scene_builds() {
    for builtin in BUILTIN_SCENES {
        let scene = Scene::load(builtin.name, &[]).unwrap_or_else(|e| panic!("{}: {e}", builtin.name));
        let moving = |motion: &BodyMotion| matches!(motion, BodyMotion::Deformable(_));
        assert!(scene.setup.bodies.iter().any(|body| moving(&body.motion)));
        let summary = summary_of(&scene);
        assert!(summary.step_s() > 0.0 && summary.step_s().is_finite());
        assert!(scene.description.recording.start_s < scene.description.duration_s);
        let picture_s = scene.description.duration_s - scene.description.recording.start_s;
        let shown_s = picture_s * scene.description.recording.slow_motion;
        assert!((2.0..=6.0).contains(&shown_s), "{}: a GIF of {shown_s} s", builtin.name);
    }
}

#[test]
fn fine_scenes_differ_in_resolution_only() {
    for builtin in BUILTIN_SCENES {
        let Some(fine) = BUILTIN_SCENES.iter().find(|s| s.name == format!("{}-fine", builtin.name)) else {
            continue;
        };
        let [coarse, fine] = [builtin.name, fine.name].map(|name| Scene::load(name, &[]).unwrap());
        let elements = |scene| summary_of(scene).elements();
        assert!(elements(&fine) > 3 * elements(&coarse), "{}", fine.name);
        // A fine pile under a flat press fails everywhere at once: to show one band it is pressed in another way.
        if builtin.name == "pile-press" {
            continue;
        }
        // A coarse mesh smooths the peaks of stress: to break under the same blow its plate has to be weaker.
        let is_plate = builtin.name.starts_with("plate-");
        let materials = |body: &BodySetup| -> Vec<Material> {
            let of =
                |m: &Material| Material { fracture: m.fracture.clone().filter(|_| !is_plate), ..m.clone() };
            body.materials.iter().map(of).collect()
        };
        for (a, b) in coarse.setup.bodies.iter().zip(&fine.setup.bodies) {
            assert_eq!((&a.name, materials(a), &a.motion), (&b.name, materials(b), &b.motion));
            let laws = |body: &BodySetup| -> Vec<_> {
                let rules =
                    body.materials.iter().filter_map(|m| m.fracture.as_ref()).flat_map(Criterion::rules);
                rules.map(|rule| (std::mem::discriminant(&rule.strength), rule.plane)).collect()
            };
            assert_eq!(laws(a), laws(b));
            assert_eq!((a.velocity_m_s, a.spin_rad_s), (b.velocity_m_s, b.spin_rad_s));
        }
        assert_eq!(coarse.setup.contact, fine.setup.contact);
        // Five elements tell a blow truly only in steps far below their stable one.
        let time = |scene: &Scene| {
            let mut time = scene.setup.time.clone();
            if builtin.name == "cube-wall" {
                time.cfl = fine.setup.time.cfl;
            }
            time
        };
        assert_eq!(time(&coarse), time(&fine));
        assert_eq!(coarse.description.cameras, fine.description.cameras);
    }
}

/// METHOD 8, V1: the numbers of the published case.
#[test]
fn rods_collision_has_the_published_numbers() {
    let scene = Scene::load("rods-collision", &[]).unwrap();
    let [left, right] = &scene.setup.bodies[..] else { panic!("two rods") };
    let (left_low, left_high) = left.mesh.bounds_m().unwrap();
    let (right_low, right_high) = right.mesh.bounds_m().unwrap();
    assert!((right_low.x - left_high.x - 2.54e-5).abs() < 1e-15);
    let close = |size: glam::DVec3, expected: [f64; 3]| {
        (size - glam::DVec3::from(expected)).abs().max_element() < 1e-15
    };
    assert!(close(left_high - left_low, [0.254, 0.0254, 0.0254]));
    assert!(close(right_high - right_low, [0.254, 0.0254, 0.0224]));
    let centre = left_low + left_high + right_low + right_high;
    assert!(centre.abs().max_element() < 1e-15, "one axis, symmetric");
    assert_eq!((left.velocity_m_s.x, right.velocity_m_s.x), (5.1359, -5.1359));
    let material = &left.materials[0];
    assert_eq!(material.density_kg_m3, 7844.0);
    assert_eq!(material.youngs_modulus_pa, 206.82e9);
    assert_eq!((material.poisson_ratio, material.damping_per_s), (0.0, 0.0));
    assert_eq!(scene.setup.gravity_m_s2, glam::DVec3::ZERO);
    assert_eq!(scene.setup.contact.friction_coefficient, 0.0);
    assert!(scene.setup.time.free_travel);
    let layers = |mesh: &hammerfall::mesh::TetMesh| {
        let mut x: Vec<i64> = mesh.nodes_m.iter().map(|n| (n.x * 1e9).round() as i64).collect();
        x.sort_unstable();
        x.dedup();
        x.len() - 1
    };
    assert_eq!(layers(&left.mesh), 10);
    let fine = Scene::load("rods-collision-fine", &[]).unwrap();
    assert_eq!(layers(&fine.setup.bodies[0].mesh), 40);
}

#[test]
fn bodies_on_others_touch_and_do_not_overlap() {
    let scene = Scene::load("incline", &["bodies.ramp.rotation.degrees=37.3".to_owned()]).unwrap();
    let [ramp, block] = &scene.setup.bodies[..] else { panic!("a ramp and a block") };
    assert_eq!(overlap(&ramp.mesh, &block.mesh), None);
    let mut pushed = block.mesh.clone();
    for node in &mut pushed.nodes_m {
        node.z -= 1e-4;
    }
    let found = overlap(&ramp.mesh, &pushed).expect("a tenth of a millimetre is an overlap");
    assert!((found.depth_m - 1e-4 * 37.3f64.to_radians().cos()).abs() < 1e-7);
}

/// The example of README: mesh files of others, of steel or of rubber by one override.
#[test]
fn the_example_with_mesh_files_builds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes/tet");
    if !folder.is_dir() {
        let text = format!(
            "\n*** The real mesh files are absent ({}): NOTHING IS TESTED HERE. ***\n",
            folder.display()
        );
        assert!(std::env::var_os("CI").is_none(), "{text}");
        // Not by `eprintln!`, which the test harness keeps to itself unless the test fails.
        let _ = writeln!(std::io::stderr(), "{text}");
        return;
    }
    let text = include_str!("../../assets/scenes/examples/hammer-on-table-mesh.toml");
    let load = |overrides: &[String]| {
        Scene::from_text("example", text, &folder, overrides).unwrap_or_else(|e| panic!("{e}"))
    };
    let steel = load(&[]);
    let rubber = load(&["materials.stuff.preset=rubber".to_owned()]);
    let [steel_summary, rubber_summary] = [&steel, &rubber].map(summary_of);
    let counts: Vec<usize> = steel_summary.bodies.iter().map(|body| body.elements).collect();
    assert_eq!(counts, [6, 17_004, 9_683]);
    assert!(rubber_summary.step_s() > 20.0 * steel_summary.step_s());
    let added = |summary: &SceneSummary| {
        let hammer = &summary.bodies[2];
        hammer.added_mass_kg / hammer.mass_kg
    };
    assert!((added(&steel_summary) - 0.02).abs() < 1e-6 && (added(&rubber_summary) - 0.02).abs() < 1e-6);
    let unscaled = load(&["bodies.hammer.mass_scaling=0".to_owned()]);
    assert!(summary_of(&unscaled).step_s() < 0.2 * steel_summary.step_s(), "slivers dictate the step");
    let (low, high) = steel.setup.bodies[1].mesh.bounds_m().unwrap();
    assert!(low.z.abs() < 1e-12 && (high.z - 0.70).abs() < 0.01, "it stands: {low} {high}");
}

/// Sides by letters are the shape's own, `top` and `bottom` the world's.
#[test]
fn sides_and_regions_choose_the_right_nodes() {
    let text = r#"title = "t"
[[bodies]]
name = "rod"
shape = { type = "rod", length = 1, width = 0.1, height = 0.1, cells = [10, 1, 1] }
material = "rubber"
rotation = { axis = [0, 1, 0], degrees = -90 }
boundary = [
    { at = "x-max", fixed = true },
    { at = "bottom", fixed = true, axes = "z" },
    { at = { side = "left", depth = 0.25 }, force = [0, 0, 1] },
]
[[bodies]]
name = "hammer"
shape = { type = "hammer" }
material = { handle = "wood", head = "steel" }
position = [3, 0, 0]
[time]
duration = 1
"#;
    let scene = build(text, &[]).unwrap();
    let rod = &scene.setup.bodies[0];
    let heights = |boundary: usize| {
        let nodes = rod.boundary[boundary].nodes.iter();
        nodes.map(|&node| (rod.mesh.nodes_m[node as usize].z * 10.0).round() as i64).collect::<Vec<_>>()
    };
    assert_eq!(heights(0), [5; 4], "the end at +x was turned up");
    assert_eq!(heights(1), [-5; 4]);
    let mut layer = heights(2);
    layer.sort_unstable();
    layer.dedup();
    assert_eq!(layer, [-5, -4, -3]);
    let axes = [false, false, true];
    assert_eq!(rod.boundary[1].action, BoundaryAction::Fixed { axes });

    let hammer = &scene.setup.bodies[1];
    for (element, &region) in hammer.mesh.regions.iter().enumerate() {
        let material = &hammer.materials[hammer.element_material[element] as usize].name;
        let expected = if hammer.mesh.region_names[region as usize] == "head" { "steel" } else { "wood" };
        assert_eq!(material, expected);
    }
}
