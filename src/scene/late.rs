//! Bodies that come in and go out on the way, as text below a scene: what the viewer throws is written down in the
//! same words in which a scene file says it, and built from them, so that a saved scene gives the same bytes.

use super::description::BodyMaterial;
use super::{Scene, SceneError};
use crate::sim::{Change, ContactChange, ContactMethod, Entrance, Pull};
use glam::DVec3;
use std::fmt::Write as _;
use toml_edit::Table;

/// What comes in.
#[derive(Clone, Debug, PartialEq)]
pub enum Newcomer {
    /// A built-in shape.
    Shape {
        /// The `shape` of the scene file, an inline table.
        shape: String,
        /// Name of its material.
        material: String,
        /// Its colour, sRGB 0..1.
        color_srgb: [f32; 3],
    },
    /// The same as a body of the scene, by name.
    CopyOf(String),
}

/// How and when it comes in.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// Name of the new body.
    pub name: String,
    /// Where its middle is, m.
    pub position_m: DVec3,
    /// Axis about which it is turned; of any length.
    pub axis: DVec3,
    /// By how much, degrees.
    pub angle_degrees: f64,
    /// m/s.
    pub velocity_m_s: DVec3,
    /// rad/s.
    pub spin_rad_s: DVec3,
    /// When, s.
    pub time_s: f64,
}

/// Keys of a body that say where it is, how it starts or what holds it: a copy has its own or none.
const OWN_KEYS: [&str; 11] = [
    "name", "position", "rotation", "on", "gap", "axes_of", "copies", "velocity", "spin", "boundary",
    "enters",
];

impl Scene {
    /// The scene with a body that comes in later, that body as built, and the text that was added.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with what is wrong with it.
    pub fn with_arrival(
        &self,
        newcomer: &Newcomer,
        arrival: &Arrival,
    ) -> Result<(Self, Entrance, String), SceneError> {
        let mut text = match newcomer {
            Newcomer::Shape { shape, material, color_srgb } => {
                format!(
                    "[[bodies]]\nshape = {shape}\nmaterial = {material:?}\ncolor = {}\n",
                    hex(*color_srgb)
                )
            }
            Newcomer::CopyOf(body) => {
                let entry = self.entry_of(body).and_then(|entry| self.document.body(entry));
                format!("[[bodies]]\n{}", entry.map(copied_keys).unwrap_or_default())
            }
        };
        text.push_str(&arrival.to_toml());
        let scene = self.with_text(&text)?;
        let is_new = |change: &Change| match change {
            Change::Enter(entrance) if entrance.body.name == arrival.name => Some((**entrance).clone()),
            _ => None,
        };
        // The text names the body, so that the scene that was built from it has it.
        let body = scene.setup.changes.iter().find_map(|planned| is_new(&planned.change));
        let body = body.ok_or_else(|| super::not_found(&arrival.name))?;
        Ok((scene, body, text))
    }

    /// The scene with a body taken out at a time, s, and the text that was added.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] when there is no such body.
    pub fn with_removal(&self, body: &str, time_s: f64) -> Result<(Self, String), SceneError> {
        let text = format!("[[removals]]\nbody = {body:?}\nat = {time_s:?}\n");
        Ok((self.with_text(&text)?, text))
    }

    /// The entry of the text that a body of the world comes from.
    #[must_use]
    pub fn entry_of(&self, body: &str) -> Option<usize> {
        self.description
            .bodies
            .iter()
            .position(|entry| entry.names_of_copies().iter().any(|name| name == body))
    }

    /// Materials that a thrown body of its own shape may be of.
    #[must_use]
    pub fn body_materials(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for body in &self.description.bodies {
            let BodyMaterial::One(name) = &body.material else { continue };
            if !names.contains(&name.as_str()) {
                names.push(name.as_str());
            }
        }
        names
    }
}

impl Arrival {
    fn to_toml(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "name = {:?}", self.name);
        let _ = writeln!(text, "position = {}", vector(self.position_m));
        if self.angle_degrees != 0.0 {
            let (axis, degrees) = (vector(self.axis), self.angle_degrees);
            let _ = writeln!(text, "rotation = {{ axis = {axis}, degrees = {degrees:?} }}");
        }
        let _ = writeln!(text, "velocity = {}", vector(self.velocity_m_s));
        let _ = writeln!(text, "spin = {}", vector(self.spin_rad_s));
        let _ = writeln!(text, "enters = {:?}", self.time_s);
        text
    }
}

/// A change of contact as the scene file has it.
#[must_use]
pub fn contact_change_text(change: &ContactChange, time_s: f64) -> String {
    let mut text = format!("[[contact_changes]]\nat = {time_s:?}\n");
    let mut line = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    if let Some(friction) = change.friction_coefficient {
        line("friction", format!("{friction:?}"));
    }
    for (body, friction) in &change.body_friction {
        debug_assert_eq!(body, super::description::GROUND);
        line("ground_friction", format!("{friction:?}"));
    }
    if let Some(own) = change.self_collision {
        line("self_collision", own.to_string());
    }
    if let Some(speed_m_s) = change.rest_speed_m_s {
        line("rest_speed", speed_m_s.map_or("\"derived\"".to_owned(), |speed_m_s| format!("{speed_m_s:?}")));
    }
    if let Some(method) = change.method {
        method_lines(method).into_iter().for_each(|(key, value)| line(key, value));
    }
    if !change.pairs.is_empty() {
        let pair = |([a, b], friction): &([String; 2], f64)| {
            format!("{{ bodies = [{a:?}, {b:?}], friction = {friction:?} }}")
        };
        let pairs: Vec<String> = change.pairs.iter().map(pair).collect();
        line("pairs", format!("[{}]", pairs.join(", ")));
    }
    text
}

