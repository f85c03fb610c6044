//! When materials break and how cracks grow: act on reset.

use super::style;
use super::widgets::{Acts, Parameter, badge};
use crate::fracture::PropagationRule;
use crate::sim::FractureParameters;
use crate::viewer::criterion_edit::{CriterionEdit, Failing};
use egui::{ComboBox, Label, RichText, TextEdit, TextStyle, Ui};

const STRENGTH: Parameter = Parameter {
    label: "Tensile strength",
    unit: "Pa",
    hint: "Largest tension that it bears",
    range: 1e2..=1e11,
    is_logarithmic: true,
};
const SHEAR: Parameter =
    Parameter { label: "Shear strength", hint: "Largest shear that it bears", range: 1e2..=1e11, ..STRENGTH };
const COHESION: Parameter = Parameter {
    label: "Cohesion",
    hint: "Shear that it bears without pressure",
    range: 1e2..=1e11,
    ..STRENGTH
};
const FRICTION_ANGLE: Parameter = Parameter {
    label: "Friction angle",
    unit: "°",
    hint: "How much pressure helps against sliding",
    range: 0.0..=80.0,
    is_logarithmic: false,
};
const SPACING: Parameter = Parameter {
    label: "Crack spacing",
    unit: "",
    hint: "How far from a crack no other starts until the news of it has arrived, in elements; 0: everything that fails cracks at once",
    range: 0.0..=20.0,
    is_logarithmic: false,
};
const ALTITUDE: Parameter = Parameter {
    label: "Smallest altitude",
    unit: "",
    hint: "That a cut may leave, over the smallest in the mesh as given: small ones let cracks run freely, large ones keep the step long",
    range: 0.02..=1.0,
    is_logarithmic: false,
};
const FRAGMENT: Parameter = Parameter {
    label: "Smallest fragment",
    unit: "",
    hint: "In average elements of the body: nothing smaller comes off",
    range: 0.0..=50.0,
    is_logarithmic: false,
};
const CRACK_SPEED: Parameter = Parameter {
    label: "Fastest crack",
    unit: "m/s",
    hint: "Half the speed of shear waves when nothing is chosen",
    range: 0.1..=1e4,
    is_logarithmic: true,
};

/// Shows the criterion of a material.
pub fn criterion(ui: &mut Ui, edit: &mut CriterionEdit) {
    ui.label("Breaks by");
    let combo = ComboBox::from_id_salt("criterion").width(ui.available_width()).truncate();
    combo.selected_text(edit.kind.label()).height(320.0).show_ui(ui, |ui| {
        let special = edit.is_special().then_some(Failing::AsInScene);
        for kind in Failing::ALL.into_iter().chain(special) {
            ui.selectable_value(&mut edit.kind, kind, kind.label()).on_hover_text(kind.explanation());
        }
    });
    match edit.kind {
        Failing::Never | Failing::AsInScene => {}
        Failing::Tensile => {
            STRENGTH.show(ui, &mut edit.tensile_strength_pa);
        }
        Failing::Tresca | Failing::VonMises => {
            SHEAR.show(ui, &mut edit.shear_strength_pa);
        }
        Failing::MohrCoulomb | Failing::DruckerPrager => with_friction(ui, edit),
        Failing::TensileOrSliding => {
            STRENGTH.show(ui, &mut edit.tensile_strength_pa);
            with_friction(ui, edit);
        }
        Failing::Formula => formula(ui, edit),
    }
    if !edit.kind.explanation().is_empty() {
        ui.label(RichText::new(edit.kind.explanation()).small().weak());
    }
}

fn with_friction(ui: &mut Ui, edit: &mut CriterionEdit) {
    COHESION.show(ui, &mut edit.cohesion_pa);
    FRICTION_ANGLE.show(ui, &mut edit.friction_angle_deg);
}

