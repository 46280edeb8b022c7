//! Scene-linear images: R G B mean radiance, SE.R SE.G SE.B its standard error, likewise for other layers of the film,
//! and N samples. Channels `exact.*` and the header entry `fogbow.sums` hold the film's sums bit by bit.

pub mod exact;
mod planes;

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, ReadChannels, ReadLayers, Text, Vec2, WritableImage, read,
};

use super::{Image, LARGEST_IMAGE};
use crate::error::{Error, Result};
use crate::film::{Film, Region};

/// Prefix of our own header entries.
pub const PREFIX: &str = "fogbow.";

/// Writes the film and its exact sums; it may cover part of an image of `size` pixels. `header` are entries (name
/// without prefix, text).
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
    let sums = ("sums".to_string(), exact::entry(film, header));
    let header: Vec<_> = header.iter().cloned().chain([sums]).collect();
    let (region, encoding) = (film.region(), Encoding::SMALL_FAST_LOSSLESS);
    let layer = Layer::new(extent(region), attributes(region, &header), encoding, planes::of(film));
    let image = exr::image::Image::empty(whole(size)).with_layer(layer);
    image.write().non_parallel().to_buffered(writer).map_err(|error| error.to_string())
}

/// Writes the radiance of the pixels of `region`, row by row, of an image of `size` pixels; `header` as in
/// [`write_film`].
///
/// # Errors
/// What the writer says.
pub fn write_pixels(
    writer: impl Write + Seek,
    pixels: &[[f32; 3]],
    region: Region,
    size: [u32; 2],
    header: &[(String, String)],
) -> core::result::Result<(), String> {
    let plane = |channel: usize| FlatSamples::F32(pixels.iter().map(|rgb| rgb[channel]).collect());
    let channels = [("R", 0), ("G", 1), ("B", 2)].map(|(name, channel)| AnyChannel::new(name, plane(channel)));
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let layer = Layer::new(extent(region), attributes(region, header), Encoding::SMALL_FAST_LOSSLESS, channels);
    let image = exr::image::Image::empty(whole(size)).with_layer(layer);
    image.write().non_parallel().to_buffered(writer).map_err(|error| error.to_string())
}

/// What an image says besides its pixels, which cover `region`; `header` are entries (name without prefix, text).
fn attributes(region: Region, header: &[(String, String)]) -> LayerAttributes {
    let utf8 = |text: &str| Text::from_slice_unchecked(text.as_bytes());
    let entry = |(name, text): &(String, String)| (utf8(&format!("{PREFIX}{name}")), AttributeValue::Text(utf8(text)));
    LayerAttributes {
        layer_position: Vec2(region.x0 as i32, region.y0 as i32),
        software_name: Some(Text::from(concat!("fogbow ", env!("CARGO_PKG_VERSION")))),
        other: header.iter().map(entry).collect(),
        ..Default::default()
    }
}

/// Width and height of `region`.
fn extent(region: Region) -> Vec2<usize> {
    Vec2(region.width() as usize, region.height() as usize)
}

/// Where an image of `size` pixels is.
fn whole([width, height]: [u32; 2]) -> ImageAttributes {
    ImageAttributes::new(IntegerBounds::new((0, 0), (width as usize, height as usize)))
}

/// Writes `image`, all planes as f32, with its header entries (name with prefix, text).
///
/// # Errors
/// What the writer says.
pub fn write_image(writer: impl Write + Seek, image: &Image) -> core::result::Result<(), String> {
    let utf8 = |text: &str| Text::from_slice_unchecked(text.as_bytes());
    let entry = |(name, text): &(String, String)| (utf8(name), AttributeValue::Text(utf8(text)));
    let software_name = Some(Text::from(concat!("fogbow ", env!("CARGO_PKG_VERSION"))));
    let other = image.header.iter().map(entry).collect();
    let attributes = LayerAttributes { software_name, other, ..Default::default() };
    let channel =
        |(name, values): &(String, Vec<f32>)| AnyChannel::new(name.as_str(), FlatSamples::F32(values.clone()));
    let channels = AnyChannels::sort(image.channels.iter().map(channel).collect());
    let layer = Layer::new((image.width, image.height), attributes, Encoding::SMALL_FAST_LOSSLESS, channels);
    exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(writer).map_err(|error| error.to_string())
}

