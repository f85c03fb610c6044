//! Data behind the cells of a legacy VTK file: of all that, material numbers are of use.

use super::cursor::{Cursor, NumberKind, Read, readable};
use super::vtk::number_kind;

/// Names under which programs write a cell's material or region.
const REGION_NAMES: [&str; 16] = [
    "mat_id",
    "material",
    "material_id",
    "materialid",
    "materialids",
    "material_ids",
    "materials",
    "region",
    "region_id",
    "regions",
    "gmsh:physical",
    "medit:ref",
    "cellentityids",
    "cell_tags",
    "attribute",
    "subdomain",
];

/// Reads the attributes from `CELL_DATA` or `POINT_DATA` on (`keyword`, already taken) and returns
/// the region number of each cell if there is one. Stops with a note at what it does not know.
pub(super) fn read_regions(
    cursor: &mut Cursor<'_>,
    keyword: &str,
    notes: &mut Vec<String>,
) -> Read<Option<Vec<i64>>> {
    let mut regions = None;
    let mut of_cells = keyword.eq_ignore_ascii_case("CELL_DATA");
    let mut count = read_count(cursor)?;
    while cursor.peek_word().is_some() {
        let word = cursor.word("an attribute")?.to_ascii_uppercase();
        match word.as_slice() {
            b"CELL_DATA" | b"POINT_DATA" => {
                of_cells = word == b"CELL_DATA";
                cursor.enter(&readable(&word));
                count = read_count(cursor)?;
            }
            b"METADATA" => skip_metadata(cursor),
            _ => {
                let mut keep = |name: &str, values: &[f64]| {
                    if of_cells && regions.is_none() && values.len() as u64 == count {
                        regions = region_numbers(name, values);
                    }
                };
                if !read_attribute(cursor, &word, count, &mut keep)? {
                    notes.push(format!("data from {} on not read", readable(&word)));
                    break;
                }
            }
        }
    }
    Ok(regions)
}

fn read_count(cursor: &mut Cursor<'_>) -> Read<u64> {
    let count = cursor.text_count("the number of cells or points")?;
    cursor.end_of_line("the count alone on its line")?;
    Ok(count)
}

/// Whole numbers under a name that means a material.
fn region_numbers(name: &str, values: &[f64]) -> Option<Vec<i64>> {
    const EXACT: f64 = 9.0e15;
    let known = REGION_NAMES.contains(&name.to_ascii_lowercase().as_str());
    let whole = values.iter().all(|value| value.fract() == 0.0 && value.abs() < EXACT);
    #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and in range")]
    (known && whole).then(|| values.iter().map(|&value| value as i64).collect())
}

/// What to do with an array: its name and values.
type Keep<'k> = dyn FnMut(&str, &[f64]) + 'k;

/// Reads one attribute; returns whether its kind is known.
fn read_attribute(cursor: &mut Cursor<'_>, keyword: &[u8], count: u64, keep: &mut Keep<'_>) -> Read<bool> {
    let components = match keyword {
        b"SCALARS" => return read_scalars(cursor, count, keep),
        b"FIELD" => return read_field(cursor, keep),
        b"VECTORS" | b"NORMALS" => 3,
        b"TENSORS" => 9,
        _ => return Ok(false),
    };
    cursor.word("a name")?;
    let word = cursor.word("a number type")?;
    let Some(kind) = number_kind(word) else {
        return Ok(false);
    };
    cursor.end_of_line("the end of the line")?;
    skip_array(cursor, kind, count.saturating_mul(components))?;
    Ok(true)
}

/// `SCALARS name type [components]`, then `LOOKUP_TABLE name`.
fn read_scalars(cursor: &mut Cursor<'_>, count: u64, keep: &mut Keep<'_>) -> Read<bool> {
    let name = readable(cursor.word("a name")?);
    let words = cursor.line().to_ascii_lowercase();
    let mut words = words.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
    let Some(kind) = words.next().and_then(number_kind) else {
        return Ok(false);
    };
    let components = match words.next() {
        None => 1,
        Some(text) => match std::str::from_utf8(text).ok().and_then(|t| t.parse().ok()) {
            Some(components) => components,
            None => return Err(cursor.unexpected("the number of components", text)),
        },
    };
    if cursor.is_at(b"LOOKUP_TABLE") {
        cursor.word("LOOKUP_TABLE")?;
        cursor.line();
    }
    if components == 1 {
        keep(&name, &read_array(cursor, kind, count)?);
    } else {
        skip_array(cursor, kind, count.saturating_mul(components))?;
    }
    Ok(true)
}

/// `FIELD name arrays`, each `name components tuples type` and its data; returns whether all
/// number types are known.
pub(super) fn read_field(cursor: &mut Cursor<'_>, keep: &mut Keep<'_>) -> Read<bool> {
    cursor.word("a name")?;
    let arrays = cursor.text_count("the number of arrays")?;
    for _ in 0..arrays {
        let mut name = readable(cursor.word("an array's name")?);
        while name.eq_ignore_ascii_case("METADATA") {
            skip_metadata(cursor);
            name = readable(cursor.word("an array's name")?);
        }
        let components = cursor.text_count("the number of components")?;
        let tuples = cursor.text_count("the number of tuples")?;
        let word = cursor.word("a number type")?;
        let Some(kind) = number_kind(word) else {
            return Ok(false);
        };
        cursor.end_of_line("the end of the line")?;
        if components == 1 {
            keep(&name, &read_array(cursor, kind, tuples)?);
        } else {
            skip_array(cursor, kind, components.saturating_mul(tuples))?;
        }
    }
    Ok(true)
}

fn read_array(cursor: &mut Cursor<'_>, kind: NumberKind, announced: u64) -> Read<Vec<f64>> {
    let count = cursor.room(announced, "numbers", 1, kind.bytes())?;
    let mut values = Vec::with_capacity(count);
    for index in 0..announced {
        cursor.item("number", index, announced);
        values.push(cursor.typed_number(kind, "a number")?);
    }
    cursor.all_items_read();
    Ok(values)
}

fn skip_array(cursor: &mut Cursor<'_>, kind: NumberKind, announced: u64) -> Read<()> {
    cursor.room(announced, "numbers", 1, kind.bytes())?;
    if cursor.is_binary() {
        return cursor.skip_bytes(announced.saturating_mul(kind.bytes() as u64), "numbers");
    }
    for index in 0..announced {
        cursor.item("number", index, announced);
        cursor.word("a number")?;
    }
    cursor.all_items_read();
    Ok(())
}

/// `METADATA` goes on to the next empty line.
pub(super) fn skip_metadata(cursor: &mut Cursor<'_>) {
    cursor.line();
    while !cursor.line().is_empty() {}
}
