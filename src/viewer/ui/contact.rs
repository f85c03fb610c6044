//! Contact on sliders: acts at once.

use super::widgets::{Acts, Parameter, badge};
use crate::sim::{ContactMethod, ContactParameters};
use crate::viewer::session::GROUND_BODY;
use crate::viewer::snapshot::Snapshot;
use egui::{ComboBox, Slider, SliderClamping, Ui};

const FRICTION: Parameter = Parameter {
    label: "Friction",
    unit: "",
    hint: "Coulomb friction coefficient: tangential over normal force at which bodies slide",
    range: 0.0..=2.0,
    is_logarithmic: false,
};
const GROUND_FRICTION: Parameter =
    Parameter { label: "Friction on the ground", range: 0.0..=2.0, ..FRICTION };
const STIFFNESS: Parameter = Parameter {
    label: "Penalty stiffness",
    unit: "N/m",
    hint: "Of the springs between surfaces; stiffer ones let less through and make steps shorter",
    range: 1.0..=1e9,
    is_logarithmic: true,
};
const TOLERANCE: Parameter = Parameter {
    label: "Tolerance",
    unit: "",
    hint: "Relative change of the contact forces at which the passes stop",
    range: 1e-9..=0.1,
    is_logarithmic: true,
};
const REST_SPEED: Parameter = Parameter {
    label: "Resting speed",
    unit: "m/s",
    hint: "Slower impacts give nothing back, so that stacks come to rest",
    range: 0.0..=10.0,
    is_logarithmic: true,
};
/// Resting speed when somebody wants to choose it, m/s.
const FIRST_REST_SPEED_M_S: f64 = 0.01;
/// Stiffness when the method is switched to penalty, N/m.
const FIRST_STIFFNESS_N_M: f64 = 1e4;

/// Shows the values; returns whether one was changed.
pub fn show(ui: &mut Ui, contact: &mut ContactParameters, snapshot: &Snapshot) -> bool {
    badge(ui, Acts::AtOnce);
    let mut is_changed = FRICTION.show(ui, &mut contact.friction_coefficient);
    is_changed |= pair_friction(ui, contact, snapshot);
    is_changed |= method(ui, &mut contact.method);
    match &mut contact.method {
        ContactMethod::Lagrange { passes, conserve_impact_energy, tolerance } => {
            is_changed |= passes_slider(ui, passes);
            is_changed |= TOLERANCE.show(ui, tolerance);
            is_changed |= ui
                .checkbox(conserve_impact_energy, "Impacts conserve energy")
                .on_hover_text("Otherwise surfaces that meet stay together: plastic impact")
                .changed();
        }
        ContactMethod::Penalty { stiffness_n_m } => is_changed |= STIFFNESS.show(ui, stiffness_n_m),
    }
    let mut is_chosen = contact.rest_speed_m_s.is_some();
    let hint = "Otherwise it follows from gravity and step";
    if ui.checkbox(&mut is_chosen, "Choose the resting speed").on_hover_text(hint).changed() {
        contact.rest_speed_m_s = is_chosen.then_some(FIRST_REST_SPEED_M_S);
        is_changed = true;
    }
    if let Some(speed_m_s) = &mut contact.rest_speed_m_s {
        is_changed |= REST_SPEED.show(ui, speed_m_s);
    }
    let hint = "Whether parts of one body push each other away";
    is_changed |= ui
        .checkbox(&mut contact.self_collision, "Bodies collide with themselves")
        .on_hover_text(hint)
        .changed();
    is_changed
}

/// One slider for all pairs with the ground, one for each other pair.
fn pair_friction(ui: &mut Ui, contact: &mut ContactParameters, snapshot: &Snapshot) -> bool {
    let has_ground = snapshot.scene.as_ref().is_some_and(|scene| scene.description.ground.is_some());
    let with_ground = |bodies: &[usize; 2]| has_ground && bodies.contains(&GROUND_BODY);
    let mut is_changed = false;
    let ground = contact.pair_friction.iter().find(|pair| with_ground(&pair.bodies));
    if let Some(mut friction) = ground.map(|pair| pair.friction_coefficient)
        && GROUND_FRICTION.show(ui, &mut friction)
    {
        is_changed = true;
        for pair in contact.pair_friction.iter_mut().filter(|pair| with_ground(&pair.bodies)) {
            pair.friction_coefficient = friction;
        }
    }
    for pair in contact.pair_friction.iter_mut().filter(|pair| !with_ground(&pair.bodies)) {
        let [a, b] = pair.bodies.map(|body| snapshot.body_names.get(body).map_or("?", String::as_str));
        ui.push_id(pair.bodies, |ui| {
            ui.weak(format!("{a} on {b}"));
            is_changed |= FRICTION.show(ui, &mut pair.friction_coefficient);
        });
    }
    is_changed
}

fn method(ui: &mut Ui, method: &mut ContactMethod) -> bool {
    let lagrange = ContactMethod::Lagrange { passes: 3, tolerance: 1e-4, conserve_impact_energy: true };
    let penalty = ContactMethod::Penalty { stiffness_n_m: FIRST_STIFFNESS_N_M };
    let choices = [(lagrange, "Lagrange multipliers"), (penalty, "Penalty springs")];
    let is_now = |choice: &ContactMethod, now: &ContactMethod| {
        std::mem::discriminant(choice) == std::mem::discriminant(now)
    };
    let name = choices.iter().find(|(choice, _)| is_now(choice, method)).map_or("", |(_, name)| name);
    let mut is_changed = false;
    ui.label("Method");
    ComboBox::from_id_salt("contact method").width(ui.available_width()).selected_text(name).show_ui(
        ui,
        |ui| {
            for (choice, name) in choices {
                if ui.selectable_label(is_now(&choice, method), name).clicked() && !is_now(&choice, method) {
                    *method = choice;
                    is_changed = true;
                }
            }
        },
    );
    is_changed
}

fn passes_slider(ui: &mut Ui, passes: &mut u32) -> bool {
    let hint = "Gauss-Seidel passes that should do in a step; more while forces still change or a penetration is left";
    ui.horizontal(|ui| {
        ui.label("Passes").on_hover_text(hint);
        ui.spacing_mut().slider_width = (ui.available_width() - 56.0).max(40.0);
        let slider = Slider::new(passes, 1..=50).logarithmic(true).clamping(SliderClamping::Edits);
        ui.add(slider).on_hover_text(hint).changed()
    })
    .inner
}
