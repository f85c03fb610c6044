//! Scenes at random, as the text of a scene file: every shape, material, criterion and contact method, boundaries, motions,
//! entrances and removals come up; pulls, changes of contact and the laws for large strain do not.
//!
//! Speeds and strengths follow from the materials, so that bodies deform by percents: what is faster or heavier crushes them,
//! which no elastic law describes.

use super::dice::Dice;
use glam::DVec3;
use hammerfall::scene::{PRESETS, Preset};
use std::fmt::Write as _;

/// Of a body from end to end, at most, m.
const SIZE_M: f64 = 0.3;

struct Maker {
    dice: Dice,
    text: String,
    /// Of the scene's bodies.
    presets: Vec<&'static Preset>,
    /// Fastest that bodies close in on each other, m/s.
    speed_m_s: f64,
    has_gravity: bool,
    has_ground: bool,
    /// Nothing outside acts but gravity.
    is_isolated: bool,
    names: Vec<String>,
}

/// The scene of a seed; a later attempt is another one.
pub fn scene(seed: u64, attempt: u64) -> String {
    let mut dice = Dice::new(seed.wrapping_mul(1_000_003).wrapping_add(attempt));
    let kinds = dice.count(1, 3);
    let presets: Vec<&Preset> = (0..kinds).map(|_| dice.choose(PRESETS)).collect();
    let softest_pa = presets.iter().map(|p| p.youngs_modulus_pa).fold(f64::INFINITY, f64::min);
    let densest_kg_m3 = presets.iter().map(|p| p.density_kg_m3).fold(0.0, f64::max);
    // The energy of a body that is stopped strains it, and the softer one it hits, by about this share.
    let strain = dice.factor(0.01, 0.15);
    let speed_m_s = (strain * (softest_pa / densest_kg_m3).sqrt()).min(30.0);
    let is_isolated = dice.is_lucky(0.35);
    let has_gravity = dice.is_lucky(if is_isolated { 0.3 } else { 0.8 });
    let has_ground = !is_isolated && dice.is_lucky(0.7);
    let text = String::new();
    let mut maker =
        Maker { dice, text, presets, speed_m_s, has_gravity, has_ground, is_isolated, names: Vec::new() };
    maker.head(seed);
    maker.materials();
    maker.settings();
    maker.bodies();
    maker.removals();
    maker.text
}

fn vector(v: DVec3) -> String {
    format!("[{:.5}, {:.5}, {:.5}]", v.x, v.y, v.z)
}

