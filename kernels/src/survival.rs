//! How readily walks go on: Russian roulette by depth.
//!
//! ```text
//! reach(i) = product of survival(d) over d = 1 .. i - 1        probability that a walk gets to vertex i, i >= 1
//! survival(d) = q                                              the same everywhere, or
//!             = q_k,  2^k <= d < 2^(k+1)                       one number for every octave of depth
//! ```
//!
//! Whether a walk goes on depends on nothing but the depth, so `reach` is known for every vertex of every path, whoever
//! made it, and weights stay exact. Light that wanders falls with a power of the number of segments, and so must
//! `reach`: numbers by octave can, where one number ends all walks about as far.

use wide::{f32x8, u32x8};

use crate::LONGEST_PATH;
use crate::lanes;
use crate::transcendental::exp;

/// The octave of depth from which on walks end of which nothing is known: see [`Survival::fading`].
pub const FIRST_FADING: usize = 3;

/// Octaves of depth: 1, 2 and 3, 4 to 7, and so on up to the longest path.
pub const OCTAVES: usize = LONGEST_PATH.ilog2() as usize + 1;

/// Probability with which a walk goes on from a vertex after the camera, (0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Survival {
    /// From all vertices alike.
    Constant(f32),
    /// By the octave of the vertex's depth.
    ByOctave(Octaves),
}

/// One probability for every octave of depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octaves {
    survival: [f32; OCTAVES],
    log_survival: [f32; OCTAVES],
    /// ln reach at the first depth of every octave.
    log_reach: [f32; OCTAVES],
}

impl Survival {
    /// Walks that go on.
    pub const CERTAIN: Self = Self::Constant(1.0);

    /// Walks of which a share `reach[k]`, (0, 1] and none larger than the one before, gets to the depth 2^k; `reach[0]`
    /// is 1. Beyond the last depth the last probability goes on.
    pub fn from_reach(reach: [f64; OCTAVES]) -> Self {
        let mut last = 1.0;
        Self::by_octave(core::array::from_fn(|k| {
            if k + 1 < OCTAVES {
                last = (reach[k + 1] / reach[k]).powf(0.5_f64.powi(k as i32)).min(1.0);
            }
            last as f32
        }))
    }

    /// What suits walks of any length of which nothing is known: from the depth `2^first` on `reach` falls with the power
    /// -3/4, so that sums of variances and costs both converge where light falls with the power -3/2, as it does in endless
    /// white fog.
    pub fn fading(first: usize) -> Self {
        Self::from_reach(core::array::from_fn(|k| 0.5_f64.powf(0.75 * k.saturating_sub(first) as f64)))
    }

    /// A probability, (0, 1], for the vertices at the depths 2^k to 2^(k+1) - 1.
    pub fn by_octave(survival: [f32; OCTAVES]) -> Self {
        let logs = survival.map(|q| f64::from(q).ln());
        let log_reach = |k: usize| (0..k).map(|j| 2.0_f64.powi(j as i32) * logs[j]).sum::<f64>();
        let log_reach = core::array::from_fn(|k| log_reach(k) as f32);
        Self::ByOctave(Octaves { survival, log_survival: logs.map(|log| log as f32), log_reach })
    }

    /// Whether every walk goes on.
    pub fn is_certain(&self) -> bool {
        match self {
            Self::Constant(q) => *q == 1.0,
            Self::ByOctave(octaves) => octaves.survival == [1.0; OCTAVES],
        }
    }

    /// The one number, if it is the same everywhere.
    pub fn constant(&self) -> Option<f32> {
        match self {
            Self::Constant(survival) => Some(*survival),
            Self::ByOctave(_) => None,
        }
    }

    /// The probabilities in every octave of depth.
    pub fn octaves(&self) -> [f32; OCTAVES] {
        core::array::from_fn(|k| self.at(1 << k))
    }

    /// Probability that a walk gets to `depth`, >= 1.
    pub fn reach(&self, depth: u32) -> f64 {
        match self {
            Self::Constant(survival) => f64::from(*survival).powi(depth as i32 - 1),
            Self::ByOctave(octaves) => f64::from(octaves.log_reach(u32x8::splat(depth)).to_array()[0]).exp(),
        }
    }

