//! The Henyey-Greenstein phase function for every g in (-1, 1).
//!
//! With `h(c) = 1 + g^2 - 2 g c` and `c` the cosine between incoming and outgoing propagation directions,
//! `phase(c) = (1 - g^2) / (4 pi h^{3/2})` [1/sr]; g > 0 scatters forward, and g = 0 in all directions alike.

pub mod reference;
mod simd;

pub use simd::{HenyeyGreensteinX8, Lobe, roll_by};

/// A Henyey-Greenstein phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    /// Mean cosine of a scattering event, in (-1, 1).
    pub g: f32,
}

#[cfg(test)]
mod tests;
