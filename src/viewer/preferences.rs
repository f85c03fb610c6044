//! What the window remembers between runs: its size, panels, light or dark. A small file in the user's configuration
//! folder, which nothing depends on: when it cannot be read or written, that is said and the viewer goes on.

use super::app::App;
use super::ui::SIDE_WIDTH;
use crate::io_reason::io_reason;
use etcetera::BaseStrategy as _;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fs, io};

/// Environment variable that names the folder of the file.
pub const FOLDER_VARIABLE: &str = "HAMMERFALL_CONFIG";
/// Name of the file.
const FILE: &str = "layout.toml";
/// A layout of more bytes is none of ours.
const MOST_BYTES: u64 = 1 << 16;
/// How long something has to stay the same until it is written: a panel that is being dragged is not.
const SETTLED: Duration = Duration::from_secs(2);
/// Size of a new window, points.
const WINDOW: [f64; 2] = [1280.0, 800.0];
/// Below this the panels do not fit, points.
pub const LEAST_WINDOW: [f64; 2] = [640.0, 420.0];
/// No display is larger, points.
const LARGEST_WINDOW: f64 = 16384.0;
/// Widest panel, points.
const WIDEST_PANEL: f32 = 4096.0;
/// Smallest and largest scale of text and buttons.
const ZOOM: [f32; 2] = [0.5, 4.0];

/// What is remembered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Width and height of the window when it is not maximised, points.
    pub window: [f64; 2],
    /// Whether the window fills the screen.
    pub is_maximized: bool,
    /// Scale of text and buttons on top of the display's.
    pub zoom: f32,
    /// Dark surroundings.
    pub is_dark: bool,
    /// Edges of the elements.
    pub wireframe: bool,
    /// Full detail in motion.
    pub is_always_fine: bool,
    /// Whether the left panel is there.
    pub parameters: bool,
    /// Whether the right panel is there.
    pub inspector: bool,
    /// Width of the left panel, points.
    pub parameters_width: f32,
    /// Width of the right panel, points.
    pub inspector_width: f32,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            window: WINDOW,
            is_maximized: false,
            zoom: 1.0,
            is_dark: false,
            wireframe: false,
            is_always_fine: false,
            parameters: true,
            inspector: true,
            parameters_width: SIDE_WIDTH,
            inspector_width: SIDE_WIDTH,
        }
    }
}

impl Preferences {
    /// What a text says; values that no window can have are replaced by the nearest that one can have.
    fn parse(text: &str) -> Result<Self, String> {
        let read: Self = toml::from_str(text).map_err(|error| error.message().to_owned())?;
        let usual = Self::default();
        let sound = |value: f32, usual: f32, [least, most]: [f32; 2]| {
            if value.is_finite() { value.clamp(least, most) } else { usual }
        };
        let side = |axis: usize| {
            let value = read.window[axis];
            if value.is_finite() { value.clamp(LEAST_WINDOW[axis], LARGEST_WINDOW) } else { WINDOW[axis] }
        };
        let panel = |width| sound(width, SIDE_WIDTH, [SIDE_WIDTH, WIDEST_PANEL]);
        Ok(Self {
            window: [side(0), side(1)],
            zoom: sound(read.zoom, usual.zoom, ZOOM),
            parameters_width: panel(read.parameters_width),
            inspector_width: panel(read.inspector_width),
            ..read
        })
    }

    /// Gives the viewer what is remembered of it.
    pub fn apply(&self, app: &mut App, context: &egui::Context) {
        app.look.is_dark = self.is_dark;
        app.look.wireframe = self.wireframe;
        app.look.is_always_fine = self.is_always_fine;
        app.panels.parameters = self.parameters;
        app.panels.inspector = self.inspector;
        app.panels.parameters_width = self.parameters_width;
        app.panels.inspector_width = self.inspector_width;
        context.set_zoom_factor(self.zoom);
    }

    /// Takes in how the viewer looks now.
    pub fn take_in(&mut self, app: &App, context: &egui::Context) {
        self.is_dark = app.look.is_dark;
        self.wireframe = app.look.wireframe;
        self.is_always_fine = app.look.is_always_fine;
        self.parameters = app.panels.parameters;
        self.inspector = app.panels.inspector;
        self.parameters_width = app.panels.parameters_width.round();
        self.inspector_width = app.panels.inspector_width.round();
        self.zoom = context.zoom_factor();
    }
}

/// The file of the layout, and what it holds.
pub struct Keeper {
    path: Option<PathBuf>,
    kept: Preferences,
    now: Preferences,
    changed: Instant,
    has_failed: bool,
}

impl Keeper {
    /// Reads the user's layout. Without a home there is none; what is wrong with one comes back as a text.
    #[must_use]
    pub fn open() -> (Self, Option<String>) {
        Self::open_in(folder())
    }

    /// Reads the layout in a folder.
    fn open_in(folder: Option<PathBuf>) -> (Self, Option<String>) {
        let path = folder.map(|folder| folder.join(FILE));
        let read = path.as_deref().map_or_else(|| Ok(Preferences::default()), read);
        let (kept, trouble) = match read {
            Ok(kept) => (kept, None),
            Err(reason) => (Preferences::default(), Some(reason)),
        };
        let now = kept.clone();
        (Self { path, kept, now, changed: Instant::now(), has_failed: false }, trouble)
    }

    /// What is remembered.
    #[must_use]
    pub fn preferences(&self) -> &Preferences {
        &self.now
    }

