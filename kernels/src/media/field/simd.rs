//! ```text
//! segment in cells: p + t v, t in [0, 1];     [t0, t1] = its part within a box a little larger than that of all cells
//! n = ceil(|v| (t1 - t0)), at most 64
//! tau~ = length ((t1 - t0) / n * sum_{i < n} mean(p + (t0 + (i + 1/2) / n (t1 - t0)) v) + (1 - (t1 - t0)) mu_around)
//! ```
//!
//! 1. Lanes with fewer points wait for those with more.
//! 2. A segment and its reverse have the same points, but for rounding.
//! 3. In a coloured field, everything is that of one channel times its hue.

use wide::{f32x8, u32x8};

use super::Field;
use crate::media::lanes::Crowding;
use crate::media::spectral::CHANNELS;
use crate::media::{MediumLanes, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3x8::Vec3x8;

/// Most points at which the coarse field is asked along a segment.
pub const MOST_POINTS: f32 = 64.0;

/// By how many cells the box is larger in which points are spread. From one face of the grid itself to the other they
/// would fall on borders of cells, where which cell they are in is a matter of rounding.
pub const BELOW: f32 = 0.271_828;
/// The same at the upper faces.
pub const ABOVE: f32 = 0.314_159;

/// Least optical depth of a segment: quotients of depths stay finite.
const LEAST_DEPTH: f32 = 1e-9;

/// A field of the same extinction in all channels.
#[derive(Clone, Copy)]
pub struct FieldLanes<'a>(&'a Field);

/// A field of coloured extinction, before it is known which channel counts for each row.
#[derive(Clone, Copy)]
pub struct ColouredFieldLanes<'a>(&'a Field);

/// A field in one channel per row.
#[derive(Clone, Copy)]
pub struct FieldX8<'a> {
    field: &'a Field,
    /// Extinction over that of the field.
    hue: f32x8,
}

impl<'a> FieldLanes<'a> {
    /// Those of a grey `field`.
    #[inline(always)]
    pub fn new(field: &'a Field) -> Self {
        Self(field)
    }
}

impl<'a> MediumLanes for FieldLanes<'a> {
    type Channel = FieldX8<'a>;

    const COLOURED: bool = false;

    #[inline(always)]
    fn in_channel(&self, _: impl FnOnce() -> u32x8) -> FieldX8<'a> {
        self.own()
    }

    #[inline(always)]
    fn own(&self) -> FieldX8<'a> {
        FieldX8::of(self.0)
    }

    fn hues(&self) -> [f32; CHANNELS] {
        [1.0; CHANNELS]
    }
}

impl<'a> ColouredFieldLanes<'a> {
    /// Those of a coloured `field`.
    #[inline(always)]
    pub fn new(field: &'a Field) -> Self {
        Self(field)
    }
}

impl<'a> MediumLanes for ColouredFieldLanes<'a> {
    type Channel = FieldX8<'a>;

    const COLOURED: bool = true;

    #[inline(always)]
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> FieldX8<'a> {
        let hues = self.0.hues;
        let hue = f32x8::new(channel().to_array().map(|channel| hues[(channel as usize).min(CHANNELS - 1)]));
        FieldX8 { field: self.0, hue }
    }

    #[inline(always)]
    fn own(&self) -> FieldX8<'a> {
        FieldX8::of(self.0)
    }

    fn hues(&self) -> [f32; CHANNELS] {
        self.0.hues
    }
}

