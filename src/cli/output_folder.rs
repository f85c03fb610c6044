//! Where a run writes, and what may be replaced there.
//!
//! Running the same command again replaces what the earlier run wrote. A folder with files of the
//! same names that another program wrote is left alone, unless the user insists.

use super::console::Console;
use super::failure::Failure;
use crate::export::summary::{PROGRAM, SUMMARY_FILE};
use crate::export::vtu::{COLLECTION_FILE, FRAME_FOLDER};
use crate::export::{PARTIAL, create_folder, partial_name};
use crate::io_reason::io_reason;
use std::path::{Path, PathBuf};

/// Name of the table of balances.
pub const HISTORY_FILE: &str = "history.csv";

/// Makes `folder` ready for a run: creates it, removes what an earlier run left.
///
/// # Errors
/// [`Failure::BadInput`] when the folder cannot be used or holds files that are not ours.
pub fn prepare_for_run(folder: &Path, force: bool, console: &Console) -> Result<(), Failure> {
    create_folder(folder).map_err(|error| Failure::from(error).before_the_run())?;
    let in_the_way = earlier_files(folder);
    if in_the_way.is_empty() {
        return Ok(());
    }
    if !force && !is_ours(folder) {
        return Err(foreign(folder, &in_the_way));
    }
    console.note(format_args!("replacing the earlier run in `{}`", folder.display()));
    in_the_way.iter().try_for_each(|file| remove(file))
}

/// Files in `folder` with names that a run writes.
fn earlier_files(folder: &Path) -> Vec<PathBuf> {
    [HISTORY_FILE, SUMMARY_FILE, COLLECTION_FILE]
        .into_iter()
        .map(|name| folder.join(name))
        .flat_map(|path| [partial_name(&path), path])
        .filter(|path| path.exists())
        .chain(numbered_files(&folder.join(FRAME_FOLDER), "frame-", ".vtu"))
        .collect()
}

/// The files `PREFIX` digits `SUFFIX` of a folder, by name, also those that a killed program left unfinished under their
/// temporary names; none when there is no folder.
pub fn numbered_files(folder: &Path, prefix: &str, suffix: &str) -> Vec<PathBuf> {
    let is_numbered = |name: &str| {
        let name = name.strip_suffix(PARTIAL).unwrap_or(name);
        name.strip_prefix(prefix)
            .and_then(|rest| rest.strip_suffix(suffix))
            .is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.file_name().to_str().is_some_and(is_numbered))
        .map(|entry| entry.path())
        .collect();
    files.sort();
    files
}

/// Whether the summary in `folder` says that we wrote it.
fn is_ours(folder: &Path) -> bool {
    let read = std::fs::read(folder.join(SUMMARY_FILE)).ok();
    let summary: Option<serde_json::Value> = read.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    summary.is_some_and(|summary| summary["program"] == PROGRAM)
}

fn foreign(folder: &Path, files: &[PathBuf]) -> Failure {
    let first = files[0].file_name().unwrap_or_default().display();
    let others = match files.len() - 1 {
        0 => String::new(),
        more => format!(" and {more} more that a run would replace"),
    };
    Failure::BadInput(format!(
        "`{}` already holds `{first}`{others}, not from an earlier run of hammerfall; choose \
         another folder, or add --force to replace",
        folder.display()
    ))
}

/// Removes a file that is about to be written anew.
///
/// # Errors
/// [`Failure::BadInput`] when the system refuses.
pub fn remove(file: &Path) -> Result<(), Failure> {
    std::fs::remove_file(file).map_err(|error| {
        let reason = io_reason(&error);
        Failure::BadInput(format!("cannot replace `{}`: {reason}", file.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quiet() -> Console {
        Console::new(true)
    }

    #[test]
    fn an_earlier_run_is_replaced_and_other_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at(FRAME_FOLDER)).unwrap();
        let ours = [
            HISTORY_FILE,
            COLLECTION_FILE,
            "run.pvd.partial",
            "frames/frame-000003.vtu",
            "frames/frame-000004.vtu.partial",
        ];
        let others = ["notes.txt", "frames/frame-x.vtu", "frames/mine.vtu"];
        for name in ours.iter().chain(&others) {
            std::fs::write(at(name), "").unwrap();
        }
        std::fs::write(at(SUMMARY_FILE), r#"{"program": "hammerfall"}"#).unwrap();
        prepare_for_run(folder.path(), false, &quiet()).unwrap();
        assert!(ours.iter().all(|name| !at(name).exists()));
        assert!(others.iter().all(|name| at(name).exists()));
    }

    #[test]
    fn files_of_others_are_replaced_only_by_force() {
        let folder = tempfile::tempdir().unwrap();
        let history = folder.path().join(HISTORY_FILE);
        std::fs::write(&history, "my sales figures").unwrap();
        std::fs::write(folder.path().join(SUMMARY_FILE), "{}").unwrap();
        let refused = prepare_for_run(folder.path(), false, &quiet());
        assert!(matches!(refused, Err(Failure::BadInput(text)) if text.contains("--force")));
        assert!(history.exists());
        prepare_for_run(folder.path(), true, &quiet()).unwrap();
        assert!(!history.exists());
    }
}
