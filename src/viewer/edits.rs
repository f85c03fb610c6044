//! Values that the user has changed, and how they come into the scene.

use super::criterion_edit::CriterionEdit;
use crate::fracture::PropagationRule;
use crate::scene::Scene;
use crate::sim::{ContactParameters, FractureParameters, Material};

/// Changed materials and contact of the open scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edits {
    /// The materials as the sliders show them.
    pub materials: Vec<Material>,
    /// When each of them breaks.
    pub criteria: Vec<CriterionEdit>,
    /// How cracks grow.
    pub fracture: FractureParameters,
    /// Share of the stability limit that steps use.
    pub cfl: f64,
    /// Contact as the sliders show it; acts at once.
    pub contact: ContactParameters,
}

impl Edits {
    /// No changes yet.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let materials = used_materials(scene);
        Self {
            criteria: materials.iter().map(|m| CriterionEdit::of(m.fracture.as_ref())).collect(),
            materials,
            fracture: scene.description.fracture.clone(),
            cfl: scene.description.time.cfl,
            contact: scene.setup.contact.clone(),
        }
    }

    /// The overrides that bring the materials of `base` to what the sliders show. Where a formula is wrong, the material
    /// goes on breaking as in the `running` scene.
    #[must_use]
    pub fn overrides(&self, base: &Scene, running: &Scene) -> Vec<String> {
        let mut overrides = Vec::new();
        for material in &self.materials {
            let Some(before) = base.description.materials.iter().find(|m| m.name == material.name) else {
                continue;
            };
            let values = keyed_values(material).into_iter().zip(keyed_values(before));
            for ((key, now), (_, then)) in values.filter(|((_, now), (_, then))| now != then) {
                debug_assert!(now.is_finite() && then.is_finite());
                overrides.push(format!("materials.{}.{key}={now:e}", material.name));
            }
        }
        for (material, edit) in self.materials.iter().zip(&self.criteria) {
            let acting = running.description.materials.iter().find(|m| m.name == material.name);
            if let Some(text) = edit.or_acting(acting.and_then(|m| m.fracture.as_ref())).to_toml() {
                overrides.push(format!("materials.{}.fracture={text}", material.name));
            }
        }
        overrides.extend(fracture_overrides(&self.fracture, &base.description.fracture));
        if self.cfl != base.description.time.cfl {
            overrides.push(format!("time.cfl={:e}", self.cfl));
        }
        overrides
    }

    /// Whether a formula is wrong, so that a reset leaves it out.
    #[must_use]
    pub fn has_wrong_formula(&self) -> bool {
        self.criteria.iter().any(|edit| edit.criterion().is_err())
    }

    /// Whether the running scene still has other materials than the sliders show.
    #[must_use]
    pub fn wait_for_reset(&self, running: &Scene) -> bool {
        let differs = |edited: &Material| {
            let now = running.description.materials.iter().find(|m| m.name == edited.name);
            now.is_some_and(|now| keyed_values(now) != keyed_values(edited))
        };
        let breaks_otherwise = |(edited, edit): (&Material, &CriterionEdit)| {
            let now = running.description.materials.iter().find(|m| m.name == edited.name);
            let wanted = edit.criterion();
            now.is_some_and(|now| wanted.is_ok_and(|wanted| wanted != now.fracture))
        };
        self.materials.iter().any(differs)
            || self.materials.iter().zip(&self.criteria).any(breaks_otherwise)
            || self.fracture != running.description.fracture
            || self.cfl != running.description.time.cfl
    }
}

/// The materials of bodies that deform; those of others have no say.
fn used_materials(scene: &Scene) -> Vec<Material> {
    let is_used = |material: &&Material| {
        scene.setup.bodies.iter().any(|body| {
            matches!(body.motion, crate::sim::BodyMotion::Deformable(_))
                && body.materials.iter().any(|m| m.name == material.name)
        })
    };
    scene.description.materials.iter().filter(is_used).cloned().collect()
}

fn fracture_overrides(now: &FractureParameters, then: &FractureParameters) -> Vec<String> {
    let numbers = [
        ("crack_spacing", now.crack_spacing_elements, then.crack_spacing_elements),
        ("smallest_altitude", now.smallest_altitude_share, then.smallest_altitude_share),
        ("smallest_fragment", now.smallest_fragment_elements, then.smallest_fragment_elements),
    ];
    let changed = numbers.into_iter().filter(|(_, now, then)| now != then);
    let mut overrides: Vec<String> = changed.map(|(key, now, _)| format!("fracture.{key}={now:e}")).collect();
    if let Some(speed_m_s) = now.crack_speed_m_s.filter(|_| now.crack_speed_m_s != then.crack_speed_m_s) {
        overrides.push(format!("fracture.crack_speed={speed_m_s:e}"));
    }
    if let Some(most) = now.max_elements.filter(|_| now.max_elements != then.max_elements) {
        overrides.push(format!("fracture.max_elements={most}"));
    }
    if now.rule != then.rule {
        let word = match now.rule {
            PropagationRule::TwoAtNode => "two-at-node",
            PropagationRule::SingleElement => "single-element",
        };
        overrides.push(format!("fracture.propagation={word}"));
    }
    overrides
}

/// The values that sliders change, with their keys in scene files.
fn keyed_values(material: &Material) -> [(&'static str, f64); 5] {
    [
        ("youngs_modulus", material.youngs_modulus_pa),
        ("poisson_ratio", material.poisson_ratio),
        ("density", material.density_kg_m3),
        ("damping", material.damping_per_s),
        ("stiffness_damping", material.stiffness_damping_s),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_changed_becomes_an_override() {
        let scene = Scene::load("hammer-ground", &[]).unwrap();
        let mut edits = Edits::of(&scene);
        assert!(edits.overrides(&scene, &scene).is_empty() && !edits.wait_for_reset(&scene));
        edits.materials[0].youngs_modulus_pa = 2.5e6;
        let name = edits.materials[0].name.clone();
        let overrides = edits.overrides(&scene, &scene);
        assert_eq!(overrides, [format!("materials.{name}.youngs_modulus=2.5e6")]);
        assert!(edits.wait_for_reset(&scene));
        let changed = scene.with_overrides(&overrides).unwrap();
        assert!(!edits.wait_for_reset(&changed));
    }

    #[test]
    fn every_scene_takes_the_overrides_of_its_materials() {
        for builtin in crate::scene::BUILTIN_SCENES {
            let scene = Scene::load(builtin.name, &[]).unwrap();
            let mut edits = Edits::of(&scene);
            assert!(!edits.materials.is_empty(), "{}", builtin.name);
            for material in &mut edits.materials {
                material.density_kg_m3 *= 1.25;
                material.poisson_ratio = 0.21;
                material.damping_per_s += 1.0;
            }
            edits.fracture.crack_spacing_elements += 1.0;
            edits.cfl *= 0.5;
            let changed = scene.with_overrides(&edits.overrides(&scene, &scene));
            assert!(!edits.wait_for_reset(&changed.unwrap()), "{}", builtin.name);
        }
    }
}
