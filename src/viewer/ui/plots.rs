//! Balances over time.

use super::icons;
use super::widgets::measured;
use crate::viewer::history::{History, Row};
use crate::viewer::recording::Recording;
use egui::{Color32, RichText, Ui};
use egui_plot::{AxisHints, GridMark, HoverPosition, Line, LineStyle, Plot, PlotPoints, VLine};
use std::cell::Cell;

const HEIGHT: f32 = 150.0;
/// Labels of times nearer than this to each other fade and go, points.
pub(super) const X_LABEL_SPACING: egui::Rangef = egui::Rangef { min: 36.0, max: 48.0 };
/// More points than the panel has pixels only cost time.
const MOST_POINTS: usize = 300;

/// One curve.
struct Curve {
    name: &'static str,
    hint: &'static str,
    color: Color32,
    is_dashed: bool,
    value: fn(&Row) -> f64,
}

static ENERGIES: [Curve; 6] = [
    Curve {
        name: "Kinetic",
        hint: "Energy of motion",
        color: Color32::from_rgb(0x3b, 0x82, 0xd6),
        is_dashed: false,
        value: |row| row.kinetic_j,
    },
    Curve {
        name: "Strain",
        hint: "Elastic energy of deformation",
        color: Color32::from_rgb(0xe0, 0x7b, 0x39),
        is_dashed: false,
        value: |row| row.strain_j,
    },
    Curve {
        name: "Potential",
        hint: "Of gravity, relative to the start",
        color: Color32::from_rgb(0x4f, 0xa3, 0x5f),
        is_dashed: false,
        value: |row| row.potential_j,
    },
    Curve {
        name: "Dissipated",
        hint: "Taken by damping, friction, plastic impact and dropped vibration",
        color: Color32::from_rgb(0xb0, 0x5c, 0x9e),
        is_dashed: false,
        value: |row| row.dissipated_j,
    },
    Curve {
        name: "Work done",
        hint: "From outside so far: what was thrown brings its energy of motion, pulls and prescribed motion add theirs",
        color: Color32::from_rgb(0xb8, 0x9a, 0x2f),
        is_dashed: false,
        value: |row| row.work_j,
    },
    Curve {
        name: "Sum − work",
        hint: "Kinetic, strain, potential and dissipated energy less the work done from outside: constant when the balance holds",
        color: Color32::from_gray(0x88),
        is_dashed: true,
        value: |row| row.sum_j,
    },
];

/// A curve with a plot of its own.
const fn single(
    name: &'static str,
    hint: &'static str,
    color: Color32,
    value: fn(&Row) -> f64,
) -> [Curve; 1] {
    [Curve { name, hint, color, is_dashed: false, value }]
}

static FORCE: [Curve; 1] = single(
    "Contact force",
    "Sum of the lengths of all contact forces",
    Color32::from_rgb(0xd0, 0x4a, 0x4a),
    |row| row.contact_force_n,
);
static MOMENTUM: [Curve; 1] = single(
    "Magnitude",
    "Length of the sum of the momenta of all bodies: never negative, whatever its direction",
    Color32::from_rgb(0x3b, 0x82, 0xd6),
    |row| row.momentum_kg_m_s,
);
static FRAGMENTS: [Curve; 1] = single(
    "Pieces",
    "Connected pieces of what deforms; a body that is whole counts as one",
    Color32::from_rgb(0xe0, 0x7b, 0x39),
    |row| row.fragments,
);
static STEP: [Curve; 1] =
    single("Stable step", "Elastic step of the slowest body", Color32::from_rgb(0x4f, 0xa3, 0x5f), |row| {
        row.stable_step_s
    });

/// A plot with its title and unit.
pub struct Figure {
    /// Title of its section.
    pub title: &'static str,
    unit: &'static str,
    curves: &'static [Curve],
}

