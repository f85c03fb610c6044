//! Paths into a scene: `bodies.hammer.velocity[2]`, `materials.glass.density`.

use super::presets::PRESETS;
use super::problem::suggestion;
use super::tree::{Node, Origin, Value};

/// One step of a resolved path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Segment {
    /// Into a table.
    Key(String),
    /// Into a list.
    Index(usize),
}

/// Tables whose keys are names chosen by the scene's author: an override must name one that is there.
const NAMED_TABLES: [&str; 2] = ["materials", "cameras"];

/// Keys that say the same thing in different words: a table may have one of each group, and an override
/// with one of them takes the place of the others.
pub(super) const RIVALS: [&[&str]; 3] =
    [&["friction", "friction_angle"], &["refinement", "element_size", "cells"], &["shape", "mesh"]];

/// The keys that a key takes the place of.
pub(super) fn rivals_of(key: &str) -> impl Iterator<Item = &'static str> {
    let group = RIVALS.iter().find(|group| group.contains(&key));
    let key = key.to_owned();
    group.into_iter().flat_map(|group| group.iter().copied()).filter(move |rival| *rival != key)
}

/// A path and one more step; either may be empty.
pub(super) fn join(path: &str, key: &str) -> String {
    match (path.is_empty(), key.is_empty()) {
        (true, _) => key.to_owned(),
        (_, true) => path.to_owned(),
        _ => format!("{path}.{key}"),
    }
}

/// Splits `a.b[2].c` into `a`, `b`, `2`, `c`.
pub(super) fn split(path: &str) -> Result<Vec<&str>, String> {
    let parts: Vec<&str> = path
        .split('.')
        .flat_map(|part| part.split('['))
        .map(|part| part.trim().trim_end_matches(']'))
        .collect();
    if parts.iter().any(|part| part.is_empty()) {
        return Err(format!(
            "`{path}` is not a path; write names with dots between them, as in \
             `materials.glass.density` or `bodies.hammer.velocity[2]`"
        ));
    }
    if parts.len() > MOST_STEPS {
        return Err(format!("the path has {} steps, and nothing in a scene lies so deep", parts.len()));
    }
    Ok(parts)
}

/// Steps of a path at most: each is a level of recursion, and the deepest value of a scene has seven.
const MOST_STEPS: usize = 32;

/// Where the value at `path` came from; the nearest table around it when it is absent.
pub(super) fn locate(root: &Node, path: &str) -> Origin {
    let mut node = root;
    let mut origin = root.origin;
    for part in split(path).unwrap_or_default() {
        let next = match &node.value {
            Value::Table(entries) => {
                entries.iter().find(|entry| entry.key == part).map(|entry| (entry.key_origin, &entry.node))
            }
            Value::List(items) => {
                list_index(items, part).ok().map(|index| (items[index].origin, &items[index]))
            }
            _ => None,
        };
        let Some((next_origin, next_node)) = next else {
            break;
        };
        (origin, node) = (next_origin, next_node);
    }
    origin
}

/// Turns the parts of a path into steps through the tree: list items by number or by their `name`.
/// Keys that are absent are kept as they are, for the checks to accept or refuse.
pub(super) fn resolve(root: &Node, parts: &[&str]) -> Result<Vec<Segment>, String> {
    let mut steps = Vec::with_capacity(parts.len());
    let mut node = Some(root);
    for (depth, part) in parts.iter().enumerate() {
        let before = || parts[..depth].join(".");
        if let [table] = parts[..depth] {
            refuse_unknown_name(node, table, part)?;
        }
        let Some(current) = node else {
            if part.parse::<usize>().is_ok() {
                return Err(format!(
                    "`{}` is not in the scene's text, so it has no number {part}; set it as a whole",
                    before()
                ));
            }
            steps.push(Segment::Key((*part).to_owned()));
            continue;
        };
        match &current.value {
            Value::Table(_) => {
                node = current.get(part);
                steps.push(Segment::Key((*part).to_owned()));
            }
            Value::List(items) => {
                let index = list_index(items, part).map_err(|reason| format!("`{}` {reason}", before()))?;
                node = Some(&items[index]);
                steps.push(Segment::Index(index));
            }
            _ => {
                return Err(format!(
                    "`{}` is {}, so there is nothing called `{part}` in it",
                    before(),
                    current.in_words()
                ));
            }
        }
    }
    Ok(steps)
}

/// Refuses to invent a material or a camera, which would silently be used by nothing. Materials of the
/// library need no entry of their own to be changed.
fn refuse_unknown_name(node: Option<&Node>, table: &str, name: &str) -> Result<(), String> {
    if !NAMED_TABLES.contains(&table) {
        return Ok(());
    }
    let entries = node.and_then(Node::entries).unwrap_or_default();
    let own = entries.iter().map(|entry| entry.key.as_str());
    let library = PRESETS.iter().map(|preset| preset.name);
    let names = own.chain(library.filter(|_| table == "materials"));
    if names.clone().any(|known| known == name) {
        return Ok(());
    }
    let hint = suggestion(name, names);
    Err(format!("there is nothing called `{name}` in `{table}`{hint}"))
}

fn list_index(items: &[Node], part: &str) -> Result<usize, String> {
    if let Ok(index) = part.parse::<usize>() {
        return if index < items.len() {
            Ok(index)
        } else {
            Err(format!("has no number {index}: it has {}, counted from 0", items.len()))
        };
    }
    let names = items.iter().filter_map(|item| item.get("name")?.text());
    items
        .iter()
        .position(|item| item.get("name").and_then(Node::text) == Some(part))
        .ok_or_else(|| format!("has nothing called `{part}`{}", suggestion(part, names)))
}
