//! One section with its axes.

use super::chart::Pen;
use super::sections::{Curve, Section, Shape};
use crate::render::{Range, short, si_prefix, with_unit};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};
use glam::{DVec2, DVec3};

/// Lengths in points.
const TITLE_SIZE: f32 = 15.0;
const TEXT_SIZE: f32 = 12.5;
/// Room for numbers and titles around the curves: left, top, right, bottom.
const BORDER: [f32; 4] = [52.0, 40.0, 14.0, 38.0];

pub const INK: Color32 = Color32::from_rgb(38, 44, 52);
pub const FAINT: Color32 = Color32::from_rgb(92, 100, 110);
const AXIS: Color32 = Color32::from_rgb(150, 156, 164);
const GRID: Color32 = Color32::from_rgb(230, 232, 236);

/// A panel of the chart: where it lies, and what stress is where in it.
pub struct Frame<'a> {
    painter: &'a Painter,
    section: &'a Section,
    /// With titles and numbers.
    area: Rect,
    /// Of the curves.
    inner: Rect,
    /// Stress of a unit of the axes, Pa, and its name.
    unit_pa: f64,
    unit: String,
}

impl<'a> Frame<'a> {
    pub fn new(painter: &'a Painter, area: Rect, section: &'a Section) -> Self {
        let [left, top, right, bottom] = BORDER;
        let inner = Rect::from_min_max(area.min + vec2(left, top), area.max - vec2(right, bottom));
        let [low_pa, high_pa] = section.shown_pa;
        let (unit_pa, prefix) = si_prefix(low_pa.abs().max(high_pa.abs()) / 2.0);
        // Both sides alike: a right angle of the stresses is one of the picture.
        let side = inner.width().min(inner.height());
        let middle = match section.shape {
            Shape::PlaneStress => inner.center(),
            Shape::Deviatoric { .. } => pos2(area.center().x, inner.center().y),
        };
        let inner = Rect::from_center_size(middle, vec2(side, side));
        Self { painter, section, area, inner, unit_pa, unit: format!("{prefix}Pa") }
    }

    /// The ground, the grid and the numbers.
    pub fn draw_axes(&self) {
        self.painter.rect_filled(self.area, 6.0, Color32::WHITE);
        let ticks_pa = self.ticks_pa();
        match self.section.shape {
            Shape::PlaneStress => self.draw_plane_axes(&ticks_pa),
            Shape::Deviatoric { .. } => self.draw_deviatoric_axes(&ticks_pa),
        }
        self.painter.rect_stroke(self.inner, 0.0, Stroke::new(1.0, AXIS), StrokeKind::Middle);
    }

    fn draw_plane_axes(&self, ticks_pa: &[f64]) {
        for &tick_pa in ticks_pa {
            let at = self.place(DVec2::splat(tick_pa));
            let color = if tick_pa == 0.0 { AXIS } else { GRID };
            self.painter.vline(at.x, self.inner.y_range(), Stroke::new(1.0, color));
            self.painter.hline(self.inner.x_range(), at.y, Stroke::new(1.0, color));
            let number = short(tick_pa / self.unit_pa);
            self.text(pos2(at.x, self.inner.bottom() + 4.0), Align2::CENTER_TOP, &number, FAINT);
            self.text(pos2(self.inner.left() - 6.0, at.y), Align2::RIGHT_CENTER, &number, FAINT);
        }
        let unit = &self.unit;
        self.text(
            self.inner.right_bottom() + vec2(0.0, 18.0),
            Align2::RIGHT_TOP,
            &format!("s1  [{unit}]"),
            INK,
        );
        self.text(
            self.inner.left_top() + vec2(0.0, -4.0),
            Align2::RIGHT_BOTTOM,
            &format!("s2  [{unit}]"),
            INK,
        );
    }

    /// Rings of equal `sqrt(2 J2)` and the projections of the three axes.
    fn draw_deviatoric_axes(&self, ticks_pa: &[f64]) {
        let painter = self.painter.with_clip_rect(self.inner);
        let middle = self.place(DVec2::ZERO);
        for &tick_pa in ticks_pa.iter().filter(|tick_pa| **tick_pa > 0.0) {
            let radius = self.place(DVec2::new(tick_pa, 0.0)).x - middle.x;
            painter.circle_stroke(middle, radius, Stroke::new(1.0, GRID));
            let number = short(tick_pa / self.unit_pa);
            self.text(middle + vec2(radius, -1.0), Align2::CENTER_BOTTOM, &number, FAINT);
        }
        for (axis, name) in [(DVec3::X, "s1"), (DVec3::Y, "s2"), (DVec3::Z, "s3")] {
            let along = self.section.shape.flat_pa(axis).normalize() * self.section.shown_pa[1];
            let tip = self.place(along * 0.93);
            painter.line_segment([self.place(along * -0.93), middle], Stroke::new(1.0, GRID));
            painter.line_segment([middle, tip], Stroke::new(1.0, AXIS));
            let beside = vec2(if along.x < 0.0 { -10.0 } else { 10.0 }, 0.0);
            self.text(tip + beside, Align2::CENTER_CENTER, name, INK);
        }
        let label = format!("distance from the axis, √(2 J2)  [{}]", self.unit);
        self.text(self.inner.right_bottom() + vec2(0.0, 18.0), Align2::RIGHT_TOP, &label, INK);
    }

    /// Draws a curve where it is shown.
    pub fn draw_curve(&self, curve: &Curve, pen: Pen) {
        let painter = self.painter.with_clip_rect(self.inner);
        for piece in curve.pieces() {
            let flat = piece.iter().map(|point_pa| self.section.shape.flat_pa(*point_pa));
            pen.draw(&painter, flat.map(|at_pa| self.place(at_pa)).collect());
        }
    }

    /// What the plane is, and how many criteria have no curve in it.
    pub fn draw_title(&self, missing: usize) {
        let title = match self.section.shape {
            Shape::PlaneStress => "Plane stress, s3 = 0".to_owned(),
            Shape::Deviatoric { mean_pa } => {
                format!("Deviatoric plane, mean stress {}", with_unit(mean_pa, "Pa"))
            }
        };
        let at = self.area.center_top() + vec2(0.0, 9.0);
        self.painter.text(at, Align2::CENTER_TOP, title, FontId::proportional(TITLE_SIZE), INK);
        if missing > 0 {
            let note = format!("{missing} of {} without a curve here", self.section.curves.len());
            self.text(self.inner.left_bottom() + vec2(8.0, -6.0), Align2::LEFT_BOTTOM, &note, FAINT);
        }
    }

    /// Round numbers of the axes or rings.
    fn ticks_pa(&self) -> Vec<f64> {
        let [mut low, high] = self.section.shown_pa.map(|end_pa| (end_pa / self.unit_pa) as f32);
        if matches!(self.section.shape, Shape::Deviatoric { .. }) {
            low = 0.0;
        }
        Range { low, high }.ticks().into_iter().map(|tick| f64::from(tick) * self.unit_pa).collect()
    }

    fn place(&self, at_pa: DVec2) -> Pos2 {
        let [low_pa, high_pa] = self.section.shown_pa;
        let share = (at_pa - DVec2::splat(low_pa)) / (high_pa - low_pa);
        let width = f64::from(self.inner.width());
        self.inner.left_bottom() + vec2((share.x * width) as f32, (-share.y * width) as f32)
    }

    fn text(&self, at: Pos2, align: Align2, text: &str, color: Color32) {
        self.painter.text(at, align, text, FontId::proportional(TEXT_SIZE), color);
    }
}
