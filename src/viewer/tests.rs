//! The whole window without a screen: real buttons are pressed, real values moved.

mod frame_loop;
mod layout;
mod panels;
mod picking;
mod random_input;
mod taking_home;
mod throwing;

use super::app::App;
use super::simulation::Simulation;
use super::thumbnails::Sketcher;
use crate::frame::{BodyRole, ColorBy};
use crate::scene::Scene;
use crate::sim::World;
use egui::{Event, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest wait for anything; a busy machine is slow, a stuck thread never comes back.
const TIME_LIMIT: Duration = Duration::from_secs(120);
/// Tall, so that every button of the panels is on the screen.
const SIZE: [f32; 2] = [1500.0, 2400.0];

type Window = Harness<'static, App>;

fn window() -> Window {
    let simulation = Simulation::start(Box::new(|| {})).unwrap();
    let app = App::new(simulation, Sketcher::start(Box::new(|| {})));
    let mut is_installed = false;
    let builder = Harness::builder().with_size(SIZE).with_max_steps(4);
    let mut window = builder.build_ui_state(
        move |ui, app: &mut App| {
            if !is_installed {
                super::ui::style::install(ui.ctx());
                is_installed = true;
            }
            app.update(ui);
        },
        app,
    );
    window.step();
    window
}

/// Lays out frames until something is so.
fn wait(window: &mut Window, what: &str, is_so: impl Fn(&App) -> bool) {
    let asked = Instant::now();
    while !is_so(window.state()) {
        window.step();
        std::thread::sleep(Duration::from_millis(3));
        assert!(asked.elapsed() < TIME_LIMIT, "waited in vain: {what}; told: {:?}", window.state().notice());
    }
}

fn settle(window: &mut Window) {
    (0..12).for_each(|_| window.step());
    wait(window, "commands", |app| !app.is_waiting());
}

/// A scene that is paused, whose material breaks by a formula.
fn with_a_formula() -> Window {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.get_by_value("Never breaks").click();
    settle(&mut window);
    press(&mut window, "Formula");
    window
}

fn press(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

fn drag(window: &mut Window, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.event(button(from, true));
    window.step();
    for share in 1..=8 {
        window.event(Event::PointerMoved(from + (to - from) * (share as f32 / 8.0)));
        window.step();
    }
    window.event(button(to, false));
    window.step();
}

fn open(window: &mut Window, scene: &str) {
    window.get_by_label(&format!("Open {scene}")).click();
    wait(window, "the scene", |app| app.snapshot.scene.is_some() && app.viewport.is_some());
    settle(window);
}

/// The world of a saved scene at the end of what the window has recorded: it has the same bytes at every moment.
fn replayed(saved: &Scene, window: &Window) -> World {
    let mut world = World::new(saved.setup.clone()).unwrap();
    for moment in window.state().snapshot.recording.moments() {
        while world.time_s() < moment.time_s {
            world.step(moment.time_s).unwrap();
        }
        // A moment at which somebody throws is recorded before the throw.
        let frame = world.publish();
        for (now, then) in frame.bodies.iter().zip(&moment.frame.bodies) {
            assert_eq!(now.positions_m, then.positions_m, "{} at {}", then.name, moment.time_s);
            assert_eq!(now.fields.von_mises_pa, then.fields.von_mises_pa);
        }
    }
    world
}

#[test]
fn choose_change_throw_break_scrub_save_and_reload() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open(&mut window, "brick-pile");
    press(&mut window, "Pause (space)");
    window.state_mut().save.folder = folder.path().to_str().unwrap().to_owned();

    // Another criterion, which acts on reset.
    press(&mut window, "brick");
    window.get_by_value("Mohr-Coulomb, tension cut-off").click();
    settle(&mut window);
    press(&mut window, "Tension (Rankine)");
    press(&mut window, "Reset to apply the changes  (R)");
    let scene = window.state().snapshot.scene.clone().unwrap();
    let brick = scene.description.materials.iter().find(|material| material.name == "brick").unwrap();
    assert_eq!(brick.fracture.as_ref().unwrap().rules().len(), 1);

    // It breaks.
    press(&mut window, "Play (space)");
    wait(&mut window, "fragments", |app| app.snapshot.frame.status.fragments > 7);
    press(&mut window, "Pause (space)");

    // However far its pieces are moved apart, all of them fit into the view.
    window.state_mut().look.explode = 2.0;
    press(&mut window, "Fit");
    let (app, camera) = (window.state(), window.state().look.camera);
    let aspect = app.viewport.unwrap().aspect_ratio();
    let places = app.drawn().moving().flat_map(|body| &body.positions_m);
    let places = places.map(|place| camera.picture_position(glam::Vec3::from(*place), aspect).unwrap());
    let beyond = places.filter(|at| at.min_element() < 0.0 || at.max_element() > 1.0).count();
    assert_eq!(beyond, 0);
    window.state_mut().look.explode = 0.0;
    press(&mut window, "Fit");

    // A hammer.
    let bodies = window.state().snapshot.frame.bodies.len();
    press(&mut window, "Throw with the mouse");
    let area = window.state().viewport.unwrap();
    drag(&mut window, area.min + 0.2 * area.size(), area.center());
    settle(&mut window);
    let snapshot = window.state().snapshot.clone();
    assert_eq!(snapshot.frame.bodies.len(), bodies + 1, "{:?}", window.state().notice());
    assert!(snapshot.undo.as_ref().is_some_and(|what| what.contains("Hammer")));
    let thrown_s = snapshot.frame.time_s;
    press(&mut window, "Play (space)");
    wait(&mut window, "time", |app| app.snapshot.frame.time_s > thrown_s + 4e-3);
    press(&mut window, "Pause (space)");

    // Back to before the throw, and to the present again.
    let bar = window.get_by_label("Timeline").rect();
    drag(&mut window, bar.center(), bar.left_center() + egui::vec2(bar.width() * 0.02, 0.0));
    settle(&mut window);
    let app = window.state();
    assert!(app.player.is_back() && app.shown().time_s < thrown_s && app.shown().bodies.len() == bodies);
    assert!(app.snapshot.frame.time_s > thrown_s, "looking back changes nothing");
    press(&mut window, "Now");
    assert_eq!(window.state().shown().bodies.len(), bodies + 1);

    // Save it all.
    for (button, ending) in [("Scene", "toml"), ("OBJ", "obj"), ("Picture", "png"), ("GIF", "gif")] {
        press(&mut window, button);
        wait(&mut window, button, |app| !app.saver.is_busy());
        let told: Vec<_> = window.state().save.lines().collect();
        assert!(told.iter().all(|(text, is_failure)| text.contains("aved") && !is_failure), "{told:?}");
        let path = folder.path().join(format!("brick-pile.{ending}"));
        assert!(path.metadata().is_ok_and(|file| file.len() > 500), "{}", path.display());
    }

    // The saved scene gives the same bytes at every recorded moment.
    let path = folder.path().join("brick-pile.toml");
    let saved = Scene::load(path.to_str().unwrap(), &[]).unwrap();
    let world = replayed(&saved, &window);
    assert!(world.body_count() == bodies + 1 && world.time_s() > thrown_s);
}

#[test]
fn play_on_from_an_earlier_moment_and_take_a_throw_back() {
    let mut window = window();
    open(&mut window, "bounce");
    wait(&mut window, "time", |app| app.snapshot.recording.moments().len() > 30);
    press(&mut window, "Pause (space)");
    press(&mut window, "Ball");
    let with_ball = window.state().snapshot.frame.bodies.len();
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Z);
    settle(&mut window);
    assert_eq!(window.state().snapshot.frame.bodies.len(), with_ball - 1);
    let end_s = window.state().snapshot.frame.time_s;
    for _ in 0..10 {
        window.key_press(egui::Key::ArrowLeft);
        window.step();
    }
    let back_s = window.state().shown().time_s;
    assert!(back_s < end_s);
    window.get_by_label("Play on from here").click();
    wait(&mut window, "playing", |app| !app.player.is_back() && app.snapshot.is_playing);
    press(&mut window, "Pause (space)");
    let times: Vec<f64> = window.state().snapshot.history.rows().iter().map(|row| row.time_s).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
}

