//! Gmsh MSH 2: `$Nodes` (number, x, y, z) and `$Elements` (number, type, tags, nodes).

use super::cells::{self, CellType};
use super::cursor::{Cursor, Read};
use super::msh::{PhysicalNames, Regions, sections};
use super::raw::RawMesh;

/// Reads everything behind `$MeshFormat`.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<RawMesh> {
    let mut reader = Reader::default();
    sections(cursor, |cursor, name| {
        match name {
            "$PhysicalNames" => reader.names = PhysicalNames::read(cursor)?,
            "$Nodes" => reader.read_nodes(cursor)?,
            "$Elements" => reader.read_elements(cursor)?,
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    let Reader { mut raw, names, regions } = reader;
    regions.name(&mut raw, |(physical, entity)| names.region_name(physical, entity))?;
    Ok(raw)
}

#[derive(Default)]
struct Reader {
    raw: RawMesh,
    names: PhysicalNames,
    /// By physical group, if any, and geometric entity.
    regions: Regions<(Option<i64>, i64)>,
}

impl Reader {
    fn read_nodes(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let announced = cursor.text_count("the number of nodes")?;
        cursor.end_of_line("the number of nodes alone on its line")?;
        let count = cursor.room(announced, "nodes", 4, 28)?;
        self.raw.nodes_m.reserve(count);
        self.raw.node_numbers.reserve(count);
        for index in 0..announced {
            cursor.item("node", index, announced);
            let number = positive(cursor, "a node's number")?;
            self.raw.read_node(cursor, number)?;
        }
        Ok(())
    }

    fn read_elements(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let announced = cursor.text_count("the number of elements")?;
        cursor.end_of_line("the number of elements alone on its line")?;
        cursor.room(announced, "elements", 4, 8)?;
        if cursor.is_binary() {
            return self.read_binary_elements(cursor, announced);
        }
        for index in 0..announced {
            cursor.item("element", index, announced);
            let number = positive(cursor, "an element's number")?;
            let cell = cell_type(cursor, number)?;
            let tags = cursor.int("the number of tags")?;
            self.read_element(cursor, cell, number, tags)?;
        }
        Ok(())
    }

    /// In binary, elements come in blocks of one type.
    fn read_binary_elements(&mut self, cursor: &mut Cursor<'_>, announced: u64) -> Read<()> {
        let mut read = 0;
        while read < announced {
            cursor.item("element", read, announced);
            let cell = cell_type(cursor, read + 1)?;
            let in_block = positive(cursor, "the number of elements in a block")?;
            let tags = cursor.int("the number of tags")?;
            if in_block > announced - read {
                return Err(cursor.malformed(format!(
                    "a block of {in_block} elements is more than the {} that are left",
                    announced - read
                )));
            }
            for index in read..read + in_block {
                cursor.item("element", index, announced);
                let number = positive(cursor, "an element's number")?;
                self.read_element(cursor, cell, number, tags)?;
            }
            read += in_block;
        }
        Ok(())
    }

    /// Reads an element's tags (the first two are its physical group and its geometric entity)
    /// and nodes.
    fn read_element(&mut self, cursor: &mut Cursor<'_>, cell: CellType, number: u64, tags: i64) -> Read<()> {
        let mut first_two = [0, 0];
        for index in 0..tags {
            let tag = cursor.int("a tag")?;
            match index {
                0 => first_two[0] = tag,
                1 => first_two[1] = tag,
                _ => {}
            }
        }
        let physical = (first_two[0] != 0).then_some(first_two[0].saturating_abs());
        let region = self.regions.index((physical, first_two[1]));
        self.raw.read_cell(cursor, cell, number, region, |c| positive(c, "a node's number"))
    }
}

fn cell_type(cursor: &mut Cursor<'_>, element: u64) -> Read<CellType> {
    let code = cursor.int("an element's type")?;
    cells::gmsh(code).ok_or_else(|| unknown_type(cursor, code, element))
}

/// The failure for an element type that nothing is known about.
pub(super) fn unknown_type(cursor: &Cursor<'_>, code: i64, element: u64) -> Box<super::cursor::Failure> {
    cursor.failure(super::error::Problem::CellKind { element, kind: format!("cell of unknown type {code}") })
}

fn positive(cursor: &mut Cursor<'_>, wanted: &'static str) -> Read<u64> {
    let value = cursor.int(wanted)?;
    u64::try_from(value)
        .ok()
        .filter(|&value| value > 0)
        .ok_or_else(|| cursor.unexpected(wanted, value.to_string().as_bytes()))
}
