//! Voxels in sparse bricks of 8^3.
//!
//! Of a brick, a [box](Boxes) of values is kept; in grids where these would take more memory than voxels that are not 0, in
//! thin shells, each such value [by itself](Masks).

use std::sync::Arc;

use wide::{f32x8, u32x8};

use super::apron::Leaves;
use super::boxes::Boxes;
use super::masks::Masks;
use super::shares;
use super::span::Span;
use crate::vec3::Vec3x8;

/// Voxels along the edge of a brick.
pub const SIDE: u32 = 8;
/// Most memory that boxes may take, over four bytes for each voxel that is not 0: with a quarter of it for the cells of a
/// coarse field, 1.3.
const MOST_OF_BOXES: f64 = 1.04;
/// How much less masks have to take where boxes take more than that: what is found in them is found later.
const WORTH_IT: f64 = 0.8;
/// Most values, fine shares included, that can be told apart.
const MOST_VALUES: usize = 1 << 32;

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
    /// Index coordinates of the first voxel of the first brick: 8 less than the least i32, at the least.
    pub origin: [i64; 3],
    /// Bricks along each axis.
    pub dims: [u32; 3],
    form: Form,
}

/// How densities are kept.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    Boxes(Boxes),
    Masks(Masks),
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
    /// If there are more than 2^31 bricks from one end to the other, or more values than bricks can hold.
    pub fn new(leaves: &[Leaf]) -> Self {
        Self::try_new(leaves).expect("no more values than bricks hold")
    }

    /// The same; none if there are more values than bricks can hold, 2^32 with those in aprons.
    ///
    /// # Panics
    /// If there are more than 2^31 bricks from one end to the other.
    pub fn try_new(leaves: &[Leaf]) -> Option<Self> {
        Self::of_at_most(leaves, MOST_VALUES)
    }

    /// The same, with `most` in place of 2^32.
    fn of_at_most(leaves: &[Leaf], most: usize) -> Option<Self> {
        let maker = Maker::new(leaves);
        let voxels = values(leaves).filter(|value| *value != 0.0).count();
        let (span, boxes) = maker.boxes();
        if boxes.pool_len() > most {
            return None;
        }
        if boxes.bytes() as f64 <= MOST_OF_BOXES * (voxels * size_of::<f32>()) as f64 {
            return Some(Self::within(&span, Form::Boxes(boxes)));
        }
        let masks = maker.masks(&span);
        let are_worth_it = masks.pool_len() <= most && masks.bytes() as f64 <= WORTH_IT * boxes.bytes() as f64;
        Some(Self::within(&span, if are_worth_it { Form::Masks(masks) } else { Form::Boxes(boxes) }))
    }

    /// Those of a span.
    fn within(span: &Span, form: Form) -> Self {
        let origin = span.first.map(|component| i64::from(component) * i64::from(SIDE));
        Self { origin, dims: span.dims, form }
    }

    /// In boxes, and by masks.
    #[cfg(test)]
    pub(super) fn both(leaves: &[Leaf]) -> [Self; 2] {
        let maker = Maker::new(leaves);
        let (span, boxes) = maker.boxes();
        let masks = maker.masks(&span);
        [Form::Boxes(boxes), Form::Masks(masks)].map(|form| Self::within(&span, form))
    }

    /// What densities range over in the cube of `side` <= 8 voxels from `first` on, which is within one brick; with the
    /// voxels behind it if densities are mixed between (`smooth`).
    pub fn extent(&self, first: [u32; 3], side: u32, smooth: bool) -> Extent {
        self.extent_of(first, [side; 3], smooth)
    }

    /// The same of so many voxels along each axis.
    fn extent_of(&self, first: [u32; 3], sides: [u32; 3], smooth: bool) -> Extent {
        let layers = sides.map(|side| side + u32::from(smooth));
        match &self.form {
            Form::Boxes(boxes) => boxes.extent(first, layers),
            Form::Masks(masks) => masks.extent(first, layers),
        }
    }

    /// The largest density.
    pub fn most(&self) -> f32 {
        match &self.form {
            Form::Boxes(boxes) => boxes.most(),
            Form::Masks(masks) => masks.most(),
        }
    }

    /// What densities range over at points of which the voxels are `low` to `high`, counted from the first one on;
    /// outside of all bricks they are 0. The mean is not asked for, and 0.
    pub fn extent_between(&self, low: [i64; 3], high: [i64; 3], smooth: bool) -> Extent {
        let voxels = self.dims.map(|dim| i64::from(dim) * i64::from(SIDE));
        let within = |axis: usize| low[axis].max(0)..high[axis].saturating_add(1).min(voxels[axis]);
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
        // As i32, which tells all of them apart that are not 2^32 from each other.
        digest(bytemuck::cast_slice(&self.origin.map(|along| along as i32)));
        digest(bytemuck::cast_slice(&self.dims));
        match &self.form {
            Form::Boxes(boxes) => boxes.digest(digest),
            Form::Masks(masks) => masks.digest(digest),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        match &self.form {
            Form::Boxes(boxes) => boxes.bytes(),
            Form::Masks(masks) => masks.bytes(),
        }
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
        let value = match &self.form {
            Form::Boxes(boxes) if smooth => boxes.corners(place, share),
            Form::Boxes(boxes) => boxes.voxel(place),
            Form::Masks(masks) if smooth => masks.corners(place, share),
            Form::Masks(masks) => masks.voxel(place),
        };
        inside.select(value, zero)
    }

    /// Density of the voxel at `place`, counted from the first one; 0 outside. For twins.
    pub fn value(&self, place: [i64; 3]) -> f64 {
        let voxels = self.dims.map(|dim| i64::from(dim) * i64::from(SIDE));
        if (0..3).any(|axis| place[axis] < 0 || place[axis] >= voxels[axis]) {
            return 0.0;
        }
        let place = place.map(|component| component as u32);
        match &self.form {
            Form::Boxes(boxes) => boxes.value(place),
            Form::Masks(masks) => masks.value(place),
        }
    }
}

/// What makes bricks of leaves.
struct Maker<'a> {
    leaves: Leaves<'a>,
    /// Steps larger than this get fine shares.
    largest_step: f32,
}

impl<'a> Maker<'a> {
    fn new(leaves: &'a [Leaf]) -> Self {
        Self { leaves: Leaves::new(leaves), largest_step: shares::largest_step(values(leaves)) }
    }

    /// Boxes, and where they are.
    fn boxes(&self) -> (Span, Boxes) {
        Boxes::new(&self.leaves, self.largest_step)
    }

    /// Masks of what boxes of this span hold.
    fn masks(&self, span: &Span) -> Masks {
        Masks::new(&self.leaves, span, self.largest_step)
    }
}

/// The least, the most and the mean of some values, >= 0.
pub(super) fn ranged(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let (mut least, mut most, mut sum, mut count) = (f64::INFINITY, 0.0_f64, 0.0, 0_u32);
    for value in values {
        (least, most, sum, count) = (least.min(value), most.max(value), sum + value, count + 1);
    }
    [least, most, sum / f64::from(count)]
}

/// What is between `a` and `b`, so far on the way.
#[inline(always)]
pub(super) fn mix(a: f32x8, b: f32x8, share: f32x8) -> f32x8 {
    (b - a).mul_add(share, a)
}

/// All densities of leaves.
fn values(leaves: &[Leaf]) -> impl Iterator<Item = f32> {
    leaves.iter().flat_map(|leaf| leaf.values.iter().copied())
}

#[cfg(test)]
mod tests;
