//! Droplets of fog and cloud: a fit to Mie scattering by water, averaged over the visible spectrum.
//!
//! A mixture of a narrow Henyey-Greenstein peak and of a Draine phase function, both functions of the diameter of the
//! droplets alone, d in um:
//!
//! ```text
//! phase   = (1 - w_D) HG(g_HG) + w_D Draine(g_D, alpha)               [1/sr]
//! g_HG    = exp(-0.0990567 / (d - 1.67154))
//! g_D     = exp(-2.20679 / (d + 3.91029) - 0.428934)
//! alpha   = exp(3.62489 - 8.29288 / (d + 5.52825))
//! w_D     = exp(-0.599085 / (d - 0.641583) - 0.665888)
//! ```
//!
//! (Jendersie and d'Eon, An Approximate Mie Scattering Function for Fog and Cloud Rendering, SIGGRAPH Talks 2023.)
//! Kernel and twin are those of the [`Mixture`].

use core::ops::RangeInclusive;

use super::{Draine, DraineX8, HenyeyGreenstein, HenyeyGreensteinX8, Mixture, MixtureX8};

/// Diameters for which the fit was made `[um]`.
pub const DIAMETERS: RangeInclusive<f32> = 5.0..=50.0;

/// The phase function of droplets.
pub type Droplets = Mixture<HenyeyGreenstein, Draine>;

/// [`Droplets`] for eight lanes.
pub type DropletsX8 = MixtureX8<HenyeyGreensteinX8, DraineX8>;

impl Droplets {
    /// The phase function of droplets of this `diameter`, in [`DIAMETERS`] `[um]`.
    pub fn of_diameter(diameter: f32) -> Self {
        debug_assert!(DIAMETERS.contains(&diameter), "a diameter of {diameter} um is out of range");
        let d = f64::from(diameter);
        let peak = (-0.0990567 / (d - 1.67154)).exp();
        let g = (-2.20679 / (d + 3.91029) - 0.428934).exp();
        let alpha = (3.62489 - 8.29288 / (d + 5.52825)).exp();
        let draine = (-0.599085 / (d - 0.641583) - 0.665888).exp();
        Self {
            weight: (1.0 - draine) as f32,
            first: HenyeyGreenstein { g: peak as f32 },
            second: Draine { g: g as f32, alpha: alpha as f32 },
        }
    }
}

impl DropletsX8 {
    /// Prepares `phase` for eight lanes.
    pub fn of(phase: &Droplets) -> Self {
        Self::new(phase, HenyeyGreensteinX8::new(phase.first), DraineX8::new(phase.second))
    }
}

#[cfg(test)]
mod tests;
