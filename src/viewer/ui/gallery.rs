//! The scenes to choose from.

use super::Action;
use super::widgets::side_scroll;
use crate::scene::{BUILTIN_SCENES, BuiltinScene};
use crate::viewer::app::App;
use egui::{Color32, Image, Margin, Rect, RichText, Sense, TextureId, Ui, UiBuilder, pos2, vec2};

/// Narrowest card and the space between cards, points.
const CARD_WIDTH: f32 = 236.0;
const GAP: f32 = 14.0;
/// Height of the text below the picture, points.
const TEXT_HEIGHT: f32 = 78.0;
/// Ending of the finer variant of a scene.
const FINER: &str = "-fine";

/// Shows the gallery.
pub fn show(ui: &mut Ui, app: &App, actions: &mut Vec<Action>) {
    side_scroll().show(ui, |ui| {
        ui.add_space(6.0);
        ui.heading("Choose a scene");
        ui.weak("Or drop a scene file (.toml) onto the window.");
        ui.add_space(8.0);
        let width = ui.available_width();
        let columns = ((width + GAP) / (CARD_WIDTH + GAP)).floor().max(1.0);
        let card_width = (width - GAP * (columns - 1.0)) / columns;
        let cards: Vec<_> =
            BUILTIN_SCENES.iter().enumerate().filter(|(_, scene)| !scene.name.ends_with(FINER)).collect();
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        for row in cards.chunks(columns as usize) {
            ui.horizontal(|ui| {
                for (index, scene) in row {
                    card(ui, scene, app.thumbnails[*index], card_width, actions);
                }
            });
        }
    });
}

fn card(
    ui: &mut Ui,
    scene: &BuiltinScene,
    picture: Option<TextureId>,
    width: f32,
    actions: &mut Vec<Action>,
) {
    let picture_height = width * 9.0 / 16.0;
    let (rect, response) = ui.allocate_exact_size(vec2(width, picture_height + TEXT_HEIGHT), Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Open {}", scene.name)));
    let stroke = if response.hovered() {
        egui::Stroke::new(1.5, super::style::accent())
    } else {
        ui.visuals().window_stroke
    };
    ui.painter().rect(rect, 8.0, ui.visuals().window_fill, stroke, egui::StrokeKind::Inside);
    let frame = Rect::from_min_size(rect.min, vec2(width, picture_height)).shrink(1.5);
    draw_picture(ui, frame, picture);
    let text = Rect::from_min_max(pos2(rect.left(), frame.bottom()), rect.max) - Margin::symmetric(11, 8);
    let mut inner =
        ui.new_child(UiBuilder::new().max_rect(text).layout(egui::Layout::top_down(egui::Align::Min)));
    inner.spacing_mut().item_spacing = vec2(6.0, 2.0);
    let is_finer_clicked = card_text(&mut inner, scene);
    if is_finer_clicked {
        actions.push(Action::Open(format!("{}{FINER}", scene.name)));
    } else if response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked() {
        actions.push(Action::Open(scene.name.to_owned()));
    }
}

fn draw_picture(ui: &Ui, frame: Rect, picture: Option<TextureId>) {
    let rounding = egui::CornerRadius { nw: 7, ne: 7, sw: 0, se: 0 };
    match picture {
        Some(id) => {
            let source = egui::load::SizedTexture::new(id, frame.size());
            Image::from_texture(source).corner_radius(rounding).paint_at(ui, frame);
        }
        None => {
            ui.painter().rect_filled(frame, rounding, ui.visuals().faint_bg_color);
        }
    }
}

/// Name and summary; returns whether the finer variant was asked for.
fn card_text(ui: &mut Ui, scene: &BuiltinScene) -> bool {
    let finer = format!("{}{FINER}", scene.name);
    let has_finer = BUILTIN_SCENES.iter().any(|other| other.name == finer);
    let mut is_finer_clicked = false;
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(scene.name).strong()).selectable(false));
        if has_finer {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let button = egui::Button::new(RichText::new("finer").small()).fill(Color32::TRANSPARENT);
                is_finer_clicked =
                    ui.add(button).on_hover_text("The same with a finer mesh; slower").clicked();
            });
        }
    });
    ui.add(egui::Label::new(RichText::new(scene.summary).weak()).wrap().selectable(false));
    is_finer_clicked
}
