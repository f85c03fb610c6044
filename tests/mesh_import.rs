//! Real mesh files, made by other people and tools.
//!
//! They lie beside the checkout in `../shared/meshes`, whose README describes every file in
//! tables; each row is checked here. Without the folder the tests say so and pass, except where
//! `CI` is set: there it must be present.

#[path = "../fuzz/entries.rs"]
#[expect(dead_code, reason = "the other entries have their tests elsewhere")]
mod entries;
mod fuzzing;

use fuzzing::Random;
use hammerfall::mesh::MeshReport;
use hammerfall::mesh::import::{ImportError, ImportOptions, ImportedMesh, Problem, read_mesh};
use std::io::Write as _;
use std::path::{Path, PathBuf};

fn meshes_folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/meshes");
    if folder.join("README.md").is_file() {
        return Some(folder);
    }
    let text =
        format!("\n*** The real mesh files are absent ({}): NOTHING IS TESTED HERE. ***\n", folder.display());
    assert!(std::env::var_os("CI").is_none(), "{text}");
    // Not by `eprintln!`, which the test harness keeps to itself unless the test fails.
    let _ = writeln!(std::io::stderr(), "{text}");
    None
}

/// One row of the README's tables.
#[derive(Debug)]
struct Row {
    file: String,
    format: String,
    vertices: usize,
    cells: String,
    bounds: Option<[[f64; 3]; 2]>,
    volume: Option<f64>,
    surface: String,
    remarks: String,
}

impl Row {
    fn parse(line: &str) -> Option<Self> {
        let columns: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [file, format, vertices, cells, bounds, volume, surface, remarks, ..] = columns[..] else {
            return None;
        };
        Some(Self {
            file: file.split('`').nth(1)?.to_owned(),
            format: format.to_owned(),
            vertices: vertices.parse().unwrap_or(0),
            cells: cells.to_owned(),
            bounds: parse_bounds(bounds),
            volume: volume.parse().ok(),
            surface: surface.to_owned(),
            remarks: remarks.to_owned(),
        })
    }

    /// The whole number in front of `word` in a text, e.g. 24 in `24 boundary tris`.
    fn number_before(text: &str, word: &str) -> Option<usize> {
        let before = text[..text.find(word)?].trim_end();
        before.rsplit(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    }

    fn tets(&self) -> Option<usize> {
        Self::number_before(&self.cells, "tets").or_else(|| Self::number_before(&self.cells, "tet10"))
    }

    fn inverted(&self) -> usize {
        Self::number_before(&self.remarks, "of ")
            .filter(|_| self.remarks.contains("tets inverted"))
            .unwrap_or(0)
    }

    fn is_readable_format(&self) -> bool {
        ["MSH 2.2", "MSH 4.1", "legacy VTK", "MEDIT"].iter().any(|format| self.format.starts_with(format))
    }
}

fn parse_bounds(text: &str) -> Option<[[f64; 3]; 2]> {
    let (low, high) = text.split_once("..")?;
    let point = |text: &str| {
        let numbers: Vec<f64> = text
            .trim_matches(['(', ')'])
            .split_whitespace()
            .filter_map(|number| number.parse().ok())
            .collect();
        <[f64; 3]>::try_from(numbers).ok()
    };
    Some([point(low)?, point(high)?])
}

fn rows(folder: &Path, subfolder: &str) -> Vec<Row> {
    let readme = std::fs::read_to_string(folder.join("README.md")).expect("a readable README");
    let rows: Vec<Row> = readme
        .lines()
        .filter(|line| line.starts_with(&format!("| `{subfolder}/")))
        .map(|line| Row::parse(line).unwrap_or_else(|| panic!("row not understood: {line}")))
        .collect();
    assert!(!rows.is_empty(), "no rows for {subfolder}");
    rows
}

fn read(folder: &Path, row: &Row, drop_bad_elements: bool) -> Result<ImportedMesh, Box<ImportError>> {
    read_mesh(&folder.join(&row.file), &ImportOptions { drop_bad_elements })
}

#[test]
fn every_file_is_read_or_refused_as_its_row_says() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    for row in rows(&folder, "tet").into_iter().chain(rows(&folder, "encodings")) {
        match read(&folder, &row, false) {
            Ok(imported) => {
                println!("{}: {:?}", row.file, imported.notes);
                check_against(&row, &imported);
            }
            Err(error) => {
                println!("{error}");
                check_refusal(&row, &error);
                check_dropping(&folder, &row);
            }
        }
    }
}

