//! Densities as shares of the range of their brick.
//!
//! ```text
//! density = least + step (coarse + fine / 2^16)
//! ```
//!
//! Coarse shares have 16 bits: values of 4 bytes take 2. Where one voxel is far denser than all others, the step from one
//! share to the next would swallow its neighbours: where it is more than 1/512 of the grid's mean, over voxels that are
//! not 0, shares have 16 more bits. So a value is off by at most a thousandth of that mean.

/// Largest coarse share.
pub const WHOLE: f32 = u16::MAX as f32;
/// Fine shares of a coarse one.
pub const FINE: f32 = 65_536.0;
/// Largest step without fine shares, over the grid's mean.
const LARGEST_STEP: f64 = 1.0 / 512.0;

/// Largest step without fine shares, among all densities of a grid.
pub fn largest_step(values: impl Iterator<Item = f32>) -> f32 {
    let filled = values.filter(|value| *value != 0.0);
    let (sum, count) = filled.fold((0.0, 0_u64), |(sum, count), value| (sum + f64::from(value), count + 1));
    (LARGEST_STEP * (sum / count.max(1) as f64)) as f32
}

/// Adds the coarse shares of `values` to the pool and, if their step would be larger than this, all of their fine ones after
/// them: then it gives true.
pub fn store(
    pool: &mut Vec<u16>,
    values: impl Iterator<Item = f32> + Clone,
    [least, step]: [f32; 2],
    largest_step: f32,
) -> bool {
    if step <= largest_step {
        pool.extend(values.map(|value| ((value - least) / step).round() as u16));
        return false;
    }
    let share = move |value: f32| (f64::from(value) - f64::from(least)) / f64::from(step);
    let coarse = move |value: f32| share(value) as u16;
    pool.extend(values.clone().map(coarse));
    pool.extend(values.map(|value| ((share(value) - f64::from(coarse(value))) * f64::from(FINE)).round() as u16));
    true
}

/// The share at these places of the pool.
pub fn share(pool: &[u16], coarse: usize, fine: Option<usize>) -> f64 {
    f64::from(pool[coarse]) + fine.map_or(0.0, |fine| f64::from(pool[fine]) / f64::from(FINE))
}
