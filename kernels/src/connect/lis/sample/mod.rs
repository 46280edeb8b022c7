//! Making the connections: a vertex from the light for each, then, once the connector has joined start and vertex, the
//! light point behind it.

pub mod reference;
pub mod simd;

use super::Lis;
use crate::Step;
use crate::columns::paths::{ImmersionColumns, PathColumns};
use crate::columns::queues::{CandidateQueue, ChainTable, EndQueue};
use crate::connect::buckets::BucketTable;
use crate::media::Medium;
use crate::tables::lights::Lights;

/// What making vertices from the light may touch.
pub struct VertexColumns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// The settings of the technique.
    pub lis: &'a Lis,
    /// Read: pixel, sample, birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where extinction is coloured: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Filled: `point`, which becomes the vertex; connections are left out whose start is too far from it, or whose
    /// flight leaves everything or ends in vacuum.
    pub connections: &'a mut CandidateQueue<'q>,
    /// Filled, at the same rows: the points on the light.
    pub ends: &'a mut EndQueue<'q>,
}

/// Makes a vertex from every light point.
///
/// Block `LIS_VERTEX` at the depth of the start: the first word gives the cosine to the normal, `u^{1 / (k + 2)}` for a
/// light of exponent k, the second the azimuth `2 pi u` in the [frame](crate::vec3::Vec3x8::frame) of the normal, the
/// third the flight, for the hero of the path, through the medium as weights see it along the ray; where both sides of a light shine, it is the back if the fourth is below
/// 1/2.
pub type VertexKernel = fn(Step, VertexColumns<'_, '_>);

/// What completing the connections may touch.
pub struct JoinColumns<'a, 'q> {
    /// Read: order and buckets, by the number of vertices that the connector inserts.
    pub buckets: &'a BucketTable<'q>,
    /// Read: the points on the light, in the rows before sorting.
    pub ends: &'a EndQueue<'q>,
    /// Read: `point`, the vertex made from the light. Filled: `point`, now the light's.
    pub candidates: &'a mut CandidateQueue<'q>,
    /// Filled at the buckets' rows: the last inserted vertex.
    pub chains: &'a mut ChainTable<'q>,
}

/// Appends the vertices made from the light to the chains; a bucket's rows then insert one vertex more than it says.
pub type JoinKernel = fn(Step, JoinColumns<'_, '_>);
