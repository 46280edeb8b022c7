//! One weight for every candidate, whichever technique made it.
//!
//! With the balance heuristic a complete path of n segments counts
//!
//! ```text
//! weight = 1 / (reach(n) + sum over starts i of reach(i) r_i)
//! ```
//!
//! where `r_i` is the density of making its suffix by a connection from vertex `i`, over the density of path tracing doing
//! so, and `reach(i) = survival^(i - 1)` the probability that a walk gets to vertex `i` if it does not stop by itself;
//! `reach(n)`, that it goes on to the light, is 0 where walks end before. Starts run from the first eligible vertex, over at
//! most `starts` vertices. Each active technique adds its own ratios; the formulas stand in
//! [`connect`](crate::connect). The weight exceeds one where fewer walks than one per sample look at the path, and is 0
//! where none does.

pub mod density;
pub mod reference;
pub mod simd;
pub mod suffix;
#[cfg(test)]
mod tests;

use suffix::Suffix;

use crate::columns::paths::{PathTable, VertexTable};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable};
use crate::columns::trail::TrailTable;
use crate::connect::Techniques;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::{PathLengths, Step, Walk};

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Rows to weigh: those of this bucket.
    pub bucket: Bucket,
    /// Read: lane, light, start, arriving, point. Filled: weight.
    pub candidates: &'a mut CandidateQueue<'q>,
    /// Read: the inserted vertices.
    pub chains: &'a ChainTable<'q>,
    /// Read: birth, last surface vertex and its normal, first vertex near a light.
    pub paths: &'a PathTable<'q>,
    /// Read: the vertex of the clock, which is the start.
    pub vertices: &'a VertexTable<'q>,
    /// Read: the vertices before it, as far as the active techniques look back.
    pub trail: &'a TrailTable<'q>,
    /// Room for the suffix of eight candidates; holds nothing between calls.
    pub suffix: &'a mut Suffix<'q>,
}

/// Weighs candidates of two segments or more; one that arrives at the back of its light, or leaves a surface towards its
/// inside, weighs nothing. Visibility plays no other part.
///
/// p_w of a start on a surface is the density of its reflection, `cos theta / pi`. The weight is multiplied by the light's
/// profile, its radiance in the direction of the path over its `radiance`.
pub type Kernel = fn(&Medium, &Lights, &Techniques, &Walk, PathLengths, Step, Columns<'_, '_>);
