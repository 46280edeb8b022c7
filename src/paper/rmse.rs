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
    /// Mean squared error, that of the reference subtracted; below 0 if there is less than noise can tell, and not a
    /// number if the reference does not know its own.
    pub squared: f64,
    /// The same of green alone.
    pub green: f64,
    /// Mean squared error of the reference.
    pub reference: f64,
}

impl Rmse {
    /// That of an image of these means against `reference`, pixel by pixel.
    pub fn of(image: impl IntoIterator<Item = [f64; 3]>, reference: &[Pixel]) -> Self {
        let (mut squares, mut green, mut count) = (0.0, 0.0, 0.0);
        for (x, r) in image.into_iter().zip(reference) {
            for (channel, x) in x.into_iter().enumerate() {
                let squared = (x - r.mean[channel]).powi(2) - error(r, channel).powi(2);
                squares += squared;
                green += if channel == 1 { 3.0 * squared } else { 0.0 };
                count += 1.0;
            }
        }
        let known = |squared: f64| if squared.is_finite() { squared } else { f64::NAN };
        let [squared, green] = [squares, green].map(|sum| known(sum / f64::max(count, 1.0)));
        Self { squared, green, reference: own(reference.iter().copied()) }
    }

    /// Its root; 0 where there is nothing but noise.
    pub fn root(&self) -> f64 {
        positive(self.squared).sqrt()
    }
}

/// `squared` if it is above 0, and 0 below; not a number if it is none.
pub fn positive(squared: f64) -> f64 {
    if squared < 0.0 { 0.0 } else { squared }
}

/// The standard error of a channel; infinite where one sample tells nothing of it.
fn error(pixel: &Pixel, channel: usize) -> f64 {
    if pixel.samples < 2 { f64::INFINITY } else { pixel.standard_error[channel] }
}

/// Mean squared error of an image by its own standard errors; infinite if it does not know them.
pub fn own(image: impl IntoIterator<Item = Pixel>) -> f64 {
    let squares = |pixel: Pixel| (0..3).map(|channel| error(&pixel, channel).powi(2)).sum::<f64>() / 3.0;
    let (sum, count) = image.into_iter().fold((0.0, 0.0), |(sum, count), pixel| (sum + squares(pixel), count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Means as f64.
pub fn wide(means: &[[f32; 3]]) -> impl Iterator<Item = [f64; 3]> + '_ {
    means.iter().map(|mean| mean.map(f64::from))
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

    fn image(number: u32, error: f64) -> Vec<Pixel> {
        let at = move |pixel: u32, channel: u32| f64::from(pixel % 10) + error * normal(number, 3 * pixel + channel);
        let pixel = |pixel: u32| Pixel {
            mean: [0, 1, 2].map(|channel| at(pixel, channel)),
            standard_error: [error; 3],
            samples: 4,
        };
        (0..20_000).map(pixel).collect()
    }

    fn means(image: Vec<Pixel>) -> impl Iterator<Item = [f64; 3]> {
        image.into_iter().map(|pixel| pixel.mean)
    }

    /// The standard error of a mean of n squares of normal deviates of variance v is v sqrt(2 / n).
    #[test]
    fn noise_of_the_reference_does_not_count() {
        for reference in [0.0, 0.1, 0.5, 2.0] {
            let found = Rmse::of(means(image(1, 0.5)), &image(2, reference));
            let error = (0.25 + reference * reference) * (2.0_f64 / 60_000.0).sqrt();
            let case = format!("{found:?} against a reference with error {reference}");
            assert!((found.squared - 0.25).abs() < 4.0 * error, "{case}");
            assert!((own(image(1, 0.5)) - 0.25).abs() < 1e-9 && (found.reference - reference.powi(2)).abs() < 1e-9);
        }
        let same = Rmse::of(means(image(3, 0.0)), &image(4, 1.0));
        assert!(same.squared.abs() < 4.0 * (2.0_f64 / 60_000.0).sqrt() && same.root() < 0.2, "{same:?}");
    }

    #[test]
    fn a_reference_of_one_sample_tells_nothing() {
        let once = || image(2, 0.0).into_iter().map(|pixel| Pixel { samples: 1, ..pixel }).collect::<Vec<_>>();
        let found = Rmse::of(means(image(1, 0.5)), &once());
        assert!(found.squared.is_nan() && found.green.is_nan() && found.root().is_nan(), "{found:?}");
        assert!(own(once()).is_infinite());
    }
}