/// The plots, from top to bottom.
pub static FIGURES: [Figure; 5] = [
    Figure { title: "Energy", unit: "J", curves: &ENERGIES },
    Figure { title: "Contact force", unit: "N", curves: &FORCE },
    Figure { title: "Pieces", unit: "", curves: &FRAGMENTS },
    Figure { title: "Momentum (magnitude)", unit: "N s", curves: &MOMENTUM },
    Figure { title: "Stable step", unit: "s", curves: &STEP },
];

impl Figure {
    /// Shows the plot with a line at `now_s`, and the values there; returns the time of the recorded moment that was clicked on, s:
    /// the one of which values were told under the mouse.
    pub fn show(&self, ui: &mut Ui, history: &History, recording: &Recording, now_s: f64) -> Option<f64> {
        let clicked_s = plot(ui, self, (history, recording), now_s);
        legend(ui, self, history.row_at(now_s).copied().unwrap_or_default());
        clicked_s
    }
}

/// The recorded moment nearest to a time, s, and the balances that are known of it.
fn moment_near(history: &History, recording: &Recording, time_s: f64) -> Option<(f64, Row)> {
    // Both may be thinned out, each in its own way.
    let moment = recording.nearest(history.row_at(time_s)?.time_s)?;
    Some((moment.time_s, *history.row_at(moment.time_s)?))
}

fn plot(
    ui: &mut Ui,
    figure: &Figure,
    (history, recording): (&History, &Recording),
    now_s: f64,
) -> Option<f64> {
    let Figure { title, unit, curves } = *figure;
    let rows = history.rows();
    let told_s = Cell::new(None);
    let label = |position: &HoverPosition<'_>| match position {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            let curve = curves.iter().find(|curve| curve.name == *plot_name)?;
            let (time_s, row) = moment_near(history, recording, position.x)?;
            told_s.set(Some(time_s));
            Some(format!(
                "{plot_name} {}\nat {}",
                value_text((curve.value)(&row), unit),
                measured(time_s, "s")
            ))
        }
        HoverPosition::Elsewhere { .. } => None,
    };
    let grid_color = ui.visuals().widgets.noninteractive.bg_stroke.color;
    let shown = Plot::new(title)
        .height(HEIGHT)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .show_crosshair(false)
        .grid_color(grid_color)
        .grid_spacing(egui::Rangef::new(10.0, 40.0))
        .x_grid_spacer(|grid| marks(grid.bounds, 3.4, 0.0))
        .y_grid_spacer(move |grid| marks(grid.bounds, 5.0, if unit.is_empty() { 1.0 } else { 0.0 }))
        .y_axis_min_width(48.0)
        .set_margin_fraction(egui::vec2(0.1, 0.06))
        .include_y(0.0)
        .include_x(0.0)
        .include_x(if is_flat(rows, |row| row.time_s) { 1e-3 } else { 0.0 })
        .include_y(if curves.iter().all(|curve| is_flat(rows, curve.value)) { 1.0 } else { 0.0 })
        .custom_x_axes(vec![AxisHints::new_x().label_spacing(X_LABEL_SPACING)])
        .x_axis_formatter(|mark, range| {
            // A label at the very end would stick out of the panel.
            let is_last = range.end() - mark.value < 0.1 * (range.end() - range.start());
            if is_last { String::new() } else { tick(mark.value, "s") }
        })
        .y_axis_formatter(move |mark, _| tick(mark.value, unit))
        .label_formatter(label)
        .show(ui, |plot| {
            plot.vline(VLine::new("now", now_s).color(grid_color).width(1.5).allow_hover(false));
            for curve in curves {
                let style =
                    if curve.is_dashed { LineStyle::Dashed { length: 6.0 } } else { LineStyle::Solid };
                plot.line(
                    line(curve.name, points(rows, curve.value)).color(curve.color).width(1.6).style(style),
                );
            }
        });
    let at = shown.response.clicked().then(|| shown.response.interact_pointer_pos()).flatten()?;
    let under_mouse_s = shown.transform.value_from_position(at).x;
    told_s.get().or_else(|| moment_near(history, recording, under_mouse_s).map(|(time_s, _)| time_s))
}

