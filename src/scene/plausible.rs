//! What can be run but looks like a slip of units.

use super::description::SceneDescription;
use crate::sim::Material;
use std::ops::RangeInclusive;

/// From jelly to twice diamond, Pa.
const YOUNGS_MODULI_PA: RangeInclusive<f64> = 1e2..=2e12;
/// From the lightest foams to well above osmium, kg/m3.
const DENSITIES_KG_M3: RangeInclusive<f64> = 1.0..=3e4;
/// Longitudinal waves in diamond reach 1.8e4 m/s.
const FASTEST_SOUND_M_S: f64 = 5e4;

/// What no material has: (path, message) of each.
pub(super) fn doubts(scene: &SceneDescription) -> Vec<(String, String)> {
    scene.materials.iter().flat_map(doubts_about).collect()
}

fn doubts_about(material: &Material) -> Vec<(String, String)> {
    let path = |key: &str| format!("materials.{}.{key}", material.name);
    let mut doubts = Vec::new();
    let (modulus_pa, density_kg_m3) = (material.youngs_modulus_pa, material.density_kg_m3);
    if let Some(much) = beyond(&YOUNGS_MODULI_PA, modulus_pa) {
        let path = path("youngs_modulus");
        let is = format!("`{path}` is {}, far {much} than of any solid", in_words(modulus_pa));
        doubts.push((path, format!("{is}; the unit is Pa, and 200 GPa are 200e9")));
    }
    if let Some(much) = beyond(&DENSITIES_KG_M3, density_kg_m3) {
        let path = path("density");
        let is = format!("`{path}` is {}, {much} than of any solid", in_words(density_kg_m3));
        doubts.push((path, format!("{is}; the unit is kg/m3, and steel has 7800")));
    }
    let sound_m_s = sound_m_s(material);
    if doubts.is_empty() && sound_m_s > FASTEST_SOUND_M_S {
        let message = format!(
            "sound would travel through `{}` at {} m/s, faster than through any solid; check `youngs_modulus` (Pa) \
             and `density` (kg/m3)",
            material.name,
            in_words(sound_m_s)
        );
        doubts.push((format!("materials.{}", material.name), message));
    }
    doubts
}

fn beyond(plausible: &RangeInclusive<f64>, number: f64) -> Option<&'static str> {
    match number {
        number if number < *plausible.start() => Some("less"),
        number if number > *plausible.end() => Some("more"),
        _ => None,
    }
}

/// Speed of longitudinal waves.
fn sound_m_s(material: &Material) -> f64 {
    let ratio = material.poisson_ratio;
    let stiffness_pa = material.youngs_modulus_pa * (1.0 - ratio) / ((1.0 + ratio) * (1.0 - 2.0 * ratio));
    (stiffness_pa / material.density_kg_m3).sqrt()
}

/// Three digits.
fn in_words(number: f64) -> String {
    let rounded: f64 = format!("{number:.2e}").parse().unwrap_or(number);
    if (1e-3..1e5).contains(&rounded) { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::super::{BUILTIN_SCENES, PRESETS, Scene};

    fn warnings_with(overrides: &[&str]) -> Vec<String> {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        Scene::load("bounce", &overrides).unwrap().warnings
    }

    #[test]
    fn slips_of_units_are_doubted_and_materials_are_not() {
        for builtin in BUILTIN_SCENES {
            let scene = Scene::load(builtin.name, &[]).unwrap();
            assert_eq!(scene.warnings, [""; 0], "{}", builtin.name);
        }
        for preset in PRESETS {
            let warnings = warnings_with(&[&format!("bodies[0].material={}", preset.name)]);
            assert_eq!(warnings, [""; 0], "{}", preset.name);
        }
        for (slips, part) in [
            (&["materials.ball.youngs_modulus=200e18"][..], "is 2e20, far more"),
            (&["materials.ball.youngs_modulus=0.05"], "is 0.05, far less"),
            (&["materials.ball.density=7.8e6"], "is 7.8e6, more"),
            (&["materials.ball.density=0.9"], "is 0.9, less"),
            (&["materials.ball.density=7.8", "materials.ball.youngs_modulus=2e11"], "sound would"),
        ] {
            let warnings = warnings_with(slips);
            assert_eq!(warnings.len(), 1, "{warnings:?}");
            assert!(warnings[0].contains(part), "{warnings:?}");
        }
    }

    #[test]
    fn a_doubt_names_the_line() {
        let text = include_str!("../../assets/scenes/bounce.toml");
        let (at, _) = text.match_indices("[[bodies]]").next().unwrap();
        let material = "[materials.odd]\npreset = \"steel\"\nyoungs_modulus = 200e18\n";
        let text = format!("{}{material}{}", &text[..at], &text[at..]);
        let line = text[..at].lines().count() + 3;
        let scene = Scene::from_text("b.toml", &text, std::path::Path::new("."), &[]).unwrap();
        assert!(scene.warnings[0].starts_with(&format!("b.toml:{line}:")), "{:?}", scene.warnings);
    }
}
