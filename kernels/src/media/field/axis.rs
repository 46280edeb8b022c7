//! A segment through the coarse field.
//!
//! ```text
//! segment in cells: p + t v, t in [0, 1];     [t0, t1] = its part within a box a little larger than that of all cells
//! n = ceil(|v| (t1 - t0)), at most 16: so many strata of it, each with the mean of the cell at its middle; 1 where all
//!     of it is known to have one extinction
//! tau~ = length ((t1 - t0) / n * sum_{i < n} mean(p + (t0 + (i + 1/2) / n (t1 - t0)) v) + (1 - (t1 - t0)) mu_around)
//! ```
//!
//! 1. Lanes with fewer strata wait for those with more. A lane that is known to be too deep for what is asked does not go
//!    on.
//! 2. A segment and its reverse have the same strata, but for rounding.
//! 3. Before the first stratum and behind the last is what is around; behind the last it has no end, so that every
//!    depth is somewhere.
//! 4. A ray is a segment of the length of its direction, 1 m, of which shares may be larger than 1: its strata are over
//!    all of its part within the box.

use wide::f32x8;

use super::Field;
use super::cells::Lookup;
use crate::media::AxisX8;
use crate::vec3::Vec3x8;

/// Most strata of a segment.
pub const MOST_STRATA: f32 = 16.0;

/// By how many cells that box is larger at the lower faces. From one face of the grid itself to the other their middles
/// would fall on borders of cells, where which cell they are in is a matter of rounding.
pub const BELOW: f32 = 0.271_828;
/// The same at the upper faces.
pub const ABOVE: f32 = 0.314_159;

/// Least optical depth of a segment: quotients of depths stay finite.
pub const LEAST_DEPTH: f32 = 1e-9;

/// Most optical depth that weights count for a segment of which it is not known, in the channel in which it is largest:
/// `e^depth`, by which estimates are multiplied, stays a number. Behind so much there is no light, if it is there. Other
/// channels, in which there may be, count their multiples of it, as estimates take them for that.
pub const MOST_DEPTH: f32 = 60.0;

/// By how much the means must exceed a depth, for rounding, to be known to be more.
const SLACK: f32 = 1.001;

/// Strata after which it is asked whether that is known.
const AT_ONCE: u32 = 4;

/// Least extinction of what a flight is in that ends [1/m]: in vacuum it ends beyond everything.
const LEAST_EXTINCTION: f32 = 1e-30;

/// Eight segments, each in one channel, and how far seeds have got on them.
#[derive(Clone, Copy)]
pub struct FieldAxis<'a> {
    field: &'a Field,
    /// Extinction over that of the field.
    hue: f32x8,
    /// Length `[m]`.
    length: f32x8,
    /// The means of the cells.
    cells: Lookup<'a>,
    /// Where it begins, in cells from the first of those around on.
    start: Vec3x8,
    /// From there to its end, in cells.
    way: Vec3x8,
    /// Where the first stratum begins, as a share of the length.
    enter: f32x8,
    /// Length of a stratum, as a share of the length.
    stride: f32x8,
    /// How many there are.
    strata: f32x8,
    /// Where all of the segment is in the even part of the field.
    even: f32x8,
    /// The stratum reached: -1 before the first.
    reached: f32x8,
    /// The place reached, as a share of the length.
    place: f32x8,
}

impl<'a> FieldAxis<'a> {
    /// From `from` to `to`, of this `length` `[m]`.
    #[inline(always)]
    pub fn new(field: &'a Field, hue: f32x8, from: Vec3x8, to: Vec3x8, length: f32x8) -> Self {
        let (start, end) = (field.in_cells(from), field.in_cells(to));
        Self::until(field, hue, start, end - start, length, f32x8::ONE)
    }

    /// From `from` on in the unit `direction`.
    #[inline(always)]
    pub fn ray(field: &'a Field, hue: f32x8, from: Vec3x8, direction: Vec3x8) -> Self {
        let (start, way) = (field.in_cells(from), field.to_cells.directions(direction));
        Self::until(field, hue, start, way, f32x8::ONE, f32x8::splat(f32::INFINITY))
    }

