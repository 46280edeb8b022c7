//! What twins ask of a medium, in one channel, in f64.

use glam::DVec3;

use super::field::reference::FieldTwin;
use crate::phase::HenyeyGreenstein;
use crate::phase::reference::Phase;

/// A medium in one channel.
pub trait Medium {
    /// Mean free path along the segment between two points `[m]`: that of the optical depth, infinite in vacuum.
    fn mean_free_path(&self, from: DVec3, to: DVec3) -> f64;

    /// Optical depth of the segment between two points, as weights count it.
    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64;

    /// Extinction of the channel over that of the clearest one, in which limits on optical depths count.
    fn over_clearest(&self) -> f64 {
        1.0
    }

    /// Extinction at a point [1/m].
    fn extinction(&self, at: DVec3) -> f64;

    /// Where a scattering event sends light.
    fn phase(&self) -> &dyn Phase;
}

/// The same extinction everywhere.
#[derive(Clone, Copy)]
pub struct Homogeneous<'a> {
    /// mu_t [1/m], >= 0.
    pub extinction: f64,
    /// Where a scattering event sends light.
    pub phase: &'a dyn Phase,
}

impl<'a> Homogeneous<'a> {
    /// A medium of this `extinction` [1/m], >= 0, that scatters light by `phase`.
    pub const fn new(extinction: f64, phase: &'a dyn Phase) -> Self {
        Self { extinction, phase }
    }

    /// A medium of this `extinction` [1/m], >= 0, that scatters light into all directions alike.
    pub const fn isotropic(extinction: f64) -> Self {
        Self { extinction, phase: &HenyeyGreenstein { g: 0.0 } }
    }
}

impl Homogeneous<'_> {
    /// The distance that a share `u` of all flights does not reach `[m]`; endless in vacuum: `-ln(1 - u) / mu_t`
    pub fn flight(&self, u: f64) -> f64 {
        flight(u, 1.0 / self.extinction)
    }
}

/// The distance that a share `u` of all flights of this mean free path does not reach `[m]`.
pub fn flight(u: f64, mean_free_path: f64) -> f64 {
    -(1.0 - u).ln() * mean_free_path
}

impl Medium for Homogeneous<'_> {
    fn mean_free_path(&self, _: DVec3, _: DVec3) -> f64 {
        1.0 / self.extinction
    }

    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64 {
        self.extinction * from.distance(to)
    }

    fn extinction(&self, _: DVec3) -> f64 {
        self.extinction
    }

    fn phase(&self) -> &dyn Phase {
        self.phase
    }
}

/// A medium of any kind.
#[derive(Clone, Copy)]
pub enum Twin<'a> {
    /// The same extinction everywhere.
    Homogeneous(Homogeneous<'a>),
    /// Extinction that differs from place to place.
    Field(FieldTwin<'a>),
}

impl Twin<'_> {
    fn kind(&self) -> &dyn Medium {
        match self {
            Self::Homogeneous(medium) => medium,
            Self::Field(medium) => medium,
        }
    }
}

impl Medium for Twin<'_> {
    fn mean_free_path(&self, from: DVec3, to: DVec3) -> f64 {
        self.kind().mean_free_path(from, to)
    }

    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64 {
        self.kind().optical_depth(from, to)
    }

    fn over_clearest(&self) -> f64 {
        self.kind().over_clearest()
    }

    fn extinction(&self, at: DVec3) -> f64 {
        self.kind().extinction(at)
    }

    fn phase(&self) -> &dyn Phase {
        self.kind().phase()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_u_of_the_flights_is_shorter_than_the_flight_of_u() {
        for extinction in [0.01, 1.0, 40.0] {
            let medium = Homogeneous::isotropic(extinction);
            for u in [1e-7, 0.3, 0.999] {
                let share = -(-medium.optical_depth(DVec3::ZERO, medium.flight(u) * DVec3::Y)).exp_m1();
                assert!((share - u).abs() < 1e-12 * (1.0 + u), "{share} at {u}");
            }
        }
        assert_eq!(Homogeneous::isotropic(0.0).flight(0.5), f64::INFINITY);
    }
}
