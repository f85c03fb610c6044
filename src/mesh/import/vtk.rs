//! Legacy VTK files (`DATASET UNSTRUCTURED_GRID`), text or big-endian binary.
//!
//! Up to version 4.2 each cell is a count and its points; from 5 on there are two arrays,
//! offsets and connectivity.

use super::cells::{self, CellType};
use super::cursor::{Cursor, Encoding, Endian, NumberKind, Read, readable};
use super::error::Problem;
use super::msh2::unknown_type;
use super::raw::{RawMesh, RawTet};
use super::vtk_attributes::{read_field, read_regions, skip_metadata};

/// Reads a VTK file.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<RawMesh> {
    let arrays = read_header(cursor)?;
    let mut reader = Reader { raw: RawMesh::default(), cells: Cells::default(), types: None, arrays };
    while cursor.peek_word().is_some() {
        cursor.all_items_read();
        let word = cursor.word("a keyword")?;
        let keyword = readable(word);
        cursor.enter(&keyword);
        match keyword.to_ascii_uppercase().as_str() {
            "POINTS" => reader.read_points(cursor)?,
            "CELLS" => reader.read_cells(cursor)?,
            "CELL_TYPES" => reader.read_types(cursor)?,
            "METADATA" => skip_metadata(cursor),
            "FIELD" => {
                read_field(cursor, &mut |_, _| {})?;
            }
            "CELL_DATA" | "POINT_DATA" => return reader.finish(cursor, Some(&keyword)),
            _ => {
                return Err(cursor.failure(Problem::SectionGoesOn {
                    wanted: "a keyword (POINTS, CELLS, CELL_TYPES, CELL_DATA)",
                    found: keyword,
                }));
            }
        }
    }
    reader.finish(cursor, None)
}

/// Reads the four lines of the head; returns whether cells come as offsets and connectivity.
fn read_header(cursor: &mut Cursor<'_>) -> Read<bool> {
    cursor.skip_past(b"DataFile");
    cursor.enter("header");
    let first = readable(cursor.line());
    let version = first.trim().trim_start_matches("Version").trim();
    let major: u32 = version
        .split('.')
        .next()
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| cursor.unexpected("the version", first.as_bytes()))?;
    if !(1..=5).contains(&major) {
        return Err(cursor.failure(Problem::UnsupportedVariant {
            what: format!("legacy VTK version {version}"),
            advice: "save it as version 4.2 or 5.1",
        }));
    }
    cursor.line();
    let encoding = cursor.word("ASCII or BINARY")?;
    let binary = match encoding.to_ascii_uppercase().as_slice() {
        b"ASCII" => false,
        b"BINARY" => true,
        _ => return Err(cursor.unexpected("ASCII or BINARY", encoding)),
    };
    read_dataset(cursor)?;
    if binary {
        cursor.encoding = Encoding::Binary(Endian::Big);
    }
    Ok(major >= 5)
}

fn read_dataset(cursor: &mut Cursor<'_>) -> Read<()> {
    let keyword = cursor.word("DATASET")?;
    if !keyword.eq_ignore_ascii_case(b"DATASET") {
        return Err(cursor.unexpected("DATASET", keyword));
    }
    let kind = cursor.word("the kind of data set")?;
    if kind.eq_ignore_ascii_case(b"UNSTRUCTURED_GRID") {
        return Ok(());
    }
    Err(cursor.failure(Problem::UnsupportedVariant {
        what: format!("a VTK data set of kind {}", readable(kind)),
        advice: "only UNSTRUCTURED_GRID can hold tetrahedra",
    }))
}

/// Points of all cells in one list.
#[derive(Debug, Default)]
struct Cells {
    /// Where the points of each cell begin; one entry more than there are cells.
    offsets: Vec<u64>,
    points: Vec<u64>,
    /// Where each cell stands in the file, bytes.
    at: Vec<usize>,
}

struct Reader {
    raw: RawMesh,
    cells: Cells,
    types: Option<Vec<CellType>>,
    /// Cells as offsets and connectivity.
    arrays: bool,
}

