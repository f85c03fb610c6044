//! What a picture must show.

use crate::compare::{assert_like_stored, screen};
use crate::shapes::{ball, block, colored, fixed, frame, ground, hammer, turned};
use glam::{Quat, Vec2, Vec3};
use hammerfall::frame::{BodyFrame, ColorBy, Frame, VertexFields};
use hammerfall::render::{
    Background, Camera, Caption, Floor, Framing, Ground, NamedView, OffScreen, Picture, View,
};
use std::sync::Arc;

pub const SIZE: [u32; 2] = [240, 135];
const ASPECT: f32 = 240.0 / 135.0;

/// A frame and how to look at it.
pub struct Shot {
    pub frame: Frame,
    pub camera: Camera,
    pub view: View,
}

impl Shot {
    pub fn new(frame: Frame) -> Self {
        Self {
            camera: Framing::of(&frame).camera(NamedView::ThreeQuarter, ASPECT),
            frame,
            view: View::for_size(SIZE),
        }
    }

    pub fn draw(&self, screen: &mut OffScreen) -> Picture {
        screen.render(SIZE, &self.frame, &self.camera, &self.view).expect("a small picture can be drawn")
    }

    /// The pixel where a world point is seen.
    pub fn pixel(&self, point: Vec3) -> [u32; 2] {
        let at = self.camera.picture_position(point, ASPECT).expect("in front");
        (at * Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).to_array().map(|v| v as u32)
    }

    /// Luminance where a world point is seen, 0..255.
    pub fn luminance(&self, picture: &Picture, point: Vec3) -> f32 {
        luminance_at(picture, self.pixel(point))
    }
}

fn luminance_at(picture: &Picture, [x, y]: [u32; 2]) -> f32 {
    let [r, g, b] = picture.rgb_at(x, y).map(f32::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// A box 0.3 above the floor; its corners are (-0.5, -0.5, 0.3) and (0.5, 0.5, 1.3).
fn box_above_floor() -> Shot {
    let cube = block(Vec3::new(-0.5, -0.5, 0.3), Vec3::new(0.5, 0.5, 1.3), [3; 3]);
    Shot::new(frame(vec![ground(), colored(cube, [0.80, 0.36, 0.28])]))
}

/// Where the key light's shadow of a point falls on the floor: the light comes from the upper
/// left front.
fn shadow_of(point: Vec3) -> Vec3 {
    let light = Vec3::new(-0.38, -0.52, 0.765);
    point - light * (point.z / light.z)
}

/// Points of a face in rows: neighbours look alike. One dark among them would be shadow acne.
fn assert_even(shot: &Shot, picture: &Picture, place: impl Fn(f32, f32) -> Vec3) {
    let inside = |i: i32| -0.36 + 0.06 * i as f32;
    for i in 0..13 {
        let levels: Vec<f32> =
            (0..13).map(|j| shot.luminance(picture, place(inside(i), inside(j)))).collect();
        let even = levels.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 5.0);
        assert!(even, "row {i}: {levels:?}");
    }
}

#[test]
fn box_casts_a_shadow_and_has_clean_faces() {
    let Some(mut screen) = screen() else { return };
    let shot = box_above_floor();
    let picture = shot.draw(&mut screen);

    let [r, _, b] = picture.rgb_at(SIZE[0] / 2, SIZE[1] / 2);
    assert!(r > b + 40, "the red box covers the centre");
    let in_shadow = shot.luminance(&picture, shadow_of(Vec3::new(0.3, 0.0, 0.8)));
    let lit = shot.luminance(&picture, Vec3::new(-1.4, -0.9, 0.0));
    assert!(in_shadow < lit - 30.0, "shadow {in_shadow}, lit {lit}");
    assert_even(&shot, &picture, |u, v| Vec3::new(u, v, 1.3));
    assert_even(&shot, &picture, |u, v| Vec3::new(u, -0.5, 0.8 + v));
    assert_like_stored("box", &picture);
}

#[test]
fn resting_box_touches_its_shadow() {
    let Some(mut screen) = screen() else { return };
    let cube = block(Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 1.0), [2; 3]);
    let shot = Shot::new(frame(vec![ground(), cube]));
    let picture = shot.draw(&mut screen);
    // Just beside the right face, which the light does not reach.
    let beside = shot.luminance(&picture, Vec3::new(0.54, 0.1, 0.0));
    let lit = shot.luminance(&picture, Vec3::new(-1.2, -0.9, 0.0));
    assert!(beside < lit - 40.0, "no light leaks under the box: {beside}, lit {lit}");
    assert_like_stored("resting", &picture);
}

