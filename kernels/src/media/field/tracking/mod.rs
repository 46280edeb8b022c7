//! Collisions along a ray through a field: free flights, and estimates of transmittance.
//!
//! Both walk from cell to cell and draw *candidates* with a rate that is constant in each: a budget of -ln(1 - u) mean
//! free paths is spent on the cells' majorants, and where it is used up there is a candidate.
//!
//! ```text
//! free flights:    rate mu_max >= mu;     a candidate at x is a collision if u mu_max < mu(x)       (Woodcock 1965)
//! transmittance:   rate mu_r >= |mu - mu_c| about the cell's mean mu_c;
//!                  T' = e^{-int mu_c} prod (1 - (mu(x) - mu_c) / mu_r)           (Novak, Selle, Jarosz 2014)
//! ```
//!
//! The majorants are those of the cell, so that empty and even cells cost a step and no candidate. Where extinction is
//! coloured, flights are those of one channel, and one set of points serves all transmittances, since rates are those of
//! the largest extinction: `T'_c = e^{-k_c int mu_c} prod (1 - k_c (mu(x) - mu_c) / mu_r)`. Each candidate has
//! two numbers of the ray's [stream](crate::random::Stream), in the order in which they are met.

mod quest;
pub mod reference;
pub mod simd;

use crate::media::spectral::CHANNELS;

/// A ray through a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts `[m]`.
    pub origin: [f32; 3],
    /// Where it goes: a unit direction for a flight, the whole segment for a transmittance `[m]`.
    pub direction: [f32; 3],
    /// Where its numbers come from.
    pub stream: crate::random::Stream,
    /// Extinctions that count, over those of the field: that of a flight, or those of up to three transmittances, from -1
    /// to 1.
    pub hues: [f32; CHANNELS],
}