fn method_lines(method: ContactMethod) -> Vec<(&'static str, String)> {
    match method {
        ContactMethod::Lagrange { passes, tolerance, conserve_impact_energy } => {
            let impact = if conserve_impact_energy { "elastic" } else { "plastic" };
            vec![
                ("method", "\"lagrange\"".to_owned()),
                ("passes", passes.to_string()),
                ("tolerance", format!("{tolerance:?}")),
                ("impact", format!("{impact:?}")),
            ]
        }
        ContactMethod::Penalty { stiffness_n_m } => {
            vec![("method", "\"penalty\"".to_owned()), ("penalty_stiffness", format!("{stiffness_n_m:?}"))]
        }
    }
}

/// A pull as the scene file has it; one that has not let go yet does so at the end of its path.
#[must_use]
pub fn pull_text(pull: &Pull) -> String {
    let mut text = format!("[[pulls]]\nbody = {:?}\nat = {}\n", pull.body, vector(pull.at_m));
    let _ = writeln!(text, "follow = {:?}", pull.follow_s);
    if pull.until_s.is_finite() {
        let _ = writeln!(text, "until = {:?}", pull.until_s);
    }
    text.push_str("path = [\n");
    for point in &pull.path {
        let _ = writeln!(text, "    {{ time = {:?}, point = {} }},", point.time_s, vector(point.point_m));
    }
    text.push_str("]\n");
    text
}

/// Every digit, so that reading gives the same number.
fn vector(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

fn hex(color_srgb: [f32; 3]) -> String {
    let [r, g, b] = color_srgb.map(|level| (level.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("\"#{r:02x}{g:02x}{b:02x}\"")
}

/// The keys of a body that a copy has in common with it.
fn copied_keys(body: &Table) -> String {
    let keys = body.iter().filter(|(key, _)| !OWN_KEYS.contains(key));
    let lines = keys.filter_map(|(key, item)| {
        let value = item.clone().into_value().ok()?;
        Some(format!("{key} = {}\n", value.to_string().trim()))
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::World;

    fn arrival(name: &str, time_s: f64) -> Arrival {
        Arrival {
            name: name.to_owned(),
            position_m: DVec3::new(0.1, -0.2, 1.0 / 3.0),
            axis: DVec3::X,
            angle_degrees: 40.0,
            velocity_m_s: DVec3::new(0.0, 0.0, -1.0),
            spin_rad_s: DVec3::new(0.1, 3.0, 0.0),
            time_s,
        }
    }

    #[test]
    fn a_late_body_comes_in_when_it_is_due_and_goes_again() {
        let scene = Scene::load("bounce", &[]).unwrap();
        let name = scene.setup.bodies.last().unwrap().name.clone();
        let (scene, entrance, _) =
            scene.with_arrival(&Newcomer::CopyOf(name.clone()), &arrival("late", 0.01)).unwrap();
        assert_eq!(entrance.body.mesh.tets.len(), scene.setup.bodies.last().unwrap().mesh.tets.len());
        let (scene, _) = scene.with_removal("late", 0.02).unwrap();
        let saved = Scene::from_text("saved", &scene.to_toml(), scene.folder(), &[]).unwrap();
        assert_eq!(saved.setup, scene.setup);
        let mut world = World::new(saved.setup.clone()).unwrap();
        let before = world.body_count();
        let (mut balance_j, mut external_j) = (Vec::new(), 0.0);
        for moment in 1..=30 {
            let until_s = 1e-3 * f64::from(moment);
            while world.time_s() < until_s {
                world.step(until_s).unwrap();
            }
            balance_j.push(world.sample().balance_j());
            external_j = world.sample().external_work_j.abs().max(external_j);
            assert_eq!(world.body_count() - before, usize::from(moment > 10), "{moment}");
        }
        assert!(world.is_removed(before));
        assert!(world.publish().bodies[before].positions_m.is_empty());
        let is_kept = balance_j.iter().all(|sum_j| (sum_j - balance_j[0]).abs() < 1e-9);
        assert!(is_kept && external_j > 0.0, "{balance_j:?}");
    }

    #[test]
    fn a_shape_comes_in_with_the_same_digits_after_saving() {
        let scene = Scene::load("bounce", &[]).unwrap();
        let newcomer = Newcomer::Shape {
            shape: "{ type = \"ball\", radius = 0.05 }".to_owned(),
            material: scene.description.materials[0].name.clone(),
            color_srgb: [0.5, 0.25, 0.1],
        };
        let (scene, body, _) = scene.with_arrival(&newcomer, &arrival("another", 1.0 / 7.0)).unwrap();
        let saved = Scene::from_text("saved", &scene.to_toml(), scene.folder(), &[]).unwrap();
        assert!(matches!(&saved.setup.changes[0].change, Change::Enter(again) if **again == body));
        assert_eq!(saved.setup.changes[0].time_s, 1.0 / 7.0);
    }
}
