//! One weight for every candidate, whichever technique made it.
//!
//! With the balance heuristic a complete path of n segments counts
//!
//! ```text
//! weight = 1 / (reach(n) + sum over starts i of reach(i) r_i)          where extinction is grey; else see `media::spectral`
//! ```
//!
//! where `r_i` is the density of making its suffix by a connection from vertex `i`, over the density of path tracing
//! doing so, and `reach(i)` the probability that a walk gets to vertex `i` if it does not stop by itself, the product of
//! the [survivals](crate::survival) before; `reach(n)`, that it goes on to the light, is 0 where walks end before. Starts
//! run from the first eligible vertex, over at most `starts` vertices. Each active technique adds its own ratios; the
//! formulas stand in [`connect`](crate::connect). The weight exceeds one where fewer walks than one per sample look at the path, and is 0
//! where none does.

mod colours;
mod factors;
mod passages;
pub mod reference;
pub mod simd;
mod starts;
pub(crate) mod straight;
#[cfg(test)]
mod tests;

use crate::columns::Spectrum;
use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, PassageColumns, PathColumns, VertexColumns};
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, WorthTable};
use crate::columns::trail::{PassageTrail, TrailTable};
use crate::connect::Techniques;
use crate::connect::suffix::Suffix;
use crate::media::Medium;
use crate::tables::lights::Lights;
use crate::{PathLengths, Step, WalkLimits};

/// Which starts compete for a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Competing {
    /// All that could have made it: its weight.
    All,
    /// The walk, and the one that did make it: a bound, no less than the weight to the last bit, for which no vertex before
    /// that start is looked at. Infinite where, by rounding, neither could have made it.
    Own,
}

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights, and how connections choose among them.
    pub lights: &'a Lights,
    /// The techniques that compete.
    pub techniques: &'a Techniques,
    /// How far walks go, and where they connect from.
    pub walk: &'a WalkLimits,
    /// Which starts compete.
    pub competing: Competing,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// Whether there are surfaces; without them, nothing of `last_surface` but the depth is read.
    pub solid: bool,
    /// Rows to weigh: those of this bucket.
    pub bucket: Bucket,
    /// Read: every column.
    pub candidates: &'a CandidateQueue<'q>,
    /// Read: the inserted vertices, and their resampling weights.
    pub chains: &'a ChainTable<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where extinction is coloured: how probable every channel is as hero of the paths.
    pub log_posterior: &'a Spectrum<'q>,
    /// Read: the last surface vertex of the paths.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read: what the starts know of the lights.
    pub outlook: &'a OutlookColumns<'q>,
    /// Read: arc of the starts.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the vertices before them, as far as the active techniques look back.
    pub trail: &'a TrailTable<'q>,
    /// Read where extinction varies: what the paths have passed through, as many sums as the medium has.
    pub passages: &'a [PassageColumns<'q>],
    /// Read there: what they had passed through at the vertices before.
    pub passage_trails: &'a [PassageTrail<'q>],
    /// Room for the suffixes of eight candidates.
    pub suffix: &'a mut Suffix<'q>,
    /// Filled: weight; and as factor, the albedos of the inserted vertices and how they were resampled, where extinction is
    /// coloured, the light that arrives in a channel over that in the reference; and the colour of an image of the sky.
    pub worth: &'a mut WorthTable<'q>,
}

/// Weighs candidates of two segments or more; one that arrives at the back of its light, or leaves a surface towards
/// its inside, weighs nothing. Visibility plays no other part.
///
/// p_w of a start on a surface is the density of its reflection, `cos theta / pi`. The weight is multiplied by the
/// light's profile, its radiance in the direction of the path over its `radiance`; the factors by the colour of an image
/// of the sky.
pub type Kernel = fn(Step, Columns<'_, '_>);
