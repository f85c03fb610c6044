//! Gmsh MSH files: what both versions share.
//!
//! A file is a sequence of sections `$Name` ... `$EndName`, in text or binary as `$MeshFormat`
//! says. Unknown sections are skipped.

use super::cursor::{Cursor, Encoding, Endian, Read, readable};
use super::error::Problem;
use super::raw::RawMesh;
use super::{msh2, msh4};
use std::collections::BTreeMap;

/// Reads an MSH file.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<RawMesh> {
    match read_format(cursor)? {
        Version::V2 => msh2::read(cursor),
        Version::V4 => msh4::read(cursor),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    V2,
    V4,
}

fn read_format(cursor: &mut Cursor<'_>) -> Read<Version> {
    cursor.skip_past(b"$MeshFormat");
    cursor.enter("$MeshFormat");
    let text = cursor.word("the version")?;
    let version = match text {
        b"2" | b"2.0" | b"2.1" | b"2.2" => Version::V2,
        b"4.1" => Version::V4,
        _ => {
            return Err(cursor.failure(Problem::UnsupportedVariant {
                what: format!("Gmsh MSH version {}", version_name(text)),
                advice: "save it as MSH 4.1 (`gmsh FILE -save -format msh41`)",
            }));
        }
    };
    let binary = cursor.int("0 for text or 1 for binary")?;
    let size = cursor.int("the size of a real number, 8")?;
    if size != 8 {
        return Err(cursor.malformed(format!("real numbers of {size} bytes are not read, only 8")));
    }
    match binary {
        0 => {}
        1 => read_byte_order(cursor)?,
        _ => return Err(cursor.malformed("text files say 0 and binary files 1 here")),
    }
    end_section(cursor, "$MeshFormat")?;
    Ok(version)
}

/// Files of version 4.0 call it 4.
fn version_name(text: &[u8]) -> String {
    match text {
        b"4" => "4.0".to_owned(),
        _ => readable(text),
    }
}

/// A binary file shows its byte order by the number 1.
fn read_byte_order(cursor: &mut Cursor<'_>) -> Read<()> {
    cursor.end_of_line("the end of the line")?;
    cursor.encoding = Encoding::Binary(Endian::Little);
    cursor.encoding = match cursor.int("the number 1, which shows the byte order")? {
        1 => Encoding::Binary(Endian::Little),
        0x0100_0000 => Encoding::Binary(Endian::Big),
        _ => return Err(cursor.malformed("the number 1, which shows the byte order, is broken")),
    };
    Ok(())
}

/// Takes all sections to `read`, by name; where it gives `false` the section is of no use and skipped.
pub(super) fn sections<'a>(
    cursor: &mut Cursor<'a>,
    mut read: impl FnMut(&mut Cursor<'a>, &str) -> Read<bool>,
) -> Read<()> {
    while let Some(name) = next_section(cursor)? {
        if read(cursor, &name)? {
            end_section(cursor, &name)?;
        } else {
            skip_section(cursor, &name)?;
        }
    }
    Ok(())
}

/// The next section's name with its `$`, or `None` at the end of the file.
fn next_section(cursor: &mut Cursor<'_>) -> Read<Option<String>> {
    cursor.leave();
    if cursor.peek_word().is_none() {
        return Ok(None);
    }
    let word = cursor.word("a section")?;
    if word.first() != Some(&b'$') {
        return Err(cursor.unexpected("a section (`$...`)", word));
    }
    let name = String::from_utf8_lossy(word).into_owned();
    cursor.enter(&name);
    Ok(Some(name))
}

/// Takes the `$End...` of a section.
fn end_section(cursor: &mut Cursor<'_>, name: &str) -> Read<()> {
    const WANTED: &str = "the end of the section";
    cursor.all_items_read();
    let word = cursor.word(WANTED)?;
    let expected = format!("$End{}", name.trim_start_matches('$'));
    if word == expected.as_bytes() {
        return Ok(());
    }
    Err(cursor.failure(Problem::SectionGoesOn { wanted: WANTED, found: readable(word) }))
}

/// Skips a section that is of no use.
fn skip_section(cursor: &mut Cursor<'_>, name: &str) -> Read<()> {
    let end = format!("$End{}", name.trim_start_matches('$'));
    if cursor.skip_past(end.as_bytes()) {
        Ok(())
    } else {
        Err(cursor.malformed("the section does not end; is the file complete?"))
    }
}

/// Regions by whatever tells them apart. Elements refer to them by index until all names of the
/// file are known.
#[derive(Debug)]
pub(super) struct Regions<K>(BTreeMap<K, u32>);

impl<K> Default for Regions<K> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<K: Ord + Copy> Regions<K> {
    pub fn index(&mut self, key: K) -> u32 {
        let next = u32::try_from(self.0.len()).unwrap_or(u32::MAX);
        *self.0.entry(key).or_insert(next)
    }

    /// Gives the regions that tetrahedra use their names, in order of appearance.
    pub fn name(self, raw: &mut RawMesh, name_of: impl Fn(K) -> String) -> Read<()> {
        let keys: BTreeMap<u32, K> = self.0.into_iter().map(|(key, index)| (index, key)).collect();
        let mut named = BTreeMap::new();
        for tet in 0..raw.tets.len() {
            let index = raw.tets[tet].region;
            let region = match named.get(&index) {
                Some(&region) => region,
                None => {
                    let name = keys.get(&index).map(|&key| name_of(key)).unwrap_or_default();
                    *named.entry(index).or_insert(raw.region(&name)?)
                }
            };
            raw.tets[tet].region = region;
        }
        Ok(())
    }
}

/// Names of the physical groups of volumes, by number.
#[derive(Debug, Default)]
pub(super) struct PhysicalNames(BTreeMap<i64, String>);

impl PhysicalNames {
    /// Reads the section, which is text in binary files, too.
    pub fn read(cursor: &mut Cursor<'_>) -> Read<Self> {
        let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Ascii);
        let result = Self::read_text(cursor);
        cursor.encoding = encoding;
        result
    }

    fn read_text(cursor: &mut Cursor<'_>) -> Read<Self> {
        let mut names = Self::default();
        let count = cursor.size("the number of names")?;
        for index in 0..count {
            cursor.item("name", index, count);
            let dimension = cursor.int("the dimension of a physical group")?;
            let number = cursor.int("the number of a physical group")?;
            let line = String::from_utf8_lossy(cursor.line()).into_owned();
            if dimension == 3 {
                names.0.insert(number, line.trim_matches('"').to_owned());
            }
        }
        Ok(names)
    }

    /// What a region is called: its physical group's name or number, or else the number of its
    /// geometric entity.
    pub fn region_name(&self, physical: Option<i64>, entity: i64) -> String {
        match physical {
            Some(number) => self
                .0
                .get(&number)
                .filter(|name| !name.is_empty())
                .cloned()
                .unwrap_or_else(|| number.to_string()),
            None => entity.to_string(),
        }
    }
}
