//! How far two images differ, and whether noise explains it.
//!
//! Errors of pixels are estimates themselves. Where a few bright samples hold much of the light, most pixels have not
//! found one yet: they are too dark and call themselves too sure, so that two honest images differ by chi-square. Sums
//! over blocks of pixels have found some, and know their errors: chi-square over blocks is the better judge there.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::error::{Error, Result};
use crate::image::Image;

/// Channels that are compared.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// The comparison of one channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelComparison {
    /// Its name.
    pub channel: String,
    /// Pixels that are finite in both images and have errors, where there are errors at all.
    pub pixels: usize,
    /// Mean of the first image.
    pub mean_a: f64,
    /// Mean of the second image.
    pub mean_b: f64,
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Mean squared difference over the square of the second image, plus 1 % of its mean against division by zero.
    pub relative_mse: f64,
    /// Differences in units of noise; absent without errors.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseComparison>,
}

/// Differences of a channel in units of the errors that the images carry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseComparison {
    /// Difference of the means over its standard error.
    pub mean_difference_in_standard_errors: f64,
    /// Pixels whose errors are above zero: chi-square's degrees of freedom.
    pub noisy_pixels: usize,
    /// Sum of the squared differences of the noisy pixels over their variances.
    pub chi_square: f64,
    /// Probability of so large a chi-square, or a larger one, from noise alone.
    pub p_value: f64,
    /// Blocks of [`BLOCK`] x [`BLOCK`] pixels with noisy ones among them.
    pub noisy_blocks: usize,
    /// Sum of the squared differences of their sums over the variances of these.
    pub chi_square_of_blocks: f64,
    /// Probability of so large a chi-square of blocks, or a larger one, from noise alone.
    pub p_value_of_blocks: f64,
}

impl NoiseComparison {
    /// Of differences by their variances, pixel by pixel, and of their sums over blocks.
    fn new(pixels: &[(f64, f64)], blocks: &[(f64, f64)]) -> Self {
        let sum = |part: fn(&(f64, f64)) -> f64| pixels.iter().map(part).sum::<f64>();
        let standard_error = sum(|pixel| pixel.1).sqrt();
        let (noisy_pixels, chi_square, p_value) = by_chi_square(pixels);
        let (noisy_blocks, chi_square_of_blocks, p_value_of_blocks) = by_chi_square(blocks);
        Self {
            mean_difference_in_standard_errors: sum(|pixel| pixel.0) / standard_error.max(f64::MIN_POSITIVE),
            noisy_pixels,
            chi_square,
            p_value,
            noisy_blocks,
            chi_square_of_blocks,
            p_value_of_blocks,
        }
    }
}

/// Edge of the blocks over which differences are added up, in pixels.
pub const BLOCK: usize = 16;

/// Degrees of freedom, chi-square and its probability, of differences and their variances. Without noise there is
/// nothing to measure a difference in.
fn by_chi_square(differences: &[(f64, f64)]) -> (usize, f64, f64) {
    let noisy = || differences.iter().filter(|(_, variance)| *variance > 0.0);
    let (freedom, sum) = (noisy().count(), noisy().map(|(difference, variance)| difference.powi(2) / variance).sum());
    (freedom, sum, ChiSquared::new(freedom.max(1) as f64).map_or(1.0, |distribution| distribution.sf(sum)))
}

/// Differences and variances of `pixels` in an image of this size, added up block by block.
fn sums_over_blocks([width, height]: [usize; 2], pixels: &[usize], differences: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let columns = width.div_ceil(BLOCK);
    let mut blocks = vec![(0.0, 0.0); columns * height.div_ceil(BLOCK)];
    for (i, (difference, variance)) in pixels.iter().zip(differences) {
        let block = &mut blocks[i / width / BLOCK * columns + i % width / BLOCK];
        *block = (block.0 + difference, block.1 + variance);
    }
    blocks
}

/// Standard errors of this size or more mark pixels that are not valid.
const INVALID_ERROR: f32 = 1e8;

/// Standard errors of the pixel means, not a number where they are unknown: marked invalid, or from a single sample.
fn standard_errors(image: &Image, channel: &str) -> Option<Vec<f64>> {
    let errors = image.channel(&format!("SE.{channel}"))?;
    let samples = image.channel("N");
    let known = |i: usize| errors[i] < INVALID_ERROR && samples.is_none_or(|samples| samples[i] >= 2.0);
    Some((0..errors.len()).map(|i| if known(i) { f64::from(errors[i]) } else { f64::NAN }).collect())
}

