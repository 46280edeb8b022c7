//! Bridges: connections shaped by a real random walk (Schuessler, Hanika, Dachsbacher, EGSR 2024), rolled towards the
//! phase function of their start.
//!
//! From a start x toward a light point at distance s along the axis w: draw the number of edges N, then a free walk of
//! N edges with unit-rate exponential lengths and a phase-function turn at each inner vertex. Rotate and scale the walk so
//! that it runs from x to the light point, and roll it about the axis. With L the length of the bridge,
//!
//! ```text
//! p = p_A P_l P(N) s^3 (N-1)! / L^N * prod_inner phase(c_j) * prod_j 1 / l_j^2 * 2 pi p(psi)
//! ```
//!
//! in vertex-volume and vertex-area measure, where `2 pi p(psi)` is 1 for a uniform roll. Path tracing's own densities of
//! the same suffix hold the same phase functions and the same `1 / l^2`, so that the ratio is one line for every N:
//!
//! ```text
//! r_i = p_A P_l P(N) (N-1)! mu_t s^3 e^{mu_t L} / ((mu_t L)^N p_w(i) cos_light) * 2 pi p(psi)
//! ```
//!
//! Neither the shape of the walk nor its phase functions enter, only N, L, s and the turn at the start.
//!
//! **Counts.** Edges of a bridge from a start at depth i, with `room = min(K - i, max_inserted + 1)`:
//!
//! ```text
//! P(N) = (1 - eps) Poisson(N - 1; lambda) + eps / room,    N in 1 .. room
//! lambda = mu_t s (straight + turning (1 - cos gamma)),    at most LARGEST_MEAN
//! ```
//!
//! with eps = [`Bridge::defensive`] and gamma the angle between axis and arriving direction: a path that has to turn on
//! its way is longer than s. A Poisson count alone has too thin a tail: a path with many more edges than lambda
//! predicts is then found by nobody and becomes a firefly. Counts beyond the room are dropped, not redrawn.
//!
//! **Roll.** With d_in the direction in which the path arrives at the start and d_0 that of the first edge, at angles
//! gamma and beta to the axis, and psi the dihedral angle between them, `d_in . d_0 = cos beta cos gamma + sin beta sin
//! gamma cos psi`. One over h is then a wrapped Cauchy density in psi, which can be drawn exactly; the Henyey-Greenstein
//! function, `h^{-3/2}`, is nearly followed, and what is left of it is a bounded factor:
//!
//! ```text
//! h_- = h(cos(beta - gamma)),   h_+ = h(cos(beta + gamma)),   h = h(d_in . d_0)
//! tan(psi / 2) = sqrt(h_- / h_+) tan(pi (u - 1/2)),     2 pi p(psi) = sqrt(h_- h_+) / h
//! ```
//!
//! (h_- h_+ is the Q of the derivation in the documentation.) A uniform roll, `tan(psi / 2) = tan(pi (u - 1/2))`, serves
//! any phase function that can be sampled; another phase function gets an aligned roll by a density in psi of its own,
//! which replaces these two lines.
//!
//! **Surfaces.** A start on a surface has no phase function: its bridges roll uniformly, p_w is the density of the reflection,
//! and gamma counts as 0.

pub mod reference;
pub mod sample;
pub mod simd;

use super::light_sample::Reach;
use crate::random;
use crate::tables::media::Medium;

/// Share of the counts that are drawn uniformly, if nothing else is asked for.
pub const DEFENSIVE: f32 = 0.05;

/// [`Bridge::straight`] and [`Bridge::turning`], if nothing else is asked for: the best of a scan, alike for g from 0 to
/// 0.95. They take a tenth of the variance of single starts where paths turn towards the light, a third for g = 0.
pub const MEAN: [f32; 2] = [0.95, 2.0];

/// Largest mean of the Poisson part of the counts: its first probability, e^-64, is far inside f32.
pub const LARGEST_MEAN: f64 = 64.0;

/// How a bridge is rolled about its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roll {
    /// In proportion to one over h of the turn at the start: the Henyey-Greenstein function to the power 2/3.
    Aligned,
    /// All angles alike.
    Uniform,
}

/// The settings of the technique.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge {
    /// How bridges are rolled.
    pub roll: Roll,
    /// Share of the counts that are drawn uniformly, [0, 1]; with 0 there are fireflies.
    pub defensive: f32,
    /// Mean of the Poisson counts per mean free path, where the light is straight ahead; >= 0.
    pub straight: f32,
    /// How much that mean grows, per mean free path, with one minus the cosine to the light; >= 0.
    pub turning: f32,
    /// Longest distance from start to light point `[m]`; infinite for no limit.
    pub max_distance: f32,
    /// Most inserted vertices; `u32::MAX` for no limit but that of the path.
    pub max_inserted: u32,
}

impl Bridge {
    /// Bridges of any length.
    pub const fn new(roll: Roll) -> Self {
        let [straight, turning] = MEAN;
        Self { roll, defensive: DEFENSIVE, straight, turning, max_distance: f32::INFINITY, max_inserted: u32::MAX }
    }

    /// The same with the counts of the paper: pure Poisson numbers of mean mu_t s.
    pub const fn with_poisson_counts(self) -> Self {
        Self { defensive: 0.0, straight: 1.0, turning: 0.0, ..self }
    }

    /// The same for a start on a surface: it has no phase function to align the roll with, and none of its turns is better than
    /// another.
    pub const fn from_surface(self) -> Self {
        Self { roll: Roll::Uniform, turning: 0.0, ..self }
    }

    /// With at most `mesc` expected segments, mu_t s, in `medium`.
    pub fn with_mesc(self, medium: &Medium, mesc: f64) -> Self {
        Self { max_distance: (mesc / f64::from(medium.extinction)) as f32, ..self }
    }

    /// Whether every path to a light can be made by a bridge from its first vertex.
    pub fn reaches_everything(&self) -> bool {
        self.max_distance == f32::INFINITY && self.max_inserted == u32::MAX
    }

    /// Most edges of a bridge from a start at `depth`, where paths have at most `longest` segments; `depth < longest`.
    pub fn room(&self, longest: u32, depth: u32) -> u32 {
        (longest - depth).min(self.max_inserted.saturating_add(1))
    }

    /// Every start within the distance limit connects, whichever way the light faces.
    pub fn reach(&self) -> Reach {
        Reach { max_distance: self.max_distance, ..Reach::new(random::BRIDGE_LIGHT) }
    }
}