/// A line through points, however near they are to each other. The plotting crate would else make one place of all that
/// share a pixel's width, as high as they differ, and fill the room from there to the next: of few points, two of which
/// are near, a triangle.
pub(super) fn line<'a>(name: &str, points: impl Into<PlotPoints<'a>>) -> Line<'a> {
    Line::new(name, points).allow_band(false)
}

/// Whether there is nothing but zeros, so that the axis needs some other end.
fn is_flat(rows: &[Row], value: fn(&Row) -> f64) -> bool {
    rows.iter().all(|row| value(row) == 0.0)
}

/// Marks at round values, about `count` of them, and at least so far apart: what is counted has no halves.
pub(super) fn marks((low, high): (f64, f64), count: f64, least_step: f64) -> Vec<GridMark> {
    let rough = ((high - low) / count).max(least_step);
    if !(rough.is_finite() && rough > 0.0) {
        return Vec::new();
    }
    let decade = 10f64.powf(rough.log10().floor());
    let lead = [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .filter(|lead| least_step == 0.0 || *lead != 2.5)
        .find(|lead| lead * decade >= 0.999 * rough)
        .unwrap_or(10.0);
    let step_size = lead * decade;
    let (first, last) = ((low / step_size).ceil() as i64, (high / step_size).floor() as i64);
    (first..=last).map(|number| GridMark { value: number as f64 * step_size, step_size }).collect()
}

pub(super) fn tick(value: f64, unit: &str) -> String {
    if value == 0.0 { "0".to_owned() } else { value_text(value, unit) }
}

/// A value with its unit; a count as it is.
fn value_text(value: f64, unit: &str) -> String {
    if unit.is_empty() { format!("{value:.0}") } else { measured(value, unit) }
}

/// Points of a curve, of each group of rows the one largest in size, so that no peak is lost.
fn points(rows: &[Row], value: fn(&Row) -> f64) -> Vec<[f64; 2]> {
    let group = rows.len().div_ceil(MOST_POINTS).max(1);
    let largest = |rows: &[Row]| {
        let row = rows.iter().max_by(|a, b| value(a).abs().total_cmp(&value(b).abs()))?;
        Some([row.time_s, value(row)])
    };
    rows.chunks(group).filter_map(largest).collect()
}

/// Names and the values of the moment looked at, two in a row, and which moment that is.
fn legend(ui: &mut Ui, figure: &Figure, row: Row) {
    let Figure { title, unit, curves } = *figure;
    egui::Grid::new(("legend", title)).num_columns(2).spacing([6.0, 2.0]).show(ui, |ui| {
        for (index, curve) in curves.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                icons::swatch(ui, curve.color);
                let text = format!("{} {}", curve.name, value_text((curve.value)(&row), unit));
                ui.label(RichText::new(text).small()).on_hover_text(curve.hint);
            });
            if index % 2 == 1 {
                ui.end_row();
            }
        }
        let text = format!("at {}", measured(row.time_s, "s"));
        ui.label(RichText::new(text).small().weak()).on_hover_text("The moment that these values are of");
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::with_unit;

    #[test]
    fn marks_are_few_and_round() {
        let values = |bounds| marks(bounds, 3.0, 0.0).iter().map(|mark| mark.value).collect::<Vec<_>>();
        assert_eq!(values((0.0, 10.0)), [0.0, 5.0, 10.0]);
        assert_eq!(values((0.0, 7.0)), [0.0, 2.5, 5.0]);
        assert_eq!(values((-2.5, 3.1)), [-2.0, 0.0, 2.0]);
        let counts = |high| marks((0.0, high), 5.0, 1.0).iter().map(|mark| mark.value).collect::<Vec<_>>();
        assert_eq!(counts(1.1), [0.0, 1.0]);
        assert_eq!(counts(7.4), [0.0, 2.0, 4.0, 6.0]);
        assert_eq!(
            (value_text(12.0, ""), value_text(1500.0, "N")),
            ("12".to_owned(), with_unit(1500.0, "N"))
        );
        assert!(values((1.0, 1.0)).is_empty() && values((0.0, f64::NAN)).is_empty());
    }

    /// Two points at the same time, as a throw leaves them, and one later: lines of the curve's colour, and no area.
    #[test]
    fn few_points_make_lines_and_no_areas() {
        let mut history = History::default();
        for (time_s, kinetic_j) in [(0.0, 0.0), (0.0, 40.0), (1e-5, 20.0), (2e-5, 21.0)] {
            history.offer(Row { time_s, kinetic_j, strain_j: 0.5 * kinetic_j, ..Row::default() });
        }
        let context = egui::Context::default();
        let mut covered_points2 = 0.0;
        for _ in 0..3 {
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(260.0, 300.0));
            let input = egui::RawInput { screen_rect: Some(screen), ..Default::default() };
            let mut output = context.run_ui(input, |ui| {
                FIGURES[0].show(ui, &history, &Recording::default(), 2e-5);
            });
            covered_points2 = output
                .shapes
                .iter()
                .flat_map(|shape| context.tessellate(vec![shape.clone()], 1.0))
                .map(|drawn| area_of(&drawn, ENERGIES[0].color))
                .sum::<f32>();
            output.textures_delta.clear();
        }
        // The longest way is up to the top and half down, and a swatch beside the name.
        let longest = 1.6 * (HEIGHT * 1.5 + 260.0) + 200.0;
        assert!((100.0..longest).contains(&covered_points2), "{covered_points2}");
    }

    fn area_of(drawn: &egui::ClippedPrimitive, color: Color32) -> f32 {
        let egui::epaint::Primitive::Mesh(mesh) = &drawn.primitive else { return 0.0 };
        let corners = mesh
            .indices
            .as_chunks::<3>()
            .0
            .iter()
            .map(|corners| corners.map(|corner| mesh.vertices[corner as usize]));
        let colored = corners.filter(|corners| corners.iter().all(|corner| corner.color == color));
        colored.map(|[a, b, c]| 0.5 * ((b.pos - a.pos).rot90().dot(c.pos - a.pos)).abs()).sum()
    }

    /// A click went to the moment before the mouse, and the value that was told was that of a point beside it.
    #[test]
    fn what_is_told_is_of_the_moment_that_a_click_goes_to() {
        let mut history = History::default();
        let mut recording = Recording::default();
        for moment in 0..40 {
            let time_s = f64::from(moment) * 0.1;
            history.offer(Row { time_s, kinetic_j: time_s, ..Row::default() });
            if moment % 4 == 0 {
                let frame = crate::frame::Frame { time_s, ..Default::default() };
                recording.push(std::sync::Arc::new(frame), 0);
            }
        }
        for (at_s, moment_s) in [(0.0, 0.0), (0.29, 0.4), (0.69, 0.8), (1.14, 1.2), (99.0, 3.6)] {
            let (time_s, row) = moment_near(&history, &recording, at_s).unwrap();
            assert!((time_s - moment_s).abs() < 1e-9, "{at_s}: {time_s}");
            assert_eq!((recording.at(time_s).unwrap().time_s, row.kinetic_j), (time_s, time_s));
        }
    }

    #[test]
    fn thinning_keeps_the_peak() {
        let rows: Vec<Row> = (0..2000)
            .map(|i| Row {
                time_s: f64::from(i),
                contact_force_n: if i == 777 { -50.0 } else { 1.0 },
                ..Row::default()
            })
            .collect();
        let points = points(&rows, |row| row.contact_force_n);
        assert!(points.len() <= MOST_POINTS);
        assert!(points.contains(&[777.0, -50.0]));
        assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }
}
