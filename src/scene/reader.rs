//! Reading tables: every key is named once, where it is read.
//!
//! A [`Table`] remembers the keys it was asked for. When it goes out of scope it reports the keys of
//! the text that nobody asked for. So a new key is one line in the function that reads its table: the
//! type, the limits, the default and the list of valid keys all follow from that line.
//!
//! Nothing stops at the first problem: a value that cannot be used is reported and a stand-in is
//! handed back, and the caller goes on. [`Findings::into_problems`] tells at the end.

use super::findings::{Findings, Stranger};
use super::path::{join, rivals_of};
use super::problem::suggestion;
use super::quantity::Quantity;
use super::tree::{Entry, Node, Origin, Value};
use glam::DVec3;

/// A table being read.
pub(super) struct Table<'a> {
    findings: &'a Findings,
    node: Option<&'a Node>,
    origin: Origin,
    path: String,
    pattern: String,
    asked: Vec<&'static str>,
}

impl<'a> Table<'a> {
    /// The whole scene.
    pub fn root(node: &'a Node, findings: &'a Findings) -> Self {
        Self {
            findings,
            node: Some(node),
            origin: node.origin,
            path: String::new(),
            pattern: String::new(),
            asked: Vec::new(),
        }
    }

    /// Path of this table, as `--set` takes it.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether the text has this key. Does not count as asking for it.
    pub fn has(&self, key: &str) -> bool {
        self.node.is_some_and(|node| node.get(key).is_some())
    }

    /// Reports a problem with a key, or with the whole table for an empty or absent key.
    pub fn problem(&self, key: &str, message: String) {
        let origin = self.entry(key).map_or(self.origin, |entry| entry.node.origin);
        self.findings.add(origin, &join(&self.path, key), message);
    }

    /// Reports a table that has more than one key of the group of rivals that `key` belongs to.
    pub fn refuse_rivals(&self, key: &'static str) {
        let group = std::iter::once(key).chain(rivals_of(key));
        let present: Vec<&str> = group.filter(|rival| self.has(rival)).collect();
        if let [first, .., last] = present[..] {
            let message =
                format!("`{}` and `{first}` exclude each other; keep one of them", self.name_of(last));
            self.problem(last, message);
        }
    }

    /// The full path of a key, for messages.
    pub fn name_of(&self, key: &str) -> String {
        join(&self.path, key)
    }

    /// Keys not asked for are not reported: for tables whose meaning could not be made out.
    pub fn forgive_the_rest(&mut self) {
        self.node = None;
    }

    /// A number within limits.
    pub fn number(&mut self, key: &'static str, quantity: Quantity) -> Option<f64> {
        let node = self.ask(key)?;
        self.checked_number(key, node, quantity)
    }

    /// A number that must be there.
    pub fn required_number(&mut self, key: &'static str, quantity: Quantity) -> f64 {
        self.require(key, &format!("a number{}", quantity.unit_in_words()));
        self.number(key, quantity).unwrap_or_else(|| quantity.stand_in())
    }

    /// A whole number within limits (both included).
    pub fn integer(&mut self, key: &'static str, low: u32, high: u32) -> Option<u32> {
        let node = self.ask(key)?;
        self.checked_integer(key, node, low, high)
    }

    /// True or false.
    pub fn flag(&mut self, key: &'static str) -> Option<bool> {
        let node = self.ask(key)?;
        if let Value::Flag(flag) = node.value {
            return Some(flag);
        }
        self.wrong_type(key, node, "true or false");
        None
    }

    /// A text.
    pub fn text(&mut self, key: &'static str) -> Option<String> {
        let node = self.ask(key)?;
        if node.text().is_none() {
            self.wrong_type(key, node, "a text in quotes");
        }
        node.text().map(str::to_owned)
    }

    /// A text that must be there.
    pub fn required_text(&mut self, key: &'static str) -> String {
        self.require(key, "a text in quotes");
        self.text(key).unwrap_or_default()
    }

    /// One of several words.
    pub fn choice<T: Copy>(&mut self, key: &'static str, options: &[(&str, T)]) -> Option<T> {
        let word = self.text(key)?;
        if let Some((_, value)) = options.iter().find(|(name, _)| *name == word) {
            return Some(*value);
        }
        let names = options.iter().map(|(name, _)| *name);
        self.problem(
            key,
            format!("`{}` cannot be \"{word}\"{}", self.name_of(key), suggestion(&word, names)),
        );
        None
    }

    /// Three numbers.
    pub fn vector(&mut self, key: &'static str, unit: &'static str) -> Option<DVec3> {
        let numbers = self.numbers(key, 3, 3, Quantity::any(unit))?;
        Some(DVec3::from_slice(&numbers))
    }

