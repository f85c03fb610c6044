//! The program as a user meets it: exit statuses, messages, and files that others can read.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use vtkio::model::{Attribute, UnstructuredGridPiece, Vtk};

/// Two rubber cubes above the ground: a few elements, collisions within a tenth of a second.
const SCENE: &str = r#"
title = "two cubes"

[time]
duration = 0.12

[recording]
history_every = 0.02
size = [96, 64]
fps = 20

[ground]
size = 2.0

[[bodies]]
name = "lower"
shape = { type = "box", size = [0.2, 0.2, 0.2], cells = [1, 1, 1] }
material = "rubber"
position = [0, 0, 0.11]

[[bodies]]
name = "upper"
shape = { type = "box", size = [0.1, 0.1, 0.1], cells = [1, 1, 1] }
material = "rubber"
position = [0.02, 0.01, 0.3]
velocity = [0, 0, -2]
"#;

const COLUMNS: &str = "time_s,step_s,stage,kinetic_j,strain_j,potential_j,dissipated_j,\
                       external_work_j,px,py,pz,lx,ly,lz,contact_force_n,contact_pairs,\
                       max_penetration_m,elements,nodes,fragments,crack_area_m2";

/// A folder with the scene in it, gone when dropped.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("cubes.toml"), SCENE).unwrap();
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hammerfall"));
        command.args(line.split_whitespace()).current_dir(self.path());
        command
    }

    fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs a command that must end well; gives its stdout.
    fn succeed(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs a command that must end with `status`; gives its stderr.
    fn fail(&self, line: &str, status: i32) -> String {
        let output = self.run(line);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(status), "{line}: {message}");
        assert!(!message.contains("panicked"), "{line}: {message}");
        message
    }

    fn read(&self, file: &str) -> String {
        fs::read_to_string(self.path().join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
    }

    fn json(&self, file: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(file)).unwrap()
    }

    fn has(&self, file: &str) -> bool {
        self.path().join(file).exists()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Rows of a history without its header; every row must be complete.
fn rows(history: &str) -> Vec<Vec<String>> {
    let mut lines = history.lines();
    assert_eq!(lines.next(), Some(COLUMNS));
    let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let rows: Vec<Vec<String>> = lines.map(split).collect();
    assert!(rows.iter().all(|row| row.len() == 21), "{history}");
    rows
}

fn times_s(history: &str) -> Vec<f64> {
    rows(history).iter().map(|row| row[0].parse().unwrap()).collect()
}

fn grid(path: &Path) -> UnstructuredGridPiece {
    let file = Vtk::import(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    UnstructuredGridPiece::try_from(file.data).unwrap()
}

fn array(attributes: &[Attribute], name: &str) -> Vec<f64> {
    match attributes.iter().find(|attribute| attribute.name() == name) {
        Some(Attribute::DataArray(array)) => array.data.cast_into::<f64>().unwrap(),
        _ => panic!("no array {name}"),
    }
}

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
fn run_writes_files_that_read_back() {
    let place = Place::new();
    let said = place.succeed("run cubes.toml -o data --vtu --set time.cfl=0.7");
    assert!(said.contains("history.csv") && said.contains("data"), "{said}");

    let history = place.read("data/history.csv");
    assert_eq!(times_s(&history).len(), 7, "{history}");
    // A row comes with the first step that reaches its moment; elastic steps end where they end.
    for (index, time_s) in times_s(&history).iter().enumerate() {
        let late_s = time_s - 0.02 * index as f64;
        assert!((-1e-12..1e-3).contains(&late_s), "{time_s}");
    }

    let summary = place.json("data/summary.json");
    assert_eq!(summary["status"], "done");
    assert_eq!(summary["interrupted"], false);
    assert_eq!(summary["scene"]["name"], "cubes");
    assert_eq!(summary["scene"]["overrides"][0], "time.cfl=0.7");
    assert_eq!(summary["counts"]["rows"], 7);
    assert_eq!(summary["counts"]["vtu_frames"], 7);
    assert!(summary["counts"]["steps"].as_u64().unwrap() > 0);
    assert!(summary["wall_time"]["total_s"].as_f64().unwrap() > 0.0);
    let end_s = summary["last"]["time_s"].as_f64().unwrap();
    assert!((0.12..0.121).contains(&end_s), "{end_s}");
    // The ground, and two cubes of five or six tetrahedra.
    let bodies = summary["scene"]["bodies"].as_array().unwrap();
    assert!(bodies.iter().any(|body| body["name"] == "upper"));

    let collection = place.read("data/run.pvd");
    assert_eq!(collection.matches("<DataSet ").count(), 7);
    let last = grid(&place.path().join("data/frames/frame-000006.vtu"));
    let count = |key: &str| -> usize {
        let counts = bodies.iter().map(|body| body[key].as_u64().unwrap() as usize);
        counts.sum()
    };
    assert_eq!(last.num_points(), count("nodes"));
    assert_eq!(array(&last.data.cell, "body_id").len(), count("elements"));
    let points = last.points.cast_into::<f64>().unwrap();
    let reference = array(&last.data.point, "reference_position");
    let displacement = array(&last.data.point, "displacement");
    for ((x, r), u) in points.iter().zip(&reference).zip(&displacement) {
        assert!((x - r - u).abs() < 1e-12);
    }
    assert!(!leftovers(place.path()), "temporary files are left");
}

#[test]
fn a_run_that_blows_up_is_status_1_and_keeps_what_was_sound() {
    let place = Place::new();
    let message = place.fail("run cubes.toml -o data --set bodies.upper.velocity=[0,0,-1e120]", 1);
    assert!(message.contains("t = ") && message.contains("blown up"), "{message}");
    let history = place.read("data/history.csv");
    assert!(!rows(&history).is_empty() && !history.contains("NaN"), "{history}");
    let summary = place.json("data/summary.json");
    assert_eq!(summary["status"], "failed");
    assert!(message.contains(summary["failure"].as_str().unwrap()), "{message}");
}

fn leftovers(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().flatten().any(|entry| {
        let path = entry.path();
        let is_partial = path.extension().is_some_and(|extension| extension == "partial");
        is_partial || (path.is_dir() && leftovers(&path))
    })
}

#[test]
fn every_step_has_its_row_when_asked_for() {
    let place = Place::new();
    place.succeed("run cubes.toml -o data --every 0 --duration 20ms");
    let summary = place.json("data/summary.json");
    let times_s = times_s(&place.read("data/history.csv"));
    assert_eq!(times_s.len() as u64, summary["counts"]["steps"].as_u64().unwrap() + 1);
    assert!(times_s.windows(2).all(|pair| pair[0] < pair[1]));
    assert!((times_s[times_s.len() - 1] - 0.02).abs() < 1e-12);
}

#[test]
fn equal_runs_give_equal_bytes_whatever_the_threads() {
    let place = Place::new();
    let history = |folder: &str, threads: u32| {
        place.succeed(&format!("run cubes.toml -o {folder} --threads {threads} --every 1ms"));
        place.read(&format!("{folder}/history.csv"))
    };
    let first = history("a", 1);
    assert!(first == history("b", 1), "two equal runs differ");
    assert!(first == history("c", 2), "one and two threads differ");
    assert!(first == history("a", 1), "writing over an earlier run differs");
}

#[test]
fn an_earlier_run_is_replaced_but_not_the_files_of_others() {
    let place = Place::new();
    place.succeed("run cubes.toml -o data --vtu --duration 80ms");
    let output = place.run("run cubes.toml -o data --vtu --duration 20ms");
    assert!(stderr(&output).contains("replacing"), "{}", stderr(&output));
    assert_eq!(fs::read_dir(place.path().join("data/frames")).unwrap().count(), 2);

    fs::create_dir(place.path().join("mine")).unwrap();
    fs::write(place.path().join("mine/history.csv"), "my own").unwrap();
    let message = place.fail("run cubes.toml -o mine", 2);
    assert!(message.contains("--force"), "{message}");
    assert_eq!(place.read("mine/history.csv"), "my own");
    place.succeed("run cubes.toml -o mine --force");
    assert!(place.read("mine/history.csv").starts_with("time_s"));
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

#[test]
#[cfg(unix)]
fn ctrl_c_keeps_what_was_written_and_says_so() {
    for signal in ["INT", "TERM"] {
        let place = Place::new();
        let child = place
            .command("run cubes.toml -o data --vtu --duration 1e6 --every 10ms")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        wait_for(|| place.has("data/frames/frame-000003.vtu"));
        send(signal, &child);
        let output = wait(child);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(130), "{message}");
        assert!(message.contains("interrupted"), "{message}");

        let times_s = times_s(&place.read("data/history.csv"));
        let summary = place.json("data/summary.json");
        assert_eq!(summary["interrupted"], true);
        assert_eq!(summary["status"], "interrupted");
        assert_eq!(summary["counts"]["rows"], times_s.len());
        // Reading a number of the summary may round its last bit.
        let (last_s, row_s) = (summary["last"]["time_s"].as_f64().unwrap(), times_s.last().unwrap());
        assert!((last_s - row_s).abs() <= f64::EPSILON * row_s, "{last_s} {row_s}");
        let frames = summary["counts"]["vtu_frames"].as_u64().unwrap();
        let listed = place.read("data/run.pvd").matches("<DataSet ").count();
        assert_eq!(listed as u64, frames);
        let last = format!("data/frames/frame-{:06}.vtu", frames - 1);
        assert!(grid(&place.path().join(last)).num_points() > 0);
        assert!(!leftovers(place.path()));
    }
}

#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(sent.unwrap().success());
}

fn wait_for(happened: impl Fn() -> bool) {
    let started = Instant::now();
    while !happened() {
        assert!(started.elapsed() < Duration::from_secs(120), "it never happened");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Waits for the end, but not for ever.
fn wait(mut child: Child) -> Output {
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
            panic!("it did not end");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.wait_with_output().unwrap()
}

#[test]
fn a_moment_is_rendered_to_a_png() {
    let place = Place::new();
    place.succeed("render cubes.toml -o new/folder/one.png --at 50ms --color-by speed --wireframe");
    place.succeed("render cubes.toml -o cut.png --at 50ms --color-by mean-stress --color-range -2kPa..2kPa --cut -y --crosses");
    let picture = image::open(place.path().join("new/folder/one.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (96, 64));
    let first = picture.get_pixel(0, 0);
    assert!(picture.pixels().any(|pixel| pixel != first), "an empty picture");
}

#[test]
fn an_animation_is_rendered_to_a_gif_and_to_a_folder() {
    use image::AnimationDecoder;
    let place = Place::new();
    // 0.12 s at 20 pictures a second, five times slower: one every 10 ms, both ends included.
    place.succeed("render cubes.toml -o fall.gif --slow-motion 5 --size 64x48 --camera front");
    let file = std::io::BufReader::new(fs::File::open(place.path().join("fall.gif")).unwrap());
    let gif = image::codecs::gif::GifDecoder::new(file).unwrap();
    let frames = gif.into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 13);
    assert!(frames.iter().all(|frame| frame.buffer().dimensions() == (64, 48)));

    place.succeed("render cubes.toml -o frames --slow-motion 2 --size 64x48");
    let count = || fs::read_dir(place.path().join("frames")).unwrap().count();
    assert_eq!(count(), 5);
    place.succeed("render cubes.toml -o frames --size 64x48");
    assert_eq!(count(), 3, "pictures of the earlier run are mixed in");
    assert!(!leftovers(place.path()));
}

#[test]
#[cfg(unix)]
fn ctrl_c_closes_the_gif() {
    use image::AnimationDecoder;
    let place = Place::new();
    let child = place
        .command("render cubes.toml -o long.gif --duration 10 --slow-motion 20 --size 64x48")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(|| place.has("long.gif"));
    send("INT", &child);
    let output = wait(child);
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    let file = std::io::BufReader::new(fs::File::open(place.path().join("long.gif")).unwrap());
    let gif = image::codecs::gif::GifDecoder::new(file).unwrap();
    assert!(!gif.into_frames().collect_frames().unwrap().is_empty());
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_the_message_names_the_package() {
    let place = Place::new();
    let output = place
        .command("render cubes.toml -o a.png")
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = stderr(&output);
    assert!(message.contains("mesa-vulkan-drivers"), "{message}");
    assert!(!place.has("a.png"));
}

/// Rows of `criteria`'s table of one criterion and section: angle in degrees, and the three stresses in Pa.
fn points(table: &str, criterion: &str, section: &str) -> Vec<[f64; 4]> {
    let row = |line: &str| -> Option<[f64; 4]> {
        let (name, numbers) = line.strip_prefix('"')?.split_once("\",")?;
        let numbers = numbers.strip_prefix(section)?.strip_prefix(',')?;
        let numbers: Vec<f64> = numbers.split(',').map(|number| number.parse().unwrap()).collect();
        name.starts_with(criterion).then(|| [numbers[1], numbers[2], numbers[3], numbers[4]])
    };
    table.lines().filter_map(row).collect()
}

#[test]
fn failure_surfaces_pass_through_the_strengths() {
    let place = Place::new();
    place.succeed("criteria -o five.csv --mean-stress -5MPa");
    let table = place.read("five.csv");
    assert!(table.starts_with("criterion,section,mean_stress_pa,angle_deg,s1_pa,s2_pa,s3_pa\n"));
    let plane = |criterion: &str, angle_deg: f64| {
        let points = points(&table, criterion, "plane-stress");
        points.into_iter().find(|point| point[0] == angle_deg).map(|[_, s1, s2, _]| [s1 / 1e6, s2 / 1e6])
    };
    // Uniaxial tension, then compression. Drucker-Prager in tension: 6 c cos(phi)/(3 + sin(phi)).
    let strengths = [
        ("tensile", 10.0, None),
        ("Tresca", 10.0, Some(-10.0)),
        ("von Mises", 10.0, Some(-10.0)),
        ("Mohr-Coulomb", 10.0, Some(-30.0)),
        ("Drucker-Prager", 90.0 / 7.0, Some(-30.0)),
    ];
    for (criterion, tension, compression) in strengths {
        let [s1, s2] = plane(criterion, 0.0).unwrap();
        assert!((s1 - tension).abs() < 1e-6 && s2.abs() < 1e-6, "{criterion}: {s1}");
        let found = plane(criterion, 180.0).map(|[s1, _]| s1);
        assert_eq!(found.is_some(), compression.is_some(), "{criterion}");
        assert!((found.unwrap_or(0.0) - compression.unwrap_or(0.0)).abs() < 1e-6, "{criterion}: {found:?}");
    }
    // Pure shear: s1 = -s2 = k for Tresca and von Mises.
    for (criterion, shear) in [("Tresca", 5.0), ("von Mises", 10.0 / 3.0_f64.sqrt())] {
        let [s1, s2] = plane(criterion, 315.0).unwrap();
        assert!((s1 - shear).abs() < 1e-6 && (s2 + shear).abs() < 1e-6, "{criterion}: {s1} {s2}");
    }
    let circle = points(&table, "von Mises", "deviatoric");
    assert_eq!(circle.len(), 1440);
    for [_, s1, s2, s3] in circle {
        assert!((s1 + s2 + s3 + 15e6).abs() < 1.0);
        let j2 = ((s1 - s2).powi(2) + (s2 - s3).powi(2) + (s3 - s1).powi(2)) / 6.0;
        assert!((j2.sqrt() / 1e6 - 10.0 / 3.0_f64.sqrt()).abs() < 1e-6);
    }
}

#[test]
fn formulas_and_scenes_are_drawn() {
    let place = Place::new();
    place.succeed("criteria --formula s1-Ft --parameter Ft=3e6 -o formula.csv");
    let typed = points(&place.read("formula.csv"), "s1-Ft", "plane-stress");
    let [_, s1, ..] = typed[0];
    assert!((s1 - 3e6).abs() < 1.0);
    place.succeed("criteria cube-wall -o scene.png --set materials.plaster.fracture.tensile_strength=2e5");
    let picture = image::open(place.path().join("scene.png")).unwrap().to_rgb8();
    assert!(picture.width() > 1000);
    let blue = picture.pixels().filter(|pixel| pixel.0 == [0, 114, 178]).count();
    assert!(blue > 1000, "{blue} pixels of the curve's colour");
}

#[test]
fn criteria_that_make_no_sense_are_refused_with_the_place() {
    let place = Place::new();
    let message = |arguments: &[&str]| {
        let mut command = place.command("criteria -o x.csv");
        let output = command.args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        stderr(&output)
    };
    assert!(message(&["--formula", "s1 - "]).contains("column 6"));
    assert!(message(&["--formula", "s1/0 - 1"]).contains("divides by zero"));
    assert!(message(&["--criterion", "tresca shear_strength=0"]).contains("shear_strength"));
    let bad_angle = "{ criterion = \"mohr-coulomb\", cohesion = 1, friction_angle = 90 }";
    let refused = message(&["--criterion", bad_angle]);
    assert!(refused.contains("friction_angle") && refused.contains("column 62"), "{refused}");
    assert!(message(&["--criterion", "tresko"]).contains("tresca"));
    assert!(message(&["--mean-stress", "1 psi"]).contains("-5MPa"));
    assert!(message(&["cubes.toml"]).contains("fracture"));
    assert!(message(&["--set", "a=1"]).contains("--set a=1"));
    assert!(!place.has("x.csv"));
    assert!(place.fail("criteria -o x.gif", 2).contains("png"));
}

#[test]
fn frames_tell_when_elements_failed() {
    let place = Place::new();
    place.succeed("run beam-notch -o data --vtu --every 0.06");
    let mut earlier: Vec<f64> = Vec::new();
    let mut frame = 0;
    while place.has(&format!("data/frames/frame-{frame:06}.vtu")) {
        let cells = grid(&place.path().join(format!("data/frames/frame-{frame:06}.vtu"))).data.cell;
        let times_s = array(&cells, "failure_time_s");
        for (crack_faces, time_s) in array(&cells, "crack_faces").iter().zip(&times_s) {
            assert!(*crack_faces == 0.0 || *time_s > 0.0, "{crack_faces} {time_s}");
        }
        for (before_s, now_s) in earlier.iter().zip(&times_s) {
            assert!(before_s == now_s || *before_s == -1.0, "{before_s} {now_s}");
        }
        earlier = times_s;
        frame += 1;
    }
    let failed: Vec<f64> = earlier.into_iter().filter(|time_s| *time_s != -1.0).collect();
    assert!(!failed.is_empty(), "the beam breaks");
    let cracks = &place.json("data/summary.json")["cracks"];
    assert_eq!(cracks["failed_elements"], failed.len());
    assert_eq!(cracks["first_failure_s"], failed.iter().copied().fold(f64::INFINITY, f64::min));
}

#[test]
fn verify_tells_how_far_off_answers_are() {
    let place = Place::new();
    let table = place.succeed("verify --quick patch criteria squeeze");
    for word in ["patch: uniform strain", "criteria:", "squeeze:", "reference", "bound", "pass"] {
        assert!(table.contains(word), "{word}: {table}");
    }
    assert!(!table.contains("falls short"), "{table}");
    let json = place.succeed("verify --quick --json --report out patch criteria squeeze");
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["falls_short"], 0);
    let cases = found["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for quantity in cases.iter().flat_map(|case| case["quantities"].as_array().unwrap()) {
        assert!(quantity["value"].is_f64() && quantity["source"] != "", "{quantity}");
        assert!(quantity["bound"].is_null() || quantity["reason"] != "", "{quantity}");
    }
    assert!(place.read("out/report.html").contains("</html>"));
    let rows = place.read("out/quantities.csv").lines().count();
    let quantities: usize = cases.iter().map(|case| case["quantities"].as_array().unwrap().len()).sum();
    assert_eq!(rows, quantities + 1);
    assert_eq!(json, place.succeed("verify --quick --json --threads 1 patch criteria squeeze"));
}

#[test]
fn verify_refuses_what_it_does_not_know() {
    let place = Place::new();
    let message = place.fail("verify patch wings", 2);
    assert!(message.contains("`wings`") && message.contains("cantilever"), "{message}");
    let message = place.fail("verify patch --set a=1", 2);
    assert!(message.contains("--set a=1"), "{message}");
}