impl Reader {
    fn read_points(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let announced = cursor.text_count("the number of points")?;
        let kind = read_kind(cursor)?;
        let count = cursor.room(announced, "points", 3, 3 * kind.bytes())?;
        self.raw.nodes_m.reserve(count);
        self.raw.node_numbers.reserve(count);
        for index in 0..announced {
            cursor.item("point", index, announced);
            let mut at = [0.0; 3];
            for (value, wanted) in at.iter_mut().zip(["an x coordinate", "a y coordinate", "a z coordinate"])
            {
                *value = cursor.typed_number(kind, wanted)?;
            }
            self.raw.add_node(cursor, index, at)?;
        }
        Ok(())
    }

    fn read_cells(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let first = cursor.text_count("the number of cells")?;
        let second = cursor.text_count("the size of the cell list")?;
        if self.arrays {
            return self.read_cell_arrays(cursor, first, second);
        }
        // A second list takes the place of the first.
        self.cells = Cells::default();
        cursor.end_of_line("two counts on the line")?;
        let count = cursor.room(first, "cells", 1, 4)?;
        let numbers = cursor.room(second, "numbers", 1, 4)?;
        self.cells.offsets.reserve(count + 1);
        self.cells.points.reserve(numbers.saturating_sub(count));
        self.cells.offsets.push(0);
        for index in 0..first {
            cursor.item("cell", index, first);
            let points = not_negative(cursor, "the number of a cell's points")?;
            self.cells.at.push(cursor.last());
            for _ in 0..points {
                self.cells.points.push(not_negative(cursor, "a point's number")?);
            }
            self.cells.offsets.push(self.cells.points.len() as u64);
        }
        cursor.all_items_read();
        let read = first + self.cells.points.len() as u64;
        if read == second {
            return Ok(());
        }
        Err(cursor
            .malformed(format!("the cell list is announced to hold {second} numbers, but it holds {read}")))
    }

    /// `OFFSETS type`, `CONNECTIVITY type`.
    fn read_cell_arrays(&mut self, cursor: &mut Cursor<'_>, offsets: u64, points: u64) -> Read<()> {
        self.cells.offsets = read_named_array(cursor, b"OFFSETS", offsets)?.0;
        (self.cells.points, self.cells.at) = read_named_array(cursor, b"CONNECTIVITY", points)?;
        let ascending = self.cells.offsets.is_sorted();
        let first_is_zero = self.cells.offsets.first() == Some(&0);
        let last_is_end = self.cells.offsets.last() == Some(&points);
        if offsets > 0 && !(ascending && first_is_zero && last_is_end) {
            return Err(cursor.malformed(format!(
                "the offsets must rise from 0 to {points}, the length of the connectivity"
            )));
        }
        // Of the places of all points only those of first points are of use.
        let firsts = &self.cells.offsets[..self.cells.offsets.len().saturating_sub(1)];
        let place = |&offset: &u64| {
            let index = usize::try_from(offset).unwrap_or(usize::MAX);
            self.cells.at.get(index).copied().unwrap_or_default()
        };
        self.cells.at = firsts.iter().map(place).collect();
        Ok(())
    }

    fn read_types(&mut self, cursor: &mut Cursor<'_>) -> Read<()> {
        let announced = cursor.text_count("the number of cells")?;
        cursor.end_of_line("the number of cells alone on its line")?;
        let count = cursor.room(announced, "cell types", 1, 4)?;
        let mut types = Vec::with_capacity(count);
        for index in 0..announced {
            cursor.item("cell", index, announced);
            let code = cursor.int("a cell's type")?;
            types.push(cells::vtk(code).ok_or_else(|| unknown_type(cursor, code, index))?);
        }
        self.types = Some(types);
        Ok(())
    }

    /// Joins cells and their types and reads the attributes that follow, if any.
    fn finish(mut self, cursor: &mut Cursor<'_>, attributes: Option<&str>) -> Read<RawMesh> {
        cursor.all_items_read();
        let Some(types) = self.types.take() else {
            return Err(cursor.failure(Problem::Ended { wanted: "the section CELL_TYPES" }));
        };
        let count = self.cells.offsets.len().saturating_sub(1);
        if types.len() != count {
            return Err(cursor.malformed(format!("there are {count} cells but {} cell types", types.len())));
        }
        let regions = match attributes {
            Some(keyword) => read_regions(cursor, keyword, &mut self.raw.notes)?,
            None => None,
        };
        for (index, cell) in types.into_iter().enumerate() {
            let region = match &regions {
                Some(regions) => match regions.get(index) {
                    Some(&number) => self.raw.numbered_region(number)?,
                    None => 0,
                },
                None => 0,
            };
            self.keep(cursor, index, cell, region)?;
        }
        Ok(self.raw)
    }

