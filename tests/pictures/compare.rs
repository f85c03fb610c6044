//! A device to draw with, and the comparison with stored pictures.

use hammerfall::export::png::write_png;
use hammerfall::render::{AdapterChoice, Gpu, OffScreen, Picture};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Set to write the references instead of comparing with them.
const WRITE_VARIABLE: &str = "HAMMERFALL_WRITE_PICTURES";
/// Largest difference of a channel that does not count: rounding differs between drivers.
const TOLERANCE: u8 = 3;
/// Pixels that may differ by more: edges fall on one side or the other. A graphics card drew 12 of the thinnest lines, those of
/// `crosses`, otherwise than the software driver does, and no more than 10 of anything else.
const MAX_OUTLIERS: usize = 16;

/// A device, software before hardware; `None`, said loudly, where there is none and no CI.
pub fn gpu() -> Option<Gpu> {
    let software = AdapterChoice::from_env_or(AdapterChoice::Software);
    let gpu = Gpu::headless_with(&software).or_else(|_| Gpu::headless_with(&AdapterChoice::Fastest));
    match gpu {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("CI").is_some() => panic!("no pictures in CI: {error}"),
        Err(error) => {
            // Not by `eprintln!`, which the test harness keeps to itself unless the test fails.
            let _ = writeln!(std::io::stderr(), "SKIPPED, nothing was drawn: {error}");
            None
        }
    }
}

/// Off-screen drawing on that device.
pub fn screen() -> Option<OffScreen> {
    gpu().map(|gpu| OffScreen::new(&gpu).expect("the pipelines can be built"))
}

/// Compares with the stored picture of that name, or writes it when asked to.
pub fn assert_like_stored(name: &str, picture: &Picture) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/pictures").join(format!("{name}.png"));
    if std::env::var_os(WRITE_VARIABLE).is_some() {
        write_png(&path, picture).expect("the reference can be written");
        return;
    }
    let stored = read(&path);
    if let Err(difference) = compare(picture, &stored) {
        let seen = std::env::temp_dir().join(format!("hammerfall-{name}.png"));
        write_png(&seen, picture).expect("the picture can be written");
        panic!("{name}: {difference}\n  stored: {}\n  seen:   {}", path.display(), seen.display());
    }
}

fn read(path: &Path) -> Picture {
    let image = image::open(path).unwrap_or_else(|error| {
        panic!("no reference {}: {error}; set {WRITE_VARIABLE}=1 to write it", path.display())
    });
    let image = image.to_rgba8();
    Picture { width: image.width(), height: image.height(), rgba: image.into_raw() }
}

fn compare(seen: &Picture, stored: &Picture) -> Result<(), String> {
    if (seen.width, seen.height) != (stored.width, stored.height) {
        return Err("the sizes differ".into());
    }
    let pairs = seen.rgba.chunks_exact(4).zip(stored.rgba.chunks_exact(4));
    let differs = |(a, b): &(&[u8], &[u8])| (0..4).any(|i| a[i].abs_diff(b[i]) > TOLERANCE);
    let outliers = pairs.filter(differs).count();
    if outliers > MAX_OUTLIERS {
        return Err(format!("{outliers} pixels differ"));
    }
    Ok(())
}

fn grey(level: u8) -> Picture {
    Picture { width: 8, height: 8, rgba: vec![level; 8 * 8 * 4] }
}

fn with_outliers(count: usize) -> Picture {
    let mut picture = grey(100);
    for pixel in picture.rgba.chunks_exact_mut(4).take(count) {
        pixel[1] += TOLERANCE + 1;
    }
    picture
}

#[test]
fn comparison_accepts_rounding_and_a_few_edges() {
    assert!(compare(&grey(100 + TOLERANCE), &grey(100)).is_ok());
    assert!(compare(&with_outliers(MAX_OUTLIERS), &grey(100)).is_ok());
}

#[test]
fn comparison_rejects_what_one_could_see() {
    assert!(compare(&grey(100 + TOLERANCE + 1), &grey(100)).is_err());
    assert!(compare(&with_outliers(MAX_OUTLIERS + 1), &grey(100)).is_err());
    let narrow = Picture { width: 4, height: 16, ..grey(100) };
    assert!(compare(&narrow, &grey(100)).is_err());
}
