//! How finely pictures are drawn.

/// How finely a picture is drawn. Files get all of it; the window takes less while things move on slow hardware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// One sample per pixel instead of four, and fewer looks at what is in the light's way.
    pub is_draft: bool,
    /// Pixels drawn for each pixel of a side, numerator and denominator; the legend is always at one.
    pub scale: [u32; 2],
}

impl Quality {
    /// The best.
    pub const FULL: Self = Self { is_draft: false, scale: [1, 1] };

    /// A draft at a share of the resolution.
    #[must_use]
    pub const fn draft(scale: [u32; 2]) -> Self {
        Self { is_draft: true, scale }
    }

    /// Samples per pixel.
    #[must_use]
    pub(crate) fn samples(self) -> u32 {
        if self.is_draft { 1 } else { 4 }
    }

    /// The size at which a picture is drawn, pixels.
    #[must_use]
    pub(crate) fn drawn_px(self, size_px: [u32; 2]) -> [u32; 2] {
        let [numerator, denominator] = self.scale.map(u64::from);
        let denominator = denominator.max(1);
        size_px.map(|side| (u64::from(side) * numerator.min(denominator)).div_ceil(denominator).max(1) as u32)
    }

    /// Pixels drawn for each pixel of a side.
    #[must_use]
    pub(crate) fn share(self) -> f32 {
        let [numerator, denominator] = self.scale;
        (numerator as f32 / denominator.max(1) as f32).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_a_picture_is_never_nothing_and_never_more() {
        assert_eq!(Quality::FULL.drawn_px([1280, 720]), [1280, 720]);
        assert_eq!(Quality::draft([2, 3]).drawn_px([1280, 721]), [854, 481]);
        assert_eq!(Quality::draft([1, 2]).drawn_px([1, 1]), [1, 1]);
        assert_eq!(Quality::draft([3, 2]).drawn_px([100, 10]), [100, 10]);
        assert_eq!(Quality::draft([0, 0]).drawn_px([100, 10]), [1, 1]);
    }
}
