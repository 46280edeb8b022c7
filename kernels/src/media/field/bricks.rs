//! Voxels in sparse bricks of 8^3, each with an apron.
//!
//! A brick has 9^3 values, those of its own voxels and the first ones of its neighbours behind, so that all eight
//! corners of an interpolation are in one brick: two loads from one cache line for each of four pairs. Constant bricks,
//! empty ones among them, share one; of others, the least [box](Kept) that holds all values that are not 0 is kept.
//!
//! **Precision.** Values are 16-bit shares of the brick's own range: a brick takes 1458 bytes where its voxels would take
//! 2048. Where one voxel is far denser than all others, the step from one share to the next would swallow its
//! neighbours: where it is more than 1/512 of the grid's mean, over voxels that are not 0, values have 16 more bits.
//!
//! ```text
//! density = least + step (coarse + fine / 2^16)
//! ```
//!
//! So a value is off by at most a thousandth of that mean.

use std::collections::HashMap;
use std::sync::Arc;

use wide::{f32x8, u32x8};

use super::heads::{Head, HeadX8, Heads};
use super::kept::{Kept, KeptX8};
use crate::lanes::{self, per_lane};
use crate::vec3x8::Vec3x8;

/// Voxels along the edge of a brick.
pub const SIDE: u32 = 8;
/// Values along it, with the apron.
pub(super) const STRIDE: usize = SIDE as usize + 1;
/// Values of a brick.
pub(super) const VALUES: usize = STRIDE * STRIDE * STRIDE;
/// Largest 16-bit share.
const WHOLE: f32 = u16::MAX as f32;
/// Fine shares of a coarse one.
const FINE: f32 = 65_536.0;
/// Largest step without fine shares, over the grid's mean.
const LARGEST_STEP: f64 = 1.0 / 512.0;

/// 8^3 voxels of a file or a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Index coordinates of the first voxel: multiples of 8.
    pub origin: [i32; 3],
    /// Densities, each finite and >= 0; x runs fastest, then y. Leaves of constant regions share them.
    pub values: Arc<[f32; 512]>,
}

/// Densities on a lattice, 0 outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Bricks {
    /// Index coordinates of the first voxel of the first brick.
    pub origin: [i32; 3],
    /// Bricks along each axis.
    pub dims: [u32; 3],
    heads: Heads,
    pool: Vec<u16>,
}

/// The extrema and the mean of some densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Least density.
    pub least: f32,
    /// Largest density.
    pub most: f32,
    /// Mean density.
    pub mean: f32,
}

