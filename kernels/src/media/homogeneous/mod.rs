//! The same extinction everywhere.
//!
//! ```text
//! tau = mu_t L,      flight = -ln(1 - u) / mu_t,      (tau / L)^N / mu_t^(N - 1) = mu_t
//! ```
//!
//! Nothing has to be kept along a path but its length.

mod simd;

pub use simd::{ColouredLanes, GreyLanes, HomogeneousX8};

/// A homogeneous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// Extinction mu_t = mu_s + mu_a per channel [1/m], >= 0; 0 in all of them is vacuum, and if it is 0 in none or in
    /// all, any two may differ.
    pub(super) extinction: [f32; 3],
    /// One over it `[m]`, infinite in vacuum.
    mean_free_path: [f32; 3],
}

/// Least extinction of a channel, as a share of that of the densest one. A channel that is clearer is given this much,
/// so that quotients of channels are finite: over ten mean free paths of the densest channel it loses 10^-5.
pub const CLEAREST: f32 = 1e-6;

impl Homogeneous {
    /// The same `extinction` [1/m], >= 0, in all channels.
    pub const fn grey(extinction: f32) -> Self {
        let mean_free_path = (1.0 / extinction as f64) as f32;
        Self { extinction: [extinction; 3], mean_free_path: [mean_free_path; 3] }
    }

    /// Extinction per channel [1/m], each >= 0; not less than [`CLEAREST`] times the largest.
    pub fn coloured(extinction: [f32; 3]) -> Self {
        let least = CLEAREST * extinction.into_iter().fold(0.0, f32::max);
        let extinction = extinction.map(|channel| channel.max(least));
        Self { extinction, mean_free_path: extinction.map(|channel| (1.0 / f64::from(channel)) as f32) }
    }

    /// One over the extinction of a channel `[m]`, infinite in vacuum.
    #[inline(always)]
    pub fn mean_free_path(&self, channel: usize) -> f32 {
        self.mean_free_path[channel]
    }

    /// Extinction of a channel [1/m].
    #[inline(always)]
    pub fn extinction(&self, channel: usize) -> f32 {
        self.extinction[channel]
    }

    /// Whether it is the same in all channels.
    pub fn is_grey(&self) -> bool {
        self.extinction == [self.extinction[0]; 3]
    }
}

#[cfg(test)]
mod tests;
