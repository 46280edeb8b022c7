//! Pictures as data within the page.
//!
//! Radiances are stored as mantissas of 8 bits per channel and an exponent per pixel (Ward, Real Pixels, 1991) in PNG
//! images of twice the height: mantissas above, exponents below. Browsers can read these exactly, and expose them. A
//! mantissa is off by at most 1/256 of its pixel's brightest channel.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::error::{Error, Result};
use crate::image::{self, Image};

/// Exponent that stands for 2 to the power 0.
const BIAS: i32 = 128;

/// A picture for the page.
pub struct Embedded {
    /// Its data URI.
    pub uri: String,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels, without that of the exponents.
    pub height: usize,
}

/// The EXR image at `path`.
///
/// # Errors
/// If it cannot be read, or lacks a channel.
pub fn radiances(path: &Path) -> Result<Embedded> {
    let image = image::exr::read_image(path)?;
    let Some(png) = png(&image) else {
        return Err(Error::failure(
            path.display(),
            "has no channels R, G and B",
            "remove it, and run the command again",
        ));
    };
    let uri = format!("data:image/png;base64,{}", STANDARD.encode(png));
    Ok(Embedded { uri, width: image.width, height: image.height })
}

/// The PNG or SVG file at `path` as a data URI.
///
/// # Errors
/// If it cannot be read.
pub fn file(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::failure(path.display(), format!("cannot be read: {error}"), "run the command again"))?;
    let kind = if path.extension().is_some_and(|ending| ending == "svg") { "svg+xml" } else { "png" };
    Ok(format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)))
}

fn png(image: &Image) -> Option<Vec<u8>> {
    let [red, green, blue] = ["R", "G", "B"].map(|name| image.channel(name));
    let (red, green, blue) = (red?, green?, blue?);
    let shared: Vec<_> = (0..red.len()).map(|i| share([red[i], green[i], blue[i]])).collect();
    let above = shared.chunks(image.width).map(|row| row.iter().flat_map(|(rgb, _)| *rgb).collect::<Vec<_>>());
    let below = shared.chunks(image.width).map(|row| row.iter().flat_map(|(_, e)| [*e; 3]).collect::<Vec<_>>());
    let rows = above.chain(below).map(Vec::into_iter);
    let mut bytes = Vec::new();
    let size = [image.width as u32, 2 * image.height as u32];
    image::png::write_rows(&mut bytes, size, rows, &[]).ok()?;
    Some(bytes)
}

/// Mantissas and exponent: a channel is `mantissa / 256 * 2^(exponent - 128)`.
fn share(rgb: [f32; 3]) -> ([u8; 3], u8) {
    let rgb = rgb.map(|channel| if channel.is_finite() { channel.max(0.0) } else { 0.0 });
    let largest = rgb.into_iter().fold(0.0, f32::max);
    if largest < 1e-37 {
        return ([0; 3], 0);
    }
    // 2^(exponent - 1) <= largest < 2^exponent, as far as rounding of the mantissa allows.
    let mut exponent = largest.log2().floor() as i32 + 1;
    if (largest * 2.0_f32.powi(-exponent) * 256.0).round() > 255.0 {
        exponent += 1;
    }
    let scale = 256.0 * 2.0_f32.powi(-exponent);
    (rgb.map(|channel| (channel * scale).round() as u8), (exponent + BIAS).clamp(0, 255) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(([r, g, b], exponent): ([u8; 3], u8)) -> [f32; 3] {
        [r, g, b].map(|mantissa| f32::from(mantissa) / 256.0 * 2.0_f32.powi(i32::from(exponent) - BIAS))
    }

    #[test]
    fn radiances_are_stored_to_a_256th_of_the_brightest_channel() {
        for rgb in
            [[1.0, 0.5, 0.25], [0.999, 0.1, 0.0], [3e-9, 1e-9, 0.0], [5e7, 1.0, 0.0], [0.0; 3], [255.5, 256.0, 1.0]]
        {
            let found = read(share(rgb));
            let largest = rgb.into_iter().fold(0.0, f32::max);
            for channel in 0..3 {
                let case = format!("{found:?} of {rgb:?}");
                assert!((found[channel] - rgb[channel]).abs() <= largest / 250.0, "{case}");
            }
        }
        assert_eq!(share([f32::NAN, f32::INFINITY, -1.0]), ([0; 3], 0));
    }

    #[test]
    fn mantissas_are_above_exponents() {
        let plane = |name: &str, values: [f32; 2]| (name.to_string(), values.to_vec());
        let channels = vec![plane("R", [1.0, 0.0]), plane("G", [0.5, 0.0]), plane("B", [0.0, 4.0])];
        let bytes = png(&Image { width: 2, height: 1, channels, header: vec![] }).expect("a picture");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        assert_eq!((reader.info().width, reader.info().height), (2, 2));
        let mut pixels = vec![0; reader.output_buffer_size().expect("a small picture")];
        reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!(pixels, [128, 64, 0, 0, 0, 128, 129, 129, 129, 131, 131, 131]);
    }
}
