//! Makes a raw mesh fit for use: nodes by index, right-handed, no bad elements, no unused nodes.

use super::cursor::{Cursor, Failure, Read};
use super::error::{Place, Problem};
use super::raw::{RawMesh, RawTet, counted, whole_file};
use super::{ImportOptions, ImportedMesh};
use crate::mesh::{ElementShape, Surface, TetMesh};

/// Below this quality an element counts as flat: its volume is lost in the rounding of
/// coordinates given to single precision.
const FLAT_QUALITY: f64 = 1e-8;

/// Checks a raw mesh and makes it a [`TetMesh`].
pub(super) fn finish(mut raw: RawMesh, cursor: &Cursor<'_>, options: &ImportOptions) -> Read<ImportedMesh> {
    if raw.tets.is_empty() {
        let found = match raw.left_out_text() {
            text if text.is_empty() => counted(raw.nodes_m.len() as u64, "node"),
            text => text,
        };
        return Err(whole_file(Problem::NoTetrahedra { found }));
    }
    let mut mesh = connect(&mut raw, cursor)?;
    note_conversions(&mut raw);
    turn_if_left_handed(&mut mesh, &mut raw.notes);
    let dropped_elements = handle_bad_elements(&mut mesh, &mut raw, cursor, options)?;
    refuse_overlap(&mesh)?;
    let unused_nodes = drop_unused_nodes(&mut mesh, &mut raw.notes);
    if let [only] = mesh.region_names.as_mut_slice()
        && only == "0"
    {
        "all".clone_into(only);
    }
    Ok(ImportedMesh { mesh, notes: raw.notes, format: "", dropped_elements, unused_nodes })
}

/// Finds nodes by their numbers in the file.
struct NodeIndex {
    /// Number and index of every node, by number.
    sorted: Vec<(u64, u32)>,
}

impl NodeIndex {
    fn new(numbers: &[u64]) -> Read<Self> {
        if u32::try_from(numbers.len()).is_err() {
            let text = format!("{} nodes are more than can be used", numbers.len());
            return Err(whole_file(Problem::Malformed(text)));
        }
        let mut sorted: Vec<(u64, u32)> = numbers.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(whole_file(Problem::NodeTwice { node: pair[0].0 }));
        }
        Ok(Self { sorted })
    }

    fn find(&self, number: u64) -> Option<u32> {
        let first = self.sorted.first()?.0;
        // Numbers without gaps, the usual case, are found at once.
        let guess = usize::try_from(number.wrapping_sub(first)).ok();
        if let Some(&(found, index)) = guess.and_then(|at| self.sorted.get(at))
            && found == number
        {
            return Some(index);
        }
        let at = self.sorted.binary_search_by_key(&number, |entry| entry.0).ok()?;
        Some(self.sorted[at].1)
    }
}

/// Replaces node numbers by indices.
fn connect(raw: &mut RawMesh, cursor: &Cursor<'_>) -> Read<TetMesh> {
    let index = NodeIndex::new(&raw.node_numbers)?;
    let mut mesh = TetMesh {
        tets: Vec::with_capacity(raw.tets.len()),
        regions: raw.tets.iter().map(|tet| tet.region).collect(),
        nodes_m: std::mem::take(&mut raw.nodes_m),
        region_names: std::mem::take(&mut raw.region_names),
    };
    if mesh.region_names.is_empty() {
        mesh.region_names.push("all".to_owned());
    }
    for tet in &raw.tets {
        let mut corners = [0; 4];
        for (corner, node) in corners.iter_mut().zip(tet.nodes) {
            *corner = index
                .find(node)
                .ok_or_else(|| at_element(cursor, tet, Problem::MissingNode { element: tet.number, node }))?;
        }
        mesh.tets.push(corners);
    }
    Ok(mesh)
}

fn at_element(cursor: &Cursor<'_>, tet: &RawTet, problem: Problem) -> Box<Failure> {
    Box::new(Failure {
        place: Place { position: Some(cursor.position(tet.at)), ..Place::default() },
        problem,
    })
}

fn note_conversions(raw: &mut RawMesh) {
    if !raw.left_out.is_empty() {
        raw.notes.push(format!("left out: {}", raw.left_out_text()));
    }
    if raw.quadratic > 0 {
        let text = format!("{} 10-node tetrahedra reduced to their 4 corners", raw.quadratic);
        raw.notes.push(text);
    }
}

/// Turns all elements when most of them are left-handed: then it is the file's convention.
fn turn_if_left_handed(mesh: &mut TetMesh, notes: &mut Vec<String>) {
    let volumes = (0..mesh.tets.len()).map(|tet| ElementShape::of(&mesh.corners_m(tet)).volume_m3);
    let (left, right) = volumes.fold((0_usize, 0_usize), |(left, right), volume| {
        (left + usize::from(volume < 0.0), right + usize::from(volume > 0.0))
    });
    if left > right {
        mesh.tets.iter_mut().for_each(|tet| tet.swap(2, 3));
        notes.push("left-handed elements turned: the whole file numbers them that way".to_owned());
    }
}

