//! The panel at the left: dropping bodies, contact, materials.

use super::{Action, contact, fracture, materials, throw, widgets};
use crate::viewer::app::App;
use egui::Ui;

const STEP_SHARE: widgets::Parameter = widgets::Parameter {
    label: "Step over the stable one",
    unit: "",
    hint: "Smaller steps tell hard blows more truly and cost more",
    range: 0.05..=1.0,
    is_logarithmic: false,
};

/// On the button for what acts on reset.
const APPLY: &str = "Reset to apply the changes  (R)";
const APPLY_ALL_ELSE: &str = "Reset without the formula  (R)";

/// Shows the panel.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    let Some(running) = app.snapshot.scene.clone() else { return };
    let is_waiting = app.edits.wait_for_reset(&running);
    if is_waiting {
        let frame = egui::Frame::new().inner_margin(egui::Margin { right: 10, ..egui::Margin::ZERO });
        egui::Panel::bottom("apply").frame(frame).show_separator_line(false).show(ui, |ui| {
            ui.add_space(6.0);
            ui.vertical_centered_justified(|ui| {
                let (text, hint) = match app.edits.has_wrong_formula() {
                    false => (APPLY, "Starts the scene anew, with the values on the sliders"),
                    true => {
                        (APPLY_ALL_ELSE, "A formula is wrong: its material goes on breaking as it does now")
                    }
                };
                if widgets::primary_button(ui, text).on_hover_text(hint).clicked() {
                    actions.push(Action::Reset);
                }
            });
        });
    }
    widgets::side_scroll().show(ui, |ui| {
        widgets::section(ui, "Throw and drop", |ui| throw::show(ui, app, actions));
        widgets::section(ui, "Contact", |ui| {
            if contact::show(ui, &mut app.edits.contact, &app.snapshot) {
                actions.push(Action::ContactEdited);
            }
        });
        let base = app.snapshot.base.clone();
        widgets::section(ui, "Materials", |ui| materials::show(ui, &mut app.edits, base.as_deref()));
        if let Some(base) = &base {
            widgets::section(ui, "Cracks", |ui| {
                fracture::growth(ui, &mut app.edits.fracture, &base.description.fracture);
                fracture::limits_reached(ui, &app.snapshot.frame.status);
            });
        }
        widgets::section(ui, "Time", |ui| {
            widgets::badge(ui, widgets::Acts::OnReset);
            STEP_SHARE.show(ui, &mut app.edits.cfl);
        });
    });
}
