//! Henyey-Greenstein in f64: density, inversion of its distribution, and its share of the forward hemisphere.
//!
//! ```text
//! h(c) = 1 + g^2 - 2 g c
//! phase(c) = (1 - g^2) / (4 pi h^{3/2})                               [1/sr]
//! c(u) = (1 + g^2 - ((1 - g^2) / (1 - g + 2 g u))^2) / (2 g),         c(0) = -1, c(1) = 1
//! F = (1 - g^2) / (2 g) [1 / (1 - g) - 1 / sqrt(1 + g^2)]
//! 2 pi p(psi) = sqrt(h_- h_+) / h                                     the roll of bridges about an axis
//! ```
//!
//! (Henyey and Greenstein, Diffuse Radiation in the Galaxy, 1941.)

use core::f64::consts::PI;

use super::HenyeyGreenstein;
use crate::phase::reference::Phase;

/// Below this |g| the division by g is carried out by hand.
const NEARLY_ISOTROPIC: f64 = 1e-3;

/// The phase function's value, which is also its density: per solid angle, at a turn by `cosine` [1/sr].
pub fn density(g: f64, cosine: f64) -> f64 {
    let h = 1.0 + g * g - 2.0 * g * cosine.clamp(-1.0, 1.0);
    (1.0 - g * g) / (4.0 * PI * h * h.sqrt())
}

/// The cosine below which a share `u` of all events falls.
pub fn sample_cosine(g: f64, u: f64) -> f64 {
    if g.abs() < NEARLY_ISOTROPIC {
        // The formula with numerator and denominator multiplied by (1 + g x)^2, x = 2 u - 1, and g cancelled. At g = 0
        // it reads c = 2 u - 1.
        let x = 2.0 * u - 1.0;
        let numerator = x + 0.5 * g * (x * x + 3.0) + g * g * x + 0.5 * g * g * g * (x * x - 1.0);
        return (numerator / (1.0 + g * x).powi(2)).clamp(-1.0, 1.0);
    }
    let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
    ((1.0 + g * g - root * root) / (2.0 * g)).clamp(-1.0, 1.0)
}

/// Share of the phase function in the forward hemisphere, without its cancellation at g = 0.
pub fn forward_share(g: f64) -> f64 {
    let root = (1.0 + g * g).sqrt();
    (1.0 + g) / (root * (root + 1.0 - g))
}

impl Phase for HenyeyGreenstein {
    fn density(&self, cosine: f64) -> f64 {
        density(f64::from(self.g), cosine)
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        sample_cosine(f64::from(self.g), u)
    }

    fn forward_share(&self) -> f64 {
        forward_share(f64::from(self.g))
    }

    fn mean_cosine(&self) -> f64 {
        f64::from(self.g)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    const ASYMMETRIES: [f64; 11] = [-0.95, -0.6, -1.1e-3, -1e-6, 0.0, 1e-6, 0.9e-3, 0.3, 0.7, 0.9, 0.97];

    /// Share of events with a cosine below `end`: midpoint rule over the angle, in which the peak is less narrow.
    fn share_below(g: f64, end: f64) -> f64 {
        let steps = 20_000;
        let width = (PI - end.acos()) / f64::from(steps);
        let angle = |i: i32| PI - (f64::from(i) + 0.5) * width;
        (0..steps).map(|i| TAU * density(g, angle(i).cos()) * angle(i).sin() * width).sum()
    }

    #[test]
    fn density_integrates_to_one() {
        for g in ASYMMETRIES {
            assert!((share_below(g, 1.0) - 1.0).abs() < 1e-5, "g = {g}: {}", share_below(g, 1.0));
        }
    }

    #[test]
    fn a_share_u_of_the_density_lies_below_the_cosine_of_u() {
        for g in ASYMMETRIES {
            for u in [0.01, 0.2, 0.5, 0.8, 0.99] {
                let share = share_below(g, sample_cosine(g, u));
                assert!((share - u).abs() < 1e-5, "g = {g}, u = {u}: {share}");
            }
            assert!((sample_cosine(g, 0.0) + 1.0).abs() < 1e-12 && (sample_cosine(g, 1.0) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn cosines_do_not_jump_where_the_formula_changes() {
        for sign in [-1.0, 1.0] {
            for u in [0.0, 0.1, 0.5, 0.73, 1.0] {
                let [below, above] = [1.0 - 1e-9, 1.0].map(|f| sample_cosine(sign * f * NEARLY_ISOTROPIC, u));
                assert!((below - above).abs() < 1e-11, "u = {u}: {below} and {above}");
            }
        }
    }
}
