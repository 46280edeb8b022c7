//! The vertices of eight candidates from which connections may start.

use wide::{f32x8, u32x8};

use crate::columns::paths::{LastSurfaceColumns, PathColumns};
use crate::lanes::LANES;
use crate::survival::LogSurvival;
use crate::{Step, WalkLimits, lanes};

/// Which vertices of eight candidates may start a connection. Starts are counted from the light: the vertex at depth
/// `i` of a path of `n` segments is start `n - i`.
#[derive(Clone, Copy)]
pub(super) struct Starts {
    /// Segments of each path.
    pub segments: u32x8,
    /// First start, counted from the light, that is not too far along the walk.
    fewest_edges: u32x8,
    /// Last start, counted from the light; 0 in dead rows.
    pub most_edges: u32x8,
    /// Rows of which the last start is on a surface.
    pub surface: f32x8,
    /// Rows in use.
    pub live: f32x8,
}

impl Starts {
    /// Those of the paths in eight lanes, of which `rows` are in use, with `inserted` vertices after the current one:
    /// behind the last surface, and as many as connect.
    #[inline(always)]
    pub fn new(
        lane_of: &[u32; LANES],
        rows: u32,
        inserted: usize,
        paths: &PathColumns<'_>,
        last_surface: &LastSurfaceColumns<'_>,
        walk: &WalkLimits,
        step: Step,
    ) -> Self {
        let segments = u32x8::splat(step.clock + inserted as u32 + 1) - paths.birth.gather(lane_of);
        let last_surface = last_surface.depth.gather(lane_of);
        let surface = lanes::as_mask(last_surface.simd_gt(u32x8::splat(0)));
        let first = last_surface.max(u32x8::splat(1));
        let live = lanes::mask(rows);
        let most_edges = segments.saturating_sub(first) & lanes::as_integer_mask(live);
        let fewest_edges = most_edges.saturating_sub(u32x8::splat(walk.starts - 1)).max(u32x8::splat(1));
        Self { segments, fewest_edges, most_edges, surface, live }
    }

    /// The fewest edges to the light from a start of any row.
    #[inline(always)]
    pub fn fewest_edges(&self) -> usize {
        lanes::as_integer_mask(self.live).select(self.fewest_edges, u32x8::splat(u32::MAX)).reduce_min().max(1) as usize
    }

    /// The fewest edges to the light from a start on a surface; more than any path has if there is none.
    #[inline(always)]
    pub fn first_on_surface(&self) -> usize {
        let on_surface = lanes::as_integer_mask(self.surface & self.live);
        on_surface.select(self.most_edges, u32x8::splat(u32::MAX)).reduce_min().max(1) as usize
    }

    /// The most edges to the light from a start of any row.
    #[inline(always)]
    pub fn most_edges(&self) -> usize {
        self.most_edges.reduce_max() as usize
    }

    /// Rows of which vertex `a` may start a connection.
    #[inline(always)]
    pub fn eligible(&self, a: usize) -> f32x8 {
        let a = u32x8::splat(a as u32);
        lanes::as_mask(self.most_edges.simd_ge(a) & self.fewest_edges.simd_le(a))
    }

    /// Probability that a walk gets to the light by itself: 0 where it ends before.
    #[inline(always)]
    pub fn reach_of_walk(&self, survival: LogSurvival<'_>, walk: &WalkLimits) -> f32x8 {
        let walks = lanes::as_mask(self.segments.simd_le(u32x8::splat(walk.segments)));
        walks.select(survival.reach(self.segments), f32x8::ZERO)
    }

    /// Depth of vertex `a`.
    #[inline(always)]
    pub fn depth(&self, a: usize) -> u32x8 {
        self.segments - u32x8::splat(a as u32)
    }
}
