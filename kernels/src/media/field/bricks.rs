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
use crate::vec3x8::Vec3x8;

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
        let boxes = maker.boxes();
        if boxes.pool_len() > most {
            return None;
        }
        if boxes.bytes() as f64 <= MOST_OF_BOXES * (voxels * size_of::<f32>()) as f64 {
            return Some(boxes);
        }
        let masks = maker.masks(&boxes);
        let are_worth_it = masks.pool_len() <= most && masks.bytes() as f64 <= WORTH_IT * boxes.bytes() as f64;
        Some(if are_worth_it { masks } else { boxes })
    }

    /// In boxes, and by masks.
    #[cfg(test)]
    pub(super) fn both(leaves: &[Leaf]) -> [Self; 2] {
        let maker = Maker::new(leaves);
        let boxes = maker.boxes();
        let masks = maker.masks(&boxes);
        [boxes, masks]
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

    /// Entries of the pool of values.
    fn pool_len(&self) -> usize {
        match &self.form {
            Form::Boxes(boxes) => boxes.pool_len(),
            Form::Masks(masks) => masks.pool_len(),
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

    fn boxes(&self) -> Bricks {
        let (span, boxes) = Boxes::new(&self.leaves, self.largest_step);
        Bricks {
            origin: span.first.map(|component| i64::from(component) * i64::from(SIDE)),
            dims: span.dims,
            form: Form::Boxes(boxes),
        }
    }

    /// What `boxes` hold.
    fn masks(&self, boxes: &Bricks) -> Bricks {
        let Bricks { origin, dims, .. } = *boxes;
        let span = Span { first: origin.map(|component| (component / i64::from(SIDE)) as i32), dims };
        Bricks { origin, dims, form: Form::Masks(Masks::new(&self.leaves, &span, self.largest_step)) }
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
            let tolerance = 1e-3 * (1.0 + f64::from(most) / 512.0);
            for (bricks, voxel) in
                Bricks::both(&leaves).iter().flat_map(|form| (0..512).map(move |voxel| (form, voxel)))
            {
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
        let bytes = |leaves: &[Leaf]| Bricks::both(leaves).map(|form| form.bytes());
        let [even, dense, most] = [2.0, 90.0, 1e3].map(|most| bytes(&spiky(most)));
        let far = Leaf { origin: [80, 0, 0], ..spiky(2.0)[0].clone() };
        let [both, alone] = [bytes(&[spiky(1e4)[0].clone(), far.clone()]), bytes(&[spiky(2.0)[0].clone(), far])];
        for form in 0..2 {
            assert_eq!(even[form], dense[form]);
            assert!(most[form] > even[form], "{} bytes, {} of the others", most[form], even[form]);
        }
        for form in 0..2 {
            assert_eq!(both[form] - alone[form], 1024, "the 512 values of one brick of sixteen have fine shares");
        }
    }

    #[test]
    fn extents_hold_all_densities_between_voxels() {
        for (most, form) in [2.0, 1e4, 1e7].into_iter().flat_map(|most| [(most, 0), (most, 1)]) {
            let bricks = &Bricks::both(&spiky(most))[form];
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

    #[test]
    fn more_values_than_can_be_told_apart_are_too_many() {
        for leaves in [shell(2.0), shell(42.0)] {
            let kept = Maker::new(&leaves).boxes().pool_len();
            let at_most = |most: usize| Bricks::of_at_most(&leaves, most);
            assert_eq!(at_most(kept), Some(Bricks::new(&leaves)));
            assert_eq!(at_most(kept - 1), None);
            assert!(Bricks::new(&leaves).pool_len() <= kept);
        }
    }

    #[test]
    fn leaves_may_be_where_the_first_numbers_are() {
        let far = Leaf { origin: [i32::MIN, 0, i32::MIN + 8], ..spiky(2.0)[0].clone() };
        for bricks in Bricks::both(&[far]) {
            let before = [i64::from(i32::MIN) - 8, -8, i64::from(i32::MIN)];
            assert_eq!((bricks.origin, bricks.dims), (before, [2; 3]));
            assert!(bricks.value([8; 3]) > 0.4 && bricks.value([16, 8, 8]) == 0.0);
            let beyond = bricks.extent_between([i64::MIN; 3], [i64::MAX; 3], true);
            assert!(beyond.least == 0.0 && beyond.most > 1.9, "{beyond:?}");
        }
    }

    /// Leaves of a shell of this thickness, in voxels, of densities about 1; every fourth of its leaves has one density.
    fn shell(thickness: f64) -> Vec<Leaf> {
        let leaf = |number: u32| {
            let origin = [number % 7, number / 7 % 7, number / 49].map(|along| 8 * along as i32 - 24);
            let value = |voxel: usize| {
                let at = [voxel % 8, voxel / 8 % 8, voxel / 64];
                let from_centre = (0..3).map(|axis| f64::from(origin[axis]) + at[axis] as f64 - 3.7).map(|d| d * d);
                let inside = (from_centre.sum::<f64>().sqrt() - 21.0).abs() < thickness / 2.0;
                let varied = random::uniform(random::words(number, voxel as u32, 8, 9)[0]) as f32;
                let density = if number.is_multiple_of(4) { 0.5 } else { 0.5 + varied };
                if inside { density } else { 0.0 }
            };
            Leaf { origin, values: Arc::new(core::array::from_fn(value)) }
        };
        (0..343).map(leaf).filter(|leaf| leaf.values.iter().any(|value| *value != 0.0)).collect()
    }

    #[test]
    fn thin_shells_take_little_more_than_their_voxels() {
        for (thickness, thin) in [(2.0, true), (4.0, true), (42.0, false)] {
            let leaves = shell(thickness);
            let bricks = Bricks::new(&leaves);
            assert_eq!(matches!(bricks.form, Form::Masks(_)), thin, "a shell of {thickness} voxels");
            let voxels = 4 * values(&leaves).filter(|value| *value != 0.0).count();
            let share = bricks.bytes() as f64 / voxels as f64;
            assert!(share <= 1.3, "a shell of {thickness} voxels: {share}");
        }
    }

    #[test]
    fn densities_of_thin_shells_are_those_of_boxes() {
        let mut leaves = shell(2.0);
        // Every fifth leaf has something far denser, and fine shares.
        for leaf in leaves.iter_mut().step_by(5) {
            let value = Arc::make_mut(&mut leaf.values).iter_mut().rfind(|value| **value != 0.0);
            *value.expect("a voxel of the shell") = 300.0;
        }
        let [boxes, masks] = Bricks::both(&leaves);
        let mut filled = 0;
        for seed in 0..20_000 {
            // Over the borders, too.
            let words = random::words(seed, 1, 4, 9);
            let along = |axis: u32| {
                let word = |lane: usize| random::words(seed, axis, lane as u32, 8)[0];
                f32x8::new(crate::lanes::per_lane(|lane| 66.0 * random::uniform(word(lane)) as f32 - 1.0))
            };
            let at = Vec3x8::new(along(0), along(1), along(2));
            for smooth in [true, false] {
                let [expected, found] = [&boxes, &masks].map(|form| form.density(at, smooth).to_array());
                for (expected, found) in expected.into_iter().zip(found) {
                    assert!((found - expected).abs() < 1e-4, "{found} instead of {expected} at {at:?}");
                    filled += u32::from(found > 0.0);
                }
            }
            let (place, side) = (words.map(|word| word % 50), 1 << (words[3] % 4));
            let first = [place[0], place[1], place[2]].map(|along| along / side * side);
            for smooth in [true, false] {
                let [expected, found] = [&boxes, &masks].map(|form| form.extent(first, side, smooth));
                for (expected, found) in [expected.least, expected.most, expected.mean].into_iter().zip([
                    found.least,
                    found.most,
                    found.mean,
                ]) {
                    assert!((found - expected).abs() < 1e-4, "{found} instead of {expected} from {first:?} on");
                }
            }
            let voxel = [place[0], place[1], place[2]].map(i64::from);
            assert!((boxes.value(voxel) - masks.value(voxel)).abs() < 1e-4, "at {voxel:?}");
        }
        assert!(filled > 16_000, "{filled} points in the shell");
    }
}
