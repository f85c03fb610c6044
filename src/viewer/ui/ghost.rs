//! What the mouse is about to throw, at its true size where it will start: translucent, with its edges.

use super::{style, viewport};
use crate::viewer::app::App;
use crate::viewer::foresight::Ghost;
use egui::{Mesh, Pos2, Rect, Shape, Stroke, Ui};
use glam::Vec3;

/// How much of what is behind it is covered.
const COVER: f32 = 0.35;
/// Cosine of the angle between two triangles from which on their edge is drawn.
const SHARP: f32 = 0.7;

/// Draws it over the picture.
pub fn draw(ui: &Ui, app: &App, area: Rect, ghost: &Ghost) {
    let places: Vec<Option<Pos2>> =
        ghost.nodes_m.iter().map(|point_m| viewport::on_screen(app, area, *point_m)).collect();
    let place = |node: u32| places.get(node as usize).copied().flatten();
    let normals: Vec<Vec3> = ghost.foreseen.surface.triangles.iter().map(|t| normal(ghost, *t)).collect();
    let eye_m = app.look.camera.eye_m();
    let faces_eye: Vec<bool> = ghost
        .foreseen
        .surface
        .triangles
        .iter()
        .zip(&normals)
        .map(|(t, n)| faces(ghost, *t, *n, eye_m))
        .collect();
    let mut fill = Mesh::default();
    for (triangle, _) in
        ghost.foreseen.surface.triangles.iter().zip(&faces_eye).filter(|(_, is_front)| **is_front)
    {
        let [Some(a), Some(b), Some(c)] = triangle.map(place) else { continue };
        let first = fill.vertices.len() as u32;
        [a, b, c].into_iter().for_each(|at| fill.colored_vertex(at, style::accent().gamma_multiply(COVER)));
        fill.add_triangle(first, first + 1, first + 2);
    }
    let painter = ui.painter().with_clip_rect(area);
    painter.add(Shape::mesh(fill));
    for edge in &ghost.foreseen.surface.edges {
        let [one, other] = edge.triangles.map(|triangle| triangle as usize);
        let is_border = faces_eye[one] != faces_eye[other];
        let is_sharp = faces_eye[one] && normals[one].dot(normals[other]) < SHARP;
        if let ([Some(from), Some(to)], true) = (edge.nodes.map(place), is_border || is_sharp) {
            let width = if is_border { 1.8 } else { 1.0 };
            painter.line_segment([from, to], Stroke::new(width, style::accent()));
        }
    }
}

fn corner(ghost: &Ghost, node: u32) -> Vec3 {
    ghost.nodes_m.get(node as usize).copied().unwrap_or_default()
}

fn normal(ghost: &Ghost, triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|node| corner(ghost, node));
    (b - a).cross(c - a).normalize_or_zero()
}

fn faces(ghost: &Ghost, triangle: [u32; 3], normal: Vec3, eye_m: Vec3) -> bool {
    normal.dot(eye_m - corner(ghost, triangle[0])) > 0.0
}
