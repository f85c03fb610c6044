//! Looking closer: cutting plane, stress crosses, and a typed range of the colours.

use super::Action;
use super::inspector::row;
use super::style;
use super::widgets::{Number, caution, measured, said_of, with_its_unit};
use crate::render::Camera;
use crate::viewer::app::App;
use crate::viewer::closer::{Closer, CutDirection};
use crate::viewer::look::Look;
use egui::{RichText, Slider, SliderClamping, TextEdit, Ui};

/// Shows the switches.
pub fn show(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let closer = app.look.closer;
    let mut is_cut = closer.is_cut;
    if ui.checkbox(&mut is_cut, "Cut the bodies open").on_hover_text("Cutting plane (C)").changed() {
        actions.push(Action::ToggleCut);
    }
    if is_cut {
        let mut edited = closer;
        plane(ui, &mut edited, &app.look.camera);
        if let Some(beside_m) = app.cut_is_beside_m() {
            let sign = if closer.is_flipped { -1.0 } else { 1.0 };
            let [from_m, to_m] = beside_m.map(|beyond_m| closer.position_m + sign * beyond_m);
            let [from, to] = [from_m.min(to_m), from_m.max(to_m)].map(|m| measured(f64::from(m), "m"));
            let text =
                format!("The plane goes through no body that moves: they are between {from} and {to} now.");
            caution(ui, &text);
        }
        if edited != closer {
            actions.push(Action::CutEdited(edited));
        }
    }
    let mut with_crosses = closer.with_crosses;
    let hint = "Principal directions as lines, the longer the larger the stress (X)";
    if ui.checkbox(&mut with_crosses, "Stress crosses").on_hover_text(hint).changed() {
        actions.push(Action::ToggleCrosses);
    }
}

fn plane(ui: &mut Ui, closer: &mut Closer, camera: &Camera) {
    let before = closer.normal();
    let stood = closer.direction;
    row(ui, "Across", |ui| {
        for (direction, label) in CutDirection::ALL {
            ui.selectable_value(&mut closer.direction, direction, label);
        }
    });
    if closer.direction != stood {
        closer.face(camera);
    }
    if closer.direction == CutDirection::Free {
        angle(ui, "Turn", &mut closer.azimuth_deg, 180.0);
        angle(ui, "Tilt", &mut closer.elevation_deg, 90.0);
    }
    if closer.normal() != before {
        closer.center();
    }
    let [low, high] = closer.span_m();
    let mut typed_into = None;
    row(ui, "Place", |ui| {
        // The value keeps its width whatever it is: a row that grows would push the panel's edge.
        let value_size = egui::vec2(88.0, ui.spacing().interact_size.y);
        let hint = "Where the plane is along its direction";
        ui.spacing_mut().slider_width = (ui.available_width() - value_size.x - 8.0).max(30.0);
        // A place that a scene says stays, even where no body has come yet.
        let slider = Slider::new(&mut closer.position_m, low..=high).clamping(SliderClamping::Edits);
        ui.add(slider.smart_aim(false).show_value(false)).on_hover_text(hint);
        let range = f64::from(low)..=f64::from(high);
        let number = Number { unit: "m", range, speed: 0.002 * f64::from(high - low), text: measured };
        let mut position_m = f64::from(closer.position_m);
        let value = number.show(ui, &mut position_m, value_size).on_hover_text(hint);
        closer.position_m = position_m as f32;
        typed_into = Some(value.id);
    });
    typed_into.into_iter().for_each(|id| said_of(ui, id, f64::from(closer.position_m)));
    if ui.checkbox(&mut closer.is_flipped, "Leave out the other side").changed() {
        closer.keep_side();
    }
}

fn angle(ui: &mut Ui, label: &str, value_deg: &mut f32, most_deg: f32) {
    let mut typed_into = None;
    row(ui, label, |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        ui.add(Slider::new(value_deg, -most_deg..=most_deg).show_value(false));
        let most = f64::from(most_deg);
        let number = Number { unit: "°", range: -most..=most, speed: 1.0, text: with_its_unit };
        let mut typed_deg = f64::from(*value_deg);
        typed_into = Some(number.show(ui, &mut typed_deg, ui.spacing().interact_size).id);
        *value_deg = typed_deg as f32;
    });
    typed_into.into_iter().for_each(|id| said_of(ui, id, f64::from(*value_deg)));
}

/// The range of the colours: found, or typed.
pub fn color_range(ui: &mut Ui, look: &mut Look) {
    if !look.color_by.has_values() {
        return;
    }
    let (found, color_by) = (look.found_range(), look.color_by);
    let typed = &mut look.typed_range;
    let mut is_found = !typed.is_on;
    let hint = "Off: type the values at the ends of the colours";
    if ui.checkbox(&mut is_found, "Colours find their own range").on_hover_text(hint).changed() {
        if is_found {
            typed.is_on = false;
        } else {
            typed.start_from(found, color_by);
        }
    }
    if !typed.is_on {
        return;
    }
    row(ui, "From, to", |ui| {
        let width = 0.5 * (ui.available_width() - ui.spacing().item_spacing.x);
        ui.add(TextEdit::singleline(&mut typed.low).desired_width(width - 8.0));
        ui.add(TextEdit::singleline(&mut typed.high).desired_width(width - 8.0));
    });
    if let Err(reason) = typed.range(color_by) {
        let (_, color) = style::error_colors(ui.visuals().dark_mode);
        ui.label(RichText::new(reason).small().color(color));
    }
}