    /// From `start` on along `way`, both in cells, of this `length` `[m]`, with strata up to the share `end` of it.
    #[inline(always)]
    fn until(field: &'a Field, hue: f32x8, start: Vec3x8, way: Vec3x8, length: f32x8, end: f32x8) -> Self {
        let [enter, exit] = match &field.one {
            Some(shape) => shape.part(start, way, end),
            None => within(start, way, [-BELOW; 3], field.cells.dims().map(|dim| dim as f32 + ABOVE), end),
        };
        let part = (exit - enter).fast_max(f32x8::ZERO);
        let crossed = way.length_squared().sqrt() * part;
        let inside = part.simd_gt(f32x8::ZERO);
        let even = field.in_even_part(start, way.mul_add(end, start));
        let most = if field.is_known() { f32x8::ONE } else { even.select(f32x8::ONE, f32x8::splat(MOST_STRATA)) };
        let strata = crossed.ceil().fast_max(f32x8::ONE).fast_min(most);
        Self {
            field,
            hue,
            length,
            cells: field.cells.lookup(),
            start: start + Vec3x8::splat([1.0; 3]),
            way,
            enter: inside.select(enter, f32x8::ZERO),
            stride: part / strata,
            strata: inside.select(strata, f32x8::ZERO),
            even,
            reached: f32x8::splat(-1.0),
            place: f32x8::ZERO,
        }
    }

    /// Mean extinction in stratum `index`, where the hue is 1 [1/m].
    #[inline(always)]
    fn mean(&self, index: f32x8) -> f32x8 {
        let inside = index.simd_ge(f32x8::ZERO) & index.simd_lt(self.strata);
        let mean = match &self.field.one {
            Some(shape) => f32x8::splat(shape.extinction),
            None => self.mean_of_cell(index),
        };
        inside.select(mean, f32x8::splat(self.field.around))
    }

    /// Mean extinction of the cell in the middle of stratum `index`, where there is such a stratum [1/m].
    #[inline(always)]
    fn mean_of_cell(&self, index: f32x8) -> f32x8 {
        let middle = self.stride.mul_add(index + f32x8::HALF, self.enter);
        self.cells.at(self.way.mul_add(middle, self.start))
    }

    /// Sum of the means of all strata, as far as the depth is not known to be more than `most`; each of them goes to
    /// `term`, too, as (index, mean), with a mean of 0 in lanes that have come to their end.
    #[inline(always)]
    fn sum(&self, most: f32x8, term: impl FnMut(f32x8, f32x8)) -> f32x8 {
        match &self.field.one {
            Some(shape) => self.sum_of(|_| f32x8::splat(shape.extinction), most, term),
            None => self.sum_of(|index| self.mean_of_cell(index), most, term),
        }
    }

    /// The same with what a `mean` is, by index of the stratum.
    #[inline(always)]
    fn sum_of(&self, mean: impl Fn(f32x8) -> f32x8, most: f32x8, mut term: impl FnMut(f32x8, f32x8)) -> f32x8 {
        let enough = f32x8::splat(SLACK) * most / (self.stride * self.length * self.hue);
        let last = self.strata.to_array().into_iter().fold(0.0, f32::max) as u32;
        let (mut strata, mut index, mut sum) = (self.strata, f32x8::ZERO, f32x8::ZERO);
        for i in 0..last {
            if i % AT_ONCE == AT_ONCE - 1 {
                strata = sum.simd_le(enough).select(strata, f32x8::ZERO);
                if !index.simd_lt(strata).any() {
                    break;
                }
            }
            let mean = index.simd_lt(strata).select(mean(index), f32x8::ZERO);
            term(index, mean);
            sum += mean;
            index += f32x8::ONE;
        }
        sum
    }

    /// The optical depth of all of it, where the means add up to `sum`.
    #[inline(always)]
    fn whole(&self, sum: f32x8) -> f32x8 {
        let around = f32x8::splat(self.field.around) * (f32x8::ONE - self.stride * self.strata);
        let depth = sum.mul_add(self.stride, around) * self.length * self.hue;
        depth.fast_max(f32x8::splat(LEAST_DEPTH))
    }

    /// Ends a flight in the stratum reached, where so much of its depth, over length and hue, is left.
    #[inline(always)]
    fn land(&mut self, left: f32x8) {
        self.place += left / self.mean(self.reached).fast_max(f32x8::splat(LEAST_EXTINCTION));
    }

    /// Where the strata end, as a share of the length.
    #[inline(always)]
    fn exit(&self) -> f32x8 {
        self.stride.mul_add(self.strata, self.enter)
    }
}

