//! Weighted means of images that have no exact sums.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image::{Image, exr};

/// The channel with the number of samples.
const COUNT: &str = "N";
/// Prefix of channels with standard errors.
const ERROR: &str = "SE.";

/// The mean of the EXR images at `paths`, pixel by pixel, weighted by their numbers of samples where all have such a
/// channel, `N`, and alike otherwise. Channels that not all of them have are left out.
///
/// # Errors
/// If one cannot be read, or they differ in size or have no channel in common.
///
/// # Panics
/// If there are no paths.
pub fn weighted(paths: &[PathBuf]) -> Result<Image> {
    let first = exr::read_image(&paths[0])?;
    let mut others = paths[1..].iter().map(|path| Ok((path, exr::read_image(path)?))).collect::<Result<Vec<_>>>()?;
    for (path, image) in &others {
        check_same(&paths[0], &first, path, image)?;
    }
    let mut images = vec![first];
    images.extend(others.drain(..).map(|(_, image)| image));
    let counted = images.iter().all(|image| image.channel(COUNT).is_some());
    let ones = vec![1.0; images[0].width * images[0].height];
    let weights: Vec<_> =
        images.iter().map(|image| image.channel(COUNT).filter(|_| counted).unwrap_or(&ones)).collect();
    let names = images[0].channels.iter().map(|(name, _)| name);
    let common = names.filter(|name| images.iter().all(|image| image.channel(name).is_some()));
    let channels: Vec<_> = common.map(|name| (name.clone(), merge(name, &images, &weights))).collect();
    if channels.is_empty() {
        return Err(Error::failure(paths[0].display(), "has no channel that all images have", "give images alike"));
    }
    let header = vec![(format!("{}merged", exr::PREFIX), format!("weighted mean of {} images", images.len()))];
    Ok(Image { width: images[0].width, height: images[0].height, channels, header })
}

fn check_same(first_path: &Path, first: &Image, path: &Path, image: &Image) -> Result<()> {
    let fault = |what: String| {
        let finding = format!("cannot be averaged with {}: {what}", first_path.display());
        Err(Error::failure(path.display(), finding, "give images of the same pixels"))
    };
    if (first.width, first.height) != (image.width, image.height) {
        let [a, b] = [first, image].map(|image| format!("{}x{}", image.width, image.height));
        return fault(format!("it has {b} pixels, not {a}"));
    }
    let region = |image: &Image| {
        let name = format!("{}region", exr::PREFIX);
        image.header.iter().find(|(entry, _)| *entry == name).map(|(_, text)| text.clone())
    };
    match (region(first), region(image)) {
        (Some(a), Some(b)) if a != b => fault(format!("it has the pixels {b} of the image, not {a}")),
        _ => Ok(()),
    }
}

/// The channel called `name` of all `images` together.
fn merge(name: &str, images: &[Image], weights: &[&[f32]]) -> Vec<f32> {
    let planes: Vec<_> = images.iter().map(|image| image.channel(name).expect("a common channel")).collect();
    let pixel = |place: usize| {
        let values = || planes.iter().zip(weights).map(|(plane, weight)| [plane[place], weight[place]].map(f64::from));
        let total = values().map(|[_, weight]| weight).sum::<f64>();
        let sum = if name == COUNT {
            values().map(|[count, _]| count).sum()
        } else if total <= 0.0 {
            0.0
        } else if name.starts_with(ERROR) {
            values().map(|[error, weight]| (error * weight).powi(2)).sum::<f64>().sqrt() / total
        } else {
            values().filter(|[_, weight]| *weight > 0.0).map(|[value, weight]| value * weight).sum::<f64>() / total
        };
        sum as f32
    };
    (0..planes[0].len()).map(pixel).collect()
}