    /// The probability at a vertex of the given depth, >= 1.
    pub fn at(&self, depth: u32) -> f32 {
        match self {
            Self::Constant(q) => *q,
            Self::ByOctave(octaves) => octaves.survival[octave(depth)],
        }
    }
}

/// The same as logarithms, which products are made of.
#[derive(Clone, Copy, Debug)]
pub enum LogSurvival<'a> {
    /// Every walk goes on.
    Certain,
    /// From all vertices alike.
    Constant(f32),
    /// By the octave of the vertex's depth.
    ByOctave(&'a Octaves),
}

impl<'a> LogSurvival<'a> {
    /// That of `survival`.
    pub fn of(survival: &'a Survival) -> Self {
        match survival {
            survival if survival.is_certain() => Self::Certain,
            Survival::Constant(survival) => Self::Constant(survival.ln()),
            Survival::ByOctave(octaves) => Self::ByOctave(octaves),
        }
    }

    /// Probability that walks get to the given depths, >= 1.
    #[inline(always)]
    pub fn reach(self, depth: u32x8) -> f32x8 {
        match self {
            Self::Certain => f32x8::ONE,
            Self::Constant(log) => exp(lanes::to_f32(depth.saturating_sub(u32x8::splat(1))) * f32x8::splat(log)),
            Self::ByOctave(octaves) => exp(octaves.log_reach(depth)),
        }
    }
}

impl From<f32> for Survival {
    fn from(survival: f32) -> Self {
        Self::Constant(survival)
    }
}

impl Octaves {
    /// Probabilities at vertices of the given depths; depth 0 counts as 1.
    #[inline(always)]
    pub fn at(&self, depth: u32x8) -> f32x8 {
        f32x8::new(depth.to_array().map(|depth| self.survival[octave(depth)]))
    }

    /// ln reach of vertices at the given depths; depth 0 counts as 1.
    #[inline(always)]
    pub fn log_reach(&self, depth: u32x8) -> f32x8 {
        let depth = depth.max(u32x8::splat(1));
        let octave = depth.to_array().map(octave);
        let [start, slope] = [&self.log_reach, &self.log_survival].map(|column| f32x8::new(octave.map(|k| column[k])));
        let first = u32x8::new(octave.map(|k| 1 << k));
        lanes::to_f32(depth - first).mul_add(slope, start)
    }
}

/// The octave of a depth; 0 counts as 1, and what is beyond the last octave as that.
#[inline(always)]
pub fn octave(depth: u32) -> usize {
    (depth.max(1).ilog2() as usize).min(OCTAVES - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reach_is_the_product_of_survivals() {
        let survival: [f32; OCTAVES] = core::array::from_fn(|k| 1.0 - 0.3 / (1 << k) as f32);
        let Survival::ByOctave(octaves) = Survival::by_octave(survival) else { panic!("by octave") };
        let mut reach = 0.0;
        for depth in 1..=LONGEST_PATH {
            if depth.is_power_of_two() || (depth + 1).is_power_of_two() || depth % 1001 == 0 {
                let found = octaves.log_reach(u32x8::splat(depth)).to_array()[3];
                assert!((f64::from(found) - reach).abs() < 1e-5, "{found} at {depth}, should be {reach}");
            }
            reach += f64::from(Survival::ByOctave(octaves).at(depth)).ln();
        }
        let depths = [0, 1, 2, 3, 4, 1023, 1024, LONGEST_PATH];
        let lanes = octaves.at(u32x8::new(depths)).to_array();
        assert_eq!(lanes, depths.map(|depth| Survival::ByOctave(octaves).at(depth)));
    }

    #[test]
    fn survivals_follow_from_the_reach_that_is_wanted() {
        let wanted: [f64; OCTAVES] = core::array::from_fn(|k| 0.6_f64.powi(k as i32));
        let Survival::ByOctave(octaves) = Survival::from_reach(wanted) else { panic!("by octave") };
        for (k, wanted) in wanted.into_iter().enumerate() {
            let found = octaves.log_reach(u32x8::splat(1 << k)).to_array()[0];
            assert!((f64::from(found) - wanted.ln()).abs() < 1e-2, "{found} at 2^{k}, should be {}", wanted.ln());
        }
        assert!(Survival::from_reach([1.0; OCTAVES]).is_certain() && Survival::CERTAIN.is_certain());
    }
}
