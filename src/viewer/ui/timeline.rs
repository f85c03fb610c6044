//! The timeline: everything simulated so far, to scrub through and to play on from.

use super::widgets::measured;
use super::{Action, style};
use crate::render::parse_with_unit;
use crate::viewer::app::App;
use crate::viewer::recording::{LEAST_LIMIT_BYTES, Mark, MarkKind};
use egui::{
    Align, Align2, Color32, DragValue, FontId, Layout, Rect, RichText, Sense, Shape, Stroke, Ui, pos2, vec2,
};

/// Height of the bar, points.
const HEIGHT: f32 = 30.0;
/// Width of the buttons' and the memory's part below which the words go, points.
const NARROW: f32 = 760.0;
/// Distance within which the mouse is on a mark, points.
const MARK_REACH: f32 = 5.0;
const MEBIBYTE: f64 = (1 << 20) as f64;

/// Shows the line.
pub fn show(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        buttons(ui, app, actions);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            memory(ui, app, is_narrow, actions);
            ui.add_enabled_ui(app.player.is_back(), |ui| {
                let hint =
                    "Simulates on from here, with the values of then. What came after this moment is left; Ctrl Z brings it back";
                if super::widgets::primary_button(ui, "Play on from here").on_hover_text(hint).clicked() {
                    actions.push(Action::PlayOnFromHere);
                }
            });
            bar(ui, app, actions);
        });
    });
}

fn buttons(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let has_recording = app.snapshot.recording.moments().len() > 1;
    ui.add_enabled_ui(has_recording, |ui| {
        let text = if app.player.is_playing() { "Stop" } else { "Replay" };
        if ui.button(text).on_hover_text("Plays what was recorded (space while looking back)").clicked() {
            actions.push(Action::Replay);
        }
    });
    ui.add_enabled_ui(app.player.is_back(), |ui| {
        if ui.button("Now").on_hover_text("Back to where the simulation stands (End)").clicked() {
            actions.push(Action::ShowNow);
        }
    });
}

fn memory(ui: &mut Ui, app: &App, is_narrow: bool, actions: &mut Vec<Action>) {
    let recording = &app.snapshot.recording;
    let mut limit = recording.limit_bytes() as f64 / MEBIBYTE;
    let hint = format!(
        "Memory for the recording: drag, or click and type. When it is full, every second moment is forgotten; one of {} is kept now.",
        recording.one_of()
    );
    let least = LEAST_LIMIT_BYTES as f64 / MEBIBYTE;
    let value = DragValue::new(&mut limit).range(least..=65536.0).speed(4.0).max_decimals(0).suffix(" MiB");
    let value = value.custom_parser(|text| parse_with_unit(text, "MiB"));
    if ui.add(value).on_hover_text(&hint).changed() {
        actions.push(Action::SetMemoryLimit((limit * MEBIBYTE) as usize));
    }
    let used = recording.bytes() as f64 / MEBIBYTE;
    let text = if is_narrow { format!("{used:.0} of") } else { format!("memory: {used:.0} MiB of") };
    ui.label(RichText::new(text).small().weak()).on_hover_text(hint);
}

