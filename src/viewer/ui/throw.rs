//! Throwing and dropping bodies into the scene.

use super::Action;
use super::inspector::row;
use super::widgets::{Parameter, mass_text, measured};
use crate::viewer::app::App;
use crate::viewer::thrown::{TOOL, ThrowKind};
use egui::{Button, ComboBox, Ui};

const SPEED: Parameter = Parameter {
    label: "Speed",
    unit: "m/s",
    hint: "How fast it leaves the hand",
    range: 0.1..=500.0,
    is_logarithmic: true,
};
const SIZE: Parameter = Parameter {
    label: "Size",
    unit: "",
    hint: "Times the size that suits the scene; small bodies make small steps",
    range: 0.25..=4.0,
    is_logarithmic: true,
};
const SPIN: Parameter = Parameter {
    label: "Spin",
    unit: "rad/s",
    hint: "Rolling forwards (positive) or backwards, as seen along the throw",
    range: -200.0..=200.0,
    is_logarithmic: false,
};

/// Shows what is thrown and how.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    ui.add_enabled_ui(app.snapshot.run_error.is_none(), |ui| {
        choices(ui, app);
        let hint = "A copy has the size of the body that it is a copy of";
        let has_size = ui.add_enabled_ui(!app.aim.kind.is_copy(), |ui| SIZE.show(ui, &mut app.aim.scale));
        has_size.response.on_disabled_hover_text(hint);
        SPEED.show(ui, &mut app.aim.speed_m_s);
        SPIN.show(ui, &mut app.aim.spin_rad_s);
        weight(ui, app, actions);
        let hint = "Press where the body shall start, drag to what it shall hit, let go (T; Esc ends it). Off: dragging turns the camera.";
        let text = if app.aim.is_armed { "Drag in the picture to throw" } else { "Throw with the mouse" };
        let size = [ui.available_width(), 28.0];
        let aim = Button::selectable(app.aim.is_armed, text).frame_when_inactive(true);
        if ui.add_sized(size, aim).on_hover_text(hint).clicked() {
            actions.push(Action::ToggleAim);
        }
        drop_buttons(ui, actions);
        undo(ui, app, actions);
        ui.weak("Shift and drag pulls a body.");
    });
}

/// What it weighs and how hard it hits.
fn weight(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    // Not while a slider moves: each answer takes building the scene.
    if !ui.input(|input| input.pointer.any_down()) {
        actions.extend(app.aim.next_foresight(&app.snapshot).map(Action::Foresee));
    }
    let known = app.aim.chosen(&app.snapshot);
    let told = known.map(|foreseen| {
        let flight_m_s = glam::DVec3::X * app.aim.speed_m_s;
        let spin = if app.aim.spin_rad_s == 0.0 { "" } else { " + spin" };
        let energy_j = foreseen.kinetic_j(flight_m_s, glam::DVec3::ZERO);
        (mass_text(foreseen.mass_kg()), format!("{}{spin}", measured(energy_j, "J")))
    });
    let (mass, energy) = told.unwrap_or_else(|| ("…".to_owned(), "…".to_owned()));
    let hint =
        "Kinetic energy of its flight when it leaves the hand; what the spin adds is told while aiming";
    for (label, value, hint) in [("Mass", mass, "What the chosen body weighs"), ("Energy", energy, hint)] {
        row(ui, label, |ui| {
            ui.strong(value).on_hover_text(hint);
        });
    }
}

fn choices(ui: &mut Ui, app: &mut App) {
    let aim = &mut app.aim;
    let bodies = app.snapshot.scene.iter().flat_map(|scene| &scene.description.bodies);
    let copies = bodies.filter(|body| matches!(body.motion, crate::sim::BodyMotion::Deformable(_)));
    let copies = copies.map(|body| ThrowKind::CopyOf(body.name.clone()));
    let kinds: Vec<ThrowKind> = ThrowKind::SHAPES.into_iter().chain(copies).collect();
    row(ui, "Body", |ui| {
        let shown = words(&aim.kind);
        let combo = ComboBox::from_id_salt("thrown body").width(ui.available_width()).truncate();
        let combo = combo.selected_text(&shown).show_ui(ui, |ui| {
            for kind in kinds {
                let text = words(&kind);
                ui.selectable_value(&mut aim.kind, kind, text);
            }
        });
        // Names of bodies may be longer than there is room.
        combo.response.on_hover_text(format!("What is thrown or dropped: {shown}"));
    });
    let is_copy = aim.kind.is_copy();
    ui.add_enabled_ui(!is_copy, |ui| {
        row(ui, "Made of", |ui| {
            let scene = app.snapshot.scene.clone();
            let materials = scene.as_ref().map(|scene| scene.body_materials()).unwrap_or_default();
            let shown = if is_copy { "as it is" } else { material_words(&aim.material) }.to_owned();
            let combo = ComboBox::from_id_salt("thrown material").width(ui.available_width()).truncate();
            let combo = combo.selected_text(&shown).show_ui(ui, |ui| {
                ui.selectable_value(&mut aim.material, TOOL.to_owned(), material_words(TOOL));
                for name in materials.into_iter().filter(|name| *name != TOOL) {
                    ui.selectable_value(&mut aim.material, name.to_owned(), name);
                }
            });
            let hint = "A material of the scene, or that of a tool, which is heavy and never breaks";
            combo.response.on_hover_text(format!("{shown}\n{hint}"));
        });
    });
}

fn words(kind: &ThrowKind) -> String {
    match kind {
        ThrowKind::CopyOf(name) => format!("like `{name}`"),
        kind => kind.label().to_owned(),
    }
}

fn material_words(name: &str) -> &str {
    if name == TOOL { "tool, never breaks" } else { name }
}

fn drop_buttons(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.label("Or drop one from above");
    ui.columns_const(|columns: &mut [Ui; 3]| {
        for (ui, kind) in columns.iter_mut().zip(ThrowKind::SHAPES) {
            let size = [ui.available_width(), 28.0];
            let hint = format!("Drop a {} from above the middle", kind.label().to_lowercase());
            if ui.add_sized(size, Button::new(kind.label())).on_hover_text(hint).clicked() {
                actions.push(Action::Drop(kind));
            }
        }
    });
}

fn undo(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let undo =
        (&app.snapshot.undo, "Undo", "The scene goes back to where it stood then (Ctrl Z)", Action::Undo);
    let redo = (&app.snapshot.redo, "Redo", "Does it again, at its own time (Ctrl Y)", Action::Redo);
    let hint = "Does again, at its own time, what had been done here before that (Ctrl Shift Y)";
    let other = (&app.snapshot.redo_other, "Or redo", hint, Action::RedoOther);
    for (what, word, hint, action) in [undo, redo, other] {
        // Always there: what is below keeps its place under the mouse.
        let text = what.as_ref().map_or_else(|| word.to_owned(), |what| format!("{word}: {what}"));
        ui.add_enabled_ui(what.is_some(), |ui| {
            let button = ui.add_sized([ui.available_width(), 26.0], Button::new(&text).truncate());
            let nothing = "Nothing to do so with now";
            if button.on_hover_text(format!("{text}\n{hint}")).on_disabled_hover_text(nothing).clicked() {
                actions.push(action);
            }
        });
    }
}
