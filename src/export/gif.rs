//! Animations as GIF files, written picture by picture.
//!
//! After every picture the file on disk is a complete GIF: whatever ends the program, what was
//! written so far can be watched. Until the first picture is there the file has a temporary name; where there is a
//! file already, it keeps that to the end: a full disk costs nobody the old one.

use super::{ExportError, partial_name};
use crate::export::palette::Palette;
use crate::render::Picture;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// The index that means "as before"; palettes leave it free.
const TRANSPARENT: u8 = 255;
/// Last byte of every GIF file.
const TRAILER: u8 = 0x3b;
/// Most pictures a second: players slow down anything faster.
const MAX_FPS: f64 = 50.0;
/// A new palette is learned when the changed pixels of a picture miss the present one by more
/// than this on average (weighted channel steps).
const RELEARN_ABOVE: f32 = 1.0;
/// Channel steps by which a pixel may differ from what is shown and still count as unchanged.
const UNCHANGED_WITHIN: u8 = 1;

/// Writes a GIF that loops for ever.
pub struct GifWriter {
    path: PathBuf,
    /// The temporary name, while the file has it.
    beside: Option<PathBuf>,
    /// Whether there is a file to be replaced at the end.
    replaces: bool,
    /// Whether the disk has refused something.
    is_refused: bool,
    file: File,
    encoder: gif::Encoder<Vec<u8>>,
    /// Length of the file up to the last complete picture, without the end mark.
    complete_bytes: u64,
    size: [usize; 2],
    fps: f64,
    pictures: u64,
    palette: Palette,
    /// Whether `palette` is no longer the one at the head of the file.
    has_own_palette: bool,
    /// Colours as they were when last written, to find what changed.
    shown: Vec<[u8; 3]>,
}

impl GifWriter {
    /// Starts a file. Its palette is learned from `samples`, pictures of about the same colours
    /// as those to come (the first one will do); later pictures bring their own where needed.
    ///
    /// # Errors
    /// [`ExportError`]: where it cannot be written, a side above 65,535 pixels, a rate that is
    /// not above 0 and at most 50 pictures a second.
    pub fn create(
        path: &Path,
        size_px: [u32; 2],
        fps: f64,
        samples: &[&Picture],
    ) -> Result<Self, ExportError> {
        let failed = |reason: String| ExportError::Encode { path: path.to_owned(), reason };
        if !(fps > 0.0 && fps <= MAX_FPS) {
            return Err(failed(format!(
                "{fps} pictures a second; GIF players show more than 0 and at most {MAX_FPS}"
            )));
        }
        let [Ok(width), Ok(height)] = size_px.map(u16::try_from) else {
            return Err(failed("a GIF has at most 65535 pixels on a side".into()));
        };
        let palette = Palette::learn(samples.iter().flat_map(|p| p.colors()));
        let encoder = gif::Encoder::new(Vec::new(), width, height, &palette.bytes())
            .and_then(|mut encoder| {
                encoder.set_repeat(gif::Repeat::Infinite)?;
                Ok(encoder)
            })
            .map_err(|error| failed(error.to_string()))?;
        let replaces = path.is_file();
        // What is there and no plain file (a pipe, a device) cannot be replaced by one.
        let beside = (replaces || !path.exists()).then(|| partial_name(path));
        let file = File::create(beside.as_deref().unwrap_or(path));
        let file = file.map_err(ExportError::io("write", path))?;
        Ok(Self {
            path: path.to_owned(),
            beside,
            replaces,
            is_refused: false,
            file,
            encoder,
            complete_bytes: 0,
            size: size_px.map(|px| px as usize),
            fps,
            pictures: 0,
            palette,
            has_own_palette: false,
            shown: Vec::new(),
        })
    }

    /// Appends a picture and brings it to the disk.
    ///
    /// # Errors
    /// [`ExportError`]: a picture of another size, a full disk; the pictures before stay
    /// readable.
    pub fn push(&mut self, picture: &Picture) -> Result<(), ExportError> {
        let [width, height] = self.size;
        let pixels: Vec<[u8; 3]> = picture.colors().collect();
        if picture.width as usize != width || pixels.len() != width * height {
            return Err(self.failed(format!(
                "a picture of {}x{} pixels does not fit one of {width}x{height}",
                picture.width, picture.height
            )));
        }
        let changed = self.changed_rectangle(&pixels);
        let own_palette = self.relearn(&pixels, &changed);
        let buffer = self.indices(&pixels, &changed);
        let frame = gif::Frame {
            delay: self.next_delay(),
            dispose: gif::DisposalMethod::Keep,
            transparent: Some(TRANSPARENT),
            left: changed.left as u16,
            top: changed.top as u16,
            width: changed.width as u16,
            height: changed.height as u16,
            palette: own_palette.then(|| self.palette.bytes()),
            buffer: Cow::Owned(buffer),
            ..Default::default()
        };
        self.encoder.write_frame(&frame).map_err(|error| self.failed(error.to_string()))?;
        let written = self.flush();
        self.is_refused |= written.is_err();
        self.pictures += u64::from(written.is_ok());
        written.and_then(|()| self.show()).map_err(ExportError::io("write", &self.path))
    }

