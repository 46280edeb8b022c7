//! How noisy an image is, as one number that a few pixels cannot decide.
//!
//! A pixel's noise is its standard error over its mean, both as lengths of RGB vectors; what is much darker than the
//! image counts as a tenth of the median pixel. That is never more than about one, however bright a lamp is that a
//! pixel sees a part of. The noise of the image is the root of the mean of their squares, without the noisiest
//! hundredth of the pixels. Black pixels do not count: whether they are dark or just have not met light yet, nobody can
//! tell.

use super::Pixel;

/// Divisor of the number of pixels: the noisiest of them do not count.
pub const NOISIEST: usize = 100;
/// From how many pixels on at least one of them does not count.
const MANY: usize = 10;
/// Share of the median that dark pixels count as.
pub const DARK: f64 = 0.1;

/// The length of an RGB vector, by which pixels are compared.
pub fn length(rgb: [f64; 3]) -> f64 {
    rgb.into_iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What darker pixels count as in an image whose pixels that are not black have these `means`; 0 if there are none.
pub fn dark(mut means: Vec<f64>) -> f64 {
    let middle = means.len() / 2;
    if means.is_empty() { 0.0 } else { DARK * *means.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The noise of an image; infinite if no pixel has an error yet, as with one sample each, or all are black.
pub fn relative(pixels: impl Iterator<Item = Pixel>) -> f64 {
    let (mut means, mut errors) = (Vec::new(), Vec::new());
    for pixel in pixels.filter(|pixel| pixel.samples > 1 && pixel.mean != [0.0; 3]) {
        means.push(length(pixel.mean));
        errors.push(length(pixel.standard_error));
    }
    if means.is_empty() {
        return f64::INFINITY;
    }
    let floor = dark(means.clone());
    let mut noises: Vec<f64> = means.iter().zip(errors).map(|(mean, error)| error / mean.max(floor)).collect();
    let left_out = (noises.len() / NOISIEST).max(usize::from(noises.len() >= MANY));
    let kept = noises.len() - left_out;
    if left_out > 0 {
        noises.select_nth_unstable_by(kept, f64::total_cmp);
    }
    (noises[..kept].iter().map(|noise| noise * noise).sum::<f64>() / kept as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(mean: f64, error: f64) -> Pixel {
        Pixel { mean: [mean; 3], standard_error: [error; 3], samples: 16 }
    }

    #[test]
    fn it_is_the_error_over_the_mean_where_all_pixels_are_alike() {
        for mean in [1e-20, 1.0, 1e20] {
            assert!((relative([pixel(mean, 0.03 * mean); 64].into_iter()) - 0.03).abs() < 1e-12);
        }
    }

    #[test]
    fn a_pixel_that_sees_a_lamp_does_not_hold_it_up() {
        let fog = [pixel(1.0, 0.02); 63];
        for (mean, error) in [(500.0, 500.0), (1e9, 1e9), (1e-9, 1e9)] {
            let noise = relative(fog.into_iter().chain([pixel(mean, error)]));
            assert!((noise - 0.02).abs() < 1e-12, "{noise} with a pixel of {mean} +- {error}");
        }
        // Nor do the many pixels of its rim in an image of many more.
        let rim = core::iter::repeat_n(pixel(500.0, 300.0), 60);
        assert!((relative(core::iter::repeat_n(pixel(1.0, 0.02), 5940).chain(rim)) - 0.02).abs() < 1e-12);
    }

    #[test]
    fn noise_all_over_counts() {
        let pixels = (0..1000).map(|i| pixel(1.0, if i % 10 == 0 { 0.5 } else { 0.01 }));
        let expected = (0.01_f64 * 0.01 * 0.909 + 0.25 * 0.091).sqrt();
        assert!((relative(pixels) - expected).abs() < 2e-3);
    }

    #[test]
    fn dark_pixels_count_as_a_tenth_of_the_median() {
        let pixels = core::iter::repeat_n(pixel(1.0, 0.0), 50).chain(core::iter::repeat_n(pixel(1e-6, 1e-3), 50));
        // Half of a hundred at 1 %, less one.
        assert!((relative(pixels) - (0.01_f64.powi(2) * 49.0 / 99.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn black_pixels_do_not_count() {
        let rare = core::iter::repeat_n(pixel(0.0, 0.0), 990).chain(core::iter::repeat_n(pixel(5.0, 4.0), 10));
        assert!((relative(rare) - 0.8).abs() < 1e-12, "few paths have found the light: that is noise");
    }

    #[test]
    fn single_samples_and_black_images_have_no_noise_to_tell() {
        assert!(relative([Pixel { samples: 1, ..pixel(1.0, 0.0) }; 4].into_iter()).is_infinite());
        assert!(relative([pixel(0.0, 0.0); 4].into_iter()).is_infinite());
    }
}
