//! PNG and GIF files come back as they were, and faults are told in plain words. No device is
//! needed here.

use hammerfall::export::ExportError;
use hammerfall::export::gif::GifWriter;
use hammerfall::export::png::write_png;
use hammerfall::render::Picture;
use std::fs;
use std::path::Path;

const SIZE: [u32; 2] = [48, 32];

/// A shaded disk that moves to the right over a gradient.
fn picture(step: u32) -> Picture {
    let [width, height] = SIZE;
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let (dx, dy) = (x as f32 - 12.0 - 2.0 * step as f32, y as f32 - 16.0);
        let grey = 180 + (y * 2) as u8;
        if dx * dx + dy * dy < 64.0 {
            [200, (60.0 + 5.0 * dx) as u8, (90.0 - 5.0 * dy) as u8, 255]
        } else {
            [grey, grey, grey, 255]
        }
    };
    Picture { width, height, rgba: (0..width * height).flat_map(pixel).collect() }
}

/// Pictures as a player shows them, their delays, and whether they loop for ever.
fn play(path: &Path) -> (Vec<Picture>, Vec<u16>, bool) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
    let (width, height) = (decoder.width() as u32, decoder.height() as u32);
    let mut canvas = vec![0u8; (width * height * 4) as usize];
    let (mut pictures, mut delays) = (Vec::new(), Vec::new());
    while let Some(part) = decoder.read_next_frame().unwrap() {
        for (i, pixel) in part.buffer.chunks_exact(4).enumerate() {
            let (x, y) = (i % part.width as usize, i / part.width as usize);
            let at = 4 * ((y + part.top as usize) * width as usize + x + part.left as usize);
            if pixel[3] > 0 {
                canvas[at..at + 4].copy_from_slice(pixel);
            }
        }
        pictures.push(Picture { width, height, rgba: canvas.clone() });
        delays.push(part.delay);
    }
    let endless = decoder.repeat() == gif::Repeat::Infinite;
    (pictures, delays, endless)
}

fn mean_difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.rgba.iter().zip(&b.rgba);
    pairs.map(|(a, b)| f32::from(a.abs_diff(*b))).sum::<f32>() / a.rgba.len() as f32
}

#[test]
fn gif_comes_back_with_colors_delays_and_loop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let mut writer = GifWriter::create(&path, SIZE, 30.0, &[&picture(0)]).unwrap();
    for step in 0..9 {
        writer.push(&picture(step)).unwrap();
    }
    writer.finish().unwrap();
    let (pictures, delays, endless) = play(&path);
    assert!(endless);
    assert_eq!(delays, [3, 4, 3, 3, 4, 3, 3, 4, 3], "30 a second on average");
    assert_eq!(pictures.len(), 9);
    for (step, shown) in pictures.iter().enumerate() {
        let difference = mean_difference(shown, &picture(step as u32));
        assert!(difference < 1.5, "picture {step}: {difference}");
    }
}

#[test]
fn gif_learns_colors_that_come_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let grey = Picture { rgba: [120, 120, 120, 255].repeat((SIZE[0] * SIZE[1]) as usize), ..picture(0) };
    let mut writer = GifWriter::create(&path, SIZE, 10.0, &[&grey]).unwrap();
    for next in [&grey, &picture(1), &picture(2)] {
        writer.push(next).unwrap();
    }
    writer.finish().unwrap();
    let (pictures, ..) = play(&path);
    assert!(mean_difference(&pictures[2], &picture(2)) < 1.5);
}

#[test]
fn gif_is_complete_after_every_picture_and_still_ones_cost_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let mut writer = GifWriter::create(&path, SIZE, 25.0, &[&picture(0)]).unwrap();
    let mut sizes = Vec::new();
    for step in [0, 1, 1] {
        writer.push(&picture(step)).unwrap();
        sizes.push(fs::metadata(&path).unwrap().len());
        // The writer is still open, as if the program were stopped here.
        assert_eq!(play(&path).0.len(), sizes.len());
        assert_eq!(fs::read(&path).unwrap().last(), Some(&0x3b));
    }
    drop(writer);
    assert_eq!(play(&path).0.len(), 3);
    assert!(sizes[2] - sizes[1] < 40, "{sizes:?}");
}

#[test]
fn gif_refuses_what_players_cannot_show() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let refused = |size, fps| match GifWriter::create(&path, size, fps, &[]) {
        Ok(_) => panic!("{size:?} at {fps} was taken"),
        Err(error) => error.to_string(),
    };
    assert!(refused(SIZE, 60.0).contains("at most 50"));
    assert!(refused(SIZE, 0.0).contains("more than 0"));
    assert!(refused(SIZE, f64::NAN).contains("more than 0"));
    assert!(refused([70_000, 10], 25.0).contains("65535"));
    assert!(!path.exists());
    let mut writer = GifWriter::create(&path, [10, 10], 25.0, &[]).unwrap();
    let error = writer.push(&picture(0)).unwrap_err().to_string();
    assert!(error.contains("48x32"), "{error}");
}

#[test]
fn png_comes_back_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    for step in [0, 3] {
        write_png(&path, &picture(step)).unwrap();
        let read = image::open(&path).unwrap().to_rgba8();
        assert_eq!(read.into_raw(), picture(step).rgba);
    }
    let files = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 1, "nothing half-written is left");
}

#[test]
fn missing_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no/such/a.png");
    let error = write_png(&path, &picture(0)).unwrap_err();
    assert!(matches!(error, ExportError::NoFolder { .. }), "{error}");
    assert!(error.to_string().contains("no/such"), "{error}");
    let error = match GifWriter::create(&path, SIZE, 25.0, &[]) {
        Ok(_) => panic!("wrote into a missing folder"),
        Err(error) => error,
    };
    assert!(matches!(error, ExportError::NoFolder { .. }), "{error}");
}

#[test]
fn folder_in_the_way_and_wrong_pixels_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let error = write_png(folder.path(), &picture(0)).unwrap_err();
    assert!(error.to_string().contains("is a folder, not a file"), "{error}");
    let short = Picture { rgba: vec![0; 7], ..picture(0) };
    let error = write_png(&folder.path().join("a.png"), &short).unwrap_err();
    assert!(error.to_string().contains("7 bytes"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_told_in_plain_words() {
    // A device that is always full.
    let mut writer = GifWriter::create(Path::new("/dev/full"), SIZE, 25.0, &[]).unwrap();
    let error = writer.push(&picture(0)).unwrap_err().to_string();
    assert!(error.contains("the disk is full"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_costs_nobody_the_old_animation() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let write = |pictures: std::ops::Range<u32>| {
        let mut writer = GifWriter::create(&path, SIZE, 25.0, &[&picture(0)])?;
        pictures.map(picture).try_for_each(|picture| writer.push(&picture))?;
        writer.finish()
    };
    write(0..3).unwrap();
    let old = std::fs::read(&path).unwrap();
    // What is written beside it meanwhile comes to a device that is always full.
    let beside = hammerfall::export::partial_name(&path);
    std::os::unix::fs::symlink("/dev/full", &beside).unwrap();
    assert!(write(0..5).unwrap_err().to_string().contains("the disk is full"));
    assert_eq!(std::fs::read(&path).unwrap(), old);
    let _ = std::fs::remove_file(&beside);
    // Without a picture it stays as well, and a whole new one takes its place.
    write(0..0).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), old);
    write(0..5).unwrap();
    assert_eq!(play(&path).0.len(), 5);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
