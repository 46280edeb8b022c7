//! How far an image is from what it converges to.
//!
//! With x an image and r a reference, independent and both of mean m, the mean of (x - r)^2 is the sum of both
//! variances. The reference knows its own, the squares of its standard errors, so that
//!
//! ```text
//! MSE(x) = mean over pixels and channels of (x - r)^2 - SE_r^2
//! ```
//!
//! has the mean of x's squared error, however noisy the reference is.

use crate::film::Pixel;

/// An error, with what it was found from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rmse {
    /// Mean squared error, that of the reference subtracted; below 0 if there is less than noise can tell.
    pub squared: f64,
    /// The same of green alone.
    pub green: f64,
    /// What the image's own standard errors say it is.
    pub predicted: f64,
    /// Mean squared error of the reference.
    pub reference: f64,
}

impl Rmse {
    /// That of `image` against `reference`, pixel by pixel.
    pub fn of(image: impl Iterator<Item = Pixel>, reference: impl Iterator<Item = Pixel>) -> Self {
        let (mut sums, mut green, mut count) = ([0.0; 3], 0.0, 0.0);
        for (x, r) in image.zip(reference) {
            for channel in 0..3 {
                let own = r.standard_error[channel].powi(2);
                let squared = (x.mean[channel] - r.mean[channel]).powi(2) - own;
                sums[0] += squared;
                green += if channel == 1 { 3.0 * squared } else { 0.0 };
                sums[1] += x.standard_error[channel].powi(2);
                sums[2] += own;
                count += 1.0;
            }
        }
        let [squared, predicted, reference] = sums.map(|sum: f64| sum / f64::max(count, 1.0));
        Self { squared, green: green / f64::max(count, 1.0), predicted, reference }
    }

    /// Its root; 0 where there is nothing but noise.
    pub fn root(&self) -> f64 {
        self.squared.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fogbow_kernels::random;

    /// A normal deviate by number.
    fn normal(image: u32, pixel: u32) -> f64 {
        let [u, v, ..] = random::words(pixel, image, 0, 7).map(random::uniform);
        (-2.0 * u.ln()).sqrt() * (core::f64::consts::TAU * v).cos()
    }

    fn image(number: u32, error: f64) -> impl Iterator<Item = Pixel> {
        let at = move |pixel: u32, channel: u32| f64::from(pixel % 10) + error * normal(number, 3 * pixel + channel);
        (0..20_000).map(move |pixel| Pixel {
            mean: [0, 1, 2].map(|channel| at(pixel, channel)),
            standard_error: [error; 3],
            samples: 4,
        })
    }

    /// The standard error of a mean of n squares of normal deviates of variance v is v sqrt(2 / n).
    #[test]
    fn noise_of_the_reference_does_not_count() {
        for reference in [0.0, 0.1, 0.5, 2.0] {
            let found = Rmse::of(image(1, 0.5), image(2, reference));
            let error = (0.25 + reference * reference) * (2.0_f64 / 60_000.0).sqrt();
            let case = format!("{found:?} against a reference with error {reference}");
            assert!((found.squared - 0.25).abs() < 4.0 * error, "{case}");
            assert!((found.predicted - 0.25).abs() < 1e-9 && (found.reference - reference.powi(2)).abs() < 1e-9);
        }
        let same = Rmse::of(image(3, 0.0), image(4, 1.0));
        assert!(same.squared.abs() < 4.0 * (2.0_f64 / 60_000.0).sqrt() && same.root() < 0.2, "{same:?}");
    }
}
