//! The random numbers of connections.

use wide::{f32x8, u32x8};

use crate::columns::paths::{LastSurfaceColumns, PathColumns};
use crate::lanes::LANES;
use crate::random::{self, Purpose, uniform_f32};
use crate::{Step, lanes};

/// What the random numbers of eight connections are drawn from.
pub struct Sequence {
    pixel: u32x8,
    sample: u32x8,
    /// Depths of the starts.
    pub depth: u32x8,
    seed: u32,
}

impl Sequence {
    /// That of connections from the current vertices of the paths in `lane_of`.
    #[inline(always)]
    pub fn new(step: Step, paths: &PathColumns<'_>, lane_of: &[u32; LANES]) -> Self {
        let depth = u32x8::splat(step.clock) - paths.birth.gather(lane_of);
        Self { pixel: paths.pixel.gather(lane_of), sample: paths.sample.gather(lane_of), depth, seed: step.seed }
    }

    /// Starts on a surface.
    #[inline(always)]
    pub fn on_surface(&self, last_surface: &LastSurfaceColumns<'_>, lane_of: &[u32; LANES]) -> f32x8 {
        lanes::as_mask(last_surface.depth.gather(lane_of).simd_eq(self.depth))
    }

    /// Four uniform numbers of block `purpose`.
    #[inline(always)]
    pub fn uniforms(&self, purpose: Purpose) -> [f32x8; 4] {
        let block = random::block(self.depth, purpose);
        random::words(self.pixel, self.sample, block, self.seed).map(uniform_f32)
    }
}

/// The same for one connection, for the twins; each technique names its own numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draws {
    /// Index of the pixel in the whole image.
    pub pixel: u32,
    /// Number of the sample in its pixel.
    pub sample: u32,
    /// Depth of the start.
    pub depth: u32,
    /// Seed of the frame.
    pub seed: u32,
}

impl Draws {
    /// Those of a connection from the current vertex of the path in `lane`.
    pub fn new(step: Step, paths: &PathColumns<'_>, lane: usize) -> Self {
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        Self { pixel, sample, depth: paths.depth_of(step.clock, lane), seed: step.seed }
    }

    /// Four uniform numbers of block `purpose`.
    pub(super) fn uniforms(&self, purpose: Purpose) -> [f64; 4] {
        random::words(self.pixel, self.sample, random::block(self.depth, purpose), self.seed).map(random::uniform)
    }
}
