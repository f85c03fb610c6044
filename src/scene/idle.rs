//! What a scene plans that can never happen: it may be run, but is surely not what was meant.

use super::description::{Body, SceneDescription};
use crate::sim::{BodySetup, FractureParameters};

/// Everything that can never act in a scene, whose bodies `bodies` are: (path, message) of each.
pub(super) fn doubts(scene: &SceneDescription, bodies: &[BodySetup]) -> Vec<(String, String)> {
    let idle = Idle { scene };
    let mut found = idle.entrances();
    found.extend(idle.removals());
    found.extend(idle.contact_changes());
    found.extend(idle.pulls());
    found.extend(idle.color_range());
    found.extend(idle.fracture(bodies));
    found
}

struct Idle<'a> {
    scene: &'a SceneDescription,
}

impl Idle<'_> {
    /// Why nothing happens at a time, if it is beyond the end.
    fn beyond_the_end(&self, at_s: f64) -> Option<String> {
        let end_s = self.scene.duration_s;
        (at_s >= end_s).then(|| format!("at {at_s} s, but the scene ends at {end_s} s (`time.duration`)"))
    }

    fn body(&self, name: &str) -> Option<&Body> {
        self.scene.bodies.iter().find(|body| body.names_of_copies().iter().any(|copy| copy == name))
    }

    /// When a body comes in, s.
    fn enters_s(&self, name: &str) -> f64 {
        self.body(name).and_then(|body| body.enters_s).unwrap_or(0.0)
    }

    /// When a body is taken out, s; nobody is before he has come in.
    fn leaves_s(&self, name: &str) -> f64 {
        let enters_s = self.enters_s(name);
        let own = self.scene.removals.iter();
        let own = own.filter(|removal| removal.body == name && removal.at_s >= enters_s);
        own.map(|removal| removal.at_s).fold(f64::INFINITY, f64::min)
    }

    fn entrances(&self) -> Vec<(String, String)> {
        let late = |(index, body): (usize, &Body)| {
            let why = self.beyond_the_end(body.enters_s?)?;
            let message = format!("`{}` never comes in: that would be {why}", body.name);
            Some((format!("bodies[{index}].enters"), message))
        };
        self.scene.bodies.iter().enumerate().filter_map(late).collect()
    }

    fn removals(&self) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for (index, removal) in self.scene.removals.iter().enumerate() {
            let path = format!("removals[{index}]");
            let enters_s = self.enters_s(&removal.body);
            let message = if let Some(why) = self.beyond_the_end(removal.at_s) {
                format!("`{path}` never acts: it is {why}")
            } else if removal.at_s < enters_s {
                format!(
                    "`{path}` never acts: `{}` is to be taken out at {} s, but comes in only at {enters_s} s",
                    removal.body, removal.at_s
                )
            } else {
                continue;
            };
            found.push((format!("{path}.at"), message));
        }
        found
    }

    fn color_range(&self) -> Option<(String, String)> {
        let recording = &self.scene.recording;
        recording.color_range.filter(|_| !recording.color_by.has_values())?;
        let message = format!(
            "`recording.color_range` has no effect: colours by {} have no values; choose a field with \
             `recording.color_by`, for example \"von-mises\"",
            recording.color_by.name()
        );
        Some(("recording.color_range".to_owned(), message))
    }

    fn fracture(&self, bodies: &[BodySetup]) -> Option<(String, String)> {
        let settings = &self.scene.fracture;
        let mut breaking = bodies.iter().filter(|body| body.can_break()).peekable();
        if breaking.peek().is_none() {
            let message =
                "`fracture` has no effect: nothing that moves is of a material with a `fracture`".to_owned();
            return (*settings != FractureParameters::default()).then(|| ("fracture".to_owned(), message));
        }
        let most = settings.max_elements?;
        let full = breaking.find(|body| body.mesh.tets.len() > most as usize)?;
        let message = format!(
            "`fracture.max_elements` is {most}, but `{}` begins with {} elements: its cracks can only run along the faces \
             there are",
            full.name,
            full.mesh.tets.len()
        );
        Some(("fracture.max_elements".to_owned(), message))
    }

    fn contact_changes(&self) -> Vec<(String, String)> {
        let changes = self.scene.contact_changes.iter().enumerate();
        let late = changes.filter_map(|(index, late)| {
            let path = format!("contact_changes[{index}]");
            let why = self.beyond_the_end(late.at_s)?;
            Some((format!("{path}.at"), format!("`{path}` never acts: it is {why}")))
        });
        late.collect()
    }

    fn pulls(&self) -> Vec<(String, String)> {
        let mut found = Vec::new();
        for (index, pull) in self.scene.pulls.iter().enumerate() {
            let path = format!("pulls[{index}]");
            let leaves_s = self.leaves_s(&pull.body);
            let message = if let Some(why) = self.beyond_the_end(pull.begins_s()) {
                format!("`{path}` never acts: it begins {why}")
            } else if leaves_s <= pull.begins_s() {
                format!(
                    "`{path}` never acts: it begins at {} s, but `{}` is taken out at {leaves_s} s",
                    pull.begins_s(),
                    pull.body
                )
            } else {
                continue;
            };
            found.push((format!("{path}.path"), message));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scene;

    fn warnings(more: &str) -> Vec<String> {
        let text = format!("{}\n{more}", include_str!("../../assets/scenes/bounce.toml"));
        Scene::from_text("b.toml", &text, std::path::Path::new("."), &[]).unwrap().warnings
    }

    #[test]
    fn what_can_never_act_is_warned_about() {
        let pull = |time: f64| {
            format!(
                "[[pulls]]\nbody = \"ball\"\nat = [0, 0, 1]\npath = [{{ time = {time}, point = [0, 0, 1] }}, \
                 {{ time = {}, point = [0, 0, 2] }}]\n",
                time + 0.1
            )
        };
        let removal = |at: f64| format!("[[removals]]\nbody = \"ball\"\nat = {at}\n");
        let change = |at: f64| format!("[[contact_changes]]\nat = {at}\nfriction = 0.2\n");
        let sound = [pull(0.1), removal(0.3), change(0.1)].concat();
        assert_eq!(warnings(&sound), [""; 0]);
        for (text, part) in [
            (pull(500.0), "`pulls[0]` never acts: it begins at 500 s, but the scene ends"),
            (removal(500.0), "`removals[0]` never acts: it is at 500 s, but the scene ends"),
            (change(500.0), "`contact_changes[0]` never acts: it is at 500 s, but the scene ends"),
            (format!("{}{}", removal(0.1), pull(0.2)), "but `ball` is taken out at 0.1 s"),
        ] {
            let found = warnings(&text);
            assert!(found.len() == 1 && found[0].contains(part), "{found:?}");
            assert!(found[0].starts_with("b.toml:"), "{found:?}");
        }
    }

    #[test]
    fn limits_of_cracks_that_do_nothing_are_warned_about() {
        let warnings = |scene: &str, set: &str| Scene::load(scene, &[set.to_owned()]).unwrap().warnings;
        let idle = warnings("bounce", "fracture.crack_speed=5");
        assert!(idle.len() == 1 && idle[0].contains("`fracture` has no effect"), "{idle:?}");
        let full = warnings("cube-wall", "fracture.max_elements=4");
        assert!(full.len() == 1 && full[0].contains("but `cube` begins with 5 elements"), "{full:?}");
        assert_eq!(warnings("cube-wall", "fracture.max_elements=5"), [""; 0]);
    }

    #[test]
    fn a_removal_that_never_acts_takes_nobody_from_a_pull() {
        let late = "[[removals]]\nbody = \"ball\"\nat = 0.1\n[[pulls]]\nbody = \"ball\"\nat = [0, 0, 1]\n\
                    path = [{ time = 0.3, point = [0, 0, 1] }, { time = 0.4, point = [0, 0, 2] }]\n";
        let text = format!("{}\n{late}", include_str!("../../assets/scenes/bounce.toml"));
        let late = ["bodies[0].enters=0.2".to_owned()];
        let found = Scene::from_text("b.toml", &text, std::path::Path::new("."), &late).unwrap().warnings;
        assert!(found.len() == 1 && found[0].contains("`removals[0]` never acts"), "{found:?}");
    }

    #[test]
    fn a_colour_range_without_values_is_warned_about() {
        let warnings = |color_by: &str| {
            let overrides =
                [format!("recording.color_by={color_by}"), "recording.color_range=[0, 1]".to_owned()];
            Scene::load("bounce", &overrides).unwrap().warnings
        };
        assert_eq!(warnings("speed"), [""; 0]);
        let found = warnings("body");
        assert!(found.len() == 1 && found[0].contains("colours by body have no values"), "{found:?}");
    }

    #[test]
    fn a_body_that_comes_in_after_the_end_is_warned_about() {
        let late = |overrides: &[&str]| {
            let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
            Scene::load("bounce", &overrides).unwrap().warnings
        };
        assert_eq!(late(&["bodies[0].enters=0.1"]), [""; 0]);
        let found = late(&["bodies[0].enters=77"]);
        assert!(
            found.len() == 1
                && found[0].contains("never comes in: that would be at 77 s, but the scene ends"),
            "{found:?}"
        );
    }
}