#[test]
fn ball_is_round_and_smooth() {
    let Some(mut screen) = screen() else { return };
    let mut shot = Shot::new(frame(vec![colored(ball(Vec3::ZERO, 1.0, 8), [0.9, 0.35, 0.2])]));
    shot.view.ground = Ground::Hidden;
    shot.camera.target_m = Vec3::ZERO;
    let picture = shot.draw(&mut screen);
    let is_ball = |x: u32, y: u32| {
        let [r, _, b] = picture.rgb_at(x, y);
        r > b.saturating_add(10)
    };
    let mut ball_pixels = 0;
    let mut uneven = 0;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] / 2 {
            let pair = [is_ball(x, y), is_ball(SIZE[0] - 1 - x, y)];
            ball_pixels += pair.iter().filter(|inside| **inside).count();
            uneven += usize::from(pair[0] != pair[1]);
        }
    }
    let radius = 0.5 * 0.8 * SIZE[1] as f32;
    let disk = std::f32::consts::PI * radius * radius;
    assert!((ball_pixels as f32 / disk - 1.0).abs() < 0.15, "{ball_pixels} of {disk}");
    assert!(uneven < 60, "left and right differ at {uneven} pixels");
    assert_like_stored("ball", &picture);
}

#[test]
fn body_throws_its_shadow_on_another() {
    let Some(mut screen) = screen() else { return };
    let slab = fixed(block(Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.2), [2, 2, 1]));
    let above = block(Vec3::new(-0.2, -0.2, 0.7), Vec3::new(0.2, 0.2, 1.1), [1; 3]);
    // Reaching beyond the slab, so that this one is no floor.
    let beside = block(Vec3::new(1.2, -0.2, 0.0), Vec3::new(1.5, 0.1, 0.3), [1; 3]);
    let mut shot = Shot::new(frame(vec![slab, above, beside]));
    shot.camera = Framing::of(&shot.frame).camera(NamedView::High, ASPECT);
    let picture = shot.draw(&mut screen);
    let down = |p: Vec3| shadow_of(p - Vec3::Z * 0.2) + Vec3::Z * 0.2;
    let shaded = shot.luminance(&picture, down(Vec3::new(0.1, 0.1, 0.9)));
    let lit = shot.luminance(&picture, Vec3::new(-0.7, -0.7, 0.2));
    assert!(shaded < lit - 25.0, "shaded {shaded}, lit {lit}");
    assert_like_stored("shadow-on-body", &picture);
}

/// The hammer with values that grow along its handle.
fn stressed_hammer() -> BodyFrame {
    let mut body = hammer(1);
    let low = body.positions_m.iter().map(|p| p[2]).fold(f32::MAX, f32::min);
    let high = body.positions_m.iter().map(|p| p[2]).fold(f32::MIN, f32::max);
    let share = |p: &[f32; 3]| (p[2] - low) / (high - low);
    let values: Vec<f32> = body.positions_m.iter().map(share).collect();
    body.fields = VertexFields {
        von_mises_pa: values.iter().map(|v| v * 3e8).collect(),
        failure_index: Vec::new(),
        mean_stress_pa: values.iter().map(|v| (2.0 * v - 1.0) * 2e6).collect(),
        ..Default::default()
    };
    body
}

