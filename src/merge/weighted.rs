//! Weighted means of images that have no exact sums.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image::Image;
use crate::image::exr::{self, AboutImage};

/// The channel with the number of samples.
const COUNT: &str = "N";
/// Prefix of channels with standard errors.
const ERROR: &str = "SE.";
/// The channel with the mean depth of samples that hit something.
const DEPTH: &str = "depth.Z";
/// The channel with their share of all samples.
const HITS: &str = "depth.A";

/// A weighted mean.
#[derive(Clone, Debug)]
pub struct Weighted {
    /// The mean.
    pub image: Image,
    /// What a person should know: that numbers of samples do not count.
    pub warnings: Vec<String>,
}

/// The mean of the EXR images at `paths`, pixel by pixel, weighted by their numbers of samples where all have such a
/// channel, `N`, and alike otherwise. Channels that not all of them have are left out. One image at a time is in memory.
///
/// # Errors
/// If one cannot be read, its numbers of samples are no such numbers, or they differ in size or have no channel in
/// common.
///
/// # Panics
/// If there are no paths.
pub fn weighted(paths: &[PathBuf]) -> Result<Weighted> {
    let abouts = paths.iter().map(|path| exr::about_image(path)).collect::<Result<Vec<_>>>()?;
    let first = &abouts[0];
    for (path, about) in paths.iter().zip(&abouts).skip(1) {
        check_same(&paths[0], first, path, about)?;
    }
    let is_common = |name: &String| abouts.iter().all(|about| about.names.contains(name));
    let names: Vec<_> = first.names.iter().filter(|name| is_common(name)).cloned().collect();
    if names.is_empty() {
        return Err(Error::failure(paths[0].display(), "has no channel that all images have", "give images alike"));
    }
    let counted = names.iter().any(|name| name == COUNT);
    let mut total = vec![0.0; first.width * first.height];
    let mut total_of_hits = total.clone();
    let mut sums: Vec<_> = names.iter().map(|_| total.clone()).collect();
    for (path, about) in paths.iter().zip(&abouts) {
        let image = exr::read_image(path)?;
        let plane = |name: &str| image.channel(name).filter(|plane| plane.len() == total.len());
        let planes: Option<Vec<_>> = names.iter().map(|name| plane(name)).collect();
        let Some(planes) = planes.filter(|_| image.width == about.width) else {
            let finding = "was replaced by another image while it was merged";
            return Err(Error::failure(path.display(), finding, "merge once nobody writes images any more"));
        };
        let weights = plane(COUNT).filter(|_| counted);
        weights.map_or(Ok(()), |weights| check_counts(path, weights, about.width))?;
        let weight = |place: usize| weights.map_or(1.0, |weights| f64::from(weights[place]));
        // Depth is the mean over samples that hit something.
        let hits = plane(HITS);
        let hit_weight = |place: usize| weight(place) * hits.map_or(1.0, |hits| f64::from(hits[place]));
        for ((name, sums), plane) in names.iter().zip(&mut sums).zip(planes) {
            for (place, (sum, value)) in sums.iter_mut().zip(plane).enumerate() {
                let weight = if name == DEPTH { hit_weight(place) } else { weight(place) };
                *sum += term(name, f64::from(*value), weight);
            }
        }
        total.iter_mut().enumerate().for_each(|(place, total)| *total += weight(place));
        total_of_hits.iter_mut().enumerate().for_each(|(place, total)| *total += hit_weight(place));
    }
    let mean = |name: &str, sums: &[f64]| {
        let total = if name == DEPTH { &total_of_hits } else { &total };
        sums.iter().zip(total).map(|(sum, total)| value(name, *sum, *total)).collect()
    };
    let channels = names.iter().zip(&sums).map(|(name, sums)| (name.clone(), mean(name, sums))).collect();
    let header = vec![(format!("{}merged", exr::PREFIX), format!("weighted mean of {} images", paths.len()))];
    let image = Image { width: first.width, height: first.height, channels, header };
    Ok(Weighted { image, warnings: uncounted(paths, &abouts).into_iter().collect() })
}

/// The warning that some images say how many samples they have and others do not, if so.
fn uncounted(paths: &[PathBuf], abouts: &[AboutImage]) -> Option<String> {
    let has_counts = |about: &AboutImage| about.names.iter().any(|name| name == COUNT);
    let (silent, _) = paths.iter().zip(abouts).find(|(_, about)| !has_counts(about))?;
    let finding = "has no numbers of samples (channel N), but others have: all images count alike";
    abouts.iter().any(has_counts).then(|| format!("{}: {finding}", silent.display()))
}

/// Fails unless all of `counts` are numbers of samples.
fn check_counts(path: &Path, counts: &[f32], width: usize) -> Result<()> {
    let is_wrong = |count: &f32| !count.is_finite() || *count < 0.0;
    let Some(place) = counts.iter().position(is_wrong) else { return Ok(()) };
    let (x, y) = (place % width, place / width);
    let finding = format!("has {} samples in pixel ({x}, {y}), by its channel N", counts[place]);
    let remedy =
        "give images whose channel N is finite and not negative, or remove it from one to have all count alike";
    Err(Error::failure(path.display(), finding, remedy))
}

/// What an image of this weight adds to the sum of the channel called `name`, where its value is `value`.
fn term(name: &str, value: f64, weight: f64) -> f64 {
    match name {
        COUNT => value,
        _ if name.starts_with(ERROR) => (value * weight).powi(2),
        // What has no samples may be anything.
        _ if weight > 0.0 => value * weight,
        _ => 0.0,
    }
}

/// The value of a pixel of the channel called `name`, of its `sum` and the `total` of weights.
fn value(name: &str, sum: f64, total: f64) -> f32 {
    let value = match name {
        COUNT => sum,
        _ if total <= 0.0 => 0.0,
        _ if name.starts_with(ERROR) => sum.sqrt() / total,
        _ => sum / total,
    };
    value as f32
}

fn check_same(first_path: &Path, first: &AboutImage, path: &Path, image: &AboutImage) -> Result<()> {
    let fault = |what: String| {
        let finding = format!("cannot be averaged with {}: {what}", first_path.display());
        Err(Error::failure(path.display(), finding, "give images of the same pixels"))
    };
    if (first.width, first.height) != (image.width, image.height) {
        let [a, b] = [first, image].map(|image| format!("{}x{}", image.width, image.height));
        return fault(format!("it has {b} pixels, not {a}"));
    }
    match (&first.region, &image.region) {
        (Some(a), Some(b)) if a != b => fault(format!("it has the pixels {b} of the image, not {a}")),
        _ => Ok(()),
    }
}
