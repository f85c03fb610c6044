//! The panel at the right: what is shown, and the plots.

use super::{Action, closer, element, plots, save, widgets};
use crate::frame::ColorBy;
use crate::render::NamedView;
use crate::viewer::app::App;
use crate::viewer::exploded::is_in_pieces;
use egui::{ComboBox, RichText, Ui};

/// Shows the panel.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    widgets::side_scroll().show(ui, |ui| {
        widgets::section(ui, "View", |ui| view(ui, app, actions));
        widgets::section(ui, "Inside", |ui| closer::show(ui, app, actions));
        widgets::section(ui, "Take it home", |ui| save::show(ui, app, actions));
        let snapshot = app.snapshot.clone();
        widgets::section(ui, "Element", |ui| {
            element::show(ui, app);
        });
        let now_s = app.shown().time_s;
        for figure in &plots::FIGURES {
            widgets::section(ui, figure.title, |ui| {
                if let Some(time_s) = figure.show(ui, &snapshot.history, &snapshot.recording, now_s) {
                    actions.push(Action::LookAt(time_s));
                }
            });
        }
    });
}

fn view(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    let has_nothing_to_explode = app.look.explode > 0.0 && !is_in_pieces(app.shown());
    let are_crosses_too_short = app.are_crosses_too_short();
    let look = &mut app.look;
    let before = look.color_by;
    row(ui, "Colour by", |ui| {
        let list = ComboBox::from_id_salt("colour by").height(widgets::LIST_HEIGHT);
        list.width(ui.available_width()).selected_text(before.label()).show_ui(ui, |ui| {
            for choice in ColorBy::ALL {
                widgets::entry(ui, &mut look.color_by, choice, choice.label());
            }
        });
    });
    if look.color_by != before {
        // What was typed was in another unit.
        look.typed_range.is_on = false;
        actions.push(Action::ColorsEdited);
    }
    closer::color_range(ui, look);
    row(ui, "Look from", |ui| {
        ui.horizontal(|ui| {
            let width = ui.available_width() - 62.0;
            ComboBox::from_id_salt("look from")
                .height(widgets::LIST_HEIGHT)
                .width(width)
                .selected_text("Direction")
                .show_ui(ui, |ui| {
                    for (index, view) in NamedView::ALL.into_iter().enumerate() {
                        if ui
                            .selectable_label(false, format!("{}  {}", index + 1, view_label(view)))
                            .clicked()
                        {
                            actions.push(Action::LookFrom(view));
                        }
                    }
                });
            if ui.button("Fit").on_hover_text("Show everything but what flew or fell far off (F)").clicked() {
                actions.push(Action::FrameAll);
            }
        });
    });
    ui.checkbox(&mut look.wireframe, "Edges of the elements").on_hover_text("Wireframe (W)");
    let hint =
        "While things move, slow machines draw less finely to keep up; at rest everything is drawn finely";
    ui.checkbox(&mut look.is_always_fine, "Full detail in motion").on_hover_text(hint);
    row(ui, "Explode", |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 4.0).max(40.0);
        let hint = "Moves the fragments apart, only for the eye";
        ui.add(egui::Slider::new(&mut look.explode, 0.0..=2.0).show_value(false)).on_hover_text(hint);
    });
    if has_nothing_to_explode {
        small(ui, "Every body is in one piece now: there is nothing to explode.");
    }
    let fits_colors = look.color_by.has_values() && !look.typed_range.is_on;
    let (text, hint) = match (fits_colors, look.closer.with_crosses) {
        (false, false) => return,
        (true, false) => (
            "Fit the colours to now",
            "The colours' range grows with what is seen; this fits it to the moment shown",
        ),
        (false, true) => (
            "Fit the crosses to now",
            "The crosses' measure grows with what is seen; this fits it to the moment shown",
        ),
        (true, true) => (
            "Fit colours and crosses to now",
            "The colours' range and the crosses' measure grow with what is seen; this fits them to the moment shown",
        ),
    };
    if ui.button(text).on_hover_text(hint).clicked() {
        actions.push(Action::FitToNow);
    }
    if are_crosses_too_short {
        small(
            ui,
            "Beside the largest stress seen so far, all crosses of this moment are too short to be drawn.",
        );
    } else if fits_colors && look.closer.with_crosses {
        small(
            ui,
            "Both measure the largest that is seen: colours since they were chosen, crosses since they were switched on.",
        );
    }
}

fn small(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).small().weak());
}

/// Width of the labels before values, points: all begin and end in one line.
const LABEL_WIDTH: f32 = 70.0;

/// A value with its label before it.
pub fn row(ui: &mut Ui, label: &str, value: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let size = egui::vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_size(size);
            ui.label(label);
        });
        value(ui);
    });
}

fn view_label(view: NamedView) -> String {
    let name = view.name().replace('-', " ");
    let mut letters = name.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}