/// Drags with a key held, in so many frames.
fn drag_held(window: &mut Window, path: [Pos2; 2], modifiers: Modifiers, frames: u32) {
    hold(window, path, modifiers, frames);
    release(window, path[1], modifiers);
}

/// Drags in so many frames, and does not let go.
fn hold(window: &mut Window, [from, to]: [Pos2; 2], modifiers: Modifiers, frames: u32) {
    window.event(Event::ModifiersChanged(modifiers));
    window.event(Event::PointerMoved(from));
    window.event(primary_button(from, true, modifiers));
    window.step();
    for frame in 1..=frames {
        window.event(Event::PointerMoved(from + (to - from) * (frame as f32 / frames as f32)));
        window.step();
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn release(window: &mut Window, at: Pos2, modifiers: Modifiers) {
    window.event(primary_button(at, false, modifiers));
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    window.step();
}

fn primary_button(pos: Pos2, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers }
}

#[test]
fn a_body_is_pulled_with_the_mouse_saved_repeated_taken_back_and_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.state_mut().save.folder = folder.path().to_str().unwrap().to_owned();
    let app = window.state();
    let area = app.viewport.unwrap();
    let ball = app.snapshot.frame.bodies.last().unwrap();
    let middle = ball.positions_m.iter().map(|p| glam::Vec3::from(*p)).sum::<glam::Vec3>();
    let middle = middle / ball.positions_m.len() as f32;
    let share = app.look.camera.picture_position(middle, area.width() / area.height()).unwrap();
    let at = area.min + egui::vec2(share.x, share.y) * area.size();
    let yaw_rad = app.look.camera.yaw_rad;
    drag_held(&mut window, [at, at + egui::vec2(150.0, -80.0)], Modifiers::SHIFT, 40);
    settle(&mut window);
    press(&mut window, "Pause (space)");
    let app = window.state();
    assert_eq!(app.look.camera.yaw_rad, yaw_rad, "the camera turned instead");
    assert!(app.snapshot.undo.as_ref().is_some_and(|what| what.contains("ball pulled")));
    let moments = app.snapshot.recording.moments();
    assert!(moments.iter().any(|moment| !moment.frame.pulls.is_empty()), "the spring is not shown");
    assert!(app.snapshot.frame.pulls.is_empty(), "it was let go");

    press(&mut window, "Scene");
    wait(&mut window, "the scene", |app| !app.saver.is_busy());
    let path = folder.path().join("bounce.toml");
    let saved = Scene::load(path.to_str().unwrap(), &[]).unwrap();
    assert_eq!(saved.description.pulls.len(), 1);
    replayed(&saved, &window);

    // From the start, with the same pull; then without it.
    press(&mut window, "Rerun");
    let scene = window.state().snapshot.scene.clone().unwrap();
    assert_eq!((window.state().snapshot.frame.time_s, scene.description.pulls.len()), (0.0, 1));
    window.key_press(egui::Key::R);
    settle(&mut window);
    assert!(window.state().snapshot.scene.as_ref().unwrap().description.pulls.is_empty());
    assert!(!window.state().snapshot.can_repeat);

    // Taken back and done again by keys.
    press(&mut window, "Ball");
    let bodies = |window: &Window| window.state().snapshot.frame.bodies.len();
    let with_ball = bodies(&window);
    for (modifiers, key, count) in [
        (Modifiers::COMMAND, egui::Key::Z, with_ball - 1),
        (Modifiers::COMMAND | Modifiers::SHIFT, egui::Key::Z, with_ball),
        (Modifiers::COMMAND, egui::Key::Z, with_ball - 1),
        (Modifiers::COMMAND, egui::Key::Y, with_ball),
    ] {
        window.key_press_modifiers(modifiers, key);
        settle(&mut window);
        assert_eq!(bodies(&window), count, "{modifiers:?} {key:?}");
    }
}

