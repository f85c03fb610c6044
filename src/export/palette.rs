//! A few good colours for a picture, and which of them to use where.

use std::collections::HashMap;

/// Weight of a colour that fills `n` pixels is `n` to this power: below 1, so that a large
/// background does not take all colours from a small body.
const COUNT_POWER: f32 = 0.55;
/// Rounds of moving colours to the middle of what they stand for.
const ROUNDS: usize = 2;
/// How much the eye minds errors in red, green and blue.
const CHANNEL_WEIGHT: [f32; 3] = [0.55, 0.80, 0.45];
/// Colours nearer than this to their match (weighted channel steps) are not mixed from two: the
/// eye does not see the difference, and even areas stay small in the file.
const DITHER_ABOVE: f32 = 1.3;
/// Matches remembered at most: some tens of megabytes, also in the longest animation.
const MOST_REMEMBERED: usize = 1 << 20;
/// Colours farther apart than this are not mixed: one would see the pattern.
const WIDEST_MIX: f32 = 28.0;
/// Thresholds in an order that spreads each level evenly over 4x4 pixels, in sixteenths.
const BAYER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

type Rgb = [u8; 3];

/// Colours that stay the same for a whole animation.
const BASE_COLORS: usize = 144;
/// Colours that come and go.
const EXTRA_COLORS: usize = 255 - BASE_COLORS;
/// A colour at most this far from one of the base (weighted channel steps) is always shown by
/// the base: a still background then looks the same before and after something passed in front
/// of it, whatever the extra colours are by then.
const BASE_SERVES_WITHIN: f32 = 3.0;

/// At most 255 colours and a memory of what matches them.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    /// Base colours, then extra ones.
    colors: Vec<Rgb>,
    base_count: usize,
    /// Matches by the base, which hold for ever; `None` where it does not serve.
    base_matches: HashMap<Rgb, Option<Match>>,
    /// Matches by all colours, which hold until the extra ones change.
    other_matches: HashMap<Rgb, Match>,
}

/// How to show one colour: mostly `main`, and `other` on `share` of the pixels.
#[derive(Clone, Copy, Debug)]
struct Match {
    main: u8,
    other: u8,
    /// In sixteenths.
    share: u8,
    /// Distance of `main`, weighted channel steps.
    error: f32,
}

impl Palette {
    /// Learns base and extra colours from pixels.
    pub fn learn(pixels: impl Iterator<Item = Rgb>) -> Self {
        let points = weighted(pixels);
        let base = learn_colors(&points, BASE_COLORS);
        let mut palette = Self {
            base_count: base.len(),
            colors: base,
            base_matches: HashMap::new(),
            other_matches: HashMap::new(),
        };
        palette.learn_extra(&points);
        palette
    }

    /// Replaces the extra colours by some that suit these pixels.
    pub fn relearn(&mut self, pixels: impl Iterator<Item = Rgb>) {
        self.learn_extra(&weighted(pixels));
    }

    fn learn_extra(&mut self, points: &[Point]) {
        self.colors.truncate(self.base_count);
        let is_missed = |p: &&Point| nearest(&self.colors, p.color).1 > BASE_SERVES_WITHIN;
        let missed: Vec<Point> = points.iter().filter(is_missed).copied().collect();
        self.colors.extend(learn_colors(&missed, EXTRA_COLORS));
        self.other_matches.clear();
    }

    /// Red, green, blue of each colour, one after the other.
    pub fn bytes(&self) -> Vec<u8> {
        self.colors.concat()
    }

    /// The colour to use for `color` at a pixel, an index into the palette.
    pub fn index(&mut self, color: Rgb, [x, y]: [usize; 2]) -> u8 {
        let found = self.matched(color);
        let threshold = BAYER[y % 4][x % 4];
        if threshold < found.share { found.other } else { found.main }
    }

    /// The colour of the palette nearest to `color`, an index into it.
    pub fn nearest(&mut self, color: Rgb) -> u8 {
        self.matched(color).main
    }

    /// Distance of a colour from the nearest in the palette, weighted channel steps.
    pub fn error(&mut self, color: Rgb) -> f32 {
        self.matched(color).error
    }

