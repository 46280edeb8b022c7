//! What nobody knows of a flight where extinction is coloured and differs from place to place: how much more or less of
//! the other channels' light came along.
//!
//! A flight through a [field](crate::media::field) is drawn for the hero h of its path, and [`spectral_weight`
//! ](crate::spectral_weight) counts it in channel c as if transmittances were those of the coarse field. They are not:
//! what is missing is
//!
//! ```text
//! (T_c / T_h) / e^{-(tau~_c - tau~_h)}
//! ```
//!
//! over the way flown, of which an estimate by other points of that way, given its ends, is unbiased.

mod channels;
pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{ImmersionColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::{EstimateColumns, SurfaceHitQueue};
use crate::columns::{Column, Spectrum};
use crate::lanes::LaneSet;
use crate::media::field::Field;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The field that the flights are in.
    pub field: &'a Field,
    /// The paths that go on.
    pub live: &'a LaneSet<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: hero.
    pub immersion: &'a ImmersionColumns<'q>,
    /// Read: the flights.
    pub flight: &'a Column<'q, f32>,
    /// Read: the surfaces that end some of them, and how far away they are.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read: where the flights start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: their direction.
    pub ray: &'a RayColumns<'q>,
    /// Scratch, by lane.
    pub estimates: &'a mut EstimateColumns<'q>,
    /// Multiplied by what is missing.
    pub throughput: &'a mut Spectrum<'q>,
}

/// Multiplies the throughput of all live paths by `T'_c e^{tau~_c}` for extinctions less that of the hero, estimated with
/// [stream](crate::random::Stream) 1 of the block `TRACKING` at the depth of the vertex before.
pub type Kernel = fn(Step, Columns<'_, '_>);
