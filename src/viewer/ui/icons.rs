//! Signs on buttons, drawn instead of taken from a font that may lack them.

use egui::{Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2};
use std::f32::consts::{FRAC_PI_2, PI};

/// Size of a button with a sign, points.
const BUTTON_SIZE: egui::Vec2 = vec2(34.0, 26.0);
/// Half the size of the sign, points.
const REACH: f32 = 6.0;

/// What a sign stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Let time run.
    Play,
    /// Stop time.
    Pause,
    /// One step.
    Step,
    /// Light or dark.
    Contrast,
}

/// A button with a sign.
pub fn button(ui: &mut Ui, icon: Icon, hint: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(BUTTON_SIZE, Sense::click());
    let visuals = *ui.style().interact(&response);
    let painter = ui.painter();
    let area = rect.expand(visuals.expansion);
    let stroke = visuals.bg_stroke;
    painter.rect(area, visuals.corner_radius, visuals.weak_bg_fill, stroke, egui::StrokeKind::Inside);
    let color = if ui.is_enabled() { visuals.fg_stroke.color } else { ui.visuals().weak_text_color() };
    draw(painter, icon, rect.center(), color);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), hint));
    response.on_hover_text(hint)
}

/// A small square in the colour of a curve.
pub fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(9.0, 9.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, color);
}

fn draw(painter: &Painter, icon: Icon, at: Pos2, color: Color32) {
    match icon {
        Icon::Play => triangle(painter, at + vec2(1.0, 0.0), REACH, color),
        Icon::Pause => {
            for x in [-3.2, 3.2] {
                bar(painter, at + vec2(x, 0.0), color);
            }
        }
        Icon::Step => {
            triangle(painter, at - vec2(2.0, 0.0), REACH * 0.9, color);
            bar(painter, at + vec2(6.0, 0.0), color);
        }
        Icon::Contrast => contrast(painter, at, color),
    }
}

/// Points to the right.
fn triangle(painter: &Painter, at: Pos2, reach: f32, color: Color32) {
    let corners =
        vec![at + vec2(-0.7 * reach, -reach), at + vec2(reach, 0.0), at + vec2(-0.7 * reach, reach)];
    painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
}

fn bar(painter: &Painter, at: Pos2, color: Color32) {
    painter.rect_filled(Rect::from_center_size(at, vec2(3.2, 2.0 * REACH)), 1.0, color);
}

/// A circle, half of it filled.
fn contrast(painter: &Painter, at: Pos2, color: Color32) {
    painter.circle_stroke(at, REACH, Stroke::new(1.6, color));
    let half = (0..=16).map(|i| {
        let angle = -FRAC_PI_2 + PI * i as f32 / 16.0;
        pos2(at.x + REACH * angle.cos(), at.y + REACH * angle.sin())
    });
    painter.add(Shape::convex_polygon(half.collect(), color, Stroke::NONE));
}
