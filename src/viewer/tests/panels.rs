//! The panels: what they tell, and how their lists and edges answer.

use super::{drag, hold, open, press, release, settle, wait, window, with_a_formula};
use crate::viewer::criterion_edit::Failing;
use egui::{Key, pos2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

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

/// By keys alone: a list is gone through with arrows, Enter takes the entry and closes it, and closes one that nothing was
/// chosen in.
#[test]
fn enter_chooses_and_closes_an_open_list() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let is_open = |window: &super::Window| window.query_by_label("Von Mises stress").is_some();
    window.get_by_value("Material").click();
    settle(&mut window);
    assert!(is_open(&window), "the list did not open");
    window.key_press(Key::Enter);
    settle(&mut window);
    assert!(!is_open(&window), "the list is still open");
    window.get_by_value("Material").click();
    settle(&mut window);
    // From the first entry to the one below it.
    for key in [Key::ArrowDown, Key::ArrowDown, Key::Enter] {
        window.key_press(key);
        settle(&mut window);
    }
    assert!(!is_open(&window), "the list is still open");
    assert_eq!(window.state().look.color_by, crate::frame::ColorBy::ALL[1]);
}

/// While somebody types, letters are no shortcuts, but there is help.
#[test]
fn help_opens_while_somebody_types() {
    let mut window = with_a_formula();
    window.get_all_by_value("s1 - 1*MPa").next().unwrap().click();
    settle(&mut window);
    window.key_press(Key::T);
    window.key_press(Key::F1);
    settle(&mut window);
    assert!(window.state().panels.help && !window.state().aim.is_armed);
}

#[test]
fn escape_leaves_the_gallery() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    window.key_press(Key::G);
    settle(&mut window);
    assert!(window.state().is_gallery);
    window.key_press(Key::Escape);
    settle(&mut window);
    assert!(!window.state().is_gallery);
}

/// Two materials that are unfolded have lists and formulas of their own.
#[test]
fn every_material_has_a_criterion_of_its_own() {
    let mut window = window();
    open(&mut window, "hammer-ground");
    press(&mut window, "Pause (space)");
    assert_eq!(window.state().edits.criteria.len(), 2);
    let kinds = |window: &super::Window| {
        let criteria = &window.state().edits.criteria;
        [criteria[0].kind, criteria[1].kind]
    };
    let choose = |window: &mut super::Window, list: usize, label: &str| {
        let lists: Vec<_> = window.get_all_by_role(egui::Role::ComboBox).collect();
        let own = lists.iter().filter(|list| {
            let value = list.accesskit_node().value().unwrap_or_default();
            Failing::ALL.iter().any(|kind| kind.label() == value)
        });
        own.collect::<Vec<_>>()[list].click();
        drop(lists);
        settle(window);
        press(window, label);
    };
    assert_eq!(kinds(&window), [Failing::Never; 2]);
    choose(&mut window, 1, "Shear (Tresca)");
    assert_eq!(kinds(&window), [Failing::Never, Failing::Tresca]);
    choose(&mut window, 0, "Formula");
    assert_eq!(kinds(&window), [Failing::Formula, Failing::Tresca]);
    choose(&mut window, 1, "Formula");
    window.state_mut().edits.criteria[1].formula = "s1 - 3*MPa".to_owned();
    settle(&mut window);
    window.get_all_by_value("s1 - 3*MPa").next().unwrap().click();
    settle(&mut window);
    window.event(egui::Event::Text("*2".to_owned()));
    settle(&mut window);
    let formulas: Vec<String> =
        window.state().edits.criteria.iter().map(|criterion| criterion.formula.clone()).collect();
    assert_eq!(formulas, ["s1 - 1*MPa", "s1 - 3*MPa*2"]);
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

/// The first letter makes the button for resets appear: it took the field away from under the typing once, and what followed
/// were keys of the window.
#[test]
fn a_value_is_typed_to_its_end_and_a_slider_dragged_to_its_end() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let row = window.get_by_label("Young's modulus").rect();
    let fields = window.get_all_by_role(egui::Role::SpinButton);
    let beside = |rect: egui::Rect| (rect.center().y - row.center().y).abs() < 8.0;
    fields.into_iter().find(|field| beside(field.rect())).unwrap().click();
    settle(&mut window);
    for letter in "2.5 GPa".chars() {
        window.event(egui::Event::Text(letter.to_string()));
        window.step();
    }
    window.key_press(Key::Enter);
    settle(&mut window);
    let stiffness = |window: &super::Window| {
        let app = window.state();
        let materials = app.edits.materials.iter().map(|material| material.youngs_modulus_pa);
        materials.fold(0.0, f64::max)
    };
    assert_eq!(stiffness(&window), 2.5e9);
    assert!(!window.state().is_gallery && !window.state().snapshot.is_playing);
    press(&mut window, "Reset to apply the changes  (R)");
    let sliders = window.get_all_by_role(egui::Role::Slider);
    let below = |rect: egui::Rect| (5.0..40.0).contains(&(rect.center().y - row.center().y));
    let slider = sliders.into_iter().map(|slider| slider.rect()).find(|rect| below(*rect)).unwrap();
    drag(&mut window, slider.lerp_inside(egui::vec2(0.6, 0.5)), slider.right_center());
    assert!(stiffness(&window) > 5e11, "{}", stiffness(&window));
}

/// The slider's place and the rounded speed differ: as long as it was held, every frame asked for the speed anew.
#[test]
fn a_slider_that_is_held_still_asks_once() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let sliders = window.get_all_by_role(egui::Role::Slider).map(|slider| slider.rect());
    let speed = sliders.min_by(|a, b| a.top().total_cmp(&b.top())).expect("the speed is on a slider");
    let before = window.state().snapshot.speed;
    let path = [speed.center(), speed.lerp_inside(egui::vec2(0.314, 0.5))];
    hold(&mut window, path, egui::Modifiers::NONE, 3);
    settle(&mut window);
    assert_ne!(window.state().snapshot.speed, before);
    let asked = window.state().asked_lately().0;
    (0..20).for_each(|_| window.step());
    assert_eq!(window.state().asked_lately().0, asked, "{:?}", window.state().asked_lately());
    release(&mut window, path[1], egui::Modifiers::NONE);
}

/// What is no number differs from itself: a field in which it stood asked for its change in every frame.
#[test]
fn what_is_no_number_is_not_asked_for() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let fields = window.get_all_by_role(egui::Role::SpinButton);
    let lowest = fields.into_iter().max_by(|a, b| a.rect().bottom().total_cmp(&b.rect().bottom()));
    lowest.expect("the memory limit is a field").click();
    settle(&mut window);
    window.event(egui::Event::Text("nan".to_owned()));
    settle(&mut window);
    let asked = window.state().asked_lately().0;
    (0..20).for_each(|_| window.step());
    assert_eq!(window.state().asked_lately().0, asked, "{:?}", window.state().asked_lately());
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
    // It is still there to be mended; the button has nothing left to do.
    assert_eq!(window.state().edits.criteria[0].formula, "s1 - 7*MPa +");
    assert!(window.query_by_label_contains("Column").is_some());
    assert!(window.query_by_label_contains("Reset without").is_none());
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
    // And the field shows all of it, in several lines.
    let formula = window.state().edits.criteria[0].formula.clone();
    let field = window.get_by_value(&formula).rect();
    assert!(field.height() > 50.0 && field.right() < right, "{field:?}");
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