fn bar(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    let recording = &app.snapshot.recording;
    let width = ui.available_width().max(40.0);
    let (area, _) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::hover());
    // A name of its own: what comes and goes beside it must not end a drag.
    let response = ui.interact(area, egui::Id::unique("timeline bar"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Timeline"));
    let end_s = end_s(app);
    let rail = Rect::from_center_size(area.center(), vec2(area.width() - 12.0, 6.0));
    let x_of = |time_s: f64| rail.left() + rail.width() * (time_s / end_s).clamp(0.0, 1.0) as f32;
    let visuals = ui.visuals().clone();
    let painter = ui.painter();
    painter.rect_filled(rail, 3.0, visuals.widgets.inactive.bg_fill);
    let recorded_s = recording.moments().last().map_or(0.0, |moment| moment.time_s);
    let done = rail.with_max_x(x_of(recorded_s));
    painter.rect_filled(done, 3.0, style::accent().gamma_multiply(0.45));
    // Recorded moments come a while after it.
    let now_s = app.snapshot.frame.time_s;
    for mark in app.snapshot.planned.iter().filter(|mark| mark.time_s > now_s) {
        // What is still to come is only sketched.
        let ends = [pos2(x_of(mark.time_s), area.top()), pos2(x_of(mark.time_s), area.bottom())];
        painter.extend(Shape::dashed_line(&ends, Stroke::new(2.0, mark_color(mark.kind)), 4.0, 3.0));
    }
    let planned = app.snapshot.planned.iter().filter(|mark| mark.time_s <= now_s);
    for mark in recording.marks().iter().chain(planned) {
        let x = x_of(mark.time_s);
        let stroke = Stroke::new(2.0, mark_color(mark.kind));
        match mark.kind {
            MarkKind::Contact => painter.vline(x, area.top() + 1.0..=rail.top() - 1.0, stroke),
            MarkKind::Crack => painter.vline(x, rail.bottom() + 1.0..=area.bottom() - 1.0, stroke),
            MarkKind::Edit => painter.vline(x, area.y_range(), stroke),
        };
    }
    let shown_s = app.shown().time_s;
    let handle = pos2(x_of(shown_s), rail.center().y);
    painter.circle(handle, 7.0, style::accent(), Stroke::new(2.0, visuals.window_fill));
    if (response.dragged() || response.clicked())
        && let Some(at) = response.interact_pointer_pos()
    {
        let share = f64::from((at.x - rail.left()) / rail.width());
        actions.push(Action::LookAt((share * end_s).clamp(0.0, recorded_s)));
    }
    let text = hover_text(ui, app, rail, end_s);
    if let Some((x, text)) = text.filter(|_| response.hovered() || response.dragged()) {
        hint_above(ui, area, x, &text);
    }
}

/// The time that the bar reaches to: the scene's end, or what was simulated or is planned beyond.
fn end_s(app: &App) -> f64 {
    let scene = app.snapshot.scene.as_ref().map_or(0.0, |scene| scene.description.duration_s);
    let planned = app.snapshot.planned.iter().map(|mark| mark.time_s).fold(scene, f64::max);
    planned.max(app.snapshot.frame.time_s).max(1e-9)
}

/// Place and text of the hint: a mark near the mouse, or the time there.
fn hover_text(ui: &Ui, app: &App, rail: Rect, end_s: f64) -> Option<(f32, String)> {
    let mouse = ui.input(|input| input.pointer.hover_pos())?;
    let x_of = |mark: &Mark| rail.left() + rail.width() * (mark.time_s / end_s) as f32;
    let marks = app.snapshot.recording.marks().iter().chain(app.snapshot.planned.iter());
    let near: Vec<&Mark> = marks.filter(|mark| (x_of(mark) - mouse.x).abs() < MARK_REACH).collect();
    if let Some(first) = near.first() {
        let more = if near.len() > 1 { format!(" and {} more", near.len() - 1) } else { String::new() };
        return Some((x_of(first), format!("{} at {}{more}", first.text, measured(first.time_s, "s"))));
    }
    let time_s = f64::from((mouse.x - rail.left()) / rail.width()).clamp(0.0, 1.0) * end_s;
    Some((mouse.x, measured(time_s, "s")))
}

fn hint_above(ui: &Ui, area: Rect, x: f32, text: &str) {
    let painter =
        ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Tooltip, ui.scope_id().with("timeline hint")));
    let visuals = ui.visuals();
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(11.5), visuals.text_color());
    let half = 0.5 * galley.size().x + 8.0;
    let x = x.clamp(area.left() + half.min(0.5 * area.width()), area.right() - half.min(0.5 * area.width()));
    let back = Align2::CENTER_BOTTOM.anchor_size(pos2(x, area.top() - 4.0), galley.size() + vec2(14.0, 6.0));
    painter.rect_filled(back, 5.0, visuals.window_fill);
    painter.rect_stroke(back, 5.0, visuals.window_stroke, egui::StrokeKind::Inside);
    painter.galley(back.min + vec2(7.0, 3.0), galley, visuals.text_color());
}

fn mark_color(kind: MarkKind) -> Color32 {
    match kind {
        MarkKind::Contact => Color32::from_rgb(0x4f, 0xa3, 0x5f),
        MarkKind::Crack => Color32::from_rgb(0xd0, 0x4a, 0x4a),
        MarkKind::Edit => Color32::from_rgb(0xe0, 0x9b, 0x39),
    }
}
