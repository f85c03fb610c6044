//! Values from the command line, and scenes saved with them.

use super::*;

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