impl Bricks {
    /// The bricks of `leaves`, no two of which have the same origin; those that are all zero are left out, but for one
    /// if there is no other.
    ///
    /// # Panics
    /// If there are more than 2^31 bricks from one end to the other.
    pub fn new(leaves: &[Leaf]) -> Self {
        let brick_of = |leaf: &Leaf| leaf.origin.map(|component| component.div_euclid(SIDE as i32));
        let by_brick: HashMap<[i32; 3], &Leaf> = leaves.iter().map(|leaf| (brick_of(leaf), leaf)).collect();
        // The apron of the brick before a leaf reaches into it.
        let touched = by_brick
            .keys()
            .flat_map(|brick| (0..8).map(|corner: i32| [0, 1, 2].map(|axis| brick[axis] - (corner >> axis & 1))));
        let mut touched: Vec<[i32; 3]> = touched.collect();
        touched.sort_unstable_by_key(|[x, y, z]| [*z, *y, *x]);
        touched.dedup();
        let largest_step = (LARGEST_STEP * mean(leaves)) as f32;
        let mut pool = vec![0; VALUES];
        let store = |brick: [i32; 3]| (brick, store(&mut pool, &gather(&by_brick, brick), largest_step));
        let stored = touched.into_iter().map(store);
        let filled: Vec<([i32; 3], Head)> = stored.filter(|(_, head)| *head != Head::constant(0.0)).collect();
        pool.shrink_to_fit();
        let bound = |pick: fn(i32, i32) -> i32| {
            let ends = filled.iter().map(|(brick, _)| *brick);
            ends.reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis]))).unwrap_or_default()
        };
        let (first, last) = (bound(i32::min), bound(i32::max));
        let dims = [0, 1, 2].map(|axis| (last[axis] - first[axis] + 1) as u32);
        let place = |brick: [i32; 3]| [0, 1, 2].map(|axis| (brick[axis] - first[axis]) as u32);
        let filled: Vec<([u32; 3], Head)> = filled.into_iter().map(|(brick, head)| (place(brick), head)).collect();
        Self { origin: first.map(|component| component * SIDE as i32), dims, heads: Heads::new(dims, &filled), pool }
    }

    /// What densities range over in the cube of `side` <= 8 voxels from `first` on, which is within one brick; with the
    /// voxels behind it if densities are mixed between (`smooth`).
    pub fn extent(&self, first: [u32; 3], side: u32, smooth: bool) -> Extent {
        self.extent_of(first, [side; 3], smooth)
    }

    /// The same of so many voxels along each axis.
    fn extent_of(&self, first: [u32; 3], sides: [u32; 3], smooth: bool) -> Extent {
        let (head, first) = self.find(first);
        if head.is_constant() {
            return Extent { least: head.least, most: head.least, mean: head.least };
        }
        let layers = sides.map(|side| side as usize + usize::from(smooth));
        let (mut least, mut most, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
        for (z, y) in (0..layers[2]).flat_map(|z| (0..layers[1]).map(move |y| (z, y))) {
            for x in 0..layers[0] {
                let share = self.share(head, [first[0] + x, first[1] + y, first[2] + z]);
                (least, most, sum) = (least.min(share), most.max(share), sum + share);
            }
        }
        let mean = sum / layers.into_iter().product::<usize>() as f64;
        let [least, most, mean] = [least, most, mean].map(|share| head.density(share as f32));
        // Two shares that were mixed apart may round to more than either of them.
        Extent { least, most: if head.kept.has_fine() { most.next_up() } else { most }, mean }
    }

    /// The largest density.
    pub fn most(&self) -> f32 {
        self.heads.all().iter().map(|head| head.density(WHOLE)).fold(0.0, f32::max)
    }

    /// What densities range over at points of which the voxels are `low` to `high`, counted from the first one on;
    /// outside of all bricks they are 0. The mean is not asked for, and 0.
    pub fn extent_between(&self, low: [i64; 3], high: [i64; 3], smooth: bool) -> Extent {
        let voxels = self.dims.map(|dim| i64::from(dim * SIDE));
        let within = |axis: usize| low[axis].max(0)..(high[axis] + 1).min(voxels[axis]);
        let outside = (0..3).any(|axis| low[axis] < 0 || high[axis] >= voxels[axis]);
        let mut found = Extent { least: if outside { 0.0 } else { f32::INFINITY }, most: 0.0, mean: 0.0 };
        if (0..3).any(|axis| within(axis).is_empty()) {
            return Extent { least: 0.0, ..found };
        }
        let side = i64::from(SIDE);
        let bricks = |axis: usize| within(axis).start / side..=(within(axis).end - 1) / side;
        for (z, y, x) in bricks(2).flat_map(|z| bricks(1).flat_map(move |y| bricks(0).map(move |x| (z, y, x)))) {
            let part = |axis: usize, brick: i64| {
                let (start, end) = (within(axis).start.max(brick * side), within(axis).end.min((brick + 1) * side));
                (start as u32, (end - start) as u32)
            };
            let parts = [part(0, x), part(1, y), part(2, z)];
            let extent = self.extent_of(parts.map(|(start, _)| start), parts.map(|(_, side)| side), smooth);
            (found.least, found.most) = (found.least.min(extent.least), found.most.max(extent.most));
        }
        found
    }

    /// Hands all densities, and where they are, to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(&self.origin));
        digest(bytemuck::cast_slice(&self.dims));
        self.heads.digest(digest);
        digest(bytemuck::cast_slice(&self.pool));
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.heads.bytes() + size_of_val(self.pool.as_slice())
    }

    /// Voxels along each axis.
    pub fn voxels(&self) -> [f32; 3] {
        self.dims.map(|dim| (dim * SIDE) as f32)
    }

    /// Densities at points in voxels from the first one on; 0 outside. Between the corners of a cell it is trilinear if
    /// `smooth`, or else that of the first of them.
    #[inline(always)]
    pub fn density(&self, at: Vec3x8, smooth: bool) -> f32x8 {
        let zero = f32x8::ZERO;
        let axes = [at.x, at.y, at.z];
        let mut inside = f32x8::splat(f32::from_bits(u32::MAX));
        let mut place = [u32x8::splat(0); 3];
        let mut share = [zero; 3];
        for (axis, voxels) in self.voxels().into_iter().enumerate() {
            inside &= axes[axis].simd_ge(zero) & axes[axis].simd_lt(f32x8::splat(voxels));
            let clamped = inside.select(axes[axis], zero);
            let whole = clamped.fast_trunc_int();
            share[axis] = clamped - f32x8::from_i32x8(whole);
            place[axis] = bytemuck::cast(whole);
        }
        let value = if smooth { self.corners(place, share) } else { self.voxel(place) };
        inside.select(value, zero)
    }

    /// The head of the brick that a voxel is in, and its place there.
    fn find(&self, [x, y, z]: [u32; 3]) -> (&Head, [usize; 3]) {
        let head = self.heads.at([x, y, z].map(|voxel| voxel / SIDE));
        (head, [x % SIDE, y % SIDE, z % SIDE].map(|local| local as usize))
    }

    /// The share of a value of a brick, in steps.
    fn share(&self, head: &Head, at: [usize; 3]) -> f64 {
        let Some(index) = head.kept.index(at) else { return 0.0 };
        let coarse = head.first as usize + index;
        let fine = if head.kept.has_fine() { self.pool[coarse + head.kept.len()] } else { 0 };
        f64::from(self.pool[coarse]) + f64::from(fine) / f64::from(FINE)
    }

    #[inline(always)]
    fn corners(&self, place: [u32x8; 3], share: [f32x8; 3]) -> f32x8 {
        let head = self.heads.at_lanes(place.map(|voxel| voxel >> SIDE.ilog2()));
        let kept = kept(&head, place, share);
        let (KeptX8 { at: [x, y, z], share: [fx, fy, fz], left, .. }, [row, layer]) = (&kept, kept.steps);
        let pair = |first: u32x8| {
            let first = first.to_array();
            let of = |lane: usize| {
                let pair = &self.pool[first[lane] as usize..][..2];
                u32::from(pair[0]) | u32::from(pair[1]) << 16
            };
            let pair = u32x8::new(per_lane(of));
            mix(lanes::to_f32(pair & u32x8::splat(0xffff)), lanes::to_f32(pair >> 16_u32), *fx)
        };
        let shares = |first: u32x8| {
            let behind = first + layer;
            let [low, after_low, high, after_high] = [first, first + row, behind, behind + row].map(pair);
            mix(mix(low, after_low, *fy), mix(high, after_high, *fy), *fz)
        };
        let first = head.first + *z * layer + *y * row + *x;
        // Where something is not kept, the least density is 0.
        with_fine(&kept, first, shares).mul_add(*left * head.step, head.least)
    }

    #[inline(always)]
    fn voxel(&self, place: [u32x8; 3]) -> f32x8 {
        let head = self.heads.at_lanes(place.map(|voxel| voxel >> SIDE.ilog2()));
        let kept = kept(&head, place, [f32x8::ZERO; 3]);
        let [row, layer] = kept.steps;
        let [x, y, z] =
            [0, 1, 2].map(|axis| kept.at[axis] + bytemuck::cast::<_, u32x8>(kept.share[axis].fast_trunc_int()));
        let shares = |index: u32x8| {
            let index = index.to_array();
            f32x8::new(per_lane(|lane| f32::from(self.pool[index[lane] as usize])))
        };
        let index = head.first + z * layer + y * row + x;
        with_fine(&kept, index, shares).mul_add(kept.left * head.step, head.least)
    }

    /// Density of the voxel at `place`, counted from the first one; 0 outside. For twins.
    pub fn value(&self, place: [i64; 3]) -> f64 {
        let voxels = self.dims.map(|dim| i64::from(dim * SIDE));
        if (0..3).any(|axis| place[axis] < 0 || place[axis] >= voxels[axis]) {
            return 0.0;
        }
        let (head, at) = self.find(place.map(|component| component as u32));
        f64::from(head.step) * self.share(head, at) + f64::from(head.least)
    }
}

