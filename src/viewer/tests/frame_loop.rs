//! The frame loop without a screen: it waits for no simulation, and survives the loss of its device.

use super::TIME_LIMIT;
use crate::render::Picture;
use crate::viewer::app::App;
use crate::viewer::frame_times::FrameTimes;
use crate::viewer::measure::Turning;
use crate::viewer::off_screen_window::OffScreenWindow;
use crate::viewer::pacing::FRAME_S;
use crate::viewer::simulation::Simulation;
use crate::viewer::snapshot::Command;
use crate::viewer::thumbnails::Sketcher;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A block of 55,566 elements that hits the ground.
const LARGE: &str = r#"
title = "A large block"

[materials.block]
density = 1100
youngs_modulus = 8e5
poisson_ratio = 0.4

[ground]
size = 3.0

[[bodies]]
name = "block"
shape = { type = "box", size = [0.6, 0.6, 0.6], cells = 21, split = "six" }
material = "block"
on = "ground"
gap = 1e-4
velocity = [0, 0, -3]

[time]
duration = 1.0
"#;
const SIZE_PX: [u32; 2] = [640, 420];

fn open(simulation: Simulation, scene: &str) -> OffScreenWindow {
    let mut app = App::new(simulation, Sketcher::idle());
    app.open(scene, &[]);
    let mut window = OffScreenWindow::new(app, SIZE_PX, 1.0).unwrap();
    wait(&mut window, "the scene", |app| app.snapshot.scene.is_some() && !app.is_waiting());
    window
}

fn wait(window: &mut OffScreenWindow, what: &str, is_so: impl Fn(&App) -> bool) {
    let asked = Instant::now();
    while !is_so(&window.app) {
        let input = window.input(FRAME_S, Vec::new());
        window.frame(input).unwrap();
        std::thread::sleep(Duration::from_millis(2));
        assert!(asked.elapsed() < TIME_LIMIT, "waited in vain: {what}; told: {:?}", window.app.notice());
    }
}

fn frames(window: &mut OffScreenWindow, turning: &mut Turning, count: u32) -> FrameTimes {
    let mut times = FrameTimes::default();
    (0..count).for_each(|_| times.note(turning.frame(window).unwrap()));
    times
}

/// The figure in ms is that of `hammerfall view SCENE --measure-frames N`; here only what holds on a busy machine too:
/// the same frames with and without a simulation beside them.
#[test]
fn the_window_answers_while_fifty_thousand_elements_are_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.toml");
    std::fs::write(&path, LARGE).unwrap();
    let simulation = Simulation::start(Box::new(|| {})).unwrap();
    let mut window = open(simulation, path.to_str().unwrap());
    let mut turning = Turning::new(SIZE_PX);
    wait(&mut window, "time", |app| app.snapshot.frame.status.steps > 2);
    assert!(window.app.snapshot.frame.status.elements >= 50_000);
    frames(&mut window, &mut turning, 5);
    let steps = window.app.snapshot.frame.status.steps;
    let mut running = frames(&mut window, &mut turning, 40);
    let asked = Instant::now();
    // The window goes first where cores are scarce: a step may take long then, but comes.
    while window.app.snapshot.frame.status.steps <= steps {
        running.note(turning.frame(&mut window).unwrap());
        assert!(asked.elapsed() < TIME_LIMIT, "the simulation stands still");
    }
    assert!(window.app.snapshot.is_playing);
    window.app.press_for_test(Command::Pause);
    wait(&mut window, "the pause", |app| !app.snapshot.is_playing && !app.is_waiting());
    let paused = frames(&mut window, &mut turning, 40);
    println!("50,000 elements: running, {running}; paused, {paused}");
    // Two threads share the cores then, and each new moment has to be drawn anew; waiting for steps would add up to
    // the tenths of a second that lie between two moments.
    assert!(running.within(0.5) < 6 * paused.within(0.5), "running, {running}; paused, {paused}");
}

