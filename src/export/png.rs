//! Pictures as PNG files.

use super::palette::Palette;
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

/// As [`write_png`], with at most 255 colours that suit the picture: files of panels and plots become a third as large.
///
/// # Errors
/// [`ExportError`], in words for the user.
pub fn write_small_png(path: &Path, picture: &Picture) -> Result<(), ExportError> {
    write_whole(path, &encode_small(path, picture)?)
}

fn encode_small(path: &Path, picture: &Picture) -> Result<Vec<u8>, ExportError> {
    let failed =
        |error: png::EncodingError| ExportError::Encode { path: path.to_owned(), reason: error.to_string() };
    let pixels = rgb_of(path, picture)?;
    let mut palette = Palette::learn(pixels.iter().copied());
    // Not mixed: a still picture shows the pattern.
    let indices: Vec<u8> = pixels.iter().map(|color| palette.nearest(*color)).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    // Neighbouring numbers of colours mean nothing.
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(palette.bytes());
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&indices).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// A picture as the content of a PNG file.
///
/// # Errors
/// [`ExportError`], in words for the user.
pub fn png_bytes(picture: &Picture) -> Result<Vec<u8>, ExportError> {
    encode(Path::new("picture.png"), picture)
}

fn encode(path: &Path, picture: &Picture) -> Result<Vec<u8>, ExportError> {
    let failed = |reason: String| ExportError::Encode { path: path.to_owned(), reason };
    let rgb = rgb_of(path, picture)?;
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(rgb.as_flattened(), picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}

/// Red, green and blue of every pixel.
fn rgb_of(path: &Path, picture: &Picture) -> Result<Vec<[u8; 3]>, ExportError> {
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
    Ok(picture.colors().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colors_are_written_as_they_are_and_many_nearly_so() {
        let (width, height) = (64, 16);
        let many = |at: u32| [(at * 4) as u8, (at / 4) as u8, 99, 255];
        let few = |at: u32| -> [u8; 4] {
            if at.is_multiple_of(7) { [12, 200, 30, 255] } else { [250, 250, 250, 255] }
        };
        for (color, most) in [(&few as &dyn Fn(u32) -> [u8; 4], 0), (&many, 40)] {
            let rgba = (0..width * height).flat_map(color).collect();
            let picture = Picture { width, height, rgba };
            let bytes = encode_small(Path::new("x.png"), &picture).unwrap();
            let read = image::load_from_memory(&bytes).unwrap().to_rgb8();
            assert_eq!((read.width(), read.height()), (width, height));
            let worst = read.pixels().zip(picture.rgba.chunks_exact(4)).map(|(now, then)| {
                now.0.iter().zip(then).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or_default()
            });
            assert!(worst.max().unwrap() <= most);
        }
        assert!(encode_small(Path::new("x.png"), &Picture::default()).is_err());
    }
}
