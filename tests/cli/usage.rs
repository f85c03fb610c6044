//! What is said to whoever asks for help, mistypes, or names a place that cannot be written.

use crate::{Place, SCENE, stderr, wait};
use std::fs;
use std::process::Stdio;

#[test]
fn help_names_every_command_option_and_status() {
    let place = Place::new();
    let help = place.succeed("--help");
    for word in [
        "view",
        "render",
        "run",
        "scenes",
        "check",
        "criteria",
        "verify",
        "--set",
        "--threads",
        "--quiet",
        "Exit status",
        "130",
    ] {
        assert!(help.contains(word), "{word} is not in\n{help}");
    }
    let render = place.succeed("render --help");
    for option in [
        "--output",
        "--size",
        "--fps",
        "--duration",
        "--at",
        "--slow-motion",
        "--camera",
        "--color-by",
        "--wireframe",
        "--cut",
        "--crosses",
        "--color-range",
        "von-mises",
        "--set",
    ] {
        assert!(render.contains(option), "{option} is not in\n{render}");
    }
    assert!(place.succeed("view --help").contains("--measure-frames"));
    let run = place.succeed("run --help");
    for option in ["--output", "--vtu", "--every", "--duration", "--force"] {
        assert!(run.contains(option), "{option} is not in\n{run}");
    }
    assert!(place.succeed("--version").starts_with("hammerfall "));
}

#[test]
fn bad_usage_is_status_2_and_says_what_is_expected() {
    let place = Place::new();
    let cases = [
        ("fly", "unrecognized subcommand"),
        ("veiw cubes.toml", "'view'"),
        ("rednre cubes.toml -o a.gif", "'render'"),
        ("run cubes.toml", "--output"),
        ("run cubes.toml -o d --duration soon", "10ms"),
        ("run cubes.toml -o d --duration 0", "longer than zero"),
        ("run cubes.toml -o d --duration -1", "not negative"),
        ("run cubes.toml -o d --set density", "KEY=VALUE"),
        ("run cubes.toml -o d --threads 0", "1..=1024"),
        ("render cubes.toml -o a.gif --size 960", "960x540"),
        ("render cubes.toml -o a.gif --color-by stres", "von-mises"),
        ("render cubes.toml -o a.gif --cut w", "1,0,2"),
        ("render cubes.toml -o a.gif --cut -z=far", "50mm"),
        ("render cubes.toml -o a.gif --color-by speed --color-range 2..1", "below the upper"),
        ("render cubes.toml -o a.gif --color-range 0..1", "--color-by"),
        ("render cubes.toml -o a.gif --camera nowhere", "three-quarter"),
        ("render cubes.toml -o a.mp4", ".mp4"),
        ("render cubes.toml -o a.gif --at 0.1", "--at"),
        ("render cubes.toml -o a.gif --fps 60", "at most 50"),
        ("render cubes.toml -o a.gif --slow-motion 1e9", "--slow-motion"),
    ];
    for (line, reason) in cases {
        let message = place.fail(line, 2);
        assert!(message.contains(reason), "{line}: {message}");
    }
    assert!(!place.has("d") && !place.has("a.gif"));
}

#[test]
fn bad_input_is_status_2_and_says_what_is_wrong() {
    let place = Place::new();
    let write = |name: &str, text: &str| fs::write(place.path().join(name), text).unwrap();
    write("broken.toml", "title = \n");
    write("typo.toml", &SCENE.replace("velocity", "velocty"));
    write("body.msh", MESH);
    write("notes.md", "# Notes\n");
    write("overlap.toml", &SCENE.replace("0.01, 0.3", "0.01, 0.2"));
    let cases = [
        ("run hamer-table -o d", "hammer-table"),
        ("run nothing/there.toml -o d", "there.toml"),
        ("run broken.toml -o d", "broken.toml"),
        ("run typo.toml -o d", "velocity"),
        ("run overlap.toml -o d", "upper"),
        ("run cubes.toml -o d --set materials.rubber.poisson_ratio=0.5", "poisson_ratio"),
        ("run cubes.toml -o d --set bodies.upper.velocity=[0,0,-1e300]", "finite"),
        ("check typo.toml", "velocity"),
        ("check notes.md", "not a scene file (scene files end in .toml)"),
        ("run notes.md -o d", "scene files end in .toml"),
        ("run body.msh -o d", "takes a mesh by `mesh.file = \"body.msh\"`"),
        ("render hamer-table -o a.gif", "hammer-table"),
    ];
    for (line, reason) in cases {
        let message = place.fail(line, 2);
        assert!(message.contains(reason), "{line}: {message}");
    }
    assert!(!place.has("d") && !place.has("a.gif"));
}

