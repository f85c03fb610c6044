//! Gmsh MSH 4.1: nodes and elements in blocks, each of one geometric entity.

use super::cells::{self, CellType};
use super::cursor::{Cursor, Read};
use super::msh::{PhysicalNames, Regions, sections};
use super::msh2::unknown_type;
use super::raw::RawMesh;
use std::collections::BTreeMap;

/// Reads everything behind `$MeshFormat`.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<RawMesh> {
    let mut reader = Reader::default();
    sections(cursor, |cursor, name| {
        match name {
            "$PhysicalNames" => reader.names = PhysicalNames::read(cursor)?,
            "$Entities" => reader.read_entities(cursor)?,
            "$Nodes" => reader.read_nodes(cursor)?,
            "$Elements" => reader.read_elements(cursor)?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let Reader { mut raw, names, physical_of_volume, regions } = reader;
    regions.name(&mut raw, |volume| names.region_name(physical_of_volume.get(&volume).copied(), volume))?;
    Ok(raw)
}

#[derive(Default)]
struct Reader {
    raw: RawMesh,
    names: PhysicalNames,
    /// First physical group of each volume.
    physical_of_volume: BTreeMap<i64, i64>,
    /// By geometric entity.
    regions: Regions<i64>,
}

impl Reader {
    /// Counts of points, curves, surfaces and volumes, then a record each.
    fn read_entities(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        end_of_name(cursor)?;
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = cursor.size("the number of entities of a dimension")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for index in 0..count {
                cursor.item("entity", index, count);
                self.read_entity(cursor, dimension)?;
            }
        }
        Ok(())
    }

    fn read_entity(&mut self, cursor: &mut Cursor<'_>, dimension: usize) -> Read<()> {
        let number = cursor.int("an entity's number")?;
        let reals = if dimension == 0 { 3 } else { 6 };
        for _ in 0..reals {
            cursor.real("a coordinate of an entity")?;
        }
        let groups = cursor.size("the number of physical groups")?;
        for index in 0..groups {
            let group = cursor.int("a physical group")?;
            if dimension == 3 && index == 0 {
                self.physical_of_volume.insert(number, group.saturating_abs());
            }
        }
        if dimension > 0 {
            let boundaries = cursor.size("the number of bounding entities")?;
            for _ in 0..boundaries {
                cursor.int("a bounding entity")?;
            }
        }
        Ok(())
    }

    fn read_nodes(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let [blocks, announced] = read_header(cursor, "the number of nodes")?;
        // A number and three coordinates.
        let count = cursor.room(announced, "nodes", 4, 32)?;
        self.raw.nodes_m.reserve(count);
        self.raw.node_numbers.reserve(count);
        let mut read = 0;
        for block in 0..blocks {
            cursor.item("block of nodes", block, blocks);
            read += self.read_node_block(cursor)?;
        }
        check_total(cursor, "nodes", announced, read)
    }

    /// All numbers of a block, then all places; returns how many.
    fn read_node_block(&mut self, cursor: &mut Cursor<'_>) -> Read<u64> {
        let dimension = read_dimension(cursor)?;
        cursor.int("an entity's number")?;
        let parametric = cursor.int("whether parameters are given")? != 0;
        let announced = cursor.size("the number of nodes in a block")?;
        cursor.end_of_line_in_text("the number of nodes at the end of its line")?;
        let count = cursor.room(announced, "nodes", 4, 32)?;
        let mut numbers = Vec::with_capacity(count);
        for index in 0..announced {
            cursor.item("node", index, announced);
            numbers.push(cursor.size("a node's number")?);
        }
        for (number, index) in numbers.into_iter().zip(0..) {
            cursor.item("node", index, announced);
            self.raw.read_node(cursor, number)?;
            if parametric {
                for _ in 0..dimension {
                    cursor.real("a node's parameter on its entity")?;
                }
            }
        }
        Ok(announced)
    }

    fn read_elements(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let [blocks, announced] = read_header(cursor, "the number of elements")?;
        // A number and a node at least.
        cursor.room(announced, "elements", 2, 16)?;
        let mut read = 0;
        for block in 0..blocks {
            cursor.item("block of elements", block, blocks);
            read += self.read_element_block(cursor)?;
        }
        check_total(cursor, "elements", announced, read)
    }

    fn read_element_block(&mut self, cursor: &mut Cursor<'_>) -> Read<u64> {
        read_dimension(cursor)?;
        let entity = cursor.int("an entity's number")?;
        let code = cursor.int("an element's type")?;
        let announced = cursor.size("the number of elements in a block")?;
        cursor.end_of_line_in_text("the number of elements at the end of its line")?;
        cursor.room(announced, "elements", 2, 16)?;
        let region = self.regions.index(entity);
        for index in 0..announced {
            cursor.item("element", index, announced);
            let number = cursor.size("an element's number")?;
            let cell: CellType = cells::gmsh(code).ok_or_else(|| unknown_type(cursor, code, number))?;
            self.raw.read_cell(cursor, cell, number, region, |c| c.size("a node's number"))?;
        }
        Ok(announced)
    }
}

/// Binary data begins right behind the line of the section's name.
fn end_of_name(cursor: &mut Cursor<'_>) -> Read<()> {
    cursor.end_of_line("the section's name alone on its line")
}

/// Number of blocks and of items; the smallest and largest number follow and are not needed.
fn read_header(cursor: &mut Cursor<'_>, wanted: &'static str) -> Read<[u64; 2]> {
    end_of_name(cursor)?;
    let blocks = cursor.size("the number of blocks")?;
    let items = cursor.size(wanted)?;
    cursor.size("the smallest number")?;
    cursor.size("the largest number")?;
    cursor.end_of_line_in_text("four counts on the line")?;
    Ok([blocks, items])
}

fn read_dimension(cursor: &mut Cursor<'_>) -> Read<i64> {
    let dimension = cursor.int("an entity's dimension")?;
    if (0..=3).contains(&dimension) {
        Ok(dimension)
    } else {
        Err(cursor.unexpected("an entity's dimension, 0 to 3", dimension.to_string().as_bytes()))
    }
}

fn check_total(cursor: &Cursor<'_>, items: &'static str, announced: u64, read: u64) -> Read<()> {
    if announced == read {
        return Ok(());
    }
    Err(cursor.malformed(format!("the section announces {announced} {items}, but its blocks hold {read}")))
}
