//! The medium that fills space.

use crate::phase::PhaseFunction;

/// A homogeneous medium of grey extinction.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Extinction coefficient mu_t = mu_s + mu_a [1/m], >= 0; 0 is vacuum.
    pub extinction: f32,
    /// Single-scattering albedo mu_s / mu_t per channel, in [0, 1]; 0 in vacuum.
    pub albedo: [f32; 3],
    /// Where a scattering event sends light.
    pub phase: PhaseFunction,
}

impl Medium {
    /// Whether no path has more than its camera segment: light is never scattered.
    pub fn never_scatters(&self) -> bool {
        self.extinction == 0.0 || self.albedo == [0.0; 3]
    }
}
