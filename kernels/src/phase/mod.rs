//! The Henyey-Greenstein phase function for every g in (-1, 1).
//!
//! With `h(c) = 1 + g^2 - 2 g c` and `c` the cosine between incoming and outgoing propagation directions,
//! `phase(c) = (1 - g^2) / (4 pi h^{3/2})` [1/sr]; g > 0 scatters forward.

pub mod reference;
mod simd;

pub use simd::{Deflection, HenyeyGreensteinX8, PlaneAngle};

/// Share of the phase function in the forward hemisphere:
/// `(1 - g^2) / (2 g) [1 / (1 - g) - 1 / sqrt(1 + g^2)]`, without its cancellation at g = 0.
pub fn forward_share(g: f64) -> f64 {
    let root = (1.0 + g * g).sqrt();
    (1.0 + g) / (root * (root + 1.0 - g))
}

/// A Henyey-Greenstein phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    /// Mean cosine of a scattering event, in (-1, 1).
    pub g: f32,
}

#[cfg(test)]
mod tests;
