//! Scenes as users meet them: the shipped ones build, wrong ones are refused with the place and the
//! reason, overrides reach every value, and nothing that can be typed makes the program panic.

#[path = "../fuzz/entries.rs"]
#[expect(dead_code, reason = "the other entries have their tests elsewhere")]
mod entries;
mod fuzzing;

use hammerfall::scene::{BUILTIN_SCENES, Location, Scene, SceneError, SceneSummary, overlap};
use hammerfall::sim::{BodyMotion, BoundaryAction, ContactMethod, World};
use std::io::Write as _;
use std::path::Path;

const STACK: &str = "stack";

/// A small sound scene; the tests add to it and break it.
const CUBE: &str = r#"title = "A cube"

[ground]

[[bodies]]
name = "cube"
shape = { type = "box", size = [1, 1, 1], cells = 2 }
material = "rubber"
on = "ground"

[time]
duration = 1
"#;

fn build(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    Scene::from_text("test.toml", text, Path::new("."), &overrides)
}

/// Problems as `line: message` or `--set text: message`.
fn problems(text: &str, overrides: &[&str]) -> Vec<String> {
    let Err(error) = build(text, overrides) else {
        return Vec::new();
    };
    error
        .problems()
        .iter()
        .map(|problem| match &problem.location {
            Location::Line { line, .. } => format!("{line}: {}", problem.message),
            Location::Override(text) => format!("--set {text}: {}", problem.message),
        })
        .collect()
}

/// Every expected problem is found (by its beginning, after `...` anywhere), and no other.
fn assert_problems(text: &str, overrides: &[&str], expected: &[&str]) {
    let found = problems(text, overrides);
    let matches = |found: &str, expected: &str| {
        let mut parts = expected.split("...");
        found.starts_with(parts.next().unwrap_or_default()) && parts.all(|part| found.contains(part))
    };
    let missing: Vec<_> = expected.iter().filter(|e| !found.iter().any(|f| matches(f, e))).collect();
    let extra: Vec<_> = found.iter().filter(|f| !expected.iter().any(|e| matches(f, e))).collect();
    assert!(
        missing.is_empty() && found.len() == expected.len(),
        "missing {missing:#?}\nextra {extra:#?}\nof {found:#?}"
    );
}

fn summary_of(scene: &Scene) -> SceneSummary {
    SceneSummary::of(scene, &World::new(scene.setup.clone()).unwrap())
}

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
        for (a, b) in coarse.setup.bodies.iter().zip(&fine.setup.bodies) {
            assert_eq!((&a.name, &a.materials, &a.motion), (&b.name, &b.materials, &b.motion));
            assert_eq!((a.velocity_m_s, a.spin_rad_s), (b.velocity_m_s, b.spin_rad_s));
        }
        assert_eq!(coarse.setup.contact, fine.setup.contact);
        assert_eq!(coarse.setup.time, fine.setup.time);
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
    let text = include_str!("../assets/scenes/examples/hammer-on-table-mesh.toml");
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

#[test]
fn all_problems_are_told_at_once_each_with_its_line() {
    let text = r##"titel = "x"
gravity = [0, 0]

[materials.glas]
density = -3
youngs_modulus = "70e9"
poisson_ratio = 0.5
colour = "#c04030"

[[bodies]]
name = "a"
shape = { type = "bx", size = [1, 1, 1] }
material = "glas"
friction = 0.3

[[bodies]]
name = "a"
shape = { type = "box", size = [1, 1, -1], cells = [1, 1.5, 1] }
material = "stel"
on = "b"
position = [0, nan]

[[bodies]]
name = "b"
shape = { type = "hammer" }
material = { head = "steel", handle = "wood" }
velocity = [1, 0, 0]
motion = "fixed"
rotation = { axis = [0, 0, 0], degrees = 3 }

[contact]
method = "penalty"
passes = 0

[[contact.pairs]]
bodies = ["a", "ground"]
friction = -1

[time]
duration = 0

[recording]
camera = "main"
"##;
    assert_problems(
        text,
        &["time.cfl=2", "materials.glas.damping=no"],
        &[
            "1: `title` is missing at the top of the scene",
            "1: unknown key `titel` at the top of the scene; did you mean `title`?",
            "2: `gravity` must be a list of 3 numbers (m/s2), but is a list of 2",
            "5: `materials.glas.density` (kg/m3) must be above 0, but is -3",
            "6: `materials.glas.youngs_modulus` must be a number (Pa)...leave the quotes out",
            "7: `materials.glas.poisson_ratio` must be above -1 and below 0.5, but is 0.5",
            "8: unknown key `colour` in `materials.glas`; did you mean `color`?",
            "12: `bodies.a.shape.type` cannot be \"bx\"; did you mean `box`?",
            "14: `friction` does not belong in `bodies.a`, but in `contact`",
            "17: there is another body called `a`; names must differ",
            "18: `bodies.a.shape.size` (m) must be above 0, but is -1",
            "18: `bodies.a.shape.cells` must be a whole number from 1 to 100000, but is 1.5",
            "19: there is no material called `stel`; did you mean `steel`?",
            "20: `b` must stand above this body in the scene's text",
            "21: `bodies.a.position` (m) must be a finite number, but is NaN",
            "27: `bodies.b.velocity` has no effect...\"fixed\"",
            "29: `bodies.b.rotation.axis` must not be zero",
            "31: `penalty_stiffness` is missing in `contact`",
            "33: `contact.passes` must be a whole number from 1",
            "36: there is no body called `ground`; there is `a`, `b`",
            "37: `contact.pairs[0].friction` (coefficient) must be at least 0, but is -1",
            "40: `time.duration` (s) must be above 0, but is 0",
            "43: there is no camera called `main`",
            "--set time.cfl=2: `time.cfl` must be above 0 and at most 1, but is 2",
            "--set materials.glas.damping=no: `materials.glas.damping` must be a number (1/s), but is the text \"no\"",
        ],
    );
}