    /// Takes in how things are now, and writes them when they have settled. What is wrong comes back as a text, once.
    pub fn keep(&mut self, now: Preferences) -> Option<String> {
        if now != self.now {
            self.now = now;
            self.changed = Instant::now();
        }
        if self.changed.elapsed() < SETTLED { None } else { self.close() }
    }

    /// Writes what has changed. What is wrong comes back as a text, once.
    pub fn close(&mut self) -> Option<String> {
        let path = self.path.as_deref().filter(|_| self.now != self.kept && !self.has_failed)?;
        match write(path, &self.now) {
            Ok(()) => {
                self.kept = self.now.clone();
                None
            }
            Err(reason) => {
                self.has_failed = true;
                Some(reason)
            }
        }
    }
}

/// The folder of the layout; `None` for somebody without a home.
fn folder() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os(FOLDER_VARIABLE).filter(|folder| !folder.is_empty()) {
        return Some(PathBuf::from(folder));
    }
    Some(etcetera::base_strategy::choose_native_strategy().ok()?.config_dir().join("hammerfall"))
}

fn read(path: &Path) -> Result<Preferences, String> {
    let failed = |reason: String| {
        format!(
            "The layout of the last time cannot be read from {}: {reason}. It is ignored.",
            path.display()
        )
    };
    match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Preferences::default()),
        Ok(file) if file.len() > MOST_BYTES => return Err(failed("it is far too large".to_owned())),
        // A pipe would be waited on for ever.
        Ok(file) if !file.is_file() => return Err(failed("it is no file".to_owned())),
        Err(error) => return Err(failed(io_reason(&error))),
        Ok(_) => {}
    }
    let text = fs::read_to_string(path).map_err(|error| failed(io_reason(&error)))?;
    Preferences::parse(&text).map_err(failed)
}

/// The file appears whole or not at all.
fn write(path: &Path, preferences: &Preferences) -> Result<(), String> {
    let failed = |reason: String| format!("The layout cannot be remembered in {}: {reason}.", path.display());
    let text = toml::to_string(preferences).map_err(|error| failed(error.to_string()))?;
    let unfinished = path.with_extension(format!("{}.unfinished", std::process::id()));
    let written = path
        .parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::write(&unfinished, text))
        .and_then(|()| fs::rename(&unfinished, path));
    written.map_err(|error| {
        let _ = fs::remove_file(&unfinished);
        failed(io_reason(&error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed() -> Preferences {
        Preferences {
            window: [1000.0, 700.0],
            is_maximized: true,
            zoom: 1.5,
            is_dark: true,
            wireframe: true,
            is_always_fine: true,
            parameters: false,
            inspector: false,
            parameters_width: 300.0,
            inspector_width: 400.0,
        }
    }

    #[test]
    fn what_was_kept_is_there_the_next_time() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("not/there/yet");
        let (mut keeper, trouble) = Keeper::open_in(Some(folder.clone()));
        assert_eq!((keeper.preferences(), trouble), (&Preferences::default(), None));
        // Nothing is written before it has settled, and nothing that is as it was.
        assert_eq!((keeper.keep(Preferences::default()), keeper.close()), (None, None));
        assert!(!folder.exists());
        assert_eq!((keeper.keep(changed()), keeper.close()), (None, None));
        let (keeper, trouble) = Keeper::open_in(Some(folder.clone()));
        assert_eq!((keeper.preferences(), trouble), (&changed(), None));
        assert_eq!(fs::read_dir(folder).unwrap().count(), 1, "something was left behind");
    }

    #[test]
    fn nonsense_is_ignored_with_a_word() {
        let home = tempfile::tempdir().unwrap();
        let large = "#".repeat(MOST_BYTES as usize + 1);
        for text in ["window = 7", "is_dark = \"perhaps\"", "[[", "\0", "window = [1.0]", &large] {
            fs::write(home.path().join(FILE), text).unwrap();
            let (keeper, trouble) = Keeper::open_in(Some(home.path().to_owned()));
            assert_eq!(keeper.preferences(), &Preferences::default());
            assert!(trouble.is_some_and(|text| text.contains(FILE) && text.contains("ignored")));
        }
        fs::write(home.path().join(FILE), [0xff, 0xfe, 0x00]).unwrap();
        assert!(Keeper::open_in(Some(home.path().to_owned())).1.is_some());
        fs::remove_file(home.path().join(FILE)).unwrap();
        fs::create_dir(home.path().join(FILE)).unwrap();
        assert!(Keeper::open_in(Some(home.path().to_owned())).1.is_some());
    }

    #[test]
    fn absurd_values_become_sound_and_unknown_ones_are_left_alone() {
        let text = "window = [nan, 1e300]\nzoom = -inf\nparameters_width = 1e9\nnew_in_a_later_version = 3\n";
        let read = Preferences::parse(text).unwrap();
        assert_eq!(read.window, [WINDOW[0], LARGEST_WINDOW]);
        assert_eq!((read.zoom, read.parameters_width), (1.0, WIDEST_PANEL));
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_once() {
        let home = tempfile::tempdir().unwrap();
        let in_the_way = home.path().join("file");
        fs::write(&in_the_way, "").unwrap();
        let (mut keeper, _) = Keeper::open_in(Some(in_the_way.join("folder")));
        keeper.keep(changed());
        assert!(keeper.close().is_some_and(|text| text.contains("cannot be remembered")));
        assert_eq!(keeper.close(), None);
        let (mut homeless, trouble) = Keeper::open_in(None);
        homeless.keep(changed());
        assert_eq!((trouble, homeless.close()), (None, None));
    }
}
