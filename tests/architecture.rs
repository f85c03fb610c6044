//! Imports point one way, and files stay small enough to read.
//!
//! math, mesh; then fem, contact and fracture, which do not know each other; then sim, scene;
//! frame is the seam that sim writes and render reads; export, viewer and cli on top. Nothing
//! below render names a graphics crate. Unit tests inside a file may reach further.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What each top-level module may import. A new module belongs into this table.
const ARROWS: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("io_reason", &[]),
    ("mesh", &["math", "io_reason"]),
    ("fem", &["math", "mesh"]),
    ("contact", &["math", "mesh"]),
    ("fracture", &["math", "mesh"]),
    ("frame", &[]),
    ("sim", &["math", "mesh", "fem", "contact", "fracture", "frame"]),
    ("scene", &["math", "mesh", "fracture", "frame", "io_reason", "sim"]),
    ("render", &["math", "frame"]),
    ("verify", &["math", "mesh", "fem", "contact", "fracture", "frame", "sim", "scene"]),
    ("export", &["math", "mesh", "fracture", "frame", "io_reason", "sim", "scene", "render"]),
    (
        "viewer",
        &[
            "math",
            "mesh",
            "fem",
            "contact",
            "fracture",
            "frame",
            "io_reason",
            "sim",
            "scene",
            "render",
            "export",
        ],
    ),
    (
        "cli",
        &[
            "math",
            "mesh",
            "fem",
            "fracture",
            "frame",
            "io_reason",
            "sim",
            "scene",
            "render",
            "export",
            "verify",
            "viewer",
        ],
    ),
    // The crate's root and the program only name modules.
    ("lib", &["cli"]),
    ("main", &["cli"]),
];
/// Modules that may name graphics crates.
const DRAWING: &[&str] = &["render", "export", "viewer", "cli"];
/// Crates that nothing below `render` names.
const GRAPHICS_CRATES: &[&str] =
    &["wgpu", "winit", "egui", "egui_wgpu", "egui_winit", "egui_plot", "image", "gif"];
/// Beyond this a file is no longer read in one sitting.
const MOST_LINES: usize = 700;

/// A source file: its path below `src`, and its text.
struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// `["sim", "world"]` for `sim/world.rs`, `["sim"]` for `sim/mod.rs` and `sim.rs`.
    fn module_path(&self) -> Vec<String> {
        let path = self.path.with_extension("");
        let mut names: Vec<String> = path.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if names.len() > 1 && names.last().is_some_and(|last| last == "mod") {
            names.pop();
        }
        names
    }

    fn is_test(&self) -> bool {
        self.module_path().iter().any(|name| name == "tests")
    }
}

