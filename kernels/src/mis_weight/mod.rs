//! One weight for every candidate, whichever technique made it.
//!
//! With the balance heuristic a complete path counts `1 / (1 + sum over starts i of r_i)`, where `r_i` is the density of
//! making its suffix by a connection from vertex `i`, over the density of path tracing doing so. Each active technique
//! adds its own ratios; the formulas stand in [`connect`](crate::connect).

pub mod reference;
pub mod simd;
pub mod suffix;

use suffix::Suffix;

use crate::Step;
use crate::columns::paths::{PathTable, VertexTable};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable};
use crate::connect::Techniques;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Rows to weigh: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane, light, start, arriving, point. Filled: weight.
    pub candidates: &'a mut CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Read: birth, last surface vertex, first vertex near a light.
    pub paths: &'a PathTable<'q>,
    /// Read: the history up to the start, which is the vertex of the clock.
    pub vertices: &'a VertexTable<'q>,
    /// Room for the suffix of eight candidates; holds nothing between calls.
    pub suffix: &'a mut Suffix<'q>,
}

/// Weighs candidates of two segments or more; one that arrives at the back of its light weighs nothing. Visibility plays
/// no part.
pub type Kernel = fn(&Medium, &Lights, &Techniques, Step, Columns<'_, '_>);
