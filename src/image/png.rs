//! 8-bit images for the eye.

use std::io::Write;

use super::tone::Exposure;
use crate::film::Film;

/// Writes the film with the curve of [`super::tone`]; the exposure is noted in the file.
///
/// # Errors
/// What the writer says.
pub fn write_film(writer: impl Write, film: &Film, exposure: Exposure) -> core::result::Result<(), String> {
    let region = film.region();
    let rows = region.rows().map(|y| region.columns().flat_map(move |x| exposure.encode(film.pixel(x, y).mean)));
    let note = ("exposure", exposure.to_string());
    write_rows(writer, [region.width(), region.height()], rows, &[note])
}

/// Writes pixels that are indices into a `palette` of red, green and blue.
///
/// # Errors
/// What the writer says.
pub fn write_indexed(
    writer: impl Write,
    size: [u32; 2],
    palette: &[u8],
    indices: &[u8],
) -> core::result::Result<(), String> {
    let failed = |error: png::EncodingError| error.to_string();
    let mut encoder = png::Encoder::new(writer, size[0], size[1]);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_compression(png::Compression::High);
    // Differences of indices mean nothing.
    encoder.set_filter(png::Filter::NoFilter);
    let mut png = encoder.write_header().map_err(failed)?;
    png.write_image_data(indices).map_err(failed)?;
    png.finish().map_err(failed)
}

/// Writes rows of RGB bytes.
///
/// # Errors
/// What the writer says.
pub fn write_rows(
    writer: impl Write,
    size: [u32; 2],
    rows: impl Iterator<Item = impl Iterator<Item = u8>>,
    notes: &[(&str, String)],
) -> core::result::Result<(), String> {
    let failed = |error: png::EncodingError| error.to_string();
    let mut encoder = png::Encoder::new(writer, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (name, text) in notes {
        encoder.add_text_chunk((*name).into(), text.clone()).map_err(failed)?;
    }
    let mut png = encoder.write_header().map_err(failed)?;
    let mut stream = png.stream_writer().map_err(failed)?;
    let mut line = Vec::with_capacity(3 * size[0] as usize);
    for row in rows {
        line.clear();
        line.extend(row);
        stream.write_all(&line).map_err(|error| error.to_string())?;
    }
    stream.finish().map_err(failed)
}
