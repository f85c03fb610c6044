//! The camera that a scene asks for.

use crate::render::{Camera, Framing, NamedView};
use crate::scene::SceneDescription;
use crate::scene::description::{Camera as SceneCamera, Eye};
use glam::Vec3;

/// The camera with which a scene opens: the one it records with, its first one, or the automatic one.
#[must_use]
pub fn opening_camera(scene: &SceneDescription, framing: &Framing, aspect: f32) -> Camera {
    let wanted = scene.recording.camera.as_deref();
    let named = wanted.and_then(|name| scene.cameras.iter().find(|camera| camera.name == name));
    let recorded = scene.recording.size_px.map(|side_px| side_px as f32);
    let narrower = recorded[0] / recorded[1] / aspect;
    if let Some(camera) = named {
        return farther_off(scene_camera(camera, framing, aspect), framing, aspect, narrower);
    }
    match (wanted.and_then(|name| name.parse::<NamedView>().ok()), scene.cameras.first()) {
        (None, Some(first)) => farther_off(scene_camera(first, framing, aspect), framing, aspect, narrower),
        (view, _) => framing.camera(view.unwrap_or_default(), aspect),
    }
}

/// A camera that was placed for a picture so many times wider, as far back as it takes to see at the sides what that
/// picture shows there.
fn farther_off(camera: Camera, framing: &Framing, aspect: f32, narrower: f32) -> Camera {
    const TRIES: u8 = 8;
    if narrower.is_nan() || narrower <= 1.0 {
        return camera;
    }
    let points_m = framing.shown_points_m();
    let at = |try_: u8| {
        let factor = narrower.powf(f32::from(try_) / f32::from(TRIES));
        Camera { distance_m: camera.distance_m * factor, ..camera }
    };
    let sees_sides = |camera: &Camera| {
        let places = points_m.iter().map(|point_m| camera.picture_position(*point_m, aspect));
        places.flatten().all(|place| (0.0..=1.0).contains(&place.x))
    };
    (0..TRIES).map(at).find(sees_sides).unwrap_or_else(|| at(TRIES))
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
    fn a_narrow_view_is_farther_off_only_where_something_would_be_cut_off() {
        let scene = crate::scene::Scene::load("hammer-table", &[]).unwrap();
        let frame = crate::sim::World::new(scene.setup.clone()).unwrap().publish();
        let framing = Framing::of(&frame);
        let [width, height] = scene.description.recording.size_px.map(|side_px| side_px as f32);
        let camera = |aspect: f32| opening_camera(&scene.description, &framing, aspect);
        let recorded = camera(width / height);
        assert_eq!(camera(2.0 * width / height), recorded);
        let narrow = camera(0.8);
        assert!(narrow.distance_m > recorded.distance_m, "{narrow:?}");
        assert!(narrow.distance_m <= recorded.distance_m * width / height / 0.8 * 1.0001);
        for point_m in framing.shown_points_m() {
            let place = narrow.picture_position(point_m, 0.8).unwrap();
            assert!((0.0..=1.0).contains(&place.x), "{place}");
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