    fn keep(&mut self, cursor: &Cursor<'_>, index: usize, cell: CellType, region: u32) -> Read<()> {
        let number = index as u64;
        self.raw.check_kind(cursor, cell, number)?;
        let [from, to] =
            [index, index + 1].map(|at| usize::try_from(self.cells.offsets[at]).unwrap_or(usize::MAX));
        let points = self.cells.points.get(from..to).unwrap_or_default();
        if cell.nodes != 0 && points.len() as u64 != cell.nodes {
            return Err(cursor.malformed(format!(
                "cell {index} is a {} but has {} points",
                cell.name,
                points.len()
            )));
        }
        let nodes = std::array::from_fn(|corner| points.get(corner).copied().unwrap_or_default());
        let tet = RawTet { nodes, number, region, at: self.cells.at[index] };
        self.raw.keep_cell(cell, tet);
        Ok(())
    }
}

fn not_negative(cursor: &mut Cursor<'_>, wanted: &'static str) -> Read<u64> {
    let value = cursor.int(wanted)?;
    u64::try_from(value).map_err(|_| cursor.unexpected(wanted, value.to_string().as_bytes()))
}

/// A keyword, a number type and an array of indices; also where each number stands.
fn read_named_array(
    cursor: &mut Cursor<'_>,
    keyword: &'static [u8],
    announced: u64,
) -> Read<(Vec<u64>, Vec<usize>)> {
    let wanted = if keyword == b"OFFSETS" { "OFFSETS" } else { "CONNECTIVITY" };
    let word = cursor.word(wanted)?;
    if !word.eq_ignore_ascii_case(keyword) {
        return Err(cursor.unexpected(wanted, word));
    }
    cursor.enter(wanted);
    let kind = read_kind(cursor)?;
    let count = cursor.room(announced, "numbers", 1, kind.bytes())?;
    let (mut numbers, mut places) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for index in 0..announced {
        cursor.item("number", index, announced);
        let number = cursor.typed_number(kind, "a number")?;
        let whole = as_index(number)
            .ok_or_else(|| cursor.unexpected("a whole number from 0", number.to_string().as_bytes()))?;
        numbers.push(whole);
        places.push(cursor.last());
    }
    cursor.all_items_read();
    Ok((numbers, places))
}

/// A whole number up to where `f64` counts exactly.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be whole and in range"
)]
fn as_index(number: f64) -> Option<u64> {
    const EXACT: f64 = 9.0e15;
    ((0.0..EXACT).contains(&number) && number.fract() == 0.0).then_some(number as u64)
}

/// A number type and the end of its line.
fn read_kind(cursor: &mut Cursor<'_>) -> Read<NumberKind> {
    let word = cursor.word("a number type")?;
    let kind = number_kind(word).ok_or_else(|| cursor.unexpected("a number type", word))?;
    cursor.end_of_line("the end of the line")?;
    Ok(kind)
}

pub(super) fn number_kind(word: &[u8]) -> Option<NumberKind> {
    Some(match word.to_ascii_lowercase().as_slice() {
        b"char" => NumberKind::I8,
        b"unsigned_char" => NumberKind::U8,
        b"short" => NumberKind::I16,
        b"unsigned_short" => NumberKind::U16,
        // VTK writes its index type as 32 bits into old files.
        b"int" | b"vtkidtype" => NumberKind::I32,
        b"unsigned_int" => NumberKind::U32,
        b"long" | b"vtktypeint64" => NumberKind::I64,
        b"unsigned_long" | b"vtktypeuint64" => NumberKind::U64,
        b"float" => NumberKind::F32,
        b"double" => NumberKind::F64,
        _ => return None,
    })
}