/// Variance of every difference, from the errors that the images carry; `None` if that says nothing about any pixel.
fn variances(a: &Image, b: &Image, channel: &str) -> Option<Vec<f64>> {
    let errors = [standard_errors(a, channel), standard_errors(b, channel)];
    let variance = |i: usize| errors.iter().flatten().map(|errors| errors[i].powi(2)).sum();
    let variances: Vec<f64> = (0..a.width * a.height).map(variance).collect();
    variances.iter().any(|variance| *variance > 0.0).then_some(variances)
}

/// Compares R, G and B.
///
/// # Errors
/// If the images differ in size or lack a channel.
pub fn compare(a: &Image, b: &Image) -> Result<Vec<ChannelComparison>> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(Error::failure(
            "compare",
            format!("the images have different sizes, {}x{} and {}x{}", a.width, a.height, b.width, b.height),
            "compare images of the same size; render one again with the other's --size and --crop",
        ));
    }
    CHANNELS.iter().map(|channel| compare_channel(a, b, channel)).collect()
}

/// A channel of the first and of the second image.
fn planes<'a>(a: &'a Image, b: &'a Image, channel: &str) -> Result<[&'a [f32]; 2]> {
    let plane = |image: &'a Image, which: &str| {
        image.channel(channel).ok_or_else(|| {
            let names: Vec<_> = image.channels.iter().map(|(name, _)| name.as_str()).collect();
            let finding = format!("the {which} image has no channel {channel}, only {}", names.join(", "));
            Error::failure("compare", finding, "compare images with channels R, G and B")
        })
    };
    Ok([plane(a, "first")?, plane(b, "second")?])
}

fn compare_channel(a: &Image, b: &Image, channel: &str) -> Result<ChannelComparison> {
    let [plane_a, plane_b] = planes(a, b, channel)?;
    let variances = variances(a, b, channel);
    let valid = |i: &usize| {
        let known = variances.as_ref().is_none_or(|variances| variances[*i].is_finite());
        known && plane_a[*i].is_finite() && plane_b[*i].is_finite()
    };
    let pixels: Vec<usize> = (0..plane_a.len()).filter(valid).collect();
    let count = pixels.len().max(1) as f64;
    let sum = |value: &dyn Fn(usize) -> f64| pixels.iter().map(|i| value(*i)).sum::<f64>();
    let (value_a, value_b) = (|i: usize| f64::from(plane_a[i]), |i: usize| f64::from(plane_b[i]));
    let (mean_a, mean_b) = (sum(&value_a) / count, sum(&value_b) / count);
    let square = |i: usize| (value_a(i) - value_b(i)).powi(2);
    let floor = (0.01 * mean_b).powi(2).max(f64::MIN_POSITIVE);
    let noise = variances.as_ref().map(|variances| {
        let differences: Vec<_> = pixels.iter().map(|i| (value_a(*i) - value_b(*i), variances[*i])).collect();
        let blocks = sums_over_blocks([a.width, a.height], &pixels, &differences);
        NoiseComparison::new(&differences, &blocks)
    });
    Ok(ChannelComparison {
        channel: channel.into(),
        pixels: pixels.len(),
        mean_a,
        mean_b,
        rmse: (sum(&square) / count).sqrt(),
        relative_mse: sum(&|i| square(i) / (value_b(i).powi(2) + floor)) / count,
        noise,
    })
}