    fn matched(&mut self, color: Rgb) -> Match {
        if self.base_matches.len() > MOST_REMEMBERED {
            self.base_matches.clear();
        }
        let base = &self.colors[..self.base_count];
        let by_base = self.base_matches.entry(color).or_insert_with(|| {
            let found = find_match(base, color);
            (found.error <= BASE_SERVES_WITHIN).then_some(found)
        });
        by_base.unwrap_or_else(|| {
            let other = self.other_matches.entry(color);
            *other.or_insert_with(|| find_match(&self.colors, color))
        })
    }
}

/// At most `count` colours that stand for the points.
fn learn_colors(points: &[Point], count: usize) -> Vec<Rgb> {
    let mut colors = split(points.to_vec(), count);
    for _ in 0..ROUNDS {
        settle(points, &mut colors);
    }
    let mut colors: Vec<Rgb> = colors.into_iter().map(|c| c.map(|v| v.round() as u8)).collect();
    colors.sort_unstable();
    colors.dedup();
    colors
}

fn find_match(colors: &[Rgb], color: Rgb) -> Match {
    let wanted = color.map(f32::from);
    let (main, error) = nearest(colors, wanted);
    let only_main = Match { main: main as u8, other: main as u8, share: 0, error };
    // An empty palette matches nothing.
    let Some(shown) = colors.get(main).map(|c| c.map(f32::from)) else {
        return only_main;
    };
    if error < DITHER_ABOVE {
        return only_main;
    }
    // The partner lies on the other side, perhaps a good way off; mixed with it, the mean comes
    // near the wanted colour.
    let beyond = |steps: f32| std::array::from_fn(|i| wanted[i] + steps * (wanted[i] - shown[i]));
    let partners = [1.0, 2.0, 4.0].map(|steps| nearest(colors, beyond(steps)).0);
    let Some(other) = partners.into_iter().find(|other| *other != main) else {
        return only_main;
    };
    let partner = colors[other].map(f32::from);
    if distance_squared(partner, shown) > WIDEST_MIX * WIDEST_MIX {
        return only_main;
    }
    let along: f32 = (0..3).map(|i| (wanted[i] - shown[i]) * (partner[i] - shown[i])).sum();
    let length: f32 = (0..3).map(|i| (partner[i] - shown[i]).powi(2)).sum();
    let share = if length > 0.0 { along / length } else { 0.0 };
    Match { other: other as u8, share: (share.clamp(0.0, 0.5) * 16.0).round() as u8, ..only_main }
}

fn nearest(colors: &[Rgb], wanted: [f32; 3]) -> (usize, f32) {
    let mut best = (0, f32::INFINITY);
    for (index, color) in colors.iter().enumerate() {
        let distance = distance_squared(color.map(f32::from), wanted);
        if distance < best.1 {
            best = (index, distance);
        }
    }
    (best.0, best.1.sqrt())
}

fn distance_squared(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (CHANNEL_WEIGHT[i] * (a[i] - b[i])).powi(2)).sum()
}

/// A colour and how much it counts.
#[derive(Clone, Copy, Debug)]
struct Point {
    color: [f32; 3],
    weight: f32,
}

/// Each colour once. The lowest bit is dropped: a quarter of the points, and no visible loss,
/// since the mean of what falls together is kept.
fn weighted(pixels: impl Iterator<Item = Rgb>) -> Vec<Point> {
    let mut all: Vec<Rgb> = pixels.collect();
    all.sort_unstable_by_key(|c| coarse(*c));
    all.chunk_by(|a, b| coarse(*a) == coarse(*b))
        .map(|same| Point {
            color: std::array::from_fn(|i| {
                same.iter().map(|c| f32::from(c[i])).sum::<f32>() / same.len() as f32
            }),
            weight: (same.len() as f32).powf(COUNT_POWER),
        })
        .collect()
}

fn coarse(color: Rgb) -> Rgb {
    color.map(|channel| channel >> 1)
}

/// Splits the points again and again where the spread is largest; the means are the colours.
fn split(points: Vec<Point>, count: usize) -> Vec<[f32; 3]> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut groups = vec![Group::new(points)];
    while groups.len() < count {
        let worst = (0..groups.len()).max_by(|a, b| groups[*a].spread.total_cmp(&groups[*b].spread));
        let Some(worst) = worst.filter(|index| groups[*index].spread > 0.0) else {
            break;
        };
        let (low, high) = groups.swap_remove(worst).halves();
        groups.extend([low, high]);
    }
    groups.iter().map(|group| group.mean).collect()
}

