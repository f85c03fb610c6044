//! Which parts of the window have to be painted again, so that a number that changes does not repaint all panels: a
//! software driver needs longer for them than for many a scene.

use egui::emath::Rot2;
use egui::epaint::{ClippedShape, TextShape};
use egui::{Color32, Rect, Shape, pos2};

/// Shapes that are looked through for one that is missing or new.
const LOOK_AHEAD: usize = 48;
/// Rectangles that are painted one by one at most.
const MOST_PARTS: usize = 12;
/// Two rectangles are painted as one if that adds at most so much to the smaller one: a share of it, and pixels.
const WASTE: (f32, f32) = (0.3, 1000.0);
/// From this share of the window on, all of it is painted.
const MOST_SHARE: f32 = 0.7;
/// How far edges are smoothed beyond a shape, pixels.
const SMOOTHING_PX: f32 = 2.0;

/// What a window shows besides the scene's picture. Rectangles are in pixels, at whole ones.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Shapes, back to front.
    pub shapes: Vec<ClippedShape>,
    /// Below all of them.
    pub background: Color32,
    /// Where the picture is, between both.
    pub picture: Option<Rect>,
    /// Size of the window.
    pub size_px: [u32; 2],
    /// Pixels for each point.
    pub pixels_per_point: f32,
}

impl Layout {
    /// All of the window.
    #[must_use]
    pub fn whole(&self) -> Rect {
        let [width, height] = self.size_px.map(|side| side as f32);
        Rect::from_min_max(pos2(0.0, 0.0), pos2(width, height))
    }

    /// The shapes that reach into a part of the window.
    #[must_use]
    pub fn shapes_in(&self, part: Rect) -> Vec<ClippedShape> {
        self.shapes.iter().filter(|shape| is_over(self.extent(shape), part)).cloned().collect()
    }

    /// The window's pixels that a shape may touch.
    fn extent(&self, shape: &ClippedShape) -> Rect {
        let scale = self.pixels_per_point;
        let clip = (shape.clip_rect * scale).expand(1.0);
        let Some(bounds) = bounds_of(&shape.shape) else { return Rect::NOTHING };
        let bounds = (shape.transform_after_tessellation * bounds * scale).expand(SMOOTHING_PX);
        // What has no sound extent may be anywhere.
        let touched = if bounds.is_finite() { bounds.intersect(clip) } else { clip };
        rounded_out(touched).intersect(self.whole())
    }

    /// Parts that look different from those of the layout before.
    ///
    /// `has_new_picture` says that the picture shows something else.
    #[must_use]
    pub fn changes_since(&self, before: &Self, has_new_picture: bool) -> Vec<Rect> {
        let frame = |of: &Self| (of.background, of.picture, of.size_px, of.pixels_per_point.to_bits());
        if frame(self) != frame(before) {
            return vec![self.whole()];
        }
        let mut parts = Parts::default();
        if let Some(picture) = self.picture.filter(|_| has_new_picture) {
            parts.add(picture.intersect(self.whole()));
        }
        let (old, new) = (&before.shapes, &self.shapes);
        let (mut i, mut j) = (0, 0);
        while i < old.len() || j < new.len() {
            let (gone, come) = step(&old[i..], &new[j..]);
            if gone + come == 0 {
                (i, j) = (i + 1, j + 1);
                continue;
            }
            old[i..i + gone].iter().for_each(|shape| parts.add(before.extent(shape)));
            new[j..j + come].iter().for_each(|shape| parts.add(self.extent(shape)));
            (i, j) = (i + gone, j + come);
        }
        if parts.area() > MOST_SHARE * self.whole().area() {
            return vec![self.whole()];
        }
        parts.0
    }
}

/// All that a shape may touch before it is clipped, points; `None` for nothing.
fn bounds_of(shape: &Shape) -> Option<Rect> {
    match shape {
        Shape::Vec(parts) => parts.iter().filter_map(bounds_of).reduce(Rect::union),
        Shape::Text(text) => bounds_of_text(text),
        shape => Some(shape.visual_bounding_rect()).filter(|bounds| *bounds != Rect::NOTHING),
    }
}

/// Letters, and the strips behind those that are selected, of which the text's own bounds know nothing.
fn bounds_of_text(text: &TextShape) -> Option<Rect> {
    let letters = (text.galley.mesh_bounds != Rect::NOTHING).then(|| text.visual_bounding_rect());
    let rows = text.galley.rows.iter().filter(|row| !row.visuals.mesh.is_empty());
    let painted = rows.map(|row| row.visuals.mesh.calc_bounds().translate(row.pos.to_vec2()));
    let turned =
        |painted: Rect| painted.rotate_bb(Rot2::from_angle(text.angle)).translate(text.pos.to_vec2());
    letters.into_iter().chain(painted.map(turned)).reduce(Rect::union)
}