    /// A list of numbers with at least `low` and at most `high` of them.
    pub fn numbers(
        &mut self,
        key: &'static str,
        low: usize,
        high: usize,
        quantity: Quantity,
    ) -> Option<Vec<f64>> {
        let items = self.list_of(key, low, high, &format!("numbers{}", quantity.unit_in_words()))?;
        let numbers: Vec<f64> =
            items.iter().filter_map(|item| self.checked_number(key, item, quantity)).collect();
        (numbers.len() == items.len()).then_some(numbers)
    }

    /// Three whole numbers within limits, or one for all three.
    pub fn integers(&mut self, key: &'static str, low: u32, high: u32) -> Option<[u32; 3]> {
        let node = self.ask(key)?;
        if node.number().is_some() {
            return self.checked_integer(key, node, low, high).map(|n| [n; 3]);
        }
        let items = self.list_of(key, 3, 3, "whole numbers, or one for all three")?;
        let numbers: Vec<u32> =
            items.iter().filter_map(|item| self.checked_integer(key, item, low, high)).collect();
        <[u32; 3]>::try_from(numbers).ok()
    }

    /// A list of texts.
    pub fn texts(&mut self, key: &'static str, low: usize, high: usize) -> Option<Vec<String>> {
        let items = self.list_of(key, low, high, "texts in quotes")?;
        let texts: Vec<String> = items
            .iter()
            .filter_map(|item| {
                if item.text().is_none() {
                    self.wrong_type(key, item, "a list of texts in quotes");
                }
                item.text().map(str::to_owned)
            })
            .collect();
        (texts.len() == items.len()).then_some(texts)
    }

    /// A table, when it is there.
    pub fn table(&mut self, key: &'static str) -> Option<Table<'a>> {
        let node = self.ask(key)?;
        if node.entries().is_none() {
            self.wrong_type(key, node, "a table (`[...]` or `{ ... }`)");
            return None;
        }
        let pattern = join(&self.pattern, key);
        Some(self.child(Some(node), self.name_of(key), pattern))
    }

    /// A table; one without keys when it is not there.
    pub fn table_or_empty(&mut self, key: &'static str) -> Table<'a> {
        let path = self.name_of(key);
        let pattern = join(&self.pattern, key);
        self.table(key).unwrap_or_else(|| self.child(None, path, pattern))
    }

    /// A list of tables (`[[key]]`), each named by its `name` or its number.
    pub fn tables(&mut self, key: &'static str) -> Vec<Table<'a>> {
        let Some(node) = self.ask(key) else {
            return Vec::new();
        };
        let Value::List(items) = &node.value else {
            self.wrong_type(key, node, &format!("a list of tables (`[[{key}]]`)"));
            return Vec::new();
        };
        let pattern = format!("{}[]", join(&self.pattern, key));
        let mut tables = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let path = match item.get("name").and_then(Node::text) {
                Some(name) => join(&self.name_of(key), name),
                None => format!("{}[{index}]", self.name_of(key)),
            };
            if item.entries().is_none() {
                let message = format!("`{path}` must be a table, but is {}", item.in_words());
                self.findings.add(item.origin, &path, message);
            } else {
                tables.push(self.child(Some(item), path, pattern.clone()));
            }
        }
        tables
    }

    /// The tables inside a table whose keys are names (`[materials.steel]`).
    pub fn named_tables(&mut self, key: &'static str) -> Vec<(String, Table<'a>)> {
        let Some(mut table) = self.table(key) else {
            return Vec::new();
        };
        let entries = table.node.and_then(Node::entries).unwrap_or_default();
        let pattern = format!("{}.NAME", table.pattern);
        let mut tables = Vec::with_capacity(entries.len());
        for entry in entries {
            let path = table.name_of(&entry.key);
            if entry.node.entries().is_some() {
                let child = table.child(Some(&entry.node), path, pattern.clone());
                tables.push((entry.key.clone(), child));
            } else {
                let message = format!("`{path}` must be a table, but is {}", entry.node.in_words());
                self.findings.add(entry.node.origin, &path, message);
            }
        }
        table.forgive_the_rest();
        tables
    }

    /// All entries of this table as (name, text), for tables such as `material = { head = "steel" }`.
    pub fn named_texts(&mut self) -> Vec<(String, String)> {
        let entries = self.node.and_then(Node::entries).unwrap_or_default();
        let mut texts = Vec::with_capacity(entries.len());
        for entry in entries {
            match entry.node.text() {
                Some(text) => texts.push((entry.key.clone(), text.to_owned())),
                None => self.wrong_type(&entry.key, &entry.node, "a text in quotes"),
            }
        }
        self.forgive_the_rest();
        texts
    }

    /// All entries of this table as (name, number), for tables such as `parameters = { k = 2e6 }`.
    pub fn named_numbers(&mut self) -> Vec<(String, f64)> {
        let entries = self.node.and_then(Node::entries).unwrap_or_default();
        let number = |entry: &Entry| {
            Some((entry.key.clone(), self.checked_number(&entry.key, &entry.node, Quantity::any(""))?))
        };
        let numbers = entries.iter().filter_map(number).collect();
        self.forgive_the_rest();
        numbers
    }

    /// Whether the value of a key is a text, a list or a table, for keys that take several.
    pub fn kind_of(&mut self, key: &'static str) -> Option<Kind> {
        let node = self.ask(key)?;
        Some(match node.value {
            Value::Text(_) => Kind::Text,
            Value::List(_) => Kind::List,
            Value::Table(_) => Kind::Table,
            _ => Kind::Other,
        })
    }

    /// Reports a value of the wrong type, for keys that take several.
    pub fn report_type(&self, key: &str, expected: &str) {
        if let Some(entry) = self.entry(key) {
            self.wrong_type(key, &entry.node, expected);
        }
    }

    /// Reports a key that is not there.
    pub fn require(&self, key: &'static str, what: &str) {
        if !self.has(key) {
            let message = if self.path.is_empty() {
                format!("`{key}` is missing at the top of the scene: {what}")
            } else {
                format!("`{key}` is missing in `{}`: {what}", self.path)
            };
            self.findings.add(self.origin, &self.name_of(key), message);
        }
    }

    fn entry(&self, key: &str) -> Option<&'a Entry> {
        let entries = self.node?.entries()?;
        entries.iter().find(|entry| entry.key == key)
    }

    fn ask(&mut self, key: &'static str) -> Option<&'a Node> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
            self.findings.note_key(&self.pattern, key);
        }
        self.entry(key).map(|entry| &entry.node)
    }

