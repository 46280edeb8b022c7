//! Extinction that differs between channels.
//!
//! A path's flights are drawn for one channel, its *hero*, chosen with probabilities q_c. With p_c for the density of
//! free walks in channel c, the prefix of a path up to its vertex x_s was made with density `P_s = sum_c q_c p_c`,
//! whichever channel was its hero, and the balance heuristic over heroes and techniques (Wilkie et al., Hero Wavelength
//! Spectral Sampling, EGSR 2014; Miller, Georgiev, Jarosz, A Null-Scattering Path Integral Formulation of Light
//! Transport, SIGGRAPH 2019) divides by the sum of all their densities. Every path keeps
//!
//! ```text
//! posterior_c(s) = q_c p_c(x_0 .. x_s) / P_s,      T_k(s) = f_k(x_0 .. x_s) / P_s
//! ```
//!
//! A complete path is weighed relative to free walks in one channel of its own, the *reference* `*`: that of the
//! largest `posterior_c(s) p_c(x_s .. x_n)`, in which it is likeliest to have been made, so that no quotient leaves the
//! range of its numbers. With `D_c` for the sum that weighs it where everything is as in channel c,
//!
//! ```text
//! D   = sum_c posterior_c(s) (p_c / p_*)(x_s .. x_n) D_c,      D_c = reach(n) + sum_i reach(i) r_{i,c}
//! C_k = Le_k T_k(s) (f_k / p_*)(x_s .. x_n) / D
//! ```
//!
//! In `D_c`, all but the random walk's own share are quotients over p_c, in which p_c itself cancels:
//!
//! ```text
//! D   = reach(n) W_n + sum_i reach(i) r_{i,*} W_i,      W_i = sum_c posterior_c(s) (p_c / p_*)(x_s .. x_i)
//! ```
//!
//! for techniques that do not ask for the extinction, with the reciprocal of `p_c / p_*` where x_i lies before x_s.
//! Those that do (the number of edges of a bridge, MVNEE's seeds, flights from the light) draw for the hero, and have
//! the mean of their densities over the channels, of which each has its share of `W_i`.
//!
//! Where a medium's extinction in all channels follows one density, quotients of walks need no more than the number of
//! vertices m and the optical depth of the reference:
//!
//! ```text
//! ln (p_c / p_*) = m ln k_c - (k_c - 1) tau_*,      k_c = mu_c / mu_*
//! ```

use wide::{f32x8, u32x8};

use super::MediumLanes;
use crate::transcendental::{exp, neg_ln};

/// Channels of a coloured medium.
pub const CHANNELS: usize = 3;

/// Probability with which a path is drawn for a channel.
pub const SHARE: f32 = 1.0 / CHANNELS as f32;

/// Extinction of all channels, over that of the reference of every row.
#[derive(Clone, Copy)]
pub struct Hues {
    /// k_c.
    ratio: [f32x8; CHANNELS],
    /// ln k_c.
    log_ratio: [f32x8; CHANNELS],
    /// Densities of what a connection has drawn for the hero already, over that of the reference.
    drawn: [f32x8; CHANNELS],
}

impl Hues {
    /// Those of a medium, where row i takes channel `reference[i]` as its own.
    #[inline(always)]
    pub fn new(medium: impl MediumLanes, reference: u32x8) -> Self {
        let extinction = medium.hues();
        let own = f32x8::new(reference.to_array().map(|channel| extinction[channel as usize]));
        let ratio = extinction.map(|channel| f32x8::splat(channel) / own);
        Self { ratio, log_ratio: ratio.map(|ratio| -neg_ln(ratio)), drawn: [f32x8::ONE; CHANNELS] }
    }

    /// `ln (p_c / p_*)` of a walk past `vertices` vertices over the reference's optical `depth`, per channel. Both are
    /// negative for the reciprocal.
    #[inline(always)]
    pub fn log_quotients(&self, vertices: f32x8, depth: f32x8) -> [f32x8; CHANNELS] {
        core::array::from_fn(|c| vertices.mul_add(self.log_ratio[c], (f32x8::ONE - self.ratio[c]) * depth))
    }

    /// [`Self::log_quotients`] as factors.
    #[inline(always)]
    pub fn quotients(&self, vertices: f32x8, depth: f32x8) -> [f32x8; CHANNELS] {
        self.log_quotients(vertices, depth).map(exp)
    }

    /// The same once a flight of the reference's optical `depth` has been drawn for the hero.
    #[inline(always)]
    pub fn after_flight(self, depth: f32x8) -> Self {
        Self { drawn: self.quotients(f32x8::ONE, depth), ..self }
    }

    /// The mean density of all that is drawn for the hero, where channels have these `shares` and, beside what has been
    /// drawn already, these `values`.
    #[inline(always)]
    pub fn mean(&self, shares: [f32x8; CHANNELS], values: [f32x8; CHANNELS]) -> f32x8 {
        let [a, b, c] = core::array::from_fn(|channel| shares[channel] * self.drawn[channel]);
        a.mul_add(values[0], b.mul_add(values[1], c * values[2]))
    }

    /// The reference's optical `depth`, in all channels.
    #[inline(always)]
    pub fn depths(&self, depth: f32x8) -> [f32x8; CHANNELS] {
        self.ratio.map(|ratio| ratio * depth)
    }
}

/// The channel of the largest of `values`, the first of equals.
#[inline(always)]
pub fn largest([first, second, third]: [f32x8; CHANNELS]) -> u32x8 {
    let is_second = second.simd_gt(first);
    let best = is_second.select(second, first);
    let channel: u32x8 = bytemuck::cast::<f32x8, u32x8>(is_second) & u32x8::splat(1);
    let is_third: u32x8 = bytemuck::cast(third.simd_gt(best));
    is_third.select(u32x8::splat(2), channel)
}