/// How many shapes are gone at the front and how many have come; none where both begin with the same one.
fn step(old: &[ClippedShape], new: &[ClippedShape]) -> (usize, usize) {
    let (Some(first_old), Some(first_new)) = (old.first(), new.first()) else {
        return (old.len(), new.len());
    };
    for ahead in 0..LOOK_AHEAD.min(old.len().max(new.len())) {
        if new.get(ahead) == Some(first_old) {
            return (0, ahead);
        }
        if old.get(ahead) == Some(first_new) {
            return (ahead, 0);
        }
    }
    (1, 1)
}

/// A few rectangles that cover all that were added.
#[derive(Default)]
struct Parts(Vec<Rect>);

impl Parts {
    fn add(&mut self, mut part: Rect) {
        if !part.is_positive() {
            return;
        }
        let is_close = |a: Rect, b: Rect| waste(a, b) <= WASTE.0 * a.area().min(b.area()) + WASTE.1;
        let merges = |a: Rect, b: Rect| is_over(a, b) || is_close(a, b);
        while let Some(at) = self.0.iter().position(|other| merges(*other, part)) {
            part = part.union(self.0.swap_remove(at));
        }
        self.0.push(part);
        if self.0.len() > MOST_PARTS {
            self.merge_nearest();
        }
    }

    fn merge_nearest(&mut self) {
        let count = self.0.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let waste_of = |(a, b): &(usize, usize)| waste(self.0[*a], self.0[*b]);
        let Some((a, b)) = pairs.min_by(|x, y| waste_of(x).total_cmp(&waste_of(y))) else { return };
        // The later one first, so that the other keeps its place.
        let merged = self.0.swap_remove(b).union(self.0.swap_remove(a));
        self.add(merged);
    }

    fn area(&self) -> f32 {
        self.0.iter().map(Rect::area).sum()
    }
}

/// Pixels that are painted in vain if two rectangles are painted as one.
fn waste(a: Rect, b: Rect) -> f32 {
    a.union(b).area() - a.area() - b.area()
}

/// Whether two rectangles share any area.
fn is_over(a: Rect, b: Rect) -> bool {
    a.intersect(b).is_positive()
}

fn rounded_out(rect: Rect) -> Rect {
    Rect::from_min_max(rect.min.floor(), rect.max.ceil())
}