/// Whatever the simulation's thread is busy with, even for ever, frames go on and commands are taken.
#[test]
fn frames_go_on_while_the_simulation_answers_nothing() {
    let is_held = Arc::new(AtomicBool::new(false));
    let held = is_held.clone();
    let hold = move || {
        while held.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    let mut window = open(Simulation::start(Box::new(hold)).unwrap(), "bounce");
    let mut turning = Turning::new(SIZE_PX);
    is_held.store(true, Ordering::Relaxed);
    // This one the thread still carries out; then it is held.
    window.app.press_for_test(Command::Step);
    let before = window.app.look.camera;
    for _ in 0..20 {
        window.app.press_for_test(Command::SetSpeed(0.1));
        turning.frame(&mut window).unwrap();
    }
    assert!(window.app.is_waiting(), "the thread was not held");
    assert_ne!(window.app.look.camera, before, "the mouse turns nothing");
    is_held.store(false, Ordering::Relaxed);
    wait(&mut window, "an answer", |app| !app.is_waiting());
    assert!((window.app.snapshot.speed - 0.1).abs() < 1e-12);
}

/// No clock has a say: frames are said to take as long as those of a large scene on a software driver.
#[test]
fn slow_frames_are_drawn_less_finely_until_everything_stands_still() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "bounce");
    window.app.press_for_test(Command::Pause);
    wait(&mut window, "the pause", |app| !app.snapshot.is_playing && !app.is_waiting());
    let camera = window.app.look.camera;
    let fine = picture(&mut window);
    window.steer();
    window.assumed = Some(Duration::from_millis(90));
    for _ in 0..8 {
        turn_away(&mut window, 1);
        // The next layout tells.
        assert_eq!(window.app.detail, window.detail());
    }
    assert_eq!(window.detail(), Some("draft, 1/2"));
    window.app.look.camera = camera;
    let draft = picture(&mut window);
    let scene = |picture: &Picture| (120..350).map(|y| picture.rgb_at(320, y)).collect::<Vec<_>>();
    assert_ne!(scene(&draft), scene(&fine));
    // The panels tell.
    assert_eq!(window.app.detail, window.detail());
    window.idle(Duration::from_secs(1));
    let mut pieces = 0;
    while scene(&picture(&mut window)) != scene(&fine) {
        pieces += 1;
        assert!(pieces < 20, "the picture does not become fine");
    }
    assert!(pieces > 5, "the window would not answer while all of it is drawn: {pieces}");
    // Whoever wants it finely all the same, gets it.
    window.app.look.is_always_fine = true;
    turn_away(&mut window, 1);
    window.app.look.camera = camera;
    assert_eq!(scene(&picture(&mut window)), scene(&fine));
    assert_eq!(window.app.detail, None);
}

/// A large scene's new moments do not take all of the time: the camera is drawn anew in each frame, the moment not.
#[test]
fn frames_do_not_wait_for_new_moments() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "bounce");
    window.steer();
    window.assumed = Some(Duration::from_millis(90));
    turn_away(&mut window, 6);
    let (mut frames, mut drawn) = (0, 0);
    let mut last = window.drawn_frame();
    let asked = Instant::now();
    while drawn < 10 {
        let camera = window.app.look.camera;
        turn_away(&mut window, 1);
        assert_ne!(window.app.look.camera, camera);
        frames += 1;
        let now = window.drawn_frame();
        drawn += u32::from(!Arc::ptr_eq(now.as_ref().unwrap(), last.as_ref().unwrap()));
        last = now;
        assert!(asked.elapsed() < TIME_LIMIT, "time stands still");
    }
    assert!(2 * drawn <= frames + 1, "new moments in {drawn} of {frames} frames");
}

/// What changes is painted into what is there already: the same bytes as all of it painted anew.
#[test]
fn painting_what_changed_gives_the_same_picture_as_painting_all() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "bounce");
    wait(&mut window, "plots", |app| app.snapshot.history.rows().len() > 20);
    window.app.press_for_test(Command::Pause);
    wait(&mut window, "the pause", |app| !app.snapshot.is_playing && !app.is_waiting());
    let deeds: [fn(&mut App); 9] = [
        |_| {},
        |app| app.look.is_dark = true,
        |app| app.look.is_dark = false,
        |app| app.look.wireframe = true,
        |app| app.panels.help = true,
        |app| app.panels.help = false,
        |app| app.panels.inspector = false,
        |app| app.tell("Something went wrong".to_owned()),
        |app| app.look.camera.distance_m *= 1.5,
    ];
    for (number, deed) in deeds.into_iter().enumerate() {
        deed(&mut window.app);
        for x in [30.0, 160.0, 400.0, 600.0] {
            let at = egui::Event::PointerMoved(egui::pos2(x, 14.0 + 60.0 * number as f32));
            let input = window.input(FRAME_S, vec![at]);
            window.frame(input).unwrap();
        }
        assert_same_when_painted_anew(&mut window, &format!("deed {number}"));
    }
    // Text in the line at the bottom is selected, and then no more.
    let line = SIZE_PX[1] as f32 - 12.0;
    let plain = assert_same_when_painted_anew(&mut window, "all deeds");
    drag(&mut window, [egui::pos2(12.0, line), egui::pos2(300.0, line)]);
    let selected = assert_same_when_painted_anew(&mut window, "a text is selected");
    drag(&mut window, [egui::pos2(620.0, line); 2]);
    assert_same_when_painted_anew(&mut window, "nothing is selected any more");
    assert!(differing(&plain, &selected) > 200, "nothing was selected");
}

