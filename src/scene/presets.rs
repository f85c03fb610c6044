//! The library of materials that a scene can start from.
//!
//! Room-temperature, handbook-typical values. Densities and elastic constants of metals, glass and
//! ceramics: *ASM Metals Handbook* vols. 1-2, *CRC Handbook of Chemistry and Physics* (elastic
//! constants of polycrystals); concrete: Eurocode 2 (EN 1992-1-1, table 3.1, class C30/37, uncracked
//! nu = 0.2); wood: *Wood Handbook*, USDA FPL-GTR-282, oak along the grain, taken as isotropic;
//! polymers, rubber, cork, ice: Ashby, *Materials Selection in Mechanical Design*, mid-range values.
//!
//! Damping is not a handbook value: alpha (of C = alpha M) is set so that ringing dies out in about the
//! time one expects of a hand-sized object.

/// A material of the library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name, as `preset = "..."` takes it.
    pub name: &'static str,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Mass-proportional damping, 1/s.
    pub damping_per_s: f64,
    /// Base colour, sRGB 0..1.
    pub color_srgb: [f32; 3],
}

const fn preset(name: &'static str, elastic: [f64; 3], damping: f64, rgb: [u8; 3]) -> Preset {
    Preset {
        name,
        density_kg_m3: elastic[0],
        youngs_modulus_pa: elastic[1],
        poisson_ratio: elastic[2],
        damping_per_s: damping,
        color_srgb: [rgb[0] as f32 / 255.0, rgb[1] as f32 / 255.0, rgb[2] as f32 / 255.0],
    }
}

/// All of them, by kind: `[density kg/m3, Young's modulus Pa, Poisson's ratio]`, damping 1/s, colour.
pub const PRESETS: &[Preset] = &[
    preset("steel", [7850.0, 210e9, 0.30], 20.0, [138, 147, 158]),
    preset("cast-iron", [7200.0, 120e9, 0.26], 60.0, [88, 92, 98]),
    preset("aluminium", [2700.0, 70e9, 0.33], 20.0, [186, 192, 198]),
    preset("copper", [8960.0, 120e9, 0.34], 20.0, [192, 118, 80]),
    preset("brass", [8500.0, 105e9, 0.34], 20.0, [205, 170, 90]),
    preset("lead", [11340.0, 16e9, 0.44], 200.0, [104, 108, 120]),
    preset("glass", [2500.0, 70e9, 0.22], 20.0, [150, 200, 205]),
    preset("ceramic", [3900.0, 370e9, 0.22], 20.0, [233, 228, 216]),
    preset("porcelain", [2400.0, 70e9, 0.20], 30.0, [240, 240, 236]),
    preset("concrete", [2400.0, 33e9, 0.20], 60.0, [158, 155, 148]),
    preset("brick", [1900.0, 15e9, 0.18], 60.0, [168, 88, 66]),
    preset("granite", [2650.0, 60e9, 0.25], 40.0, [140, 132, 130]),
    preset("ice", [917.0, 9e9, 0.33], 60.0, [196, 222, 236]),
    preset("wood", [700.0, 11e9, 0.35], 80.0, [176, 128, 78]),
    preset("cork", [180.0, 30e6, 0.05], 100.0, [190, 150, 105]),
    preset("acrylic", [1180.0, 3.2e9, 0.37], 60.0, [190, 214, 226]),
    preset("nylon", [1140.0, 2.7e9, 0.39], 80.0, [228, 222, 205]),
    preset("rubber", [1100.0, 5e6, 0.45], 20.0, [70, 92, 150]),
    preset("soft-rubber", [1000.0, 0.6e6, 0.45], 15.0, [214, 98, 76]),
    preset("foam", [80.0, 0.3e6, 0.20], 30.0, [236, 206, 110]),
    preset("gel", [1000.0, 0.1e6, 0.45], 10.0, [120, 190, 130]),
];

/// The material of the library with this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}
