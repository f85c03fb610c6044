//! The scene itself, and the mouse over it.

use super::{Action, banner};
use crate::viewer::app::App;
use crate::viewer::orbit::MouseInput;
use egui::{Color32, PointerButton, Pos2, Rect, Response, Sense, Ui};
use glam::Vec2;

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
    let input = mouse_input(ui, &response);
    app.look.move_camera(&input, area.height());
    if response.double_clicked() {
        actions.push(Action::FrameAll);
    }
    if let Some(picture) = app.picture.filter(|_| snapshot.scene.is_some()) {
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(picture, area, whole, Color32::WHITE);
    }
    if snapshot.scene.is_none() {
        banner::waiting(ui, area, "Opening the scene …");
    }
    banner::show(ui.ctx(), app, actions);
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