/// The formula, and below it what is wrong and where, while it is typed.
fn formula(ui: &mut Ui, edit: &mut CriterionEdit) {
    let hint = "In s1, s2, s3, I1, J2, J3 with + - * / ^, sqrt, abs, min, max; stresses in Pa: 10*MPa";
    // A name of its own: what appears above it while it is typed must not take the keyboard away.
    let text =
        TextEdit::singleline(&mut edit.formula).id_salt("formula").code_editor().desired_width(f32::INFINITY);
    ui.add(text).on_hover_text(hint);
    let Some(error) = edit.formula_error() else { return };
    let (_, color) = style::error_colors(ui.visuals().dark_mode);
    let before = edit.formula.chars().take(error.column.saturating_sub(1));
    let place = if is_seen_whole(ui, &edit.formula) {
        // The place as in the text above: the field has a margin of its own.
        let mark = format!("{}^", before.map(|_| ' ').collect::<String>());
        ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.horizontal(|ui| {
                ui.add_space(FORMULA_MARGIN);
                ui.label(RichText::new(mark).monospace().color(color));
            });
        });
        String::new()
    } else {
        // The field shows some part of it, where a mark would point to anything.
        let rest: String = edit.formula.chars().skip(before.count()).take(MOST_QUOTED).collect();
        if rest.is_empty() { ", at the end".to_owned() } else { format!(", at “{rest}”") }
    };
    let text = format!(
        "Column {}{place}: {}. Until that is mended this material breaks as it does now, after a reset too.",
        error.column, error.problem
    );
    ui.add(Label::new(RichText::new(text).small().color(color)).wrap());
}

/// Space between the edge of the formula's field and its text, points.
const FORMULA_MARGIN: f32 = 4.0;
/// Letters of a formula that are quoted to show a place in it.
const MOST_QUOTED: usize = 12;

/// Whether the field has room for all of a formula.
fn is_seen_whole(ui: &Ui, formula: &str) -> bool {
    let font = TextStyle::Monospace.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(formula.to_owned(), font, ui.visuals().text_color());
    text.size().x + 2.0 * FORMULA_MARGIN < ui.available_width()
}

/// Shows how cracks grow.
pub fn growth(ui: &mut Ui, parameters: &mut FractureParameters, base: &FractureParameters) {
    badge(ui, Acts::OnReset);
    SPACING.show(ui, &mut parameters.crack_spacing_elements);
    ALTITUDE.show(ui, &mut parameters.smallest_altitude_share);
    FRAGMENT.show(ui, &mut parameters.smallest_fragment_elements);
    let mut is_chosen = parameters.crack_speed_m_s.is_some();
    ui.add_enabled_ui(base.crack_speed_m_s.is_none(), |ui| {
        if ui.checkbox(&mut is_chosen, "Choose the fastest crack").on_hover_text(CRACK_SPEED.hint).changed() {
            parameters.crack_speed_m_s = is_chosen.then_some(FIRST_CRACK_SPEED_M_S);
        }
    });
    if let Some(speed_m_s) = &mut parameters.crack_speed_m_s {
        CRACK_SPEED.show(ui, speed_m_s);
    }
    let mut is_limited = parameters.max_elements.is_some();
    ui.add_enabled_ui(base.max_elements.is_none(), |ui| {
        let hint = "Of a body; beyond it cracks run along the faces there are. Eight times the first when nothing is chosen.";
        if ui.checkbox(&mut is_limited, "Choose the most elements").on_hover_text(hint).changed() {
            parameters.max_elements = is_limited.then_some(FIRST_MOST_ELEMENTS);
        }
    });
    if let Some(most) = &mut parameters.max_elements {
        let slider = egui::Slider::new(most, 100..=1_000_000).logarithmic(true);
        ui.add(slider.clamping(egui::SliderClamping::Edits));
    }
    let mut single = parameters.rule == PropagationRule::SingleElement;
    let hint = "Otherwise a node opens where two elements at it fail";
    if ui.checkbox(&mut single, "One failed element opens a node").on_hover_text(hint).changed() {
        parameters.rule = if single { PropagationRule::SingleElement } else { PropagationRule::TwoAtNode };
    }
}

/// Values that sliders start from when somebody wants to choose.
const FIRST_CRACK_SPEED_M_S: f64 = 100.0;
const FIRST_MOST_ELEMENTS: u32 = 20_000;
