//! The Rayleigh phase function: particles much smaller than the wavelength, such as the molecules of air.
//!
//! With `c` the cosine between incoming and outgoing propagation directions, `phase(c) = 3 / (16 pi) (1 + c^2)` [1/sr],
//! for light of no polarisation (Chandrasekhar, Radiative Transfer, 1960, section 1.3). Its mean cosine is 0.

pub mod reference;
mod simd;

pub use simd::RayleighX8;

/// The Rayleigh phase function. It has no parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rayleigh;

#[cfg(test)]
mod tests;
