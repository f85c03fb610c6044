//! Taking it home.

use super::widgets::{caution, measured};
use super::{Action, style};
use crate::render::parse_with_unit;
use crate::viewer::app::{App, SaveKind, in_a_sentence};
use egui::{Align, Button, DragValue, Layout, ProgressBar, RichText, TextEdit, Ui};
use std::path::Path;

/// Shows the section.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    let top = ui.cursor().top();
    fields(ui, app, actions);
    let place = egui::Rect::from_x_y_ranges(ui.max_rect().x_range(), top..=ui.cursor().top());
    app.save.is_in_sight = ui.clip_rect().contains_rect(place.shrink2(egui::vec2(place.width() / 2.0, 2.0)));
}

fn fields(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label("Into");
        let folder = TextEdit::singleline(&mut app.save.folder).desired_width(f32::INFINITY);
        ui.add(folder).on_hover_text("Folder; files that are there are never written over");
    });
    buttons(ui, actions);
    match app.saver.animation() {
        Some((path, share)) => under_way(ui, path, share, actions),
        None => animation(ui, app, actions),
    }
    let (_, failed) = style::error_colors(ui.visuals().dark_mode);
    for (text, is_failure) in app.save.lines() {
        let text = RichText::new(text).small();
        ui.label(if is_failure { text.color(failed) } else { text.weak() });
    }
}

/// How far the animation is; everything else can be saved meanwhile.
fn under_way(ui: &mut Ui, path: &Path, share: f32, actions: &mut Vec<Action>) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("Cancel").on_hover_text("What it has so far is kept").clicked() {
                actions.push(Action::CancelSaving);
            }
            // The name can be read on both parts of the bar.
            let name = RichText::new(name).color(ui.visuals().text_color());
            let bar = ProgressBar::new(share).fill(style::accent().gamma_multiply(0.45));
            ui.add(bar.desired_width(ui.available_width()).text(name));
        });
    });
}

fn buttons(ui: &mut Ui, actions: &mut Vec<Action>) {
    const BUTTONS: [(SaveKind, &str, &str); 4] = [
        (SaveKind::Picture, "Picture", "The moment shown, as PNG"),
        (SaveKind::Scene, "Scene", "As TOML: thrown bodies, sliders, camera and all (Ctrl S)"),
        (
            SaveKind::Obj,
            "OBJ",
            "The fragments of the moment shown as objects, for Blender and others; whole, even if cut open or exploded for the eye",
        ),
        (SaveKind::Ply, "PLY", "The same, with body, fragment and crack at every triangle"),
    ];
    ui.columns_const(|columns: &mut [Ui; 4]| {
        for (ui, (kind, text, hint)) in columns.iter_mut().zip(BUTTONS) {
            ui.spacing_mut().button_padding.x = 2.0;
            let size = [ui.available_width(), 26.0];
            if ui.add_sized(size, Button::new(text)).on_hover_text(hint).clicked() {
                actions.push(Action::Save(kind));
            }
        }
    });
}

/// The range of the animation, and what it would come to.
fn animation(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    let end_s = app.snapshot.recording.moments().last().map_or(0.0, |moment| moment.time_s);
    let [from_s, to_s] = app.save.range(end_s);
    let mut shares = [from_s, to_s].map(|time_s| 100.0 * time_s / end_s.max(1e-12));
    ui.horizontal(|ui| {
        let hint = "Part of the timeline, in percent of what is recorded";
        let mut is_changed = false;
        for (share, prefix) in shares.iter_mut().zip(["from ", "to "]) {
            let value = DragValue::new(share).range(0.0..=100.0).speed(0.5).prefix(prefix).suffix(" %");
            let value = value.custom_parser(|text| parse_with_unit(text, "%"));
            is_changed |= ui.add(value.max_decimals(1)).on_hover_text(hint).changed();
        }
        if is_changed {
            app.save.shares = Some([shares[0].min(shares[1]), shares[1].max(shares[0])]);
        }
        let size = [ui.available_width(), 26.0];
        ui.add_enabled_ui(end_s > 0.0, |ui| {
            if ui
                .add_sized(size, Button::new("GIF"))
                .on_hover_text("The range as an animation, at the speed on the slider; long ones are hurried through in 1000 pictures")
                .clicked()
            {
                actions.push(Action::Save(SaveKind::Animation));
            }
        });
    });
    let pictures = app.animation_times().len();
    let text = format!("{pictures} pictures of {} to {}", measured(from_s, "s"), measured(to_s, "s"));
    ui.label(RichText::new(text).small().weak());
    if let Some(lacks) = app.animation_lacks() {
        caution(ui, &(in_a_sentence(&lacks) + "."));
    }
}
