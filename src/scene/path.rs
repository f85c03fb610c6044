//! Paths into a scene: `bodies.hammer.velocity[2]`, `materials.glass.density`.

use super::presets;
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
    Ok(parts)
}

/// Where the value at `path` came from; the nearest table around it when it is absent.
pub(super) fn locate(root: &Node, path: &str) -> Origin {
    let mut node = root;
    let mut origin = root.origin;
    for part in split(path).unwrap_or_default() {
        let next = match &node.value {
            Value::Table(entries) => entries
                .iter()
                .find(|entry| entry.key == part)
                .map(|entry| (entry.key_origin, &entry.node)),
            Value::List(items) => list_index(items, part)
                .ok()
                .map(|index| (items[index].origin, &items[index])),
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
        let Some(current) = node else {
            steps.push(Segment::Key((*part).to_owned()));
            continue;
        };
        match &current.value {
            Value::Table(_) => {
                node = current.get(part);
                if node.is_none() {
                    refuse_unknown_name(current, &parts[..depth], part)?;
                }
                steps.push(Segment::Key((*part).to_owned()));
            }
            Value::List(items) => {
                let index =
                    list_index(items, part).map_err(|reason| format!("`{}` {reason}", before()))?;
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

/// Refuses to invent a material or a camera, which would silently be used by nothing.
fn refuse_unknown_name(table: &Node, before: &[&str], name: &str) -> Result<(), String> {
    let [parent] = before else {
        return Ok(());
    };
    let preset = *parent == "materials" && presets::find(name).is_some();
    if preset || !NAMED_TABLES.contains(parent) {
        return Ok(());
    }
    let names = table.entries().unwrap_or_default().iter();
    Err(format!(
        "there is nothing called `{name}` in `{parent}`{}",
        suggestion(name, names.map(|entry| entry.key.as_str()))
    ))
}

fn list_index(items: &[Node], part: &str) -> Result<usize, String> {
    if let Ok(index) = part.parse::<usize>() {
        return if index < items.len() {
            Ok(index)
        } else {
            Err(format!(
                "has {} entries, numbered from 0, so there is no number {index}",
                items.len()
            ))
        };
    }
    let names = items.iter().filter_map(|item| item.get("name")?.text());
    items
        .iter()
        .position(|item| item.get("name").and_then(Node::text) == Some(part))
        .ok_or_else(|| format!("has nothing called `{part}`{}", suggestion(part, names)))
}
