//! Structure-of-arrays storage: a [`Column`] is rows of one quantity, stored and read in batches of
//! [`LANES`].
//!
//! Tables and queues are declared once with [`columns!`](crate::columns!): every field becomes a column, rows are
//! written by field name, and the doc comment of a field is the place for its unit, range, sentinel and measure.
//! All storage comes from one arena per worker, is allocated when the worker starts and never grows.

mod field;
mod macros;
pub mod parts;
pub mod paths;
pub mod queues;
mod spectrum;
pub mod trail;

use core::ops::Range;

use bumpalo::Bump;
use bytemuck::{Pod, Zeroable};
use wide::{f32x8, u32x8};

use crate::lanes::LANES;
use crate::real::Real;
use crate::vec3::{Vec3, Vec3x8};
pub use field::{ColumnMut, ColumnRef, ColumnSet, Field};
pub use spectrum::Spectrum;

/// Lines between neighbouring columns that hold nothing: columns whose distance is a power of two would compete for the
/// same cache sets.
const STAGGER: usize = 3;

/// Two batches, a line of the cache: a column begins with one, so that loads of sixteen rows do not cross from one to
/// the next.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 2 * LANES]);

/// A 4-byte quantity that can be a column: `f32` or `u32`.
pub trait Scalar: Pod + PartialEq + core::fmt::Debug {
    /// Eight of them.
    type Batch: Pod;
    /// As many as `F` has.
    type As<F: Real>: Pod;
}

impl Scalar for f32 {
    type Batch = f32x8;
    type As<F: Real> = F;
}

impl Scalar for u32 {
    type Batch = u32x8;
    type As<F: Real> = F::Word;
}

/// Rows of one quantity in the arena `'q`; the number of rows is a multiple of [`LANES`].
pub struct Column<'q, T: Scalar> {
    batches: &'q mut [T::Batch],
}

impl<'q, T: Scalar> Column<'q, T> {
    /// A zeroed column with room for at least `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize) -> Self {
        let len = rows.div_ceil(LANES);
        let lines = arena.alloc_slice_fill_copy(len.div_ceil(2) + STAGGER, Line::zeroed());
        Self { batches: &mut bytemuck::cast_slice_mut(lines)[..len] }
    }

    /// Its first `batches` batches, to read. Slices cut to one length let a loop over them run without bounds checks.
    #[inline(always)]
    pub fn view(&self, batches: usize) -> &[T::Batch] {
        &self.batches[..batches]
    }

    /// Its first `batches` batches, to fill.
    #[inline(always)]
    pub fn view_mut(&mut self, batches: usize) -> &mut [T::Batch] {
        &mut self.batches[..batches]
    }

    /// The rows of some batches, to read, one by one or eight by eight.
    #[inline(always)]
    pub fn stretch<F: Real>(&self, batches: Range<usize>) -> &[T::As<F>] {
        bytemuck::cast_slice(&self.batches[batches])
    }

    /// The rows of some batches, to fill, one by one or eight by eight.
    #[inline(always)]
    pub fn stretch_mut<F: Real>(&mut self, batches: Range<usize>) -> &mut [T::As<F>] {
        bytemuck::cast_slice_mut(&mut self.batches[batches])
    }

    /// Its rows, to read.
    #[inline(always)]
    pub fn rows(&self) -> &[T] {
        bytemuck::cast_slice(self.batches)
    }

    /// Its rows, to fill.
    #[inline(always)]
    pub fn rows_mut(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(self.batches)
    }

    /// Batch `b`: rows `8 b .. 8 b + 8`.
    #[inline(always)]
    pub fn batch(&self, b: usize) -> T::Batch {
        self.batches[b]
    }

    /// Overwrites batch `b`.
    #[inline(always)]
    pub fn set_batch(&mut self, b: usize, value: T::Batch) {
        self.batches[b] = value;
    }

    /// The rows that `lanes` names, as one batch.
    #[inline(always)]
    pub fn gather(&self, lanes: &[u32; LANES]) -> T::Batch {
        let rows = self.rows();
        bytemuck::cast::<[T; LANES], T::Batch>(lanes.map(|lane| rows[lane as usize]))
    }

    /// Writes the first `count` elements of `batch` to the rows that `lanes` names.
    #[inline(always)]
    pub fn scatter(&mut self, lanes: &[u32; LANES], count: usize, batch: T::Batch)
    where
        [T; LANES]: Pod,
    {
        let values: [T; LANES] = bytemuck::cast(batch);
        let rows = self.rows_mut();
        for (lane, value) in lanes.iter().zip(values).take(count) {
            rows[*lane as usize] = value;
        }
    }
}

/// Rows or batches of three columns, to read.
#[derive(Clone, Copy)]
pub struct View3<'a, F = f32x8> {
    x: &'a [F],
    y: &'a [F],
    z: &'a [F],
}

