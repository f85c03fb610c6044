//! The scene itself, and the mouse over it.

use super::widgets::{mass_text, measured};
use super::{Action, banner, element, ghost, grab, style};
use crate::viewer::aim::Path;
use crate::viewer::app::App;
use crate::viewer::orbit::MouseInput;
use crate::viewer::pick::{Hit, pick};
use egui::text::LayoutJob;
use egui::{
    Align, Align2, Color32, FontId, Galley, PointerButton, Pos2, Rect, Response, Sense, Shape, Stroke, Ui,
};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Shows the picture of the scene; what it shows is drawn after the layout, so it is never a frame late.
pub fn show(ui: &mut Ui, app: &mut App, actions: &mut Vec<Action>) {
    let area = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    if area.width() < 1.0 || area.height() < 1.0 {
        app.viewport = None;
        return;
    }
    app.viewport = Some(area);
    let snapshot = app.snapshot.clone();
    app.look.settle(&snapshot, area.width() / area.height());
    let mut input = mouse_input(ui, &response);
    if grab::drag(ui, app, area, &response, actions) {
        input.orbit = Vec2::ZERO;
    }
    app.aim.is_spent &= response.dragged_by(PointerButton::Primary);
    if app.aim.is_spent {
        input.orbit = Vec2::ZERO;
    }
    if app.aim.is_armed {
        input.orbit = Vec2::ZERO;
        take_aim(app, area, &response, actions);
    }
    app.look.move_camera(&input, area.height());
    if response.clicked()
        && let Some(hit) = response.interact_pointer_pos().and_then(|at| hit_at(app, area, at))
    {
        actions.push(Action::Inspect(hit.body, hit.element));
    }
    if response.double_clicked() {
        actions.push(Action::FrameAll);
    }
    if let Some(picture) = app.picture.filter(|_| snapshot.scene.is_some()) {
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(picture, area, whole, Color32::WHITE);
    }
    if snapshot.scene.is_none() {
        banner::waiting(ui, area, "Opening the scene …");
    } else {
        draw_aim(ui, app, area);
        element::mark(ui, app, area);
        grab::draw(ui, app, area);
        body_menu(ui, app, area, &response, actions);
    }
    banner::show(ui.ctx(), app, actions);
}

/// A place on the screen as a share of the picture.
pub(super) fn share(area: Rect, at: Pos2) -> Vec2 {
    Vec2::new((at.x - area.left()) / area.width(), (at.y - area.top()) / area.height())
}

pub(super) fn aspect(area: Rect) -> f32 {
    area.width() / area.height()
}

pub(super) fn hit_at(app: &App, area: Rect, at: Pos2) -> Option<Hit> {
    pick(app.drawn(), &app.look.camera.ray_in_world(share(area, at), aspect(area)))
}

/// Where a point of the world is on the screen.
pub(super) fn on_screen(app: &App, area: Rect, point_m: Vec3) -> Option<Pos2> {
    let at = app.look.camera.picture_position(point_m, aspect(area))?;
    Some(area.min + egui::vec2(at.x * area.width(), at.y * area.height()))
}

const HOW_TO_THROW: &str =
    "Press where the body shall start, drag to its target, let go to throw. Esc: no more throwing";
const TOO_SHORT: &str = "Nothing is thrown yet: press where the body shall start, drag to what it shall hit, and let go there. Esc: no more throwing";

/// Dragging draws a line; letting go throws along it.
fn take_aim(app: &mut App, area: Rect, response: &Response, actions: &mut Vec<Action>) {
    let is_begun = response.drag_started_by(PointerButton::Primary);
    if is_begun {
        let at = response.interact_pointer_pos().map(|at| share(area, at - response.drag_delta()));
        app.aim.drag = at.map(|at| [at, at]);
        (app.aim.is_let_go, app.aim.was_too_short) = (false, false);
        actions.push(Action::Foresee(app.aim.foresight()));
    }
    if app.aim.is_let_go {
        // The body that was let go has not come back from the simulation yet: nobody knows how much room it needs.
    } else if let (Some(drag), Some(at)) = (&mut app.aim.drag, response.interact_pointer_pos()) {
        drag[1] = share(area, at);
        app.aim.is_let_go = response.drag_stopped_by(PointerButton::Primary);
    } else if !response.dragged() {
        app.aim.drag = None;
    }
    app.aim.was_too_short |= response.clicked();
    app.place_ghost();
    let is_known = app.ghost().is_some() || !(is_begun || app.is_waiting());
    if app.aim.is_let_go && is_known {
        let path = aimed(app, area);
        app.aim.was_too_short = path.is_none();
        if let Some(path) = path.filter(|_| app.snapshot.run_error.is_none()) {
            actions.push(Action::Throw(app.aim.throw(&path)));
        }
        (app.aim.drag, app.aim.is_let_go) = (None, false);
        app.place_ghost();
    }
}

/// The path of the throw under way.
fn aimed(app: &App, area: Rect) -> Option<Path> {
    let (camera, aspect) = (&app.look.camera, aspect(area));
    let start_m = app.ghost().map_or_else(|| app.aim.start_m(camera, aspect), |ghost| Some(ghost.start_m))?;
    app.aim.path(app.shown(), camera, aspect, start_m)
}

