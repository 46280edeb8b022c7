//! The exact sums of a film in its EXR file.
//!
//! Every channel of a layer has its sums in u32 channels: `exact.R.sum0` to `sum2` are the limbs of the sum of its
//! samples, the least significant first, `exact.R.squares0` to `squares3` those of the sum of their squares, both in
//! units of the layer. The header entry `fogbow.sums` says which layers there are and in which units, and has a
//! checksum of all other entries and all sums; `fogbow.coverage` says which samples they are of.

use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{AnyChannels, FlatSamples};
use serde::{Deserialize, Serialize};

use super::{PREFIX, entries, fault, planes, read_layer};
use crate::error::{Error, Result};
use crate::film::{Coverage, Exact, ExactSquares, ExactSum, Film, Layer, LayerForm, Region, tile_size};

/// Version of the layout of sums.
const LAYOUT: u32 = 1;

/// The header entry about the sums.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sums {
    layout: u32,
    layers: Vec<LayerForm>,
    checksum: String,
}

/// The name of that entry, with its prefix.
pub fn name() -> String {
    format!("{PREFIX}sums")
}

/// Its text, for a `film` with these `header` entries, names without prefix.
pub fn entry(film: &Film, header: &[(String, String)]) -> String {
    let layers = film.layers().iter().map(LayerForm::of).collect();
    let sums = Sums { layout: LAYOUT, layers, checksum: checksum(film, header) };
    serde_json::to_string(&sums).expect("numbers and names")
}

/// A checksum of `header` entries, names without prefix, and of all sums of `film`.
fn checksum(film: &Film, header: &[(String, String)]) -> String {
    let mut header: Vec<_> = header.iter().collect();
    header.sort();
    let mut hasher = blake3::Hasher::new();
    for text in header.into_iter().flat_map(|(name, text)| [name, text]) {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    let (region, mut bytes) = (film.region(), Vec::new());
    for (layer, settings) in film.layers().iter().enumerate() {
        for y in region.rows() {
            bytes.clear();
            for (x, channel) in region.columns().flat_map(|x| (0..settings.channels).map(move |channel| (x, channel))) {
                let Exact { sum, squares } = film.exact(layer, channel, x, y);
                bytes.extend(sum.limbs().map(u32::to_le_bytes).as_flattened());
                bytes.extend(squares.limbs().map(u32::to_le_bytes).as_flattened());
            }
            hasher.update(&bytes);
        }
    }
    hasher.finalize().to_hex().to_string()
}

/// What an EXR file says of the sums in it.
#[derive(Clone, Debug)]
pub struct About {
    /// Our header entries, names without prefix, but for the one about the sums.
    pub header: Vec<(String, String)>,
    /// Width and height of the whole image.
    pub size: [u32; 2],
    /// The pixels that are in the file.
    pub region: Region,
    /// What it keeps of every pixel.
    pub layers: Vec<Layer>,
    /// The samples.
    pub coverage: Coverage,
    checksum: String,
}

impl About {
    /// The header entry called `name`.
    pub fn entry(&self, name: &str) -> Option<&str> {
        self.header.iter().find(|(entry, _)| entry == name).map(|(_, text)| text.as_str())
    }
}

/// The error that there are no sums in the file at `path`, or none that can be used.
fn useless(path: &Path, finding: impl core::fmt::Display) -> Error {
    let remedy = "render it again, or merge by weighted mean with --weighted";
    Error::failure(path.display(), finding, remedy)
}

/// The error that the image at `path` was denoised: what that left has no samples.
fn denoised(path: &Path) -> Error {
    let noisy = crate::denoise::noisy(path).map_or_else(String::new, |path| format!(", {}", path.display()));
    let remedy = format!("give the noisy one{noisy}; merge --denoise denoises what is merged");
    Error::failure(path.display(), "is a denoised image, which has no samples to merge", remedy)
}

/// What the file at `path` says of its sums.
///
/// # Errors
/// If it cannot be read, or has no exact sums.
pub fn about(path: &Path) -> Result<About> {
    super::check_size(path)?;
    let meta = MetaData::read_from_file(path, false).map_err(|error| fault(path, error))?;
    let useless = |finding: &str| useless(path, finding);
    let damaged = || useless("is damaged: its header contradicts itself");
    let first = meta.headers.first().ok_or_else(damaged)?;
    let mut header: Vec<_> = entries(&first.own_attributes)
        .into_iter()
        .filter_map(|(name, text)| Some((name.strip_prefix(PREFIX)?.to_string(), text)))
        .collect();
    let Some(place) = header.iter().position(|(name, _)| *name == name_without_prefix()) else {
        if header.iter().any(|(name, _)| name == "denoised") {
            return Err(denoised(path));
        }
        return Err(useless("has no exact sums: another program wrote it, or an earlier version of fogbow"));
    };
    let (_, text) = header.remove(place);
    let sums: Sums = serde_json::from_str(&text).map_err(|_| useless("has exact sums in a layout that is unknown"))?;
    if sums.layout != LAYOUT {
        return Err(useless("has exact sums in the layout of another version of fogbow"));
    }
    let layers = LayerForm::layers(&sums.layers);
    let layers = layers.ok_or_else(|| useless("has exact sums of layers that are unknown"))?;
    let window = first.shared_attributes.display_window.size;
    let position = first.own_attributes.layer_position;
    let corner = [position.x(), position.y()].map(|x| u32::try_from(x).ok());
    let [Some(x0), Some(y0)] = corner else { return Err(damaged()) };
    let [width, height, x, y] = [window.width(), window.height(), first.layer_size.width(), first.layer_size.height()]
        .map(|length| u32::try_from(length).unwrap_or(u32::MAX));
    let region = Region { x0, y0, x1: x0.saturating_add(x), y1: y0.saturating_add(y) };
    if region.x1 > width || region.y1 > height {
        return Err(damaged());
    }
    let size = [width, height];
    let coverage = Coverage::default();
    let mut about = About { header, size, region, layers, coverage, checksum: sums.checksum };
    about.coverage = about.entry("coverage").and_then(|text| text.parse().ok()).ok_or_else(damaged)?;
    let inside = |coverage: &Coverage| coverage.hull().is_none_or(|hull| hull.region.hull(region) == region);
    if inside(&about.coverage) { Ok(about) } else { Err(damaged()) }
}

fn name_without_prefix() -> &'static str {
    "sums"
}

