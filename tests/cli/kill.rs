//! `kill -9` at any moment: what was written stays readable, and running again needs no force.
//!
//! Moments are found by what lies on the disk, not by the clock.

use crate::{Place, array, grid, leftovers, pictures_of_gif, rows, wait_for};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;

/// Ends the child without letting it say a word.
fn kill(mut child: Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |metadata| metadata.len())
}

/// All files in a folder and the folders in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The kernel takes a write a page at a time and may stop between two for a killed program.
const PAGE: usize = 4096;

/// The whole rows of a history; all of it, but for a row that a page's end has cut.
fn whole_rows(history: &str) -> &str {
    let whole = history.rfind('\n').map_or(0, |end| end + 1);
    let rest = &history[whole..];
    assert!(rest.is_empty() || history.len().is_multiple_of(PAGE), "half a row: {rest}");
    &history[..whole]
}

/// Checks whatever a killed run has left; files under temporary names are nobody's.
fn check_run(place: &Place) -> usize {
    let folder = place.path().join("data");
    if length(&folder.join("history.csv")) > 0 {
        let history = place.read("data/history.csv");
        let mut before_s = f64::NEG_INFINITY;
        for row in rows(whole_rows(&history)) {
            let time_s: f64 = row[0].parse().unwrap();
            assert!(time_s > before_s && row.iter().all(|field| !field.is_empty()));
            before_s = time_s;
        }
    }
    if place.has("data/summary.json") {
        assert_eq!(place.json("data/summary.json")["status"], "running");
    }
    let mut listed = 0;
    if place.has("data/run.pvd") {
        let collection = place.read("data/run.pvd");
        assert!(collection.trim_end().ends_with("</VTKFile>"), "{collection}");
        for entry in collection.split("file=\"").skip(1) {
            let name = entry.split('"').next().unwrap();
            assert!(place.has(&format!("data/{name}")), "{name} is listed but not there");
            listed += 1;
        }
    }
    for path in files(&folder).iter().filter(|path| path.extension().is_some_and(|ending| ending == "vtu")) {
        let frame = grid(path);
        assert_eq!(array(&frame.data.point, "velocity").len(), 3 * frame.num_points(), "{}", path.display());
    }
    listed
}

#[test]
fn a_killed_run_leaves_whole_rows_and_frames() {
    let mut listed = 0;
    for frames in [0, 1, 7, 60] {
        let place = Place::new();
        let child =
            place.command("run cubes.toml -o data --vtu --duration 1e6 --every 1ms --quiet").spawn().unwrap();
        let frame = place.path().join(format!("data/frames/frame-{frames:06}.vtu"));
        // In the middle of writing it, if the disk lets us see that.
        wait_for(|| frame.exists() || frame.with_extension("vtu.partial").exists());
        kill(child);
        listed = check_run(&place);
        place.succeed("run cubes.toml -o data --duration 2ms");
        assert!(!leftovers(place.path()), "the next run clears up");
    }
    assert!(listed > 50, "{listed} frames are listed");
}

#[test]
fn a_run_killed_among_its_rows_leaves_whole_ones() {
    for bytes in [1, 3_000, 40_000, 200_000] {
        let place = Place::new();
        let child = place.command("run cubes.toml -o data --duration 1e6 --every 0 --quiet").spawn().unwrap();
        let history = place.path().join("data/history.csv");
        wait_for(|| length(&history) >= bytes);
        kill(child);
        check_run(&place);
    }
}

#[test]
fn a_killed_gif_can_be_watched() {
    let mut most = 0;
    for bytes in [0, 1, 5_000, 30_000] {
        let place = Place::new();
        let line = "render cubes.toml -o fall.gif --duration 2 --slow-motion 20 --size 64x48 --quiet";
        let child = place.command(line).spawn().unwrap();
        let gif = place.path().join("fall.gif");
        if bytes == 0 {
            wait_for(|| {
                files(place.path()).iter().any(|path| path.file_name().is_some_and(|n| n != "cubes.toml"))
            });
        } else {
            wait_for(|| length(&gif) >= bytes);
        }
        kill(child);
        if gif.exists() {
            let pictures = pictures_of_gif(&gif).len();
            assert!(pictures > 0, "a GIF without pictures");
            most = most.max(pictures);
        }
    }
    assert!(most > 5, "{most} pictures");
}

#[test]
fn killed_pictures_are_whole_or_not_there() {
    for count in [1, 12] {
        let place = Place::new();
        let line = "render cubes.toml -o frames --duration 2 --slow-motion 20 --size 320x240";
        let child = place.command(&format!("{line} --quiet")).spawn().unwrap();
        let last = place.path().join(format!("frames/frame-{:05}.png", count - 1));
        wait_for(|| last.exists());
        kill(child);
        let all = files(&place.path().join("frames"));
        let pngs: Vec<_> = all.iter().filter(|path| path.extension().is_some_and(|e| e == "png")).collect();
        assert!(pngs.len() >= count);
        for path in pngs {
            assert_eq!(image::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).width(), 320);
        }
        // A picture that was being written counts as ours: no --force is needed.
        fs::write(place.path().join("frames/frame-00099.png.partial"), "half a picture").unwrap();
        place.succeed("render cubes.toml -o frames --duration 0.05 --size 64x48");
        assert!(!place.has("frames/frame-00099.png.partial"));
    }
}

#[test]
fn a_killed_picture_leaves_the_one_before() {
    let place = Place::new();
    place.succeed("render cubes.toml -o one.png --at 50ms");
    let before = fs::read(place.path().join("one.png")).unwrap();
    let child =
        place.command("render cubes.toml -o one.png --at 20 --size 1600x1200 --quiet").spawn().unwrap();
    let picture = place.path().join("one.png");
    let partial = place.path().join("one.png.partial");
    // Either the trial that it can be written at all, or the picture itself.
    wait_for(|| partial.exists() || length(&picture) != before.len() as u64);
    kill(child);
    image::open(&picture).unwrap();
}
