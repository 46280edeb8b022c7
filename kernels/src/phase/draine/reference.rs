//! Draine in f64: density, and inversion of its distribution by bisection.
//!
//! ```text
//! phase(c) = (1 - g^2) (1 + alpha c^2) / (4 pi n h^{3/2})                               [1/sr]
//! n        = 1 + alpha (1 + 2 g^2) / 3,   h = q^2 = a - 2 g c,   a = 1 + g^2
//! u(c)     = (1 - g^2) / (2 g n) [P(1 + g) - P(q)]
//! P(q)     = -(1 + alpha a^2 / (4 g^2)) / q - alpha a q / (2 g^2) + alpha q^3 / (12 g^2)
//! <c>      = g (1 + alpha (3 + 2 g^2) / 5) / n
//! ```
//!
//! The mean is that of c and c^3 over Henyey-Greenstein, whose Legendre moments are g^l. (Draine 2003; Jendersie and
//! d'Eon, An Approximate Mie Scattering Function for Fog and Cloud Rendering, 2023.)

use core::f64::consts::{PI, TAU};

use super::Draine;
use crate::phase::reference::Phase;

/// Below this |g| the differences of P lose too many digits to the division by g^3, and the distribution is a
/// quadrature of the density, which is smooth.
const NEARLY_ISOTROPIC: f64 = 0.2;

/// Share of events with a cosine below `cosine`.
pub fn share_below(phase: &Draine, cosine: f64) -> f64 {
    let (g, alpha) = (f64::from(phase.g), f64::from(phase.alpha));
    if g.abs() < NEARLY_ISOTROPIC {
        // Gauss' rule of three nodes, on 64 intervals.
        let half = (cosine + 1.0) / 128.0;
        let interval = |i: i32| {
            let at = |node: f64| phase.density(-1.0 + half * (f64::from(2 * i + 1) + node));
            let node = 0.6_f64.sqrt();
            half * (5.0 * at(-node) + 8.0 * at(0.0) + 5.0 * at(node)) / 9.0
        };
        return TAU * (0..64).map(interval).sum::<f64>();
    }
    let (a, g2) = (1.0 + g * g, g * g);
    let primitive =
        |q: f64| -(1.0 + alpha * a * a / (4.0 * g2)) / q - alpha * a * q / (2.0 * g2) + alpha * q.powi(3) / (12.0 * g2);
    let q = (a - 2.0 * g * cosine).sqrt();
    (1.0 - g2) / (2.0 * g * norm(g, alpha)) * (primitive(1.0 + g) - primitive(q))
}

/// What `1 + alpha c^2` is on average over Henyey-Greenstein.
fn norm(g: f64, alpha: f64) -> f64 {
    1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0
}

impl Phase for Draine {
    fn density(&self, cosine: f64) -> f64 {
        let (g, alpha) = (f64::from(self.g), f64::from(self.alpha));
        let h = 1.0 + g * g - 2.0 * g * cosine.clamp(-1.0, 1.0);
        (1.0 - g * g) * (1.0 + alpha * cosine * cosine) / (4.0 * PI * norm(g, alpha) * h * h.sqrt())
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..54 {
            let middle = 0.5 * (low + high);
            if share_below(self, middle) < u { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    fn forward_share(&self) -> f64 {
        1.0 - share_below(self, 0.0)
    }

    fn mean_cosine(&self) -> f64 {
        let (g, alpha) = (f64::from(self.g), f64::from(self.alpha));
        g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / norm(g, alpha)
    }
}
