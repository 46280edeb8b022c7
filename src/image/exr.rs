//! Scene-linear images: R G B mean radiance, SE.R SE.G SE.B its standard error, N samples.

use std::io::{Seek, Write};
use std::path::Path;

use exr::prelude::{
    AnyChannels, AttributeValue, Encoding, FlatSamples, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
    ReadChannels, ReadLayers, SpecificChannels, Text, Vec2, WritableImage, read,
};

use super::Image;
use crate::error::{Error, Result};
use crate::film::Film;

/// Prefix of our own header entries.
pub const PREFIX: &str = "fogbow.";

/// Writes the film, which may cover part of an image of `size` pixels, with `header` entries (name without prefix, text).
///
/// Pixels are computed as they are written: no copy of the film is made.
///
/// # Errors
/// What the writer says.
pub fn write_film(
    writer: impl Write + Seek,
    film: &Film,
    size: [u32; 2],
    header: &[(String, String)],
) -> core::result::Result<(), String> {
    let region = film.region();
    let channels = SpecificChannels::build()
        .with_channel("R")
        .with_channel("G")
        .with_channel("B")
        .with_channel("SE.R")
        .with_channel("SE.G")
        .with_channel("SE.B")
        .with_channel("N")
        .with_pixel_fn(|at: Vec2<usize>| {
            let pixel = film.pixel(region.x0 + at.x() as u32, region.y0 + at.y() as u32);
            let ([r, g, b], [ser, seg, seb]) = (pixel.mean, pixel.standard_error);
            (r as f32, g as f32, b as f32, ser as f32, seg as f32, seb as f32, pixel.samples as f32)
        });
    let mut attributes =
        LayerAttributes { layer_position: Vec2(region.x0 as i32, region.y0 as i32), ..Default::default() };
    attributes.software_name = Some(Text::from(concat!("fogbow ", env!("CARGO_PKG_VERSION"))));
    let utf8 = |text: &str| Text::from_slice_unchecked(text.as_bytes());
    let entry = |(name, text): &(String, String)| (utf8(&format!("{PREFIX}{name}")), AttributeValue::Text(utf8(text)));
    attributes.other = header.iter().map(entry).collect();
    let extent = Vec2(region.width() as usize, region.height() as usize);
    let layer = Layer::new(extent, attributes, Encoding::SMALL_FAST_LOSSLESS, channels);
    let window = IntegerBounds::new((0, 0), (size[0] as usize, size[1] as usize));
    let image = exr::image::Image::empty(ImageAttributes::new(window)).with_layer(layer);
    image.write().non_parallel().to_buffered(writer).map_err(|error| error.to_string())
}

/// Reads every f32, f16 or u32 plane of the first layer of `path`.
///
/// # Errors
/// If the file cannot be read or is no EXR image.
pub fn read_image(path: &Path) -> Result<Image> {
    let failed = |error: exr::error::Error| match error {
        exr::error::Error::Io(error) => {
            Error::failure(path.display(), format!("cannot be read: {error}"), "check the path and its permissions")
        }
        error => Error::failure(path.display(), format!("is no EXR image: {error}"), "give an EXR image"),
    };
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(failed)?;
    let layer = image.layer_data;
    let text = |value: &AttributeValue| match value {
        AttributeValue::Text(text) => String::from_utf8_lossy(text.as_slice()).into_owned(),
        other => format!("{other:?}"),
    };
    let mut header: Vec<_> =
        layer.attributes.other.iter().map(|(name, value)| (name.to_string(), text(value))).collect();
    header.extend(layer.attributes.software_name.iter().map(|name| ("software".to_string(), name.to_string())));
    header.sort();
    let AnyChannels { list } = layer.channel_data;
    let plane = |samples: FlatSamples| match samples {
        FlatSamples::F32(values) => values,
        FlatSamples::F16(values) => values.into_iter().map(exr::prelude::f16::to_f32).collect(),
        FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
    };
    let channels = list.into_iter().map(|channel| (channel.name.to_string(), plane(channel.sample_data))).collect();
    Ok(Image { width: layer.size.width(), height: layer.size.height(), channels, header })
}
