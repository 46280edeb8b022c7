//! Which of the values of a brick are kept: a box of them, about all that are not 0.
//!
//! ```text
//! low, high: first and last value along an axis, low < high
//! outside of them everything is 0
//! a point between l and l + 1, at the share f:  l' = min(max(l, low), high - 1),  d = f + l - l'
//!                                               f' = min(max(d, 0), 1),           w = min(max(3/2 - |d - 1/2|, 0), 1)
//! ```
//!
//! Points outside of the box are moved to its border, d is how far they are beyond l'; from the border on, the density falls
//! to 0 over one edge of a voxel: w is what is left of it, and the density is what is mixed at f' times the three w. Values
//! of the box are in sequence, x first, so that steps from one to the next along y and z differ from brick to brick.

use wide::{f32x8, i32x8, u32x8};

use super::apron::{STRIDE, VALUES};

/// Bits of a coordinate.
const BITS: u32 = 4;
/// Those of one coordinate.
const ONE: u32 = (1 << BITS) - 1;

/// Set where values have a fine share, too.
const FINE: u32 = 1 << (6 * BITS);

/// The box: six coordinates in 0..=8, those of its first value and then of its last one; and whether its values have
/// fine shares, which follow all of the coarse ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept(u32);

/// What is kept of eight bricks, and where points are in it.
pub struct KeptX8 {
    /// The value before each point along every axis, counted from the first one that is kept.
    pub at: [u32x8; 3],
    /// How far each point is from there to the next one, in [0, 1].
    pub share: [f32x8; 3],
    /// What is left, in [0, 1], of the density there: less than all of it beyond the border.
    pub left: f32x8,
    /// Values along x, and along x and y.
    pub steps: [u32x8; 2],
    /// The box.
    kept: u32x8,
}

impl Kept {
    /// All values.
    pub const ALL: Self = Self::new([0; 3], [STRIDE as u32 - 1; 3]);

    const fn new([a, b, c]: [u32; 3], [d, e, f]: [u32; 3]) -> Self {
        Self(a | b << BITS | c << (2 * BITS) | d << (3 * BITS) | e << (4 * BITS) | f << (5 * BITS))
    }

    /// The least box, of at least two values along each axis, outside of which all are 0.
    pub fn around(values: &[f32; VALUES]) -> Self {
        let (mut low, mut high) = ([STRIDE - 1; 3], [0; 3]);
        for (index, _) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let place = [index % STRIDE, index / STRIDE % STRIDE, index / (STRIDE * STRIDE)];
            for axis in 0..3 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        for axis in 0..3 {
            low[axis] = low[axis].min(STRIDE - 2);
            high[axis] = high[axis].max(low[axis] + 1);
        }
        Self::new(low.map(|c| c as u32), high.map(|c| c as u32))
    }

    /// The same with fine shares.
    #[must_use]
    pub fn with_fine(self) -> Self {
        Self(self.0 | FINE)
    }

    /// Whether there are fine shares.
    pub fn has_fine(self) -> bool {
        self.0 & FINE != 0
    }

    /// All of it, for [`KeptX8`].
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// First and last coordinate along each axis.
    pub fn bounds(self) -> [[usize; 2]; 3] {
        [0, 1, 2].map(|axis| [axis, axis + 3].map(|nth| (self.0 >> (nth * BITS) & ONE) as usize))
    }

    /// Values along each axis.
    pub fn sides(self) -> [usize; 3] {
        self.bounds().map(|[low, high]| high - low + 1)
    }

    /// How many there are.
    pub fn len(self) -> usize {
        self.sides().into_iter().product()
    }

    /// The index of a value among those that are kept, if it is.
    pub fn index(self, at: [usize; 3]) -> Option<usize> {
        let (bounds, [width, height, _]) = (self.bounds(), self.sides());
        let is_kept = (0..3).all(|axis| (bounds[axis][0]..=bounds[axis][1]).contains(&at[axis]));
        let [x, y, z] = [0, 1, 2].map(|axis| at[axis].wrapping_sub(bounds[axis][0]));
        is_kept.then(|| (z * height + y) * width + x)
    }

    /// The kept values of a brick, in their sequence.
    pub fn of(self, values: &[f32; VALUES]) -> impl Iterator<Item = f32> + Clone {
        let [x, y, z] = self.bounds().map(|[low, high]| low..=high);
        let rows = z.flat_map(move |z| y.clone().map(move |y| (z * STRIDE + y) * STRIDE));
        rows.flat_map(move |row| values[row + x.start()..=row + x.end()].iter().copied())
    }
}

impl KeptX8 {
    /// Points between the value `at`, counted in their bricks, and the next one along each axis, to which they are so far
    /// on their way.
    #[inline(always)]
    pub fn new(kept: u32x8, at: [u32x8; 3], share: [f32x8; 3]) -> Self {
        let coordinate = |nth: u32| (kept >> (nth * BITS)) & u32x8::splat(ONE);
        let one = u32x8::splat(1);
        let mut found = Self { at, share, left: f32x8::ONE, steps: [one; 2], kept };
        for axis in 0..3 {
            let (low, high) = (coordinate(axis as u32), coordinate(axis as u32 + 3));
            let inside = at[axis].max(low).min(high - one);
            let moved: i32x8 = bytemuck::cast(at[axis] - inside);
            found.at[axis] = inside - low;
            let beyond = share[axis] + f32x8::from_i32x8(moved);
            found.share[axis] = beyond.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            let left = f32x8::splat(1.5) - (beyond - f32x8::HALF).abs();
            found.left *= left.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            if axis < 2 {
                found.steps[1] *= high - low + one;
            }
            if axis == 0 {
                found.steps[0] = found.steps[1];
            }
        }
        found
    }

