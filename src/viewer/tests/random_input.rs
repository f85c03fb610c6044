//! Thousands of random clicks, drags, keys, words, dropped files and sizes: nothing may panic, hang or fail to draw.
//!
//! The seed is fixed, so that a failure comes again. `HAMMERFALL_RANDOM_INPUT_S=600` goes on for ten minutes instead
//! of some hundred frames, `HAMMERFALL_RANDOM_INPUT_SEED` tries another way.

use crate::scene::BUILTIN_SCENES;
use crate::viewer::app::App;
use crate::viewer::off_screen_window::OffScreenWindow;
use crate::viewer::simulation::Simulation;
use crate::viewer::thumbnails::Sketcher;
use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, pos2, vec2};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Frames of a short run.
const FRAMES: u32 = 700;
/// Frames between two looks at whether the simulation still answers.
const LOOK: u32 = 100;
/// A frame or an answer that takes longer never comes. Fine scenes take their time on a busy machine.
const STUCK: Duration = Duration::from_secs(240);
/// Files that may lie about before they are cleared away.
const MOST_FILES: usize = 40;
/// Wall time of a frame, s.
const FRAME_S: f64 = 1.0 / 30.0;

const KEYS: [Key; 27] = [
    Key::Space,
    Key::Period,
    Key::R,
    Key::T,
    Key::F,
    Key::W,
    Key::G,
    Key::F1,
    Key::Escape,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Home,
    Key::End,
    Key::Num1,
    Key::Num5,
    Key::Num9,
    Key::Tab,
    Key::Enter,
    Key::Backspace,
    Key::Delete,
    Key::Y,
    Key::Z,
    Key::S,
    Key::A,
    Key::Plus,
];
const WORDS: [&str; 14] = [
    "0",
    "-1",
    "1e300",
    "nan",
    "-inf",
    "3 GPa",
    "s1 - Ft",
    "max(",
    "/0",
    "1e-300",
    "ü§€ \u{202e}x",
    "\u{0}",
    "\n",
    "12",
];
const SIZES: [[u32; 2]; 12] = [
    [0, 0],
    [0, 500],
    [900, 0],
    [1, 1],
    [7, 1400],
    [1500, 9],
    [640, 420],
    [900, 600],
    [900, 600],
    [1280, 720],
    [1280, 720],
    [1000, 800],
];

/// xorshift64*: S. Vigna, ACM Trans. Math. Softw. 42 (2016).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 16
    }

    fn below(&mut self, count: usize) -> usize {
        (self.roll() % count as u64) as usize
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    fn share(&mut self) -> f32 {
        self.below(10_000) as f32 / 10_000.0
    }
}

/// Ends the whole process when frames stop coming: a stuck thread cannot be told to fail.
struct Watchdog {
    frames: Arc<AtomicU64>,
}

impl Watchdog {
    fn start(seed: u64) -> Self {
        let frames = Arc::new(AtomicU64::new(0));
        let seen = Arc::downgrade(&frames);
        std::thread::spawn(move || {
            let (mut last, mut since) = (0, Instant::now());
            while let Some(frames) = seen.upgrade() {
                let now = frames.load(Ordering::Relaxed);
                if now != last {
                    (last, since) = (now, Instant::now());
                }
                if since.elapsed() > STUCK {
                    eprintln!("random input with seed {seed}: stuck in frame {now}");
                    std::process::exit(101);
                }
                drop(frames);
                std::thread::sleep(Duration::from_millis(200));
            }
        });
        Self { frames }
    }

    fn pat(&self) {
        self.frames.fetch_add(1, Ordering::Relaxed);
    }
}

/// Somebody without a plan.
struct Monkey {
    dice: Dice,
    at: Pos2,
    held: Option<PointerButton>,
    folder: PathBuf,
    files: Vec<PathBuf>,
}

impl Monkey {
    fn new(seed: u64, folder: &Path) -> Self {
        let file = |name: &str, content: &[u8]| {
            let path = folder.join(name);
            std::fs::write(&path, content).unwrap();
            path
        };
        let files = vec![
            file("sound.toml", include_bytes!("../../../assets/scenes/bounce.toml")),
            file("cut-short.toml", b"title = \"x\"\n[[bodies]]\nname = "),
            file("not-text.toml", &[0xff, 0x00, 0xfe, 0x80, 0x0a]),
            file("empty.toml", b""),
            file("mesh.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n9999999999 1 1 1\n"),
            folder.to_owned(),
            folder.join("is-not-there.toml"),
        ];
        Self { dice: Dice(seed | 1), at: Pos2::ZERO, held: None, folder: folder.to_owned(), files }
    }

    fn place(&mut self, size_px: [u32; 2]) -> Pos2 {
        let [width, height] = size_px.map(|side| side as f32);
        // Now and then outside.
        pos2(self.dice.share() * width * 1.02, self.dice.share() * height * 1.02)
    }

    fn button(&mut self, button: PointerButton, pressed: bool) -> Event {
        self.held = pressed.then_some(button);
        Event::PointerButton { pos: self.at, button, pressed, modifiers: Modifiers::NONE }
    }

