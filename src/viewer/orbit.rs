//! What the mouse does to the camera.

use crate::render::Camera;
use glam::Vec2;

/// Turn of the camera for a drag across the height of the view, radians.
const TURN_RAD: f32 = 3.6;
/// Distance after one notch of the wheel (50 points), over the one before.
const ZOOM_PER_NOTCH: f32 = 0.85;
const POINTS_PER_NOTCH: f32 = 50.0;

/// What the mouse did over the view since the last frame, in points, x to the right and y down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MouseInput {
    /// Drag with the left button.
    pub orbit: Vec2,
    /// Drag with the right or middle button.
    pub pan: Vec2,
    /// Turn of the wheel, away from the user positive.
    pub wheel: f32,
    /// Pinch: above 1 comes closer.
    pub pinch: f32,
}

/// Moves the camera; `height` is the view's, in points.
pub fn apply(camera: &mut Camera, input: &MouseInput, height: f32) {
    let height = height.max(1.0);
    if input.orbit != Vec2::ZERO {
        // The scene follows the pointer: dragging right turns the eye to the left.
        let turn = input.orbit * (TURN_RAD / height);
        camera.orbit(-turn.x, turn.y);
    }
    if input.pan != Vec2::ZERO {
        camera.pan(input.pan / height);
    }
    let factor = ZOOM_PER_NOTCH.powf(input.wheel / POINTS_PER_NOTCH) / input.pinch.clamp(0.1, 10.0);
    if factor != 1.0 {
        camera.zoom(factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: MouseInput = MouseInput { orbit: Vec2::ZERO, pan: Vec2::ZERO, wheel: 0.0, pinch: 1.0 };

    #[test]
    fn nothing_moves_without_input() {
        let mut camera = Camera::default();
        apply(&mut camera, &STILL, 500.0);
        assert_eq!(camera, Camera::default());
    }

    #[test]
    fn the_scene_follows_the_pointer() {
        let seen = |input: MouseInput| {
            let mut camera = Camera { yaw_rad: 0.3, pitch_rad: 0.4, ..Camera::default() };
            // A point between the eye and the target.
            let point = camera.target_m + camera.axes()[2] * 0.5;
            apply(&mut camera, &input, 500.0);
            camera.picture_position(point, 1.5).unwrap() - Vec2::splat(0.5)
        };
        assert!(seen(MouseInput { orbit: Vec2::new(40.0, 0.0), ..STILL }).x > 0.01);
        assert!(seen(MouseInput { orbit: Vec2::new(0.0, 40.0), ..STILL }).y > 0.01);
        let panned = seen(MouseInput { pan: Vec2::new(30.0, -20.0), ..STILL });
        assert!(panned.x > 0.01 && panned.y < -0.01);
    }

    #[test]
    fn the_wheel_comes_closer_and_goes_back() {
        let mut camera = Camera::default();
        apply(&mut camera, &MouseInput { wheel: 50.0, ..STILL }, 500.0);
        assert!((camera.distance_m - 5.0 * ZOOM_PER_NOTCH).abs() < 1e-5);
        apply(&mut camera, &MouseInput { wheel: -50.0, ..STILL }, 500.0);
        assert!((camera.distance_m - 5.0).abs() < 1e-4);
        apply(&mut camera, &MouseInput { pinch: 2.0, ..STILL }, 500.0);
        assert!((camera.distance_m - 2.5).abs() < 1e-4);
    }
}
