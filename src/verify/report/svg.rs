//! A plot as SVG, to stand inside a page.

use super::number;
use crate::verify::{Curve, Plot, Scale};
use std::fmt::Write as _;

const WIDTH: f64 = 680.0;
const HEIGHT: f64 = 380.0;
/// Free room around the axes: left, top, right, bottom.
const MARGINS: [f64; 4] = [86.0, 16.0, 16.0, 52.0];
/// More points than pixels show nothing more and make pages heavy.
const MOST_POINTS: usize = 1500;
/// Distinct to most eyes (M. Okabe, K. Ito, *Color Universal Design*, 2008).
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// One axis: what it shows, and where on the picture.
struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(scale: Scale, values: impl Iterator<Item = f64>, [from, to]: [f64; 2]) -> Option<Self> {
        let usable = values.filter(|v| v.is_finite() && (scale == Scale::Linear || *v > 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return None;
        }
        let (low, high) = match scale {
            Scale::Log => (
                10.0_f64.powf(low.log10().floor()),
                10.0_f64.powf(high.log10().ceil().max(low.log10().floor() + 1.0)),
            ),
            Scale::Linear if low == high => (low - 1.0, high + 1.0),
            Scale::Linear => (low - 0.03 * (high - low), high + 0.05 * (high - low)),
        };
        Some(Self { scale, low, high, from, to })
    }

    fn place(&self, value: f64) -> Option<f64> {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        share.is_finite().then_some(self.from + share * (self.to - self.from))
    }

    fn ticks(&self) -> Vec<f64> {
        match self.scale {
            Scale::Log => {
                let [first, last] = [self.low, self.high].map(|v| v.log10().round() as i32);
                let every = ((last - first) / 6).max(1) as usize;
                (first..=last).step_by(every).map(|power| 10.0_f64.powi(power)).collect()
            }
            Scale::Linear => {
                let step = round_step((self.high - self.low) / 6.0);
                let [first, last] = [(self.low / step).ceil(), (self.high / step).floor()].map(|v| v as i64);
                (first..=last).map(|n| n as f64 * step).collect()
            }
        }
    }
}

/// The next of 1, 2, 5, 10, ... above a step.
fn round_step(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    let factors = [1.0, 2.0, 5.0];
    factors.into_iter().map(|factor| factor * power).find(|rounded| *rounded >= step).unwrap_or(10.0 * power)
}

/// The plot as an `<svg>` element; empty where there is nothing to draw.
pub(super) fn svg(plot: &Plot) -> String {
    let [left, top, right, bottom] = MARGINS;
    let points = || plot.curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::new(plot.scales[0], points().map(|p| p[0]), [left, WIDTH - right]);
    let y = Axis::new(plot.scales[1], points().map(|p| p[1]), [HEIGHT - bottom, top]);
    let (Some(x), Some(y)) = (x, y) else { return String::new() };
    let mut text = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n",
        escaped(plot.title)
    );
    for tick in x.ticks() {
        let Some(at) = x.place(tick) else { continue };
        let (low, label) = (HEIGHT - bottom, number(tick));
        let _ = writeln!(
            text,
            "<path class=\"grid\" d=\"M{at:.1} {top}V{low}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            low + 17.0
        );
    }
    for tick in y.ticks() {
        let Some(at) = y.place(tick) else { continue };
        let (end, label) = (WIDTH - right, number(tick));
        let _ = writeln!(
            text,
            "<path class=\"grid\" d=\"M{left} {at:.1}H{end}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            left - 6.0,
            at + 4.0
        );
    }
    let [x_label, y_label] = plot.labels.map(escaped);
    let _ = writeln!(
        text,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_label}</text>",
        0.5 * (left + WIDTH - right),
        HEIGHT - 12.0
    );
    let middle = 0.5 * (top + HEIGHT - bottom);
    let _ = writeln!(
        text,
        "<text transform=\"translate(16 {middle:.1}) rotate(-90)\" text-anchor=\"middle\">{y_label}</text>"
    );
    for (curve, color) in plot.curves.iter().zip(COLORS.iter().cycle()) {
        draw(&mut text, curve, color, &x, &y);
    }
    text.push_str("</svg>\n");
    let legend = plot.curves.iter().zip(COLORS.iter().cycle());
    let legend = legend.map(|(curve, color)| {
        format!("<span><i style=\"background:{color}\"></i>{}</span>", escaped(&curve.name))
    });
    let _ = writeln!(text, "<p class=\"legend\">{}</p>", legend.collect::<Vec<_>>().join(" "));
    text
}

fn draw(text: &mut String, curve: &Curve, color: &str, x: &Axis, y: &Axis) {
    /// Curves of fewer points get a mark at each.
    const MARKED: usize = 12;
    let every = curve.points.len().div_ceil(MOST_POINTS).max(1);
    let places: Vec<[f64; 2]> =
        curve.points.iter().step_by(every).filter_map(|p| Some([x.place(p[0])?, y.place(p[1])?])).collect();
    let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
    if path.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"/>",
        path.join("L")
    );
    if places.len() <= MARKED {
        for [x, y] in places {
            let _ = writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>");
        }
    }
}

/// Text that means itself inside HTML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_drawn_leaves_no_trace_of_nan() {
        let labels = ["x", "y"];
        let logs = [Scale::Log, Scale::Log];
        let points = vec![[1.0, 0.0], [2.0, f64::NAN], [10.0, 1e-3], [100.0, 1e-5]];
        let plot = Plot::new("a", "a < b", labels).scaled(logs).with("c", points);
        let drawn = svg(&plot);
        assert!(!drawn.contains("NaN") && !drawn.contains("inf") && drawn.contains("a &lt; b"), "{drawn}");
        assert_eq!(svg(&Plot::new("a", "", labels).scaled(logs).with("c", vec![[0.0, 0.0]])), "");
    }

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let axis = Axis::new(Scale::Linear, [0.0, 9.7].into_iter(), [0.0, 1.0]).unwrap();
        assert_eq!(axis.ticks(), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        let axis = Axis::new(Scale::Log, [0.02, 30.0].into_iter(), [0.0, 1.0]).unwrap();
        assert_eq!(axis.ticks().len(), 5);
    }
}