fn drag(window: &mut OffScreenWindow, [from, to]: [egui::Pos2; 2]) {
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let [moved, there] = [from, to].map(egui::Event::PointerMoved);
    for event in [moved, button(from, true), there.clone(), button(to, false), there] {
        let input = window.input(0.5, vec![event]);
        window.frame(input).unwrap();
    }
}

fn assert_same_when_painted_anew(window: &mut OffScreenWindow, after: &str) -> Picture {
    // Nothing moves between both.
    let input = window.input(0.0, Vec::new());
    let parts = window.picture(input).unwrap();
    window.forget_what_is_painted();
    let input = window.input(0.0, Vec::new());
    let whole = window.picture(input).unwrap();
    assert!(parts == whole, "after {after}: {} pixels differ", differing(&parts, &whole));
    whole
}

fn differing(a: &Picture, b: &Picture) -> usize {
    let places = (0..a.height).flat_map(|y| (0..a.width).map(move |x| (x, y)));
    places.filter(|(x, y)| a.rgb_at(*x, *y) != b.rgb_at(*x, *y)).count()
}

fn turn_away(window: &mut OffScreenWindow, frames: u32) {
    for _ in 0..frames {
        window.app.look.camera.distance_m *= 1.01;
        let input = window.input(FRAME_S, Vec::new());
        window.frame(input).unwrap();
    }
}

fn picture(window: &mut OffScreenWindow) -> Picture {
    let input = window.input(FRAME_S, Vec::new());
    window.picture(input).unwrap()
}

#[test]
fn looking_at_a_scene_changes_nothing_of_it_whatever_its_sliders_offer() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "pile-split");
    let overrides = ["time.cfl=0.01", "contact.passes=80", "fracture.max_elements=2000000"];
    for overrides in [&overrides[..0], &overrides] {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        window.app.open("pile-split", &overrides);
        wait(&mut window, "the scene", |app| app.snapshot.scene.is_some() && !app.is_waiting());
        let contact = window.app.snapshot.contact.clone();
        for _ in 0..3 {
            picture(&mut window);
        }
        let scene = window.app.snapshot.scene.clone().unwrap();
        assert!(!window.app.edits.wait_for_reset(&scene), "{:?}", window.app.edits.fracture);
        assert_eq!(window.app.snapshot.contact, contact);
        assert_eq!(window.app.snapshot.undo, None);
    }
}

#[test]
fn a_lost_device_is_opened_anew_and_nothing_of_the_scene_is_lost() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "bounce");
    let moments = |app: &App| app.snapshot.recording.moments().len();
    wait(&mut window, "a recording", |app| moments(app) > 10);
    let before = (moments(&window.app), window.app.snapshot.frame.time_s, window.app.look.camera);
    window.lose_device();
    let input = window.input(FRAME_S, Vec::new());
    let error = window.frame(input).unwrap_err();
    assert!(matches!(error, crate::render::GpuError::Lost(_)), "{error}");
    // Lost for good: so is the next frame, and still nothing panics.
    let input = window.input(FRAME_S, Vec::new());
    assert!(window.frame(input).is_err());
    window.recover().unwrap();
    wait(&mut window, "more", |app| moments(app) > before.0 && app.snapshot.frame.time_s > before.1);
    assert_eq!(window.app.look.camera, before.2);
    let input = window.input(FRAME_S, Vec::new());
    let picture = window.picture(input).unwrap();
    let [x, y] = [picture.width / 2, picture.height / 2];
    assert!(picture.rgb_at(x, y) != picture.rgb_at(4, 60), "nothing is drawn");
}

#[test]
fn a_window_without_size_is_laid_out_and_not_drawn() {
    let mut window = open(Simulation::start(Box::new(|| {})).unwrap(), "bounce");
    for size_px in [[0, 0], [0, 300], [300, 0], [1, 1], SIZE_PX] {
        window.size_px = size_px;
        for _ in 0..3 {
            let input = window.input(FRAME_S, Vec::new());
            window.frame(input).unwrap();
        }
    }
}
