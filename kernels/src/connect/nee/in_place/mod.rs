//! Next event estimation in place: from vertices to contributions while eight rows are in registers.
//!
//! Where it competes with walks alone, nothing can block its connections and every vertex makes one, these need no
//! queue: a light point is drawn, weighed and counted at once, as [`light_sample`](crate::connect::light_sample),
//! [`mis_weight`](crate::mis_weight) and [`accumulate`](crate::accumulate) do one after the other. Columns are read and
//! written in the order of lanes, and the radiance is the same bit for bit.

pub mod reference;
pub mod simd;

use crate::accumulate::Dropped;
use crate::columns::Spectrum;
use crate::columns::paths::{OutlookColumns, PathColumns, RayColumns, VertexColumns};
use crate::connect::Techniques;
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::tables::lights::Lights;
use crate::{PathLengths, Step, WalkLimits};

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium, for which this [`suffices`].
    pub medium: &'a Medium,
    /// The lights, likewise.
    pub lights: &'a Lights,
    /// How far walks go, likewise.
    pub walk: &'a WalkLimits,
    /// The paths whose vertices connect.
    pub live: &'a LaneSet<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read where the selection depends on the start: its light sum.
    pub outlook: &'a OutlookColumns<'q>,
    /// Read: position of the starts.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the ray that arrives there.
    pub before: &'a RayColumns<'q>,
    /// Read, in the channels in use.
    pub throughput: &'a Spectrum<'q>,
    /// Added to, in the channels in use.
    pub radiance: &'a mut Spectrum<'q>,
    /// Added to: contributions that were not finite, and so were dropped.
    pub dropped: &'a mut Dropped,
    /// Added to: how many there were.
    pub tally: &'a mut Tally,
}

/// How many connections were made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Starts in front of a light.
    pub tried: u64,
    /// Those of them that count anything.
    pub weighted: u64,
}

/// Whether all connections of a frame can be made in place: by next event estimation alone, from every vertex, through
/// grey homogeneous media with one phase function, to lights at places that nothing hides.
pub fn suffices(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &WalkLimits,
    lengths: PathLengths,
    solid: bool,
) -> bool {
    let connects = techniques.are_nee_alone() && walk.starts == u32::MAX && lengths.min <= 1;
    let is_plain = medium.field().is_none() && !medium.is_coloured() && medium.phases.is_none();
    let is_free = !solid && lights.are_clear() && !lights.has_distant() && !lights.lights().is_empty();
    connects && is_plain && is_free
}

/// Draws a light point for the current vertex of every live path, as light_sample does within
/// [`SCOPE`](super::SCOPE), weighs the connection as mis_weight does, and adds `weight Le T` to the path's radiance as
/// accumulate does.
pub type Kernel = fn(Step, Columns<'_, '_>);
