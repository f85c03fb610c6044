//! The element that was clicked on: its stress, and Mohr's circles with the envelope of its criterion.

use super::widgets::measured;
use crate::fracture::{Criterion, Strength};
use crate::viewer::inspection::Inspection;
use egui::{Color32, Grid, RichText, Ui};
use egui_plot::{Line, Plot, VLine};
use std::f64::consts::TAU;

const HEIGHT: f32 = 170.0;
const CIRCLE: Color32 = Color32::from_rgb(0x3b, 0x82, 0xd6);
const ENVELOPE: Color32 = Color32::from_rgb(0xd0, 0x4a, 0x4a);

/// Shows the element.
pub fn show(ui: &mut Ui, inspection: Option<&Inspection>, is_back: bool) {
    let Some(inspection) = inspection else {
        ui.weak("Click on a body to look at an element.");
        return;
    };
    ui.label(format!("{}, element {}", inspection.body, inspection.element));
    if is_back {
        ui.label(RichText::new("Values of the present, not of the moment looked back at").small().weak());
    }
    Grid::new("element").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(RichText::new(name).small().weak());
            ui.label(RichText::new(value).small().strong());
            ui.end_row();
        };
        row("material", inspection.material.clone());
        if let Some(fragment) = inspection.fragment {
            row("fragment", fragment.to_string());
        }
        for (name, value) in ["s1", "s2", "s3"].into_iter().zip(inspection.principal_pa.to_array()) {
            row(name, measured(value, "Pa"));
        }
        if let Some(index) = inspection.failure_index {
            row("failure index", format!("{index:.3}"));
        }
    });
    components(ui, inspection);
    mohr(ui, inspection);
}

/// The tensor in world axes, two components a row: more would not fit into the panel.
fn components(ui: &mut Ui, inspection: &Inspection) {
    let s = inspection.cauchy_pa;
    let rows = [
        [("σx", s.x_axis.x), ("τxy", s.x_axis.y)],
        [("σy", s.y_axis.y), ("τyz", s.y_axis.z)],
        [("σz", s.z_axis.z), ("τzx", s.z_axis.x)],
    ];
    Grid::new("components").num_columns(4).spacing([8.0, 2.0]).show(ui, |ui| {
        for row in rows {
            for (name, value) in row {
                ui.label(RichText::new(name).small().weak());
                ui.label(RichText::new(measured(value, "Pa")).small().strong());
            }
            ui.end_row();
        }
    });
}

fn mohr(ui: &mut Ui, inspection: &Inspection) {
    let [s1, s2, s3] = inspection.principal_pa.to_array();
    let lines = inspection.criterion.as_ref().map(envelope).unwrap_or_default();
    let reach = (s1 - s3).abs().max(s1.abs()).max(s3.abs());
    // Without stress the envelope alone says how large the picture must be.
    let reach = if reach > 0.0 { reach } else { lines.iter().map(|l| l.size_pa()).fold(1.0, f64::max) };
    let grid_color = ui.visuals().widgets.noninteractive.bg_stroke.color;
    Plot::new("Mohr's circles")
        .grid_color(grid_color)
        .height(HEIGHT)
        .data_aspect(1.0)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .include_x(s3 - 0.3 * reach)
        .include_x(s1 + 0.3 * reach)
        .include_y(0.8 * reach)
        .include_y(-0.8 * reach)
        .x_axis_formatter(|mark, _| measured(mark.value, "Pa"))
        .y_axis_formatter(|mark, _| measured(mark.value, "Pa"))
        .show(ui, |plot| {
            for (name, high, low) in [("s1, s3", s1, s3), ("s1, s2", s1, s2), ("s2, s3", s2, s3)] {
                plot.line(
                    Line::new(name, circle(0.5 * (high + low), 0.5 * (high - low))).color(CIRCLE).width(1.6),
                );
            }
            for limit in &lines {
                match limit {
                    Limit::Tension(strength_pa) => {
                        plot.vline(VLine::new("tension", *strength_pa).color(ENVELOPE))
                    }
                    Limit::Shear { cohesion_pa, slope } => {
                        let (low, high) =
                            (s3 - 2.0 * reach, (s1 + 2.0 * reach).min(apex(*cohesion_pa, *slope)));
                        for sign in [1.0, -1.0] {
                            let points = [low, high].map(|s| [s, sign * (cohesion_pa - s * slope)]);
                            plot.line(Line::new("shear", points.to_vec()).color(ENVELOPE).width(1.4));
                        }
                    }
                }
            }
        });
    if inspection.criterion.is_some() && lines.is_empty() {
        ui.label(
            RichText::new("This criterion has no envelope in this plane: it looks at all three stresses.")
                .small()
                .weak(),
        );
    }
}

fn circle(centre: f64, radius: f64) -> Vec<[f64; 2]> {
    (0..=96)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 96.0).sin_cos();
            [centre + radius * cos, radius * sin]
        })
        .collect()
}

/// A line of the envelope: what touches it fails.
enum Limit {
    /// At this normal stress, Pa.
    Tension(f64),
    /// At the shear stress `cohesion - slope * normal stress`.
    Shear { cohesion_pa: f64, slope: f64 },
}

impl Limit {
    fn size_pa(&self) -> f64 {
        match self {
            Self::Tension(size_pa) | Self::Shear { cohesion_pa: size_pa, .. } => *size_pa,
        }
    }
}

/// Where the two lines of an envelope meet, Pa.
fn apex(cohesion_pa: f64, slope: f64) -> f64 {
    if slope > 0.0 { cohesion_pa / slope } else { f64::INFINITY }
}

fn envelope(criterion: &Criterion) -> Vec<Limit> {
    let limit = |strength: &Strength| match *strength {
        Strength::Tensile { tensile_strength_pa } => Some(Limit::Tension(tensile_strength_pa)),
        Strength::Tresca { shear_strength_pa } => {
            Some(Limit::Shear { cohesion_pa: shear_strength_pa, slope: 0.0 })
        }
        Strength::MohrCoulomb { cohesion_pa, friction_angle_rad } => {
            Some(Limit::Shear { cohesion_pa, slope: friction_angle_rad.tan() })
        }
        _ => None,
    };
    criterion.rules().iter().filter_map(|rule| limit(&rule.strength)).collect()
}
