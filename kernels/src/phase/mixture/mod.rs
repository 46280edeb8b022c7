//! Two phase functions, each with its share of the events.
//!
//! `phase(c) = w first(c) + (1 - w) second(c)` [1/sr], `c` the cosine between incoming and outgoing propagation
//! directions.

pub mod reference;
mod simd;

pub use simd::MixtureX8;

use super::{HenyeyGreenstein, HenyeyGreensteinX8};

/// A mixture of two phase functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixture<A, B> {
    /// Share of the first, in [0, 1].
    pub weight: f32,
    /// Scatters that share of the events.
    pub first: A,
    /// Scatters the rest.
    pub second: B,
}

/// Two Henyey-Greenstein lobes for eight lanes.
pub type TwoLobeX8 = MixtureX8<HenyeyGreensteinX8, HenyeyGreensteinX8>;

impl TwoLobeX8 {
    /// Prepares `phase` for eight lanes.
    pub fn of(phase: &Mixture<HenyeyGreenstein, HenyeyGreenstein>) -> Self {
        Self::new(phase, HenyeyGreensteinX8::new(phase.first), HenyeyGreensteinX8::new(phase.second))
    }
}

#[cfg(test)]
mod tests;
