//! What the parts of a scene say about each other: names that must exist, names that must differ.

use super::super::description::{Body, BodyMaterial, GROUND, SceneDescription};
use super::super::findings::Findings;
use super::super::path;
use super::super::presets::PRESETS;
use super::super::problem::suggestion;
use super::super::tree::{Node, Origin};
use super::is_ground;
use crate::sim::{BodyMotion, bars_to_breaking};
use std::collections::BTreeSet;

/// Checks a scene whose parts have been read one by one.
pub(super) fn check(scene: &SceneDescription, root: &Node, findings: &Findings) {
    let checks = Checks { scene, root, findings };
    checks.names_differ();
    checks.materials_exist();
    checks.what_breaks_may_break();
    checks.new_materials_are_used();
    checks.neighbours_exist();
    checks.pairs_exist();
    checks.removed_bodies_exist();
    checks.pulled_bodies_follow();
    checks.ground_is_there();
    checks.camera_exists();
    checks.recording_fits();
}

struct Checks<'a> {
    scene: &'a SceneDescription,
    root: &'a Node,
    findings: &'a Findings,
}

impl Checks<'_> {
    fn report(&self, path: &str, message: String) {
        self.findings.add(path::locate(self.root, path), path, message);
    }

    fn bodies(&self) -> impl Iterator<Item = (String, &Body)> {
        let bodies = self.scene.bodies.iter().enumerate();
        bodies.map(|(index, body)| (format!("bodies[{index}]"), body))
    }

    fn names_differ(&self) {
        let mut seen: BTreeSet<String> = self.scene.ground.iter().map(|_| GROUND.to_owned()).collect();
        for (path, body) in self.bodies() {
            for name in body.names_of_copies() {
                if seen.contains(&name) && !name.is_empty() {
                    self.report(
                        &format!("{path}.name"),
                        format!("there is another body called `{name}`; names must differ"),
                    );
                }
                seen.insert(name);
            }
        }
    }

    fn materials_exist(&self) {
        for (path, body) in self.bodies() {
            let path = format!("{path}.material");
            match &body.material {
                BodyMaterial::One(name) => self.material_exists(&path, name),
                BodyMaterial::ByRegion(pairs) => {
                    for (region, name) in pairs {
                        self.material_exists(&format!("{path}.{region}"), name);
                    }
                }
            }
        }
        if let Some(ground) = &self.scene.ground {
            self.material_exists("ground.material", &ground.material);
        }
    }

    /// Some settings of a body do not go together with a material that breaks.
    fn what_breaks_may_break(&self) {
        let breaks = |name: &str| self.scene.materials.iter().any(|m| m.name == name && m.fracture.is_some());
        for (path, body) in self.bodies() {
            let BodyMotion::Deformable(kinematics) = body.motion else { continue };
            let Some(material) = body.material.names().find(|name| breaks(name)) else { continue };
            let bars = bars_to_breaking(kinematics, body.mass_scaling_max_share);
            for (key, why) in ["kinematics", "mass_scaling"].into_iter().zip(bars) {
                if let Some(why) = why {
                    let message = format!("`{material}` has a `fracture`, and a body that can break {why}");
                    self.report(&format!("{path}.{key}"), message);
                }
            }
        }
    }

    /// An override may change a material of the library, but not one that no body is of: it would be
    /// without effect.
    fn new_materials_are_used(&self) {
        let ground = self.scene.ground.iter().map(|ground| ground.material.as_str());
        let bodies = self.scene.bodies.iter().flat_map(|body| body.material.names());
        let used: Vec<&str> = bodies.chain(ground).collect();
        for material in &self.scene.materials {
            let path = format!("materials.{}", material.name);
            let new = matches!(path::locate(self.root, &path), Origin::Override(_));
            if new && !used.contains(&material.name.as_str()) {
                let hint = suggestion(&material.name, used.iter().copied());
                self.report(&path, format!("no body is of the material `{}`{hint}", material.name));
            }
        }
    }

    fn material_exists(&self, path: &str, name: &str) {
        let own = self.scene.materials.iter().map(|m| m.name.as_str());
        let names = own.chain(PRESETS.iter().map(|preset| preset.name));
        if !name.is_empty() && !names.clone().any(|known| known == name) {
            let hint = suggestion(name, names);
            self.report(path, format!("there is no material called `{name}`{hint}"));
        }
    }

    /// `on` and `axes_of` name the ground or a body above, so that placing goes from top to bottom.
    fn neighbours_exist(&self) {
        for (index, body) in self.scene.bodies.iter().enumerate() {
            let earlier = || self.scene.bodies[..index].iter().map(|body| body.name.as_str());
            let with_ground = || earlier().chain(self.scene.ground.iter().map(|_| GROUND));
            if let Some(on) = &body.placement.on {
                let known = with_ground().any(|name| name == on);
                let hint = if is_ground(on) {
                    "; add a `[ground]` to the scene".to_owned()
                } else {
                    suggestion(on, with_ground())
                };
                self.neighbour_exists(index, "on", on, known, &hint);
            }
            if let Some(axes_of) = &body.placement.axes_of {
                let known = earlier().any(|name| name == axes_of);
                let hint = suggestion(axes_of, earlier());
                self.neighbour_exists(index, "axes_of", axes_of, known, &hint);
            }
        }
    }

    fn neighbour_exists(&self, body: usize, key: &str, name: &str, known: bool, hint: &str) {
        if known {
            return;
        }
        let later = self.scene.bodies[body..].iter().any(|body| body.name == name);
        let message = if later {
            format!("`{name}` must stand above this body in the scene's text to be named here")
        } else {
            format!("there is no body called `{name}` above this one{hint}")
        };
        self.report(&format!("bodies[{body}].{key}"), message);
    }

    fn pairs_exist(&self) {
        let names = || {
            let bodies = self.scene.bodies.iter().map(|body| body.name.as_str());
            bodies.chain(self.scene.ground.iter().map(|_| GROUND))
        };
        let of_change = self.scene.contact_changes.iter().enumerate().flat_map(|(change, late)| {
            let pairs = late.change.pairs.iter().enumerate();
            pairs.map(move |(index, (pair, _))| (format!("contact_changes[{change}].pairs[{index}]"), pair))
        });
        let pairs = self.scene.contact.pairs.iter().enumerate();
        let pairs = pairs.map(|(index, (pair, _))| (format!("contact.pairs[{index}]"), pair));
        for (path, pair) in pairs.chain(of_change) {
            for (place, name) in pair.iter().enumerate() {
                let copy = self.scene.bodies.iter().flat_map(Body::names_of_copies);
                if !names().any(|known| known == name) && !copy.into_iter().any(|c| c == *name) {
                    let hint = suggestion(name, names());
                    self.report(
                        &format!("{path}.bodies[{place}]"),
                        format!("there is no body called `{name}`{hint}"),
                    );
                }
            }
        }
    }

    fn removed_bodies_exist(&self) {
        let names: Vec<String> = self.scene.bodies.iter().flat_map(Body::names_of_copies).collect();
        for (index, removal) in self.scene.removals.iter().enumerate() {
            if !names.contains(&removal.body) && !removal.body.is_empty() {
                let hint = suggestion(&removal.body, names.iter().map(String::as_str));
                let message = format!("there is no body called `{}`{hint}", removal.body);
                self.report(&format!("removals[{index}].body"), message);
            }
        }
    }

    /// Only bodies that are there and move by their own dynamics can be pulled.
    fn pulled_bodies_follow(&self) {
        let is_called = |body: &&Body, name: &str| body.names_of_copies().iter().any(|copy| copy == name);
        for (index, pull) in self.scene.pulls.iter().enumerate().filter(|(_, pull)| !pull.body.is_empty()) {
            let path = format!("pulls[{index}].body");
            match self.scene.bodies.iter().find(|body| is_called(body, &pull.body)) {
                None => {
                    let names: Vec<String> =
                        self.scene.bodies.iter().flat_map(Body::names_of_copies).collect();
                    let hint = suggestion(&pull.body, names.iter().map(String::as_str));
                    self.report(&path, format!("there is no body called `{}` that moves{hint}", pull.body));
                }
                Some(body) if !matches!(body.motion, BodyMotion::Deformable(_)) => {
                    self.report(
                        &path,
                        format!("`{}` does not move by itself and follows no pull", pull.body),
                    );
                }
                Some(body) if body.enters_s.is_some_and(|enters_s| enters_s > pull.begins_s()) => {
                    let message = format!("`{}` is grabbed before it comes in", pull.body);
                    self.report(&path, message);
                }
                Some(_) => {}
            }
        }
    }

    fn ground_is_there(&self) {
        for (index, late) in self.scene.contact_changes.iter().enumerate() {
            if !late.change.body_friction.is_empty() && self.scene.ground.is_none() {
                let message = "there is no ground; add a `[ground]` to the scene, or name a pair in `pairs`";
                self.report(&format!("contact_changes[{index}].ground_friction"), message.to_owned());
            }
        }
    }

    fn camera_exists(&self) {
        let names = self.scene.cameras.iter().map(|camera| camera.name.as_str());
        if let Some(name) = &self.scene.recording.camera
            && !names.clone().any(|known| known == name)
        {
            let hint = suggestion(name, names);
            self.report("recording.camera", format!("there is no camera called `{name}`{hint}"));
        }
    }

    fn recording_fits(&self) {
        let start_s = self.scene.recording.start_s;
        if start_s >= self.scene.duration_s && start_s > 0.0 {
            self.report(
                "recording.start",
                format!(
                    "the recording starts at {start_s} s, but the scene ends at {} s (`time.duration`)",
                    self.scene.duration_s
                ),
            );
        }
    }
}
