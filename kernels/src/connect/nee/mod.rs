//! Next event estimation: one straight connection from the current vertex.
//!
//! The connection is the one that [`light_sample`](super::light_sample) draws, without inserted vertices. It is always
//! attempted, so that its density is `p_A P_l` (area measure) and, with path tracing's
//! `p_w exp(-mu_t s) cos_light / s^2`,
//!
//! ```text
//! r_{n-1} = p_A P_l s^2 exp(mu_t s) / (p_w cos_light),      r_i = 0 for all other starts
//! ```
//!
//! Where nothing else competes it happens [in place](in_place), all but tracing what may be hidden.

pub mod in_place;
pub mod reference;
pub(crate) mod simd;

use super::light_sample::Scope;
use super::{Densities, Row};
use crate::random;

/// Every start in front of the light connects, at any distance.
pub const SCOPE: Scope = Scope { facing: true, ..Scope::new(random::NEE_LIGHT) };

/// What others must know of it.
pub const ROW: Row = Row {
    most_inserted: 0,
    looks_back: false,
    most_edges: 1,
    most_edges_near: 0,
    densities: Densities::All,
    near: f32::INFINITY,
};
