//! Takes out of a failing scene whatever it fails without.

use super::checks::check;
use hammerfall::scene::Scene;
use std::path::Path;
use toml::{Table, Value};

/// The kind of failure: the words before the first number.
fn failure_of(scene: &Table) -> Option<String> {
    let text = toml::to_string(scene).ok()?;
    let scene = Scene::from_text("reduced", &text, Path::new("."), &[]).ok()?;
    let reason = check(&scene).err()?;
    Some(reason.chars().take_while(|c| !c.is_ascii_digit()).collect())
}

/// Every key and every item of a list, deepest last, as the steps that lead there.
fn places(value: &Value, here: &[String], found: &mut Vec<Vec<String>>) {
    let mut visit = |step: String, value: &Value| {
        let mut path = here.to_vec();
        path.push(step);
        found.push(path.clone());
        places(value, &path, found);
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| visit(key.clone(), value)),
        Value::Array(items) => (0..items.len()).rev().for_each(|i| visit(i.to_string(), &items[i])),
        _ => {}
    }
}

fn without(value: &mut Value, path: &[String]) {
    let [step, rest @ ..] = path else { return };
    match value {
        Value::Table(table) if rest.is_empty() => {
            table.remove(step);
        }
        Value::Array(items) if rest.is_empty() => {
            items.remove(step.parse().unwrap_or_default());
        }
        Value::Table(table) => table.get_mut(step).into_iter().for_each(|inner| without(inner, rest)),
        Value::Array(items) => {
            let inner = step.parse().ok().and_then(|index: usize| items.get_mut(index));
            inner.into_iter().for_each(|inner| without(inner, rest));
        }
        _ => {}
    }
}

/// A scene that fails in the same way and no longer does when any one thing is taken out of it.
pub fn reduce(text: &str) -> String {
    let mut scene: Table = text.parse().expect("TOML");
    let wanted = failure_of(&scene).expect("a scene that fails");
    loop {
        let mut all = Vec::new();
        places(&Value::Table(scene.clone()), &[], &mut all);
        let smaller = all.iter().find_map(|path| {
            let mut tried = Value::Table(scene.clone());
            without(&mut tried, path);
            let Value::Table(tried) = tried else { return None };
            (failure_of(&tried).as_ref() == Some(&wanted)).then_some(tried)
        });
        match smaller {
            Some(smaller) => scene = smaller,
            None => return toml::to_string(&scene).expect("TOML"),
        }
        println!("{} bytes", toml::to_string(&scene).expect("TOML").len());
    }
}
