//! Tells mesh formats apart by their first bytes.

use super::cursor::readable;
use super::error::Problem;

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Msh,
    Vtk,
    Medit,
}

/// First word of a file and the format it shows.
const READ: [(&str, Format); 3] =
    [("$MeshFormat", Format::Msh), ("# vtk DataFile", Format::Vtk), ("MeshVersionFormatted", Format::Medit)];

const SURFACE_ADVICE: &str =
    "they hold a surface only, and a body needs its volume meshed with tetrahedra (in Gmsh: `gmsh -3`)";
const RESAVE_ADVICE: &str = "convert the file, e.g. with Gmsh or meshio";

/// First words of formats that are not read, their names and what to do.
const NOT_READ: [(&str, &str, &str); 15] = [
    ("$NOD", "Gmsh MSH 1.0", "save the file as MSH 4.1 (`gmsh FILE -save -format msh41`)"),
    ("<?xml", "VTK XML (.vtu)", RESAVE_ADVICE),
    ("<VTKFile", "VTK XML (.vtu)", RESAVE_ADVICE),
    ("(", "Ansys Fluent", RESAVE_ADVICE),
    ("**", "Abaqus", RESAVE_ADVICE),
    ("*HEADING", "Abaqus", RESAVE_ADVICE),
    ("*NODE", "Abaqus", RESAVE_ADVICE),
    ("*PART", "Abaqus", RESAVE_ADVICE),
    ("solid", "STL", SURFACE_ADVICE),
    ("ply", "PLY", SURFACE_ADVICE),
    ("OFF", "OFF", SURFACE_ADVICE),
    ("COFF", "OFF", SURFACE_ADVICE),
    ("\u{89}HDF", "HDF5 (MED, XDMF, CGNS)", RESAVE_ADVICE),
    ("\u{1}\0\0\0", "binary MEDIT (.meshb)", "save the file as text (.mesh)"),
    ("\0\0\0\u{1}", "binary MEDIT (.meshb)", "save the file as text (.mesh)"),
];

/// Formats told by their extension alone.
const BY_EXTENSION: [(&str, &str, &str); 12] = [
    ("vtu", "VTK XML (.vtu)", RESAVE_ADVICE),
    ("node", "TetGen", RESAVE_ADVICE),
    ("ele", "TetGen", RESAVE_ADVICE),
    ("inp", "Abaqus", RESAVE_ADVICE),
    ("bdf", "Nastran", RESAVE_ADVICE),
    ("nas", "Nastran", RESAVE_ADVICE),
    ("med", "MED", RESAVE_ADVICE),
    ("stl", "STL", SURFACE_ADVICE),
    ("obj", "OBJ", SURFACE_ADVICE),
    ("ply", "PLY", SURFACE_ADVICE),
    ("off", "OFF", SURFACE_ADVICE),
    ("meshb", "binary MEDIT (.meshb)", "save the file as text (.mesh)"),
];

impl Format {
    /// Tells the format from the content; the extension only helps to name what is not read.
    pub fn detect(data: &[u8], extension: &str) -> Result<Self, Problem> {
        let content = content_start(data);
        if let Some((_, format)) = READ.iter().find(|(word, _)| begins_with(content, word)) {
            return Ok(*format);
        }
        let by_content =
            NOT_READ.iter().find(|(word, ..)| begins_with(content, word) || begins_with_bytes(data, word));
        let by_extension = BY_EXTENSION.iter().find(|(known, ..)| *known == extension);
        Err(match by_content.or(by_extension) {
            Some(&(_, format, advice)) => Problem::UnsupportedFormat { format, advice },
            None => Problem::UnknownFormat { begins: readable(&content[..content.len().min(30)]) },
        })
    }

    /// Name and encoding.
    pub fn name(self, binary: bool) -> &'static str {
        match (self, binary) {
            (Self::Msh, false) => "Gmsh MSH, text",
            (Self::Msh, true) => "Gmsh MSH, binary",
            (Self::Vtk, false) => "legacy VTK, text",
            (Self::Vtk, true) => "legacy VTK, binary",
            (Self::Medit, _) => "MEDIT, text",
        }
    }
}

/// Whether the content begins with a word, whatever its case.
fn begins_with(content: &[u8], word: &str) -> bool {
    content.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
}

/// Signatures are given as characters up to 255, one a byte.
fn begins_with_bytes(data: &[u8], signature: &str) -> bool {
    let mut bytes = data.iter();
    signature.chars().all(|c| bytes.next().is_some_and(|&byte| char::from(byte) == c))
}

/// The first thing that tells a format: behind white space, MEDIT's `#` comments and Gmsh's
/// `$Comments` section.
fn content_start(data: &[u8]) -> &[u8] {
    let mut content = data.strip_prefix(b"\xef\xbb\xbf").unwrap_or(data);
    loop {
        content = content.trim_ascii_start();
        let is_comment = content.starts_with(b"#") && !begins_with(content, "# vtk DataFile");
        let end: &[u8] = if is_comment {
            b"\n"
        } else if content.starts_with(b"$Comments") {
            b"$EndComments"
        } else {
            return content;
        };
        match content.windows(end.len()).position(|part| part == end) {
            Some(at) => content = &content[at + end.len()..],
            None => return content,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(data: &[u8], extension: &str) -> String {
        Format::detect(data, extension).expect_err("refused").to_string()
    }

    #[test]
    fn content_counts_more_than_the_extension() {
        let medit = b"\n# made by hand\n MeshVersionFormatted 2";
        assert_eq!(Format::detect(medit, "obj").ok(), Some(Format::Medit));
        let msh = b"$Comments\nhello\n$EndComments\n$MeshFormat\n";
        assert_eq!(Format::detect(msh, "").ok(), Some(Format::Msh));
    }

    #[test]
    fn known_formats_are_refused_by_name() {
        for (data, extension, name) in [
            (b"$NOD\n4\n".as_slice(), "msh", "MSH 1.0"),
            (b"<VTKFile type=", "vtk", "VTK XML"),
            (b"solid part", "stl", "STL"),
            (b"v 0 0 0", "obj", "OBJ"),
            (b"3 3 0 0", "node", "TetGen"),
            (b"\x89HDF\r\n", "med", "HDF5"),
            (b"\x01\0\0\0\x02\0\0\0", "meshb", "binary MEDIT"),
        ] {
            let text = refusal(data, extension);
            assert!(text.contains(name) && text.contains("Formats read"), "{text}");
        }
        assert!(refusal(b"hello", "msh").contains("`hello`"));
        assert!(refusal(b"", "").contains("not recognised"));
    }
}
