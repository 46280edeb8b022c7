//! Bridges: connections shaped by a real random walk (Schuessler, Hanika, Dachsbacher, EGSR 2024), rolled towards the
//! phase function of their start.
//!
//! From a start x toward a light point at distance s along the axis w: draw the number of edges N, then a free walk of
//! N edges with unit-rate exponential lengths and a phase-function turn at each inner vertex. Rotate and scale the walk
//! so that it runs from x to the light point, and roll it about the axis. With L the length of the bridge,
//!
//! ```text
//! p = p_A P_l P(N) s^3 (N-1)! / L^N * prod_inner phase(c_j) * prod_j 1 / l_j^2 * 2 pi p(psi) * 2 P(first)
//! ```
//!
//! in vertex-volume and vertex-area measure, where the last two factors are 1 for a uniform roll. Path tracing's own
//! densities of the same suffix hold the same phase functions and the same `1 / l^2`, so that the ratio is one line for
//! every N:
//!
//! ```text
//! r_i = p_A P_l P(N) (N-1)! mu_t s^3 e^{mu_t L} / ((mu_t L)^N p_w(i) cos_light) * 2 pi p(psi) * 2 P(first)
//! ```
//!
//! Neither the shape of the walk nor its phase functions enter, only N, L, s, the turn at the start and the directions
//! of both ends.
//!
//! **Counts.** Edges of a bridge from a start at depth i, with `room = min(K - i, max_inserted + 1)`:
//!
//! ```text
//! P(N) = (1 - eps) P_table(N; mu_t s, gamma) + eps / room,    N in 1 .. room
//! ```
//!
//! with eps = [`Bridge::defensive`] and gamma the angle between axis and arriving direction. The [table](counts) says
//! how much of the light comes by N edges. It is a mean, and rare paths have many more edges: found by nobody else,
//! they would become fireflies; the uniform part finds them. Counts beyond the room are dropped, not redrawn.
//!
//! **Roll.** With d_in the direction in which the path arrives at the start and d_0 that of the first edge, at angles
//! gamma and beta to the axis, and psi the dihedral angle between them, `d_in . d_0 = cos beta cos gamma + sin beta sin
//! gamma cos psi`. One over h is then a wrapped Cauchy density in psi, which can be drawn exactly; the
//! Henyey-Greenstein function, `h^{-3/2}`, is nearly followed, and what is left of it is a bounded factor:
//!
//! ```text
//! h_- = h(cos(beta - gamma)),   h_+ = h(cos(beta + gamma)),   h = h(d_in . d_0)
//! tan(psi / 2) = sqrt(h_- / h_+) tan(pi (u - 1/2)),     2 pi p(psi) = sqrt(h_- h_+) / h
//! ```
//!
//! (h_- h_+ is the Q of the derivation in the documentation.) A uniform roll, `tan(psi / 2) = tan(pi (u - 1/2))`,
//! serves any phase function that can be sampled; another phase function gets an aligned roll by a density in psi of
//! its own, which replaces these two lines, and a turn of its own by which its [counts] are tabulated.
//!
//! **Ends.** A walk is as likely read from its end as from its beginning. Where the roll is aligned, the end that suits
//! the turn at the start comes first more often, with probability [P(first)](ends).
//!
//! **Choice.** Of [several walks](sample), made of pieces that are drawn once, one that [suits](suit) is likely chosen.
//! None of this is in p: what was chosen counts its resampling weight, one over its probability and their number, which
//! is 1 in the mean (Talbot, Cline, Egbert, EGSR 2005).
//!
//! **Surfaces.** A start on a surface has no phase function: its bridges roll uniformly along walks as they are drawn,
//! p_w is the density of the reflection, and the table has a row of its own for it.

pub mod counts;
pub mod ends;
pub mod reference;
pub mod sample;
pub mod simd;
pub mod suit;

use std::sync::Arc;

use counts::CountTable;

use super::light_sample::Scope;
use super::{Densities, Row};
use crate::media::Medium;
use crate::random;

