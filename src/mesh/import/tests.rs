//! Tiny hand-made files in every encoding, sound and broken.

use super::*;
use crate::mesh::MeshReport;
use glam::DVec3;

/// Two tetrahedra on a common face.
#[derive(Clone)]
struct Sample {
    nodes: Vec<[f64; 3]>,
    /// Node indices from 0.
    tets: Vec<[u64; 4]>,
}

fn sample() -> Sample {
    Sample {
        nodes: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.75, 0.75, 0.75]],
        tets: vec![[0, 1, 2, 3], [1, 2, 3, 4]],
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Msh2Text,
    Msh2Little,
    Msh2Big,
    Msh4Text,
    Msh4Little,
    Msh4Big,
    Vtk4Text,
    Vtk4Binary,
    Vtk5Text,
    Vtk5Binary,
    Medit,
}

const KINDS: [Kind; 11] = [
    Kind::Msh2Text,
    Kind::Msh2Little,
    Kind::Msh2Big,
    Kind::Msh4Text,
    Kind::Msh4Little,
    Kind::Msh4Big,
    Kind::Vtk4Text,
    Kind::Vtk4Binary,
    Kind::Vtk5Text,
    Kind::Vtk5Binary,
    Kind::Medit,
];

impl Kind {
    fn is_binary(self) -> bool {
        matches!(
            self,
            Self::Msh2Little
                | Self::Msh2Big
                | Self::Msh4Little
                | Self::Msh4Big
                | Self::Vtk4Binary
                | Self::Vtk5Binary
        )
    }

    fn is_vtk(self) -> bool {
        matches!(self, Self::Vtk4Text | Self::Vtk4Binary | Self::Vtk5Text | Self::Vtk5Binary)
    }

    /// Nodes and elements are numbered from here.
    fn first(self) -> u64 {
        u64::from(!self.is_vtk())
    }

    fn write(self, sample: &Sample) -> Vec<u8> {
        let mut out = Writer { bytes: Vec::new(), kind: self };
        match self {
            Self::Msh2Text | Self::Msh2Little | Self::Msh2Big => out.msh2(sample),
            Self::Msh4Text | Self::Msh4Little | Self::Msh4Big => out.msh4(sample),
            Self::Medit => out.medit(sample),
            _ => out.vtk(sample),
        }
        out.bytes
    }
}

