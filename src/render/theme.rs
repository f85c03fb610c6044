//! Light and colours of the two studios, linear unless named sRGB.

use crate::render::view::Background;
use glam::Vec3;

/// Everything that tells the light studio from the dark one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Theme {
    pub background_low: Vec3,
    pub background_high: Vec3,
    pub floor_color: Vec3,
    pub key_light: Vec3,
    pub sky_light: Vec3,
    pub bounce_light: Vec3,
    /// Light of the sky as a mirror would show it.
    pub rim_light: Vec3,
    pub wire_color: Vec3,
    pub wire_opacity: f32,
    pub shadow_strength: f32,
    pub text_srgb: [u8; 3],
    pub faint_text_srgb: [u8; 3],
    /// Behind texts over the picture, and how much of it covers what is there, 0..255.
    pub text_backing_srgb: [u8; 3],
    pub text_backing_opacity: u8,
}

impl Theme {
    pub fn of(background: Background) -> Self {
        match background {
            Background::Light => Self::light(),
            Background::Dark => Self::dark(),
        }
    }

    fn light() -> Self {
        Self {
            background_low: Vec3::new(0.80, 0.81, 0.82),
            background_high: Vec3::new(0.56, 0.61, 0.67),
            floor_color: Vec3::new(0.80, 0.81, 0.82),
            key_light: Vec3::new(0.92, 0.89, 0.84),
            sky_light: Vec3::new(0.40, 0.43, 0.47),
            bounce_light: Vec3::new(0.20, 0.19, 0.18),
            rim_light: Vec3::new(0.66, 0.70, 0.75),
            wire_color: Vec3::splat(0.02),
            wire_opacity: 0.55,
            shadow_strength: 0.62,
            text_srgb: [38, 44, 52],
            faint_text_srgb: [92, 100, 110],
            text_backing_srgb: [238, 240, 243],
            text_backing_opacity: 190,
        }
    }

    fn dark() -> Self {
        Self {
            background_low: Vec3::new(0.022, 0.024, 0.028),
            background_high: Vec3::new(0.008, 0.010, 0.014),
            floor_color: Vec3::new(0.060, 0.064, 0.072),
            key_light: Vec3::new(0.95, 0.92, 0.87),
            sky_light: Vec3::new(0.22, 0.25, 0.30),
            bounce_light: Vec3::new(0.06, 0.06, 0.065),
            rim_light: Vec3::new(0.42, 0.48, 0.58),
            wire_color: Vec3::splat(0.004),
            wire_opacity: 0.6,
            shadow_strength: 0.80,
            text_srgb: [226, 230, 236],
            faint_text_srgb: [150, 158, 168],
            text_backing_srgb: [16, 18, 22],
            text_backing_opacity: 190,
        }
    }
}