fn draw_aim(ui: &Ui, app: &App, area: Rect) {
    app.ghost().into_iter().for_each(|ghost| ghost::draw(ui, app, area, ghost));
    let Some(path) = aimed(app, area) else {
        if app.aim.is_armed && app.aim.drag.is_none() {
            let text = if app.aim.was_too_short { TOO_SHORT } else { HOW_TO_THROW };
            // In more lines where the view is narrow.
            let font = FontId::proportional(12.5);
            let mut job = LayoutJob::simple(text.to_owned(), font, style::accent(), area.width() - 36.0);
            job.halign = Align::Center;
            let galley = ui.painter().layout_job(job);
            on_sheet(ui, area, area.center_top() + egui::vec2(0.0, 14.0), galley);
        }
        return;
    };
    let painter = ui.painter().with_clip_rect(area);
    let points: Vec<Pos2> =
        path.points_m.iter().filter_map(|point_m| on_screen(app, area, *point_m)).collect();
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return };
    let before = points.get(points.len().saturating_sub(2)).copied().unwrap_or(first);
    let stroke = Stroke::new(2.5, style::accent());
    painter.circle(first, 6.0, style::accent(), Stroke::new(2.0, Color32::WHITE));
    painter.extend(Shape::dashed_line(&points, stroke, 9.0, 5.0));
    painter.arrow(last, (last - before).normalized() * 0.1, stroke);
    painter.circle_stroke(last, 9.0, stroke);
    let label = aim_label(app, &path);
    let galley = painter.layout_no_wrap(label, FontId::proportional(13.0), style::accent());
    let place = Align2::LEFT_BOTTOM.anchor_size(first + egui::vec2(10.0, -10.0), galley.size());
    // Whole, wherever the body starts.
    let inside = area.shrink(6.0);
    let most = (inside.max - place.size()).max(inside.min);
    on_sheet(ui, area, place.min.clamp(inside.min, most), galley);
}

/// Text over the picture that can be read over whatever is behind it.
fn on_sheet(ui: &Ui, area: Rect, at: Pos2, galley: Arc<Galley>) {
    let painter = ui.painter().with_clip_rect(area);
    let back = galley.rect.translate(at.to_vec2()).expand2(egui::vec2(6.0, 3.0));
    painter.rect_filled(back, 5.0, ui.visuals().window_fill.gamma_multiply(0.85));
    painter.galley(at, galley, style::accent());
}

/// How fast, how heavy, with how much energy; and where it cannot start in sight.
fn aim_label(app: &App, path: &Path) -> String {
    let mut label = measured(app.aim.speed_m_s, "m/s");
    let Some(ghost) = app.ghost() else { return label };
    let energy_j = ghost.foreseen.kinetic_j(path.velocity_m_s(), app.aim.spin_rad_s(path));
    label += &format!(", {}, {}", mass_text(ghost.foreseen.mass_kg()), measured(energy_j, "J"));
    let lift = measured(f64::from(ghost.lift_m), "m");
    if !ghost.is_in_sight() {
        label += &format!(
            "\nThere is no free place in sight: it starts {lift} higher, out of sight.\nPress elsewhere, or move the camera back."
        );
    } else if ghost.lift_m > 0.0 {
        label += &format!("\nIt starts {lift} higher: there is no room under the mouse.");
    }
    label
}

/// What can be done with the body under the mouse, on a click with the right button.
fn body_menu(ui: &Ui, app: &App, area: Rect, response: &Response, actions: &mut Vec<Action>) {
    let id = response.id.with("body under the menu");
    if response.secondary_clicked() {
        let hit = response.interact_pointer_pos().and_then(|at| hit_at(app, area, at));
        ui.data_mut(|data| data.insert_temp(id, hit.map(|hit| hit.body)));
    }
    response.context_menu(|ui| {
        let body: Option<usize> = ui.data(|data| data.get_temp(id)).flatten();
        let name = body.and_then(|body| app.shown().bodies.get(body).map(|frame| (body, frame.name.clone())));
        let Some((body, name)) = name else {
            ui.weak("No body here");
            return;
        };
        ui.strong(&*name);
        let is_own = app.snapshot.scene.as_ref().is_some_and(|scene| scene.entry_of(&name).is_some());
        ui.add_enabled_ui(is_own, |ui| {
            if ui.button("Take out of the scene").clicked() {
                actions.push(Action::Remove(body));
            }
        });
        if !is_own {
            ui.weak("It stays: only the scene's bodies and what was thrown can be taken out.");
        }
    });
}

fn mouse_input(ui: &Ui, response: &Response) -> MouseInput {
    let drag = |button| {
        let delta = if response.dragged_by(button) { response.drag_delta() } else { egui::Vec2::ZERO };
        Vec2::new(delta.x, delta.y)
    };
    let (wheel, pinch) = if response.hovered() {
        ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()))
    } else {
        (0.0, 1.0)
    };
    MouseInput {
        orbit: drag(PointerButton::Primary),
        pan: drag(PointerButton::Secondary) + drag(PointerButton::Middle),
        wheel,
        pinch,
    }
}
