//! Connection techniques: each joins a vertex of the path to a light through a chain of inserted vertices.
//!
//! One folder per technique, sampling and density side by side. A technique's *ratio* `r_i` is the density of making a
//! given suffix from start `i`, over the density of path tracing doing so; [`mis_weight`](crate::mis_weight) adds up
//! the [`ratios`] of all active techniques.

pub mod bridge;
pub mod buckets;
pub mod density;
pub mod distant;
pub mod light_sample;
pub mod light_survey;
pub mod likelihood;
pub mod lis;
pub mod mvnee;
pub mod nee;
pub mod omnee;
pub mod ratios;
pub mod sequence;
pub mod suffix;
mod technique;

use bridge::Bridge;
use light_sample::Scope;
use lis::{Connector, Lis};
use mvnee::Mvnee;

pub use technique::{Chain, Connection, Densities, Row, Technique};

/// What single precision leaves open of where vertices are, over the distance of the light point from the origin and from
/// the start: two roundings of positions and a few of sums.
///
/// A technique that goes forward only must not refuse what rounding turned around: the weight of a connection that its own
/// technique refuses would be left to others that hardly make it, and one that is as good as 0 could become 1. So whatever
/// turns back by no more than that passes.
pub const BLUR: f32 = 5e-7;

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
    /// Has no connection insert more than `most` vertices, the one that is made from the light not counted.
    pub fn limit_inserted(&mut self, most: u32) {
        let [of_lis_bridge, of_lis_mvnee] = match &mut self.lis {
            Some(Lis { connector: Connector::Bridge(bridge), .. }) => [Some(&mut bridge.max_inserted), None],
            Some(Lis { connector: Connector::Mvnee(mvnee), .. }) => [None, Some(&mut mvnee.max_inserted)],
            None => [None, None],
        };
        let own = [
            self.bridge.as_mut().map(|bridge| &mut bridge.max_inserted),
            self.mvnee.as_mut().map(|mvnee| &mut mvnee.max_inserted),
        ];
        own.into_iter().chain([of_lis_bridge, of_lis_mvnee]).flatten().for_each(|limit| *limit = most.min(*limit));
    }

    /// The same where no vertex can be inserted, because nothing scatters: what inserts any is next event estimation
    /// there.
    pub fn without_vertices(self) -> Self {
        Self { nee: self.any(), ..Self::default() }
    }

    /// The same with bridges whose walks are as they are drawn.
    pub fn with_walks_as_drawn(self) -> Self {
        let lis = self.lis.map(|lis| match lis.connector {
            Connector::Bridge(bridge) => Lis { connector: Connector::Bridge(bridge.as_drawn()), ..lis },
            Connector::Mvnee(_) => lis,
        });
        Self { bridge: self.bridge.map(Bridge::as_drawn), lis, ..self }
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
