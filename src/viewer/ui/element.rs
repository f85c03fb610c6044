//! The element that was clicked on: its stress, and Mohr's circles with the envelope of its criterion.

use super::plots::{X_LABEL_SPACING, line, marks, tick};
use super::stress_space::{self, NearSurface};
use super::viewport;
use super::widgets::measured;
use crate::fracture::envelope::{
    DrawnRange, distance_along_pa, mohr_envelope, principal_place, principal_point_pa,
};
use crate::fracture::{Criterion, CriterionError, Strength};
use crate::render::short;
use crate::viewer::app::App;
use crate::viewer::inspection::{Inspection, RigidBody};
use egui::{Align2, Color32, Grid, Id, Rect, RichText, Stroke, Ui};
use egui_plot::{AxisHints, Plot, PlotPoint, PlotUi, Points, Text};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

pub const HEIGHT: f32 = 170.0;
pub const CIRCLE: Color32 = Color32::from_rgb(0x3b, 0x82, 0xd6);
pub const ENVELOPE: Color32 = Color32::from_rgb(0xd0, 0x4a, 0x4a);

/// Shows the element.
pub fn show(ui: &mut Ui, app: &App) {
    let Some(inspection) = app.inspection() else {
        ui.weak(if app.is_inspection_late() {
            "Finding the values of this moment …"
        } else if app.snapshot.inspection.is_some() {
            "At this moment the element is not there."
        } else {
            "Click on a body to look at an element."
        });
        return;
    };
    if let Some(rigid) = &inspection.rigid {
        return rigid_body(ui, &inspection.body, rigid);
    }
    ui.label(format!("{}, element {}", inspection.body, inspection.element));
    Grid::new("element").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| told(ui, name, &value);
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
    let curves =
        inspection.criterion.as_ref().map(|criterion| curves(ui, criterion, inspection.principal_pa));
    mohr(ui, inspection, curves.as_ref().map_or(&[], |curves| &curves.envelope));
    if let Some(curves) = curves {
        stress_space::show(ui, &curves.surface, inspection.principal_pa);
    }
}

/// A row of a grid: a name and its value.
fn told(ui: &mut Ui, name: &str, value: &str) {
    ui.label(RichText::new(name).small().weak());
    ui.label(RichText::new(value).small().strong());
    ui.end_row();
}

/// Most coefficients of friction with a rigid body that are told.
const MOST_PAIRS: usize = 8;

/// A body that does not deform has no elements to speak of.
fn rigid_body(ui: &mut Ui, name: &str, rigid: &RigidBody) {
    ui.label(name);
    ui.weak("It is rigid: no stress, no cracks.");
    Grid::new("rigid").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| told(ui, name, &value);
        match rigid.motion {
            None => row("moves", "never".to_owned()),
            Some((velocity_m_s, spin_rad_s)) => {
                row("moves", "as the scene prescribes".to_owned());
                row("speed now", measured(velocity_m_s.length(), "m/s"));
                row("spin now", measured(spin_rad_s.length(), "rad/s"));
            }
        }
        for (coefficient, other) in rigid.friction.iter().take(MOST_PAIRS) {
            row("friction", format!("{} with {other}", short(*coefficient)));
        }
    });
}

/// Outlines the element in the picture, where its skin is in sight.
pub fn mark(ui: &Ui, app: &App, area: Rect) {
    let Some(inspection) = app.inspection().filter(|inspection| inspection.rigid.is_none()) else { return };
    let painter = ui.painter().with_clip_rect(area);
    for corners_m in skin_in_sight(app, area, inspection) {
        let corners = corners_m.map(|corner_m| viewport::on_screen(app, area, corner_m));
        let [Some(a), Some(b), Some(c)] = corners else { continue };
        // Light around dark: it is seen on every colour.
        for stroke in [Stroke::new(4.0, Color32::WHITE), Stroke::new(1.8, Color32::BLACK)] {
            // Side by side: a line around a sharp corner runs out into a spike as long as the picture.
            for ends in [[a, b], [b, c], [c, a]] {
                painter.line_segment(ends, stroke);
            }
        }
    }
}

