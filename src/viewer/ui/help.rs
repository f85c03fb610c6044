//! Keys and mouse.

use super::keys::KEYS;
use egui::{Align2, Context, Grid, RichText, ScrollArea, Ui, Window};

/// Width of the window from which both tables stand side by side, points.
const WIDE: f32 = 1000.0;
/// Height of what is around the text, points.
const TITLE_AND_MARGINS: f32 = 90.0;

const MOUSE: [(&str, &str); 8] = [
    ("Left drag", "turn"),
    ("Shift and left drag on a body", "pull it by a spring"),
    ("Right or middle drag", "move"),
    ("Wheel", "come closer, go back"),
    ("Click on a body", "look closely at an element"),
    ("Right click on a body", "take it out of the scene"),
    ("Double click", "show everything"),
    ("Drop a file", "open a scene"),
];

/// Shows the window if it is open.
pub fn show(context: &Context, is_open: &mut bool) {
    if !*is_open {
        return;
    }
    Window::new("Keys and mouse")
        .open(is_open)
        .title_frame(egui::Frame::new().inner_margin(egui::Margin::symmetric(14, 10)))
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(context, |ui| {
            // A small window scrolls it.
            let most = (context.content_rect().height() - TITLE_AND_MARGINS).max(80.0);
            // A bar that is always there says that there is more below.
            ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
            ScrollArea::vertical().max_height(most).min_scrolled_height(most).show(ui, content);
        });
}

fn content(ui: &mut Ui) {
    // Side by side where there is room: one below the other they are higher than most windows.
    if ui.content_rect().width() > WIDE {
        ui.horizontal_top(|ui| {
            table(ui, "keys", &KEYS);
            ui.add_space(14.0);
            table(ui, "mouse", &MOUSE);
        });
    } else {
        table(ui, "keys", &KEYS);
        ui.add_space(10.0);
        table(ui, "mouse", &MOUSE);
    }
    ui.add_space(10.0);
    ui.weak("Values with a unit can be typed: click on them and write, for example, 2.5 GPa or 36 km/h.");
    ui.weak("Ctrl + and Ctrl - make everything larger or smaller, Ctrl 0 as usual. The panels' edges can be dragged.");
}

fn table(ui: &mut Ui, id: &str, rows: &[(&str, &str)]) {
    Grid::new(id).num_columns(2).spacing([18.0, 6.0]).show(ui, |ui| {
        for (what, does) in rows {
            ui.label(RichText::new(*what).strong());
            ui.label(*does);
            ui.end_row();
        }
    });
}
