//! Scenes: from TOML text to what the simulation starts from.
//!
//! ```text
//!   text ──document──▶ tree ──parse──▶ SceneDescription ──build──▶ WorldSetup
//!          (+ --set)          (reader)                  (shapes, place, selection, overlap)
//! ```
//!
//! [`Scene::load`] does it all. Every stage collects all its problems and says where in the text (or in
//! which override) each of them sits.

mod apart;
mod build;
pub mod description;
mod document;
mod findings;
mod idle;
mod late;
mod library;
mod parse;
mod path;
mod place;
mod plausible;
mod presets;
mod problem;
mod quantity;
mod reader;
mod selection;
mod settle;
mod shape;
mod shape_mesh;
mod summary;
mod tree;

pub use description::SceneDescription;
pub use document::SceneDocument;
pub use late::{Arrival, Newcomer, contact_change_text, pull_text};
pub use library::{BUILTIN_SCENES, BuiltinScene};
pub use presets::{PRESETS, Preset};
pub use problem::{Location, Problem, SceneError, nearest};
pub use shape::{MeshFile, Shape};
pub use summary::{BodySummary, SceneSummary};

use crate::fracture::Criterion;
use crate::sim::WorldSetup;
use findings::{Finding, Findings};
use std::path::{Path, PathBuf};

/// A scene, checked and ready to run.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of a built-in scene, or a file's name without its ending.
    pub name: String,
    /// What the text says: title, cameras, recording and everything else.
    pub description: SceneDescription,
    /// What the simulation starts from.
    pub setup: WorldSetup,
    /// What reading mesh files had to say: (body, note).
    pub notes: Vec<(String, String)>,
    /// What can be run but looks like a slip, each with its place: `fall.toml:12:5: ...`.
    pub warnings: Vec<String>,
    document: SceneDocument,
    folder: PathBuf,
}

impl Scene {
    /// Loads a built-in scene by its name, or a file by its path, with overrides (`path=value`) on top.
    ///
    /// # Errors
    /// [`SceneError`]: no such scene, an unreadable file, or everything that is wrong in it.
    pub fn load(name_or_path: &str, overrides: &[String]) -> Result<Self, SceneError> {
        if let Some(builtin) = library::find(name_or_path) {
            return Self::from_text(builtin.name, builtin.text, Path::new("."), overrides);
        }
        let path = Path::new(name_or_path);
        if !path.exists() {
            return Err(not_found(name_or_path));
        }
        let is_toml = path.extension().is_none_or(|ending| ending.eq_ignore_ascii_case("toml"));
        if !is_toml && path.is_file() {
            return Err(SceneError::NotAScene { path: path.to_owned() });
        }
        let text = std::fs::read_to_string(path)
            .map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
        let folder = path.parent().unwrap_or(Path::new("."));
        Self::from_text(name_or_path, &text, folder, overrides)
    }

    /// The same from text in memory. `label` is what messages call it; mesh files are looked for from
    /// `folder`.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with everything that is wrong.
    pub fn from_text(
        label: &str,
        text: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, SceneError> {
        let document = SceneDocument::parse(label, text)?;
        Self::from_document(document, folder, overrides)
    }

    /// What a text with overrides on top says, read and checked value by value, before any mesh is made or mesh file
    /// looked for.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with everything that is wrong so far.
    pub fn describe(label: &str, text: &str, overrides: &[String]) -> Result<SceneDescription, SceneError> {
        let mut document = SceneDocument::parse(label, text)?;
        let Reading { description, problems, .. } = Reading::of(&mut document, overrides);
        if problems.is_empty() { Ok(description) } else { Err(document.invalid(problems)) }
    }

    /// This scene with further overrides on top: what a slider of the viewer does.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with everything that is wrong; this scene stays as it is.
    pub fn with_overrides(&self, overrides: &[String]) -> Result<Self, SceneError> {
        Self::from_document(self.document.clone(), &self.folder, overrides)
    }

    /// This scene with more text below it: a body that was thrown, one that was taken out. Overrides become text.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with everything that is wrong; this scene stays as it is.
    pub fn with_text(&self, added: &str) -> Result<Self, SceneError> {
        let text = format!("{}\n\n{added}", self.document.to_toml().trim_end());
        let document = SceneDocument::parse(self.document.label(), &text)?;
        Self::from_document(document, &self.folder, &[])
    }

    /// The scene as TOML, overrides, comments and all: loading it again gives the same scene.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.document.to_toml()
    }

    /// The folder that relative paths of mesh files start at.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The overrides that were applied.
    #[must_use]
    pub fn overrides(&self) -> &[String] {
        self.document.overrides()
    }

    fn from_document(
        mut document: SceneDocument,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, SceneError> {
        let Reading { description, mut problems, is_readable } = Reading::of(&mut document, overrides);
        // With values that stand in for wrong ones, building would find what is not there.
        if !is_readable {
            return Err(document.invalid(problems));
        }
        let built = build::build(&description, folder).unwrap_or_else(|found| {
            problems.extend(located(&document, found));
            build::Built::default()
        });
        if !problems.is_empty() {
            return Err(document.invalid(problems));
        }
        let mut doubts = plausible::doubts(&description);
        doubts.extend(idle::doubts(&description, &built.setup.bodies));
        let doubts = document.problems(located(&document, doubts));
        Ok(Self {
            name: short_name(document.label()),
            warnings: doubts.iter().map(|doubt| doubt.in_scene(document.label())).collect(),
            description,
            setup: built.setup,
            notes: built.notes,
            document,
            folder: folder.to_owned(),
        })
    }
}

/// What [`parse_criterion`] adds to the columns of the first line.
pub const CRITERION_COLUMN: usize = parse::CRITERION_PREFIX.len();

/// Reads a failure criterion by itself, written as the `fracture` of a material in a scene:
/// `{ criterion = "tresca", shear_strength = 5e6 }`. `label` is what messages call it.
///
/// # Errors
/// [`SceneError::Invalid`] with everything that is wrong; columns of the first line count from
/// [`CRITERION_COLUMN`].
pub fn parse_criterion(label: &str, table: &str) -> Result<Criterion, SceneError> {
    parse::parse_criterion(label, table)
}

/// What a document says, and everything that is wrong with it before anything is built.
struct Reading {
    description: SceneDescription,
    problems: Vec<Finding>,
    /// Whether every value could be read; else others stand in for them.
    is_readable: bool,
}

impl Reading {
    /// Of a document with overrides on top.
    fn of(document: &mut SceneDocument, overrides: &[String]) -> Self {
        let mut problems = document.try_apply(overrides);
        let findings = Findings::default();
        let mut description = parse::read_scene(document.root(), &findings);
        let is_readable = problems.is_empty() && findings.is_empty();
        parse::check_whole(&mut description, document.root(), &findings);
        problems.extend(findings.into_problems());
        Self { description, problems, is_readable }
    }
}

/// Findings whose paths are turned into places.
fn located(document: &SceneDocument, found: Vec<(String, String)>) -> Vec<Finding> {
    let found = found.into_iter();
    found.map(|(path, message)| Finding { origin: document.locate(&path), path, message }).collect()
}

fn short_name(label: &str) -> String {
    let stem = Path::new(label).file_stem();
    stem.map_or_else(|| label.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn not_found(asked: &str) -> SceneError {
    let names = BUILTIN_SCENES.iter().map(|scene| scene.name);
    let hint = match problem::nearest(asked, names) {
        Some(name) => format!("; did you mean `{name}`?"),
        None => "; `hammerfall scenes` lists the built-in ones".to_owned(),
    };
    SceneError::NotFound { asked: asked.to_owned(), hint }
}