/// The triangles of an element that nothing hides, m.
pub fn skin_in_sight(app: &App, area: Rect, inspection: &Inspection) -> Vec<[Vec3; 3]> {
    let bodies = &app.drawn().bodies;
    let Some(body) = bodies.iter().position(|body| *body.name == *inspection.body) else { return Vec::new() };
    let (surface, positions_m) = (&bodies[body].surface, &bodies[body].positions_m);
    let own = surface.triangles.iter().zip(&surface.triangle_element);
    let own = own.filter(|(_, element)| **element == inspection.element);
    let place = |node: u32| positions_m.get(node as usize).map(|p| Vec3::from(*p));
    let corners = own.filter_map(|(&[a, b, c], _)| Some([place(a)?, place(b)?, place(c)?]));
    let is_seen = |corners_m: &[Vec3; 3]| {
        let middle_m = corners_m.iter().sum::<Vec3>() / 3.0;
        let hit = viewport::on_screen(app, area, middle_m).and_then(|at| viewport::hit_at(app, area, at));
        hit.is_some_and(|hit| (hit.body, hit.element) == (body, inspection.element))
    };
    corners.filter(is_seen).collect()
}

/// What a criterion looks like near a state of stress.
struct Curves {
    criterion: Criterion,
    principal_pa: DVec3,
    envelope: Vec<Limit>,
    surface: Result<NearSurface, CriterionError>,
}

/// Found once for each state, not for each frame of the window: it takes thousands of looks at the criterion.
fn curves(ui: &Ui, criterion: &Criterion, principal_pa: DVec3) -> Arc<Curves> {
    let id = Id::unique("failure surface");
    let known = ui.data(|data| data.get_temp::<Arc<Curves>>(id));
    if let Some(known) = known.filter(|k| k.principal_pa == principal_pa && k.criterion == *criterion) {
        return known;
    }
    let found = Arc::new(Curves {
        criterion: criterion.clone(),
        principal_pa,
        envelope: envelope(criterion, principal_pa),
        surface: NearSurface::of(criterion, principal_pa),
    });
    ui.data_mut(|data| data.insert_temp(id, found.clone()));
    found
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

fn mohr(ui: &mut Ui, inspection: &Inspection, lines: &[Limit]) {
    let [s1, s2, s3] = inspection.principal_pa.to_array();
    let reach = (s1 - s3).abs().max(s1.abs()).max(s3.abs());
    // Without stress the envelope alone says how large the picture must be.
    let strength = |line: &Limit| line.first().map_or(0.0, |[sigma, tau]| sigma.abs().max(*tau));
    let reach = if reach > 0.0 { reach } else { lines.iter().map(strength).fold(1.0, f64::max) };
    figure(ui, "Mohr's circles", ["normal stress σ", "shear stress τ"])
        .include_x(s3 - 0.3 * reach)
        .include_x(s1 + 0.3 * reach)
        .include_y(0.8 * reach)
        .include_y(-0.8 * reach)
        .show(ui, |plot| {
            for (name, high, low) in [("s1, s3", s1, s3), ("s1, s2", s1, s2), ("s2, s3", s2, s3)] {
                plot.line(
                    line(name, circle(0.5 * (high + low), 0.5 * (high - low))).color(CIRCLE).width(1.6),
                );
            }
            for limit in lines {
                for sign in [1.0, -1.0] {
                    let points: Vec<[f64; 2]> =
                        limit.iter().map(|[sigma, tau]| [*sigma, sign * tau]).collect();
                    plot.line(line("envelope", points).color(ENVELOPE).width(1.4));
                }
            }
            // Apart even where two of them are equal.
            let places = [(s1, Align2::LEFT_TOP), (s2, Align2::CENTER_BOTTOM), (s3, Align2::RIGHT_TOP)];
            for (name, (stress_pa, anchor)) in ["s1", "s2", "s3"].into_iter().zip(places) {
                plot.points(Points::new(name, vec![[stress_pa, 0.0]]).radius(2.5).color(CIRCLE));
                mark_place(plot, name, [stress_pa, 0.0], anchor);
            }
        });
    if let Some(criterion) = &inspection.criterion {
        let text = match lines.len() {
            0 => {
                "Mohr's circles. No red line: with s2 as far between s1 and s3 as now, this criterion bounds no circles."
            }
            drawn if drawn < criterion.rules().len() => {
                "Mohr's circles; red: what touches it fails, with s2 as far between s1 and s3 as now. Not every rule of the \
                 criterion bounds circles."
            }
            _ => "Mohr's circles; red: what touches it fails, with s2 as far between s1 and s3 as now.",
        };
        ui.label(RichText::new(text).small().weak());
    }
}

/// Writes a name at a place of a plot.
pub fn mark_place(plot: &mut PlotUi<'_>, name: &str, [x, y]: [f64; 2], anchor: Align2) {
    let text = RichText::new(name).small();
    plot.text(Text::new(name, PlotPoint::new(x, y), text).anchor(anchor).allow_hover(false));
}

/// A plot that stands still; axes without a name have none written.
pub fn figure(ui: &Ui, name: &str, [x_name, y_name]: [&str; 2]) -> Plot<'static> {
    Plot::new(name.to_owned())
        .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
        .height(HEIGHT)
        .data_aspect(1.0)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .grid_spacing(egui::Rangef::new(10.0, 40.0))
        .x_grid_spacer(|grid| marks(grid.bounds, 3.0, 0.0))
        .y_grid_spacer(|grid| marks(grid.bounds, 4.0, 0.0))
        .custom_x_axes(vec![AxisHints::new_x().label(small(x_name)).label_spacing(X_LABEL_SPACING)])
        .custom_y_axes(vec![AxisHints::new_y().label(small(y_name))])
        .x_axis_formatter(|mark, range| {
            // A label at the very end would stick out of the panel.
            let is_last = range.end() - mark.value < 0.1 * (range.end() - range.start());
            if is_last { String::new() } else { tick(mark.value, "Pa") }
        })
        .y_axis_formatter(|mark, _| tick(mark.value, "Pa"))
}

