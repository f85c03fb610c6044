//! Tetrahedral meshes from files.
//!
//! | format | versions | encodings |
//! |---|---|---|
//! | Gmsh MSH | 2.2, 4.1 | text, binary of both byte orders |
//! | legacy VTK, unstructured grid | 2.0 to 4.2, 5.1 | text, binary |
//! | MEDIT `.mesh` | 1, 2 | text |
//!
//! The format is told from the content. A reader turns bytes into a raw mesh that still has the
//! file's own numbers, so that every refusal can name the node or element and the place; common
//! checks then make it fit for use. To add a format: recognise it in `format.rs` and write one
//! function `fn read(&mut Cursor) -> Read<RawMesh>`.

mod cells;
mod cursor;
mod error;
mod finish;
mod format;
mod medit;
mod msh;
mod msh2;
mod msh4;
mod raw;
mod vtk;
mod vtk_attributes;

use super::TetMesh;
use cursor::{Cursor, Failure};
pub use error::{ImportError, Place, Position, Problem};
use format::Format;
use std::path::Path;

/// Largest file that is read: what fits the memory of an ordinary machine several times over.
const LARGEST_FILE_BYTES: u64 = 4 << 30;

/// What may be done to a mesh on the way in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImportOptions {
    /// Leave out elements that are inverted, flat or given twice, instead of refusing the file.
    pub drop_bad_elements: bool,
}

/// A mesh from a file, in the file's unit of length.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedMesh {
    /// The mesh: sound, right-handed, without unused nodes.
    pub mesh: TetMesh,
    /// Everything that was changed or left out, a sentence each.
    pub notes: Vec<String>,
    /// Format and encoding, for messages.
    pub format: &'static str,
    /// Elements left out because they were bad.
    pub dropped_elements: usize,
    /// Nodes left out because no element uses them.
    pub unused_nodes: usize,
}

/// Reads a tetrahedral mesh.
///
/// # Errors
/// [`ImportError`], boxed since it is large and rare, with the file, the place in it and the reason, when the file cannot be read, is
/// of another format, malformed, or not a sound mesh of tetrahedra.
pub fn read_mesh(path: &Path, options: &ImportOptions) -> Result<ImportedMesh, Box<ImportError>> {
    let data =
        read_file(path).map_err(|problem| in_file(path, Failure { place: Place::default(), problem }))?;
    read_mesh_bytes(&data, path, options)
}

/// The same from the bytes of a file, which messages call `file`.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_bytes(
    data: &[u8],
    file: &Path,
    options: &ImportOptions,
) -> Result<ImportedMesh, Box<ImportError>> {
    let extension = file.extension().map(|text| text.to_string_lossy().to_ascii_lowercase());
    parse_mesh(data, &extension.unwrap_or_default(), options).map_err(|failure| in_file(file, *failure))
}

fn in_file(file: &Path, Failure { place, problem }: Failure) -> Box<ImportError> {
    Box::new(ImportError { file: file.to_owned(), place, problem })
}

fn read_file(path: &Path) -> Result<Vec<u8>, Problem> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(Problem::NotAFile("it is not a plain file".to_owned()));
    }
    if metadata.len() > LARGEST_FILE_BYTES {
        let text = format!("it has {} bytes; at most 4 GiB are read", metadata.len());
        return Err(Problem::NotAFile(text));
    }
    Ok(std::fs::read(path)?)
}

/// Reads a mesh from the bytes of a file. `extension` (lower case, without the dot) only helps
/// to name formats that are not read.
fn parse_mesh(data: &[u8], extension: &str, options: &ImportOptions) -> Result<ImportedMesh, Box<Failure>> {
    let format = Format::detect(data, extension)
        .map_err(|problem| Box::new(Failure { place: Place::default(), problem }))?;
    let mut cursor = Cursor::new(data);
    let raw = match format {
        Format::Msh => msh::read(&mut cursor)?,
        Format::Vtk => vtk::read(&mut cursor)?,
        Format::Medit => medit::read(&mut cursor)?,
    };
    let imported = finish::finish(raw, &cursor, options)?;
    Ok(ImportedMesh { format: format.name(cursor.is_binary()), ..imported })
}

#[cfg(test)]
mod tests;
