//! Pictures as PNG files.

use super::{ExportError, write_whole};
use crate::render::Picture;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};
use std::path::Path;

/// Writes a picture as PNG. The file appears whole or not at all: what was there before is
/// replaced only when everything is written.
///
/// # Errors
/// [`ExportError`], in words for the user.
pub fn write_png(path: &Path, picture: &Picture) -> Result<(), ExportError> {
    write_whole(path, &encode(path, picture)?)
}

fn encode(path: &Path, picture: &Picture) -> Result<Vec<u8>, ExportError> {
    let failed = |reason: String| ExportError::Encode { path: path.to_owned(), reason };
    let pixels = picture.width as usize * picture.height as usize;
    if pixels == 0 || picture.rgba.len() != 4 * pixels {
        return Err(failed(format!(
            "{} bytes are no picture of {}x{} pixels",
            picture.rgba.len(),
            picture.width,
            picture.height
        )));
    }
    let rgb: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(&rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}
