//! The text of a scene with the overrides applied to it.
//!
//! The text is kept twice: as a tree with the place of every value, which the checks read, and as an
//! editable document that keeps comments and layout, which is what saving writes.

use super::findings::Finding;
use super::path::{self, Segment};
use super::problem::{Location, Problem, SceneError};
use super::tree::{self, Entry, Node, Origin, Value};
use toml::de::{DeTable, DeValue};
use toml_edit::{DocumentMut, Item, TableLike};

/// The text of a scene and the overrides on top of it.
#[derive(Clone, Debug)]
pub struct SceneDocument {
    label: String,
    text: String,
    root: Node,
    editable: DocumentMut,
    overrides: Vec<String>,
}

impl SceneDocument {
    /// Reads the text of a scene. `label` is what messages call it: a path, or a built-in scene's name.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with every place where the text is not TOML.
    pub fn parse(label: &str, text: &str) -> Result<Self, SceneError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let (table, errors) = DeTable::parse_recoverable(text);
        let findings = syntax_findings(text, &errors);
        let mut document = Self {
            label: label.to_owned(),
            text: text.to_owned(),
            root: tree::from_document(&table),
            editable: DocumentMut::new(),
            overrides: Vec::new(),
        };
        if !findings.is_empty() {
            return Err(document.invalid(findings));
        }
        match text.parse() {
            Ok(editable) => document.editable = editable,
            Err(error) => {
                let start = toml_edit::TomlError::span(&error).map_or(0, |span| span.start);
                return Err(document.invalid(vec![syntax_finding(start, error.message())]));
            }
        }
        Ok(document)
    }

    /// Applies overrides, each `path=value` as after `--set`, in order; a later one wins.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with every override that cannot be read or leads nowhere. Whether the
    /// values are sensible is checked later, with the rest of the scene.
    pub fn apply(&mut self, overrides: &[impl AsRef<str>]) -> Result<(), SceneError> {
        let findings = self.try_apply(overrides);
        if findings.is_empty() { Ok(()) } else { Err(self.invalid(findings)) }
    }

    /// The same, handing back what is wrong for it to be told together with the rest.
    pub(super) fn try_apply(&mut self, overrides: &[impl AsRef<str>]) -> Vec<Finding> {
        let mut findings = Vec::new();
        for text in overrides {
            let number = self.overrides.len();
            self.overrides.push(text.as_ref().to_owned());
            if let Err((path, message)) = self.apply_one(text.as_ref(), number) {
                findings.push(Finding { origin: Origin::Override(number), path, message });
            }
        }
        findings
    }

    /// The scene as TOML: the text, comments and all, with the overrides in it.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.editable.to_string()
    }

    /// What messages call the scene.
    #[must_use]
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The overrides applied so far.
    #[must_use]
    pub fn overrides(&self) -> &[String] {
        &self.overrides
    }

    /// The text of a body.
    pub(super) fn body(&self, entry: usize) -> Option<&toml_edit::Table> {
        self.editable.get("bodies")?.as_array_of_tables()?.get(entry)
    }

    pub(super) fn root(&self) -> &Node {
        &self.root
    }

    /// Where the value at `path` came from.
    pub(super) fn locate(&self, path: &str) -> Origin {
        path::locate(&self.root, path)
    }

    /// The error for these findings.
    pub(super) fn invalid(&self, findings: Vec<Finding>) -> SceneError {
        SceneError::Invalid { scene: self.label.clone(), problems: self.problems(findings) }
    }

    /// These findings with their places, in the order of the text, overrides last.
    pub(super) fn problems(&self, mut findings: Vec<Finding>) -> Vec<Problem> {
        findings.sort_by_key(|finding| finding.origin);
        findings.dedup_by(|a, b| a.origin == b.origin && a.message == b.message);
        let place = |finding: Finding| Problem {
            location: self.location(finding.origin),
            path: finding.path,
            message: finding.message,
        };
        findings.into_iter().map(place).collect()
    }

    fn location(&self, origin: Origin) -> Location {
        match origin {
            Origin::Override(number) => Location::Override(self.overrides[number].clone()),
            Origin::Text(byte) => {
                let before = floor_to_char(&self.text, byte);
                let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
                Location::Line {
                    line: before.matches('\n').count() + 1,
                    column: before[line_start..].chars().count() + 1,
                }
            }
        }
    }

    fn apply_one(&mut self, text: &str, number: usize) -> Result<(), (String, String)> {
        let Some((path, value)) = text.split_once('=') else {
            let message = "write a path, `=` and a value, as in `materials.glass.density=2500`";
            return Err((String::new(), message.to_owned()));
        };
        let path = path.trim();
        let value = read_value(value.trim(), number).map_err(|m| (path.to_owned(), m))?;
        let steps = path::split(path)
            .and_then(|parts| path::resolve(&self.root, &parts))
            .map_err(|message| (path.to_owned(), message))?;
        put_in_document(self.editable.as_item_mut(), &steps, to_editable(&value));
        put_in_tree(&mut self.root, &steps, value, number);
        Ok(())
    }
}

/// Lines with broken syntax that are told; one open bracket makes every line below it look broken.
const SYNTAX_LINES: usize = 5;