/// The film at `path`, about which the file says `about`.
///
/// # Errors
/// If the file cannot be read, or its sums, its pixels and its header do not belong together.
pub fn read_film(path: &Path, about: &About) -> Result<Film> {
    let region = about.region;
    let layer = read_layer(path)?;
    let film = Film::try_new(&about.layers, region, tile_size(region)).map_err(|error| {
        Error::failure(path.display(), format!("is too large for memory: {error}"), "merge smaller crops")
    })?;
    let AnyChannels { list } = layer.channel_data;
    let plane = |name: &str| {
        let channel = list.iter().find(|channel| channel.name == *name);
        let samples = channel.map(|channel| &channel.sample_data);
        let count = region.pixels() as usize;
        samples.filter(|samples| samples.len() == count).ok_or_else(|| useless(path, format!("has no channel {name}")))
    };
    for (index, layer) in about.layers.iter().enumerate() {
        for (channel, name) in layer.planes.iter().enumerate().take(layer.channels) {
            let names = planes::limb_names(name, layer.squares);
            let limbs = names.iter().map(|name| match plane(name)? {
                FlatSamples::U32(values) => Ok(values.as_slice()),
                _ => Err(useless(path, format!("has a channel {name} of another type"))),
            });
            add(&film, index, channel, &limbs.collect::<Result<Vec<_>>>()?);
        }
    }
    about.coverage.parts().iter().for_each(|part| film.count(part.region, part.samples.len() as u32));
    if checksum(&film, &about.header) != about.checksum {
        return Err(useless(
            path,
            "is damaged, or another program changed it: its exact sums or its header are not whole",
        ));
    }
    for (index, layer) in about.layers.iter().enumerate() {
        for (channel, name) in layer.planes.iter().enumerate() {
            let FlatSamples::F32(values) = plane(name)? else { return Err(useless(path, "has no f32 pixels")) };
            if !shows(&film, index, channel, values) {
                return Err(useless(
                    path,
                    "was changed by another program: its pixels are not those of its exact sums",
                ));
            }
        }
    }
    Ok(film)
}

/// Whether the images at `paths` have the same exact sums of the same samples of the same pixels; none if one of them
/// has no sums, or none that can be used.
pub fn are_same(paths: [&Path; 2]) -> Option<bool> {
    let [Ok(a), Ok(b)] = paths.map(about) else { return None };
    if (a.size, a.region, &a.layers, &a.coverage) != (b.size, b.region, &b.layers, &b.coverage) {
        return Some(false);
    }
    let [a, b] = [read_film(paths[0], &a).ok()?, read_film(paths[1], &b).ok()?];
    Some(a.is_same(&b))
}

/// Adds the sums whose limbs are `planes` to a channel of a layer.
fn add(film: &Film, layer: usize, channel: usize, planes: &[&[u32]]) {
    let region = film.region();
    for (y, x) in region.rows().flat_map(|y| region.columns().map(move |x| (y, x))) {
        let place = region.place(x, y);
        let limb = |index: usize| planes.get(index).map_or(0, |plane| plane[place]);
        let sum = ExactSum::from_limbs(core::array::from_fn(limb));
        let squares = ExactSquares::from_limbs(core::array::from_fn(|index| limb(ExactSum::LIMBS + index)));
        film.add_exact(layer, channel, x, y, &Exact { sum, squares });
    }
}

/// Whether `values` are the means of a channel of a layer.
fn shows(film: &Film, layer: usize, channel: usize, values: &[f32]) -> bool {
    let region = film.region();
    let mut pixels = region.rows().flat_map(|y| region.columns().map(move |x| (x, y)));
    pixels.all(|(x, y)| {
        let mean = film.estimate(layer, channel, x, y).mean as f32;
        mean.to_bits() == values[region.place(x, y)].to_bits()
    })
}