/// Points that share a colour so far.
struct Group {
    points: Vec<Point>,
    mean: [f32; 3],
    /// Axis of the largest spread.
    axis: usize,
    /// Weighted sum of squares along it.
    spread: f32,
}

impl Group {
    fn new(points: Vec<Point>) -> Self {
        let weight: f32 = points.iter().map(|p| p.weight).sum();
        let mean = std::array::from_fn(|i| {
            points.iter().map(|p| p.weight * p.color[i]).sum::<f32>() / weight.max(f32::MIN_POSITIVE)
        });
        let spread = |i: usize| -> f32 {
            let squares = points.iter().map(|p| p.weight * (p.color[i] - mean[i]).powi(2));
            squares.sum::<f32>() * CHANNEL_WEIGHT[i].powi(2)
        };
        let spreads = [spread(0), spread(1), spread(2)];
        let axis = (0..3).fold(0, |best, i| if spreads[i] > spreads[best] { i } else { best });
        Self { points, mean, axis, spread: spreads[axis] }
    }

    fn halves(self) -> (Self, Self) {
        let (axis, middle) = (self.axis, self.mean[self.axis]);
        let (low, high): (Vec<_>, Vec<_>) = self.points.into_iter().partition(|p| p.color[axis] < middle);
        (Self::new(low), Self::new(high))
    }
}

/// Moves every colour to the mean of the points it is nearest to.
fn settle(points: &[Point], colors: &mut [[f32; 3]]) {
    let mut sums = vec![([0.0f32; 3], 0.0f32); colors.len()];
    for point in points {
        let mut best = (0, f32::INFINITY);
        for (index, color) in colors.iter().enumerate() {
            let distance = distance_squared(*color, point.color);
            if distance < best.1 {
                best = (index, distance);
            }
        }
        if let Some((sum, weight)) = sums.get_mut(best.0) {
            (0..3).for_each(|i| sum[i] += point.weight * point.color[i]);
            *weight += point.weight;
        }
    }
    for (color, (sum, weight)) in colors.iter_mut().zip(sums) {
        if weight > 0.0 {
            *color = sum.map(|channel| channel / weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colors_are_kept_exactly() {
        let colors = [[0, 0, 0], [255, 255, 255], [200, 30, 40]];
        let mut palette = Palette::learn(colors.into_iter().cycle().take(300));
        assert_eq!(palette.base_count, 3);
        for color in colors {
            assert_eq!(palette.error(color), 0.0);
        }
    }

    #[test]
    fn small_body_before_a_large_gradient_keeps_its_color() {
        let gradient = (0..100_000).map(|i| [(150 + i % 100) as u8; 3]);
        let body = std::iter::repeat_n([220, 40, 30], 20);
        let mut palette = Palette::learn(gradient.chain(body));
        assert!(palette.error([220, 40, 30]) < 2.0);
    }

    #[test]
    fn mixing_brings_the_mean_near_the_wanted_color() {
        let ends = [[100, 100, 100], [116, 116, 116]];
        let mut palette = Palette::learn(ends.into_iter());
        for wanted in [104u8, 108, 112] {
            let cells = (0..16).map(|i| palette.index([wanted; 3], [i % 4, i / 4]));
            let mean = cells.map(|i| f32::from(ends[i as usize][0])).sum::<f32>() / 16.0;
            assert!((mean - f32::from(wanted)).abs() <= 1.0, "{wanted}: {mean}");
        }
    }

    #[test]
    fn still_background_looks_the_same_after_colors_are_relearned() {
        let background: Vec<Rgb> = (0..3000).map(|i| [(100 + i % 120) as u8; 3]).collect();
        let mut palette = Palette::learn(background.iter().copied());
        let before = palette.bytes();
        let shown: Vec<u8> = background.iter().map(|c| palette.index(*c, [1, 2])).collect();
        palette.relearn((0..=255).map(|i| [i, 40, 255 - i]));
        assert_ne!(palette.bytes(), before);
        let again: Vec<u8> = background.iter().map(|c| palette.index(*c, [1, 2])).collect();
        assert_eq!(shown, again);
        assert!(palette.error([128, 40, 127]) < 2.0);
    }

    #[test]
    fn nothing_to_learn_from_gives_no_colors_and_no_panic() {
        let mut palette = Palette::learn(std::iter::empty());
        assert_eq!(palette.index([1, 2, 3], [0, 0]), 0);
    }
}
