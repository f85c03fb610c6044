//! What the window looks like: drawn as `render --panels` does, at the sizes that people have.

use crate::render::Picture;
use crate::viewer::app::App;
use crate::viewer::off_screen_window::new_context;
use crate::viewer::preferences::Preferences;
use crate::viewer::simulation::Simulation;
use crate::viewer::thumbnails::Sketcher;
use crate::viewer::{WindowShot, WindowState, window_picture};

fn shot(scene: &str) -> WindowShot {
    WindowShot { scene: scene.to_owned(), at_s: 0.05, size_px: [900, 600], ..WindowShot::default() }
}

fn brightness(picture: &Picture, [x, y]: [u32; 2]) -> u32 {
    picture.rgb_at(x, y).iter().map(|level| u32::from(*level)).sum::<u32>() / 3
}

#[test]
fn the_window_is_drawn_without_a_screen_and_the_same_each_time() {
    let picture = window_picture(&shot("bounce")).unwrap();
    assert_eq!((picture.width, picture.height), (900, 600));
    // Panels at the sides, the scene between them.
    assert!(picture.rgb_at(300, 560) != picture.rgb_at(450, 150), "nothing is drawn");
    let is_panel = |x| picture.rgb_at(x, 45).iter().all(|level| *level > 240);
    assert!(is_panel(4) && is_panel(895) && !is_panel(450));
    assert_eq!(window_picture(&shot("bounce")).unwrap(), picture);
    let error = window_picture(&shot("no-such-scene")).unwrap_err();
    assert!(error.contains("no-such-scene"), "{error}");
}

#[test]
fn every_state_has_a_picture_of_its_own_light_and_dark() {
    let states = [
        WindowState::Scene,
        WindowState::Gallery,
        WindowState::Plots,
        WindowState::Element,
        WindowState::Help,
    ];
    let draw = |state, is_dark| window_picture(&WindowShot { state, is_dark, ..shot("bounce") }).unwrap();
    let light = states.map(|state| draw(state, false));
    for (index, picture) in light.iter().enumerate() {
        assert!(light[..index].iter().all(|other| other != picture), "{:?}", states[index]);
        assert!(brightness(picture, [3, 45]) > 200);
    }
    assert!(brightness(&draw(WindowState::Gallery, true), [3, 45]) < 60);
}

#[test]
fn a_display_of_twice_the_density_shows_the_same_window_larger() {
    let small = window_picture(&shot("bounce")).unwrap();
    let large =
        window_picture(&WindowShot { size_px: [1800, 1200], pixels_per_point: 2.0, ..shot("bounce") });
    let large = large.unwrap();
    // The edges of bars and panels, and the empty places beside them.
    let places = [[4, 4], [4, 300], [262, 300], [450, 60], [636, 300], [895, 300], [450, 598], [4, 540]];
    for [x, y] in places {
        let [a, b] = [brightness(&small, [x, y]), brightness(&large, [2 * x, 2 * y])];
        assert!(a.abs_diff(b) < 25, "{a} and {b} at {x}, {y}");
    }
}

/// What the scene says of the ends of the colours is meant for its own field.
#[test]
fn another_field_finds_its_own_range() {
    let draw = |range: &str| {
        let overrides =
            vec!["recording.color_by=von-mises".to_owned(), format!("recording.color_range={range}")];
        let color_by = Some(crate::frame::ColorBy::MaxPrincipal);
        window_picture(&WindowShot { color_by, overrides, ..shot("bounce") }).unwrap()
    };
    assert!(draw("[0, 7e4]") == draw("found"));
}

#[test]
fn a_remembered_layout_is_the_same_after_it_was_shown() {
    let kept = Preferences {
        is_dark: true,
        wireframe: true,
        is_always_fine: true,
        inspector: false,
        parameters_width: 333.0,
        zoom: 1.25,
        ..Preferences::default()
    };
    let context = new_context();
    let mut app = App::new(Simulation::start(Box::new(|| {})).unwrap(), Sketcher::idle());
    kept.apply(&mut app, &context);
    app.is_gallery = false;
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0));
    for _ in 0..4 {
        let input = egui::RawInput { screen_rect: Some(screen), ..Default::default() };
        context.run_ui(input, |ui| app.update(ui)).textures_delta.clear();
    }
    let mut now = Preferences { parameters: false, ..Preferences::default() };
    now.take_in(&app, &context);
    assert_eq!(now, kept);
}