fn small(text: &str) -> RichText {
    RichText::new(text).small()
}

fn circle(centre: f64, radius: f64) -> Vec<[f64; 2]> {
    (0..=96)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 96.0).sin_cos();
            [centre + radius * cos, radius * sin]
        })
        .collect()
}

/// A line of the envelope, `[sigma, tau]`, Pa: what touches it fails.
type Limit = Vec<[f64; 2]>;

/// The envelope of each rule, from far in pressure to the apex.
fn envelope(criterion: &Criterion, principal_pa: DVec3) -> Vec<Limit> {
    let [s1, _, s3] = principal_pa.to_array();
    let size_pa = s1.abs().max(s3.abs());
    criterion.rules().iter().filter_map(|rule| limit(&rule.strength, principal_pa, size_pa)).collect()
}

fn limit(strength: &Strength, principal_pa: DVec3, size_pa: f64) -> Option<Limit> {
    if let Strength::Tensile { tensile_strength_pa } = strength {
        return Some(upright(*tensile_strength_pa, size_pa));
    }
    let criterion = Criterion::single(strength.clone()).ok()?;
    let (_, _, angle_rad) = principal_place(principal_pa);
    let along = principal_point_pa(0.0, 1.0, angle_rad);
    let own_pa = distance_along_pa(&criterion, DVec3::ZERO, along).ok()??;
    let reach_pa = 2.5 * own_pa.max(size_pa);
    let range = DrawnRange { mean_pa: [-reach_pa, reach_pa], reach_pa: 8.0 * reach_pa };
    let line = mohr_envelope(&criterion, angle_rad, 65, &range).ok().filter(|line| line.len() > 1)?;
    let is_point = line.iter().all(|[s, t]| (s - line[0][0]).hypot(*t) < 1e-3 * reach_pa);
    Some(if is_point { upright(line[0][0], size_pa) } else { line })
}

/// The line of circles that all touch in one point, as under tension: what is forbidden lies beyond it.
fn upright(sigma_pa: f64, size_pa: f64) -> Limit {
    vec![[sigma_pa, 0.0], [sigma_pa, 3.0 * size_pa.max(sigma_pa.abs())]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fracture::Formula;

    fn of_formula(text: &str, principal_pa: DVec3) -> Vec<Limit> {
        let strength = Strength::Formula(Formula::new(text, &[]).unwrap());
        envelope(&Criterion::single(strength).unwrap(), principal_pa)
    }

    #[test]
    fn formulas_have_the_envelopes_of_what_they_say() {
        for state in [DVec3::ZERO, DVec3::new(1e6, 2e5, -3e6), DVec3::new(-1e5, -1e5, -1e6)] {
            let tension = of_formula("s1 - 2*MPa", state);
            assert_eq!(tension.len(), 1);
            assert!(tension[0].iter().all(|[sigma, _]| (sigma / 2e6 - 1.0).abs() < 1e-3), "{tension:?}");
            assert!(tension[0][1][1] > 2e6, "a line, not a point: {tension:?}");
            let shear = of_formula("(s1 - s3)/2 - 2*MPa", state);
            assert!(shear[0].len() > 20 && shear[0].iter().all(|[_, tau]| (tau / 2e6 - 1.0).abs() < 1e-6));
        }
        // The mean stress alone sets circles no bound.
        assert!(of_formula("I1 - 2*MPa", DVec3::new(1e6, 0.0, -1e6)).is_empty());
    }
}
