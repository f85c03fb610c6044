//! A TOML document as a tree whose every value knows where it came from.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a value came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    /// The scene's text, at this byte.
    Text(usize),
    /// The override with this number.
    Override(usize),
}

/// A value and its origin.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub origin: Origin,
    pub value: Value,
}

/// What a TOML value can be.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Flag(bool),
    Date,
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// One key of a table.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub key: String,
    pub key_origin: Origin,
    pub node: Node,
}

impl Node {
    /// The entries, when this is a table.
    pub fn entries(&self) -> Option<&[Entry]> {
        match &self.value {
            Value::Table(entries) => Some(entries),
            _ => None,
        }
    }

    /// The value of a key, when this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entries()?.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    /// The text, when this is one.
    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number, when this is one.
    pub fn number(&self) -> Option<f64> {
        match self.value {
            Value::Integer(number) => Some(number as f64),
            Value::Float(number) => Some(number),
            _ => None,
        }
    }

    /// The value in words, for "but is ...".
    pub fn in_words(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("the text \"{text}\""),
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            Value::Flag(flag) => flag.to_string(),
            Value::Date => "a date".to_owned(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

/// The tree of a parsed document, entries in the order of the text.
pub(super) fn from_document(table: &Spanned<DeTable<'_>>) -> Node {
    Node { origin: Origin::Text(table.span().start), value: Value::Table(entries_of(table.get_ref(), None)) }
}

/// The tree of the value of an override, every part of it from that override.
pub(super) fn from_override(value: &DeValue<'_>, number: usize) -> Node {
    convert(value, 0, Some(Origin::Override(number)))
}

fn convert(value: &DeValue<'_>, start: usize, origin: Option<Origin>) -> Node {
    let nested = |item: &Spanned<DeValue<'_>>| convert(item.get_ref(), item.span().start, origin);
    let value = match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(number) => integer(number.as_str(), number.radix()),
        DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::List(items.iter().map(nested).collect()),
        DeValue::Table(table) => Value::Table(entries_of(table, origin)),
    };
    Node { origin: origin.unwrap_or(Origin::Text(start)), value }
}

/// Integers beyond 64 bits become floating point: the checks then name a sensible limit.
fn integer(digits: &str, radix: u32) -> Value {
    i64::from_str_radix(digits, radix)
        .map_or_else(|_| Value::Float(digits.parse().unwrap_or(f64::INFINITY)), Value::Integer)
}

fn entries_of(table: &DeTable<'_>, origin: Option<Origin>) -> Vec<Entry> {
    let mut ordered: Vec<_> = table.iter().collect();
    ordered.sort_by_key(|(key, _)| key.span().start);
    ordered
        .into_iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            key_origin: origin.unwrap_or(Origin::Text(key.span().start)),
            node: convert(value.get_ref(), value.span().start, origin),
        })
        .collect()
}
