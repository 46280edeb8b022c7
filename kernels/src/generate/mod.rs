//! Camera rays for the lanes that are to be refilled.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{PathTable, RayTable, VertexTable};
use crate::columns::queues::RequestTable;
use crate::tables::camera::Camera;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// Lanes to fill, and with which sample of which pixel.
    pub requests: &'a RequestTable<'q>,
    /// Filled: every column; the lane becomes live and occupied.
    pub paths: &'a mut PathTable<'q>,
    /// Filled: the camera vertex, in the slot of the clock: position on the near plane.
    pub vertices: &'a mut VertexTable<'q>,
    /// Filled: the camera ray, in the slot of the clock.
    pub rays: &'a mut RayTable<'q>,
}

/// Makes the first ray of every requested path.
///
/// A sample's place in its pixel is uniform (box filter). Paths start on the plane at distance `near` along the viewing
/// axis.
pub type Kernel = fn(&Camera, Step, Columns<'_, '_>);
