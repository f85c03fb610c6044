//! Where `render` puts its pictures: one PNG, a GIF, or a folder of numbered PNGs.

use super::console::Console;
use super::failure::Failure;
use super::output_folder::{numbered_files, remove};
use super::shot::Shot;
use crate::export::gif::GifWriter;
use crate::export::png::write_png;
use crate::export::{ExportError, create_folder, partial_name};
use crate::render::Picture;
use std::path::{Path, PathBuf};

/// What kind of output a path asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// One picture.
    Png,
    /// An animation.
    Gif,
    /// Numbered pictures in a folder.
    Folder,
}

impl OutputKind {
    /// Tells the kind from the path's ending; a folder that exists or has no ending is a folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for an ending that cannot be written.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        let ends_as_folder = path.to_string_lossy().ends_with(std::path::is_separator);
        if ends_as_folder || path.is_dir() {
            return Ok(Self::Folder);
        }
        let Some(extension) = path.extension() else {
            return Ok(Self::Folder);
        };
        match extension.to_string_lossy().to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "gif" => Ok(Self::Gif),
            other => Err(Failure::BadInput(format!(
                "cannot write a .{other}: name the output something.png, something.gif, or a folder \
                 (no ending) for numbered PNGs"
            ))),
        }
    }
}

/// Takes finished pictures and writes them.
pub enum PictureSink {
    /// One picture.
    Png(PathBuf),
    /// An animation.
    Gif(GifFile),
    /// Numbered pictures.
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Number of the next picture.
        next: usize,
    },
}

/// A GIF that is begun with its first pictures.
pub struct GifFile {
    path: PathBuf,
    size_px: [u32; 2],
    fps: f64,
    // Boxed: with its palette the writer is far larger than the other kinds of output.
    writer: Option<Box<GifWriter>>,
}

impl PictureSink {
    /// Makes the place ready: a folder for numbered pictures is created and cleared of those of an earlier run. The
    /// folder of a single file must be there, as for everything else that writes one.
    /// A file that is there stays until the first picture replaces it.
    ///
    /// # Errors
    /// [`Failure::BadInput`] when the place cannot be used.
    pub fn create(path: &Path, shot: &Shot, force: bool, console: &Console) -> Result<Self, Failure> {
        let kind = OutputKind::of(path)?;
        if kind == OutputKind::Folder {
            prepare_folder(path, force, console)?;
            return Ok(Self::Folder { folder: path.to_owned(), next: 0 });
        }
        check_writable(path, console)?;
        let path = path.to_owned();
        Ok(match kind {
            OutputKind::Gif => {
                Self::Gif(GifFile { path, size_px: shot.size_px, fps: shot.fps, writer: None })
            }
            _ => Self::Png(path),
        })
    }

    /// Begins the output. A GIF asks for some pictures from all over the animation, from which it
    /// learns its colours.
    ///
    /// # Errors
    /// [`Failure::Run`] when the file cannot be created, and whatever `samples` returns.
    pub fn begin(&mut self, samples: impl FnOnce() -> Result<Vec<Picture>, Failure>) -> Result<(), Failure> {
        if let Self::Gif(GifFile { path, size_px, fps, writer }) = self {
            let samples = samples()?;
            let samples: Vec<&Picture> = samples.iter().collect();
            *writer = Some(Box::new(GifWriter::create(path, *size_px, *fps, &samples)?));
        }
        Ok(())
    }

    /// Writes the next picture; [`PictureSink::begin`] comes first.
    ///
    /// # Errors
    /// [`Failure::Run`] when it cannot be written.
    pub fn add(&mut self, picture: &Picture) -> Result<(), Failure> {
        match self {
            Self::Png(path) => write_png(path, picture)?,
            Self::Gif(GifFile { writer, .. }) => {
                let writer = writer.as_mut().expect("`begin` comes before `add`");
                writer.push(picture)?;
            }
            Self::Folder { folder, next } => {
                write_png(&folder.join(format!("{PREFIX}{next:05}{SUFFIX}")), picture)?;
                *next += 1;
            }
        }
        Ok(())
    }

    /// Closes the output; what was added is then readable.
    ///
    /// # Errors
    /// [`Failure::Run`] when closing fails.
    pub fn finish(self) -> Result<(), Failure> {
        match self {
            Self::Gif(GifFile { writer: Some(writer), .. }) => Ok(writer.finish()?),
            _ => Ok(()),
        }
    }
}

/// Finds out before the simulation whether the picture can be written after it, and says what it will take the place of.
pub fn check_writable(path: &Path, console: &Console) -> Result<(), Failure> {
    let trial = partial_name(path);
    std::fs::write(&trial, b"")
        .and_then(|()| std::fs::remove_file(&trial))
        .map_err(|error| Failure::from(ExportError::io("write", path)(error)).before_the_run())?;
    if path.exists() {
        console.note(format_args!("replacing `{}`", path.display()));
    }
    Ok(())
}

const PREFIX: &str = "frame-";
const SUFFIX: &str = ".png";

/// Creates the folder and removes earlier pictures, which would mix with the new ones.
fn prepare_folder(folder: &Path, force: bool, console: &Console) -> Result<(), Failure> {
    create_folder(folder).map_err(|error| Failure::from(error).before_the_run())?;
    let earlier = numbered_files(folder, PREFIX, SUFFIX);
    if earlier.is_empty() {
        return Ok(());
    }
    let all = std::fs::read_dir(folder).map_or(0, Iterator::count);
    if !force && all > earlier.len() {
        return Err(Failure::BadInput(format!(
            "`{}` holds {} numbered pictures and other files as well; choose another folder, or add \
             --force to replace the pictures",
            folder.display(),
            earlier.len()
        )));
    }
    console.note(format_args!("replacing {} pictures in `{}`", earlier.len(), folder.display()));
    earlier.iter().try_for_each(|file| remove(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_kind() {
        let kind = |path: &str| OutputKind::of(Path::new(path));
        assert_eq!(kind("a/b.png").unwrap(), OutputKind::Png);
        assert_eq!(kind("b.GIF").unwrap(), OutputKind::Gif);
        assert_eq!(kind("frames").unwrap(), OutputKind::Folder);
        assert_eq!(kind("new/frames.png/").unwrap(), OutputKind::Folder);
        let refused = kind("film.mp4");
        assert!(matches!(refused, Err(Failure::BadInput(text)) if text.contains(".mp4")));
    }

    #[test]
    fn an_existing_folder_is_a_folder_whatever_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let named = folder.path().join("odd.gif");
        std::fs::create_dir(&named).unwrap();
        assert_eq!(OutputKind::of(&named).unwrap(), OutputKind::Folder);
    }

    #[test]
    fn pictures_beside_other_files_are_replaced_only_by_force() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("frame-00001.png");
        let quiet = Console::new(true);
        std::fs::write(&picture, "").unwrap();
        prepare_folder(folder.path(), false, &quiet).unwrap();
        assert!(!picture.exists());
        std::fs::write(&picture, "").unwrap();
        std::fs::write(folder.path().join("notes.txt"), "").unwrap();
        assert!(prepare_folder(folder.path(), false, &quiet).is_err() && picture.exists());
        prepare_folder(folder.path(), true, &quiet).unwrap();
        assert!(!picture.exists() && folder.path().join("notes.txt").exists());
    }
}
