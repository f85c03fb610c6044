//! What was found to be wrong on the way through a scene's text.

use super::path::join;
use super::problem::{nearest, suggestion};
use super::tree::Origin;
use std::cell::RefCell;
use std::collections::BTreeSet;

/// A problem before its place is turned into a line.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub origin: Origin,
    pub path: String,
    pub message: String,
}

/// A key nobody asked for.
pub(super) struct Stranger {
    pub origin: Origin,
    /// Path of its table.
    pub table: String,
    pub key: String,
    /// The keys of that table.
    pub known: Vec<&'static str>,
}

/// What was found so far, and which keys exist.
#[derive(Default)]
pub(super) struct Findings {
    list: RefCell<Vec<Finding>>,
    strangers: RefCell<Vec<Stranger>>,
    /// Every key asked for: (table's pattern such as `bodies[].shape`, key).
    asked: RefCell<BTreeSet<(String, &'static str)>>,
}

impl Findings {
    /// Adds a problem.
    pub fn add(&self, origin: Origin, path: &str, message: String) {
        self.list.borrow_mut().push(Finding { origin, path: path.to_owned(), message });
    }

    /// Whether nothing was found so far.
    pub fn is_empty(&self) -> bool {
        self.list.borrow().is_empty() && self.strangers.borrow().is_empty()
    }

    /// Adds a key nobody asked for.
    pub fn add_stranger(&self, stranger: Stranger) {
        self.strangers.borrow_mut().push(stranger);
    }

    /// Notes that tables of this pattern have this key.
    pub fn note_key(&self, pattern: &str, key: &'static str) {
        self.asked.borrow_mut().insert((pattern.to_owned(), key));
    }

    #[cfg(test)]
    /// Every key that was asked for, with the pattern of its table.
    pub fn asked(&self) -> BTreeSet<(String, &'static str)> {
        self.asked.borrow().clone()
    }

    /// All problems.
    pub fn into_problems(self) -> Vec<Finding> {
        let asked = self.asked.into_inner();
        let mut list = self.list.into_inner();
        list.extend(self.strangers.into_inner().into_iter().map(|stranger| Finding {
            origin: stranger.origin,
            path: join(&stranger.table, &stranger.key),
            message: stranger.in_words(&asked),
        }));
        list
    }
}

/// Words that people try for a moment or a place, and what the tables call it. The longer lists first.
const OTHER_WORDS: [(&[&str], &[&str]); 4] = [
    (&["at"], &["position", "enters"]),
    (&["time", "t", "when", "start", "begin", "from", "at"], &["at", "path"]),
    (&["time", "t", "when", "start", "begin", "at"], &["enters"]),
    (&["at", "t", "when"], &["time"]),
];

impl Stranger {
    /// What the table calls something that goes by another word elsewhere.
    fn names_for_it(&self) -> Option<String> {
        let fits = |(words, names): &&(&[&str], &[&str])| {
            let is_known = |name: &&&str| self.known.contains(name);
            words.contains(&self.key.as_str()) && names.iter().any(|name| is_known(&name))
        };
        let (_, names) = OTHER_WORDS.iter().find(fits)?;
        let names = names.iter().filter(|name| self.known.contains(name));
        let quoted: Vec<String> = names.map(|name| format!("`{name}`")).collect();
        Some(quoted.join(" or "))
    }

    fn in_words(&self, asked: &BTreeSet<(String, &'static str)>) -> String {
        let place = if self.table.is_empty() {
            "at the top of the scene".to_owned()
        } else {
            format!("in `{}`", self.table)
        };
        let key = &self.key;
        if let Some(names) = self.names_for_it() {
            return format!("unknown key `{key}` {place}; did you mean {names}?");
        }
        if let Some(name) = nearest(key, self.known.iter().copied()) {
            return format!("unknown key `{key}` {place}; did you mean `{name}`?");
        }
        let home = asked.iter().find(|(_, name)| name == key);
        match home.map(|(table, _)| table.as_str()) {
            Some("") => format!("`{key}` does not belong {place}, but at the top of the scene"),
            Some(table) => format!("`{key}` does not belong {place}, but in `{table}`"),
            None => format!("unknown key `{key}` {place}{}", suggestion(key, self.known.iter().copied())),
        }
    }
}
