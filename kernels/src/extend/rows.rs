//! A stretch of rays, row by row.

use core::ops::Range;

use crate::Step;
use crate::columns::paths::{PathColumns, RayColumns, VertexColumns};
use crate::columns::{Column, View3};

/// Rays on their way.
pub(super) struct Beams<'a> {
    pub clock: u32,
    pub birth: &'a [u32],
    pub origin: View3<'a, f32>,
    pub direction: View3<'a, f32>,
    pub flight: &'a [f32],
}

impl<'a> Beams<'a> {
    #[inline(always)]
    pub fn new(
        step: Step,
        batches: Range<usize>,
        paths: &'a PathColumns<'_>,
        vertex: &'a VertexColumns<'_>,
        ray: &'a RayColumns<'_>,
        flight: &'a Column<'_, f32>,
    ) -> Self {
        Self {
            clock: step.clock,
            birth: paths.birth.stretch::<f32>(batches.clone()),
            origin: vertex.position.stretch(batches.clone()),
            direction: ray.direction.stretch(batches.clone()),
            flight: flight.stretch::<f32>(batches),
        }
    }

    /// Where the flight of a row ends: nowhere, if it leaves the camera.
    #[inline(always)]
    pub fn end(&self, i: usize) -> f32 {
        if self.birth[i] == self.clock { f32::INFINITY } else { self.flight[i] }
    }
}
