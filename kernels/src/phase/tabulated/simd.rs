//! Tabulated phase functions for eight rows.
//!
//! ```text
//! x = 1 - cosine, rows (x_i, f_i, v_i),  v_i the share of events with a smaller x
//! x(v)       = x_i + k (x_(i+1) - x_i),   v_i < v <= v_(i+1),  m = (v - v_i) / (v_(i+1) - v_i)
//! k          = m (a + b) / (a + sqrt((1 - m) a^2 + m b^2)),    a = f_i,  b = f_(i+1)
//! density(x) = (1 - k) f_i + k f_(i+1),   x_i < x <= x_(i+1),  k = (x - x_i) / (x_(i+1) - x_i)
//! ```
//!
//! Departures from the textbook:
//! 1. Rows descend from the cosine 1 and hold `x = 1 - c`, rounded from f64: a forward peak is resolved to angles far
//!    below those of which the cosine is 1 in f32. `v = 1 - u` is exact, `x = |out - in|^2 / 2`.
//! 2. The interval is found bit by bit, in as many steps for all lanes, in columns that end in infinities up to a power
//!    of two. What is compared is strictly ordered, so that an interval of no width or no share is never found.
//! 3. The quadratic is solved in the form that does not cancel. Next to a zero of the table f_i is 0 and so is m at its
//!    end: the denominator is kept above zero.
//! 4. One over a density below 2^-60 is 2^60.

use wide::{f32x8, u32x8};

use super::{LARGEST_INVERSE_DENSITY, Tabulated};
use crate::phase::reference::Phase;
use crate::phase::{Deflection, HenyeyGreensteinX8, PhaseX8};
use crate::vec3::Vec3x8;

/// Cosines of the forward hemisphere are at least this.
const SMALLEST_COSINE: f32 = 6e-8;

/// A table as kernels read it: rows from x = 0 to x = 2, filled up to a power of two.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// 1 - cosine, then infinities
    x: Box<[f32]>,
    /// share of events with a smaller x, from 0 to 1, then infinities
    above: Box<[f32]>,
    /// phase function [1/sr], then zeros
    density: Box<[f32]>,
    /// share of the events with x < 1
    forward: f32,
}

impl Columns {
    /// From rows (cosine, phase function) that ascend from -1 to 1.
    pub fn new(rows: &[(f64, f64)]) -> Self {
        let size = rows.len().next_power_of_two();
        let column = |filler: f32, of: &mut dyn FnMut(usize) -> f64| -> Box<[f32]> {
            (0..size).map(|i| if i < rows.len() { of(i) as f32 } else { filler }).collect()
        };
        let row = |i: usize| {
            let (cosine, density) = rows[rows.len() - 1 - i];
            (1.0 - cosine, density)
        };
        let (mut sum, mut forward) = (0.0, 0.0);
        let mut add = |i: usize| {
            if i > 0 {
                let ((x0, f0), (x1, f1)) = (row(i - 1), row(i));
                let share_until = |x: f64| {
                    let f = f0 + (f1 - f0) * (x - x0) / (x1 - x0);
                    core::f64::consts::PI * (f0 + f) * (x - x0)
                };
                if x0 < 1.0 {
                    forward = sum + share_until(x1.min(1.0));
                }
                sum += share_until(x1);
            }
            if i + 1 < rows.len() { f64::min(sum, 1.0) } else { 1.0 }
        };
        let above = column(f32::INFINITY, &mut add);
        Self {
            x: column(f32::INFINITY, &mut |i| row(i).0),
            above,
            density: column(0.0, &mut |i| row(i).1),
            forward: forward as f32,
        }
    }
}

/// The values of a column in some rows.
#[inline(always)]
fn gather(column: &[f32], rows: u32x8) -> f32x8 {
    f32x8::new(rows.to_array().map(|row| column[row as usize]))
}

/// The last row with a value below `value`, or the first, and the row after it.
#[inline(always)]
fn find(column: &[f32], value: f32x8) -> [u32x8; 2] {
    let mut row = u32x8::ZERO;
    let mut bit = column.len() as u32 / 2;
    while bit > 0 {
        let next = row | u32x8::splat(bit);
        let below: u32x8 = bytemuck::cast(gather(column, next).simd_lt(value));
        row |= below & u32x8::splat(bit);
        bit /= 2;
    }
    [row, row + u32x8::splat(1)]
}

/// A [`Tabulated`] phase function for eight lanes.
#[derive(Clone, Copy)]
pub struct TabulatedX8<'t> {
    columns: &'t Columns,
    forward: f32x8,
    lobe: HenyeyGreensteinX8,
}

impl<'t> TabulatedX8<'t> {
    /// Prepares `phase` for eight lanes.
    pub fn new(phase: &'t Tabulated) -> Self {
        let columns = &phase.columns;
        Self { columns, forward: f32x8::splat(columns.forward), lobe: HenyeyGreensteinX8::new(phase.lobe()) }
    }

    /// `1 - cosine` that a share `v` of all events, in (0, 1), has between it and 0.
    #[inline(always)]
    fn pole_distance(&self, v: f32x8) -> f32x8 {
        let rows = find(&self.columns.above, v);
        let [x0, x1] = rows.map(|row| gather(&self.columns.x, row));
        let [v0, v1] = rows.map(|row| gather(&self.columns.above, row));
        let [a, b] = rows.map(|row| gather(&self.columns.density, row));
        let m = (v - v0) / (v1 - v0);
        let root = (m * b).mul_add(b, (f32x8::ONE - m) * a * a).sqrt();
        let k = m * (a + b) / (a + root).fast_max(f32x8::splat(f32::MIN_POSITIVE));
        k.fast_min(f32x8::ONE).mul_add(x1 - x0, x0)
    }
}

#[inline(always)]
fn deflection(x: f32x8) -> Deflection {
    Deflection { cosine: f32x8::ONE - x, sine: (x * (f32x8::splat(2.0) - x)).sqrt() }
}

impl PhaseX8 for TabulatedX8<'_> {
    #[inline(always)]
    fn sample(&self, u: f32x8) -> Deflection {
        deflection(self.pole_distance(f32x8::ONE - u))
    }

    #[inline(always)]
    fn sample_forward(&self, u: f32x8) -> Deflection {
        let x = self.pole_distance((f32x8::ONE - u) * self.forward);
        deflection(x.fast_min(f32x8::splat(1.0 - SMALLEST_COSINE)))
    }

    #[inline(always)]
    fn forward_share(&self) -> f32x8 {
        self.forward
    }

    #[inline(always)]
    fn inverse_shape(&self, incoming: Vec3x8, outgoing: Vec3x8) -> f32x8 {
        let half = f32x8::splat(0.5);
        let x = ((outgoing - incoming).length_squared() * half).fast_min(f32x8::splat(2.0));
        let rows = find(&self.columns.x, x);
        let [x0, x1] = rows.map(|row| gather(&self.columns.x, row));
        let [a, b] = rows.map(|row| gather(&self.columns.density, row));
        let k = (x - x0) / (x1 - x0);
        let density = k.mul_add(b, (f32x8::ONE - k) * a);
        f32x8::ONE / density.fast_max(f32x8::splat(LARGEST_INVERSE_DENSITY.recip()))
    }

    #[inline(always)]
    fn lobe(&self) -> HenyeyGreensteinX8 {
        self.lobe
    }
}
