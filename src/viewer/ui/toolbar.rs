//! The bar at the top: scenes, play, speed, panels.

use super::Action;
use super::icons::{self, Icon};
use crate::render::short;
use crate::viewer::app::App;
use crate::viewer::pacing::SLOWEST;
use egui::{Align, Button, Layout, RichText, Slider, Ui};

/// Shows the bar.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if app.is_gallery {
            gallery_side(ui, app, actions);
        } else {
            scene_side(ui, app, actions);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| right_side(ui, app, actions));
    });
}

fn gallery_side(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    ui.label(RichText::new("hammerfall").heading().strong());
    if app.snapshot.scene.is_some() && ui.button("Back to the scene").clicked() {
        actions.push(Action::ShowGallery(false));
    }
}

fn scene_side(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    if ui.button("Scenes").on_hover_text("Choose a scene (G)").clicked() {
        actions.push(Action::ShowGallery(true));
    }
    ui.separator();
    let snapshot = &app.snapshot;
    ui.add_enabled_ui(snapshot.scene.is_some(), |ui| {
        ui.add_enabled_ui(snapshot.run_error.is_none(), |ui| {
            let (icon, hint) = if snapshot.is_playing {
                (Icon::Pause, "Pause (space)")
            } else {
                (Icon::Play, "Play (space)")
            };
            if icons::button(ui, icon, hint).clicked() {
                actions.push(Action::TogglePlay);
            }
            if icons::button(ui, Icon::Step, "One step (.)").clicked() {
                actions.push(Action::Step);
            }
        });
        let hint = "Back to the start with the values on the sliders; what was thrown, taken out and pulled is left out (R)";
        if ui.button("Reset").on_hover_text(hint).clicked() {
            actions.push(Action::Reset);
        }
        ui.add_enabled_ui(snapshot.can_repeat, |ui| {
            let hint = "Back to the start with the values on the sliders; what was thrown, taken out, pulled and changed comes again, each at its time (Shift R)";
            let nothing = "As Reset, but what was thrown, taken out, pulled and changed comes again: nothing of it has been yet";
            let rerun = ui.button("Rerun").on_hover_text(hint).on_disabled_hover_text(nothing);
            if rerun.clicked() {
                actions.push(Action::Again);
            }
        });
        ui.separator();
        speed(ui, app, actions);
    });
}

fn speed(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let asked = app.snapshot.speed;
    let mut speed = if asked > 0.0 { asked } else { 1.0 };
    ui.label("Speed");
    ui.spacing_mut().slider_width = 130.0;
    let slowest = SLOWEST.min(speed);
    let slider = Slider::new(&mut speed, slowest..=1.0).logarithmic(true).show_value(false);
    let hint = "Simulated time over time on the wall";
    // A slider that is held still gives its own unrounded value again and again.
    if ui.add(slider).on_hover_text(hint).changed() && rounded_speed(speed) != asked {
        actions.push(Action::SetSpeed(rounded_speed(speed)));
    }
    ui.label(speed_text(speed)).on_hover_text(hint);
}

/// A speed whose slowness has two digits.
fn rounded_speed(speed: f64) -> f64 {
    let slowness = 1.0 / speed;
    let scale = 10f64.powf(slowness.log10().floor() - 1.0);
    1.0 / ((slowness / scale).round() * scale).max(1.0)
}

/// `real time`, `1/8`, `1/2000`.
pub fn speed_text(speed: f64) -> String {
    let slowness = 1.0 / speed;
    match slowness {
        s if s < 1.005 => "real time".to_owned(),
        s if s < 9.95 => format!("1/{}", short((10.0 * s).round() / 10.0)),
        s => format!("1/{s:.0}"),
    }
}

fn right_side(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    if ui.button("Help").on_hover_text("Keys and mouse (F1)").clicked() {
        actions.push(Action::ToggleHelp);
    }
    if icons::button(ui, Icon::Contrast, "Light or dark").clicked() {
        actions.push(Action::ToggleDark);
    }
    if app.is_gallery {
        return;
    }
    let panels = &mut app.panels;
    for (is_open, text, hint) in [
        (&mut panels.inspector, "Plots", "Colours and plots"),
        (&mut panels.parameters, "Parameters", "Materials, contact, dropping"),
    ] {
        if ui.add(Button::selectable(*is_open, text)).on_hover_text(hint).clicked() {
            *is_open = !*is_open;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_told_as_people_do() {
        assert_eq!(speed_text(1.0), "real time");
        assert_eq!(speed_text(0.125), "1/8");
        assert_eq!(speed_text(rounded_speed(1.0 / 2037.0)), "1/2000");
        assert_eq!(rounded_speed(1.0), 1.0);
        assert_eq!(rounded_speed(0.999), 1.0);
    }
}
