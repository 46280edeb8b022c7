//! Once-more next event estimation: a connection through exactly one inserted vertex (Hanika, Weidlich, Droske, EGSR
//! 2022).
//!
//! From a start x toward a light point at distance s along the axis w: the turn theta at the inserted vertex is drawn
//! from the phase function restricted to the forward hemisphere and renormalised, the angle alpha between axis and
//! first edge uniformly in (0, theta), the azimuth uniformly. By the law of sines
//!
//! ```text
//! d_1 = s sin(theta - alpha) / sin theta,    d_2 = s sin alpha / sin theta
//! p = p_A P_l phase(theta) / F * s (sin theta / theta) / (d_1^2 d_2^2)
//! ```
//!
//! with F the forward share of the phase function. The ratio to path tracing, at the second vertex before the light and
//! for theta < pi / 2 only, as far as rounding can tell,
//!
//! ```text
//! r_{n-2} = p_A P_l s (sin theta / theta) exp(mu_t L) / (F p_w mu_t cos_light)
//! ```
//!
//! It makes paths with one inserted vertex and no others; next event estimation is its companion.

pub mod reference;
pub mod sample;
pub(crate) mod simd;

use super::light_sample::Scope;
use super::{Densities, Row};
use crate::PathLengths;
use crate::random;

/// What others must know of it.
pub const ROW: Row = Row {
    most_inserted: 1,
    looks_back: true,
    most_edges: 2,
    most_edges_near: 0,
    densities: Densities::All,
    near: f32::INFINITY,
};

/// Every start connects that has two segments left, whichever way the light faces.
pub fn scope(lengths: PathLengths) -> Scope {
    Scope { max_depth: lengths.max.saturating_sub(2), ..Scope::new(random::OMNEE_LIGHT) }
}