/// Luminance down the middle of the legend's bar.
fn legend_levels(picture: &Picture) -> Vec<f32> {
    // Margin and half a bar's width from the right, in points of this size.
    let points = View::for_size(SIZE).pixels_per_point;
    let x = SIZE[0] - ((16.0 + 6.0) * points) as u32;
    let top = (46.0 * points) as u32;
    let bottom = top + (0.35 * SIZE[1] as f32) as u32;
    (top..bottom).map(|y| luminance_at(picture, [x, y])).collect()
}

#[test]
fn legend_of_sizes_gets_lighter_upwards() {
    let Some(mut screen) = screen() else { return };
    let mut shot = Shot::new(frame(vec![ground(), stressed_hammer()]));
    shot.view.color_by = ColorBy::VonMises;
    let picture = shot.draw(&mut screen);
    let levels = legend_levels(&picture);
    assert!(levels.windows(2).all(|w| w[1] <= w[0] + 0.5), "{levels:?}");
    assert!(levels[0] > levels[levels.len() - 1] + 80.0, "{levels:?}");
    assert_like_stored("von-mises", &picture);
}

#[test]
fn legend_of_signed_values_is_lightest_in_the_middle() {
    let Some(mut screen) = screen() else { return };
    let mut shot = Shot::new(frame(vec![ground(), stressed_hammer()]));
    shot.view.color_by = ColorBy::MeanStress;
    shot.view.background = Background::Dark;
    let picture = shot.draw(&mut screen);
    let levels = legend_levels(&picture);
    let brightest = (0..levels.len()).fold(0, |best, i| if levels[i] > levels[best] { i } else { best });
    let middle = levels.len() as f32 / 2.0;
    assert!((brightest as f32 - middle).abs() < 0.2 * middle, "{levels:?}");
    assert_like_stored("mean-stress-dark", &picture);
}

#[test]
fn colors_of_values_follow_the_fixed_range() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    let body = &mut shot.frame.bodies[1];
    body.fields.speed_m_s = vec![1.0; body.positions_m.len()];
    shot.view.color_by = ColorBy::Speed;
    shot.view.legend = false;
    let top = Vec3::new(0.0, 0.0, 1.3);
    let mut level = |high: f32| {
        shot.view.range = Some(hammerfall::render::Range { low: 0.0, high });
        let picture = shot.draw(&mut screen);
        shot.luminance(&picture, top)
    };
    let (full, half, little) = (level(1.0), level(2.0), level(20.0));
    assert!(full > half + 20.0 && half > little + 20.0, "{full} {half} {little}");
}

#[test]
fn wireframe_draws_the_elements_edges() {
    let Some(mut screen) = screen() else { return };
    let cube = block(Vec3::new(-0.5, -0.5, 0.3), Vec3::new(0.5, 0.5, 1.3), [2; 3]);
    let mut shot = Shot::new(frame(vec![ground(), cube]));
    let plain = shot.draw(&mut screen);
    shot.view.wireframe = true;
    let wired = shot.draw(&mut screen);
    // An edge between two squares of the top, and the middle of a triangle.
    let edge = Vec3::new(0.0, -0.25, 1.3);
    let middle = Vec3::new(-0.17, -0.33, 1.3);
    let darker = |p: Vec3| shot.luminance(&plain, p) - shot.luminance(&wired, p);
    assert!(darker(edge) > 20.0, "{}", darker(edge));
    assert!(darker(middle).abs() < 6.0, "{}", darker(middle));
    assert_like_stored("wireframe", &wired);
}

#[test]
fn crack_faces_have_their_own_tint() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    let body = &mut shot.frame.bodies[1];
    body.palette_srgb = Arc::new([[0.55, 0.60, 0.66]]);
    let surface = Arc::make_mut(&mut body.surface);
    let is_top = |t: &[u32; 3]| t.iter().all(|v| body.positions_m[*v as usize][2] > 1.29);
    surface.triangle_is_crack = surface.triangles.iter().map(is_top).collect();
    let picture = shot.draw(&mut screen);
    let warmth = |p: Vec3| {
        let [x, y] = shot.pixel(p);
        let [r, _, b] = picture.rgb_at(x, y).map(i32::from);
        r - b
    };
    assert!(warmth(Vec3::new(0.0, 0.0, 1.3)) > 50);
    assert!(warmth(Vec3::new(0.0, -0.5, 0.8)) < 10);
    assert_like_stored("crack", &picture);
}