#[test]
fn a_formula_is_told_where_it_is_wrong_while_it_is_typed() {
    let mut window = with_a_formula();
    let typed = window.state().edits.criteria[0].formula.clone();
    // The field and the text in it.
    window.get_all_by_value(&typed).next().unwrap().click();
    settle(&mut window);
    // The click, in the middle of the field, puts the cursor at the end of the short text.
    window.event(Event::Text(" - F".to_owned()));
    settle(&mut window);
    // The error has appeared by now; the keyboard still belongs to the field, and its letters are no shortcuts.
    assert!(window.query_by_label_contains("Column").is_some());
    window.event(Event::Text("tt".to_owned()));
    settle(&mut window);
    assert_eq!(window.state().edits.criteria[0].formula, format!("{typed} - Ftt"));
    let column = format!("Column {}", typed.len() + 4);
    assert!(window.query_by_label_contains(&column).is_some(), "the place is not told");
    window.state_mut().edits.criteria[0].formula = "s1 - 2*MPa".to_owned();
    settle(&mut window);
    assert!(window.query_by_label_contains("Column").is_none());
    press(&mut window, "Reset to apply the changes  (R)");
    let scene = window.state().snapshot.scene.clone().unwrap();
    assert!(scene.description.materials.iter().any(|material| material.fracture.is_some()));
}

