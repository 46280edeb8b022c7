//! Connection techniques: each joins a vertex of the path to a light through a chain of inserted vertices.
//!
//! One folder per technique, sampling and density side by side. A technique's *ratio* `r_i` is the density of making a
//! given suffix from start `i`, over the density of path tracing doing so; [`mis_weight`](crate::mis_weight) adds up
//! the ratios of all active techniques.

pub mod bridge;
pub mod buckets;
pub mod density;
pub mod light_sample;
pub mod light_survey;
pub mod likelihood;
pub mod lis;
pub mod mvnee;
pub mod nee;
pub mod omnee;
pub mod sequence;
pub mod suffix;
mod technique;

use bridge::Bridge;
use light_sample::Scope;
use lis::Lis;
use mvnee::Mvnee;

pub use technique::{Chain, Connection, Densities, Row, Technique};

/// The connection techniques of a frame; path tracing is always among the competitors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Techniques {
    /// Next event estimation: one straight connection from every vertex.
    pub nee: bool,
    /// Multiple-vertex next event estimation.
    pub mvnee: Option<Mvnee>,
    /// Once-more next event estimation: exactly one inserted vertex.
    pub omnee: bool,
    /// Bridges.
    pub bridge: Option<Bridge>,
    /// Light importance sampling: connections that end at a vertex made from the light.
    pub lis: Option<Lis>,
}

impl Techniques {
    /// The same where no vertex can be inserted, because nothing scatters: what inserts any is next event estimation
    /// there.
    pub fn without_vertices(self) -> Self {
        Self { nee: self.any(), ..Self::default() }
    }

    /// The straight connections that keep light importance sampling company: none where next event estimation makes
    /// them all.
    pub fn companion(&self) -> Option<Scope> {
        self.lis.as_ref().filter(|_| !self.nee).map(Lis::companion)
    }

    /// Whether any vertex connects.
    pub fn any(&self) -> bool {
        *self != Self::default()
    }
}