/// Share of the counts that are drawn uniformly, if nothing else is asked for.
pub const DEFENSIVE: f32 = 0.05;

/// How a bridge is rolled about its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roll {
    /// In proportion to one over h of the turn at the start, the Henyey-Greenstein function to the power 2/3; walks are
    /// chosen among several, and the end comes first that suits that turn.
    Aligned,
    /// All angles alike, and walks as they are drawn.
    Uniform,
}

/// Most alternatives of each half of a walk.
pub const MOST_ALTERNATIVES: usize = 2;

/// Fewest edges of walks that have alternatives: there is little to choose among shorter ones.
pub const FEWEST_CHOSEN: usize = 4;

/// Share of the walks that are chosen whether they suit or not.
pub const INDIFFERENT: f32 = 0.1;

/// The settings of the technique.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridge {
    /// How bridges are rolled.
    pub roll: Roll,
    /// Alternatives of each half of a walk where the roll is aligned: 1 for walks as they are drawn, or
    /// [`MOST_ALTERNATIVES`].
    pub alternatives: usize,
    /// Share of the counts that are drawn uniformly, [0, 1]; with 0 there are fireflies.
    pub defensive: f32,
    /// Probabilities of the others.
    pub counts: Arc<CountTable>,
    /// Longest distance from start to light point `[m]`; infinite for no limit.
    pub max_distance: f32,
    /// Largest optical depth from start to light point: the limit where extinction varies, or else infinite.
    pub max_depth: f32,
    /// Most inserted vertices; `u32::MAX` for no limit but that of the path.
    pub max_inserted: u32,
}

impl Bridge {
    /// Bridges of any length in `medium`, on paths of at most `longest` segments.
    pub fn new(roll: Roll, medium: &Medium, longest: u32) -> Self {
        Self::with_counts(roll, Arc::new(CountTable::new(medium, longest)))
    }

    /// Bridges of any length, with numbers of edges from `counts`.
    pub fn with_counts(roll: Roll, counts: Arc<CountTable>) -> Self {
        Self {
            roll,
            alternatives: MOST_ALTERNATIVES,
            defensive: DEFENSIVE,
            counts,
            max_distance: f32::INFINITY,
            max_depth: f32::INFINITY,
            max_inserted: u32::MAX,
        }
    }

    /// Of walks as they are drawn.
    pub fn as_drawn(self) -> Self {
        Self { alternatives: 1, ..self }
    }

    /// Alternatives of each half of a walk of so many `edges`.
    pub fn alternatives_of(&self, edges: usize) -> usize {
        if self.roll == Roll::Aligned && edges >= FEWEST_CHOSEN { self.alternatives } else { 1 }
    }

    /// With at most `mesc` expected segments, mu_t s, in the clearest channel of `medium`.
    pub fn with_mesc(self, medium: &Medium, mesc: f64) -> Self {
        let max_distance = (mesc * medium.mean_free_path()) as f32;
        Self { max_distance, max_depth: medium.longest_depth(mesc), ..self }
    }

    /// Whether every path of at most `longest` segments can be made by a bridge from its first vertex.
    pub fn reaches_everything(&self, longest: u32) -> bool {
        self.max_distance.min(self.max_depth) == f32::INFINITY && self.max_inserted.saturating_add(2) >= longest
    }

    /// Most edges of a bridge from a start at `depth`, where paths have at most `longest` segments; `depth < longest`.
    pub fn room(&self, longest: u32, depth: u32) -> u32 {
        (longest - depth).min(self.max_inserted.saturating_add(1))
    }

    /// What others must know of it.
    pub fn row(&self) -> Row {
        Row {
            most_inserted: self.max_inserted,
            looks_back: true,
            most_edges: self.max_inserted.saturating_add(1) as usize,
            most_edges_near: 0,
            densities: Densities::None,
            near: f32::INFINITY,
        }
    }

    /// Every start within the distance limit connects, whichever way the light faces.
    pub fn scope(&self) -> Scope {
        Scope { max_distance: self.max_distance, ..Scope::new(random::BRIDGE_LIGHT) }
    }
}
