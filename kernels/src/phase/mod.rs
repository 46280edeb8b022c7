//! Phase functions: where a scattering event sends light.
//!
//! One folder each, with sampler and density side by side, for eight rows and as a twin. A stage matches on the kind
//! once, with [`with_phase!`](crate::with_phase), and runs a kernel that is generic over [`PhaseX8`]. A new phase
//! function is its folder, a row of [`PhaseFunction`] and one of [`with_phase!`](crate::with_phase).

use std::sync::Arc;

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
pub use henyey_greenstein::{HenyeyGreenstein, HenyeyGreensteinX8, Lobe};
pub use lanes::{Deflection, PhaseX8, PlaneAngle, Turns};
pub use mixture::{Mixture, MixtureX8, TwoLobeX8};
pub use rayleigh::{Rayleigh, RayleighX8};
pub use tabulated::{Tabulated, TabulatedX8};

/// The phase function of a medium.
#[derive(Clone, Debug, PartialEq)]
pub enum PhaseFunction {
    /// One lobe, forward or backward.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Particles much smaller than the wavelength.
    Rayleigh(Rayleigh),
    /// One lobe, and more of it forward and backward than sideways.
    Draine(Draine),
    /// A forward lobe and another one.
    TwoLobe(Mixture<HenyeyGreenstein, HenyeyGreenstein>),
    /// Droplets of fog and cloud.
    Droplets(Droplets),
    /// Linear between rows of a table.
    Tabulated(Arc<Tabulated>),
}

impl PhaseFunction {
    /// All directions alike.
    pub const fn isotropic() -> Self {
        Self::henyey_greenstein(0.0)
    }

    /// A Henyey-Greenstein phase function of mean cosine `g`, in (-1, 1).
    pub const fn henyey_greenstein(g: f32) -> Self {
        Self::HenyeyGreenstein(HenyeyGreenstein { g })
    }

    /// Particles much smaller than the wavelength.
    pub const fn rayleigh() -> Self {
        Self::Rayleigh(Rayleigh)
    }

    /// A Draine phase function: `g` in (-1, 1), `alpha` in [0, [`Draine::LARGEST_ALPHA`]].
    pub const fn draine(g: f32, alpha: f32) -> Self {
        Self::Draine(Draine { g, alpha })
    }

    /// A Cornette-Shanks phase function, `g` in (-1, 1): Draine's of alpha = 1.
    pub const fn cornette_shanks(g: f32) -> Self {
        Self::draine(g, 1.0)
    }

    /// Henyey-Greenstein lobes of mean cosines `g`, each in (-1, 1), of which the first has a share of `weight`, in [0,
    /// 1].
    pub const fn two_lobe([first, second]: [f32; 2], weight: f32) -> Self {
        let (first, second) = (HenyeyGreenstein { g: first }, HenyeyGreenstein { g: second });
        Self::TwoLobe(Mixture { weight, first, second })
    }

    /// Droplets of fog and cloud of this `diameter`, in [`droplets::DIAMETERS`] `[um]`.
    pub fn droplets(diameter: f32) -> Self {
        Self::Droplets(Droplets::of_diameter(diameter))
    }

    /// Rows of a cosine, ascending in [-1, 1], and a value in any unit, or what is wrong with them: see
    /// [`Tabulated::new`].
    pub fn tabulated(rows: &[(f64, f64)]) -> Result<Self, String> {
        Ok(Self::Tabulated(Arc::new(Tabulated::new(rows)?)))
    }

    /// Shows what it holds beyond the parameters of a scene to `digest`: the rows of a table.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        if let Self::Tabulated(table) = self {
            table.rows().iter().for_each(|row| digest(bytemuck::cast_slice(&[row.0, row.1])));
        }
    }

    /// As the twins ask it.
    pub fn twin(&self) -> &dyn reference::Phase {
        match self {
            Self::HenyeyGreenstein(phase) => phase,
            Self::Rayleigh(phase) => phase,
            Self::Draine(phase) => phase,
            Self::TwoLobe(phase) => phase,
            Self::Droplets(phase) => phase,
            Self::Tabulated(phase) => &**phase,
        }
    }

    /// Mean cosine of a scattering event.
    pub fn mean_cosine(&self) -> f64 {
        self.twin().mean_cosine()
    }
}

/// Runs `$body` with `$lanes` as the [`PhaseX8`] of a [`PhaseFunction`]: once per kind in the program, and one of them
/// at a time.
#[macro_export]
macro_rules! with_phase {
    ($phase:expr, |$lanes:ident| $body:expr) => {
        match $phase {
            $crate::phase::PhaseFunction::HenyeyGreenstein(phase) => {
                let $lanes = $crate::phase::HenyeyGreensteinX8::new(*phase);
                $body
            }
            $crate::phase::PhaseFunction::Rayleigh(phase) => {
                let $lanes = $crate::phase::RayleighX8::new(*phase);
                $body
            }
            $crate::phase::PhaseFunction::Draine(phase) => {
                let $lanes = $crate::phase::DraineX8::new(*phase);
                $body
            }
            $crate::phase::PhaseFunction::TwoLobe(phase) => {
                let $lanes = $crate::phase::TwoLobeX8::of(phase);
                $body
            }
            $crate::phase::PhaseFunction::Droplets(phase) => {
                let $lanes = $crate::phase::DropletsX8::of(phase);
                $body
            }
            $crate::phase::PhaseFunction::Tabulated(phase) => {
                let $lanes = $crate::phase::TabulatedX8::new(phase);
                $body
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3::Vec3x8;

    #[test]
    fn kernels_of_every_kind_are_those_of_their_twins() {
        let kinds = [
            PhaseFunction::isotropic(),
            PhaseFunction::henyey_greenstein(-0.4),
            PhaseFunction::rayleigh(),
            PhaseFunction::cornette_shanks(0.5),
            PhaseFunction::two_lobe([0.9, -0.3], 0.8),
            PhaseFunction::droplets(20.0),
            PhaseFunction::tabulated(&[(-1.0, 1.0), (0.5, 3.0)]).expect("the table is valid"),
        ];
        for phase in &kinds {
            let [from, to] = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]].map(Vec3x8::splat);
            let inverse = with_phase!(phase, |lanes| lanes.inverse_density(from, to)).to_array()[0];
            let expected = phase.twin().density(0.8).recip();
            assert!((f64::from(inverse) / expected - 1.0).abs() < 1e-5, "{phase:?}: {inverse} for {expected}");
        }
    }
}
