//! What a scene would cost, before it is run.

use crate::mesh::ElementShape;
use crate::sim::{BodyMotion, BodySetup, Material, WorldSetup};
use std::fmt;

/// Size and cost of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// Title of the scene.
    pub title: String,
    /// How much time is simulated, s.
    pub duration_s: f64,
    /// The bodies.
    pub bodies: Vec<BodySummary>,
    /// What reading mesh files had to say: (body, note).
    pub notes: Vec<(String, String)>,
}

/// Size and cost of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySummary {
    /// Name.
    pub name: String,
    /// Tetrahedra.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Estimate of the elastic step at the scene's cfl, s: smallest altitude over the speed of
    /// pressure waves. Infinite for bodies that do not deform.
    pub step_s: f64,
    /// Mass that mass scaling adds for that step, kg.
    pub added_mass_kg: f64,
}

impl SceneSummary {
    /// Tetrahedra of all bodies.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.bodies.iter().map(|body| body.elements).sum()
    }

    /// Nodes of all bodies.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.bodies.iter().map(|body| body.nodes).sum()
    }

    /// Smallest elastic step of any body, s; infinite when nothing deforms.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let steps = self.bodies.iter().map(|body| body.step_s);
        steps.fold(f64::INFINITY, f64::min)
    }

    /// Elastic steps at most: as many as if nothing ever moved freely or rested.
    #[must_use]
    pub fn steps_at_most(&self) -> f64 {
        (self.duration_s / self.step_s()).ceil()
    }

    pub(super) fn of(title: &str, duration_s: f64, setup: &WorldSetup, notes: Vec<(String, String)>) -> Self {
        let (cfl, max_step_s) = (setup.time.cfl, setup.time.max_step_s);
        let bodies = setup.bodies.iter();
        Self {
            title: title.to_owned(),
            duration_s,
            bodies: bodies.map(|body| summary_of(body, cfl, max_step_s)).collect(),
            notes,
        }
    }
}

fn summary_of(body: &BodySetup, cfl: f64, max_step_s: f64) -> BodySummary {
    let elements: Vec<(f64, f64)> =
        (0..body.mesh.tets.len()).map(|element| mass_and_step(body, element)).collect();
    let mass_kg: f64 = elements.iter().map(|(mass, _)| mass).sum();
    let budget_kg = body.mass_scaling_max_share * mass_kg;
    let (step_s, added_mass_kg) = match body.motion {
        BodyMotion::Deformable(_) => scaled_step(elements, budget_kg),
        _ => (f64::INFINITY, 0.0),
    };
    BodySummary {
        name: body.name.clone(),
        elements: body.mesh.tets.len(),
        nodes: body.mesh.nodes_m.len(),
        mass_kg,
        step_s: (cfl * step_s).min(if step_s.is_finite() { max_step_s } else { step_s }),
        added_mass_kg,
    }
}

/// Mass, kg, and stable step, s, of an element: smallest altitude over the speed of pressure waves.
fn mass_and_step(body: &BodySetup, element: usize) -> (f64, f64) {
    let shape = ElementShape::of(&body.mesh.corners_m(element));
    let material = &body.materials[body.element_material[element] as usize];
    let mass_kg = material.density_kg_m3 * shape.volume_m3.abs();
    (mass_kg, shape.min_altitude_m / pressure_wave_speed_m_s(material))
}

/// c_p = sqrt((lambda + 2 mu) / rho).
fn pressure_wave_speed_m_s(material: &Material) -> f64 {
    let nu = material.poisson_ratio;
    let modulus_pa = material.youngs_modulus_pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    (modulus_pa / material.density_kg_m3).sqrt()
}

/// The longest step that adding at most `budget_kg` to the worst elements allows, and what it adds.
/// An element of mass m and step h needs m ((H/h)^2 - 1) more mass to be stable at the step H.
fn scaled_step(mut elements: Vec<(f64, f64)>, budget_kg: f64) -> (f64, f64) {
    elements.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut step_s = elements.first().map_or(f64::INFINITY, |&(_, step)| step);
    let (mut mass_kg, mut mass_over_step2, mut added_kg) = (0.0, 0.0, 0.0);
    if budget_kg <= 0.0 {
        return (step_s, 0.0);
    }
    for (index, &(mass, step)) in elements.iter().enumerate() {
        mass_kg += mass;
        mass_over_step2 += mass / (step * step);
        let next_s = elements.get(index + 1).map_or(step, |&(_, next)| next);
        // Added mass at the step H is H^2 sum(m/h^2) - sum(m).
        let affordable_s = ((budget_kg + mass_kg) / mass_over_step2).sqrt();
        step_s = affordable_s.min(next_s).max(step_s);
        added_kg = (step_s * step_s * mass_over_step2 - mass_kg).max(0.0);
        if affordable_s < next_s {
            break;
        }
    }
    (step_s, added_kg)
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        writeln!(f, "  {} elements, {} nodes", self.elements(), self.nodes())?;
        let width = self.bodies.iter().map(|body| body.name.len()).max().unwrap_or(0);
        for body in &self.bodies {
            writeln!(f, "  {:width$}  {body}", body.name)?;
        }
        if self.step_s().is_finite() {
            writeln!(
                f,
                "  elastic step about {:.2e} s; {} s need at most {} of them (fewer while bodies \
                 move freely or rest)",
                self.step_s(),
                self.duration_s,
                thousands(self.steps_at_most())
            )?;
        }
        for (body, note) in &self.notes {
            writeln!(f, "  note on {body}: {note}")?;
        }
        Ok(())
    }
}

impl fmt::Display for BodySummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} elements, {} nodes, {:.4} kg", self.elements, self.nodes, self.mass_kg)?;
        if self.step_s.is_finite() {
            write!(f, ", step {:.2e} s", self.step_s)?;
        } else {
            write!(f, ", rigid")?;
        }
        if self.added_mass_kg > 0.0 {
            let percent = 100.0 * self.added_mass_kg / self.mass_kg;
            write!(f, ", mass scaling adds about {percent:.2} % of it")?;
        }
        Ok(())
    }
}

/// A count with thin gaps: `1 234 567`.
fn thousands(count: f64) -> String {
    let digits = format!("{count:.0}");
    let first = digits.len() % 3;
    let (head, tail) = digits.split_at(first);
    let groups = tail.as_bytes().chunks(3).map(String::from_utf8_lossy);
    let head = (!head.is_empty()).then(|| head.into());
    head.into_iter().chain(groups).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_scaling_spends_its_budget_on_the_worst_elements() {
        let elements = vec![(1.0, 1.0), (1.0, 4.0), (8.0, 4.0)];
        let (step, added) = scaled_step(elements.clone(), 3.0);
        assert!((step - 2.0).abs() < 1e-12 && (added - 3.0).abs() < 1e-12);
        let (step, added) = scaled_step(elements, 0.0);
        assert_eq!((step, added), (1.0, 0.0));
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(thousands(1_234_567.0), "1 234 567");
        assert_eq!(thousands(123.0), "123");
    }
}
