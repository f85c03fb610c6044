//! Pictures as PNG files.

use crate::render::Picture;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};
use std::fs;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a picture was not written or read.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The folder to write into does not exist.
    #[error("cannot write {}: the folder {} does not exist; create it first", file.display(), folder.display())]
    NoFolder {
        /// File asked for.
        file: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot write {}: {}", file.display(), reason_of(source))]
    Write {
        /// File asked for.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The pixels do not make up a picture of that size, or one too large for the format.
    #[error("cannot write {}: {reason}", file.display())]
    Encode {
        /// File asked for.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// Plain words for the faults people meet.
fn reason_of(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "the disk is full; free some space or choose another place".into()
        }
        io::ErrorKind::PermissionDenied => "permission denied; choose a place you may write to".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only; choose another place".into(),
        io::ErrorKind::IsADirectory => "there is a folder of that name".into(),
        _ => error.to_string(),
    }
}

/// Says what is wrong with writing `file`, naming the folder if it is missing.
pub(super) fn write_error(file: &Path, source: io::Error) -> PictureError {
    let folder = folder_of(file);
    if source.kind() == io::ErrorKind::NotFound && !folder.is_dir() {
        return PictureError::NoFolder { file: file.to_owned(), folder: folder.to_owned() };
    }
    PictureError::Write { file: file.to_owned(), source }
}

fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Writes a picture as PNG. The file appears whole or not at all: what was there before is
/// replaced only when everything is written.
///
/// # Errors
/// [`PictureError`], in words for the user.
pub fn write_png(path: &Path, picture: &Picture) -> Result<(), PictureError> {
    let bytes = encode(path, picture)?;
    if path.is_dir() {
        return Err(write_error(path, io::ErrorKind::IsADirectory.into()));
    }
    let unfinished = unfinished_name(path);
    write_through(&unfinished, &bytes).and_then(|()| fs::rename(&unfinished, path)).map_err(|source| {
        // Nothing half-written stays; if it cannot be removed, the first error says more.
        let _ = fs::remove_file(&unfinished);
        write_error(path, source)
    })
}

/// The file's name with `.part` added, in the same folder so that renaming is atomic.
fn unfinished_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}

fn write_through(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = BufWriter::new(fs::File::create(path)?);
    file.write_all(bytes)?;
    file.into_inner().map_err(|error| error.into_error())?.sync_all()
}

fn encode(path: &Path, picture: &Picture) -> Result<Vec<u8>, PictureError> {
    let failed = |reason: String| PictureError::Encode { file: path.to_owned(), reason };
    let pixels = picture.width as usize * picture.height as usize;
    if pixels == 0 || picture.rgba.len() != 4 * pixels {
        return Err(failed(format!(
            "{} bytes are no picture of {}x{} pixels",
            picture.rgba.len(),
            picture.width,
            picture.height
        )));
    }
    let rgb: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(&rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}
