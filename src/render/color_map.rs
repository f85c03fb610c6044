//! Colour maps: evenly spaced in lightness, safe for colour-blind eyes and in grey print.
//!
//! Both are made here from a few anchors in the Oklab space, where equal steps look equal.

/// Entries of a tabulated map.
pub const TABLE_LENGTH: usize = 256;

/// Which map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorMap {
    /// For sizes, from zero up: deep blue over teal and green to pale yellow.
    Sequential,
    /// For signed values, zero in the middle: blue, pale grey, red.
    Diverging,
}

/// Lightness, chroma and hue (degrees) at evenly spaced positions. Lightness rises in equal
/// steps, from where light and shade can still be told apart: most of a body is often at zero. Hue runs from
/// blue to yellow without passing red, so that no two ends look alike.
const SEQUENTIAL_LCH: [[f32; 3]; 6] = [
    [0.43, 0.130, 285.0],
    [0.53, 0.120, 262.0],
    [0.63, 0.105, 222.0],
    [0.73, 0.120, 178.0],
    [0.83, 0.155, 132.0],
    [0.93, 0.165, 104.0],
];

/// Lightness mirrored about the middle; chroma falls to nothing there.
const DIVERGING_LCH: [[f32; 3]; 7] = [
    [0.34, 0.130, 264.0],
    [0.56, 0.140, 254.0],
    [0.76, 0.085, 246.0],
    [0.93, 0.000, 100.0],
    [0.76, 0.110, 45.0],
    [0.56, 0.170, 30.0],
    [0.34, 0.130, 22.0],
];

impl ColorMap {
    /// The colour at a position from 0 to 1, sRGB 0..1.
    #[must_use]
    pub fn srgb(self, position: f32) -> [f32; 3] {
        match self {
            Self::Sequential => interpolate(&SEQUENTIAL_LCH, position),
            Self::Diverging => interpolate(&DIVERGING_LCH, position),
        }
    }

    /// The map as 8-bit sRGB with full opacity.
    #[must_use]
    pub fn table(self) -> [[u8; 4]; TABLE_LENGTH] {
        std::array::from_fn(|i| {
            let [r, g, b] = self.srgb(i as f32 / (TABLE_LENGTH - 1) as f32).map(to_byte);
            [r, g, b, 255]
        })
    }
}

/// A colour for the body with this index, sRGB 0..1: equal lightness, and hues that stay apart
/// however many bodies there are.
#[must_use]
pub fn body_srgb(index: usize) -> [f32; 3] {
    // The golden angle never comes back near where it was.
    let hue_deg = (250.0 + 137.508 * index as f32) % 360.0;
    linear_from_oklab(oklab([0.70, 0.105, hue_deg])).map(srgb_from_linear)
}

/// Straight lines in Oklab between the anchors.
fn interpolate(anchors: &[[f32; 3]], position: f32) -> [f32; 3] {
    let scaled = position.clamp(0.0, 1.0) * (anchors.len() - 1) as f32;
    let index = (scaled as usize).min(anchors.len() - 2);
    let share = scaled - index as f32;
    let (a, b) = (oklab(anchors[index]), oklab(anchors[index + 1]));
    let lab = std::array::from_fn(|i| a[i] + share * (b[i] - a[i]));
    linear_from_oklab(lab).map(srgb_from_linear)
}

fn oklab([lightness, chroma, hue_deg]: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = hue_deg.to_radians().sin_cos();
    [lightness, chroma * cos, chroma * sin]
}

/// The inverse of the Oklab transform, with the constants of its definition.
fn linear_from_oklab([l, a, b]: [f32; 3]) -> [f32; 3] {
    let long = (l + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let medium = (l - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let short = (l - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * long - 3.307_711_6 * medium + 0.230_969_94 * short,
        -1.268_438 * long + 2.609_757_4 * medium - 0.341_319_38 * short,
        -0.004_196_086_3 * long - 0.703_418_6 * medium + 1.707_614_7 * short,
    ]
}

/// sRGB encoding of one linear channel, clamped to 0..1.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A channel 0..1 as a byte, rounded and clamped.
#[must_use]
pub fn to_byte(channel: f32) -> u8 {
    (channel.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear_from_srgb(srgb: f32) -> f32 {
        if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
    }

    fn luminance([r, g, b]: [f32; 3]) -> f32 {
        0.2126 * linear_from_srgb(r) + 0.7152 * linear_from_srgb(g) + 0.0722 * linear_from_srgb(b)
    }

    fn luminances(map: ColorMap) -> Vec<f32> {
        let positions = (0..=100).map(|i| i as f32 / 100.0);
        positions.map(|p| luminance(map.srgb(p))).collect()
    }

    #[test]
    fn sequential_map_only_gets_lighter() {
        let steps = luminances(ColorMap::Sequential);
        assert!(steps.windows(2).all(|w| w[1] > w[0]), "{steps:?}");
    }

    #[test]
    fn diverging_map_is_lightest_at_zero_and_neutral_there() {
        let steps = luminances(ColorMap::Diverging);
        assert!(steps[..=50].windows(2).all(|w| w[1] > w[0]), "{steps:?}");
        assert!(steps[50..].windows(2).all(|w| w[1] < w[0]), "{steps:?}");
        let [r, g, b] = ColorMap::Diverging.srgb(0.5);
        assert!((r - g).abs() < 0.01 && (g - b).abs() < 0.01);
    }

    #[test]
    fn anchors_lie_inside_the_srgb_gamut() {
        for anchor in SEQUENTIAL_LCH.into_iter().chain(DIVERGING_LCH) {
            let linear = linear_from_oklab(oklab(anchor));
            let inside = linear.iter().all(|c| (-0.002..=1.002).contains(c));
            assert!(inside, "{anchor:?} -> {linear:?}");
        }
    }

    #[test]
    fn encoding_and_decoding_are_inverse() {
        for i in 0..=255 {
            let srgb = i as f32 / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(srgb)) - srgb).abs() < 1e-5);
        }
    }
}
