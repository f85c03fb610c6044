//! When materials break and how cracks grow: act on reset.

use super::style;
use super::widgets::{Acts, LIST_HEIGHT, Parameter, badge, entry};
use crate::fracture::PropagationRule;
use crate::frame::FrameStatus;
use crate::sim::FractureParameters;
use crate::viewer::criterion_edit::{CriterionEdit, Failing};
use egui::text::{CCursor, CharIndex};
use egui::{Color32, ComboBox, Galley, Key, Label, Rect, RichText, Shape, Stroke, TextEdit, Ui, vec2};

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
    hint: "Half the speed of shear waves in what breaks when nothing is chosen",
    range: 0.1..=1e4,
    is_logarithmic: true,
};

/// Shows the criterion of a material.
pub fn criterion(ui: &mut Ui, edit: &mut CriterionEdit) {
    ui.label("Breaks by");
    let combo = ComboBox::from_id_salt("criterion").width(ui.available_width()).truncate();
    combo.selected_text(edit.kind.label()).height(LIST_HEIGHT).show_ui(ui, |ui| {
        let special = edit.is_special().then_some(Failing::AsInScene);
        for kind in Failing::ALL.into_iter().chain(special) {
            entry(ui, &mut edit.kind, kind, kind.label()).on_hover_text(kind.explanation());
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
    let text = TextEdit::multiline(&mut edit.formula).id_salt("formula").code_editor().lock_focus(false);
    let field = text.desired_rows(1).desired_width(f32::INFINITY).return_key(None).show(ui);
    if field.response.has_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
        field.response.surrender_focus();
    }
    field.response.response.on_hover_text(hint);
    // What is pasted may come in lines; for the formula they are spaces.
    if edit.formula.contains(['\n', '\r']) {
        edit.formula = edit.formula.replace(['\n', '\r'], " ");
    }
    let Some(error) = edit.formula_error() else { return };
    let (_, color) = style::error_colors(ui.visuals().dark_mode);
    let place = error_place(&field.galley, error.column);
    underline(ui, place.translate(field.galley_pos.to_vec2()), color);
    let text = format!(
        "Column {}: {}. Until that is mended this material breaks as it does now, after a reset too.",
        error.column, error.problem
    );
    ui.add(Label::new(RichText::new(text).small().color(color)).wrap());
}

/// Where the letter of a column, counted from 1, is in a text that may be wrapped.
fn error_place(galley: &Galley, column: usize) -> Rect {
    let at =
        |index: usize| galley.pos_from_cursor(CCursor { index: CharIndex(index), prefer_next_row: true });
    let letter = at(column.saturating_sub(1));
    let next = at(column);
    // At the end, and before a break, there is no next letter in the row.
    let is_beside = next.top() == letter.top() && next.left() > letter.left();
    letter.with_max_x(if is_beside { next.left() } else { letter.left() + LETTER_WIDTH })
}

/// About as wide as a letter of a formula, points.
const LETTER_WIDTH: f32 = 7.0;

/// A line under a letter, with a wedge that points up to it.
fn underline(ui: &Ui, letter: Rect, color: Color32) {
    let y = letter.bottom();
    ui.painter().hline(letter.x_range(), y, Stroke::new(2.0, color));
    let tip = letter.center_bottom();
    let foot = |dx: f32| tip + vec2(dx, 4.0);
    ui.painter().add(Shape::convex_polygon(vec![tip, foot(3.5), foot(-3.5)], color, Stroke::NONE));
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

/// Says which limits cracks have reached by the moment that is simulated.
pub fn limits_reached(ui: &mut Ui, status: &FrameStatus) {
    let mut say = |text: String| {
        ui.add(Label::new(RichText::new(text).small().weak()).wrap());
    };
    if status.nodes_left_whole > 0 {
        say(format!(
            "Limit reached: nodes not cut since a fragment would be too small: {}",
            status.nodes_left_whole
        ));
    }
    if status.edges_left_whole > 0 {
        say(format!(
            "Limit reached: cuts along faces since a body has as many elements as it may: {}",
            status.edges_left_whole
        ));
    }
    if status.nodes_held_up > 0 {
        say(format!(
            "Limit reached: nodes at which a crack had to wait, as it would be too fast: {}",
            status.nodes_held_up
        ));
    }
}

/// Values that sliders start from when somebody wants to choose.
const FIRST_CRACK_SPEED_M_S: f64 = 100.0;
const FIRST_MOST_ELEMENTS: u32 = 20_000;

#[cfg(test)]
mod tests {
    use super::*;

    /// In a formula that is wrapped, too, every column is the place of its letter.
    #[test]
    fn a_column_is_where_its_letter_is() {
        let text = "max(s1 - 2*MPa, sqrt(J2)-10*MPa)";
        let found = std::rc::Rc::new(std::cell::RefCell::new(None));
        let keep = found.clone();
        let mut window =
            egui_kittest::Harness::builder().with_accessibility_check(false).build_ui(move |ui| {
                let mut formula = text.to_owned();
                let field = TextEdit::multiline(&mut formula).code_editor().desired_width(120.0).show(ui);
                *keep.borrow_mut() = Some(field.galley);
            });
        window.step();
        let galley = found.borrow_mut().take().unwrap();
        assert!(galley.rows.len() > 1, "it is not wrapped");
        let mut column = 0;
        for row in &galley.rows {
            for glyph in &row.glyphs {
                column += 1;
                let place = error_place(&galley, column);
                let left = row.pos.x + glyph.pos.x;
                assert!((place.left() - left).abs() < 0.5, "{column}: {place:?} for {left}");
                assert!((place.top() - row.pos.y).abs() < 2.0 && place.width() > 3.0, "{column}: {place:?}");
            }
        }
        // What is missing is missed behind the last one.
        let end = error_place(&galley, column + 1);
        assert!(end.left() >= error_place(&galley, column).right() - 0.5 && end.width() > 3.0, "{end:?}");
    }
}