/// The difference of two images as RGB bytes: grey where equal, red where the first is brighter, blue where it is
/// darker. Full colour is `scale`: three standard errors where there are errors, the largest difference elsewhere.
pub fn difference_picture(a: &Image, b: &Image) -> Result<(Vec<u8>, String)> {
    let mut differences = vec![0.0; a.width * a.height];
    let mut in_errors = true;
    for channel in CHANNELS {
        let [plane_a, plane_b] = planes(a, b, channel)?;
        let variances = variances(a, b, channel);
        in_errors &= variances.is_some();
        for (i, difference) in differences.iter_mut().enumerate() {
            let deviation = variances.as_ref().map_or(1.0, |variances| variances[i].sqrt());
            let z = f64::from(plane_a[i] - plane_b[i]) / if deviation > 0.0 { deviation } else { 1.0 };
            *difference += if z.is_finite() { z / 3.0 } else { 0.0 };
        }
    }
    let largest = differences.iter().fold(0.0, |largest: f64, difference| largest.max(difference.abs()));
    let (scale, meaning) =
        if in_errors { (3.0, "3 standard errors".into()) } else { (largest, format!("a difference of {largest:.4e}")) };
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let colour = |difference: f64| {
        let t = (difference / scale).clamp(-1.0, 1.0);
        let (away, towards) = ((235.0 * (1.0 - t.abs())) as u8, 235 + (20.0 * t.abs()) as u8);
        if t > 0.0 { [towards, away, away] } else { [away, away, towards] }
    };
    Ok((differences.into_iter().flat_map(colour).collect(), meaning))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: &[f32], error: Option<f32>) -> Image {
        let planes = CHANNELS.map(|name| (name.to_string(), values.to_vec()));
        let errors = CHANNELS.map(|name| error.map(|error| (format!("SE.{name}"), vec![error; values.len()])));
        let channels = planes.into_iter().chain(errors.into_iter().flatten()).collect();
        Image { width: values.len(), height: 1, channels, header: vec![] }
    }

    #[test]
    fn differences_are_measured_in_the_errors_of_both_images() {
        let a = image(&[1.0, 2.0, 3.0, 4.0], Some(0.3));
        let b = image(&[1.5, 1.5, 3.5, 4.5], Some(0.4));
        let red = &compare(&a, &b).expect("same size")[0];
        assert_eq!((red.pixels, red.mean_a, red.mean_b, red.rmse), (4, 2.5, 2.75, 0.5));
        let noise = red.noise.as_ref().expect("has errors");
        assert!((noise.mean_difference_in_standard_errors + 1.0).abs() < 1e-6);
        assert!((noise.chi_square - 4.0).abs() < 1e-5 && (noise.p_value - 0.406).abs() < 1e-3);
        assert!((noise.chi_square_of_blocks - 1.0).abs() < 1e-5 && (noise.p_value_of_blocks - 0.317).abs() < 1e-3);
        assert_eq!((noise.noisy_pixels, noise.noisy_blocks), (4, 1));
    }

    /// Pixels that are 1 on average, half of it by samples that come once in sixteen pixels: the others, which have
    /// seen nothing of them, are all alike.
    #[test]
    fn blocks_know_the_errors_of_rare_light() {
        let rare = |first: u32| {
            let samples = (0..4 * BLOCK * BLOCK).map(|i| {
                let word = (i as u32 + first).wrapping_mul(0x9e37_79b9);
                let is_rare = (word ^ word >> 15).wrapping_mul(0x85eb_ca6b) >> 28 == 0;
                if is_rare { (8.5, 8.0) } else { (0.5 + 0.02 * (i as f32 + first as f32).sin(), 0.02) }
            });
            let (values, errors): (Vec<f32>, Vec<f32>) = samples.unzip();
            let mut image = image(&values, Some(0.0));
            (image.width, image.height) = (2 * BLOCK, 2 * BLOCK);
            image
                .channels
                .iter_mut()
                .filter(|(name, _)| name.starts_with("SE"))
                .for_each(|(_, all)| all.clone_from(&errors));
            image
        };
        let red = compare(&rare(0), &rare(1 << 20)).expect("same size").swap_remove(0);
        let noise = red.noise.expect("has errors");
        assert_eq!((noise.noisy_pixels, noise.noisy_blocks), (4 * BLOCK * BLOCK, 4));
        assert!(noise.p_value_of_blocks > 0.01, "{noise:?}");
        // The same, half as bright again: more than noise.
        let mut bright = rare(1 << 20);
        bright.channels.iter_mut().filter(|(name, _)| name == "R").for_each(|(_, all)| {
            all.iter_mut().for_each(|value| *value *= 1.5);
        });
        let red = compare(&rare(0), &bright).expect("same size").swap_remove(0);
        assert!(red.noise.expect("has errors").p_value_of_blocks < 1e-4);
    }

    #[test]
    fn without_errors_there_is_no_verdict() {
        let a = image(&[1.0, f32::NAN], None);
        let red = &compare(&a, &a).expect("same size")[0];
        assert_eq!((red.pixels, red.rmse, &red.noise), (1, 0.0, &None));
    }

    #[test]
    fn a_single_sample_gives_no_error_and_no_verdict() {
        let mut a = image(&[1.0, 2.0], Some(0.0));
        let b = image(&[1.5, 2.0], Some(0.1));
        a.channels.push(("N".into(), vec![1.0; 2]));
        let red = &compare(&a, &b).expect("same size")[0];
        assert_eq!((red.pixels, &red.noise), (2, &None));
    }

    #[test]
    fn pixels_marked_invalid_do_not_count() {
        let mut a = image(&[1.0, 2.0], Some(0.1));
        let b = image(&[1.0, 9.0], Some(0.1));
        a.channels.iter_mut().filter(|(name, _)| name.starts_with("SE")).for_each(|(_, errors)| errors[1] = 1e9);
        assert_eq!(compare(&a, &b).expect("same size")[1].pixels, 1);
    }

    #[test]
    fn images_of_different_sizes_are_refused() {
        assert!(compare(&image(&[1.0], None), &image(&[1.0, 2.0], None)).is_err());
    }
}