/// What every EXR file begins with.
pub const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What is wrong with the file at `path`, in words of someone who did not write the format.
fn fault(path: &Path, error: exr::error::Error) -> Error {
    use exr::error::Error::Io;
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(MAGIC.len() as u64).read_to_end(&mut start));
    let failure = |finding: String, remedy: &str| Error::failure(path.display(), finding, remedy);
    match error {
        Io(error) if error.kind() != ErrorKind::UnexpectedEof => {
            failure(format!("cannot be read: {error}"), "check the path and its permissions")
        }
        _ if read.is_ok() && start.is_empty() => failure("is empty".into(), "give an EXR image"),
        _ if !MAGIC.starts_with(&start) => failure("is not an EXR image".into(), "give an EXR image"),
        error if matches!(error, Io(_)) || error.to_string().contains("missing bytes") => {
            failure("is truncated: the file ends before the image does".into(), "copy or render it again")
        }
        error => failure(format!("is a damaged EXR image: {error}"), "copy or render it again"),
    }
}

/// An error if the image at `path` claims to be larger than any that is read: before memory is taken for it.
fn check_size(path: &Path) -> Result<()> {
    let meta = MetaData::read_from_file(path, false).map_err(|error| fault(path, error))?;
    let area = |header: &Header| header.layer_size.width().saturating_mul(header.layer_size.height());
    let Some(header) = meta.headers.iter().find(|header| area(header) > LARGEST_IMAGE) else { return Ok(()) };
    let size = header.layer_size;
    let finding = format!("has {}x{} pixels, more than the limit of {LARGEST_IMAGE}", size.0, size.1);
    Err(Error::failure(path.display(), finding, "give a smaller image"))
}

/// The first layer of the image at `path`.
fn read_layer(path: &Path) -> Result<Layer<AnyChannels<FlatSamples>>> {
    check_size(path)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| fault(path, error))?;
    Ok(image.layer_data)
}

/// What attributes say, as text.
fn entries(attributes: &LayerAttributes) -> Vec<(String, String)> {
    let text = |value: &AttributeValue| match value {
        AttributeValue::Text(text) => String::from_utf8_lossy(text.as_slice()).into_owned(),
        other => format!("{other:?}"),
    };
    let mut header: Vec<_> = attributes.other.iter().map(|(name, value)| (name.to_string(), text(value))).collect();
    header.extend(attributes.software_name.iter().map(|name| ("software".to_string(), name.to_string())));
    header.sort();
    header
}

/// What an EXR file says of its image.
#[derive(Clone, Debug)]
pub struct AboutImage {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Names of the planes that [`read_image`] reads.
    pub names: Vec<String>,
    /// The pixels of the whole image that are in the file, if it says so.
    pub region: Option<String>,
}

/// What the file at `path` says of the image that [`read_image`] reads.
///
/// # Errors
/// If the file cannot be read, is no EXR image, or has more than 2^27 pixels.
pub fn about_image(path: &Path) -> Result<AboutImage> {
    check_size(path)?;
    let meta = MetaData::read_from_file(path, false).map_err(|error| fault(path, error))?;
    let Some(header) = meta.headers.iter().find(|header| !header.deep) else {
        return Err(Error::failure(path.display(), "has no flat layer", "give another EXR image"));
    };
    let names = header.channels.list.iter().map(|channel| channel.name.to_string());
    let region = format!("{PREFIX}region");
    let region = entries(&header.own_attributes).into_iter().find(|(name, _)| *name == region);
    Ok(AboutImage {
        width: header.layer_size.width(),
        height: header.layer_size.height(),
        names: names.filter(|name| !name.starts_with(planes::EXACT)).collect(),
        region: region.map(|(_, text)| text),
    })
}

/// Reads every f32, f16 or u32 plane of the first layer of `path`, but for those with exact sums.
///
/// # Errors
/// If the file cannot be read, is not a whole EXR image, or has more than 2^27 pixels.
pub fn read_image(path: &Path) -> Result<Image> {
    let layer = read_layer(path)?;
    let mut header = entries(&layer.attributes);
    header.retain(|(name, _)| *name != exact::name());
    let AnyChannels { list } = layer.channel_data;
    let plane = |samples: FlatSamples| match samples {
        FlatSamples::F32(values) => values,
        FlatSamples::F16(values) => values.into_iter().map(exr::prelude::f16::to_f32).collect(),
        FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
    };
    let channels = list.into_iter().map(|channel| (channel.name.to_string(), channel.sample_data));
    let channels = channels.filter(|(name, _)| !name.starts_with(planes::EXACT));
    let channels = channels.map(|(name, samples)| (name, plane(samples))).collect();
    Ok(Image { width: layer.size.width(), height: layer.size.height(), channels, header })
}
