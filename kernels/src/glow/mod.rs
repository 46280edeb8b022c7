//! Light that media emit along flights.
//!
//! A flight from x in direction w ends at distance t, wherever that is: at a collision, on a surface or a light, or never.
//! What it has passed is emission that the path meets, and its mean is what there is to meet:
//!
//! ```text
//! E[ int_0^t e(x + s w) ds ] = int e(x + s w) P(t > s) ds = int e(x + s w) T(s) ds
//! ```
//!
//! No majorant is asked for, emission without extinction counts as well, and nothing else makes such paths, so that there
//! is nothing to weigh them against.
//!
//! Where extinction is [coloured](crate::media::spectral), the flight is one of the path's hero h, and such flights are as
//! frequent as `posterior_h P`: what one has passed counts in channel h alone, as `T_h / posterior_h`, so that the mean
//! over heroes is right in every channel, and no transmittance of another one is asked for.
//!
//! The integral along the way flown is estimated by one point in each of some strata
//! of equal length within the box of all volumes or, if nothing around these emits, of those that do; that of the constant
//! emission around them is known.

pub mod reference;
pub mod simd;

use crate::accumulate::Dropped;
use crate::columns::parts::PartTable;
use crate::columns::paths::{ImmersionColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{HitQueue, SurfaceHitQueue};
use crate::columns::{Column, Spectrum};
use crate::lanes::LaneSet;
use crate::media::{Glow, Medium};
use crate::tables::lights::Lights;
use crate::{PathLengths, Step, WalkLimits};

/// Most points at which emission is asked for along a flight.
pub const MOST_POINTS: u32 = 64;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium around everything.
    pub medium: &'a Medium,
    /// What it emits. Where there is emission around all volumes, there is extinction.
    pub glow: &'a Glow,
    /// The lights.
    pub lights: &'a Lights,
    /// The path lengths that count.
    pub lengths: PathLengths,
    /// How readily walks have gone on.
    pub walk: &'a WalkLimits,
    /// The paths that fly.
    pub live: &'a LaneSet<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: where the flights start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: their direction.
    pub ray: &'a RayColumns<'q>,
    /// Read: how far they would go.
    pub flight: &'a Column<'q, f32>,
    /// Read: the disks and spheres that may end them.
    pub hits: &'a HitQueue<'q>,
    /// Read: the surfaces that end them.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read, in the channels in use.
    pub throughput: &'a Spectrum<'q>,
    /// Read where extinction is coloured: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Read where extinction is coloured: ln posterior_c, before the flight.
    pub log_posterior: &'a Spectrum<'q>,
    /// Scratch: how far they go `[m]`.
    pub flown: &'a mut Column<'q, f32>,
    /// Filled for live lanes, in the channels in use: what they add [W/(m^2 sr)].
    pub glowing: &'a mut Spectrum<'q>,
    /// Added to, in the channels in use.
    pub radiance: &'a mut Spectrum<'q>,
    /// Which of the parts by origin emission is; of no meaning where there are none.
    pub origin: usize,
    /// Added to, in the channels in use.
    pub parts: &'a mut PartTable<'q>,
    /// Added to: contributions that were not finite, and so were dropped.
    pub dropped: &'a mut Dropped,
}

/// Adds `T / reach(depth + 1)` times the integral of emission along the way flown to the radiance of every live path,
/// as light of a path of `depth + 1` segments, unless that is outside `lengths`; and once more to the parts of the
/// radiance that it belongs to. Where extinction is coloured, it is `T / (posterior reach(depth + 1))` in the channel of
/// the hero, and nothing in the others.
///
/// The way within [that box](Glow::part) has `n = ceil(length * rate)` strata, 1 to [`MOST_POINTS`]; number i of the
/// [stream](crate::random::Stream) 0 of the block `GLOW` says where in stratum i its point is.
pub type Kernel = fn(Step, Columns<'_, '_>);