/// The first error of each of the first few broken lines.
fn syntax_findings(text: &str, errors: &[toml::de::Error]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    let mut lines: Vec<usize> = Vec::new();
    for error in errors {
        let byte = error.span().map_or(0, |span| span.start);
        let line = floor_to_char(text, byte).matches('\n').count();
        if lines.contains(&line) || lines.len() == SYNTAX_LINES {
            continue;
        }
        lines.push(line);
        findings.push(syntax_finding(byte, error.message()));
    }
    findings
}

fn syntax_finding(byte: usize, reason: &str) -> Finding {
    let hint = if reason.contains("array") { " (is a `[` left open above?)" } else { "" };
    Finding {
        origin: Origin::Text(byte),
        path: String::new(),
        message: format!("this is not valid TOML: {reason}{hint}"),
    }
}

/// The text up to `byte`, or to the start of the character that `byte` is in.
fn floor_to_char(text: &str, byte: usize) -> &str {
    let mut end = byte.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    &text[..end]
}

/// A value as TOML writes it; words that are none of TOML's values are taken as text.
fn read_value(text: &str, number: usize) -> Result<Node, String> {
    let error = match DeValue::parse(text) {
        Ok(value) => return Ok(tree::from_override(value.get_ref(), number)),
        Err(error) => error,
    };
    let node = |value| Node { origin: Origin::Override(number), value };
    let looks_like_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    if looks_like_number && let Ok(value) = text.parse::<f64>() {
        return Ok(node(Value::Float(value)));
    }
    if text.is_empty() || text.starts_with(['[', '{', '"', '\'']) {
        return Err(format!("the value is not valid TOML: {}", error.message()));
    }
    Ok(node(Value::Text(text.to_owned())))
}

fn put_in_tree(node: &mut Node, steps: &[Segment], value: Node, number: usize) {
    let Some((first, rest)) = steps.split_first() else {
        *node = value;
        return;
    };
    match (first, &mut node.value) {
        (Segment::Index(index), Value::List(items)) => {
            put_in_tree(&mut items[*index], rest, value, number);
        }
        (Segment::Key(key), Value::Table(entries)) => {
            let index = entries.iter().position(|entry| entry.key == *key);
            let index = index.unwrap_or_else(|| {
                entries.push(new_entry(key, number));
                entries.len() - 1
            });
            if rest.is_empty() {
                entries[index].key_origin = Origin::Override(number);
            }
            put_in_tree(&mut entries[index].node, rest, value, number);
            if rest.is_empty() {
                entries.retain(|entry| !path::rivals_of(key).any(|rival| rival == entry.key));
            }
        }
        _ => {}
    }
}

fn new_entry(key: &str, number: usize) -> Entry {
    Entry {
        key: key.to_owned(),
        key_origin: Origin::Override(number),
        node: Node { origin: Origin::Override(number), value: Value::Table(Vec::new()) },
    }
}

fn put_in_document(item: &mut Item, steps: &[Segment], value: toml_edit::Value) {
    let Some((first, rest)) = steps.split_first() else {
        replace(item, value);
        return;
    };
    match first {
        Segment::Index(index) => {
            if let Some(next) = item.get_mut(*index) {
                put_in_document(next, rest, value);
            }
        }
        Segment::Key(key) => {
            let inline = item.is_inline_table();
            if let Some(table) = item.as_table_like_mut() {
                put_in_table(table, key, inline, |next| put_in_document(next, rest, value), rest);
            }
        }
    }
}

fn put_in_table(
    table: &mut dyn TableLike,
    key: &str,
    inline: bool,
    put: impl FnOnce(&mut Item),
    rest: &[Segment],
) {
    let was_header = table.get(key).is_some_and(|item| !item.is_value());
    if rest.is_empty() && was_header {
        table.remove(key);
    }
    if table.get(key).is_none() {
        let nothing = if inline || rest.is_empty() {
            Item::Value(toml_edit::InlineTable::new().into())
        } else {
            Item::Table(toml_edit::Table::new())
        };
        table.insert(key, nothing);
    }
    if let Some(next) = table.get_mut(key) {
        put(next);
    }
    if rest.is_empty() {
        for rival in path::rivals_of(key) {
            table.remove(rival);
        }
    }
}

/// Puts a value where another was and keeps the blanks and comments around it.
fn replace(item: &mut Item, mut value: toml_edit::Value) {
    if let Some(old) = item.as_value() {
        *value.decor_mut() = old.decor().clone();
    }
    *item = Item::Value(value);
}

fn to_editable(node: &Node) -> toml_edit::Value {
    match &node.value {
        Value::Text(text) => text.as_str().into(),
        Value::Integer(number) => (*number).into(),
        Value::Float(number) => (*number).into(),
        Value::Flag(flag) => (*flag).into(),
        Value::Date => "a date".into(),
        Value::List(items) => items.iter().map(to_editable).collect::<toml_edit::Array>().into(),
        Value::Table(entries) => entries
            .iter()
            .map(|entry| (entry.key.as_str(), to_editable(&entry.node)))
            .collect::<toml_edit::InlineTable>()
            .into(),
    }
}
