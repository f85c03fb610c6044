//! Reads a mesh file's bytes, as text or as binary numbers, and knows where it is.

use super::error::{Place, Position, Problem};

/// What a reader returns; the error is boxed because it is large and rare.
pub(super) type Read<T> = Result<T, Box<Failure>>;

/// A problem and where it was met.
#[derive(Debug)]
pub(super) struct Failure {
    pub place: Place,
    pub problem: Problem,
}

/// Byte order of binary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(Endian),
}

/// A place in the bytes of a file. Words are separated by white space; numbers are words or
/// binary, by `encoding`.
pub(super) struct Cursor<'a> {
    data: &'a [u8],
    at: usize,
    /// Where the last word or number began, for messages.
    last: usize,
    pub encoding: Encoding,
    section: Option<String>,
    item: Option<(&'static str, u64, u64)>,
}

impl<'a> Cursor<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self { data, at: 0, last: 0, encoding: Encoding::Ascii, section: None, item: None }
    }

    /// Names the section for messages; none is being counted yet.
    pub fn enter(&mut self, section: &str) {
        self.section = Some(section.to_owned());
        self.item = None;
    }

    pub fn leave(&mut self) {
        self.section = None;
        self.item = None;
    }

    /// Says which of how many items is read next, from 0.
    pub fn item(&mut self, what: &'static str, index: u64, count: u64) {
        self.item = Some((what, index + 1, count));
    }

    pub fn all_items_read(&mut self) {
        self.item = None;
    }

    pub fn is_binary(&self) -> bool {
        self.encoding != Encoding::Ascii
    }

    /// Where the last word or number began, in bytes.
    pub fn last(&self) -> usize {
        self.last
    }

    /// A failure at the last word or number.
    pub fn failure(&self, problem: Problem) -> Box<Failure> {
        Box::new(Failure {
            place: Place {
                position: Some(self.position(self.last)),
                section: self.section.clone(),
                item: self.item,
            },
            problem,
        })
    }

    pub fn malformed(&self, text: impl Into<String>) -> Box<Failure> {
        self.failure(Problem::Malformed(text.into()))
    }

    /// Line of a byte in text, the byte itself in binary.
    pub fn position(&self, at: usize) -> Position {
        if self.is_binary() {
            return Position::Byte(at);
        }
        let before = &self.data[..at.min(self.data.len())];
        Position::Line(1 + before.iter().filter(|&&byte| byte == b'\n').count())
    }

    fn rest(&self) -> &'a [u8] {
        &self.data[self.at..]
    }

    fn skip_white(&mut self) {
        let rest = self.rest();
        self.at += rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
    }

    /// The next word, left where it is; `None` at the end of the file.
    pub fn peek_word(&mut self) -> Option<&'a [u8]> {
        self.skip_white();
        let rest = self.rest();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        (end > 0).then(|| &rest[..end])
    }

    /// Whether the next word is `word`, whatever its case; takes nothing, not even white space.
    pub fn is_at(&self, word: &[u8]) -> bool {
        let rest = self.rest().trim_ascii_start();
        rest.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
    }

    /// Takes the next word.
    pub fn word(&mut self, wanted: &'static str) -> Read<&'a [u8]> {
        let word = self.peek_word();
        self.last = self.at;
        match word {
            Some(word) => {
                self.at += word.len();
                Ok(word)
            }
            None => Err(self.failure(Problem::Ended { wanted })),
        }
    }

    /// Takes the rest of the line, without its end.
    pub fn line(&mut self) -> &'a [u8] {
        self.last = self.at;
        let rest = self.rest();
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        rest[..end].trim_ascii()
    }

    /// Nothing else may stand on the line; takes its end.
    pub fn end_of_line(&mut self, wanted: &'static str) -> Read<()> {
        let rest = self.rest();
        let blank = rest.iter().position(|byte| !matches!(byte, b' ' | b'\t' | b'\r')).unwrap_or(rest.len());
        match rest.get(blank) {
            None => self.at = self.data.len(),
            Some(b'\n') => self.at += blank + 1,
            Some(_) => {
                let found = self.word(wanted)?;
                return Err(self.unexpected(wanted, found));
            }
        }
        Ok(())
    }

    /// [`Self::end_of_line`] in text; nothing in binary, which has no lines.
    pub fn end_of_line_in_text(&mut self, wanted: &'static str) -> Read<()> {
        if self.is_binary() {
            return Ok(());
        }
        self.end_of_line(wanted)
    }

    /// Goes behind the next occurrence of `needle`; whether there is one.
    pub fn skip_past(&mut self, needle: &[u8]) -> bool {
        self.last = self.at;
        match find(self.rest(), needle) {
            Some(found) => {
                self.at += found + needle.len();
                true
            }
            None => false,
        }
    }

    pub fn unexpected(&self, wanted: &'static str, found: &[u8]) -> Box<Failure> {
        self.failure(Problem::Unexpected { wanted, found: readable(found) })
    }

    /// Where a number should stand there is a word: if it begins a section, items are missing.
    fn not_a_number(&self, wanted: &'static str, word: &[u8]) -> Box<Failure> {
        let found = readable(word);
        let begins_section = word[0] == b'$' || (word.len() > 2 && word[0].is_ascii_uppercase());
        let is_float_name =
            [b"nan".as_slice(), b"inf"].iter().any(|name| word.to_ascii_lowercase().starts_with(name));
        self.failure(if begins_section && !is_float_name {
            Problem::SectionEnded { wanted, found }
        } else {
            Problem::Unexpected { wanted, found }
        })
    }

    /// The next `N` bytes.
    fn bytes<const N: usize>(&mut self, wanted: &'static str) -> Read<[u8; N]> {
        self.last = self.at;
        match self.rest().first_chunk::<N>() {
            Some(bytes) => {
                self.at += N;
                Ok(*bytes)
            }
            None => Err(self.failure(Problem::Ended { wanted })),
        }
    }

    /// Skips `count` bytes.
    pub fn skip_bytes(&mut self, count: u64, wanted: &'static str) -> Read<()> {
        self.last = self.at;
        match usize::try_from(count) {
            Ok(count) if count <= self.rest().len() => {
                self.at += count;
                Ok(())
            }
            _ => Err(self.failure(Problem::Ended { wanted })),
        }
    }

    fn text_number<T: std::str::FromStr>(&mut self, wanted: &'static str) -> Read<T> {
        let word = self.word(wanted)?;
        std::str::from_utf8(word)
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.not_a_number(wanted, word))
    }

    /// A whole number written as text, whatever the encoding.
    pub fn text_count(&mut self, wanted: &'static str) -> Read<u64> {
        self.text_number(wanted)
    }

    /// A whole number of 32 bits in binary.
    pub fn int(&mut self, wanted: &'static str) -> Read<i64> {
        match self.encoding {
            Encoding::Ascii => self.text_number(wanted),
            Encoding::Binary(endian) => {
                let bytes = self.bytes(wanted)?;
                Ok(i64::from(match endian {
                    Endian::Little => i32::from_le_bytes(bytes),
                    Endian::Big => i32::from_be_bytes(bytes),
                }))
            }
        }
    }

    /// A whole number of 64 bits in binary, not negative.
    pub fn size(&mut self, wanted: &'static str) -> Read<u64> {
        match self.encoding {
            Encoding::Ascii => self.text_number(wanted),
            Encoding::Binary(endian) => {
                let bytes = self.bytes(wanted)?;
                Ok(match endian {
                    Endian::Little => u64::from_le_bytes(bytes),
                    Endian::Big => u64::from_be_bytes(bytes),
                })
            }
        }
    }

    /// A number of 64 bits in binary.
    pub fn real(&mut self, wanted: &'static str) -> Read<f64> {
        match self.encoding {
            Encoding::Ascii => self.text_real(wanted),
            Encoding::Binary(endian) => {
                let bytes = self.bytes(wanted)?;
                Ok(match endian {
                    Endian::Little => f64::from_le_bytes(bytes),
                    Endian::Big => f64::from_be_bytes(bytes),
                })
            }
        }
    }

    /// A real number written as text; Fortran's `1.0D+00` is understood.
    fn text_real(&mut self, wanted: &'static str) -> Read<f64> {
        let word = self.word(wanted)?;
        let parse = |text: &str| text.parse().ok();
        std::str::from_utf8(word)
            .ok()
            .and_then(|text| parse(text).or_else(|| parse(&text.replace(['d', 'D'], "e"))))
            .ok_or_else(|| self.not_a_number(wanted, word))
    }

    /// A big-endian binary number, or a word of text.
    pub fn typed_number(&mut self, kind: NumberKind, wanted: &'static str) -> Read<f64> {
        if !self.is_binary() {
            return self.text_real(wanted);
        }
        Ok(match kind {
            NumberKind::I8 => f64::from(i8::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::U8 => f64::from(u8::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::I16 => f64::from(i16::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::U16 => f64::from(u16::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::I32 => f64::from(i32::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::U32 => f64::from(u32::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::I64 => i64::from_be_bytes(self.bytes(wanted)?) as f64,
            NumberKind::U64 => u64::from_be_bytes(self.bytes(wanted)?) as f64,
            NumberKind::F32 => f64::from(f32::from_be_bytes(self.bytes(wanted)?)),
            NumberKind::F64 => f64::from_be_bytes(self.bytes(wanted)?),
        })
    }

    /// Checks an announced count against what is left of the file, so that nothing is ever
    /// reserved that cannot be there. An item takes `bytes` bytes, or `words` words of text.
    pub fn room(&self, announced: u64, items: &'static str, words: usize, bytes: usize) -> Read<usize> {
        let (left, each) = if self.is_binary() {
            (self.rest().len(), bytes)
        } else {
            // Every word but the last needs a space behind it.
            (self.rest().len() + 1, 2 * words)
        };
        let room = left / each.max(1);
        match usize::try_from(announced) {
            Ok(count) if count <= room => Ok(count),
            _ => Err(self.failure(Problem::Announced { announced, items, room: room as u64 })),
        }
    }
}

/// A number type of legacy VTK.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberKind {
    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// First occurrence of `needle`.
fn find(data: &[u8], needle: &[u8]) -> Option<usize> {
    data.windows(needle.len()).position(|part| part == needle)
}

/// A piece of a file for a message: short, and printable.
pub(super) fn readable(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let text: String = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)])
        .chars()
        .take(MOST)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    if bytes.len() > text.len() { format!("{text}...") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_in_text_and_bytes_in_binary() {
        let mut cursor = Cursor::new(b"1 2\n\n  x7");
        cursor.enter("$Nodes");
        assert_eq!(cursor.int("a").expect("1"), 1);
        assert_eq!(cursor.int("a").expect("2"), 2);
        cursor.item("node", 2, 5);
        let error = cursor.int("a number").expect_err("a word");
        assert_eq!(error.place.to_string(), ", line 3, section $Nodes, node 3 of 5");
        assert!(matches!(error.problem, Problem::Unexpected { .. }));
        cursor.encoding = Encoding::Binary(Endian::Big);
        let error = cursor.int("a number").expect_err("nothing left");
        assert_eq!(error.place.position, Some(Position::Byte(9)));
    }

    #[test]
    fn both_byte_orders_are_read() {
        let mut cursor = Cursor::new(&[1, 0, 0, 0, 0, 0, 0, 1]);
        cursor.encoding = Encoding::Binary(Endian::Little);
        assert_eq!(cursor.int("a").expect("four bytes"), 1);
        cursor.encoding = Encoding::Binary(Endian::Big);
        assert_eq!(cursor.int("a").expect("four bytes"), 1);
    }

    #[test]
    fn room_is_what_the_rest_can_hold() {
        let cursor = Cursor::new(b"1 2 3 4 5 6");
        assert_eq!(cursor.room(2, "triples", 3, 24).expect("fits"), 2);
        assert!(cursor.room(3, "triples", 3, 24).is_err());
        assert!(cursor.room(u64::MAX, "triples", 3, 24).is_err());
    }

    #[test]
    fn fortran_exponents_are_numbers() {
        let mut cursor = Cursor::new(b"1.5D-01 nan");
        assert_eq!(cursor.real("x").expect("a number"), 0.15);
        assert!(cursor.real("x").expect("a number").is_nan());
    }

    #[test]
    fn readable_text_is_short_and_printable() {
        assert_eq!(readable(b"a\0b"), "a?b");
        assert!(readable(&[b'x'; 500]).len() < 50);
    }
}
