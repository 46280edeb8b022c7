//! First flights that were drawn from another density: what they count goes to the throughput.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::{Column, Spectrum};
use crate::lanes::LaneSet;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lanes that have just left the camera.
    pub requested: &'a LaneSet<'q>,
    /// The paths that go on.
    pub live: &'a LaneSet<'q>,
    /// Read for requested lanes: density of the free flight over that of the one that was taken, or probability over
    /// probability where a surface ended it.
    pub weight: &'a Column<'q, f32>,
    /// Multiplied by the weight where a path was requested and goes on, in the channels in use.
    pub throughput: &'a mut Spectrum<'q>,
}

/// Multiplies the throughput by the weight of the [first flight](crate::first_flight). Lights that the camera sees
/// directly were counted before: they do not depend on the flight.
pub type Kernel = fn(Step, Columns<'_, '_>);
