//! Collisions along a ray through a grid: free flights, and estimates of transmittance.
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
//! The majorants are those of the cell, so that empty and even cells cost a step and no candidate. Each candidate has
//! two numbers of the ray's [stream](crate::random::Stream), in the order in which they are met.

pub mod reference;
pub mod simd;

/// A ray through a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts `[m]`.
    pub origin: [f32; 3],
    /// Where it goes: a unit direction for a flight, the whole segment for a transmittance `[m]`.
    pub direction: [f32; 3],
    /// Where its numbers come from.
    pub stream: crate::random::Stream,
}
