//! What lies under the mouse.

use crate::frame::{BodyFrame, Frame};
use crate::render::{Camera, Ray};
use glam::{Vec2, Vec3};

/// Where a ray meets a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Number of the body in the frame.
    pub body: usize,
    /// Element behind the surface.
    pub element: u32,
    /// Where, m.
    pub point_m: Vec3,
    distance_m: f32,
}

/// The first body that a ray meets.
#[must_use]
pub fn pick(frame: &Frame, ray: &Ray) -> Option<Hit> {
    let hits = frame.bodies.iter().enumerate().filter_map(|(index, body)| pick_body(index, body, ray));
    hits.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

fn pick_body(index: usize, body: &BodyFrame, ray: &Ray) -> Option<Hit> {
    let corner = |vertex: u32| body.positions_m.get(vertex as usize).map(|p| Vec3::from(*p));
    let triangles = body.surface.triangles.iter().enumerate();
    let hits = triangles.filter_map(|(triangle, [a, b, c])| {
        let distance_m = meets(ray, [corner(*a)?, corner(*b)?, corner(*c)?])?;
        let element = body.surface.triangle_element.get(triangle).copied().unwrap_or(0);
        let point_m = ray.origin_m + ray.direction * distance_m;
        Some(Hit { body: index, element, point_m, distance_m })
    });
    hits.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

/// Distance along the ray to a triangle. T. Möller, B. Trumbore, J. Graphics Tools 2 (1997).
fn meets(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let across = ray.direction.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from_a = ray.origin_m - a;
    let u = from_a.dot(across) / determinant;
    let around = from_a.cross(ab);
    let v = ray.direction.dot(around) / determinant;
    let distance_m = ac.dot(around) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance_m > 0.0).then_some(distance_m)
}

/// The point under the mouse: on a body, or else as far away as what the camera looks at. `position` is the share of
/// the picture from its upper left corner.
#[must_use]
pub fn point_under(frame: &Frame, camera: &Camera, position: Vec2, aspect: f32) -> Vec3 {
    let ray = camera.ray_in_world(position, aspect);
    pick(frame, &ray).map_or_else(|| in_focus(camera, &ray), |hit| hit.point_m)
}

/// Where the ray is as far in front of the eye as what the camera looks at.
#[must_use]
pub fn in_focus(camera: &Camera, ray: &Ray) -> Vec3 {
    let forward = -camera.axes()[2];
    ray.origin_m + ray.direction * (camera.distance_m / ray.direction.dot(forward).max(0.05))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::SurfaceTopology;
    use std::sync::Arc;

    #[test]
    fn the_nearer_of_two_triangles_is_picked() {
        let triangle = |z: f32| {
            let surface = SurfaceTopology {
                triangles: vec![[0, 1, 2]],
                triangle_element: vec![7],
                ..SurfaceTopology::default()
            };
            BodyFrame {
                positions_m: vec![[-1.0, -1.0, z], [2.0, -1.0, z], [-1.0, 2.0, z]],
                surface: Arc::new(surface),
                ..BodyFrame::default()
            }
        };
        let frame = Frame { bodies: vec![triangle(0.0), triangle(1.0)], ..Frame::default() };
        let down = |x: f32| Ray { origin_m: Vec3::new(x, 0.0, 5.0), direction: Vec3::NEG_Z };
        let hit = pick(&frame, &down(0.0)).unwrap();
        assert_eq!((hit.body, hit.element, hit.point_m), (1, 7, Vec3::Z));
        assert_eq!(pick(&frame, &down(9.0)), None);
    }
}
