//! Bricks of which a box of values is kept, with an apron: see [`Kept`].
//!
//! Each of four pairs of corners takes two loads from one cache line. Constant bricks, empty ones among them, keep no values.
//!
//! ```text
//! density = least + step share
//! ```

use wide::{f32x8, u32x8};

use super::apron::{Leaves, VALUES};
use super::bricks::{Extent, SIDE, mix, ranged};
use super::kept::{Kept, KeptX8};
use super::shares::{self, WHOLE};
use super::span::{Span, places, split};
use super::table::Table;
use crate::lanes::{self, LANES, per_lane};

/// Boxes of values, one for each brick.
#[derive(Clone, Debug, PartialEq)]
pub struct Boxes {
    heads: Table<Head>,
    pool: Vec<u16>,
}

/// Where the values of a brick are, and what they mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// First of those that are kept in the pool.
    pub first: u32,
    /// Which these are.
    pub kept: Kept,
    /// Density of share 0.
    pub least: f32,
    /// Difference between neighbouring shares.
    pub step: f32,
}

/// The heads of eight bricks.
pub struct HeadX8 {
    /// First of the values that are kept in the pool.
    pub first: u32x8,
    /// The bits of which these are.
    pub kept: u32x8,
    /// Density of share 0.
    pub least: f32x8,
    /// Difference between neighbouring shares.
    pub step: f32x8,
}

impl Head {
    /// Of an empty brick.
    pub const EMPTY: Self = Self::constant(0.0);

    /// Of a brick of one density.
    pub const fn constant(density: f32) -> Self {
        Self { first: 0, kept: Kept::ALL, least: density, step: 0.0 }
    }

    /// Whether it is that of a brick of one density.
    pub const fn is_constant(&self) -> bool {
        self.step == 0.0
    }

    /// Density of this `share`.
    #[inline(always)]
    pub fn density(&self, share: f32) -> f32 {
        self.step.mul_add(share, self.least)
    }
}

impl Default for Head {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl HeadX8 {
    /// Those of eight bricks: all of them are read before anything else of the bricks, so that what is farthest away,
    /// their values, is waited for together.
    #[inline(always)]
    fn new(heads: [&Head; LANES]) -> Self {
        Self {
            first: u32x8::new(per_lane(|lane| heads[lane].first)),
            kept: u32x8::new(per_lane(|lane| heads[lane].kept.bits())),
            least: f32x8::new(per_lane(|lane| heads[lane].least)),
            step: f32x8::new(per_lane(|lane| heads[lane].step)),
        }
    }
}

impl Boxes {
    /// The boxes of all bricks of the leaves with at least one density that is not 0; and where these are. Steps larger than
    /// this get fine shares.
    pub fn new(leaves: &Leaves<'_>, largest_step: f32) -> (Span, Self) {
        let mut pool = vec![0; VALUES];
        let store = |brick: [i32; 3]| (brick, store(&mut pool, &leaves.values(brick), largest_step));
        let stored = leaves.bricks().into_iter().map(store);
        let filled: Vec<([i32; 3], Head)> = stored.filter(|(_, head)| *head != Head::EMPTY).collect();
        pool.shrink_to_fit();
        let span = Span::around(filled.iter().map(|(brick, _)| *brick));
        let filled: Vec<([u32; 3], Head)> = filled.into_iter().map(|(brick, head)| (span.place(brick), head)).collect();
        (span, Self { heads: Table::new(span.dims, &filled), pool })
    }

    /// What densities range over in so many `layers` of voxels along each axis from `first` on, which are in one brick and
    /// its apron.
    pub fn extent(&self, first: [u32; 3], layers: [u32; 3]) -> Extent {
        let (brick, first) = split(first);
        let head = self.heads.at(brick);
        if head.is_constant() {
            return Extent { least: head.least, most: head.least, mean: head.least };
        }
        let shares = places(first, layers).map(|at| self.share(head, at));
        let [least, most, mean] = ranged(shares).map(|share| head.density(share as f32));
        // Two shares that were mixed apart may round to more than either of them.
        Extent { least, most: if head.kept.has_fine() { most.next_up() } else { most }, mean }
    }

    /// The largest density.
    pub fn most(&self) -> f32 {
        self.heads.all().iter().map(|head| head.density(WHOLE)).fold(0.0, f32::max)
    }

    /// Hands all densities to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(self.heads.pages()));
        for Head { first, kept, least, step } in self.heads.all() {
            digest(&[first.to_le_bytes(), kept.bits().to_le_bytes(), least.to_le_bytes(), step.to_le_bytes()].concat());
        }
        digest(bytemuck::cast_slice(&self.pool));
    }

    /// Entries of the pool, fine shares and padding included; beyond 2^32 of them, values are not told apart.
    pub fn pool_len(&self) -> usize {
        self.pool.len()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.heads.bytes() + size_of_val(self.pool.as_slice())
    }

    /// Density of the voxel at `place`, for twins.
    pub fn value(&self, place: [u32; 3]) -> f64 {
        let (brick, at) = split(place);
        let head = self.heads.at(brick);
        f64::from(head.step) * self.share(head, at) + f64::from(head.least)
    }

    /// The share of a value of a brick, in steps.
    fn share(&self, head: &Head, at: [u32; 3]) -> f64 {
        let Some(index) = head.kept.index(at.map(|local| local as usize)) else { return 0.0 };
        let coarse = head.first as usize + index;
        shares::share(&self.pool, coarse, head.kept.has_fine().then(|| coarse + head.kept.len()))
    }

    /// Densities between the voxels at `place` and the next ones, to which points are so far on their way.
    #[inline(always)]
    pub fn corners(&self, place: [u32x8; 3], share: [f32x8; 3]) -> f32x8 {
        let head = HeadX8::new(self.heads.at_lanes(place.map(|voxel| voxel >> SIDE.ilog2())));
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

    /// Densities of the voxels at `place`.
    #[inline(always)]
    pub fn voxel(&self, place: [u32x8; 3]) -> f32x8 {
        let head = HeadX8::new(self.heads.at_lanes(place.map(|voxel| voxel >> SIDE.ilog2())));
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
    fine.select(shares(at + behind).mul_add(f32x8::splat(1.0 / shares::FINE), coarse), coarse)
}

/// Adds what is kept of the values of a brick to the pool.
fn store(pool: &mut Vec<u16>, values: &[f32; VALUES], largest_step: f32) -> Head {
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let most = values.iter().copied().fold(0.0, f32::max);
    let step = (most - least) / WHOLE;
    if step == 0.0 {
        return Head::constant(least);
    }
    let first = pool.len() as u32;
    let kept = Kept::around(values);
    let fine = shares::store(pool, kept.of(values), [least, step], largest_step);
    Head { first, kept: if fine { kept.with_fine() } else { kept }, least, step }
}
