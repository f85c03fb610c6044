//! What went wrong, said over the picture.

use super::{Action, style};
use crate::viewer::app::App;
use egui::{Align2, Area, Context, Id, Margin, Order, Rect, RichText, ScrollArea, Ui, vec2};

const WIDTH: f32 = 560.0;
const MOST_HEIGHT: f32 = 180.0;
/// Height of what explains the stress crosses, in the lower right corner of the picture, points.
const CROSS_LEGEND_HEIGHT: f32 = 26.0;

/// Shows the run's error and the latest notice, if there are any.
pub fn show(context: &Context, app: &App, actions: &mut Vec<Action>) {
    let has_error = !app.is_gallery && app.snapshot.run_error.is_some();
    let saved = app.save.notice();
    if !has_error && app.notice().is_none() && saved.is_none() {
        return;
    }
    let area = app.viewport.filter(|_| !app.is_gallery);
    let area = area.unwrap_or_else(|| context.content_rect());
    // At the bottom, where it hides neither the legends nor, mostly, what happens.
    let legend = if app.is_gallery || app.drawn().crosses.is_empty() { 0.0 } else { CROSS_LEGEND_HEIGHT };
    let corner = area.center_bottom() - vec2(0.0, 14.0 + legend);
    Area::new(Id::unique("banner"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(corner)
        .show(context, |ui| {
            ui.set_width(WIDTH.min(area.width() - 24.0).max(200.0));
            if let Some(error) = app.snapshot.run_error.as_ref().filter(|_| has_error) {
                run_error(ui, error, actions);
            }
            let mut close = |ui: &mut Ui, text: &str, is_passing: bool, action: Action| {
                let is_dark = app.look.is_dark;
                let colors =
                    if is_passing { style::notice_colors(is_dark) } else { style::warning_colors(is_dark) };
                message(ui, colors, text, |ui| {
                    if ui.button("Close").clicked() {
                        actions.push(action);
                    }
                });
            };
            if let Some(notice) = app.notice() {
                close(ui, notice, app.is_notice_passing(), Action::DismissNotice);
            }
            if let Some((text, is_failure)) = &saved {
                close(ui, text, !is_failure, Action::DismissSaved);
            }
        });
}

fn run_error(ui: &mut Ui, error: &str, actions: &mut Vec<Action>) {
    let colors = style::error_colors(ui.visuals().dark_mode);
    message(ui, colors, error, |ui| {
        ui.label("The last good frame stays.");
        if super::widgets::primary_button(ui, "Reset  (R)").clicked() {
            actions.push(Action::Reset);
        }
    });
}

fn message(
    ui: &mut Ui,
    (background, color): (egui::Color32, egui::Color32),
    text: &str,
    buttons: impl FnOnce(&mut Ui),
) {
    let frame = egui::Frame::new().fill(background).corner_radius(8).inner_margin(Margin::same(12));
    frame.shadow(ui.visuals().popup_shadow).show(ui, |ui| {
        ScrollArea::vertical().max_height(MOST_HEIGHT).show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.label(RichText::new(text).color(color));
        });
        ui.add_space(4.0);
        ui.horizontal(buttons);
    });
}

/// A line in the middle of the picture, while something is under way.
pub fn waiting(ui: &Ui, area: Rect, text: &str) {
    let font = egui::TextStyle::Heading.resolve(ui.style());
    ui.painter().text(area.center(), Align2::CENTER_CENTER, text, font, ui.visuals().weak_text_color());
}