#[test]
fn caption_changes_only_its_corner() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    let bare = shot.draw(&mut screen);
    shot.view.caption =
        Some(Caption { show_time: true, slow_motion: Some(400.0), text: "cube on floor".into() });
    let captioned = shot.draw(&mut screen);
    let mut changed = 0;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            if bare.rgb_at(x, y) != captioned.rgb_at(x, y) {
                changed += 1;
                assert!(x < SIZE[0] * 2 / 3 && y > SIZE[1] / 2, "at {x}, {y}");
            }
        }
    }
    assert!(changed > 100, "{changed} pixels of text");
    assert_like_stored("caption", &captioned);
}

#[test]
fn dark_studio_is_dark_and_its_bodies_are_not() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    shot.view.background = Background::Dark;
    let picture = shot.draw(&mut screen);
    assert!(luminance_at(&picture, [2, 2]) < 60.0);
    assert!(shot.luminance(&picture, Vec3::new(0.0, 0.0, 1.3)) > 90.0);
    assert_like_stored("dark", &picture);
}

#[test]
fn floor_hides_what_is_below_it() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    shot.view.ground = Ground::At(Floor { height_m: 0.8, replaces: Some(0) });
    let picture = shot.draw(&mut screen);
    let is_red = |z: f32| {
        let [x, y] = shot.pixel(Vec3::new(0.0, -0.5, z));
        let [r, _, b] = picture.rgb_at(x, y).map(i32::from);
        r - b > 25
    };
    assert!(is_red(1.1) && !is_red(0.5));
}

#[test]
fn floor_seen_from_below_hides_nothing() {
    let Some(mut screen) = screen() else { return };
    let mut shot = box_above_floor();
    shot.camera.pitch_rad = -0.6;
    let picture = shot.draw(&mut screen);
    let [x, y] = shot.pixel(Vec3::new(0.0, 0.0, 0.3));
    let [r, _, b] = picture.rgb_at(x, y);
    assert!(r > b + 15, "the box's bottom is seen");
}

#[test]
fn broken_input_draws_what_can_be_drawn() {
    let Some(mut screen) = screen() else { return };
    let empty = Shot::new(Frame::default()).draw(&mut screen);
    assert!(luminance_at(&empty, [120, 60]) > 100.0);

    let mut shot = box_above_floor();
    let lost = turned(ball(Vec3::new(0.0, 0.0, 2.0), 0.3, 2), Vec3::ZERO, Quat::IDENTITY);
    let mut blown_up = lost.clone();
    blown_up.positions_m[3] = [f32::NAN; 3];
    blown_up.positions_m[4] = [f32::INFINITY; 3];
    let mut cut_short = lost;
    cut_short.positions_m.truncate(2);
    shot.frame.bodies.extend([blown_up, cut_short]);
    let picture = shot.draw(&mut screen);
    let [x, y] = shot.pixel(Vec3::new(0.0, -0.5, 0.8));
    let [r, _, b] = picture.rgb_at(x, y);
    assert!(r > b + 40, "the sound box is drawn");
}

#[test]
fn same_frame_gives_the_same_bytes_whatever_was_drawn_before() {
    let Some(mut screen) = screen() else { return };
    let shot = box_above_floor();
    let first = shot.draw(&mut screen);
    let mut other = Shot::new(frame(vec![ground(), stressed_hammer()]));
    other.view.color_by = ColorBy::VonMises;
    other.draw(&mut screen);
    screen.render([33, 57], &other.frame, &other.camera, &other.view).expect("an odd size can be drawn");
    assert!(shot.draw(&mut screen) == first);
}
