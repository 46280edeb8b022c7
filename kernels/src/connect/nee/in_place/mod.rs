//! Next event estimation in place: from vertices to contributions while a stretch of rows is at hand.
//!
//! Where it competes with walks alone every vertex connects, and a weight needs no history. So light points are drawn,
//! weighed, and judged by the roulette at once, as [`light_sample`](crate::connect::light_sample),
//! [`mis_weight`](crate::mis_weight) and [`roulette`](crate::roulette) do one after the other with queues in between.
//! Where nothing can block a connection it is counted at once, too, as [`accumulate`](crate::accumulate) does. Where
//! something can, those that are left are listed, to be traced: with the roulette that is one of dozens.
//!
//! Columns are read and written in the order of lanes, and the radiance is the same bit for bit.

pub mod reference;
pub mod simd;

use crate::accumulate::Dropped;
use crate::columns::Spectrum;
use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{CandidateQueue, WorthTable};
use crate::connect::Techniques;
use crate::lanes::LaneSet;
use crate::media::Medium;
use crate::roulette::Threshold;
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
    /// Read where there are surfaces: depth and normal.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Whether there are surfaces.
    pub solid: bool,
    /// Whether anything can block a connection.
    pub blocked: bool,
    /// What survives; none if all does.
    pub threshold: Option<Threshold>,
    /// Read: position of the starts.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the ray that arrives there.
    pub before: &'a RayColumns<'q>,
    /// Read, in the channels in use.
    pub throughput: &'a Spectrum<'q>,
    /// Added to, in the channels in use, where nothing is blocked.
    pub radiance: &'a mut Spectrum<'q>,
    /// Filled, in lane order, where something may be: connections that count anything.
    pub candidates: &'a mut CandidateQueue<'q>,
    /// Filled: what they count.
    pub worth: &'a mut WorthTable<'q>,
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
    /// Those of them that survive the roulette.
    pub kept: u64,
}

/// Whether all connections of a frame can be made in place: by next event estimation alone, from every vertex, through
/// grey homogeneous media with one phase function, to lights at places.
pub fn suffices(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &WalkLimits,
    lengths: PathLengths,
) -> bool {
    let connects = techniques.are_nee_alone() && walk.starts == u32::MAX && lengths.min <= 1;
    let is_plain = medium.field().is_none() && !medium.is_coloured() && medium.phases.is_none();
    connects && is_plain && !lights.has_distant() && !lights.lights().is_empty()
}

/// Draws a light point for the current vertex of every live path, as light_sample does within
/// [`SCOPE`](super::SCOPE), weighs the connection as mis_weight does, keeps it as roulette does, and adds `weight Le T` to
/// the path's radiance as accumulate does, or lists it.
pub type Kernel = fn(Step, Columns<'_, '_>);
