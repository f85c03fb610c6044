//! What leaves the program as files: data here, pictures beside it.
//!
//! Every file is readable at any time, also after a crash: tables are written line by line, and
//! everything else goes to a temporary file first and takes its name when it is whole.

pub mod csv;
pub mod gif;
mod palette;
pub mod png;
pub mod summary;
pub mod surface_mesh;
pub mod vtu;

use crate::io_reason::io_reason;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The folder to write into does not exist.
    #[error("cannot {action} `{}`: the folder `{}` does not exist; create it first", path.display(), folder.display())]
    NoFolder {
        /// What was tried.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot {action} `{}`: {}", path.display(), io_reason(source))]
    Io {
        /// What was tried: `"write"`, `"create"`, ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The content could not be put into its format.
    #[error("cannot encode `{}`: {reason}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// The format library's reason.
        reason: String,
    },
}

impl ExportError {
    /// An [`ExportError::Io`], or [`ExportError::NoFolder`] if that is why; for `map_err`.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            Some(folder) if source.kind() == io::ErrorKind::NotFound && !folder.is_dir() => {
                let folder = folder.to_owned();
                Self::NoFolder { action, path, folder }
            }
            _ => Self::Io { action, path, source },
        }
    }
}

/// Creates a folder and its parents.
///
/// # Errors
/// [`ExportError::Io`] when the system refuses.
pub fn create_folder(folder: &Path) -> Result<(), ExportError> {
    std::fs::create_dir_all(folder).map_err(ExportError::io("create the folder", folder))
}

/// Writes a whole file so that a reader sees the old content or the new, never a part.
///
/// # Errors
/// [`ExportError::Io`] when the system refuses; the old file then stays as it was.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<(), ExportError> {
    if path.is_dir() {
        return Err(ExportError::io("write", path)(io::ErrorKind::IsADirectory.into()));
    }
    let partial = partial_name(path);
    let written = write_through(&partial, content).and_then(|()| std::fs::rename(&partial, path));
    written.map_err(|source| {
        // Best effort: the write has failed already, and that is what must be told.
        let _ = std::fs::remove_file(&partial);
        ExportError::io("write", path)(source)
    })
}

fn write_through(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut file = std::fs::File::create(path)?;
    file.write_all(content)?;
    file.sync_all()
}

/// What temporary names end in.
pub const PARTIAL: &str = ".partial";

/// The temporary name beside `path` under which it is written until it is whole.
#[must_use]
pub fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(PARTIAL);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_file_replaces_the_old_one_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"old").unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_refused_write_names_the_file_and_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("a.txt");
        let message = write_whole(&path, b"x").unwrap_err().to_string();
        assert!(message.contains("a.txt"), "{message}");
        assert!(message.contains("missing` does not exist; create it"), "{message}");
    }
}
