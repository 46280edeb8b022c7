//! What a flight says of the channel that it was drawn for, where extinction differs between channels.
//!
//! Flights are drawn for the hero of a path, and might have been drawn for any channel, [as likely
//! ](crate::media::spectral) as
//!
//! ```text
//! posterior_c' = posterior_c p_c / P,      T_k' = T_k f_k / P,      P = sum_c posterior_c p_c
//! ```
//!
//! with f_c for the density of a free flight in channel c, over the distance that the path went: `mu_c e^{-tau_c}`
//! where it scatters, and the probability `e^{-tau_c}` where it meets a surface before. The density p_c with which it
//! was drawn is the same, but for [first flights](crate::first_flight) that may be aimed: they have a density, or [the
//! probability to get to a surface](crate::first_surface), of their own.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{RayColumns, VertexColumns};
use crate::columns::queues::SurfaceHitQueue;
use crate::columns::{Column, Spectrum};
use crate::lanes::LaneSet;
use crate::media::Medium;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The medium that the flights are in.
    pub medium: &'a Medium,
    /// The paths that go on.
    pub live: &'a LaneSet<'q>,
    /// Those of them that end on a surface.
    pub on_surface: &'a LaneSet<'q>,
    /// Those whose flights have a density of their own, if any have.
    pub aimed: Option<&'a LaneSet<'q>>,
    /// Read where that is so: it, per channel [1/m], or the probability to get to the surface where they end on one.
    pub density: &'a Spectrum<'q>,
    /// Read: the flights.
    pub flight: &'a Column<'q, f32>,
    /// Read: how far away the surfaces are.
    pub surface_hits: &'a SurfaceHitQueue<'q>,
    /// Read: where the flights start.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: their direction.
    pub ray: &'a RayColumns<'q>,
    /// Read and filled for live paths: ln posterior_c.
    pub log_posterior: &'a mut Spectrum<'q>,
    /// Multiplied by f_k / P.
    pub throughput: &'a mut Spectrum<'q>,
}

/// Takes the flights of all live paths into account. Rows of surface hits whose path is no longer live are filled as
/// well; nothing reads them.
pub type Kernel = fn(Step, Columns<'_, '_>);
