//! MEDIT `.mesh` files in text: keywords, each with a count and that many records.

use super::cells::{self, MeditSection};
use super::cursor::{Cursor, Read, readable};
use super::error::Problem;
use super::raw::RawMesh;

/// Reads a MEDIT file.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<RawMesh> {
    let mut raw = RawMesh::default();
    let mut dimension = 3;
    while cursor.peek_word().is_some() {
        cursor.all_items_read();
        let word = cursor.word("a keyword")?;
        if word.starts_with(b"#") {
            cursor.line();
            continue;
        }
        let keyword = readable(word);
        if !word[0].is_ascii_alphabetic() {
            return Err(cursor.failure(Problem::SectionGoesOn { wanted: "a keyword", found: keyword }));
        }
        cursor.enter(&keyword);
        match keyword.to_ascii_lowercase().as_str() {
            "end" => break,
            "meshversionformatted" => {
                cursor.int("the version")?;
            }
            "dimension" => dimension = cursor.int("the dimension")?,
            "vertices" => read_vertices(cursor, &mut raw, dimension)?,
            lower => match section(lower) {
                Some(section) => read_cells(cursor, &mut raw, section)?,
                None => skip_numbers(cursor),
            },
        }
    }
    Ok(raw)
}

fn section(lower_keyword: &str) -> Option<MeditSection> {
    cells::MEDIT.iter().copied().find(|section| section.keyword.eq_ignore_ascii_case(lower_keyword))
}

/// Coordinates and a reference number each; vertices are numbered from 1.
fn read_vertices(cursor: &mut Cursor<'_>, raw: &mut RawMesh, dimension: i64) -> Read<()> {
    if dimension != 3 {
        return Err(cursor.malformed(format!("the mesh has {dimension} dimensions, and a body needs 3")));
    }
    let announced = cursor.size("the number of vertices")?;
    let count = cursor.room(announced, "vertices", 4, 0)?;
    raw.nodes_m.reserve(count);
    raw.node_numbers.reserve(count);
    for index in 0..announced {
        cursor.item("vertex", index, announced);
        raw.read_node(cursor, index + 1)?;
        cursor.real("a vertex's reference number")?;
    }
    Ok(())
}

fn read_cells(cursor: &mut Cursor<'_>, raw: &mut RawMesh, section: MeditSection) -> Read<()> {
    let announced = cursor.size("the number of elements")?;
    let words = usize::try_from(section.cell.nodes).unwrap_or(0) + 1;
    cursor.room(announced, "elements", words, 0)?;
    for index in 0..announced {
        cursor.item("element", index, announced);
        let kept = raw.tets.len();
        raw.read_cell(cursor, section.cell, index + 1, 0, |c| c.size("a node's number"))?;
        let reference = cursor.int("an element's reference number")?;
        if raw.tets.len() > kept {
            raw.tets[kept].region = raw.numbered_region(reference)?;
        }
    }
    Ok(())
}

/// Skips the numbers of a keyword that is of no use.
fn skip_numbers(cursor: &mut Cursor<'_>) {
    while let Some(word) = cursor.peek_word() {
        if word[0].is_ascii_alphabetic() {
            return;
        }
        // The word is there, so taking it cannot fail.
        let _taken = cursor.word("a number");
    }
}
