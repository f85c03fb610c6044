//! The picture: a panel for each section, one legend.

use super::choice::Entry;
use super::panel::{Frame, INK};
use super::sections::Sections;
use crate::render::{Picture, paint};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

/// Lengths in points.
const PIXELS_PER_POINT: f32 = 1.5;
const PANEL: f32 = 380.0;
const PANELS_IN_A_ROW: usize = 3;
const GAP: f32 = 18.0;
const LEGEND_ROW: f32 = 22.0;
const LEGEND_SIZE: f32 = 14.0;
/// Room that a row of the legend needs: for the sample of the line, and for a letter.
const SAMPLE: f32 = 44.0;
const LETTER: f32 = 7.4;
const GROUND: Color32 = Color32::from_rgb(244, 245, 247);

/// Colours that also colour-blind people tell apart (M. Okabe, K. Ito, 2002).
const COLORS: [Color32; 7] = [
    Color32::from_rgb(0, 114, 178),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(60, 60, 60),
];

/// How a criterion's curve is drawn.
#[derive(Clone, Copy)]
pub struct Pen {
    stroke: Stroke,
    is_dashed: bool,
}

impl Pen {
    /// Later ones are thinner, so that a curve on top of another lets it be seen; with no colour left, dashed.
    fn of(index: usize) -> Self {
        let width = 3.2 - 1.6 * (index.min(4) as f32 / 4.0);
        Self {
            stroke: Stroke::new(width, COLORS[index % COLORS.len()]),
            is_dashed: index / COLORS.len() % 2 == 1,
        }
    }

    /// Draws a curve.
    pub fn draw(self, painter: &Painter, points: Vec<Pos2>) {
        if self.is_dashed {
            painter.extend(Shape::dashed_line(&points, self.stroke, 7.0, 4.0));
        } else {
            painter.add(Shape::line(points, self.stroke));
        }
    }
}

/// Draws everything.
pub fn draw(entries: &[Entry], sections: &Sections) -> Picture {
    let columns = sections.list.len().min(PANELS_IN_A_ROW);
    let rows = sections.list.len().div_ceil(columns);
    let width = GAP + columns as f32 * (PANEL + GAP);
    let legend = Legend::of(entries, width - 2.0 * GAP);
    let panels_bottom = GAP + rows as f32 * (PANEL + GAP);
    let size = [width, panels_bottom + legend.height() + GAP];
    paint(size, PIXELS_PER_POINT, GROUND, |painter| {
        for (index, section) in sections.list.iter().enumerate() {
            let [column, row] = [index % columns, index / columns].map(|i| GAP + i as f32 * (PANEL + GAP));
            let area = Rect::from_min_size(pos2(column, row), vec2(PANEL, PANEL));
            let frame = Frame::new(painter, area, section);
            frame.draw_axes();
            for (curve, pen) in section.curves.iter().zip((0..).map(Pen::of)) {
                frame.draw_curve(curve, pen);
            }
            let missing = section.curves.iter().filter(|curve| curve.is_empty()).count();
            frame.draw_title(missing);
        }
        legend.draw(painter, entries, pos2(GAP, panels_bottom));
    })
}

/// Names in as many columns as they fit in.
struct Legend {
    column_width: f32,
    rows: usize,
    most_letters: usize,
}

impl Legend {
    fn of(entries: &[Entry], width: f32) -> Self {
        let longest = entries.iter().map(|entry| entry.name.chars().count()).max().unwrap_or(0);
        let needed = SAMPLE + longest as f32 * LETTER + 16.0;
        let columns = ((width / needed) as usize).clamp(1, entries.len().clamp(1, 3));
        let column_width = width / columns as f32;
        let most_letters = ((column_width - SAMPLE) / LETTER) as usize;
        Self { column_width, rows: entries.len().div_ceil(columns), most_letters }
    }

    fn height(&self) -> f32 {
        self.rows as f32 * LEGEND_ROW
    }

    fn draw(&self, painter: &Painter, entries: &[Entry], corner: Pos2) {
        for (index, entry) in entries.iter().enumerate() {
            let [column, row] = [index / self.rows, index % self.rows];
            let left = corner + vec2(column as f32 * self.column_width, (row as f32 + 0.5) * LEGEND_ROW);
            let sample = vec![left + vec2(4.0, 0.0), left + vec2(SAMPLE - 10.0, 0.0)];
            Pen::of(index).draw(painter, sample);
            let font = FontId::proportional(LEGEND_SIZE);
            let name = shortened(&entry.name, self.most_letters);
            painter.text(left + vec2(SAMPLE, 0.0), Align2::LEFT_CENTER, name, font, INK);
        }
    }
}

/// A name that a line has room for.
fn shortened(name: &str, most_letters: usize) -> String {
    if name.chars().count() <= most_letters {
        return name.to_owned();
    }
    let kept: String = name.chars().take(most_letters.saturating_sub(1)).collect();
    format!("{kept}…")
}