impl MediumX8 for FieldX8<'_> {
    const VARIES: bool = true;

    #[inline(always)]
    fn mean_free_path(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        length / self.optical_depth(from, to, length)
    }

    #[inline(never)]
    fn optical_depth(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        let field = self.field;
        let (start, end) = (field.in_cells(from), field.in_cells(to));
        let way = end - start;
        let [enter, exit] = within(start, way, [-BELOW; 3], field.cells.dims.map(|dim| dim as f32 + ABOVE), f32x8::ONE);
        let part = (exit - enter).fast_max(f32x8::ZERO);
        let crossed = way.length_squared().sqrt() * part;
        let points = crossed.ceil().fast_max(f32x8::ONE).fast_min(f32x8::splat(MOST_POINTS));
        let stride = part / points;
        let most = points.to_array().into_iter().fold(0.0, f32::max) as u32;
        let inside = part.simd_gt(f32x8::ZERO);
        let mut sum = f32x8::ZERO;
        for i in 0..if inside.any() { most } else { 0 } {
            let index = f32x8::splat(i as f32);
            let t = stride.mul_add(index + f32x8::splat(0.5), enter);
            let counts = inside & index.simd_lt(points);
            sum += counts.select(field.mean_at(way.mul_add(t, start)), f32x8::ZERO);
        }
        let around = f32x8::splat(field.around) * (f32x8::ONE - part);
        let depth = sum.mul_add(stride, around) * length * self.hue;
        depth.fast_max(f32x8::splat(LEAST_DEPTH))
    }

    #[inline(always)]
    fn optical_depth_along(self, _: f32x8, summed: f32x8) -> f32x8 {
        summed * self.hue
    }

    #[inline(always)]
    fn over_clearest(self) -> f32x8 {
        self.hue * f32x8::splat(1.0 / self.field.clearest())
    }

    #[inline(always)]
    fn extinction(self, at: Vec3x8) -> f32x8 {
        self.field.extinction(at) * self.hue
    }

    #[inline(always)]
    fn crowding(self, edges: usize, arc: f32x8, depth: f32x8, log_extinction: f32x8) -> Crowding {
        // Extinctions count without hue, and the depth with it: one hue of all too many is left.
        let log = f32x8::splat(-(edges as f32)) * neg_ln(depth / (arc * self.hue)) - log_extinction;
        Crowding { log, scale: self.hue }
    }

    #[inline(always)]
    fn log_seeds(self, seeds: usize, mean_free_path: f32x8, log_extinction: f32x8) -> f32x8 {
        if seeds == 0 {
            return f32x8::ZERO;
        }
        f32x8::splat(seeds as f32) * neg_ln(mean_free_path * self.hue) - log_extinction
    }
}

impl<'a> FieldX8<'a> {
    /// A `field` in the channel in which its extinction is largest.
    #[inline(always)]
    pub fn of(field: &'a Field) -> Self {
        Self { field, hue: f32x8::ONE }
    }
}

impl Field {
    /// Mean extinction of the cells that points, in cells, are in [1/m].
    #[inline(always)]
    fn mean_at(&self, at: Vec3x8) -> f32x8 {
        let all = self.cells.all();
        f32x8::new(self.cells_at(at).to_array().map(|cell| all[cell as usize].mean))
    }
}

/// The part of `start + t way`, t in [0, `end`], within a box; empty where the second is not larger.
#[inline(always)]
pub fn within(start: Vec3x8, way: Vec3x8, low: [f32; 3], high: [f32; 3], end: f32x8) -> [f32x8; 2] {
    let (mut enter, mut exit) = (f32x8::ZERO, end);
    let axes = [(start.x, way.x), (start.y, way.y), (start.z, way.z)];
    for (((origin, step), low), high) in axes.into_iter().zip(low).zip(high) {
        // Along an axis, a way that does not move is either inside all the time or never: +-inf do as they should, and
        // the NaN of a start on the very boundary is moved off it.
        let step = step.simd_eq(f32x8::ZERO).select(f32x8::splat(1e-30), step);
        let inverse = f32x8::ONE / step;
        let (a, b) = ((f32x8::splat(low) - origin) * inverse, (f32x8::splat(high) - origin) * inverse);
        (enter, exit) = (enter.fast_max(a.fast_min(b)), exit.fast_min(a.fast_max(b)));
    }
    [enter, exit]
}