#[test]
fn a_cut_stays_where_the_scene_says_even_far_from_all_bodies() {
    let mut window = window();
    let cut = "recording.cut={ across = [0, 0, -1], at = -9 }".to_owned();
    window.state_mut().open("bounce", &[cut]);
    wait(&mut window, "the scene", |app| app.snapshot.scene.is_some() && app.viewport.is_some());
    settle(&mut window);
    let closer = window.state().look.closer;
    assert_eq!((closer.position_m, closer.cut().unwrap().position_m), (9.0, -9.0));
    // Its panel says that nothing is cut, until something is.
    assert!(window.query_by_label_contains("goes through no body that moves").is_some());
    window.state_mut().look.closer.center();
    settle(&mut window);
    assert!(window.query_by_label_contains("goes through no body").is_none());
    // There is but one piece.
    assert!(window.query_by_label_contains("nothing to explode").is_none());
    window.state_mut().look.explode = 1.0;
    settle(&mut window);
    assert!(window.query_by_label_contains("nothing to explode").is_some());
}

#[test]
fn bodies_are_cut_open_and_stress_crosses_shown() {
    let mut window = window();
    open(&mut window, "bounce");
    wait(&mut window, "time", |app| app.snapshot.recording.moments().len() > 12);
    press(&mut window, "Pause (space)");
    let area = |app: &App| app.drawn().bodies.iter().map(|body| body.surface.triangles.len()).sum::<usize>();
    let whole = area(window.state());
    press(&mut window, "Cut the bodies open");
    wait(&mut window, "the inside", |app| app.snapshot.with_interior);
    settle(&mut window);
    let cut = window.state().look.closer.cut().unwrap();
    assert!(cut.normal.dot(window.state().look.camera.axes()[2]) > 0.0, "the section faces away");
    let moving = |app: &App| app.drawn().bodies.iter().rposition(|body| body.role == BodyRole::Deformable);
    let ball = moving(window.state()).unwrap();
    let body = window.state().drawn().bodies[ball].clone();
    assert!(!body.positions_m.is_empty() && body.positions_m.iter().all(|p| cut.beyond_m(*p) < 1e-5));
    // The section is there: many points lie in the plane.
    let in_plane = body.positions_m.iter().filter(|p| cut.beyond_m(**p).abs() < 1e-6).count();
    assert!(in_plane > 20, "{in_plane}");
    assert_ne!(area(window.state()), whole);
    press(&mut window, "Leave out the other side");
    let body = &window.state().drawn().bodies[ball];
    assert!(body.positions_m.iter().all(|p| cut.beyond_m(*p) > -1e-5));
    press(&mut window, "Free");
    let normal = window.state().look.closer.normal();
    assert_eq!(normal, glam::Vec3::X, "both angles are zero at first");
    press(&mut window, "Stress crosses");
    assert!(!window.state().drawn().crosses.is_empty());
    // An animation would lack them at the moments before.
    assert!(window.query_by_label_contains("of them without a section and stress crosses").is_some());

    // A moment recorded before the cut was on is looked into by simulating up to it again.
    window.key_press(egui::Key::ArrowLeft);
    (0..4).for_each(|_| window.key_press(egui::Key::ArrowLeft));
    settle(&mut window);
    wait(&mut window, "the inside of then", |app| {
        app.player.is_back()
            && app.shown().time_s < app.snapshot.frame.time_s
            && !app.drawn().crosses.is_empty()
    });
    assert_eq!(window.state().drawn().time_s, window.state().shown().time_s);
    press(&mut window, "Now");
    window.key_press(egui::Key::C);
    window.key_press(egui::Key::X);
    settle(&mut window);
    assert_eq!(area(window.state()), whole);
    assert!(!window.state().snapshot.with_interior && window.state().drawn().crosses.is_empty());
}

#[test]
fn the_element_shows_the_values_of_the_moment_looked_at() {
    let mut window = window();
    open(&mut window, "rods-collision");
    wait(&mut window, "a collision", |app| app.snapshot.frame.time_s > 8e-5);
    press(&mut window, "Pause (space)");
    let frame = window.state().snapshot.frame.clone();
    let rod = frame.bodies.iter().position(|body| body.role == BodyRole::Deformable).unwrap();
    window.state_mut().inspect(rod, 7);
    settle(&mut window);
    let now = window.state().inspection().cloned().unwrap();
    assert!(now.principal_pa.length() > 1e3, "{now:?}");
    // At the start there was no stress.
    let bar = window.get_by_label("Timeline").rect();
    drag(&mut window, bar.center(), bar.left_center() + egui::vec2(1.0, 0.0));
    settle(&mut window);
    wait(&mut window, "the values of then", |app| app.player.is_back() && app.inspection().is_some());
    let then = window.state().inspection().cloned().unwrap();
    assert_eq!(then.element, now.element);
    assert!(then.principal_pa.length() < 0.01 * now.principal_pa.length(), "{then:?}");
    press(&mut window, "Now");
    assert_eq!(window.state().inspection(), Some(&now));
}