impl Maker {
    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        writeln!(self.text, "{line}").expect("writing to a String cannot fail");
    }

    fn head(&mut self, seed: u64) {
        self.line(format_args!("title = \"random scene {seed}\""));
        let gravity = match self.has_gravity {
            false => DVec3::ZERO,
            true if self.has_ground => DVec3::NEG_Z * 9.81,
            true => self.dice.direction() * self.dice.between(1.0, 20.0),
        };
        self.line(format_args!("gravity = {}", vector(gravity)));
        if self.has_ground {
            let friction = self.dice.between(0.0, 1.0);
            self.line(format_args!("[ground]\nsize = 4.0\nfriction = {friction:.3}"));
        }
    }

    /// Materials `m0`, `m1`, ..., some of them breaking.
    fn materials(&mut self) {
        for index in 0..self.presets.len() {
            let preset = self.presets[index];
            self.line(format_args!("[materials.m{index}]\npreset = \"{}\"", preset.name));
            if self.dice.is_lucky(0.5) {
                let damping = if self.dice.is_lucky(0.3) { 0.0 } else { self.dice.factor(1.0, 1000.0) };
                self.line(format_args!("damping = {damping:.3}"));
            }
            if self.dice.is_lucky(0.15) {
                let crossing_s = 0.01 / (preset.youngs_modulus_pa / preset.density_kg_m3).sqrt();
                let damping_s = crossing_s * self.dice.factor(0.01, 0.3);
                self.line(format_args!("stiffness_damping = {damping_s:e}"));
            }
            if self.dice.is_lucky(0.6) {
                let fracture = self.fracture(preset);
                self.line(format_args!("fracture = {fracture}"));
            }
        }
    }

    fn fracture(&mut self, preset: &Preset) -> String {
        if self.dice.is_lucky(0.3) {
            let (a, b) = (self.criterion(preset), self.criterion(preset));
            return format!("{{ any_of = [{a}, {b}] }}");
        }
        self.criterion(preset)
    }

    /// Of about the stress that a stopped body has, rho c v.
    fn criterion(&mut self, preset: &Preset) -> String {
        let blow_pa = self.speed_m_s * (preset.youngs_modulus_pa * preset.density_kg_m3).sqrt();
        let strength_pa = blow_pa * self.dice.factor(0.1, 2.0);
        let plane = match self.dice.count(0, 3) {
            0 => ", plane = \"opening\"",
            1 => ", plane = \"sliding\"",
            _ => "",
        };
        let angle = self.dice.between(0.0, 50.0);
        let criterion = match self.dice.count(0, 6) {
            0 => format!("criterion = \"tensile\", tensile_strength = {strength_pa:.3}"),
            1 => format!("criterion = \"tresca\", shear_strength = {strength_pa:.3}{plane}"),
            2 => format!("criterion = \"von-mises\", shear_strength = {strength_pa:.3}{plane}"),
            3 => {
                format!(
                    "criterion = \"mohr-coulomb\", cohesion = {strength_pa:.3}, friction_angle = {angle:.2}{plane}"
                )
            }
            4 => {
                format!(
                    "criterion = \"drucker-prager\", cohesion = {strength_pa:.3}, friction_angle = {angle:.2}{plane}"
                )
            }
            5 => format!(
                "criterion = \"formula\", formula = \"s1 - Ft\", parameters = {{ Ft = {strength_pa:.3} }}{plane}"
            ),
            _ => format!(
                "criterion = \"formula\", formula = \"sqrt(3*J2) + a*I1 - Y\", parameters = {{ a = {:.3}, Y = \
                 {strength_pa:.3} }}{plane}",
                self.dice.between(0.0, 0.5)
            ),
        };
        format!("{{ {criterion} }}")
    }

    fn settings(&mut self) {
        self.contact();
        let cfl = self.dice.between(0.3, 0.9);
        self.line(format_args!("[time]\nduration = 3.0\ncfl = {cfl:.2}"));
        if self.dice.is_lucky(0.15) {
            self.line(format_args!("free_travel = false"));
        }
        if self.dice.is_lucky(0.2) {
            self.line(format_args!("sleeping = false"));
        }
        if self.dice.is_lucky(0.3) {
            let interval_s = self.dice.factor(1e-4, 0.02);
            self.line(format_args!("free_interval = {interval_s:.6}"));
        }
        if self.dice.is_lucky(0.2) {
            let tolerance = self.dice.factor(1e-5, 0.1);
            self.line(format_args!("vibration_tolerance = {tolerance:.6}"));
        }
        self.growth();
    }

    fn contact(&mut self) {
        let friction = if self.dice.is_lucky(0.2) { 0.0 } else { self.dice.between(0.0, 1.2) };
        self.line(format_args!("[contact]\nfriction = {friction:.3}"));
        if self.dice.is_lucky(0.2) {
            // Stiff enough for the heaviest corner of a body to go in by a small part of an element.
            let stiffness = self.presets.iter().map(|p| p.youngs_modulus_pa).fold(0.0, f64::max) * 0.05;
            self.line(format_args!("method = \"penalty\"\npenalty_stiffness = {stiffness:e}"));
        } else {
            if self.dice.is_lucky(0.4) {
                self.line(format_args!("impact = \"plastic\""));
            }
            if self.dice.is_lucky(0.3) {
                let passes = self.dice.count(1, 6);
                self.line(format_args!("passes = {passes}"));
            }
        }
        if self.dice.is_lucky(0.2) {
            self.line(format_args!("self_collision = false"));
        }
    }

    fn growth(&mut self) {
        self.line(format_args!("[fracture]"));
        if self.dice.is_lucky(0.3) {
            self.line(format_args!("propagation = \"single-element\""));
        }
        if self.dice.is_lucky(0.3) {
            let spacing = self.dice.between(0.0, 5.0);
            self.line(format_args!("crack_spacing = {spacing:.2}"));
        }
        if self.dice.is_lucky(0.3) {
            let altitude = self.dice.between(0.1, 1.0);
            self.line(format_args!("smallest_altitude = {altitude:.3}"));
        }
        if self.dice.is_lucky(0.3) {
            let fragment = self.dice.between(0.0, 20.0);
            self.line(format_args!("smallest_fragment = {fragment:.2}"));
        }
        if self.dice.is_lucky(0.15) {
            self.line(format_args!("max_elements = 500"));
        }
    }

    fn bodies(&mut self) {
        let count = self.dice.count(2, 5);
        let mut place_m = DVec3::Z * SIZE_M;
        for index in 0..count as usize {
            let name = format!("b{index}");
            self.line(format_args!("[[bodies]]\nname = \"{name}\""));
            let shape = self.shape();
            self.line(format_args!("{shape}"));
            let stands = self.placement(index, &mut place_m);
            self.motion(index, stands, place_m);
            self.names.push(name);
        }
    }

    /// A shape and its material or materials.
    fn shape(&mut self) -> String {
        let material = |maker: &mut Self| {
            let index = maker.dice.count(0, maker.presets.len() as u64 - 1);
            format!("\"m{index}\"")
        };
        let mut m = |low: f64, high: f64| self.dice.between(low, high);
        let (a, b, c) = (m(0.06, 0.16), m(0.06, 0.16), m(0.06, 0.16));
        let (long, thin, thinner) = (m(0.15, 0.28), m(0.03, 0.06), m(0.012, 0.022));
        let cells = |dice: &mut Dice, most: [u64; 3]| {
            let [x, y, z] = most.map(|most| dice.count(1, most));
            let split = if dice.is_lucky(0.5) { ", split = \"five\"" } else { "" };
            format!("cells = [{x}, {y}, {z}]{split}")
        };
        let dice = &mut self.dice;
        let (shape, regions): (String, &[&str]) = match dice.count(0, 9) {
            0 => (format!("\"box\", size = [{a:.4}, {b:.4}, {c:.4}], {}", cells(dice, [3, 3, 3])), &[]),
            1 => (
                format!(
                    "\"rod\", length = {long:.4}, width = {thin:.4}, height = {thin:.4}, {}",
                    cells(dice, [7, 2, 2])
                ),
                &[],
            ),
            2 => (
                format!(
                    "\"plate\", length = {long:.4}, width = {a:.4}, thickness = {thin:.4}, {}",
                    cells(dice, [5, 4, 1])
                ),
                &[],
            ),
            3 => (
                format!(
                    "\"pile\", width = {a:.4}, depth = {b:.4}, height = {long:.4}, {}",
                    cells(dice, [2, 2, 4])
                ),
                &[],
            ),
            4 => (
                format!(
                    "\"beam\", length = {long:.4}, width = {thin:.4}, height = 0.06, notch_width = 0.02, notch_depth = \
                     0.02, notch_radius = {}",
                    dice.choose(&["0", "0.005"])
                ),
                &[],
            ),
            5 => (format!("\"ball\", radius = {:.4}", dice.between(0.03, 0.08)), &[]),
            6 => (
                format!(
                    "\"table\", length = {long:.4}, width = 0.15, height = 0.15, top_thickness = {thin:.4}, leg_width = \
                     {thin:.4}"
                ),
                &["top", "legs"],
            ),
            7 => (
                format!("\"cup\", radius = {:.4}, height = 0.1, wall = {thinner:.4}", thin + 0.02),
                &["bowl", "handle"],
            ),
            8 => (
                format!(
                    "\"lamp\", height = {long:.4}, foot_radius = {thin:.4}, stem_radius = 0.012, shade_radius = {:.4}, \
                     shade_height = 0.06",
                    thin + 0.02
                ),
                &["foot", "stem", "shade"],
            ),
            _ => (
                format!(
                    "\"hammer\", head_length = {a:.4}, head_width = {thin:.4}, handle_length = {long:.4}, handle_width = \
                     {thinner:.4}"
                ),
                &["head", "handle"],
            ),
        };
        let by_region = !regions.is_empty() && self.dice.is_lucky(0.5);
        let materials = if by_region {
            let of: Vec<String> =
                regions.iter().map(|region| format!("{region} = {}", material(self))).collect();
            format!("{{ {} }}", of.join(", "))
        } else {
            material(self)
        };
        format!("shape = {{ type = {shape} }}\nmaterial = {materials}")
    }

    /// Writes where the body is; whether it stands on something. `place_m` is that of the body before it.
    fn placement(&mut self, index: usize, place_m: &mut DVec3) -> bool {
        if self.dice.is_lucky(0.5) {
            let angles = self.dice.direction() * self.dice.between(0.0, 180.0);
            self.line(format_args!("rotation = {}", vector(angles)));
        }
        let below = match index {
            0 if self.has_ground => Some("ground".to_owned()),
            0 => None,
            _ if self.has_ground && self.dice.is_lucky(0.3) => Some("ground".to_owned()),
            _ => self.dice.is_lucky(0.7).then(|| self.names[index - 1].clone()),
        };
        match below {
            Some(below) => {
                let apart_m = if below == "ground" && index > 0 { 1.2 * SIZE_M * index as f64 } else { 0.0 };
                if apart_m > 0.0 {
                    *place_m = DVec3::new(apart_m, 0.0, SIZE_M);
                }
                place_m.x += self.dice.between(-0.03, 0.03);
                place_m.y += self.dice.between(-0.03, 0.03);
                place_m.z += SIZE_M;
                let gap_m = if self.dice.is_lucky(0.3) { 0.0 } else { self.dice.factor(1e-4, 0.03) };
                let (x, y) = (place_m.x, place_m.y);
                self.line(format_args!("on = \"{below}\"\nposition = [{x:.5}, {y:.5}]\ngap = {gap_m:.6}"));
                true
            }
            None => {
                let mut away = self.dice.direction();
                away.z = away.z.abs();
                *place_m += away.normalize() * if index == 0 { 0.0 } else { 1.15 * SIZE_M };
                self.line(format_args!("position = {}", vector(*place_m)));
                false
            }
        }
    }

    fn motion(&mut self, index: usize, stands: bool, place_m: DVec3) {
        if !self.is_isolated && index + 1 < 5 && self.dice.is_lucky(0.12) {
            if self.dice.is_lucky(0.5) {
                self.line(format_args!("motion = \"fixed\""));
            } else {
                let velocity = self.dice.direction() * self.speed_m_s * self.dice.between(0.0, 0.5);
                let spin = self.dice.direction() * self.speed_m_s * self.dice.between(0.0, 2.0);
                self.line(format_args!(
                    "motion = \"kinematic\"\nprescribed = {{ velocity = {}, spin = {} }}",
                    vector(velocity),
                    vector(spin)
                ));
            }
            return;
        }
        let speed = self.speed_m_s * self.dice.between(0.0, 1.0);
        // Onto what is below, or back to where the first one is.
        let aim = if stands { DVec3::NEG_Z } else { (DVec3::Z * SIZE_M - place_m).normalize_or_zero() };
        let velocity =
            if index == 0 { DVec3::ZERO } else { aim * speed + 0.2 * speed * self.dice.direction() };
        if !(stands && self.dice.is_lucky(0.3)) {
            self.line(format_args!("velocity = {}", vector(velocity)));
        }
        if self.dice.is_lucky(0.4) {
            let spin = self.dice.direction() * self.speed_m_s / SIZE_M * self.dice.between(0.0, 2.0);
            self.line(format_args!("spin = {}", vector(spin)));
        }
        // What breaks needs `green`, which a scene that has breaking materials keeps for all.
        if !self.text.contains("fracture = {") {
            if self.dice.is_lucky(0.4) {
                self.line(format_args!("kinematics = \"body-frame\""));
            }
            if self.dice.is_lucky(0.15) {
                self.line(format_args!("mass_scaling = 0.02"));
            }
        }
        if !self.is_isolated && self.dice.is_lucky(0.15) {
            let enters_s = self.dice.factor(1e-4, 0.05);
            self.line(format_args!("enters = {enters_s:.5}"));
        }
        if !self.is_isolated && self.dice.is_lucky(0.25) {
            self.boundary();
        }
    }

    fn boundary(&mut self) {
        let at = match self.dice.count(0, 3) {
            0 => "\"bottom\"".to_owned(),
            1 => format!("\"{}\"", self.dice.choose(&["x-min", "x-max", "y-min", "z-max", "left", "front"])),
            2 => "{ side = \"top\", depth = 0.01 }".to_owned(),
            _ => "\"all\"".to_owned(),
        };
        let speed = 0.2 * self.speed_m_s;
        // About what a tenth of a per cent of strain over a square of 5 cm takes.
        let softest_pa = self.presets.iter().map(|p| p.youngs_modulus_pa).fold(f64::INFINITY, f64::min);
        let force_n = 1e-3 * softest_pa * 0.05_f64.powi(2) * self.dice.between(0.0, 1.0);
        let action = match self.dice.count(0, 2) {
            0 => "fixed = true, axes = \"xz\"".to_owned(),
            1 => format!("velocity = {}", vector(self.dice.direction() * speed)),
            _ => format!("force = {}, ramp = 0.01", vector(self.dice.direction() * force_n)),
        };
        self.line(format_args!("boundary = [{{ at = {at}, {action} }}]"));
    }

    fn removals(&mut self) {
        if !self.is_isolated && self.dice.is_lucky(0.25) {
            let body = self.dice.choose(&self.names).clone();
            let at_s = self.dice.between(0.05, 0.2);
            self.line(format_args!("[[removals]]\nbody = \"{body}\"\nat = {at_s:.4}"));
        }
    }
}
