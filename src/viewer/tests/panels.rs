//! The panels: what they tell, and how their lists and edges answer.

use super::{drag, open, press, settle, wait, window, with_a_formula};
use egui::{Key, pos2};
use egui_kittest::kittest::Queryable as _;

/// A list that is open closes first; what else Esc does comes after.
#[test]
fn escape_closes_an_open_list_and_nothing_else() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.key_press(Key::T);
    settle(&mut window);
    window.get_by_value("Material").click();
    settle(&mut window);
    assert!(window.query_by_label("Von Mises stress").is_some(), "the list did not open");
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(window.query_by_label("Von Mises stress").is_none(), "the list is still open");
    assert!(window.state().aim.is_armed, "Esc did more than to close the list");
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(!window.state().aim.is_armed);
}

/// The values beside the plots are those of the moment looked at, which they name.
#[test]
fn plots_tell_the_values_of_the_moment_looked_at() {
    let mut window = window();
    open(&mut window, "bounce");
    wait(&mut window, "time", |app| app.snapshot.recording.moments().len() > 12);
    press(&mut window, "Pause (space)");
    let told = |window: &super::Window| {
        let app = window.state();
        let row = app.snapshot.history.row_at(app.shown().time_s).copied().unwrap();
        let kinetic = format!("Kinetic {}", crate::render::with_unit(row.kinetic_j, "J"));
        assert!(window.query_by_label(&kinetic).is_some(), "{kinetic}");
        let at = format!("at {}", crate::render::with_unit(row.time_s, "s"));
        // One for each plot.
        assert_eq!(window.query_all_by_label(&at).count(), 5, "{at}");
        row.kinetic_j
    };
    let now_j = told(&window);
    for _ in 0..6 {
        window.key_press(Key::ArrowLeft);
        window.step();
    }
    settle(&mut window);
    assert!(window.state().player.is_back());
    assert_ne!(told(&window), now_j);
}

/// A wrong formula is left out of a reset, which the button says; the material breaks as it did before.
#[test]
fn a_wrong_formula_is_left_out_of_a_reset() {
    let mut window = with_a_formula();
    window.state_mut().edits.criteria[0].formula = "s1 - 7*MPa".to_owned();
    settle(&mut window);
    press(&mut window, "Reset to apply the changes  (R)");
    let acting = |window: &super::Window| {
        let scene = window.state().snapshot.scene.clone().unwrap();
        let material = &window.state().edits.materials[0];
        let now = scene.description.materials.iter().find(|other| other.name == material.name).cloned();
        now.unwrap()
    };
    let before = acting(&window);
    assert!(before.fracture.is_some());
    window.state_mut().edits.criteria[0].formula = "s1 - 7*MPa +".to_owned();
    window.state_mut().edits.materials[0].density_kg_m3 *= 2.0;
    settle(&mut window);
    press(&mut window, "Reset without the formula  (R)");
    let now = acting(&window);
    assert_eq!(now.fracture, before.fracture);
    assert!((now.density_kg_m3 / before.density_kg_m3 - 2.0).abs() < 1e-9);
    // It is still there to be mended, and the button with it.
    assert_eq!(window.state().edits.criteria[0].formula, "s1 - 7*MPa +");
    assert!(window.query_by_label("Reset without the formula  (R)").is_some());
}

/// However long, an error is told to its end, and the panel stays as wide as it is.
#[test]
fn a_long_error_of_a_formula_is_wrapped() {
    let mut window = with_a_formula();
    let viewport = window.state().viewport;
    window.state_mut().edits.criteria[0].formula =
        "s1 + s2 + s3 - 2*MPa + a_strength_with_a_name_that_has_no_end_and_is_no_parameter_of_it".to_owned();
    settle(&mut window);
    assert_eq!(window.state().viewport, viewport);
    let right = viewport.unwrap().left();
    let told: Vec<_> = window.query_all_by_label_contains("Column").map(|text| text.rect()).collect();
    assert!(!told.is_empty() && told.iter().all(|rect| rect.right() < right), "{told:?} beyond {right}");
    assert!(told.iter().any(|rect| rect.height() > 30.0), "it is not wrapped: {told:?}");
    // The field shows only a part, so the place is quoted.
    assert!(window.query_by_label_contains("at “a_strength_w”").is_some());
}

/// The cards end before the scroll bar.
#[test]
fn the_gallery_leaves_room_for_its_scroll_bar() {
    let window = window();
    let right = crate::scene::BUILTIN_SCENES
        .iter()
        .filter_map(|scene| {
            let label = format!("Open {}", scene.name);
            window.query_by_label(&label).map(|card| card.rect().right())
        })
        .fold(0.0, f32::max);
    assert!(right > 1000.0 && right < super::SIZE[0] - 25.0, "{right}");
}

#[test]
fn what_is_thrown_is_named_in_full() {
    let mut window = window();
    open(&mut window, "bounce");
    for label in ["Body", "Made of"] {
        assert!(window.query_by_label(label).is_some(), "{label}");
    }
    let made_of = window.get_by_value("tool, never breaks").rect();
    assert!(made_of.width() > 150.0, "{made_of:?}");
}

/// Dragging an edge chooses the width, and a small window changes nothing of it.
#[test]
fn a_panel_that_had_no_room_comes_back_as_wide_as_it_was_chosen() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let edge = window.state().viewport.unwrap().right();
    drag(&mut window, pos2(edge + 2.0, 500.0), pos2(edge - 216.0, 500.0));
    settle(&mut window);
    let chosen = window.state().panels.inspector_width;
    let wide = window.state().viewport.unwrap();
    assert!((chosen - 480.0).abs() < 3.0, "{chosen}");
    window.set_size(egui::vec2(900.0, 600.0));
    settle(&mut window);
    let narrow = window.state().viewport.unwrap();
    assert!((narrow.width() - 320.0).abs() < 30.0, "{narrow}");
    assert_eq!(window.state().panels.inspector_width, chosen);
    window.set_size(super::SIZE.into());
    settle(&mut window);
    assert_eq!(window.state().viewport.unwrap(), wide);
}
