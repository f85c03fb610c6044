//! Pulling at a body: press on it with Shift held, drag, let go.

use super::{Action, style, viewport};
use crate::frame::BodyRole;
use crate::render::{Camera, Ray};
use crate::viewer::app::App;
use egui::{Color32, PointerButton, Pos2, Rect, Response, Stroke, Ui};
use glam::Vec3;

/// A body that the mouse holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// How far in front of the eye the mouse moves, m.
    depth_m: f32,
    /// Where it was last, m.
    to_m: Vec3,
}

/// Begins, leads and ends a pull; whether the mouse is busy with one.
pub fn drag(ui: &Ui, app: &mut App, area: Rect, response: &Response, actions: &mut Vec<Action>) -> bool {
    if response.drag_started_by(PointerButton::Primary) && !app.aim.is_armed {
        let is_asked = ui.input(|input| input.modifiers.shift);
        let at = ui.input(|input| input.pointer.press_origin()).filter(|_| is_asked);
        app.hold = at.and_then(|at| begin(app, area, at, actions));
    }
    let Some(hold) = &mut app.hold else { return false };
    if let Some(at) = response.interact_pointer_pos() {
        let camera = &app.look.camera;
        let ray = camera.ray_in_world(viewport::share(area, at), viewport::aspect(area));
        let to_m = at_depth(camera, &ray, hold.depth_m);
        // In a window without a size nothing is anywhere.
        if to_m.is_finite() && to_m != hold.to_m {
            hold.to_m = to_m;
            actions.push(Action::Drag(to_m.as_dvec3()));
        }
    }
    if !response.dragged_by(PointerButton::Primary) {
        app.hold = None;
        actions.push(Action::LetGo);
    }
    true
}

fn begin(app: &App, area: Rect, at: Pos2, actions: &mut Vec<Action>) -> Option<Hold> {
    let hit = viewport::hit_at(app, area, at)?;
    let is_free = app.drawn().bodies.get(hit.body)?.role == BodyRole::Deformable;
    if !is_free || app.snapshot.run_error.is_some() {
        return None;
    }
    let camera = &app.look.camera;
    let depth_m = (hit.point_m - camera.eye_m()).dot(-camera.axes()[2]);
    let point_m = hit.point_m.as_dvec3();
    actions.push(Action::Grab { element: (hit.body, hit.element), point_m, to_m: point_m });
    Some(Hold { depth_m, to_m: hit.point_m })
}

/// The point of a ray at a distance in front of the eye, m.
fn at_depth(camera: &Camera, ray: &Ray, depth_m: f32) -> Vec3 {
    let forward = -camera.axes()[2];
    ray.origin_m + ray.direction * (depth_m / ray.direction.dot(forward).max(0.05))
}

/// Lines from grabbed points to what they are pulled to.
pub fn draw(ui: &Ui, app: &App, area: Rect) {
    let painter = ui.painter().with_clip_rect(area);
    for pull in &app.drawn().pulls {
        let ends = [pull.from_m, pull.to_m].map(|end| viewport::on_screen(app, area, Vec3::from(end)));
        let [Some(from), Some(to)] = ends else { continue };
        painter.line_segment([from, to], Stroke::new(2.5, style::accent()));
        painter.circle(from, 5.0, style::accent(), Stroke::new(2.0, Color32::WHITE));
        painter.circle_stroke(to, 7.0, Stroke::new(2.5, style::accent()));
    }
}
