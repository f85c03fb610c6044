//! `hammerfall run`: tables, summaries and frames that read back.

use crate::{Place, array, grid, leftovers, rows, send, stderr, times_s, wait, wait_for};
use std::fs;
use std::process::Stdio;

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

#[test]
fn frames_tell_when_elements_failed() {
    let place = Place::new();
    let told = place.succeed("run beam-notch -o data --vtu --every 0.06");
    assert!(told.contains("stable step of `beam` as cut"), "{told}");
    assert!(!told.contains("limit reached"), "{told}");
    let told = place.succeed("run beam-notch -o limited --set fracture.max_elements=32");
    assert!(told.contains("limit reached: ") && told.contains("(fracture.max_elements)"), "{told}");
    let told = place.succeed("run beam-notch -o slow --set fracture.crack_speed=0.5");
    assert!(told.contains("limit reached: ") && told.contains("(fracture.crack_speed)"), "{told}");
    assert!(place.json("slow/summary.json")["fracture_limits_reached"]["speed"].as_u64() > Some(0));
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