#[test]
fn a_typed_colour_range_is_used_and_a_wrong_one_is_told() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let frame = window.state().snapshot.frame.clone();
    window.state_mut().look.color_by = ColorBy::VonMises;
    window.state_mut().look.take_in(&frame);
    settle(&mut window);
    press(&mut window, "Colours find their own range");
    window.state_mut().look.typed_range.high = "3 MPa".to_owned();
    settle(&mut window);
    let view = |window: &Window| window.state().picture_request(1.0).unwrap().view.range.unwrap();
    assert_eq!(view(&window).high, 3e6);
    window.state_mut().look.typed_range.high = "3 apples".to_owned();
    settle(&mut window);
    assert!(window.query_by_label_contains("“3 apples” is no value in Pa").is_some());
    assert_ne!(view(&window).high, 3e6);
    press(&mut window, "Colours find their own range");
    assert!(window.query_by_label_contains("apples").is_none());
}

#[test]
fn escape_ends_throwing_and_what_was_said_goes_away() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.state_mut().save.folder = folder.path().to_str().unwrap().to_owned();
    window.key_press(egui::Key::T);
    settle(&mut window);
    assert!(window.state().aim.is_armed);
    window.key_press(egui::Key::Escape);
    settle(&mut window);
    assert!(!window.state().aim.is_armed);

    // In the middle of a throw: the button does nothing more until it is released, and then turns the camera again.
    window.key_press(egui::Key::T);
    settle(&mut window);
    let area = window.state().viewport.unwrap();
    let camera = |window: &Window| window.state().look.camera;
    let (before, bodies) = (camera(&window), window.state().snapshot.frame.bodies.len());
    hold(&mut window, [area.min + 0.3 * area.size(), area.center()], Modifiers::NONE, 4);
    window.key_press(egui::Key::T);
    window.step();
    assert!(!window.state().aim.is_armed);
    window.event(Event::PointerMoved(area.center() + egui::vec2(60.0, 20.0)));
    settle(&mut window);
    assert_eq!(camera(&window), before);
    release(&mut window, area.center(), Modifiers::NONE);
    settle(&mut window);
    assert_eq!(window.state().snapshot.frame.bodies.len(), bodies);
    drag(&mut window, area.center(), area.center() + egui::vec2(60.0, 20.0));
    assert_ne!(camera(&window), before);

    // What was taken back is said for some seconds; what went wrong stays.
    press(&mut window, "Ball");
    window.key_press_modifiers(Modifiers::COMMAND, egui::Key::Z);
    wait(&mut window, "the notice", |app| app.notice().is_some_and(|text| text.contains("Taken back")));
    (0..60).for_each(|_| window.step());
    assert_eq!(window.state().notice(), None);
    window.state_mut().tell("It went wrong.".to_owned());
    (0..60).for_each(|_| window.step());
    assert_eq!(window.state().notice(), Some("It went wrong."));
    window.key_press(egui::Key::Escape);
    settle(&mut window);

    // Saved with its panel in sight, it says so there; without, over the picture, until something else is done.
    let save = |window: &mut Window, name: &str| {
        window.key_press_modifiers(Modifiers::COMMAND, egui::Key::S);
        window.step();
        // The clock of this window goes on with its frames: none is laid out while the disk works.
        let (file, asked) = (Path::new(&window.state().save.folder).join(name), Instant::now());
        while !file.exists() {
            std::thread::sleep(Duration::from_millis(3));
            assert!(asked.elapsed() < TIME_LIMIT, "{name} was not saved");
        }
        wait(window, "the scene", |app| !app.saver.is_busy());
        window.step();
    };
    save(&mut window, "bounce.toml");
    assert_eq!(window.state().notice(), None);
    assert!(window.query_by_label_contains("bounce.toml").is_some());
    window.state_mut().panels.inspector = false;
    settle(&mut window);
    save(&mut window, "bounce-2.toml");
    let told = |window: &Window| window.state().save.notice().map(|(text, _)| text).unwrap_or_default();
    assert!(
        told(&window).starts_with("Saved ") && told(&window).contains("bounce-2.toml"),
        "{}",
        told(&window)
    );
    // Another one right after it: both can be read, whatever else is done, for some seconds.
    save(&mut window, "bounce-3.toml");
    window.key_press(egui::Key::Period);
    settle(&mut window);
    assert!(
        told(&window).contains("bounce-2.toml") && told(&window).contains("bounce-3.toml"),
        "{}",
        told(&window)
    );
    (0..60).for_each(|_| window.step());
    assert_eq!(told(&window), "");
}
