//! Phase functions: where a scattering event sends light.
//!
//! One folder each, with sampler and density side by side, for eight rows and as a twin. A stage matches on the kind once, with
//! [`with_phase!`](crate::with_phase), and runs a kernel that is generic over [`PhaseX8`]. A new phase function is its folder, a
//! row of [`PhaseFunction`] and one of [`with_phase!`](crate::with_phase).

#[cfg(test)]
mod checks;
pub mod draine;
pub mod droplets;
pub mod henyey_greenstein;
mod lanes;
pub mod mixture;
pub mod rayleigh;
pub mod reference;
pub mod tabulated;

pub use draine::{Draine, DraineX8};
pub use droplets::{Droplets, DropletsX8};
pub use henyey_greenstein::{HenyeyGreenstein, HenyeyGreensteinX8};
pub use lanes::{Deflection, PhaseX8, PlaneAngle};
pub use mixture::{Mixture, MixtureX8, TwoLobeX8};
pub use rayleigh::{Rayleigh, RayleighX8};
pub use tabulated::{Tabulated, TabulatedX8};

/// The phase function of a medium.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseFunction {
    /// One lobe, forward or backward.
    HenyeyGreenstein(HenyeyGreenstein),
}

impl PhaseFunction {
    /// A Henyey-Greenstein phase function of mean cosine `g`.
    pub const fn henyey_greenstein(g: f32) -> Self {
        Self::HenyeyGreenstein(HenyeyGreenstein { g })
    }

    /// As the twins ask it.
    pub fn twin(&self) -> &dyn reference::Phase {
        match self {
            Self::HenyeyGreenstein(phase) => phase,
        }
    }

    /// Mean cosine of a scattering event.
    pub fn mean_cosine(&self) -> f64 {
        self.twin().mean_cosine()
    }
}

/// Runs `$body` with `$lanes` as the [`PhaseX8`] of a [`PhaseFunction`]: once per kind in the program, and one of them at a time.
#[macro_export]
macro_rules! with_phase {
    ($phase:expr, |$lanes:ident| $body:expr) => {
        match $phase {
            $crate::phase::PhaseFunction::HenyeyGreenstein(phase) => {
                let $lanes = $crate::phase::HenyeyGreensteinX8::new(*phase);
                $body
            }
        }
    };
}
