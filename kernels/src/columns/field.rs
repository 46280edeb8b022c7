//! What a field of a [`columns!`](crate::columns!) declaration may be, and how it is stored.

use bumpalo::Bump;
use wide::{f32x8, u32x8};

use super::{Column, Column3};
use crate::lanes;
use crate::lanes::LANES;
use crate::vec3::Vec3x8;

/// A type that a column declaration accepts: `f32`, `u32` or `[f32; 3]`.
pub trait Field: Copy + PartialEq + core::fmt::Debug {
    /// Eight rows of it.
    type Batch: Copy;
    /// Where its rows live.
    type Column<'q>;

    /// A zeroed column with room for `rows` rows.
    fn column<'q>(arena: &'q Bump, rows: usize) -> Self::Column<'q>;
    /// Reads row `row`.
    fn row(column: &Self::Column<'_>, row: usize) -> Self;
    /// Overwrites row `row`.
    fn set_row(column: &mut Self::Column<'_>, row: usize, value: Self);
    /// Overwrites batch `b`.
    fn set_batch(column: &mut Self::Column<'_>, b: usize, batch: Self::Batch);
    /// Stores all eight elements of `batch`, reordered by `order`, at the rows from `at` on.
    fn store_packed(column: &mut Self::Column<'_>, at: usize, order: u32x8, batch: Self::Batch);
    /// Shows every plain column inside to `visit`.
    fn visit(column: &Self::Column<'_>, visit: &mut dyn FnMut(ColumnRef<'_>));
    /// Hands every plain column inside to `visit`.
    fn visit_mut(column: &mut Self::Column<'_>, visit: &mut dyn FnMut(ColumnMut<'_>));
}

/// A column whose type is known at run time only: how tests compare, permute and poison whole tables.
#[derive(Clone, Copy, Debug)]
pub enum ColumnRef<'a> {
    /// Real numbers.
    F32(&'a [f32]),
    /// Indices, counters and bits.
    U32(&'a [u32]),
}

/// As [`ColumnRef`], to change.
#[derive(Debug)]
pub enum ColumnMut<'a> {
    /// Real numbers.
    F32(&'a mut [f32]),
    /// Indices, counters and bits.
    U32(&'a mut [u32]),
}

/// A table or queue as a list of named plain columns; a vector is three columns of one name.
pub trait ColumnSet {
    /// Shows every plain column, with the name of its field, to `visit`.
    fn visit(&self, visit: &mut dyn FnMut(&'static str, ColumnRef<'_>));
    /// Hands every plain column, with the name of its field, to `visit`.
    fn visit_mut(&mut self, visit: &mut dyn FnMut(&'static str, ColumnMut<'_>));
}

impl Field for f32 {
    type Batch = f32x8;
    type Column<'q> = Column<'q, f32>;

    fn column<'q>(arena: &'q Bump, rows: usize) -> Self::Column<'q> {
        Column::new_in(arena, rows)
    }

    #[inline(always)]
    fn row(column: &Self::Column<'_>, row: usize) -> Self {
        column.rows()[row]
    }

    #[inline(always)]
    fn set_row(column: &mut Self::Column<'_>, row: usize, value: Self) {
        column.rows_mut()[row] = value;
    }

    #[inline(always)]
    fn set_batch(column: &mut Self::Column<'_>, b: usize, batch: Self::Batch) {
        column.set_batch(b, batch);
    }

    #[inline(always)]
    fn store_packed(column: &mut Self::Column<'_>, at: usize, order: u32x8, batch: f32x8) {
        let packed = lanes::reorder_f32(batch, order).to_array();
        column.rows_mut()[at..at + LANES].copy_from_slice(&packed);
    }

    fn visit(column: &Self::Column<'_>, visit: &mut dyn FnMut(ColumnRef<'_>)) {
        visit(ColumnRef::F32(column.rows()));
    }

    fn visit_mut(column: &mut Self::Column<'_>, visit: &mut dyn FnMut(ColumnMut<'_>)) {
        visit(ColumnMut::F32(column.rows_mut()));
    }
}

impl Field for u32 {
    type Batch = u32x8;
    type Column<'q> = Column<'q, u32>;

    fn column<'q>(arena: &'q Bump, rows: usize) -> Self::Column<'q> {
        Column::new_in(arena, rows)
    }

    #[inline(always)]
    fn row(column: &Self::Column<'_>, row: usize) -> Self {
        column.rows()[row]
    }

    #[inline(always)]
    fn set_row(column: &mut Self::Column<'_>, row: usize, value: Self) {
        column.rows_mut()[row] = value;
    }

    #[inline(always)]
    fn set_batch(column: &mut Self::Column<'_>, b: usize, batch: Self::Batch) {
        column.set_batch(b, batch);
    }

    #[inline(always)]
    fn store_packed(column: &mut Self::Column<'_>, at: usize, order: u32x8, batch: u32x8) {
        let packed = batch.shuffle(order).to_array();
        column.rows_mut()[at..at + LANES].copy_from_slice(&packed);
    }

    fn visit(column: &Self::Column<'_>, visit: &mut dyn FnMut(ColumnRef<'_>)) {
        visit(ColumnRef::U32(column.rows()));
    }

    fn visit_mut(column: &mut Self::Column<'_>, visit: &mut dyn FnMut(ColumnMut<'_>)) {
        visit(ColumnMut::U32(column.rows_mut()));
    }
}

impl Field for [f32; 3] {
    type Batch = Vec3x8;
    type Column<'q> = Column3<'q>;

    fn column<'q>(arena: &'q Bump, rows: usize) -> Self::Column<'q> {
        Column3::new_in(arena, rows)
    }

    #[inline(always)]
    fn row(column: &Self::Column<'_>, row: usize) -> Self {
        column.row(row)
    }

    #[inline(always)]
    fn set_row(column: &mut Self::Column<'_>, row: usize, value: Self) {
        column.set_row(row, value);
    }

    #[inline(always)]
    fn set_batch(column: &mut Self::Column<'_>, b: usize, batch: Self::Batch) {
        column.set_batch(b, batch);
    }

    #[inline(always)]
    fn store_packed(column: &mut Self::Column<'_>, at: usize, order: u32x8, batch: Vec3x8) {
        f32::store_packed(&mut column.x, at, order, batch.x);
        f32::store_packed(&mut column.y, at, order, batch.y);
        f32::store_packed(&mut column.z, at, order, batch.z);
    }

    fn visit(column: &Self::Column<'_>, visit: &mut dyn FnMut(ColumnRef<'_>)) {
        column.channels().into_iter().for_each(|channel| visit(ColumnRef::F32(channel.rows())));
    }

    fn visit_mut(column: &mut Self::Column<'_>, visit: &mut dyn FnMut(ColumnMut<'_>)) {
        column.channels_mut().into_iter().for_each(|channel| visit(ColumnMut::F32(channel.rows_mut())));
    }
}