fn check_against(row: &Row, imported: &ImportedMesh) {
    let report = MeshReport::of(&imported.mesh);
    let what = format!("{row:?}\n{:?}\n{report}", imported.notes);
    assert!(row.is_readable_format(), "{what}");
    assert!(report.is_sound(), "{what}");
    assert_eq!(Some(report.tets), row.tets(), "{what}");
    assert_eq!(report.nodes + imported.unused_nodes, row.vertices, "{what}");
    check_volume_and_bounds(row, &report);
    let triangles = Row::number_before(&row.remarks, "boundary tris");
    assert_eq!(Some(report.surface_triangles), triangles, "{what}");
    let edges = row.surface.split("NON-MANIFOLD: ").nth(1);
    let edges = edges.and_then(|text| Row::number_before(text, "edges"));
    assert_eq!(report.non_manifold_edges, edges.unwrap_or(0), "{what}");
    let parts = Row::number_before(&row.remarks, "parts")
        .or_else(|| Row::number_before(&row.remarks, "face-connected parts"));
    assert_eq!(report.parts, parts.unwrap_or(1), "{what}");
    let slivers = Row::number_before(&row.remarks, "slivers").unwrap_or(0);
    assert_eq!(report.slivers, slivers, "{what}");
    let turned = imported.notes.iter().any(|note| note.contains("turned"));
    assert_eq!(turned, row.inverted() > 0, "{what}");
}

fn check_volume_and_bounds(row: &Row, report: &MeshReport) {
    let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-4 * scale;
    let volume = row.volume.expect("a volume").abs();
    assert!(close(report.volume_m3, volume, volume), "{row:?}\n{report}");
    if row.cells.contains("tet10") {
        return; // The row's box holds the middle nodes, too.
    }
    let (low, high) = report.bounds_m.expect("nodes");
    let scale = (high - low).max_element();
    let expected = row.bounds.expect("a bounding box");
    for (found, expected) in [low, high].iter().zip(expected) {
        for (found, expected) in found.to_array().into_iter().zip(expected) {
            assert!(close(found, expected, scale.max(expected.abs())), "{row:?}\n{report}");
        }
    }
}

fn check_refusal(row: &Row, error: &ImportError) {
    let text = error.to_string();
    assert!(text.contains(row.file.rsplit('/').next().unwrap_or("")), "{text}");
    let as_expected = match &error.problem {
        Problem::UnsupportedFormat { .. } | Problem::UnsupportedVariant { .. } => !row.is_readable_format(),
        Problem::NoTetrahedra { .. } => row.cells.contains("tris") && row.tets().is_none(),
        Problem::CellKind { .. } => row.cells.contains("hex"),
        Problem::BadElement { bad, total, .. } => *bad == row.inverted() && Some(*total) == row.tets(),
        _ => false,
    };
    assert!(as_expected, "{row:?}\n{text}");
}

fn check_dropping(folder: &Path, row: &Row) {
    if row.inverted() == 0 || !row.is_readable_format() {
        return;
    }
    let imported = read(folder, row, true).expect("the bad elements are dropped");
    let report = MeshReport::of(&imported.mesh);
    assert_eq!(imported.dropped_elements, row.inverted());
    assert_eq!(Some(report.tets + row.inverted()), row.tets());
    assert_eq!(report.inverted, 0, "{report}");
}

#[test]
fn malformed_files_are_refused_with_a_place() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    for row in rows(&folder, "malformed") {
        let result = read(&folder, &row, true);
        // Only the largest number in a header is odd: the format allows that.
        if row.file.contains("mismatch_between_max_nodes") {
            check_against(&row, &result.expect("a legal file"));
            continue;
        }
        let error = result.expect_err("refused");
        println!("{error}");
        if row.is_readable_format() {
            assert!(error.place.position.is_some(), "{error}");
            assert!(error.place.section.is_some(), "{error}");
        } else {
            assert!(matches!(error.problem, Problem::UnsupportedFormat { .. }), "{error}");
        }
    }
}