    /// Gives the file its name as soon as it has a picture and takes the place of nothing.
    fn show(&mut self) -> io::Result<()> {
        match self.beside.take_if(|_| !self.replaces) {
            Some(beside) => std::fs::rename(beside, &self.path),
            None => Ok(()),
        }
    }

    /// Ends the file. Dropping the writer does as well, but tells no errors.
    ///
    /// # Errors
    /// [`ExportError`] when the disk does not take the last bytes.
    pub fn finish(mut self) -> Result<(), ExportError> {
        self.end().map_err(ExportError::io("write", &self.path))
    }

    fn end(&mut self) -> io::Result<()> {
        // Without a picture it is no GIF, and what was there stays.
        if self.pictures == 0 {
            return self.beside.take().map_or(Ok(()), std::fs::remove_file);
        }
        let synced = self.file.sync_all();
        self.is_refused |= synced.is_err();
        synced?;
        match self.beside.take().filter(|_| !self.is_refused) {
            Some(beside) => std::fs::rename(beside, &self.path),
            None => Ok(()),
        }
    }

    fn failed(&self, reason: String) -> ExportError {
        ExportError::Encode { path: self.path.clone(), reason }
    }

    /// Writes what the encoder has made, with the end mark behind it, and steps back in front of
    /// the mark. If the disk takes only a part, the file ends after the picture before.
    fn flush(&mut self) -> io::Result<()> {
        let mut bytes = std::mem::take(self.encoder.get_mut());
        bytes.push(TRAILER);
        let written = self.file.write_all(&bytes);
        if written.is_err() && self.complete_bytes > 0 {
            // What is wrong with the disk has been found; closing the file is all that is left.
            let _ = self.file.set_len(self.complete_bytes);
            let _ = self.file.seek(SeekFrom::Start(self.complete_bytes));
            let _ = self.file.write_all(&[TRAILER]);
        }
        written?;
        self.complete_bytes += bytes.len() as u64 - 1;
        self.file.seek(SeekFrom::Start(self.complete_bytes))?;
        Ok(())
    }

    /// Hundredths of a second until the next picture; rounded so that the errors never add up.
    fn next_delay(&self) -> u16 {
        let until = |picture: u64| (100.0 * picture as f64 / self.fps).round();
        let delay = until(self.pictures + 1) - until(self.pictures);
        delay.min(f64::from(u16::MAX)) as u16
    }

    fn is_unchanged(&self, index: usize, color: [u8; 3]) -> bool {
        self.shown
            .get(index)
            .is_some_and(|shown| (0..3).all(|i| shown[i].abs_diff(color[i]) <= UNCHANGED_WITHIN))
    }

    /// The smallest rectangle with all changed pixels; one pixel when nothing changed, since a
    /// picture must have some.
    fn changed_rectangle(&self, pixels: &[[u8; 3]]) -> Rectangle {
        let [width, height] = self.size;
        let (mut low, mut high) = ([width, height], [0, 0]);
        for (index, color) in pixels.iter().enumerate() {
            if !self.is_unchanged(index, *color) {
                let at = [index % width, index / width];
                low = std::array::from_fn(|i| low[i].min(at[i]));
                high = std::array::from_fn(|i| high[i].max(at[i] + 1));
            }
        }
        if high == [0, 0] {
            (low, high) = ([0, 0], [1, 1]);
        }
        Rectangle { left: low[0], top: low[1], width: high[0] - low[0], height: high[1] - low[1] }
    }

    /// Learns a new palette if the present one does not serve the changed pixels; returns whether
    /// the picture must carry its own.
    fn relearn(&mut self, pixels: &[[u8; 3]], changed: &Rectangle) -> bool {
        let mut needed = Vec::new();
        for index in changed.indices(self.size[0]) {
            if !self.is_unchanged(index, pixels[index]) {
                needed.push(pixels[index]);
            }
        }
        let sum: f32 = needed.iter().map(|color| self.palette.error(*color)).sum();
        if sum > RELEARN_ABOVE * needed.len() as f32 {
            self.palette.relearn(needed.into_iter());
            self.has_own_palette = true;
        }
        self.has_own_palette
    }

    fn indices(&mut self, pixels: &[[u8; 3]], changed: &Rectangle) -> Vec<u8> {
        let width = self.size[0];
        let first = self.shown.is_empty();
        if first {
            self.shown = vec![[0; 3]; pixels.len()];
        }
        let mut indices = Vec::with_capacity(changed.width * changed.height);
        for index in changed.indices(width) {
            let color = pixels[index];
            if !first && self.is_unchanged(index, color) {
                indices.push(TRANSPARENT);
            } else {
                self.shown[index] = color;
                indices.push(self.palette.index(color, [index % width, index / width]));
            }
        }
        indices
    }
}

impl Drop for GifWriter {
    fn drop(&mut self) {
        // Who wants to know of errors calls `finish`.
        let _ = self.end();
    }
}

/// A part of a picture, pixels.
struct Rectangle {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Rectangle {
    /// Indices of its pixels in a picture of the given width, row by row.
    fn indices(&self, picture_width: usize) -> impl Iterator<Item = usize> + use<> {
        let (left, width) = (self.left, self.width);
        let rows = self.top..self.top + self.height;
        rows.flat_map(move |y| (left..left + width).map(move |x| y * picture_width + x))
    }
}