#[test]
fn broken_toml_names_every_broken_line() {
    assert_problems(
        "title = \"x\na == 3\nb = 1\nb = 2\nc = [1, 2\nd = 4\n",
        &[],
        &[
            "1: this is not valid TOML: invalid basic string",
            "2: this is not valid TOML: extra `=`",
            "4: this is not valid TOML: duplicate key",
            "6: this is not valid TOML...is a `[` left open above?",
        ],
    );
}

/// What only shows when meshes are made: line 5 starts the body of `CUBE`.
#[test]
fn problems_of_shapes_and_places_have_their_line() {
    let cases: &[(&str, &str, &[&str])] = &[
        (
            r#"shape = { type = "hammer", head_width = 0.5 }"#,
            r#"material = "rubber""#,
            &["7: hammer: `head_width` is 0.5, but it must be less than `handle_length`"],
        ),
        (
            r#"shape = { type = "box", size = [1, 1, 1], cells = 1000 }"#,
            r#"material = "rubber""#,
            &["7: box: this resolution would give about 6.0e9 elements"],
        ),
        (
            r#"shape = { type = "hammer", cells = 3 }"#,
            r#"material = "rubber""#,
            &["7: unknown key `cells` in `bodies.cube.shape`"],
        ),
        (
            r#"shape = { type = "hammer" }"#,
            r#"material = { head = "steel", handel = "wood" }"#,
            &["8: the body has no region called `handel`; did you mean `handle`?"],
        ),
        (
            r#"shape = { type = "hammer" }"#,
            r#"material = { head = "steel" }"#,
            &["8: region `handle` of the body has no material"],
        ),
        (r#"mesh = { file = "nowhere.msh" }"#, r#"material = "rubber""#, &["7: ...nowhere.msh"]),
        (
            r#"shape = { type = "ball" }"#,
            "material = \"rubber\"\nposition = [40, 0]",
            &["10: the body is nowhere above `ground`"],
        ),
    ];
    for (shape, material, expected) in cases {
        let text = CUBE
            .replace(r#"shape = { type = "box", size = [1, 1, 1], cells = 2 }"#, shape)
            .replace(r#"material = "rubber""#, material);
        assert_problems(&text, &[], expected);
    }
}

/// A body that cannot be placed, one placed by it, and mistakes of other kinds beside them.
#[test]
fn a_body_without_its_place_does_not_hide_other_mistakes() {
    let text = format!(
        "{CUBE}
[[bodies]]
name = \"lost\"
shape = {{ type = \"hammer\" }}
material = {{ head = \"steel\" }}
on = \"nobody\"
[[bodies]]
name = \"on-lost\"
shape = {{ type = \"ball\" }}
material = \"rubber\"
on = \"lost\"
[[bodies]]
name = \"inside\"
shape = {{ type = \"ball\", radius = 0.3 }}
material = \"rubber\"
position = [0, 0, 0.9]
[[bodies.boundary]]
at = {{ region = \"al\" }}
fixed = true
"
    );
    assert_problems(
        &text,
        &[],
        &[
            "17: region `handle` of the body has no material",
            "18: there is no body called `nobody` above this one",
            "28: `cube` and `inside` overlap at the start",
            "30: the body has no region called `al`",
        ],
    );
}

#[test]
fn empty_selections_are_refused_and_say_where_the_body_is() {
    let text = format!(
        "{CUBE}
[[bodies]]
name = \"b\"
shape = {{ type = \"ball\" }}
material = \"rubber\"
position = [3, 0, 1]
[[bodies.boundary]]
at = {{ sphere = {{ center = [9, 9, 9], radius = 1 }} }}
fixed = true
[[bodies.boundary]]
at = {{ region = \"al\" }}
force = [0, 0, 1]
[[bodies.boundary]]
at = \"top\"
force = [0, 0, 1]
velocity = [0, 0, 1]
"
    );
    let problem = "29: `bodies.b.boundary[2]` must say one of";
    assert_problems(&text, &[], &[&problem.replace("29", "25")]);
    assert_problems(
        &text.replace("\nvelocity = [0, 0, 1]\n", "\n"),
        &[],
        &[
            "20: no node of the body lies there; it reaches from [2.95",
            "23: the body has no region called `al`; did you mean `all`?",
        ],
    );
}

#[test]
fn overlapping_bodies_are_refused_by_name_and_depth() {
    let text = format!(
        "{CUBE}
[[bodies]]
name = \"ball\"
shape = {{ type = \"ball\", radius = 0.3, refinement = 2 }}
material = \"rubber\"
position = [0, 0, 1.2]
copies = {{ count = 2, offset = [0.5, 0, 0] }}
"
    );
    assert_problems(
        &text,
        &[],
        &[
            "18: `cube` and `ball-1` overlap at the start, by ... m or more near",
            "18: `cube` and `ball-2` overlap at the start",
            "18: `ball-1` and `ball-2` overlap at the start",
        ],
    );
    let apart = ["bodies.ball.position[2]=1.31", "bodies.ball.copies.offset=[0.7,0,0]"];
    assert_problems(&text, &apart, &[]);
}

#[test]
fn overrides_reach_values_by_name_and_by_number() {
    let scene = build(
        CUBE,
        &[
            "bodies.cube.velocity=[1, 2, 3]",
            "bodies[0].velocity[1]=-2e0",
            "materials.rubber.youngs_modulus=30e6",
            "contact.method=penalty",
            "contact.penalty_stiffness=1e5",
            "bodies.0.shape.element_size=.5",
            "time.duration=.25",
        ],
    )
    .unwrap();
    let cube = &scene.setup.bodies[1];
    assert_eq!(cube.velocity_m_s, glam::DVec3::new(1.0, -2.0, 3.0));
    assert_eq!(cube.materials[0].youngs_modulus_pa, 30e6);
    assert_eq!(cube.materials[0].density_kg_m3, 1100.0, "the rest is the library's");
    let penalty = ContactMethod::Penalty { stiffness_n_m: 1e5 };
    assert_eq!(scene.setup.contact.method, penalty);
    assert_eq!(scene.description.duration_s, 0.25);
    assert_eq!(cube.mesh.tets.len(), 48, "`element_size` took the place of `cells`");
}

#[test]
fn wrong_overrides_name_the_override_and_the_nearest_name() {
    assert_problems(
        CUBE,
        &[
            "bodies.cub.velocity=[1,2,3]",
            "materials.ruber.density=3",
            "materials.steel.density=3",
            "contact.frict=.5",
            "bodies.9.name=a",
            "bodies.cube.name.x=3",
            "gravity[2]=-1",
            "contact.friction",
            "recording.size=[1",
        ],
        &[
            "--set bodies.cub.velocity=[1,2,3]: `bodies` has nothing called `cub`; did you mean `cube`?",
            "--set materials.ruber.density=3: there is nothing called `ruber` in `materials`",
            "--set materials.steel.density=3: no body is of the material `steel`; there is `rubber`, `concrete`",
            "--set contact.frict=.5: unknown key `frict` in `contact`; did you mean `friction`?",
            "--set bodies.9.name=a: `bodies` has no number 9: it has 1, counted from 0",
            "--set bodies.cube.name.x=3: `bodies.cube.name` is the text \"cube\"",
            "--set gravity[2]=-1: `gravity` is not in the scene's text",
            "--set contact.friction: write a path, `=` and a value",
            "--set recording.size=[1: the value is not valid TOML",
        ],
    );
}

/// What is saved is what was run.
#[test]
fn saving_and_loading_gives_the_same_scene() {
    let overrides = [
        "materials.cube={preset=\"rubber\", damping=3}",
        "bodies.dark.copies.count=4",
        "bodies.light.shape.refinement=3",
        "ground.friction_angle=20",
        "contact.passes=7",
        "contact.pairs=[{bodies=[\"dark\",\"light-2\"],friction=0.9}]",
        "cameras.main.yaw=-5",
        "recording.color_by=speed",
        "recording.start=1",
        "bodies.dark.boundary=[{at=\"top\",force=[0,0,-1],ramp=0.5}]",
    ];
    let overrides = overrides.map(str::to_owned);
    let scene = Scene::load(STACK, &overrides).unwrap();
    let text = scene.to_toml();
    assert!(text.contains("# kg/m3") || text.contains("# m"), "comments are kept:\n{text}");
    let again = Scene::from_text(STACK, &text, Path::new("."), &[]).unwrap();
    assert_eq!(again.description, scene.description);
    assert_eq!(again.setup, scene.setup);
    assert_eq!(scene.setup.contact.pair_friction.len(), 9 + 4);
    let boundary = &scene.setup.bodies.last().unwrap().boundary[0];
    assert_eq!(boundary.nodes.len(), 9);
    assert!(matches!(boundary.action, BoundaryAction::Force { ramp_s: 0.5, .. }));
    for builtin in BUILTIN_SCENES {
        let scene = Scene::load(builtin.name, &[]).unwrap();
        assert_eq!(scene.to_toml(), builtin.text, "untouched text stays as it is");
    }
}

#[test]
fn wrong_fracture_is_refused_with_the_place() {
    let fracture = |value: &str| format!("materials.rubber.fracture={value}");
    let cases = [
        (
            "{criterion=\"tensil\"}",
            "`materials.rubber.fracture.criterion` cannot be \"tensil\"; did you mean `tensile`?",
        ),
        ("{criterion=\"tensile\"}", "`tensile_strength` is missing"),
        (
            "{criterion=\"tensile\",tensile_strength=0}",
            "`materials.rubber.fracture.tensile_strength` (Pa) must be above 0",
        ),
        ("{criterion=\"tensile\",tensile_strength=1,cohesion=2}", "unknown key `cohesion`"),
        (
            "{criterion=\"mohr-coulomb\",cohesion=1,friction_angle=90}",
            "`materials.rubber.fracture.friction_angle`...below 90",
        ),
        ("{criterion=\"formula\",formula=\"s1 - Ft\",parameters={Fk=1}}", "column 6 of `s1 - Ft`...Ft"),
        ("{criterion=\"formula\",formula=\"s1/0 - 1\"}", "column"),
        ("{any_of=[]}", "`materials.rubber.fracture.any_of` needs at least one criterion"),
    ];
    for (value, message) in cases {
        let set = fracture(value);
        assert_problems(CUBE, &[&set], &[&format!("--set {set}: {message}")]);
    }
    assert_problems(
        CUBE,
        &["fracture.propagation=both"],
        &["--set fracture.propagation=both: `fracture.propagation` cannot be"],
    );
    let sound = fracture(
        "{any_of=[{criterion=\"tresca\",shear_strength=1e5},{criterion=\"tensile\",tensile_strength=1e5}]}",
    );
    let scene = build(CUBE, &[&sound, "fracture.max_elements=90"]).unwrap();
    let criterion = scene.setup.bodies[1].materials[0].fracture.as_ref().unwrap();
    assert_eq!((criterion.rules().len(), scene.setup.fracture.max_elements), (2, Some(90)));
}

#[test]
fn an_unknown_scene_gets_the_nearest_name() {
    let error = Scene::load("hamer-table", &[]).unwrap_err().to_string();
    assert!(error.contains("did you mean `hammer-table`?"), "{error}");
}

/// Tokens of the shipped scenes deleted, doubled, swapped and altered: refused or built, never a panic.
#[test]
fn mutated_scenes_never_panic() {
    let strange = [
        "-1",
        "0",
        "1e308",
        "nan",
        "\"\"",
        "[]",
        "{}",
        "true",
        "\"ground\"",
        "99999999999999999999",
        "[[bodies]]",
        "[time]",
        "=",
        "\"\"\"",
        "1979-05-27",
        "é",
        "type",
        "name",
    ];
    let mut random = SmallRandom(0x5eed);
    let mut refused = 0;
    for round in 0..600 {
        let builtin = BUILTIN_SCENES[round % BUILTIN_SCENES.len()];
        if builtin.name.ends_with("-fine") {
            continue;
        }
        let mut tokens = tokens_of(builtin.text);
        for _ in 0..=random.below(3) {
            let at = random.below(tokens.len());
            match random.below(4) {
                0 => drop(tokens.remove(at)),
                1 => tokens.insert(at, tokens[at].clone()),
                2 => tokens.swap(at, random.below(at.max(1))),
                _ => tokens[at] = strange[random.below(strange.len())].to_owned(),
            }
        }
        let text = tokens.concat();
        match build(&text, &[]) {
            Ok(_) => {}
            Err(error) => {
                refused += 1;
                assert!(!error.problems().is_empty());
                assert!(!error.to_string().is_empty());
            }
        }
    }
    assert!(refused > 200, "only {refused} refused: the mutations are too tame");
}

/// Overrides made of words of the scene, in any order and number.
#[test]
fn random_overrides_never_panic() {
    let text = BUILTIN_SCENES[0].text;
    let words: Vec<String> = tokens_of(text).into_iter().filter(|t| !t.trim().is_empty()).collect();
    let mut random = SmallRandom(0xbad5eed);
    for _ in 0..2000 {
        let path: Vec<&str> =
            (0..=random.below(3)).map(|_| words[random.below(words.len())].as_str()).collect();
        let glue = if random.below(10) == 0 { "[" } else { "=" };
        let value = &words[random.below(words.len())];
        let text_of_override = format!("{}{glue}{value}", path.join("."));
        if let Err(error) = build(text, &[&text_of_override]) {
            assert!(!error.problems().is_empty(), "{text_of_override}");
        }
    }
}

#[test]
fn fuzzed_scenes_are_refused_or_sound() {
    fuzzing::run("scene", 700, entries::scene);
}

#[test]
fn fuzzed_formulas_are_refused_or_have_values() {
    fuzzing::run("formula", 20_000, entries::formula);
}

/// Refused by count, before ten thousand meshes are made.
#[test]
fn copies_beyond_all_memory_are_refused() {
    let refused = build(include_str!("corpus/scene/many_copies.toml"), &[]).unwrap_err().to_string();
    assert!(refused.contains("1620000000 elements"), "{refused}");
}

/// Nesting is recursion: neither text nor overrides may use up the stack.
#[test]
fn depth_without_end_is_refused() {
    let smallest = include_str!("corpus/scene/smallest.toml");
    for depth in [100, 100_000] {
        let dotted = vec!["a"; depth].join(".");
        let brackets = "[".repeat(depth) + &"]".repeat(depth);
        let tables = "{a=".repeat(depth) + "1" + &"}".repeat(depth);
        for text in [
            format!("{dotted} = 1\n{smallest}"),
            format!("{smallest}\n[{dotted}]\n"),
            format!("{smallest}\n[[{dotted}]]\n"),
        ]
        .into_iter()
        .chain([&brackets, &tables].map(|value| format!("a = {value}\n{smallest}")))
        {
            assert!(build(&text, &[]).is_err(), "{depth}: {}", &text[..40]);
        }
        for value in ["1", &brackets, &tables] {
            for path in [&dotted, "bodies", "time.duration"] {
                let text = format!("{path}={value}");
                assert!(build(smallest, &[&text]).is_err() || *path != *dotted, "{depth}: {}", &text[..20]);
            }
        }
    }
    let formula = "(".repeat(100_000) + "s1" + &")".repeat(100_000);
    entries::formula(formula.as_bytes());
    entries::formula("-".repeat(100_000).as_bytes());
    entries::formula("s1^".repeat(100_000).as_bytes());
    entries::formula("s1+".repeat(100_000).as_bytes());
}

/// Words, numbers, blanks and signs, which together are the text again.
fn tokens_of(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let kind = |c: char| match c {
        c if c.is_alphanumeric() || "_-.".contains(c) => 0,
        c if c.is_whitespace() => 1,
        _ => 2,
    };
    let mut last = 3;
    for c in text.chars() {
        match tokens.last_mut() {
            Some(token) if kind(c) == last && last < 2 => token.push(c),
            _ => tokens.push(c.to_string()),
        }
        last = kind(c);
    }
    tokens
}

/// A linear congruential generator (Knuth's MMIX constants): the same rounds every time.
struct SmallRandom(u64);

impl SmallRandom {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as usize) % limit
    }
}
