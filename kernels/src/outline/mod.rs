//! More rays through pixels that outlines of lamps pass through.
//!
//! Where a sample of such a pixel sees its lamps directly, it does so by [`LOOKS`] rays, each through a cell of its own of
//! the pixel, and each counts one part of as many: the variance of what is seen falls by far more than their number, since
//! most cells are on one side of the outline. The path of the sample goes on from one further ray, which sees no lamps.

pub mod reference;
pub mod simd;

use crate::Step;
use crate::columns::paths::{RayColumns, VertexColumns};
use crate::columns::queues::RequestColumns;
use crate::lanes::LaneSet;
use crate::tables::camera::Camera;

/// Cells of a pixel along either side.
pub const SIDE: u32 = 4;

/// Rays of a sample through a pixel of an outline.
pub const LOOKS: u32 = SIDE * SIDE;

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The camera.
    pub camera: &'a Camera,
    /// The cell that is looked through, below [`LOOKS`], row by row.
    pub cell: u32,
    /// Samples of pixels of outlines.
    pub outlined: &'a LaneSet<'q>,
    /// Read: which sample of which pixel each of them is.
    pub requests: &'a RequestColumns<'q>,
    /// Filled: where the ray starts.
    pub vertex: &'a mut VertexColumns<'q>,
    /// Filled: its direction.
    pub ray: &'a mut RayColumns<'q>,
}

/// Makes a camera ray through one cell of the pixels of all outlined lanes, at a place that is uniform in the cell.
pub type Kernel = fn(Step, Columns<'_, '_>);
