//! What can be wrong with a scene, and how it is told.

use crate::io_reason::io_reason;
use std::fmt;
use std::path::{Path, PathBuf};

/// Where in the input a problem sits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// A place in the scene's text, both numbers counted from 1, the column in characters.
    Line {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
    },
    /// An override, as it was typed after `--set`.
    Override(String),
}

/// One thing that is wrong with a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub location: Location,
    /// Path of the value, as `--set` takes it (`materials.glass.density`); empty for the whole scene.
    pub path: String,
    /// What is wrong and what to do, one sentence or two.
    pub message: String,
}

impl Problem {
    /// The place and the message, as in `fall.toml:12:5: ...`; `scene` is what messages call the scene.
    #[must_use]
    pub fn in_scene(&self, scene: &str) -> String {
        match &self.location {
            Location::Line { line, column } => format!("{scene}:{line}:{column}: {}", self.message),
            Location::Override(text) => format!("--set {text}: {}", self.message),
        }
    }
}

/// Why a scene cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// Neither a built-in scene nor a file.
    #[error("there is no scene `{asked}`: it is neither a built-in scene nor a file{hint}")]
    NotFound {
        /// What was asked for.
        asked: String,
        /// The nearest name, and where to find them all.
        hint: String,
    },
    /// A file of another kind.
    #[error("`{}` is not a scene file: scene files end in .toml{}", path.display(), mesh_hint(path))]
    NotAScene {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("cannot read the scene file `{}`: {}", path.display(), io_reason(source))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The scene is wrong; every problem that could be found is listed.
    #[error("{}", ProblemList { scene: scene.as_str(), problems: problems.as_slice() })]
    Invalid {
        /// The scene's file or name.
        scene: String,
        /// The problems, in the order of the text; at least one.
        problems: Vec<Problem>,
    },
}

impl SceneError {
    /// The problems of the text; empty when the text was never read.
    #[must_use]
    pub fn problems(&self) -> &[Problem] {
        match self {
            Self::Invalid { problems, .. } => problems,
            _ => &[],
        }
    }
}

struct ProblemList<'a> {
    scene: &'a str,
    problems: &'a [Problem],
}

impl fmt::Display for ProblemList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.problems.len() {
            1 => write!(f, "the scene has a problem:")?,
            count => write!(f, "the scene has {count} problems:")?,
        }
        for problem in self.problems {
            write!(f, "\n  {}", problem.in_scene(self.scene))?;
        }
        Ok(())
    }
}

/// How a mesh gets into a scene, for whoever takes one for a scene.
fn mesh_hint(path: &Path) -> String {
    const MESHES: [&str; 3] = ["msh", "vtk", "mesh"];
    let ending = path.extension().unwrap_or_default();
    if !MESHES.iter().any(|known| ending.eq_ignore_ascii_case(known)) {
        return String::new();
    }
    format!(
        ". A body of a scene takes a mesh by `mesh.file = {:?}`; `hammerfall check` says whether it is sound",
        path.file_name().unwrap_or_default().to_string_lossy()
    )
}

/// The candidate nearest to `wanted`, when it is near enough to be a slip of the hand.
#[must_use]
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    let length = wanted.chars().count();
    let allowed = if length <= 3 { length / 2 } else { (length / 3).max(2) };
    candidates
        .into_iter()
        .map(|candidate| (distance(&wanted, &candidate.to_lowercase()), candidate))
        .filter(|&(distance, _)| distance <= allowed)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Edits from one word to the other; a word that the other contains counts as one edit away.
fn distance(wanted: &str, candidate: &str) -> usize {
    let edits = strsim::damerau_levenshtein(wanted, candidate);
    let contained = wanted.len() >= 3 && candidate.len() >= 3;
    if contained && (candidate.contains(wanted) || wanted.contains(candidate)) { edits.min(1) } else { edits }
}

/// `; did you mean `x`?`, or the list of what there is, or nothing when there is nothing.
pub(super) fn suggestion<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(name) = nearest(wanted, candidates.clone()) {
        return format!("; did you mean `{name}`?");
    }
    let mut names: Vec<String> = candidates.into_iter().map(|n| format!("`{n}`")).collect();
    names.dedup();
    if names.is_empty() { String::new() } else { format!("; there is {}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_find_their_name_and_strangers_do_not() {
        let names = ["density", "youngs_modulus", "color"];
        assert_eq!(nearest("densty", names), Some("density"));
        assert_eq!(nearest("young", names), Some("youngs_modulus"));
        assert_eq!(nearest("Colour", names), Some("color"));
        assert_eq!(nearest("zzz", names), None);
        // Two letters that changed places are one slip.
        assert_eq!(nearest("veiw", ["verify", "view", "render"]), Some("view"));
    }
}
