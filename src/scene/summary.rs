//! What a scene would cost, before it is run.

use super::Scene;
use crate::sim::{BodySetup, Change, SimError, World, WorldSetup};
use std::fmt;

/// Size and cost of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// Title of the scene.
    pub title: String,
    /// How much time is simulated, s.
    pub duration_s: f64,
    /// The bodies, those that come in later last.
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
    /// Mass without what mass scaling added, kg.
    pub mass_kg: f64,
    /// Elastic step at the scene's cfl, s. Infinite for bodies that do not deform.
    pub step_s: f64,
    /// Mass that mass scaling added for that step, kg.
    pub added_mass_kg: f64,
    /// When it comes in, s; `None` when it is there from the start.
    pub enters_s: Option<f64>,
}

impl SceneSummary {
    /// The summary of a scene and the world built from it.
    ///
    /// # Errors
    /// [`SimError::Setup`] when a body that comes in later is unsound.
    pub fn of(scene: &Scene, world: &World) -> Result<Self, SimError> {
        let mut bodies: Vec<_> = (0..world.body_count()).map(|index| summary_of(world, index)).collect();
        for planned in &scene.setup.changes {
            if let Change::Enter(entrance) = &planned.change {
                let alone = World::new(alone(&scene.setup, &entrance.body))?;
                bodies.push(BodySummary { enters_s: Some(planned.time_s), ..summary_of(&alone, 0) });
            }
        }
        Ok(Self {
            title: scene.description.title.clone(),
            duration_s: scene.description.duration_s,
            bodies,
            notes: scene.notes.clone(),
        })
    }

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

    /// Elastic steps at most: as many as if nothing ever moved freely or rested, and nothing were strained so much that
    /// its step has to shrink.
    #[must_use]
    pub fn steps_at_most(&self) -> f64 {
        (self.duration_s / self.step_s()).ceil()
    }
}

/// A world with nothing but one body, which has nobody to rub against.
fn alone(setup: &WorldSetup, body: &BodySetup) -> WorldSetup {
    let mut contact = setup.contact.clone();
    contact.pair_friction.clear();
    WorldSetup {
        bodies: vec![body.clone()],
        changes: Vec::new(),
        contact,
        time: setup.time.clone(),
        fracture: setup.fracture.clone(),
        gravity_m_s2: setup.gravity_m_s2,
    }
}

fn summary_of(world: &World, index: usize) -> BodySummary {
    let time = &world.setup().time;
    let step_s = time.cfl * world.stable_step_s(index);
    let added_mass_kg = world.mass_scaling(index).added_kg;
    BodySummary {
        name: world.setup().bodies[index].name.clone(),
        elements: world.tets(index).len(),
        nodes: world.reference_positions_m(index).len(),
        mass_kg: world.mass_kg(index) - added_mass_kg,
        step_s: if step_s.is_finite() { step_s.min(time.max_step_s) } else { step_s },
        added_mass_kg,
        enters_s: None,
    }
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
                "  elastic step {:.2e} s; {} s need {} of them if something deforms all the time",
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
            write!(f, ", mass scaling adds {percent:.2} % of it")?;
        }
        if let Some(enters_s) = self.enters_s {
            write!(f, ", comes in at {enters_s} s")?;
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
    fn who_comes_in_later_is_counted_and_told() {
        let scene = Scene::load("hammer-table", &["bodies.hammer.enters=0.125".to_owned()]).unwrap();
        let world = World::new(scene.setup.clone()).unwrap();
        let summary = SceneSummary::of(&scene, &world).unwrap();
        let whole = Scene::load("hammer-table", &[]).unwrap();
        let of_whole = SceneSummary::of(&whole, &World::new(whole.setup.clone()).unwrap()).unwrap();
        assert_eq!(world.body_count() + 1, summary.bodies.len());
        assert_eq!((summary.elements(), summary.step_s()), (of_whole.elements(), of_whole.step_s()));
        assert!(summary.to_string().contains(", comes in at 0.125 s"), "{summary}");
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(thousands(1_234_567.0), "1 234 567");
        assert_eq!(thousands(123.0), "123");
    }
}
