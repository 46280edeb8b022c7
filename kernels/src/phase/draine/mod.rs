//! The Draine phase function: Henyey-Greenstein times `1 + alpha c^2`.
//!
//! With `h(c) = 1 + g^2 - 2 g c` and `c` the cosine between incoming and outgoing propagation directions,
//! `phase(c) = (1 - g^2) (1 + alpha c^2) / (4 pi n h^{3/2})` [1/sr], `n = 1 + alpha (1 + 2 g^2) / 3` (Draine,
//! Scattering by Interstellar Dust Grains, 2003). With alpha = 0 it is Henyey-Greenstein, with alpha = 1
//! Cornette-Shanks, and with alpha = 1 and g = 0 Rayleigh.

pub mod reference;
mod simd;

pub use simd::DraineX8;

/// A Draine phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draine {
    /// In (-1, 1); the mean cosine if alpha = 0.
    pub g: f32,
    /// Weight of the squared cosine, in [0, [`Self::LARGEST_ALPHA`]].
    pub alpha: f32,
}

impl Draine {
    /// Up to this alpha the kernel inverts the distribution to rounding. A thousand is as good as without end: the
    /// light that scatters by a right angle is then a few thousandths of a mean direction's.
    pub const LARGEST_ALPHA: f32 = 1e3;
}

#[cfg(test)]
mod tests;