    /// What happens in one frame.
    fn events(&mut self, size_px: [u32; 2]) -> Vec<Event> {
        if let Some(button) = self.held {
            self.at = self.place(size_px);
            let moved = Event::PointerMoved(self.at);
            let ends = self.dice.below(3) == 0;
            return std::iter::once(moved).chain(ends.then(|| self.button(button, false))).collect();
        }
        match self.dice.below(20) {
            0..=10 => {
                self.at = self.place(size_px);
                let choices = [
                    PointerButton::Primary,
                    PointerButton::Primary,
                    PointerButton::Primary,
                    PointerButton::Secondary,
                    PointerButton::Middle,
                ];
                let button = self.dice.one_of(&choices);
                let mut events = vec![Event::PointerMoved(self.at), self.button(button, true)];
                if self.dice.below(3) > 0 {
                    events.push(self.button(button, false));
                }
                events
            }
            11..=15 => self.key(),
            16 => vec![Event::Text(self.dice.one_of(&WORDS).to_owned()), self.enter()],
            17 => vec![Event::Paste(self.dice.one_of(&WORDS).repeat(40))],
            18 => vec![Event::PointerGone, Event::WindowFocused(self.dice.below(2) == 0)],
            _ => vec![Event::MouseWheel {
                unit: self.dice.one_of(&[MouseWheelUnit::Line, MouseWheelUnit::Page, MouseWheelUnit::Point]),
                delta: vec2(0.0, 200.0 * (self.dice.share() - 0.5)),
                phase: TouchPhase::Move,
                source: egui::MouseWheelSource::Unknown,
                modifiers: self.dice.one_of(&[Modifiers::NONE, Modifiers::CTRL, Modifiers::SHIFT]),
            }],
        }
    }

    fn key(&mut self) -> Vec<Event> {
        let key = self.dice.one_of(&KEYS);
        let modifiers = self.dice.one_of(&[
            Modifiers::NONE,
            Modifiers::NONE,
            Modifiers::NONE,
            Modifiers::COMMAND,
            Modifiers::SHIFT,
        ]);
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        vec![event(true), event(false)]
    }

    fn enter(&self) -> Event {
        Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    /// What does not come as an event of egui: other sizes and scales, dropped files, a lost device.
    fn shake(&mut self, window: &mut OffScreenWindow) {
        match self.dice.below(60) {
            0 => window.size_px = self.dice.one_of(&SIZES),
            1 => window.pixels_per_point = self.dice.one_of(&[0.5, 1.0, 1.0, 1.25, 2.0, 3.0]),
            2 => {
                let file = self.files[self.dice.below(self.files.len())].clone();
                window.app.open(&file.to_string_lossy(), &[]);
            }
            3 if self.dice.below(4) == 0 => {
                window.lose_device();
                window.recover().unwrap();
            }
            _ => {}
        }
        // Whatever is typed there: a test leaves nothing behind.
        if Path::new(&window.app.save.folder) != self.folder {
            window.app.save.folder = self.folder.to_string_lossy().into_owned();
        }
    }

    fn tidy(&self) {
        let entries = std::fs::read_dir(&self.folder).unwrap().flatten().map(|entry| entry.path());
        let saved: Vec<PathBuf> = entries.filter(|path| !self.files.contains(path)).collect();
        if saved.len() > MOST_FILES {
            saved.iter().for_each(|path| drop(std::fs::remove_file(path)));
        }
    }
}

/// A number in an environment variable.
fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().map(|text| text.parse().expect("a whole number"))
}

/// Whether there is still somebody who answers.
fn wait_for_the_simulation(window: &mut OffScreenWindow, seed: u64, frame: u32) {
    let asked = Instant::now();
    while window.app.is_waiting() {
        let input = window.input(FRAME_S, Vec::new());
        window.frame(input).unwrap();
        std::thread::sleep(Duration::from_millis(5));
        assert!(
            asked.elapsed() < STUCK,
            "the simulation does not answer, or is asked without end: seed {seed}, frame {frame}, {} done, sent {:?}",
            window.app.snapshot.commands_done,
            window.app.asked_lately(),
        );
    }
    let notes = [window.app.snapshot.run_error.as_deref(), window.app.notice()];
    for note in notes.into_iter().flatten() {
        assert!(!note.contains("mistake in hammerfall"), "seed {seed}, frame {frame}: {note}");
    }
}

#[test]
fn random_input_neither_panics_nor_hangs() {
    let seed = number("HAMMERFALL_RANDOM_INPUT_SEED").unwrap_or(7);
    let duration = number("HAMMERFALL_RANDOM_INPUT_S").map(Duration::from_secs);
    let folder = tempfile::tempdir().unwrap();
    let simulation = Simulation::start(Box::new(|| {})).unwrap();
    let mut app = App::new(simulation, Sketcher::idle());
    app.save.folder = folder.path().to_string_lossy().into_owned();
    app.open("brick-pile", &[]);
    let mut window = OffScreenWindow::new(app, [900, 600], 1.0).unwrap();
    let mut monkey = Monkey::new(seed, folder.path());
    let watchdog = Watchdog::start(seed);
    let started = Instant::now();
    let mut frame = 0;
    while duration.map_or(frame < FRAMES, |duration| started.elapsed() < duration) {
        monkey.shake(&mut window);
        let events = monkey.events(window.size_px);
        let input = window.input(FRAME_S, events);
        window.frame(input).unwrap_or_else(|error| panic!("seed {seed}, frame {frame}: {error}"));
        watchdog.pat();
        frame += 1;
        if frame.is_multiple_of(LOOK) {
            wait_for_the_simulation(&mut window, seed, frame);
            monkey.tidy();
            if window.app.is_gallery || window.app.snapshot.scene.is_none() {
                let scene = BUILTIN_SCENES[monkey.dice.below(BUILTIN_SCENES.len())].name;
                // In a short run, nothing that takes long to open.
                window.app.open(scene.trim_end_matches("-fine"), &[]);
            }
        }
    }
    wait_for_the_simulation(&mut window, seed, frame);
    println!("random input: {frame} frames in {:.0} s, seed {seed}", started.elapsed().as_secs_f64());
}
