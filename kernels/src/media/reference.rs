//! What twins ask of a medium, in one channel, in f64.

use glam::DVec3;

use crate::phase::HenyeyGreenstein;
use crate::phase::reference::Phase;

/// A medium in one channel.
pub trait Medium {
    /// The distance that a share `u` of all flights does not reach `[m]`; endless in vacuum.
    fn flight(&self, u: f64) -> f64;

    /// Optical depth of the segment between two points.
    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64;

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

impl Medium for Homogeneous<'_> {
    /// `-ln(1 - u) / mu_t`
    fn flight(&self, u: f64) -> f64 {
        if self.extinction == 0.0 {
            return f64::INFINITY;
        }
        -(1.0 - u).ln() / self.extinction
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
