//! Wrong scenes: every problem with its place.

use super::*;

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
fn wrong_fracture_is_refused_with_the_place() {
    let fracture = |value: &str| format!("materials.rubber.fracture={value}");
    let cases = [
        (
            "{criterion=\"tensil\"}",
            "`materials.rubber.fracture.criterion` cannot be \"tensil\"; did you mean `tensile`?",
        ),
        ("{criterion=\"tensile\"}", "`tensile_strength` is missing"),
        (
            "{criterion=\"mohr-coulomb\",cohesion=1}",
            "`friction_angle` is missing in `materials.rubber.fracture`: a number (degrees)",
        ),
        ("{criterion=\"drucker-prager\",cohesion=1}", "`friction_angle` is missing"),
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

#[test]
fn a_moment_by_another_word_is_understood() {
    let text = r##"title = "x"

[[bodies]]
name = "a"
shape = { type = "box", size = [1, 1, 1] }
material = "steel"
at = 3

[[removals]]
body = "a"
time = 0.5

[[contact_changes]]
when = 0.5
friction = 0.1

[[pulls]]
body = "a"
at = [0, 0, 0]
path = [{ time = 0.1, point = [0, 0, 1] }, { at = 0.2, point = [0, 0, 2] }]

[time]
duration = 1

[recording]
cut = { across = [0, 0, 0] }
color_range = [2, 1]
"##;
    assert_problems(
        text,
        &[],
        &[
            "7: unknown key `at` in `bodies.a`; did you mean `position` or `enters`?",
            "9: `at` is missing in `removals[0]`",
            "11: unknown key `time` in `removals[0]`; did you mean `at`?",
            "13: `at` is missing in `contact_changes[0]`",
            "14: unknown key `when` in `contact_changes[0]`; did you mean `at`?",
            "20: `time` is missing in `pulls[0].path[1]`",
            "20: unknown key `at` in `pulls[0].path[1]`; did you mean `time`?",
            "26: `recording.cut.across` must have a direction",
            "27: the first of `recording.color_range` must be below the second",
        ],
    );
}

#[test]
fn what_is_recorded_beyond_single_precision_is_refused_and_no_sound_key_is_blamed() {
    let scene = |recording: &str| {
        let block = "title = \"t\"\nmaterials.block.density = 1000\nmaterials.block.youngs_modulus = 1e6\n\
                     materials.block.poisson_ratio = 0.3\n[[bodies]]\nname = \"a\"\nmaterial = \"block\"\n\
                     shape = { type = \"box\", size = [1, 1, 1], cells = 1 }\n[time]\nduration = 1\n[recording]\n";
        format!("{block}{recording}\n")
    };
    for (recording, problem) in [
        ("cut = { across = [0, 0, 0], at = 0.1 }", "12: `recording.cut.across` must have a direction"),
        ("cut = { across = [0, 1], at = 0.1 }", "12: `recording.cut.across` must"),
        ("cut = { across = [1e300, 0, 0] }", "12: `recording.cut.across` names no direction"),
        (
            "cut = { across = [1, 0, 0], at = 1e39 }",
            "12: `recording.cut.at` (m) must be at least -1e38 and at most 1e38",
        ),
        ("color_range = [-1e39, 1]", "12: `recording.color_range` must be at least -1e38 and at most 1e38"),
        ("color_range = [1.0, 1.000000001]", "12: the ends of `recording.color_range` must be further apart"),
    ] {
        assert_problems(&scene(recording), &[], &[problem]);
    }
}

#[test]
fn what_does_not_go_together_with_breaking_is_refused_with_its_place() {
    let text = include_str!("../../assets/scenes/cube-wall.toml");
    let text = text.replace("velocity =", "kinematics = \"body-frame\"\nmass_scaling = 0.1\nvelocity =");
    let line = text.lines().position(|line| line.starts_with("kinematics")).unwrap() + 1;
    assert_problems(
        &text,
        &[],
        &[
            &format!("{line}: `plaster` has a `fracture`, and a body that can break cannot have kinematics"),
            &format!("{}: `plaster` has a `fracture`, and a body that can break cannot have mass", line + 1),
        ],
    );
}
