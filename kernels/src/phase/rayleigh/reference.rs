//! Rayleigh in f64: density, and inversion of its distribution by Cardano's formula.
//!
//! ```text
//! phase(c) = 3 / (16 pi) (1 + c^2)                                    [1/sr]
//! u(c)     = 1/2 + (3 c + c^3) / 8
//! c(u)     = a - 1 / a,   a^3 = b + sqrt(b^2 + 1),   b = 4 u - 2      the real root of c^3 + 3 c - 2 b = 0
//! ```
//!
//! (Frisvad, Importance sampling the Rayleigh phase function, JOSA A 2011.)

use core::f64::consts::PI;

use super::Rayleigh;
use crate::phase::reference::Phase;

impl Phase for Rayleigh {
    fn density(&self, cosine: f64) -> f64 {
        3.0 / (16.0 * PI) * (1.0 + cosine * cosine)
    }

    /// With |b|, whose sum with the root does not cancel; the function is odd.
    fn sample_cosine(&self, u: f64) -> f64 {
        let b = 4.0 * u - 2.0;
        let a = (b.abs() + (b * b + 1.0).sqrt()).cbrt();
        (a - 1.0 / a).clamp(0.0, 1.0).copysign(b)
    }

    fn forward_share(&self) -> f64 {
        0.5
    }

    fn mean_cosine(&self) -> f64 {
        0.0
    }
}
