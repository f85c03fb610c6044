//! The program as a user meets it: exit statuses, messages, and files that others can read.

mod criteria;
mod kill;
mod render;
mod run;
mod usage;
mod verify;

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output};
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

/// Pictures in a GIF; all of it must be readable.
fn pictures_of_gif(path: &Path) -> Vec<image::Frame> {
    use image::AnimationDecoder;
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let gif = image::codecs::gif::GifDecoder::new(file).unwrap();
    gif.into_frames().collect_frames().unwrap()
}

fn leftovers(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().flatten().any(|entry| {
        let path = entry.path();
        let is_partial = path.extension().is_some_and(|extension| extension == "partial");
        is_partial || (path.is_dir() && leftovers(&path))
    })
}

/// Sends a signal and at once its echo, as GNU `timeout` does.
#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &pid, &pid]).status();
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