/// Where points between voxels and the next ones are in what is kept of their bricks.
#[inline(always)]
fn kept(head: &HeadX8, place: [u32x8; 3], share: [f32x8; 3]) -> KeptX8 {
    KeptX8::new(head.kept, place.map(|voxel| voxel & u32x8::splat(SIDE - 1)), share)
}

/// The shares at these places of the pool, and the fine ones with them where there are any.
#[inline(always)]
fn with_fine(kept: &KeptX8, at: u32x8, shares: impl Fn(u32x8) -> f32x8) -> f32x8 {
    let coarse = shares(at);
    let Some((fine, behind)) = kept.fine() else { return coarse };
    fine.select(shares(at + behind).mul_add(f32x8::splat(1.0 / FINE), coarse), coarse)
}

#[inline(always)]
fn mix(a: f32x8, b: f32x8, share: f32x8) -> f32x8 {
    (b - a).mul_add(share, a)
}

/// Mean of all densities that are not 0.
fn mean(leaves: &[Leaf]) -> f64 {
    let filled = leaves.iter().flat_map(|leaf| leaf.values.iter()).filter(|value| **value != 0.0);
    let (sum, count) = filled.fold((0.0, 0_u64), |(sum, count), value| (sum + f64::from(*value), count + 1));
    sum / count.max(1) as f64
}

