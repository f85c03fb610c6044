//! The line at the bottom: where the run stands.

use super::toolbar::speed_text;
use super::widgets::measured;
use crate::viewer::app::App;
use egui::{Color32, RichText, TextStyle, Ui};

/// Between the name of a value and the value, points.
const LABEL_GAP: f32 = 4.0;

/// Shows the line.
pub fn show(ui: &mut Ui, app: &App) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        for (label, value, hint) in values(app) {
            // What does not fit is left out, not cut through.
            if width_of(ui, label) + width_of(ui, &value) + LABEL_GAP > ui.available_width() {
                break;
            }
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = LABEL_GAP;
                ui.label(RichText::new(label).small().weak()).on_hover_text(hint);
                ui.label(RichText::new(value).small().strong()).on_hover_text(hint);
            });
        }
    });
}

/// Width of a small text, points.
fn width_of(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Small.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER).size().x
}

fn values(app: &App) -> Vec<(&'static str, String, &'static str)> {
    let snapshot = &app.snapshot;
    let frame = app.shown();
    let status = &frame.status;
    let speed = match snapshot.real_time_factor {
        Some(factor) if factor > 0.0 => speed_text(factor),
        _ if app.player.is_back() => "looking back".to_owned(),
        _ if snapshot.redoing.is_some() => "on the way to what is done again".to_owned(),
        _ if snapshot.is_playing => "…".to_owned(),
        _ if snapshot.over_after_s().is_some() => "at the end; play goes on".to_owned(),
        _ => "paused".to_owned(),
    };
    // Of the moment that is seen, as everything else here.
    let row = snapshot.history.row_at(frame.time_s).filter(|_| app.player.is_back());
    let stable_step_s = row.map_or(snapshot.stable_step_s, |row| row.stable_step_s);
    let step = if stable_step_s.is_finite() && stable_step_s > 0.0 {
        measured(stable_step_s, "s")
    } else {
        "—".into()
    };
    let mut values = vec![
        ("t", measured(frame.time_s, "s"), "Simulated time"),
        ("real-time factor", speed, "Simulated time over time on the wall, over the last second"),
        ("elements", status.elements.to_string(), "Tetrahedra of the bodies that deform"),
        ("contacts", status.contact_pairs.to_string(), "Pairs of features that press on each other"),
        (
            "pieces",
            status.fragments.to_string(),
            "Connected pieces of the bodies that deform; a whole one is one",
        ),
        ("stable step", step, "Elastic step of the slowest body"),
        ("stage", status.stage.clone(), "What the last step did"),
        ("steps", status.steps.to_string(), "Steps since the start"),
    ];
    // Its panel may be closed, and over the picture it would hide something all the while.
    if let Some((path, share)) = app.saver.animation() {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let hint = "The animation that is being saved; all else can be saved meanwhile";
        values.insert(0, ("saving", format!("{name}, {:.0} %", 100.0 * share), hint));
    }
    if let Some(detail) = app.detail {
        let hint = "To keep up, moving pictures are drawn less finely; still ones are not (View: Full detail in motion)";
        values.push(("detail in motion", detail.to_owned(), hint));
    }
    if status.sleeping_bodies > 0 {
        values.push(("asleep", status.sleeping_bodies.to_string(), "Bodies at rest, which cost nothing"));
    }
    values
}
