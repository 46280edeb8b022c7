//! Light importance sampling: connections that end at a vertex made from the light (after MVNEE-LIS of Weber, Hanika,
//! Dachsbacher 2017).
//!
//! A focused light sends what it has into a narrow beam, and a connection to a point on it mostly arrives from outside.
//! So one vertex y is made from the light point x_n first, in a direction w that follows the emission and at a free
//! flight t, and the start is connected with y, by a bridge (ours) or by MVNEE (the paper's). With theta the angle
//! between w and the light's normal and k the light's exponent, 0 for one that is alike in all directions, y has the
//! density
//!
//! ```text
//! p_dir(w) = (k + 2) / (2 pi) cos^{k+1} theta                   (solid angle: emitted flux)
//! p(y)     = p_dir(w) mu_t exp(-mu_t t) / t^2                   (vertex-volume measure)
//! p        = p_A P_l p(y) q(x_i -> y)
//! ```
//!
//! (half of p_dir where both sides shine), where q is the connector's density of its own inserted vertices, given both
//! ends. Path tracing has the density of the way to y times `phase(c_y) exp(-mu_t t) cos theta / t^2`, and that of the
//! way has mu_t where one to a light has its cosine, so that
//!
//! ```text
//! r_i = p_A P_l p_dir(w) / (phase(c_y) cos theta) * [ r_i of a connection to y, without p_A P_l / cos_light ]
//! ```
//!
//! and what y brings in is a factor without t. From a start x_i the path has N = N' + 1 >= 2 edges, N' of them the
//! connector's; whatever the connector calls s, L, l_{n-1} and m belongs to the way to y.
//!
//! **Where extinction varies.** A flight that is tracked through a field has a density that nobody can evaluate, but one
//! through its means has: the ray from x_n in the direction w has strata as every segment has
//! ([`field`](crate::media::field)), of extinction mu~(t) and optical depth tau~(t), which follow from x_n and w alone,
//! and so from x_n and y. Flights are drawn there,
//!
//! ```text
//! tau~(t) = -ln(1 - u),      p(y) = p_dir(w) mu~(t) e^{-tau~(t)} / t^2
//! ```
//!
//! and path tracing's density, as weights take it, is that of arriving at y from the start, with the true mu_t(y), and
//! `phase(c_y) e^{-tau~(y, x_n)} cos theta / t^2` from there on. What is left is one factor for all starts,
//!
//! ```text
//! r_i = p_A P_l p_dir(w) / (phase(c_y) cos theta) * mu~(t) / mu_t(y) * e^{tau~(y, x_n) - tau~(t)} * [ .. ]
//! ```
//!
//! which is 1 in a homogeneous medium: tau~ of the segment and tau~(t) of the ray differ only because their strata do.
//! `[ .. ]` counts what lies between start and y. Nothing of this is an estimate: a ratio holds the density with which y
//! is drawn, the connector's is exact given y, and the transmittance of all segments, that from y to the light among
//! them, is in the candidate's factor F. So the weights of all techniques add up to 1 for every path, and no mean
//! depends on mu~. A flight that leaves everything makes no path, and one that ends in vacuum a path that is worth
//! nothing: such connections are given up before anything is joined, and count 0. Where mu~(t) is 0, so is the ratio,
//! and others make the path. With coloured extinction flights are drawn for the hero, and `mu~ e^{-tau~}` has
//! its mean over the channels, as MVNEE's seeds have.
//!
//! **Counts.** `depth + N' + 1 <= K`: the connector has one edge less to spend. What is longer is dropped, not redrawn.
//!
//! **Companion.** Paths of a single edge cannot be made so. Starts within [`Lis::near`] of the light point, four mean
//! free paths as in the paper, also connect by next event estimation, at whose ratio these paths are weighed; beyond,
//! path tracing alone makes them. Where `nee` itself is active the companion would say the same twice and is left out.
//! In a field there is no one mean free path, and walks rarely meet a lamp that stands in vacuum: all starts have the
//! companion.

pub mod reference;
pub mod sample;
pub(crate) mod simd;

use super::bridge::Bridge;
use super::light_sample::Scope;
use super::mvnee::Mvnee;
use super::{Densities, Row};
use crate::media::Medium;
use crate::{PathLengths, random};

/// Mean free paths within which starts also connect in a straight line (Weber, Hanika, Dachsbacher 2017).
pub const NEAR: f64 = 4.0;

/// What joins a start with the vertex made from the light.
#[derive(Clone, Debug, PartialEq)]
pub enum Connector {
    /// A bridge.
    Bridge(Bridge),
    /// Seeds on the axis, perturbed.
    Mvnee(Mvnee),
}

/// The settings of the technique.
#[derive(Clone, Debug, PartialEq)]
pub struct Lis {
    /// What joins a start with the vertex made from the light; its limits are on the way to that vertex.
    pub connector: Connector,
    /// Distance from start to light point up to which the companion connects `[m]`, >= 0; infinite in a field.
    pub near: f32,
}

impl Lis {
    /// The settings for `medium`, with the companion of the paper.
    pub fn new(medium: &Medium, connector: Connector) -> Self {
        Self { connector, near: (NEAR * medium.mean_free_path()) as f32 }
    }

    /// Longest way from a start to the vertex made from the light `[m]`; infinite for no limit.
    pub fn max_distance(&self) -> f32 {
        match &self.connector {
            Connector::Bridge(bridge) => bridge.max_distance,
            Connector::Mvnee(mvnee) => mvnee.max_distance,
        }
    }

    /// Most edges from a start to the vertex made from the light, as far as the connector limits them.
    pub(crate) fn most_edges(&self) -> f32 {
        match &self.connector {
            Connector::Bridge(bridge) => bridge.max_inserted.saturating_add(1) as f32,
            Connector::Mvnee(_) => f32::INFINITY,
        }
    }

    /// What others must know of it.
    pub fn row(&self) -> Row {
        let (inserted, densities) = match &self.connector {
            Connector::Bridge(bridge) => (bridge.max_inserted, Densities::Last),
            Connector::Mvnee(mvnee) => (mvnee.max_inserted, Densities::All),
        };
        Row {
            most_inserted: inserted.saturating_add(1),
            looks_back: true,
            most_edges: inserted.saturating_add(2) as usize,
            most_edges_near: 0,
            densities,
            near: f32::INFINITY,
        }
    }

    /// The companion's connections.
    pub fn companion(&self) -> Scope {
        Scope { max_distance: self.near, facing: true, ..Scope::new(random::LIS_NEAR_LIGHT) }
    }
}

/// Every start connects that has two segments left, whichever way the light faces.
pub fn scope(lengths: PathLengths) -> Scope {
    Scope { max_depth: lengths.max.saturating_sub(2), ..Scope::new(random::LIS_LIGHT) }
}

/// The path lengths of the way to the vertex made from the light: a segment comes after it.
pub fn before_last(lengths: PathLengths) -> PathLengths {
    PathLengths { max: lengths.max.saturating_sub(1), ..lengths }
}