#[test]
fn scenes_lists_a_line_each_and_every_one_is_sound() {
    let place = Place::new();
    let list = place.succeed("scenes");
    assert!(list.lines().count() >= 14, "{list}");
    for line in list.lines() {
        let (name, summary) = line.split_once(' ').unwrap();
        assert!(!summary.trim().is_empty(), "{line}");
        let found = place.succeed(&format!("check {name}"));
        assert!(found.contains("is sound"), "{name}: {found}");
    }
}

#[test]
fn check_tells_size_and_cost() {
    let place = Place::new();
    let found = place.succeed("check cubes.toml");
    for word in ["elements", "step", "lower", "upper", "sound"] {
        assert!(found.contains(word), "{word} is not in\n{found}");
    }
}

#[test]
fn check_says_what_breaking_may_cost() {
    let place = Place::new();
    assert!(!place.succeed("check cubes.toml").contains("breaking"));
    let found = place.succeed("check mug-drop");
    assert!(found.contains("without breaking, but `") && found.contains("may come to about"), "{found}");
}

#[test]
fn a_state_of_the_window_without_its_equals_sign_is_understood() {
    let place = Place::new();
    let told = place.fail("render cubes.toml -o a.png --panels element", 2);
    assert!(told.contains("--panels=element"), "{told}");
    assert!(!place.fail("render cubes.toml -o a.png elephant", 2).contains("--panels"));
    assert!(!place.fail("run cubes.toml -o out help", 2).contains("--panels="));
    assert!(!place.fail("render cubes.toml -o a.png element", 2).contains("--panels="));
}

#[test]
fn slips_of_units_are_warned_about_unless_quiet() {
    let place = Place::new();
    for line in ["check cubes.toml", "run cubes.toml -o d --duration 1ms"] {
        let line = format!("{line} --set materials.rubber.density=0.9");
        let output = place.run(&line);
        assert!(output.status.success(), "{line}");
        let said = stderr(&output);
        assert!(said.contains("warning: --set materials.rubber.density=0.9: "), "{line}: {said}");
        assert!(!stderr(&place.run(&format!("{line} --quiet"))).contains("warning"), "{line}");
    }
}

/// One tetrahedron in Gmsh's text format.
const MESH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n\
                    $EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";

#[test]
fn check_tells_of_a_mesh_and_what_is_wrong_with_it() {
    let place = Place::new();
    let write = |name: &str, text: &str| fs::write(place.path().join(name), text).unwrap();
    write("one.msh", MESH);
    let found = place.succeed("check one.msh");
    for word in ["tetrahedra", "volume", "stable step", "steel", "is sound"] {
        assert!(found.contains(word), "{word} is not in\n{found}");
    }
    write("nan.msh", &MESH.replace("4 0 0 1", "4 0 0 nan"));
    assert!(place.fail("check nan.msh", 2).contains("node 4"));
    write("cut.msh", &MESH[..MESH.len() - 40]);
    assert!(place.fail("check cut.msh", 2).contains("cut.msh"));
    assert!(place.fail("check missing.msh", 2).contains("missing.msh"));
    assert!(place.fail("check one.msh --set a=1", 2).contains("--set"));
}

#[test]
fn a_place_that_cannot_be_written_is_told_before_anything_runs() {
    let place = Place::new();
    // A file stands where a folder is needed: that stops root, too.
    fs::write(place.path().join("taken"), "").unwrap();
    for line in [
        "run cubes.toml -o taken",
        "run cubes.toml -o taken/data",
        "render cubes.toml -o taken/a.gif",
        "render cubes.toml -o taken/a.png",
        "render cubes.toml -o taken/frames",
    ] {
        let message = place.fail(line, 2);
        assert!(message.contains("taken"), "{line}: {message}");
    }
}

#[test]
fn quiet_says_nothing_when_all_is_well() {
    let place = Place::new();
    let output = place.run("--quiet run cubes.toml -o data --duration 20ms");
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    assert!(place.has("data/summary.json"));
    assert!(!place.succeed("scenes -q").is_empty(), "a list that was asked for is a result");
}

#[test]
fn no_progress_bar_goes_into_a_pipe() {
    let place = Place::new();
    let output = place.run("run cubes.toml -o data");
    assert_eq!(stderr(&output), "");
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_ends_it_quietly() {
    let place = Place::new();
    let mut child = place.command("scenes").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Nobody will ever read.
    drop(child.stdout.take());
    let output = wait(child);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "");
}