impl AxisX8 for FieldAxis<'_> {
    const VARIES: bool = true;

    #[inline(never)]
    fn depth(&self, most: f32x8) -> f32x8 {
        self.whole(self.sum(most, |_, _| ()))
    }

    #[inline(never)]
    fn depths(&self, along: f32x8, most: f32x8) -> [f32x8; 2] {
        let place = along / self.length;
        let passed = (place - self.enter) / self.stride;
        let mut part = f32x8::ZERO;
        let whole = self.sum(most, |index, mean| {
            part += mean * (passed - index).fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
        });
        let outside = place.fast_min(self.enter) + (place - self.exit()).fast_max(f32x8::ZERO);
        let outside = self.strata.simd_eq(f32x8::ZERO).select(place, outside);
        let until = part.mul_add(self.stride, f32x8::splat(self.field.around) * outside) * self.length * self.hue;
        [until, self.whole(whole)]
    }

    #[inline(always)]
    fn extinction(&self, along: f32x8) -> f32x8 {
        self.mean(((along / self.length - self.enter) / self.stride).floor()) * self.hue
    }

    #[inline(never)]
    fn advance(&mut self, depth: f32x8) -> f32x8 {
        let from = self.place;
        let mut left = depth / (self.length * self.hue);
        loop {
            let next = self.reached + f32x8::ONE;
            let room = self.mean(self.reached) * (self.stride.mul_add(next, self.enter) - self.place);
            let passes = left.simd_ge(room) & self.reached.simd_lt(self.strata);
            if !passes.any() {
                break;
            }
            left -= passes.select(room, f32x8::ZERO);
            self.place = passes.select(self.stride.mul_add(next, self.enter), self.place);
            self.reached = passes.select(next, self.reached);
        }
        self.land(left);
        (self.place - from) * self.length
    }

    #[inline(never)]
    fn first_advance(&mut self, depth: f32x8, most: f32x8) -> [f32x8; 2] {
        // As `advance` to the bit, while the means that are looked up are added up, also behind the place reached.
        let mut left = depth / (self.length * self.hue);
        let before = f32x8::splat(self.field.around) * self.enter;
        let mut flies = left.simd_ge(before);
        left -= flies.select(before, f32x8::ZERO);
        let mut axis = *self;
        axis.place = flies.select(self.enter, f32x8::ZERO);
        axis.reached = flies.select(f32x8::ZERO, f32x8::splat(-1.0));
        let sum = self.sum(most, |index, mean| {
            let next = index + f32x8::ONE;
            let end = self.stride.mul_add(next, self.enter);
            let room = mean * (end - axis.place);
            flies &= left.simd_ge(room) & index.simd_lt(self.strata);
            left -= flies.select(room, f32x8::ZERO);
            axis.place = flies.select(end, axis.place);
            axis.reached = flies.select(next, axis.reached);
        });
        axis.land(left);
        *self = axis;
        [self.place * self.length, self.whole(sum)]
    }

    #[inline(always)]
    fn reached(&self) -> f32x8 {
        self.mean(self.reached) * self.hue
    }

    #[inline(always)]
    fn even(&self) -> (f32x8, f32x8) {
        let extinction = self.field.even.as_ref().map_or(0.0, |even| even.extinction);
        (self.even, f32x8::splat(extinction) * self.hue)
    }
}

impl Field {
    /// Where both of two points, in cells, are in the even part.
    #[inline(always)]
    pub(super) fn in_even_part(&self, start: Vec3x8, end: Vec3x8) -> f32x8 {
        self.even.as_ref().map_or(f32x8::ZERO, |even| even.holds(start) & even.holds(end))
    }
}

/// The part of `start + t way`, t in [0, `end`], within a box; empty where the second is not larger.
#[inline(always)]
pub fn within(start: Vec3x8, way: Vec3x8, low: [f32; 3], high: [f32; 3], end: f32x8) -> [f32x8; 2] {
    let [low, high] = [low, high].map(|[x, y, z]| Vec3x8::new(f32x8::splat(x), f32x8::splat(y), f32x8::splat(z)));
    within_boxes(start, way, [low, high], end)
}

/// The same with a box for each.
#[inline(always)]
pub fn within_boxes(start: Vec3x8, way: Vec3x8, [low, high]: [Vec3x8; 2], end: f32x8) -> [f32x8; 2] {
    let (mut enter, mut exit) = (f32x8::ZERO, end);
    let axes = [(start.x, way.x, low.x, high.x), (start.y, way.y, low.y, high.y), (start.z, way.z, low.z, high.z)];
    for (origin, step, low, high) in axes {
        // Along an axis, a way that does not move is either inside all the time or never: +-inf do as they should, and
        // the NaN of a start on the very boundary is moved off it.
        let step = step.simd_eq(f32x8::ZERO).select(f32x8::splat(1e-30), step);
        let inverse = f32x8::ONE / step;
        let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
        (enter, exit) = (enter.fast_max(a.fast_min(b)), exit.fast_min(a.fast_max(b)));
    }
    [enter, exit]
}