    fn child(&self, node: Option<&'a Node>, path: String, pattern: String) -> Table<'a> {
        Table {
            findings: self.findings,
            node,
            origin: node.map_or(self.origin, |node| node.origin),
            path,
            pattern,
            asked: Vec::new(),
        }
    }

    fn list_of(&mut self, key: &'static str, low: usize, high: usize, what: &str) -> Option<&'a [Node]> {
        let node = self.ask(key)?;
        match &node.value {
            Value::List(items) if (low..=high).contains(&items.len()) => Some(items),
            _ => {
                let count = match (low, high) {
                    (low, high) if low == high => low.to_string(),
                    (low, usize::MAX) => format!("at least {low}"),
                    (low, high) => format!("{low} to {high}"),
                };
                self.wrong_type(key, node, &format!("a list of {count} {what}"));
                None
            }
        }
    }

    fn checked_number(&self, key: &str, node: &Node, quantity: Quantity) -> Option<f64> {
        let unit = quantity.unit_in_words();
        let Some(number) = node.number() else {
            self.wrong_type(key, node, &format!("a number{unit}"));
            return None;
        };
        if quantity.allows(number) {
            return Some(number);
        }
        let message =
            format!("`{}`{unit} must be {}, but is {number}", self.name_of(key), quantity.limits_in_words());
        self.report(node.origin, key, message);
        None
    }

    fn checked_integer(&self, key: &str, node: &Node, low: u32, high: u32) -> Option<u32> {
        if let Value::Integer(number) = node.value
            && let Ok(number) = u32::try_from(number)
            && (low..=high).contains(&number)
        {
            return Some(number);
        }
        let expected = format!("a whole number from {low} to {high}");
        self.wrong_type(key, node, &expected);
        None
    }

    fn wrong_type(&self, key: &str, node: &Node, expected: &str) {
        let quoted_number = node.text().is_some_and(|text| text.parse::<f64>().is_ok());
        let hint = if quoted_number && expected.contains("number") { "; leave the quotes out" } else { "" };
        let message = format!("`{}` must be {expected}, but is {}{hint}", self.name_of(key), node.in_words());
        self.report(node.origin, key, message);
    }

    fn report(&self, origin: Origin, key: &str, message: String) {
        self.findings.add(origin, &self.name_of(key), message);
    }
}

impl Drop for Table<'_> {
    fn drop(&mut self) {
        let entries = self.node.and_then(Node::entries).unwrap_or_default();
        for entry in entries {
            if !self.asked.contains(&entry.key.as_str()) {
                self.findings.add_stranger(Stranger {
                    origin: entry.key_origin,
                    table: self.path.clone(),
                    key: entry.key.clone(),
                    known: self.asked.clone(),
                });
            }
        }
    }
}

/// Kinds of value, for keys that take several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Text,
    List,
    Table,
    Other,
}
