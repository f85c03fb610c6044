//! Colours, fonts and spacing of the panels.

use egui::{Color32, Context, CornerRadius, FontId, Frame, Margin, Stroke, Style, TextStyle, Theme, vec2};

/// The colour of what can be acted on and of what is chosen.
const ACCENT: Color32 = Color32::from_rgb(0x2f, 0x6f, 0xd6);

/// Sets up fonts, spacing and both themes once.
pub fn install(context: &Context) {
    for theme in [Theme::Light, Theme::Dark] {
        context.style_mut_of(theme, |style| {
            shape(style);
            paint(style, theme);
        });
    }
}

/// Light or dark from now on.
pub fn choose_theme(context: &Context, is_dark: bool) {
    context.set_theme(if is_dark { Theme::Dark } else { Theme::Light });
}

fn shape(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(11.5)),
        (TextStyle::Body, FontId::proportional(13.5)),
        (TextStyle::Button, FontId::proportional(13.5)),
        (TextStyle::Heading, FontId::proportional(16.0)),
        (TextStyle::Monospace, FontId::monospace(12.5)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(8.0, 6.0);
    spacing.button_padding = vec2(9.0, 4.0);
    spacing.interact_size = vec2(36.0, 24.0);
    spacing.slider_rail_height = 5.0;
    spacing.window_margin = Margin::same(14);
    spacing.menu_margin = Margin::same(6);
    spacing.scroll = egui::style::ScrollStyle::floating();
}

fn paint(style: &mut Style, theme: Theme) {
    let visuals = &mut style.visuals;
    let dark = theme == Theme::Dark;
    let pick = |light: u8, dark_level: u8| Color32::from_gray(if dark { dark_level } else { light });
    visuals.panel_fill = pick(247, 27);
    visuals.window_fill = pick(252, 32);
    visuals.extreme_bg_color = pick(255, 18);
    visuals.faint_bg_color = pick(241, 34);
    visuals.slider_trailing_fill = true;
    visuals.selection.bg_fill = if dark { ACCENT } else { ACCENT.gamma_multiply(0.85) };
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.menu_corner_radius = CornerRadius::same(8);
    let lines = Stroke::new(1.0, pick(222, 48));
    visuals.widgets.noninteractive.bg_stroke = lines;
    visuals.window_stroke = lines;
    visuals.widgets.noninteractive.fg_stroke.color = pick(52, 208);
    visuals.widgets.inactive.fg_stroke.color = pick(40, 220);
    visuals.widgets.inactive.weak_bg_fill = pick(232, 46);
    visuals.widgets.inactive.bg_fill = pick(214, 58);
    visuals.widgets.hovered.weak_bg_fill = pick(222, 58);
    visuals.widgets.hovered.bg_stroke = Stroke::new(1.0, pick(190, 90));
    visuals.widgets.open.weak_bg_fill = pick(240, 42);
    let radius = CornerRadius::same(6);
    for widget in [
        &mut visuals.widgets.noninteractive,
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = radius;
    }
}

/// The bars at the top and the bottom. Panels have no fill of their own: the window is cleared to their colour,
/// which costs a software driver next to nothing.
pub fn bar_frame() -> Frame {
    Frame::new().inner_margin(Margin::symmetric(12, 7))
}

/// The panels at the sides.
pub fn side_frame() -> Frame {
    Frame::new().inner_margin(Margin { left: 12, right: 4, top: 8, bottom: 8 })
}

/// The gallery.
pub fn gallery_frame() -> Frame {
    Frame::new().inner_margin(Margin { left: 20, right: 12, top: 12, bottom: 8 })
}

/// The colour of what is chosen or asks to be pressed.
#[must_use]
pub fn accent() -> Color32 {
    ACCENT
}

/// Background and text of what only says what was done.
#[must_use]
pub fn notice_colors(is_dark: bool) -> (Color32, Color32) {
    if is_dark {
        (Color32::from_rgb(38, 46, 58), Color32::from_rgb(205, 219, 238))
    } else {
        (Color32::from_rgb(233, 240, 249), Color32::from_rgb(34, 62, 98))
    }
}

/// Background and text of a warning.
#[must_use]
pub fn warning_colors(is_dark: bool) -> (Color32, Color32) {
    if is_dark {
        (Color32::from_rgb(70, 46, 20), Color32::from_rgb(255, 196, 120))
    } else {
        (Color32::from_rgb(255, 240, 214), Color32::from_rgb(140, 76, 0))
    }
}

/// Background and text of an error.
#[must_use]
pub fn error_colors(is_dark: bool) -> (Color32, Color32) {
    if is_dark {
        (Color32::from_rgb(74, 28, 28), Color32::from_rgb(255, 190, 184))
    } else {
        (Color32::from_rgb(253, 230, 227), Color32::from_rgb(150, 28, 20))
    }
}
