//! The end of walks that have come far enough, or cannot turn.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::PathColumns;
use crate::columns::queues::FlightTable;
use crate::lanes::LaneSet;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Segments after which walks end, >= 1.
    pub segments: u32,
    /// Whether the medium turns light; if not, only paths that met a surface go on.
    pub scatters: bool,
    /// Read: the flight.
    pub flights: &'a FlightTable<'q>,
    /// The paths that met a surface.
    pub on_surface: &'a LaneSet<'q>,
    /// Read: birth.
    pub paths: &'a PathColumns<'q>,
    /// Paths that end are removed.
    pub live: &'a mut LaneSet<'q>,
}

/// Ends the paths whose current segment, number `depth + 1`, is the last one that is asked for, those that would scatter
/// where nothing does, and those that fly on for ever.
pub type Kernel = fn(Step, Columns<'_, '_>);