    /// Where there are fine shares, as a mask, and how many values after its coarse one a value has its own there; 0
    /// elsewhere. None if there are none at all.
    #[inline(always)]
    pub fn fine(&self) -> Option<(f32x8, u32x8)> {
        let fine = !(self.kept & u32x8::splat(FINE)).simd_eq(u32x8::splat(0));
        let mask: f32x8 = bytemuck::cast(fine);
        let coordinate = |nth: u32| (self.kept >> (nth * BITS)) & u32x8::splat(ONE);
        let layers = coordinate(5) - coordinate(2) + u32x8::splat(1);
        mask.any().then(|| (mask, fine & (self.steps[1] * layers)))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::media::field::bricks::{Bricks, Leaf};
    use crate::random;
    use crate::vec3::Vec3x8;

    /// Two leaves side by side with `count` voxels that are not 0.
    fn sparse(seed: u32, count: u32) -> Vec<Leaf> {
        let mut leaves = [0, 8].map(|x| Leaf { origin: [x, 0, 0], values: [0.0; 512].into() });
        for voxel in 0..count {
            let [leaf, index, density, _] = random::words(seed, voxel, 3, 4);
            let values = Arc::make_mut(&mut leaves[leaf as usize % 2].values);
            values[index as usize % 512] = 1.0 + random::uniform(density) as f32;
        }
        leaves.to_vec()
    }

    /// The density of a voxel of the leaves.
    fn density(leaves: &[Leaf], at: [i64; 3]) -> f64 {
        let inside = |leaf: &&Leaf| (0..3).all(|axis| (0..8).contains(&(at[axis] - i64::from(leaf.origin[axis]))));
        let value = |leaf: &Leaf| leaf.values[(at[2] * 64 + at[1] * 8 + at[0] - i64::from(leaf.origin[0])) as usize];
        leaves.iter().find(inside).map_or(0.0, |leaf| f64::from(value(leaf)))
    }

    #[test]
    fn what_is_kept_has_the_densities_of_all() {
        for seed in 0..200 {
            let leaves = sparse(seed, 1 + seed % 9);
            let forms = Bricks::both(&leaves);
            for (round, bricks) in (0..40).flat_map(|round| forms.iter().map(move |bricks| (round, bricks))) {
                let points: [[f32; 3]; 8] = core::array::from_fn(|lane| {
                    let words = random::words(seed, round, lane as u32, 5);
                    [0, 1, 2].map(|axis| (random::uniform(words[axis]) * [18.0, 10.0, 10.0][axis]) as f32 - 1.0)
                });
                let axis = |axis: usize| f32x8::new(points.map(|at| at[axis] - bricks.origin[axis] as f32));
                let own = Vec3x8::new(axis(0), axis(1), axis(2));
                let [mixed, nearest] = [true, false].map(|smooth| bricks.density(own, smooth).to_array());
                for (lane, at) in points.iter().enumerate() {
                    let first = at.map(|x| f64::from(x).floor());
                    let corner = |nth: i32| [0, 1, 2].map(|axis| f64::from(nth >> axis & 1));
                    let part = |nth: i32| {
                        let offset = corner(nth);
                        let near = |axis: usize| 1.0 - (f64::from(at[axis]) - first[axis] - offset[axis]).abs();
                        let value = density(&leaves, [0, 1, 2].map(|axis| (first[axis] + offset[axis]) as i64));
                        near(0) * near(1) * near(2) * value
                    };
                    let expected = [(0..8).map(part).sum(), density(&leaves, first.map(|x| x as i64))];
                    for (found, expected) in [mixed[lane], nearest[lane]].into_iter().zip(expected) {
                        assert!((f64::from(found) - expected).abs() < 1e-4, "seed {seed}, {at:?}: {found}, {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn densities_that_are_next_to_nothing_are_nothing() {
        for density in [0.0, f32::from_bits(1)] {
            let mut leaves = sparse(0, 0);
            Arc::make_mut(&mut leaves[1].values)[77] = density;
            for bricks in Bricks::both(&leaves) {
                assert_eq!(bricks.dims, [1; 3]);
                for at in [[0.0; 3], [13.0, 1.0, 1.0], [-3.0, 4.5, 7.5]] {
                    assert_eq!(bricks.density(Vec3x8::splat(at), true), f32x8::ZERO);
                }
            }
        }
    }

    #[test]
    fn a_box_is_as_small_as_its_values_allow() {
        let mut values = [0.0; VALUES];
        values[STRIDE * STRIDE * 4 + STRIDE * 8] = 1.0;
        let kept = Kept::around(&values);
        assert_eq!(kept.bounds(), [[0, 1], [7, 8], [4, 5]]);
        assert_eq!(kept.of(&values).collect::<Vec<_>>(), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!([kept.index([0, 8, 4]), kept.index([0, 8, 6]), kept.index([2, 8, 4])], [Some(2), None, None]);
        values.fill(1.0);
        assert_eq!(Kept::around(&values), Kept::ALL);
        assert_eq!(Kept::ALL.of(&values).count(), VALUES);
    }
}