impl<F: Real> View3<'_, F> {
    /// The first `n` of them.
    #[inline(always)]
    pub fn first(self, n: usize) -> Self {
        Self { x: &self.x[..n], y: &self.y[..n], z: &self.z[..n] }
    }

    /// Row or batch number `i`.
    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec3<F> {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }
}

/// Rows or batches of three columns, to fill.
pub struct ViewMut3<'a, F = f32x8> {
    /// First components.
    pub x: &'a mut [F],
    /// Second components.
    pub y: &'a mut [F],
    /// Third components.
    pub z: &'a mut [F],
}

impl<F: Real> ViewMut3<'_, F> {
    /// Overwrites row or batch number `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, value: Vec3<F>) {
        (self.x[i], self.y[i], self.z[i]) = (value.x, value.y, value.z);
    }
}

impl ViewMut3<'_> {
    /// Overwrites the lanes of batch `b` that are set in `mask`.
    #[inline(always)]
    pub fn blend(&mut self, b: usize, mask: f32x8, value: Vec3x8) {
        self.x[b] = mask.select(value.x, self.x[b]);
        self.y[b] = mask.select(value.y, self.y[b]);
        self.z[b] = mask.select(value.z, self.z[b]);
    }
}

/// Three columns that are the components of one vector, or the channels of one spectrum.
pub struct Column3<'q> {
    /// First component; red.
    pub x: Column<'q, f32>,
    /// Second component; green.
    pub y: Column<'q, f32>,
    /// Third component; blue.
    pub z: Column<'q, f32>,
}

impl<'q> Column3<'q> {
    /// Three zeroed columns with room for at least `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize) -> Self {
        Self { x: Column::new_in(arena, rows), y: Column::new_in(arena, rows), z: Column::new_in(arena, rows) }
    }

    /// Its first `batches` batches, to read.
    #[inline(always)]
    pub fn view(&self, batches: usize) -> View3<'_> {
        View3 { x: self.x.view(batches), y: self.y.view(batches), z: self.z.view(batches) }
    }

    /// Its first `batches` batches, to fill.
    #[inline(always)]
    pub fn view_mut(&mut self, batches: usize) -> ViewMut3<'_> {
        ViewMut3 { x: self.x.view_mut(batches), y: self.y.view_mut(batches), z: self.z.view_mut(batches) }
    }

    /// The rows of some batches, to read, one by one or eight by eight.
    #[inline(always)]
    pub fn stretch<F: Real>(&self, batches: Range<usize>) -> View3<'_, F> {
        View3 {
            x: self.x.stretch::<F>(batches.clone()),
            y: self.y.stretch::<F>(batches.clone()),
            z: self.z.stretch::<F>(batches),
        }
    }

    /// The rows of some batches, to fill, one by one or eight by eight.
    #[inline(always)]
    pub fn stretch_mut<F: Real>(&mut self, batches: Range<usize>) -> ViewMut3<'_, F> {
        ViewMut3 {
            x: self.x.stretch_mut::<F>(batches.clone()),
            y: self.y.stretch_mut::<F>(batches.clone()),
            z: self.z.stretch_mut::<F>(batches),
        }
    }

    /// Row `row`.
    #[inline(always)]
    pub fn row(&self, row: usize) -> [f32; 3] {
        [self.x.rows()[row], self.y.rows()[row], self.z.rows()[row]]
    }

    /// Overwrites row `row`.
    #[inline(always)]
    pub fn set_row(&mut self, row: usize, value: [f32; 3]) {
        for (channel, value) in self.channels_mut().into_iter().zip(value) {
            channel.rows_mut()[row] = value;
        }
    }

    /// Batch `b`.
    #[inline(always)]
    pub fn batch(&self, b: usize) -> Vec3x8 {
        Vec3x8::new(self.x.batch(b), self.y.batch(b), self.z.batch(b))
    }

    /// Overwrites batch `b`.
    #[inline(always)]
    pub fn set_batch(&mut self, b: usize, value: Vec3x8) {
        self.x.set_batch(b, value.x);
        self.y.set_batch(b, value.y);
        self.z.set_batch(b, value.z);
    }

    /// The rows that `lanes` names, as one batch.
    #[inline(always)]
    pub fn gather(&self, lanes: &[u32; LANES]) -> Vec3x8 {
        Vec3x8::new(self.x.gather(lanes), self.y.gather(lanes), self.z.gather(lanes))
    }

    /// Writes the first `count` elements of `batch` to the rows that `lanes` names.
    #[inline(always)]
    pub fn scatter(&mut self, lanes: &[u32; LANES], count: usize, batch: Vec3x8) {
        self.x.scatter(lanes, count, batch.x);
        self.y.scatter(lanes, count, batch.y);
        self.z.scatter(lanes, count, batch.z);
    }

    /// The three columns in order, to read.
    #[inline(always)]
    pub fn channels(&self) -> [&Column<'q, f32>; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// The three columns in order, to fill.
    #[inline(always)]
    pub fn channels_mut(&mut self) -> [&mut Column<'q, f32>; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }
}
