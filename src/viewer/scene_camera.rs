//! The camera that a scene asks for.

use crate::render::{Camera, Framing, NamedView};
use crate::scene::SceneDescription;
use crate::scene::description::{Camera as SceneCamera, Eye};
use glam::Vec3;

/// Share of the width left free at each side of what a narrower view than the recording shows.
const SIDE_MARGIN: f32 = 0.04;

/// The camera with which a scene opens: the one it records with, its first one, or the automatic one. A first camera is
/// meant for pictures of the recording's shape; in a narrower view it stands farther back. One that the recording names
/// is taken as it is: so saved scenes come back as they were seen.
#[must_use]
pub fn opening_camera(scene: &SceneDescription, framing: &Framing, aspect: f32) -> Camera {
    let wanted = scene.recording.camera.as_deref();
    let named = wanted.and_then(|name| scene.cameras.iter().find(|camera| camera.name == name));
    if let Some(camera) = named {
        return scene_camera(camera, framing, aspect);
    }
    match (wanted.and_then(|name| name.parse::<NamedView>().ok()), scene.cameras.first()) {
        (None, Some(first)) => {
            let [width, height] = scene.recording.size_px.map(|side| side as f32);
            let camera = scene_camera(first, framing, aspect);
            farther_back(camera, &framing.shown_points_m(), (width / height, aspect))
        }
        (view, _) => framing.camera(view.unwrap_or_default(), aspect),
    }
}

/// Resolves a camera of a scene for a picture of the given width over height.
#[must_use]
pub fn scene_camera(wanted: &SceneCamera, framing: &Framing, aspect: f32) -> Camera {
    let target_m = wanted.target_m.map(|target| target.as_vec3());
    let mut camera =
        Camera { fov_y_rad: (wanted.field_of_view_deg as f32).to_radians(), ..Camera::default() };
    match wanted.eye {
        Eye::At(eye_m) => {
            framing.fit(&mut camera, aspect);
            let target_m = target_m.unwrap_or(camera.target_m);
            look_from(&mut camera, eye_m.as_vec3(), target_m);
        }
        Eye::Around { yaw_deg, pitch_deg, distance_m } => {
            camera.yaw_rad = (yaw_deg as f32).to_radians();
            camera.pitch_rad = (pitch_deg as f32).to_radians();
            framing.fit(&mut camera, aspect);
            camera.target_m = target_m.unwrap_or(camera.target_m);
            camera.distance_m = distance_m.map_or(camera.distance_m, |distance| distance as f32);
        }
    }
    camera
}

/// The camera moved back as far as a view of the second aspect needs, to show between its sides what one of the first
/// does. What is outside of that one anyway has no say, and never more is shown than there.
fn farther_back(camera: Camera, points_m: &[Vec3], (meant, aspect): (f32, f32)) -> Camera {
    let [right, _, back] = camera.axes();
    let slope = (0.5 * camera.fov_y_rad).tan() * aspect * (1.0 - 2.0 * SIDE_MARGIN);
    let is_meant = |point_m: &&Vec3| {
        let at = camera.picture_position(**point_m, meant);
        at.is_some_and(|at| at.min_element() >= 0.0 && at.max_element() <= 1.0)
    };
    let needed_m = points_m.iter().filter(is_meant).map(|point_m| {
        let away = *point_m - camera.target_m;
        away.dot(back) + away.dot(right).abs() / slope
    });
    let most_m = camera.distance_m * (meant / aspect).max(1.0);
    let distance_m = needed_m.fold(camera.distance_m, f32::max).min(most_m);
    Camera { distance_m, ..camera }
}

/// Turns an orbit camera so that its eye is at a point.
fn look_from(camera: &mut Camera, eye_m: Vec3, target_m: Vec3) {
    let back = eye_m - target_m;
    camera.target_m = target_m;
    camera.distance_m = back.length();
    camera.yaw_rad = back.x.atan2(-back.y);
    camera.pitch_rad = back.z.atan2(back.truncate().length());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_view_shows_between_its_sides_what_a_wide_one_does() {
        let camera = Camera { yaw_rad: 0.0, pitch_rad: 0.0, distance_m: 4.0, ..Camera::default() };
        let points_m = [Vec3::new(-1.2, 0.3, 0.0), Vec3::new(1.5, -0.4, 0.2), Vec3::new(0.0, 0.0, 3.0)];
        let across = |camera: &Camera, aspect: f32| {
            points_m.map(|point_m| camera.picture_position(point_m, aspect).unwrap())
        };
        let wide = 16.0 / 9.0;
        for aspect in [1.5, 1.0, 0.6] {
            let moved = farther_back(camera, &points_m, (wide, aspect));
            assert!(moved.distance_m > camera.distance_m || aspect == 1.5, "{aspect}");
            let [left, right, _] = across(&moved, aspect);
            assert!(left.x > 0.03 && right.x < 0.97, "{aspect}: {left} {right}");
        }
        // Where there is room, and of what is outside anyway.
        assert_eq!(farther_back(camera, &points_m, (wide, 2.0)), camera);
        assert_eq!(farther_back(camera, &points_m[2..], (wide, 0.5)), camera);
    }

    #[test]
    fn scenes_open_with_what_stands_at_the_start_between_the_sides() {
        for name in ["hammer-table", "hammer-lamp", "plates-compared", "incline", "pane-shot"] {
            let scene = crate::scene::Scene::load(name, &[]).unwrap();
            let frame = crate::sim::World::new(scene.setup.clone()).unwrap().publish();
            let [meant, narrow] = [16.0 / 9.0, 0.9];
            let framing = Framing::of(&frame);
            let [wide, camera] =
                [meant, narrow].map(|aspect| opening_camera(&scene.description, &framing, aspect));
            for point in frame.moving().flat_map(|body| &body.positions_m) {
                let [before, now] = [(wide, meant), (camera, narrow)]
                    .map(|(camera, aspect)| camera.picture_position(Vec3::from(*point), aspect).unwrap());
                let is_inside = |at: glam::Vec2| at.min_element() > 0.0 && at.max_element() < 1.0;
                assert!(!is_inside(before) || is_inside(now), "{name}: {before} {now}");
            }
        }
    }

    #[test]
    fn a_camera_at_a_point_has_its_eye_there() {
        let (eye_m, target_m) = (Vec3::new(3.0, -2.0, 1.5), Vec3::new(0.5, 0.5, 0.5));
        let mut camera = Camera::default();
        look_from(&mut camera, eye_m, target_m);
        assert!((camera.eye_m() - eye_m).length() < 1e-5, "{}", camera.eye_m());
        assert_eq!(camera.target_m, target_m);
    }
}