/// Refuses or drops elements that cannot be simulated; returns how many were dropped.
fn handle_bad_elements(
    mesh: &mut TetMesh,
    raw: &mut RawMesh,
    cursor: &Cursor<'_>,
    options: &ImportOptions,
) -> Read<usize> {
    let bad = bad_elements(mesh, &raw.tets);
    let Some((first, fault)) = bad.first() else {
        return Ok(0);
    };
    let total = mesh.tets.len();
    if !options.drop_bad_elements {
        let tet = &raw.tets[*first];
        let problem =
            Problem::BadElement { element: tet.number, fault: fault.clone(), bad: bad.len(), total };
        return Err(at_element(cursor, tet, problem));
    }
    if bad.len() == total {
        return Err(whole_file(Problem::NothingLeft { total }));
    }
    raw.notes.push(dropped_note(&bad, &raw.tets));
    let mut keep = vec![true; total];
    bad.iter().for_each(|&(tet, _)| keep[tet] = false);
    retain_by(&mut mesh.tets, &keep);
    retain_by(&mut mesh.regions, &keep);
    Ok(bad.len())
}

fn retain_by<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    values.retain(|_| flags.next().copied().unwrap_or(true));
}

fn dropped_note(bad: &[(usize, String)], tets: &[RawTet]) -> String {
    const MOST_NAMED: usize = 8;
    let named: Vec<String> =
        bad.iter().take(MOST_NAMED).map(|&(tet, _)| tets[tet].number.to_string()).collect();
    let more = if bad.len() > MOST_NAMED { ", ..." } else { "" };
    format!("{} bad elements of {} dropped: {}{more}", bad.len(), tets.len(), named.join(", "))
}

/// Indices of the elements that cannot be simulated, ascending, each with what is wrong.
fn bad_elements(mesh: &TetMesh, tets: &[RawTet]) -> Vec<(usize, String)> {
    let mut bad: Vec<(usize, String)> =
        (0..mesh.tets.len()).filter_map(|tet| Some((tet, fault_of(mesh, tet, &tets[tet])?))).collect();
    bad.extend(doubled_elements(mesh, tets));
    bad.sort_by_key(|entry| entry.0);
    bad.dedup_by_key(|entry| entry.0);
    bad
}

fn fault_of(mesh: &TetMesh, tet: usize, raw: &RawTet) -> Option<String> {
    for (i, node) in raw.nodes.iter().enumerate() {
        if raw.nodes[..i].contains(node) {
            return Some(format!("flat: it uses node {node} twice"));
        }
    }
    let shape = ElementShape::of(&mesh.corners_m(tet));
    if !shape.volume_m3.is_finite() {
        Some("too large for its volume to be a number".to_owned())
    } else if shape.quality < FLAT_QUALITY {
        Some(format!("flat (volume {:.3e})", shape.volume_m3))
    } else if shape.volume_m3 < 0.0 {
        Some(format!("inverted (volume {:.3e})", shape.volume_m3))
    } else {
        None
    }
}

/// Elements whose four nodes another element has, too; the first of them is fine.
fn doubled_elements(mesh: &TetMesh, tets: &[RawTet]) -> Vec<(usize, String)> {
    let mut sorted: Vec<([u32; 4], usize)> = mesh
        .tets
        .iter()
        .enumerate()
        .map(|(tet, corners)| {
            let mut corners = *corners;
            corners.sort_unstable();
            (corners, tet)
        })
        .collect();
    sorted.sort_unstable();
    sorted
        .chunk_by(|a, b| a.0 == b.0)
        .flat_map(|group| {
            let first = tets[group[0].1].number;
            group[1..].iter().map(move |&(_, tet)| (tet, format!("the same as element {first}")))
        })
        .collect()
}

fn refuse_overlap(mesh: &TetMesh) -> Read<()> {
    match Surface::of(&mesh.tets).overused_faces {
        0 => Ok(()),
        faces => Err(whole_file(Problem::Overlap { faces })),
    }
}

/// Keeps the nodes that elements use, in their order; returns how many went.
fn drop_unused_nodes(mesh: &mut TetMesh, notes: &mut Vec<String>) -> usize {
    let mut used = vec![false; mesh.nodes_m.len()];
    for &node in mesh.tets.as_flattened() {
        used[node as usize] = true;
    }
    let unused = used.iter().filter(|&&used| !used).count();
    if unused == 0 {
        return 0;
    }
    let mut kept_before = 0;
    let new_index: Vec<u32> = used
        .iter()
        .map(|&used| {
            let index = kept_before;
            kept_before += u32::from(used);
            index
        })
        .collect();
    retain_by(&mut mesh.nodes_m, &used);
    for node in mesh.tets.as_flattened_mut() {
        *node = new_index[*node as usize];
    }
    let text = counted(unused as u64, "node");
    notes.push(format!("{text} dropped that no element uses"));
    unused
}
