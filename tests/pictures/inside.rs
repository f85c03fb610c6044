//! Bodies cut open, and stress crosses.

use crate::compare::{assert_like_stored, screen};
use crate::scenes::{SIZE, Shot};
use crate::shapes::{colored, frame, ground, solid_block};
use glam::Vec3;
use hammerfall::frame::ColorBy;
use hammerfall::render::{Cut, Picture, Range, cross_room_m, look_inside};

const LOW: Vec3 = Vec3::new(-0.5, -0.5, 0.3);
const HIGH: Vec3 = Vec3::new(0.5, 0.5, 1.3);
const MIDDLE: Vec3 = Vec3::new(0.0, 0.0, 0.8);

/// A box above the floor whose values are zero in its middle and 1 and more on its sides.
fn solid_box() -> Shot {
    let cube = colored(solid_block(LOW, HIGH, [6; 3]), [0.62, 0.64, 0.68]);
    Shot::new(frame(vec![ground(), cube]))
}

#[test]
fn a_cut_shows_the_values_inside() {
    let Some(mut screen) = screen() else { return };
    let mut shot = solid_box();
    shot.view.color_by = ColorBy::Speed;
    shot.view.range = Some(Range { low: 0.0, high: 1.5 });
    let whole = shot.draw(&mut screen);
    // The front half is gone: it was between the camera and the middle.
    let cut = Cut::new(Vec3::NEG_Y, 0.0).expect("a direction");
    shot.frame = look_inside(&shot.frame, Some(&cut), None);
    let open = shot.draw(&mut screen);
    let on_section = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let inside = shot.luminance(&open, MIDDLE);
    // Small values are dark. Towards the rim of the section they grow evenly, to those of the skin.
    let levels: Vec<f32> = (0..9).map(|k| shot.luminance(&open, on_section(0.05 * k as f32, 0.8))).collect();
    assert!(levels.windows(2).all(|pair| pair[1] > pair[0]), "{levels:?}");
    assert!(inside < levels[8] - 40.0, "{levels:?}");
    // Where the front face was there is something else now.
    let front = Vec3::new(-0.4, -0.5, 0.5);
    assert!((shot.luminance(&whole, front) - shot.luminance(&open, front)).abs() > 10.0);
    assert_like_stored("cut", &open);
}

#[test]
fn a_cut_that_misses_changes_nothing() {
    let Some(mut screen) = screen() else { return };
    let mut shot = solid_box();
    let whole = shot.draw(&mut screen);
    let cut = Cut::new(Vec3::X, 0.6).expect("a direction");
    shot.frame = look_inside(&shot.frame, Some(&cut), None);
    assert!(shot.draw(&mut screen) == whole);
}

fn count(picture: &Picture, is_so: impl Fn([i32; 3]) -> bool) -> usize {
    let all = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    all.filter(|[x, y]| is_so(picture.rgb_at(*x, *y).map(i32::from))).count()
}

#[test]
fn crosses_show_pull_and_push_in_two_colors_with_a_legend() {
    let Some(mut screen) = screen() else { return };
    let mut shot = solid_box();
    let is_red = |[r, g, b]: [i32; 3]| r > g + 60 && r > b + 60;
    let is_blue = |[r, _, b]: [i32; 3]| b > r + 60;
    let bare = shot.draw(&mut screen);
    assert_eq!((count(&bare, is_red), count(&bare, is_blue)), (0, 0));
    let cut = Cut::new(Vec3::NEG_Y, 0.0).expect("a direction");
    let room_m = cross_room_m(&shot.frame);
    shot.frame = look_inside(&shot.frame, Some(&cut), Some(room_m));
    assert!(!shot.frame.crosses.is_empty());
    // All of them stand on the section.
    assert!(shot.frame.crosses.iter().all(|cross| cross.position_m[1].abs() < 1e-4));
    let drawn = shot.draw(&mut screen);
    let (red, blue) = (count(&drawn, is_red), count(&drawn, is_blue));
    assert!(red > 60 && blue > 30 && red > blue, "{red} {blue}");
    shot.view.legend = false;
    let without_legend = shot.draw(&mut screen);
    assert!(count(&without_legend, is_red) < red, "the legend has a sample");
    assert_like_stored("crosses", &drawn);
}