struct Writer {
    bytes: Vec<u8>,
    kind: Kind,
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn number<const N: usize>(&mut self, text: impl std::fmt::Display, little: [u8; N]) {
        if !self.kind.is_binary() {
            return self.text(&format!("{text} "));
        }
        let mut bytes = little;
        if !matches!(self.kind, Kind::Msh2Little | Kind::Msh4Little) {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn int(&mut self, value: u64) {
        self.number(value, i32::try_from(value).expect("small").to_le_bytes());
    }

    fn ints(&mut self, values: &[u64]) {
        values.iter().for_each(|&value| self.int(value));
        self.end_row();
    }

    fn size(&mut self, value: u64) {
        self.number(value, value.to_le_bytes());
    }

    fn sizes(&mut self, values: &[u64]) {
        values.iter().for_each(|&value| self.size(value));
        self.end_row();
    }

    fn real(&mut self, value: f64) {
        self.number(value, value.to_le_bytes());
    }

    fn point(&mut self, point: [f64; 3]) {
        point.iter().for_each(|&value| self.real(value));
        self.end_row();
    }

    fn end_row(&mut self) {
        if !self.kind.is_binary() {
            self.text("\n");
        }
    }

    fn format(&mut self, version: &str) {
        let binary = self.kind.is_binary();
        self.text(&format!("$MeshFormat\n{version} {} 8\n", u8::from(binary)));
        if binary {
            self.int(1);
            self.text("\n");
        }
        self.text("$EndMeshFormat\n");
    }

    fn msh2(&mut self, sample: &Sample) {
        self.format("2.2");
        self.text(&format!("$Nodes\n{}\n", sample.nodes.len()));
        for (point, number) in sample.nodes.iter().zip(1..) {
            self.int(number);
            self.point(*point);
        }
        self.text(&format!("$EndNodes\n$Elements\n{}\n", sample.tets.len()));
        if self.kind.is_binary() {
            self.ints(&[4, sample.tets.len() as u64, 2]);
        }
        for (tet, number) in sample.tets.iter().zip(1..) {
            let [a, b, c, d] = tet.map(|node| node + 1);
            if self.kind.is_binary() {
                self.ints(&[number, 0, 0, a, b, c, d]);
            } else {
                self.ints(&[number, 4, 2, 0, 0, a, b, c, d]);
            }
        }
        self.text("$EndElements\n");
    }

    fn msh4(&mut self, sample: &Sample) {
        let (nodes, tets) = (sample.nodes.len() as u64, sample.tets.len() as u64);
        self.format("4.1");
        self.text("$Nodes\n");
        self.sizes(&[1, nodes, 1, nodes]);
        [3, 0, 0].iter().for_each(|&value| self.int(value));
        self.sizes(&[nodes]);
        (1..=nodes).for_each(|number| self.sizes(&[number]));
        sample.nodes.iter().for_each(|&point| self.point(point));
        self.text("$EndNodes\n$Elements\n");
        self.sizes(&[1, tets, 1, tets]);
        [3, 0, 4].iter().for_each(|&value| self.int(value));
        self.sizes(&[tets]);
        for (tet, number) in sample.tets.iter().zip(1..) {
            let [a, b, c, d] = tet.map(|node| node + 1);
            self.sizes(&[number, a, b, c, d]);
        }
        self.text("$EndElements\n");
    }

    fn vtk(&mut self, sample: &Sample) {
        let arrays = matches!(self.kind, Kind::Vtk5Text | Kind::Vtk5Binary);
        let version = if arrays { "5.1" } else { "4.2" };
        let encoding = if self.kind.is_binary() { "BINARY" } else { "ASCII" };
        let (nodes, tets) = (sample.nodes.len(), sample.tets.len() as u64);
        self.text(&format!(
            "# vtk DataFile Version {version}\ntitle\n{encoding}\nDATASET UNSTRUCTURED_GRID\n\
             POINTS {nodes} double\n"
        ));
        sample.nodes.iter().for_each(|&point| self.point(point));
        if arrays {
            self.text(&format!("\nCELLS {} {}\nOFFSETS vtktypeint64\n", tets + 1, 4 * tets));
            (0..=tets).for_each(|cell| self.size(4 * cell));
            self.text("\nCONNECTIVITY vtktypeint64\n");
            sample.tets.iter().for_each(|tet| self.sizes(tet));
        } else {
            self.text(&format!("\nCELLS {tets} {}\n", 5 * tets));
            for &[a, b, c, d] in &sample.tets {
                self.ints(&[4, a, b, c, d]);
            }
        }
        self.text(&format!("\nCELL_TYPES {tets}\n"));
        sample.tets.iter().for_each(|_| self.ints(&[10]));
        self.text("\n");
    }

    fn medit(&mut self, sample: &Sample) {
        self.text("# by hand\nMeshVersionFormatted 2\nDimension 3\n");
        self.text(&format!("Vertices {}\n", sample.nodes.len()));
        for [x, y, z] in &sample.nodes {
            self.text(&format!("{x} {y} {z} 0\n"));
        }
        self.text(&format!("Tetrahedra\n{}\n", sample.tets.len()));
        for tet in &sample.tets {
            let [a, b, c, d] = tet.map(|node| node + 1);
            self.ints(&[a, b, c, d, 0]);
        }
        self.text("End\n");
    }
}

fn parse(data: &[u8]) -> Result<ImportedMesh, Box<Failure>> {
    parse_mesh(data, "", &ImportOptions::default())
}

fn parse_and_drop(data: &[u8]) -> Result<ImportedMesh, Box<Failure>> {
    let drop_bad_elements = true;
    parse_mesh(data, "", &ImportOptions { drop_bad_elements })
}

/// The failure for a changed sample in every encoding.
fn failures(change: impl Fn(&mut Sample)) -> Vec<(Kind, Box<Failure>)> {
    let mut changed = sample();
    change(&mut changed);
    let of = |kind: Kind| (kind, parse(&kind.write(&changed)).expect_err("refused"));
    KINDS.into_iter().map(of).collect()
}

/// The result for a changed sample in every encoding, bad elements dropped.
fn dropped(change: impl Fn(&mut Sample)) -> Vec<ImportedMesh> {
    let mut changed = sample();
    change(&mut changed);
    let of = |kind: Kind| parse_and_drop(&kind.write(&changed)).expect("read");
    KINDS.into_iter().map(of).collect()
}

#[test]
fn every_encoding_gives_the_same_mesh() {
    let sample = sample();
    for kind in KINDS {
        let imported = parse(&kind.write(&sample)).unwrap_or_else(|e| panic!("{kind:?} {e:?}"));
        assert_eq!(imported.mesh.region_names, ["all"], "{kind:?}");
        assert_eq!(imported.mesh.tets, [[0, 1, 2, 3], [1, 2, 3, 4]], "{kind:?}");
        assert_eq!(imported.mesh.nodes_m[4], DVec3::splat(0.75));
        assert!(imported.notes.is_empty(), "{:?}", imported.notes);
        assert_eq!(imported.format.contains("binary"), kind.is_binary());
    }
}

#[test]
fn a_node_that_is_not_finite_is_named() {
    for bad in [f64::NAN, f64::INFINITY] {
        for (kind, failure) in failures(|sample| sample.nodes[3][1] = bad) {
            let Problem::NotFinite { node, .. } = failure.problem else {
                panic!("{kind:?} {failure:?}");
            };
            assert_eq!(node, kind.first() + 3, "{kind:?}");
            let line = matches!(failure.place.position, Some(Position::Line(_)));
            assert_eq!(line, !kind.is_binary(), "{kind:?}");
        }
    }
}

#[test]
fn a_single_inverted_element_is_named_or_dropped() {
    let invert = |sample: &mut Sample| {
        sample.nodes.push([0.2, 0.2, -1.0]);
        sample.tets.push([0, 1, 2, 5]);
    };
    for (kind, failure) in failures(invert) {
        let Problem::BadElement { element, fault, bad, total } = failure.problem else {
            panic!("{kind:?} {failure:?}");
        };
        assert_eq!((element, bad, total), (kind.first() + 2, 1, 3), "{kind:?}");
        assert!(fault.starts_with("inverted"), "{fault}");
        assert!(failure.place.position.is_some());
    }
    for imported in dropped(invert) {
        assert_eq!((imported.mesh.tets.len(), imported.dropped_elements), (2, 1));
        assert!(imported.notes[0].contains("1 bad elements of 3"));
    }
}

#[test]
fn the_line_of_a_bad_element_is_right() {
    let mut changed = sample();
    changed.tets[1] = [1, 2, 3, 3];
    let data = Kind::Medit.write(&changed);
    let failure = parse(&data).expect_err("flat");
    let Some(Position::Line(line)) = failure.place.position else {
        panic!("{failure:?}");
    };
    let text = String::from_utf8(data).expect("text");
    assert_eq!(text.lines().nth(line - 1), Some("2 3 4 4 0 "));
}

#[test]
fn flat_elements_are_named_or_dropped() {
    let flatten = |sample: &mut Sample| {
        sample.nodes.push([0.5, 0.5, 1e-12]);
        sample.tets.push([0, 1, 2, 5]);
    };
    let repeat = |sample: &mut Sample| sample.tets[1] = [1, 2, 3, 2];
    for (change, word) in [(&flatten as &dyn Fn(&mut Sample), "flat (volume"), (&repeat, "twice")] {
        for (kind, failure) in failures(change) {
            let text = failure.problem.to_string();
            assert!(text.contains(word), "{kind:?} {text}");
        }
        for imported in dropped(change) {
            assert_eq!(imported.dropped_elements, 1);
            assert_eq!(imported.unused_nodes, 1);
        }
    }
}

#[test]
fn an_element_given_twice_is_named_or_dropped() {
    let double = |sample: &mut Sample| sample.tets.push([1, 2, 0, 3]);
    for (kind, failure) in failures(double) {
        let text = failure.problem.to_string();
        let expected = format!("the same as element {}", kind.first());
        assert!(text.contains(&expected), "{text}");
    }
    for imported in dropped(double) {
        assert_eq!(imported.mesh.tets.len(), 2);
    }
}

#[test]
fn elements_that_pile_up_on_a_face_are_refused() {
    let pile = |sample: &mut Sample| {
        sample.nodes.push([0.9, 0.9, 0.9]);
        sample.tets.push([1, 2, 3, 5]);
    };
    for (_, failure) in failures(pile) {
        assert!(matches!(failure.problem, Problem::Overlap { faces: 1 }));
    }
}

#[test]
fn a_missing_node_is_named() {
    for (kind, failure) in failures(|sample| sample.tets[1][2] = 77) {
        let Problem::MissingNode { element, node } = failure.problem else {
            panic!("{kind:?} {failure:?}");
        };
        assert_eq!([element, node], [kind.first() + 1, kind.first() + 77]);
        assert!(failure.place.position.is_some());
    }
}

#[test]
fn a_file_of_left_handed_elements_is_turned() {
    let mirror = |sample: &mut Sample| sample.tets.iter_mut().for_each(|tet| tet.swap(0, 1));
    for imported in dropped(mirror) {
        assert_eq!(imported.dropped_elements, 0);
        assert!(imported.notes[0].contains("turned"));
        assert!(MeshReport::of(&imported.mesh).is_sound());
    }
}

#[test]
fn unused_nodes_are_dropped_and_noted() {
    let add_node_in_front = |sample: &mut Sample| {
        sample.nodes.insert(0, [9.0; 3]);
        let numbers = sample.tets.iter_mut().flatten();
        numbers.for_each(|node| *node += 1);
    };
    for imported in dropped(add_node_in_front) {
        assert_eq!((imported.unused_nodes, imported.dropped_elements), (1, 0));
        assert_eq!(imported.mesh.tets, [[0, 1, 2, 3], [1, 2, 3, 4]]);
        assert_eq!(imported.mesh.nodes_m[0], DVec3::ZERO);
        assert!(imported.notes.iter().any(|note| note.contains("1 node dropped")));
    }
}

#[test]
fn only_bad_elements_leave_nothing() {
    let flatten = |sample: &mut Sample| sample.nodes.iter_mut().for_each(|node| node[2] = 0.0);
    let mut changed = sample();
    flatten(&mut changed);
    for kind in KINDS {
        let failure = parse_and_drop(&kind.write(&changed)).expect_err("nothing left");
        assert!(matches!(failure.problem, Problem::NothingLeft { total: 2 }));
    }
}

#[test]
fn a_node_given_twice_is_named() {
    let text = String::from_utf8(Kind::Msh2Text.write(&sample())).expect("text");
    let failure = parse(text.replace("\n5 0.75", "\n4 0.75").as_bytes()).expect_err("refused");
    assert!(matches!(failure.problem, Problem::NodeTwice { node: 4 }));
}

#[test]
fn counts_that_the_file_cannot_hold_are_not_believed() {
    for (kind, from, to) in [
        (Kind::Msh2Text, "$Nodes\n5", "$Nodes\n5000000000000"),
        (Kind::Msh2Text, "$Elements\n2", "$Elements\n99999"),
        (Kind::Msh4Text, "1 5 1 5", "1 18446744073709551615 1 5"),
        (Kind::Msh4Text, "3 0 4 2", "3 0 4 18446744073709551615"),
        (Kind::Vtk4Text, "POINTS 5", "POINTS 5000000000000"),
        (Kind::Vtk4Text, "CELLS 2 10", "CELLS 2 1000000000"),
        (Kind::Vtk5Text, "CELLS 3 8", "CELLS 3 800000000000"),
        (Kind::Vtk4Text, "CELL_TYPES 2", "CELL_TYPES 20000000000"),
        (Kind::Medit, "Vertices 5", "Vertices 18446744073709551615"),
        (Kind::Medit, "Tetrahedra\n2", "Tetrahedra\n2000000000"),
    ] {
        let text = String::from_utf8(kind.write(&sample())).expect("text");
        assert!(text.contains(from), "{kind:?} {from}");
        let failure = parse(text.replace(from, to).as_bytes()).expect_err("refused");
        assert!(matches!(failure.problem, Problem::Announced { .. }), "{kind:?} {failure:?}");
    }
}

#[test]
fn more_items_than_announced_are_noticed() {
    for (kind, from, to) in [
        (Kind::Msh2Text, "$Nodes\n5", "$Nodes\n4"),
        (Kind::Msh2Text, "$Elements\n2", "$Elements\n1"),
        (Kind::Medit, "Vertices 5", "Vertices 4"),
        (Kind::Vtk4Text, "POINTS 5", "POINTS 4"),
        (Kind::Vtk4Text, "CELL_TYPES 2", "CELL_TYPES 1"),
    ] {
        let text = String::from_utf8(kind.write(&sample())).expect("text");
        let failure = parse(text.replace(from, to).as_bytes()).expect_err("refused");
        assert!(matches!(failure.problem, Problem::SectionGoesOn { .. }), "{kind:?} {failure:?}");
        assert!(failure.place.section.is_some());
    }
}

#[test]
fn a_cell_of_an_unknown_type_is_refused() {
    let text = String::from_utf8(Kind::Msh2Text.write(&sample())).expect("text");
    let failure = parse(text.replace("\n2 4 2", "\n2 777 2").as_bytes()).expect_err("refused");
    let message = failure.problem.to_string();
    assert!(message.contains("element 2 is a cell of unknown type 777"), "{message}");
}

#[test]
fn named_and_numbered_regions_are_kept() {
    let text = String::from_utf8(Kind::Msh2Text.write(&sample())).expect("text");
    let text = text
        .replace("\n1 4 2 0 0", "\n1 4 2 7 0")
        .replace("\n2 4 2 0 0", "\n2 4 2 0 3")
        .replace("$Nodes", "$PhysicalNames\n2\n2 7 \"skin\"\n3 7 \"steel head\"\n$EndPhysicalNames\n$Nodes");
    let mesh = parse(text.as_bytes()).expect("read").mesh;
    assert_eq!(mesh.region_names, ["steel head", "3"]);
    assert_eq!(mesh.regions, [0, 1]);
}

#[test]
fn materials_come_from_vtk_cell_data() {
    let mut text = String::from_utf8(Kind::Vtk4Text.write(&sample())).expect("text");
    text += "POINT_DATA 5\nVECTORS v float\n";
    text += &"1 2 3\n".repeat(5);
    text += "CELL_DATA 2\nSCALARS mat_id int 1\nLOOKUP_TABLE default\n6 2\n";
    let mesh = parse(text.as_bytes()).expect("read").mesh;
    assert_eq!(mesh.region_names, ["6", "2"]);
    let cut = &text.as_bytes()[..text.len() - 3];
    assert!(parse(cut).is_err(), "a value is missing");
    text += "TEXTURE_COORDINATES t 2 float\n1 2 3 4\n";
    let notes = parse(text.as_bytes()).expect("read").notes;
    assert!(notes[0].contains("TEXTURE_COORDINATES"), "{notes:?}");
}

/// A file cut anywhere gives an error or, when only its last white space is lost, the whole mesh.
#[test]
fn a_file_cut_off_never_gives_a_part_of_the_mesh() {
    for kind in KINDS {
        let data = kind.write(&sample());
        let whole = parse(&data).expect("read").mesh;
        for length in 0..data.len() {
            if let Ok(imported) = parse(&data[..length]) {
                assert_eq!(imported.mesh, whole, "{kind:?} cut to {length}");
                assert!(length + 8 > data.len(), "{kind:?} cut to {length}");
            }
        }
    }
}

#[test]
fn broken_bytes_give_errors_or_sound_meshes() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |limit: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        usize::try_from(state % limit as u64).expect("below a usize")
    };
    for kind in KINDS {
        let data = kind.write(&sample());
        for _ in 0..3000 {
            let mut broken = data.clone();
            for _ in 0..=random(3) {
                let at = random(broken.len());
                broken[at] = random(256) as u8;
            }
            if let Ok(imported) = parse_and_drop(&broken) {
                assert!(MeshReport::of(&imported.mesh).is_sound(), "{kind:?}");
            }
        }
    }
}

#[test]
fn files_that_are_not_there_are_named() {
    let options = ImportOptions::default();
    let error = read_mesh(Path::new("no/such.msh"), &options).expect_err("absent");
    assert!(error.to_string().contains("no/such.msh"), "{error}");
    let error = read_mesh(Path::new("/"), &options).expect_err("a folder");
    assert!(error.to_string().contains("not a plain file"), "{error}");
}