/// What is left of `part` outside `hole`.
#[must_use]
pub fn around(part: Rect, hole: Option<Rect>) -> Vec<Rect> {
    let Some(hole) = hole.map(|hole| hole.intersect(part)).filter(Rect::is_positive) else {
        return vec![part];
    };
    let sides = [
        Rect::from_min_max(part.min, pos2(part.right(), hole.top())),
        Rect::from_min_max(pos2(part.left(), hole.bottom()), part.max),
        Rect::from_min_max(pos2(part.left(), hole.top()), hole.left_bottom()),
        Rect::from_min_max(hole.right_top(), pos2(part.right(), hole.bottom())),
    ];
    sides.into_iter().filter(Rect::is_positive).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{CornerRadius, Shape, vec2};

    fn square(x: f32, y: f32, color: Color32) -> ClippedShape {
        let rect = Rect::from_min_size(pos2(x, y), vec2(10.0, 10.0));
        ClippedShape {
            clip_rect: Rect::EVERYTHING,
            shape: Shape::rect_filled(rect, CornerRadius::ZERO, color),
            transform_after_tessellation: Default::default(),
        }
    }

    fn layout(shapes: Vec<ClippedShape>) -> Layout {
        let picture = Some(Rect::from_min_max(pos2(200.0, 100.0), pos2(400.0, 300.0)));
        let background = Color32::GRAY;
        Layout { shapes, background, picture, size_px: [600, 400], pixels_per_point: 1.0 }
    }

    fn row(count: u8) -> Vec<ClippedShape> {
        (0..count).map(|i| square(40.0 * f32::from(i), 20.0, Color32::from_gray(i))).collect()
    }

    #[test]
    fn the_same_layout_changes_nothing_and_a_new_picture_its_place() {
        let same = layout(row(9));
        assert!(same.changes_since(&same.clone(), false).is_empty());
        assert_eq!(same.changes_since(&same.clone(), true), [same.picture.unwrap()]);
    }

    #[test]
    fn one_shape_that_changes_comes_or_goes_repaints_its_place() {
        let before = layout(row(9));
        let place = before.extent(&before.shapes[4]);
        let mut other = before.clone();
        other.shapes[4] = square(160.0, 20.0, Color32::RED);
        assert_eq!(other.changes_since(&before, false), [place]);
        let mut fewer = before.clone();
        fewer.shapes.remove(4);
        assert_eq!(fewer.changes_since(&before, false), [place]);
        assert_eq!(before.changes_since(&fewer, false), [place]);
        assert!(place.contains_rect(Rect::from_min_size(pos2(160.0, 20.0), vec2(10.0, 10.0))));
        assert_eq!(before.shapes_in(place).len(), 1);
    }

    #[test]
    fn a_new_picture_does_not_drag_along_what_is_between_it_and_a_number() {
        let before = layout(vec![square(20.0, 20.0, Color32::RED)]);
        let now = layout(vec![square(20.0, 20.0, Color32::BLUE)]);
        let parts = now.changes_since(&before, true);
        assert_eq!(parts, [now.picture.unwrap(), now.extent(&now.shapes[0])]);
    }

    #[test]
    fn another_size_or_background_repaints_all() {
        let before = layout(row(2));
        let larger = Layout { size_px: [601, 400], ..before.clone() };
        assert_eq!(larger.changes_since(&before, false), [larger.whole()]);
        let dark = Layout { background: Color32::BLACK, ..before.clone() };
        assert_eq!(dark.changes_since(&before, false), [dark.whole()]);
    }

    #[test]
    fn many_changes_are_covered_by_few_parts() {
        let before = layout(Vec::new());
        let shapes: Vec<_> = (0..15)
            .flat_map(|x| (0..10).map(move |y| (x, y)))
            .filter(|(x, y)| (x * 7 + y * 3) % 11 == 0)
            .map(|(x, y)| square(40.0 * x as f32, 40.0 * y as f32, Color32::RED))
            .collect();
        let now = layout(shapes);
        let parts = now.changes_since(&before, false);
        assert!(parts.len() <= MOST_PARTS, "{parts:?}");
        for shape in &now.shapes {
            let extent = now.extent(shape);
            assert!(parts.iter().any(|part| part.contains_rect(extent)), "{extent:?} in {parts:?}");
        }
    }

    #[test]
    fn what_is_around_a_hole_covers_the_rest_once() {
        let part = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        let area = |hole| around(part, hole).iter().map(Rect::area).sum::<f32>();
        let hole = |low: f32, high: f32| Some(Rect::from_min_max(pos2(low, low), pos2(high, high)));
        assert_eq!(area(None), 100.0);
        assert_eq!(area(hole(2.0, 5.0)), 91.0);
        assert_eq!(area(hole(-5.0, 5.0)), 75.0);
        assert_eq!(area(hole(-5.0, 50.0)), 0.0);
        assert_eq!(area(hole(20.0, 30.0)), 100.0);
    }

    #[test]
    fn a_selected_text_reaches_as_far_as_its_strips() {
        let context = egui::Context::default();
        let mut text = None;
        let mut full = context.run_ui(egui::RawInput::default(), |ui| {
            let font = egui::FontId::proportional(20.0);
            text = Some(ui.painter().layout_no_wrap("----".to_owned(), font, Color32::RED));
        });
        full.textures_delta.clear();
        let plain = text.unwrap();
        let mut selected = plain.clone();
        let range = egui::text_selection::CCursorRange::two(plain.begin(), plain.end());
        let visuals = egui::Visuals::default();
        egui::text_selection::visuals::paint_text_selection(&mut selected, &visuals, &range, None);
        let strip = selected.rows[0].rect().translate(vec2(40.0, 50.0));
        let shape = |galley| ClippedShape {
            shape: TextShape::new(pos2(40.0, 50.0), galley, Color32::RED).into(),
            ..square(0.0, 0.0, Color32::RED)
        };
        let all = layout(vec![shape(plain), shape(selected)]);
        assert!(!all.extent(&all.shapes[0]).contains_rect(strip), "letters alone are smaller");
        assert!(all.extent(&all.shapes[1]).contains_rect(strip));
    }

    #[test]
    fn what_draws_nothing_repaints_nothing() {
        let before = layout(row(2));
        let mut now = before.clone();
        now.shapes.push(ClippedShape { shape: Shape::Noop, ..square(0.0, 0.0, Color32::RED) });
        assert_eq!(now.changes_since(&before, false), []);
    }
}
