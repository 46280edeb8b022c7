//! A tabulated phase function: measured, or computed by another program.
//!
//! `phase(c)` [1/sr] is linear in the cosine c between rows of a table. Rows are scaled so that it integrates to one
//! over all directions.

pub mod reference;
mod simd;

pub use simd::TabulatedX8;

use simd::Columns;

use crate::phase::reference::Phase;

/// A phase function that is linear in the cosine between rows.
///
/// Where the table is zero nothing scatters. The twin's density there is zero, and the kernel's inverse density
/// [`LARGEST_INVERSE_DENSITY`]: a path with such a turn gets a weight of next to nothing, and no product becomes NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// Cosine, ascending from -1 to 1, and phase function at it [1/sr].
    rows: Vec<(f64, f64)>,
    /// The same as kernels read it.
    columns: Columns,
}

/// What one over a density of zero is `[sr]`: 2^60, of which three still multiply to a finite number.
pub const LARGEST_INVERSE_DENSITY: f32 = (1_u64 << 60) as f32;

/// The least share of all events that has to be in the forward hemisphere, from which connections draw.
pub const SMALLEST_FORWARD_SHARE: f64 = 1e-6;

impl Tabulated {
    /// From rows of a cosine and a value in any unit. Cosines ascend from -1 to 1; where an end is missing, the value
    /// of the row next to it holds up to it.
    pub fn new(rows: &[(f64, f64)]) -> Result<Self, String> {
        check(rows)?;
        let mut rows = rows.to_vec();
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        if first.0 > -1.0 {
            rows.insert(0, (-1.0, first.1));
        }
        if last.0 < 1.0 {
            rows.push((1.0, last.1));
        }
        // In units of the largest value, whose sums are finite.
        let largest = rows.iter().map(|row| row.1).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err("all values are zero: a phase function scatters somewhere".into());
        }
        rows.iter_mut().for_each(|row| row.1 /= largest);
        let whole: f64 =
            rows.windows(2).map(|pair| core::f64::consts::PI * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum();
        rows.iter_mut().for_each(|row| row.1 /= whole);
        let columns = Columns::new(&rows);
        let table = Self { rows, columns };
        let forward = Phase::forward_share(&table);
        if forward < SMALLEST_FORWARD_SHARE {
            return Err(format!(
                "a share of {forward:e} scatters by less than a right angle (cosine > 0): at least \
                 {SMALLEST_FORWARD_SHARE:e} has to"
            ));
        }
        Ok(table)
    }

    /// Cosine, ascending from -1 to 1, and phase function at it [1/sr].
    pub fn rows(&self) -> &[(f64, f64)] {
        &self.rows
    }
}

fn check(rows: &[(f64, f64)]) -> Result<(), String> {
    if rows.len() < 2 {
        return Err(format!("a table needs at least two rows (cosine, value), and this one has {}", rows.len()));
    }
    for (i, (cosine, value)) in rows.iter().enumerate() {
        let row = i + 1;
        if !(-1.0..=1.0).contains(cosine) {
            return Err(format!("row {row}: a cosine of {cosine} is not in [-1, 1]"));
        }
        if !(value.is_finite() && *value >= 0.0) {
            return Err(format!("row {row}: a value of {value} is not a finite number >= 0"));
        }
        if i > 0 && *cosine <= rows[i - 1].0 {
            return Err(format!("row {row}: a cosine of {cosine} after {}; cosines ascend", rows[i - 1].0));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
