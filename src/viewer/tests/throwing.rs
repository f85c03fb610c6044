//! What is thrown is seen before, at its size and where it starts.

use super::*;
use crate::viewer::recording::{Mark, MarkKind};
use crate::viewer::snapshot::Snapshot;
use glam::Vec3;
use std::sync::Arc;

/// Where a body's middle is in the window.
fn middle_of(window: &Window, body: usize) -> Pos2 {
    let app = window.state();
    let positions_m = &app.snapshot.frame.bodies[body].positions_m;
    let middle_m = positions_m.iter().map(|p| Vec3::from(*p)).sum::<Vec3>() / positions_m.len() as f32;
    let area = app.viewport.unwrap();
    let share = app.look.camera.picture_position(middle_m, area.width() / area.height()).unwrap();
    area.min + egui::vec2(share.x, share.y) * area.size()
}

#[test]
fn a_throw_is_seen_before_at_its_size_where_it_will_start() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    // However far it has come: the ball is where the scene has it.
    window.key_press(egui::Key::R);
    settle(&mut window);
    assert_eq!(window.state().snapshot.frame.time_s, 0.0);
    let bodies = window.state().snapshot.frame.bodies.len();
    press(&mut window, "Throw with the mouse");
    assert!(window.state().ghost().is_none());
    let area = window.state().viewport.unwrap();
    // Free in the air; then where the ball is: in front of it.
    for (thrown, from) in [(1, area.min + 0.3 * area.size()), (2, middle_of(&window, bodies - 1))] {
        let target = area.min + egui::vec2(0.75, 0.2) * area.size();
        hold(&mut window, [from, target], Modifiers::NONE, 4);
        settle(&mut window);
        let app = window.state();
        let ghost = app.ghost().expect("nothing is seen of what is thrown");
        assert!(ghost.lift_m == 0.0 && ghost.is_in_sight(), "{} m higher", ghost.lift_m);
        let seen_at = app.look.camera.picture_position(ghost.start_m, area.width() / area.height()).unwrap();
        let pressed_at = (from - area.min) / area.size();
        assert!((seen_at - glam::Vec2::new(pressed_at.x, pressed_at.y)).length() < 1e-3, "{seen_at}");
        let foreseen_m = ghost.nodes_m.clone();
        release(&mut window, target, Modifiers::NONE);
        settle(&mut window);
        let app = window.state();
        assert!(app.ghost().is_none());
        let body = app.snapshot.frame.bodies.last().unwrap();
        assert_eq!(app.snapshot.frame.bodies.len(), bodies + thrown);
        for point in &body.positions_m {
            let nearest_m =
                foreseen_m.iter().map(|x| (*x - Vec3::from(*point)).length()).fold(f32::MAX, f32::min);
            assert!(nearest_m < 1e-5, "{nearest_m} m from what was seen");
        }
        assert_eq!(app.notice(), None);
    }
    // Into a moment looked back at: the ball that was thrown later is not in the way.
    press(&mut window, "Play (space)");
    wait(&mut window, "time", |app| app.snapshot.recording.moments().len() > 12);
    press(&mut window, "Pause (space)");
    let bar = window.get_by_label("Timeline").rect();
    drag(&mut window, bar.center(), bar.left_center() + egui::vec2(1.0, 0.0));
    settle(&mut window);
    assert!(window.state().player.is_back());
    let from = area.min + 0.3 * area.size();
    hold(&mut window, [from, area.center()], Modifiers::NONE, 4);
    settle(&mut window);
    assert_eq!(window.state().ghost().expect("a ghost in the past").lift_m, 0.0);
    release(&mut window, area.center(), Modifiers::NONE);
    settle(&mut window);
}

/// What falls from above while time stands was out of the picture, and nothing seemed to happen.
#[test]
fn what_is_dropped_while_time_stands_is_in_the_picture_or_told() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.key_press(egui::Key::R);
    settle(&mut window);
    for (button, told) in [("Ball", "waits above. Play (Space)"), ("Cube", "waits above")] {
        press(&mut window, button);
        let app = window.state();
        assert!(app.notice().is_some_and(|text| text.contains(told)), "{:?}", app.notice());
        let area = app.viewport.unwrap();
        let body = app.snapshot.frame.bodies.last().unwrap();
        let is_seen = |point: &[f32; 3]| {
            let at = app.look.camera.picture_position(Vec3::from(*point), area.width() / area.height());
            at.is_some_and(|at| (0.0..=1.0).contains(&at.y))
        };
        let is_above = app.notice().is_some_and(|text| text.contains("above the picture"));
        assert!(body.positions_m.iter().all(is_seen) || is_above, "{button}");
        assert!(button != "Ball" || !is_above, "there is room for a ball");
    }
}

