//! The real program in a real window, under an X server of its own.

#![cfg(target_os = "linux")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything; a software driver on a busy machine is slow, one that hangs never comes back.
const TIME_LIMIT: Duration = Duration::from_secs(240);

/// An X server without a screen, ended with this.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts the server on a free display; `None` when it is not installed.
    fn start() -> Option<Self> {
        // With -displayfd the server picks a free number itself and tells it on its stdout.
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match server {
            Ok(server) => server,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
            Err(error) => panic!("Xvfb cannot be started: {error}"),
        };
        let mut line = String::new();
        let stdout = server.stdout.take().expect("stdout is piped");
        std::io::BufRead::read_line(&mut std::io::BufReader::new(stdout), &mut line)
            .expect("Xvfb tells its display");
        assert!(line.trim().parse::<u32>().is_ok(), "Xvfb did not start: it said {line:?}");
        Some(Self { server, name: format!(":{}", line.trim()) })
    }

    /// As [`Self::start`], but says loudly when it is not there, and fails for it where it must be.
    fn start_or_skip() -> Option<Self> {
        let display = Self::start();
        if display.is_none() {
            assert!(
                std::env::var("CI").as_deref() != Ok("true"),
                "Xvfb is not installed, and at CI the window must be tested: apt install xvfb"
            );
            // Not by `eprintln!`, which the test harness keeps to itself unless the test fails.
            let _ = writeln!(
                std::io::stderr(),
                "SKIPPED: no window was tested, since Xvfb is not installed (apt install xvfb)"
            );
        }
        display
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Runs the viewer to its end, with nothing remembered.
fn run_viewer(display: Option<&str>, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    run_viewer_in(folder.path(), display, arguments)
}

/// Runs the viewer to its end; it remembers its layout in `folder`.
fn run_viewer_in(folder: &Path, display: Option<&str>, arguments: &[&str]) -> Output {
    let runtime = tempfile::tempdir().expect("a temporary folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_hammerfall"));
    command.args(arguments).env("XDG_RUNTIME_DIR", runtime.path()).env("HAMMERFALL_GPU", "software");
    command.env("HAMMERFALL_CONFIG", folder);
    command.env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env_remove("DISPLAY");
    if let Some(display) = display {
        command.env("DISPLAY", display);
    }
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait(child)
}

fn wait(mut child: Child) -> Output {
    let started = Instant::now();
    while child.try_wait().expect("the program can be waited for").is_none() {
        if started.elapsed() > TIME_LIMIT {
            let _ = child.kill();
            panic!("the window is still open after {TIME_LIMIT:?}: {:?}", child.wait_with_output());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("its output can be read")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The numbers of the closing line: frames, sizes, simulated seconds.
fn numbers(stdout: &str) -> (u32, u32, f64) {
    let words: Vec<&str> = stdout.split([' ', ',']).filter(|word| !word.is_empty()).collect();
    let before = |word: &str| words[words.iter().position(|w| w.starts_with(word)).expect(stdout) - 1];
    let after = |word: &str| words[words.iter().position(|w| *w == word).expect(stdout) + 1];
    (
        before("frames").parse().expect(stdout),
        before("sizes").parse().expect(stdout),
        after("simulated").parse().expect(stdout),
    )
}

#[test]
fn a_scene_plays_in_a_window_that_is_resized_and_closed() {
    let Some(display) = Display::start_or_skip() else { return };
    let output = run_viewer(Some(&display.name), &["view", "hammer-ground", "--quit-after-frames", "45"]);
    assert!(output.status.success(), "{}\n{}", output.status, text(&output.stderr));
    let (frames, sizes, simulated_s) = numbers(&text(&output.stdout));
    assert_eq!((frames, sizes), (45, 3), "{}", text(&output.stdout));
    assert!(simulated_s > 0.0, "{}", text(&output.stdout));
    assert_eq!(text(&output.stderr), "");
}

/// Squeezed to a pixel, minimised, taken off the screen, its graphics device taken away twice.
#[test]
fn a_window_that_is_handled_roughly_goes_on() {
    let Some(display) = Display::start_or_skip() else { return };
    let arguments = ["view", "bounce", "--quit-after-frames", "42", "--rough"];
    let output = run_viewer(Some(&display.name), &arguments);
    let report = text(&output.stdout);
    assert!(output.status.success(), "{}\n{}", output.status, text(&output.stderr));
    let (frames, sizes, simulated_s) = numbers(&report);
    assert_eq!((frames, sizes), (42, 4), "{report}");
    assert!(report.contains(" 2 recoveries"), "{report}");
    assert!(simulated_s > 0.0, "{report}");
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn the_layout_is_remembered_and_nonsense_or_a_full_disk_stop_nothing() {
    let Some(display) = Display::start_or_skip() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("layout.toml");
    std::fs::write(&file, "is_dark = true\nwindow = [\"wide\"").expect("a file");
    let arguments = ["view", "--quit-after-frames", "9"];
    let output = run_viewer_in(folder.path(), Some(&display.name), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let kept = std::fs::read_to_string(&file).expect("the layout is kept");
    assert!(kept.contains("window = [1100.0, 700.0]") && kept.contains("is_dark = false"), "{kept}");
    // The last size is the first one of the next time, so that there is one fewer.
    std::fs::write(&file, kept.replace("is_dark = false", "is_dark = true")).expect("a file");
    let output = run_viewer_in(folder.path(), Some(&display.name), &arguments);
    assert_eq!(numbers(&text(&output.stdout)).1, 2, "{}", text(&output.stdout));
    assert!(std::fs::read_to_string(&file).expect("the layout is kept").contains("is_dark = true"));
    // Below a file no folder can be made.
    let output = run_viewer_in(&file.join("folder"), Some(&display.name), &arguments);
    assert!(output.status.success(), "{}", output.status);
    assert!(text(&output.stderr).contains("layout cannot be remembered"), "{}", text(&output.stderr));
}

#[test]
fn the_gallery_opens_without_a_scene() {
    let Some(display) = Display::start_or_skip() else { return };
    let output = run_viewer(Some(&display.name), &["view", "--quit-after-frames", "24"]);
    assert!(output.status.success(), "{}\n{}", output.status, text(&output.stderr));
    assert_eq!(numbers(&text(&output.stdout)).2, 0.0);
}

#[test]
fn without_a_display_the_message_says_what_to_do() {
    let output = run_viewer(None, &["view", "bounce"]);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(
        message.contains("no window can be opened") && message.contains("hammerfall render"),
        "{message}"
    );
    assert!(!message.contains("mistake in hammerfall"), "{message}");
}

#[test]
fn without_a_graphics_driver_the_message_names_the_package() {
    let Some(display) = Display::start_or_skip() else { return };
    let nowhere = PathBuf::from("/nonexistent");
    let output = Command::new(env!("CARGO_BIN_EXE_hammerfall"))
        .args(["view", "bounce", "--quit-after-frames", "3"])
        .env("DISPLAY", &display.name)
        .env("HAMMERFALL_CONFIG", &nowhere)
        .env_remove("WAYLAND_DISPLAY")
        .env("VK_DRIVER_FILES", &nowhere)
        .env("VK_ICD_FILENAMES", &nowhere)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    let message = text(&output.stderr);
    assert!(message.contains("mesa-vulkan-drivers"), "{message}");
}
