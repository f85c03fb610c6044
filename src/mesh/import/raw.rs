//! A mesh as a file states it.

use super::cells::{CellType, Role};
use super::cursor::{Cursor, Failure, Read};
use super::error::{Place, Problem};
use glam::DVec3;
use std::collections::BTreeMap;

/// Nodes and tetrahedra with the numbers the file gives them.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub nodes_m: Vec<DVec3>,
    /// Number of each node in the file.
    pub node_numbers: Vec<u64>,
    pub tets: Vec<RawTet>,
    pub region_names: Vec<String>,
    pub notes: Vec<String>,
    /// Kinds and numbers of cells left out.
    pub left_out: Vec<(&'static str, u64)>,
    /// Number of 10-node tetrahedra.
    pub quadratic: u64,
    /// Regions whose names are numbers.
    numbered: BTreeMap<i64, u32>,
    /// Regions by name: a file may have as many as elements.
    named: BTreeMap<String, u32>,
}

/// A tetrahedron of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawTet {
    /// Numbers of its corner nodes in the file.
    pub nodes: [u64; 4],
    /// Number of the element in the file.
    pub number: u64,
    /// Index into the region names.
    pub region: u32,
    /// Where it stands in the file, bytes.
    pub at: usize,
}

impl RawMesh {
    /// Reads the coordinates of a node.
    pub fn read_node(&mut self, cursor: &mut Cursor<'_>, number: u64) -> Read<()> {
        let mut at = [0.0; 3];
        for (value, wanted) in at.iter_mut().zip(["an x coordinate", "a y coordinate", "a z coordinate"]) {
            *value = cursor.real(wanted)?;
        }
        self.add_node(cursor, number, at)
    }

    /// Adds a node; refuses places that are not finite.
    pub fn add_node(&mut self, cursor: &Cursor<'_>, number: u64, at: [f64; 3]) -> Read<()> {
        let position_m = DVec3::from_array(at);
        if !position_m.is_finite() {
            return Err(cursor.failure(Problem::NotFinite { node: number, at }));
        }
        self.nodes_m.push(position_m);
        self.node_numbers.push(number);
        Ok(())
    }

    /// Reads the nodes of a cell and keeps it if it is a tetrahedron.
    pub fn read_cell(
        &mut self,
        cursor: &mut Cursor<'_>,
        cell: CellType,
        number: u64,
        region: u32,
        mut read_node_number: impl FnMut(&mut Cursor<'_>) -> Read<u64>,
    ) -> Read<()> {
        self.check_kind(cursor, cell, number)?;
        let mut nodes = [0; 4];
        let mut at = cursor.last();
        for corner in 0..cell.nodes {
            let node = read_node_number(cursor)?;
            match corner {
                0 => (nodes[0], at) = (node, cursor.last()),
                1 => nodes[1] = node,
                2 => nodes[2] = node,
                3 => nodes[3] = node,
                _ => {}
            }
        }
        self.keep_cell(cell, RawTet { nodes, number, region, at });
        Ok(())
    }

    /// Refuses cells that cannot be used.
    pub fn check_kind(&self, cursor: &Cursor<'_>, cell: CellType, number: u64) -> Read<()> {
        if cell.role == Role::Refused {
            return Err(cursor.failure(Problem::CellKind { element: number, kind: cell.name.to_owned() }));
        }
        Ok(())
    }

    /// Keeps a cell if it is a tetrahedron, else counts it.
    pub fn keep_cell(&mut self, cell: CellType, tet: RawTet) {
        match cell.role {
            Role::Tetrahedron => self.tets.push(tet),
            Role::QuadraticTetrahedron => {
                self.quadratic += 1;
                self.tets.push(tet);
            }
            Role::LowerDimension | Role::Refused => self.leave_out(cell.name, 1),
        }
    }

    fn leave_out(&mut self, name: &'static str, count: u64) {
        match self.left_out.iter_mut().find(|entry| entry.0 == name) {
            Some(entry) => entry.1 += count,
            None => self.left_out.push((name, count)),
        }
    }

    /// Index of the region called `name`, which is added if it is new.
    pub fn region(&mut self, name: &str) -> Read<u32> {
        if let Some(&region) = self.named.get(name) {
            return Ok(region);
        }
        let region = u32::try_from(self.region_names.len())
            .map_err(|_| whole_file(Problem::Malformed("too many regions".into())))?;
        self.region_names.push(name.to_owned());
        self.named.insert(name.to_owned(), region);
        Ok(region)
    }

    /// Index of the region that is called by a number.
    pub fn numbered_region(&mut self, number: i64) -> Read<u32> {
        if let Some(&region) = self.numbered.get(&number) {
            return Ok(region);
        }
        let region = self.region(&number.to_string())?;
        self.numbered.insert(number, region);
        Ok(region)
    }

    pub fn left_out_text(&self) -> String {
        let parts: Vec<String> = self.left_out.iter().map(|&(name, count)| counted(count, name)).collect();
        parts.join(", ")
    }
}

/// `1 line`, `3 lines`.
pub(super) fn counted(count: u64, name: &str) -> String {
    format!("{count} {name}{}", if count == 1 { "" } else { "s" })
}

pub(super) fn whole_file(problem: Problem) -> Box<Failure> {
    Box::new(Failure { place: Place::default(), problem })
}