/// Adds the values of a brick to the pool, with fine shares if the step from one to the next would be larger than this.
fn store(pool: &mut Vec<u16>, values: &[f32; VALUES], largest_step: f32) -> Head {
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let most = values.iter().copied().fold(0.0, f32::max);
    let step = (most - least) / WHOLE;
    if step == 0.0 {
        return Head::constant(least);
    }
    let first = u32::try_from(pool.len()).expect("fewer than 2^32 values");
    let kept = Kept::around(values);
    if step <= largest_step {
        pool.extend(kept.of(values).map(|value| ((value - least) / step).round() as u16));
        return Head { first, kept, least, step };
    }
    let share = |value: f32| (f64::from(value) - f64::from(least)) / f64::from(step);
    let coarse = |value: f32| share(value) as u16;
    pool.extend(kept.of(values).map(coarse));
    let fine = |value: f32| ((share(value) - f64::from(coarse(value))) * f64::from(FINE)).round() as u16;
    pool.extend(kept.of(values).map(fine));
    Head { first, kept: kept.with_fine(), least, step }
}

/// The values of a brick and its apron.
fn gather(leaves: &HashMap<[i32; 3], &Leaf>, brick: [i32; 3]) -> [f32; VALUES] {
    let mut values = [0.0; VALUES];
    for corner in 0..8 {
        let offset = [0, 1, 2].map(|axis| corner >> axis & 1);
        let Some(leaf) = leaves.get(&[0, 1, 2].map(|axis| brick[axis] + offset[axis])) else {
            continue;
        };
        // Of a neighbour behind, the first layer alone.
        let side = SIDE as usize;
        let layers = offset.map(|behind| if behind == 1 { side..side + 1 } else { 0..side });
        for (z, y) in layers[2].clone().flat_map(|z| layers[1].clone().map(move |y| (z, y))) {
            for x in layers[0].clone() {
                values[(z * STRIDE + y) * STRIDE + x] = leaf.values[(z % side * side + y % side) * side + x % side];
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    /// A leaf of densities about 1, in which one of 512 voxels is as dense as this.
    fn spiky(most: f32) -> [Leaf; 1] {
        let value = |voxel: u32| 0.5 + random::uniform(random::words(voxel, 1, 2, 3)[0]) as f32;
        let values = core::array::from_fn(|voxel| if voxel == 219 { most } else { value(voxel as u32) });
        [Leaf { origin: [0; 3], values: Arc::new(values) }]
    }

    #[test]
    fn what_is_next_to_something_far_denser_keeps_its_density() {
        for most in [2.0, 90.0, 1e3, 1e4, 1e6, 1e8] {
            let leaves = spiky(most);
            let bricks = Bricks::new(&leaves);
            let tolerance = 1e-3 * (1.0 + f64::from(most) / 512.0);
            for voxel in 0..512_usize {
                // The first brick is the one before, with the leaf's first layers in its apron.
                let place = [voxel % 8, voxel / 8 % 8, voxel / 64].map(|component| component + 8);
                let expected = f64::from(leaves[0].values[voxel]);
                let at = Vec3x8::splat(place.map(|component| component as f32));
                let [smooth, nearest] = [true, false].map(|smooth| f64::from(bricks.density(at, smooth).to_array()[0]));
                for found in [bricks.value(place.map(|component| component as i64)), smooth, nearest] {
                    // Of the densest, as many digits as an f32 has.
                    let rounded = if voxel == 219 { 1e-6 * expected } else { 0.0 };
                    let difference = (found - expected).abs();
                    assert!(difference < tolerance + rounded, "{most}: {found} instead of {expected} at {place:?}");
                }
            }
        }
    }

    #[test]
    fn only_bricks_with_something_far_denser_take_more_memory() {
        let [even, dense, spiky] = [2.0, 90.0, 1e3].map(|most| Bricks::new(&spiky(most)).bytes());
        assert_eq!(even, dense);
        assert!(spiky > even, "{spiky} bytes, {even} of the others");
        let far = Leaf { origin: [80, 0, 0], ..self::spiky(2.0)[0].clone() };
        let both = Bricks::new(&[self::spiky(1e4)[0].clone(), far.clone()]).pool.len();
        let alone = Bricks::new(&[far]).pool.len();
        assert_eq!(both - alone, alone - VALUES + 512, "the 512 values of one brick of sixteen have fine shares");
    }

    #[test]
    fn extents_hold_all_densities_between_voxels() {
        for most in [2.0, 1e4, 1e7] {
            let bricks = Bricks::new(&spiky(most));
            for seed in 0..2000 {
                let words = random::words(seed, 5, 6, 7);
                let first = [0, 1, 2].map(|axis| words[axis] % 16);
                let at = [0, 1, 2].map(|axis| first[axis] as f32 + (words[axis] >> 8) as f32 / (1 << 24) as f32);
                let density = bricks.density(Vec3x8::splat(at), true).to_array()[0];
                let Extent { least, most, mean } = bricks.extent(first, 1, true);
                assert!((least..=most).contains(&density), "{density} at {at:?}, {least} to {most}");
                assert!((least..=most).contains(&mean), "{mean}, {least} to {most}");
            }
        }
    }
}