/// Mass and energy are told before anything is thrown, and Undo keeps its place.
#[test]
fn the_panel_tells_what_would_be_thrown_and_stands_still() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let app = window.state();
    let foreseen = app.aim.chosen(&app.snapshot).expect("nothing is known of the hammer");
    let energy_j = 0.5 * foreseen.mass_kg() * app.aim.speed_m_s.powi(2);
    assert!(foreseen.mass_kg() > 0.0);
    let energy = crate::render::with_unit(energy_j, "J");
    assert!(window.query_by_label(&energy).is_some(), "{energy}");
    let usual_kg = foreseen.mass_kg();
    window.state_mut().aim.scale = 2.0;
    wait(&mut window, "a larger hammer", |app| app.aim.chosen(&app.snapshot).is_some());
    let app = window.state();
    let larger_kg = app.aim.chosen(&app.snapshot).map_or(0.0, |foreseen| foreseen.mass_kg());
    // Its sides are rounded to three digits.
    assert!((larger_kg / usual_kg / 8.0 - 1.0).abs() < 0.02, "{larger_kg} {usual_kg}");
    let place = window.get_by_label("Undo").rect();
    press(&mut window, "Ball");
    assert_eq!(window.get_by_label("Undo: Ball thrown in").rect(), place);
    let built = window.state().snapshot.frame.bodies.last().unwrap().name.clone();
    assert!(built.contains("ball"));
}

/// The ball over the pile of bricks began half above the picture when the hammer had bounced, and nothing was said of it.
#[test]
fn what_is_dropped_is_whole_in_the_picture_or_told() {
    for until_s in [0.0, 0.02] {
        let mut window = window();
        open(&mut window, "brick-pile");
        // As wide as windows are.
        window.set_size(egui::vec2(1280.0, 800.0));
        settle(&mut window);
        wait(&mut window, "time", |app| app.snapshot.frame.time_s >= until_s);
        press(&mut window, "Pause (space)");
        if until_s == 0.0 {
            window.key_press(egui::Key::R);
            settle(&mut window);
        }
        press(&mut window, "Ball");
        let app = window.state();
        let area = app.viewport.unwrap();
        let body = app.snapshot.frame.bodies.last().unwrap();
        let seen_at = |point: &[f32; 3]| {
            app.look.camera.picture_position(Vec3::from(*point), area.width() / area.height()).unwrap().y
        };
        let highest = body.positions_m.iter().map(seen_at).fold(f32::MAX, f32::min);
        let is_told = app.notice().is_some_and(|text| text.contains("above the picture"));
        assert!(highest > 0.0 || is_told, "its top is at {highest}: {:?}", app.notice());
        assert!(until_s > 0.0 || !is_told, "there is room");
    }
}

/// A click or a short drag did nothing and said nothing.
#[test]
fn a_press_without_a_way_tells_how_to_throw() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    press(&mut window, "Throw with the mouse");
    let bodies = window.state().snapshot.frame.bodies.len();
    let at = window.state().viewport.unwrap().center();
    drag(&mut window, at, at + egui::vec2(1.0, 0.0));
    settle(&mut window);
    assert!(window.state().aim.was_too_short);
    drag(&mut window, at, at + egui::vec2(120.0, 0.0));
    settle(&mut window);
    let app = window.state();
    assert!(!app.aim.was_too_short && app.snapshot.frame.bodies.len() == bodies + 1);
}

/// A mark was still sketched when the simulation had passed it and only the recording had not.
#[test]
fn a_mark_is_solid_once_time_has_passed_it() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let orange = egui::Color32::from_rgb(0xe0, 0x9b, 0x39);
    let mut strokes = |share: f64| {
        let mut snapshot = Snapshot::clone(&window.state().snapshot);
        let recorded_s = snapshot.recording.moments().last().unwrap().time_s;
        Arc::make_mut(&mut snapshot.frame).time_s = recorded_s + 0.01;
        let time_s = recorded_s + 0.01 * share;
        let mark = Mark { time_s, kind: MarkKind::Edit, text: "comes in".to_owned(), edits: 0 };
        snapshot.planned = [mark].into();
        window.state().show_still(snapshot);
        (0..3).for_each(|_| window.step());
        let is_mark = |shape: &&egui::epaint::ClippedShape| matches!(shape.shape, egui::Shape::LineSegment { stroke, .. } if stroke.color == orange);
        window.output().shapes.iter().filter(is_mark).count()
    };
    assert_eq!(strokes(0.5), 1);
    assert!(strokes(1.5) > 1);
}
