//! What twins ask of a medium, in one channel, in f64.

use glam::DVec3;

use super::LEAST_EVENT;
use super::field::reference::FieldTwin;
use crate::phase::HenyeyGreenstein;
use crate::phase::reference::Phase;

/// A medium in one channel.
pub trait Medium {
    /// The segment between two points as weights see it: pieces of one extinction each, from its start to its end.
    fn strata(&self, from: DVec3, to: DVec3) -> Vec<Stratum>;

    /// The ray from a point in a unit direction, which has no end, as weights see it: the same.
    fn strata_of_ray(&self, from: DVec3, direction: DVec3) -> Vec<Stratum>;

    /// Optical depth of the segment between two points, as weights count it.
    fn optical_depth(&self, from: DVec3, to: DVec3) -> f64;

    /// Extinction of the channel over that of the clearest one, in which limits on optical depths count.
    fn over_clearest(&self) -> f64 {
        1.0
    }

    /// Extinction at a point [1/m].
    fn extinction(&self, at: DVec3) -> f64;

    /// Extinction at a vertex of a path, as densities of walks count it [1/m].
    fn event(&self, at: DVec3) -> f64 {
        self.extinction(at).max(f64::from(LEAST_EVENT))
    }

    /// Where a scattering event sends light.
    fn phase(&self) -> &dyn Phase;
}

/// A piece of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stratum {
    /// Length `[m]`.
    pub length: f64,
    /// Extinction [1/m].
    pub extinction: f64,
}

/// Optical depth of the first `along` metres of a segment.
pub fn depth_until(strata: &[Stratum], along: f64) -> f64 {
    let mut begin = 0.0;
    let mut depth = 0.0;
    for stratum in strata {
        // Unlike `clamp`, goes with segments without an end.
        depth += stratum.extinction * (along - begin).max(0.0).min(stratum.length);
        begin += stratum.length;
    }
    depth
}

/// Extinction at a distance along a segment [1/m].
pub fn extinction_along(strata: &[Stratum], along: f64) -> f64 {
    let mut end = 0.0;
    let at = strata.iter().find(|stratum| {
        end += stratum.length;
        along < end
    });
    at.or(strata.last()).map_or(0.0, |stratum| stratum.extinction)
}

/// How far along a segment an optical depth is reached `[m]`: infinitely far if it is not.
pub fn reach(strata: &[Stratum], depth: f64) -> f64 {
    let (mut left, mut begin) = (depth, 0.0);
    for stratum in strata {
        let thickness = stratum.extinction * stratum.length;
        if left < thickness {
            return begin + left / stratum.extinction;
        }
        left -= thickness;
        begin += stratum.length;
    }
    f64::INFINITY
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
    fn strata(&self, from: DVec3, to: DVec3) -> Vec<Stratum> {
        vec![Stratum { length: from.distance(to), extinction: self.extinction }]
    }

    fn strata_of_ray(&self, _: DVec3, _: DVec3) -> Vec<Stratum> {
        vec![Stratum { length: f64::INFINITY, extinction: self.extinction }]
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
    fn strata(&self, from: DVec3, to: DVec3) -> Vec<Stratum> {
        self.kind().strata(from, to)
    }

    fn strata_of_ray(&self, from: DVec3, direction: DVec3) -> Vec<Stratum> {
        self.kind().strata_of_ray(from, direction)
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
