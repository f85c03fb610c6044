//! `hammerfall render`: pictures that others can read.

use crate::{Place, leftovers, pictures_of_gif, send, stderr, wait, wait_for};
use std::fs;
use std::process::Stdio;

#[test]
fn a_moment_is_rendered_to_a_png() {
    let place = Place::new();
    place.succeed("render cubes.toml -o one.png --at 50ms --color-by speed --wireframe");
    place.succeed("render cubes.toml -o cut.png --at 50ms --color-by mean-stress --color-range -2kPa..2kPa --cut -y --crosses");
    let picture = image::open(place.path().join("one.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (96, 64));
    let first = picture.get_pixel(0, 0);
    assert!(picture.pixels().any(|pixel| pixel != first), "an empty picture");
}

#[test]
fn limits_that_cracks_reach_are_told() {
    let place = Place::new();
    let told = place
        .succeed("render beam-notch -o beam.png --size 64x48 --set fracture.smallest_fragment=20 --at 2.58");
    assert!(told.contains("limit reached: ") && told.contains("(fracture.smallest_fragment)"), "{told}");
}

#[test]
fn a_moment_beyond_the_end_is_told_before_the_way_there() {
    let place = Place::new();
    let said = |line: &str| stderr(&place.run(line));
    let beyond = said("render cubes.toml -o one.png --at 0.15");
    assert!(beyond.starts_with("note: the scene ends at 0.12 s; it is simulated on to 0.15 s"), "{beyond}");
    assert!(said("render cubes.toml -o one.png --at 0.15 --panels").starts_with("note: the scene ends"));
    assert!(!said("render cubes.toml -o one.png --at 0.12").contains("note"));
    assert!(!said("render cubes.toml -o one.png --at 0.15 --quiet").contains("note"));
}

#[test]
fn without_a_side_the_camera_looks_into_a_cut() {
    let place = Place::new();
    let picture = |cut: &str| {
        place.succeed(&format!("render cubes.toml -o cut{cut}.png --at 10ms --camera front --cut {cut}"));
        fs::read(place.path().join(format!("cut{cut}.png"))).unwrap()
    };
    assert_eq!(picture("y"), picture("-y"));
    assert_ne!(picture("y"), picture("+y"));
}

#[test]
fn a_missing_folder_of_a_single_file_is_told_before_anything_runs() {
    let place = Place::new();
    for line in [
        "render cubes.toml -o new/one.png",
        "render cubes.toml -o new/one.gif",
        "render cubes.toml -o new/one.png --panels",
    ] {
        let told = place.fail(line, 2);
        assert!(told.contains("the folder `new` does not exist; create it first"), "{line}: {told}");
        assert!(!place.has("new"));
    }
}

#[test]
fn what_takes_the_place_of_a_file_says_so() {
    let place = Place::new();
    let said = || stderr(&place.run("render cubes.toml -o one.png --at 10ms"));
    assert!(!said().contains("replacing"));
    assert!(said().contains("replacing `one.png`"));
}

#[test]
fn a_cut_that_meets_nothing_is_warned_about() {
    let place = Place::new();
    let quiet = place.run("render cubes.toml -o cut.png --at 10ms --cut x=77 --quiet");
    assert!(stderr(&quiet).contains("warning: `--cut` goes through no body that moves"));
    let said = |cut: &str| stderr(&place.run(&format!("render cubes.toml -o cut.png --at 10ms --cut {cut}")));
    let own = place.run("render cubes.toml -o cut.png --at 10ms --set recording.cut={across=[1,0,0],at=77}");
    assert!(stderr(&own).contains("warning: `recording.cut` goes through no body that moves"));
    assert!(said("x=77").contains("warning: `--cut` goes through no body that moves: the plane is at 77 m"));
    assert!(!said("x").contains("warning"));
}

#[test]
fn an_animation_is_rendered_to_a_gif_and_to_a_folder() {
    let place = Place::new();
    // 0.12 s at 20 pictures a second, five times slower: one every 10 ms, both ends included.
    place.succeed("render cubes.toml -o fall.gif --slow-motion 5 --size 64x48 --camera front");
    let frames = pictures_of_gif(&place.path().join("fall.gif"));
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
    assert!(!pictures_of_gif(&place.path().join("long.gif")).is_empty());
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
