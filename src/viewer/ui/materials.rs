//! Materials on sliders: act on reset.

use super::fracture;
use super::widgets::{Acts, Parameter, badge};
use crate::scene::Scene;
use crate::sim::Material;
use crate::viewer::criterion_edit::CriterionEdit;
use crate::viewer::edits::Edits;
use egui::{CollapsingHeader, Color32, RichText, Ui, vec2};

const MODULUS: Parameter = Parameter {
    label: "Young's modulus",
    unit: "Pa",
    hint: "Stiffness: stress per strain",
    range: 1e4..=1e12,
    is_logarithmic: true,
};
const POISSON: Parameter = Parameter {
    label: "Poisson's ratio",
    unit: "",
    hint: "How much it thins when stretched",
    range: 0.0..=0.49,
    is_logarithmic: false,
};
const DENSITY: Parameter = Parameter {
    label: "Density",
    unit: "kg/m³",
    hint: "Mass per volume",
    range: 10.0..=25e3,
    is_logarithmic: true,
};
const STIFFNESS_DAMPING: Parameter = Parameter {
    label: "Stiffness damping",
    unit: "s",
    hint: "Damps fast vibration more than slow; costs stable step",
    range: 0.0..=1e-2,
    is_logarithmic: true,
};
const DAMPING: Parameter = Parameter {
    label: "Damping",
    unit: "1/s",
    hint: "How fast ringing dies out; never slows flight or spin",
    range: 0.0..=1e4,
    is_logarithmic: true,
};

/// Shows the materials; `base` is the scene as it was opened.
pub fn show(ui: &mut Ui, edits: &mut Edits, base: Option<&Scene>) {
    badge(ui, Acts::OnReset);
    let is_open = edits.materials.len() <= 2;
    for (material, criterion) in edits.materials.iter_mut().zip(&mut edits.criteria) {
        let original =
            base.and_then(|scene| scene.description.materials.iter().find(|m| m.name == material.name));
        CollapsingHeader::new(RichText::new(&material.name))
            .id_salt(("material", &material.name))
            .default_open(is_open)
            .icon(swatch(material.color_srgb))
            .show_unindented(ui, |ui| {
                sliders(ui, material);
                // Its lists are named alike for every material.
                ui.push_id(&material.name, |ui| fracture::criterion(ui, criterion));
                go_back(ui, (material, criterion), original);
                ui.add_space(6.0);
            });
    }
}

fn sliders(ui: &mut Ui, material: &mut Material) {
    MODULUS.show(ui, &mut material.youngs_modulus_pa);
    POISSON.show(ui, &mut material.poisson_ratio);
    DENSITY.show(ui, &mut material.density_kg_m3);
    DAMPING.show(ui, &mut material.damping_per_s);
    STIFFNESS_DAMPING.show(ui, &mut material.stiffness_damping_s);
}

fn go_back(
    ui: &mut Ui,
    (material, criterion): (&mut Material, &mut CriterionEdit),
    original: Option<&Material>,
) {
    let Some(original) = original else { return };
    let criterion_before = CriterionEdit::of(original.fracture.as_ref());
    if original == material && criterion_before == *criterion {
        return;
    }
    if ui.small_button("As in the scene").on_hover_text("Takes back the changes of this material").clicked() {
        *material = original.clone();
        *criterion = criterion_before;
    }
}

/// The material's colour in place of the usual triangle.
fn swatch(color_srgb: [f32; 3]) -> impl FnOnce(&mut Ui, f32, &egui::Response) + 'static {
    let [r, g, b] = color_srgb.map(|level| (level.clamp(0.0, 1.0) * 255.0).round() as u8);
    move |ui, openness, response| {
        let rect = egui::Rect::from_center_size(response.rect.center(), vec2(12.0, 12.0));
        ui.painter().rect_filled(rect, 3.0, Color32::from_rgb(r, g, b));
        if openness < 0.5 {
            let stroke = egui::Stroke::new(1.0, ui.visuals().weak_text_color());
            ui.painter().rect_stroke(rect, 3.0, stroke, egui::StrokeKind::Outside);
        }
    }
}