#[test]
fn imports_point_one_way() {
    let wrong = violations(&sources());
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn files_stay_readable() {
    let long: Vec<String> = sources()
        .iter()
        .map(|source| (source.text.lines().count(), source.path.display()))
        .filter(|(lines, _)| *lines > MOST_LINES)
        .map(|(lines, path)| format!("src/{path}: {lines} lines"))
        .collect();
    let list = long.join("\n");
    assert!(long.is_empty(), "longer than {MOST_LINES} lines:\n{list}");
}

#[test]
fn made_up_violations_are_found() {
    let cases = [
        ("contact/response.rs", "use crate::fem::Forces;"),
        ("fem/forces.rs", "fn f() { crate::sim::World::new(); }"),
        ("mesh/surface.rs", "use crate::{\n    math::Cut,\n    scene::{self, Body},\n};"),
        ("sim/world.rs", "use super::super::scene::Scene;"),
        ("sim/mod.rs", "use super::render::View;"),
        ("sim/step/free.rs", "use super::super::super::viewer;"),
        ("scene/build.rs", "fn f(d: &wgpu::Device) {}"),
        ("frame.rs", "use image::RgbaImage;"),
        ("render/camera.rs", "pub use crate::sim::World;"),
        ("export/gif.rs", "use crate::viewer as v;"),
        ("brand_new/mod.rs", ""),
    ];
    for (path, text) in cases {
        let found = violations(&[made_up(path, text)]);
        assert_eq!(found.len(), 1, "{path}: {text} gave {found:?}");
    }
}

#[test]
fn what_is_allowed_is_not_complained_about() {
    let cases = [
        ("contact/response.rs", "use crate::mesh::TetMesh;\nuse super::pairs::Pair;"),
        ("contact/response.rs", "//! Unlike `crate::fem::Forces`.\n/* crate::sim::World */"),
        ("contact/response.rs", "const HELP: &str = \"a \\\" crate::sim::World\";"),
        ("sim/step/free.rs", "use super::super::world::World;"),
        ("fem/forces.rs", "#[cfg(test)]\nmod tests {\n    use crate::contact::Pair;\n}"),
        ("fem/tests.rs", "use crate::sim::World;"),
        ("scene/build.rs", "let wgpu_like = my_image::load();"),
        ("viewer/window.rs", "use crate::{render::View, sim::World};\nuse wgpu::Device;"),
    ];
    for (path, text) in cases {
        let found = violations(&[made_up(path, text)]);
        assert!(found.is_empty(), "{path}: {text} gave {found:?}");
    }
}

fn made_up(path: &str, text: &str) -> Source {
    Source { path: PathBuf::from(path), text: text.to_owned() }
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    collect(&root, &root, &mut found);
    assert!(found.len() > 10, "no sources below {}", root.display());
    found
}

fn collect(root: &Path, folder: &Path, found: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("the entry can be read").path();
        if path.is_dir() {
            collect(root, &path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(Source {
                text: fs::read_to_string(&path).expect("the source can be read"),
                path: path.strip_prefix(root).expect("it lies below").to_owned(),
            });
        }
    }
}

/// Everything in the sources that breaks the rules, a line each.
fn violations(sources: &[Source]) -> Vec<String> {
    let checked = sources.iter().filter(|source| !source.is_test());
    checked.flat_map(violations_in).collect()
}

fn violations_in(source: &Source) -> Vec<String> {
    let place = source.path.display();
    let module_path = source.module_path();
    let module = module_path[0].as_str();
    let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == module) else {
        return vec![format!("src/{place}: module `{module}` is not in the table of arrows")];
    };
    let code = code_of(&source.text);
    let arrows = imported_modules(&code, module_path.len())
        .into_iter()
        .filter(|name| name != module && !allowed.contains(&name.as_str()))
        .filter(|name| ARROWS.iter().any(|(known, _)| known == name))
        .map(|name| format!("src/{place}: `{module}` must not import `{name}`"));
    let drawing = named_crates(&code)
        .into_iter()
        .filter(|_| !DRAWING.contains(&module))
        .map(|name| format!("src/{place}: `{module}` must not name the crate `{name}`"));
    arrows.chain(drawing).collect()
}

/// The code without comments, string literals and the unit tests at its end.
fn code_of(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if next == '"' {
            string_length(rest)
        } else if rest.starts_with("'\"'") {
            3
        } else {
            code.push(next);
            next.len_utf8()
        };
        rest = &rest[length..];
    }
    code
}

/// Length of the string literal that `text` starts with, quotes included.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (index, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return index + 1,
            _ => {}
        }
    }
    text.len()
}

/// Top-level modules that the code names after `crate::`, or after enough `super::`.
fn imported_modules(code: &str, depth: usize) -> BTreeSet<String> {
    let to_root = "super::".repeat(depth);
    let mut found = BTreeSet::new();
    for root in ["crate::", to_root.as_str()] {
        for index in path_starts(code, root) {
            found.extend(first_names(&code[index + root.len()..]));
        }
    }
    found
}

/// Where `start` occurs as the beginning of a path.
fn path_starts<'a>(code: &'a str, start: &'a str) -> impl Iterator<Item = usize> + 'a {
    code.match_indices(start)
        .map(|(index, _)| index)
        .filter(|&index| !code[..index].ends_with(|c: char| is_word(c) || c == ':'))
}

/// The first name of a path, or of each path of a `{...}` group.
fn first_names(path: &str) -> Vec<String> {
    let first_name = |path: &str| path.chars().take_while(|&c| is_word(c)).collect();
    let Some(group) = path.strip_prefix('{') else {
        return vec![first_name(path)];
    };
    let mut names = Vec::new();
    let (mut depth, mut start) = (0, 0);
    for (index, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' | ',' if depth == 0 => {
                names.push(first_name(group[start..index].trim_start()));
                start = index + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    names
}

/// Graphics crates that the code names as the start of a path.
fn named_crates(code: &str) -> Vec<&'static str> {
    let is_named = |name: &str| path_starts(code, &format!("{name}::")).next().is_some();
    let crates = GRAPHICS_CRATES.iter().copied();
    crates.filter(|name| is_named(name)).collect()
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
