//! The one place that asks the scene module for scenes.

use super::failure::Failure;
use crate::sim::WorldSetup;

/// A scene ready to run.
pub struct LoadedScene {
    pub name: String,
    pub source: String,
    pub setup: WorldSetup,
    pub duration_s: f64,
    pub history_every_s: f64,
    pub notes: Vec<String>,
}

pub fn load(name: &str, _overrides: &[String]) -> Result<LoadedScene, Failure> {
    if name != "empty" {
        return Err(Failure::BadInput(format!("there is no scene `{name}`")));
    }
    Ok(LoadedScene {
        name: name.to_owned(),
        source: "built-in".to_owned(),
        setup: WorldSetup::default(),
        duration_s: 1.0,
        history_every_s: 0.1,
        notes: Vec::new(),
    })
}

pub fn built_in() -> Vec<(&'static str, String)> {
    vec![("empty", "nothing".to_owned())]
}
