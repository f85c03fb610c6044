//! What is clicked on and dropped on the window.

use super::*;

#[test]
fn a_mesh_that_is_dropped_on_the_window_is_told_how_it_gets_into_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("body.msh");
    std::fs::write(&path, "$MeshFormat\n").unwrap();
    let mut window = window();
    window.state_mut().open(path.to_str().unwrap(), &[]);
    wait(&mut window, "the message", |app| app.notice().is_some());
    assert!(window.state().notice().unwrap().contains("takes a mesh by `mesh.file = \"body.msh\"`"));
    assert!(window.state().is_gallery);
}

#[test]
fn the_element_that_was_clicked_on_is_outlined_where_it_is_in_sight() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let area = window.state().viewport.unwrap();
    let app = window.state();
    let ball = app.drawn().bodies.iter().rposition(|body| body.role == BodyRole::Deformable).unwrap();
    let middle_m =
        app.drawn().bodies[ball].positions_m.iter().map(|p| glam::Vec3::from(*p)).sum::<glam::Vec3>();
    let middle_m = middle_m / app.drawn().bodies[ball].positions_m.len() as f32;
    let share = app.look.camera.picture_position(middle_m, area.width() / area.height()).unwrap();
    let at = area.min + egui::vec2(share.x, share.y) * area.size();
    // A quick click: a slow one would be a drag.
    drag_held(&mut window, [at, at], Modifiers::NONE, 0);
    settle(&mut window);
    let seen = |window: &Window| {
        let app = window.state();
        super::super::ui::skin_in_sight(app, area, app.inspection().expect("an element")).len()
    };
    assert!(seen(&window) > 0);
    // From behind it is hidden.
    window.state_mut().look.camera.yaw_rad += std::f32::consts::PI;
    settle(&mut window);
    assert_eq!(seen(&window), 0);
}

/// "ground, element 4" told nothing.
#[test]
fn a_rigid_body_that_was_clicked_on_is_told_as_a_body() {
    let mut window = window();
    open(&mut window, "bounce");
    press(&mut window, "Pause (space)");
    let area = window.state().viewport.unwrap();
    let at = area.min + egui::vec2(0.5, 0.95) * area.size();
    drag_held(&mut window, [at, at], Modifiers::NONE, 0);
    settle(&mut window);
    let inspection = window.state().inspection().expect("a body");
    assert!(inspection.rigid.as_ref().is_some_and(|rigid| rigid.motion.is_none()), "{inspection:?}");
    assert!(window.query_by_label_contains("It is rigid").is_some());
    assert!(window.query_by_label_contains(", element").is_none());
}