#[test]
fn surfaces_are_refused_by_name() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    for row in rows(&folder, "surface") {
        let error = read(&folder, &row, false).expect_err("refused");
        assert!(matches!(error.problem, Problem::UnsupportedFormat { .. }), "{error}");
        assert!(error.to_string().contains("surface only"), "{error}");
    }
}

#[test]
fn all_encodings_of_one_mesh_give_the_same_mesh() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    let meshes: Vec<ImportedMesh> = rows(&folder, "encodings")
        .iter()
        .filter(|row| row.is_readable_format())
        .map(|row| read(&folder, row, false).expect("readable"))
        .collect();
    assert!(meshes.len() >= 8);
    for imported in &meshes[1..] {
        let (a, b) = (&meshes[0].mesh, &imported.mesh);
        assert_eq!(a.tets, b.tets, "{}", imported.format);
        let farthest = a.nodes_m.iter().zip(&b.nodes_m).map(|(x, y)| x.distance(*y)).fold(0.0, f64::max);
        assert!(farthest < 1e-9, "{}: {farthest}", imported.format);
    }
}

#[test]
fn regions_come_from_physical_names_tags_and_materials() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    let regions = |file: &str| -> Vec<(String, usize)> {
        let imported = read_mesh(&folder.join(file), &ImportOptions::default());
        MeshReport::of(&imported.expect("readable").mesh).regions
    };
    let named = |entries: &[(&str, usize)]| -> Vec<(String, usize)> {
        entries.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect()
    };
    assert_eq!(regions("tet/pf_physical_sides_41.msh"), named(&[("upper", 1), ("lower", 1)]));
    assert_eq!(regions("tet/skf_box_22.msh"), named(&[("all", 1105)]));
    let five = named(&[("1", 1), ("2", 3), ("3", 1)]);
    for encoding in ["22_ascii", "22_binary", "41_ascii", "41_binary"] {
        assert_eq!(regions(&format!("tet/pf_5tets_{encoding}.msh")), five);
    }
    assert_eq!(regions("tet/cylinder_in_box.mesh").len(), 2);
    assert_eq!(regions("tet/cube_sphere.mesh").len(), 2);
    assert!(regions("tet/piezo_mesh_micro.vtk").len() > 1);
}

/// Files cut off or with broken bytes: an error or a sound mesh, never a panic.
#[test]
fn damaged_files_are_errors_or_sound_meshes() {
    let Some(folder) = meshes_folder() else {
        return;
    };
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let damaged_file = scratch.path().join("damaged");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for row in rows(&folder, "tet").into_iter().chain(rows(&folder, "encodings")) {
        let data = std::fs::read(folder.join(&row.file)).expect("readable");
        if !row.is_readable_format() || data.len() > 100_000 {
            continue;
        }
        for trial in 0..24 {
            let mut damaged = data.clone();
            if trial % 2 == 0 {
                damaged.truncate(random.below(data.len()));
            } else {
                for _ in 0..=random.below(4) {
                    let at = random.below(damaged.len());
                    damaged[at] = damaged[at].wrapping_add(1 + random.below(255) as u8);
                }
            }
            std::fs::write(&damaged_file, &damaged).expect("writable");
            for drop_bad_elements in [false, true] {
                let options = ImportOptions { drop_bad_elements };
                if let Ok(imported) = read_mesh(&damaged_file, &options) {
                    let report = MeshReport::of(&imported.mesh);
                    assert!(report.is_sound(), "{} trial {trial}\n{report}", row.file);
                }
            }
        }
    }
    assert_memory_stayed_small();
}

#[test]
fn fuzzed_bytes_are_errors_or_sound_meshes() {
    fuzzing::run("mesh", 20_000, entries::mesh);
    assert_memory_stayed_small();
}

/// Counts in damaged files must never be believed: the whole run fits in little memory.
fn assert_memory_stayed_small() {
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else {
        return;
    };
    let peak_kib = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|text| text.split_whitespace().next()?.parse::<u64>().ok())
        .expect("a peak of memory");
    assert!(peak_kib < 512 * 1024, "{peak_kib} KiB");
}
