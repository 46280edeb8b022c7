//! Bricks of which every value that is not 0 is kept by itself, and nothing else: thin shells fill little of any box.
//!
//! Which of the 9^3 values of a brick with its apron these are is told by a bit each, in words of 64.
//!
//! ```text
//! bit = 81 z + 9 y + x,  word = bit / 64,  mask = bits of the word below that one
//! share = 0 unless the word has the bit
//!       = shares[first + before[word] + how many bits word & mask has]
//! density = step share
//! ```
//!
//! Fine shares of a brick follow its coarse ones.
//!
//! What an interpolation needs of a layer, two values of a row and two of the next one, is found at once: their bits are
//! within 64 others, and values of a row follow each other.

use wide::{f32x8, u32x8};

use super::apron::{Leaves, STRIDE, VALUES};
use super::bricks::{Extent, SIDE, mix, ranged};
use super::shares::{self, FINE, WHOLE};
use super::span::{Span, places, split};
use super::table::Table;
use crate::lanes::{self, LANES, per_lane};

/// Words of a brick.
const WORDS: usize = VALUES.div_ceil(64);
/// The bit of the last word, beyond those of values, that tells of fine shares.
const HAS_FINE: u64 = 1 << 63;

/// Bits of a layer.
const LAYER: u32 = (STRIDE * STRIDE) as u32;
/// Those of a cell's corners in one layer, from the first one on.
const CORNERS: u64 = 0b11 | 0b11 << STRIDE;

/// The values that are not 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Masks {
    /// Which of `bricks` is where; the first one is empty.
    places: Table<u32>,
    bricks: Vec<Brick>,
    /// Shares, and two more, so that two may be read at the end of every brick.
    pool: Vec<u16>,
}

/// Which values of a brick are not 0, and where their densities are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Brick {
    words: [u64; WORDS],
    /// Values before those of each word.
    before: [u16; WORDS],
    /// Where the shares of the brick begin in the pool.
    first: u32,
    /// Difference between neighbouring shares.
    step: f32,
}

/// The cells that eight points are in: voxels and those behind them.
struct CellsX8<'a> {
    bricks: [&'a Brick; LANES],
    /// Those of the first corners.
    bits: [u32; LANES],
}

impl Masks {
    /// The values of the leaves, of which all that are not 0 are in bricks of this span. Steps larger than this get fine
    /// shares.
    pub fn new(leaves: &Leaves<'_>, span: &Span, largest_step: f32) -> Self {
        let (mut bricks, mut pool, mut numbers) = (vec![Brick::default()], Vec::new(), Vec::new());
        for place in leaves.bricks() {
            if let Some(brick) = Brick::new(&leaves.values(place), &mut pool, largest_step) {
                numbers.push((span.place(place), bricks.len() as u32));
                bricks.push(brick);
            }
        }
        pool.extend([0; 2]);
        bricks.shrink_to_fit();
        pool.shrink_to_fit();
        Self { places: Table::new(span.dims, &numbers), bricks, pool }
    }

    /// What densities range over in so many `layers` of voxels along each axis from `first` on, which are in one brick and
    /// its apron.
    pub fn extent(&self, first: [u32; 3], layers: [u32; 3]) -> Extent {
        let (brick, first) = self.find(first);
        if brick.step == 0.0 {
            return Extent { least: 0.0, most: 0.0, mean: 0.0 };
        }
        let shares = places(first, layers).map(|at| self.share(brick, at));
        let [least, most, mean] = ranged(shares).map(|share| brick.step * share as f32);
        // Two shares that were mixed apart may round to more than either of them.
        Extent { least, most: if brick.has_fine() { most.next_up() } else { most }, mean }
    }

    /// The largest density.
    pub fn most(&self) -> f32 {
        self.bricks.iter().map(|brick| brick.step * WHOLE).fold(0.0, f32::max)
    }

    /// Hands all densities to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(self.places.pages()));
        digest(bytemuck::cast_slice(self.places.all()));
        for Brick { words, before, first, step } in &self.bricks {
            digest(bytemuck::cast_slice(words));
            digest(bytemuck::cast_slice(before));
            digest(&[first.to_le_bytes(), step.to_le_bytes()].concat());
        }
        digest(bytemuck::cast_slice(&self.pool));
    }

    /// Entries of the pool, fine shares and padding included; beyond 2^32 of them, values are not told apart.
    pub fn pool_len(&self) -> usize {
        self.pool.len()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.places.bytes() + size_of_val(self.bricks.as_slice()) + size_of_val(self.pool.as_slice())
    }

    /// Density of the voxel at `place`, for twins.
    pub fn value(&self, place: [u32; 3]) -> f64 {
        let (brick, at) = self.find(place);
        f64::from(brick.step) * self.share(brick, at)
    }

    /// The brick of a voxel, and its place there.
    fn find(&self, place: [u32; 3]) -> (&Brick, [u32; 3]) {
        let (brick, at) = split(place);
        (&self.bricks[*self.places.at(brick) as usize], at)
    }

    /// The share of a value of a brick, in steps.
    fn share(&self, brick: &Brick, at: [u32; 3]) -> f64 {
        let bit = bit(at);
        if !brick.has(bit) {
            return 0.0;
        }
        let coarse = (brick.first + brick.rank(bit)) as usize;
        shares::share(&self.pool, coarse, brick.has_fine().then(|| coarse + brick.values() as usize))
    }

    /// Densities between the voxels at `place` and the next ones, to which points are so far on their way. Not inlined:
    /// what calls it should stay as fast where it is not called.
    #[inline(never)]
    pub fn corners(&self, place: [u32x8; 3], share: [f32x8; 3]) -> f32x8 {
        let cells = self.cells(place);
        let windows = [0, LAYER].map(|further| cells.windows(further));
        let seen = (0..LANES).fold(0, |seen, lane| seen | windows[0][lane] | windows[1][lane]);
        if seen & CORNERS == 0 {
            return f32x8::ZERO;
        }
        let coarse = self.mixed::<false>(&cells, &windows, share);
        densities(&cells, coarse, || self.mixed::<true>(&cells, &windows, share))
    }

    /// Densities of the voxels at `place`.
    #[inline(never)]
    pub fn voxel(&self, place: [u32x8; 3]) -> f32x8 {
        let cells = self.cells(place);
        let seen = seen(&cells.windows(0));
        let [coarse, _] = self.pair(cells.begin::<false>(0), seen);
        densities(&cells, coarse, || self.pair(cells.begin::<true>(0), seen)[0])
    }

    /// Coarse or fine shares, mixed between the corners of cells.
    #[inline(always)]
    fn mixed<const IS_FINE: bool>(
        &self,
        cells: &CellsX8<'_>,
        windows: &[[u64; LANES]; 2],
        [x, y, z]: [f32x8; 3],
    ) -> f32x8 {
        let row = |begin: u32x8, seen: u32x8| {
            let [one, two] = self.pair(begin, seen);
            mix(one, two, x)
        };
        let layer = |further: u32, windows: &[u64; LANES]| {
            let (begin, seen) = (cells.begin::<IS_FINE>(further), seen(windows));
            let passed = u32x8::new(per_lane(|lane| (windows[lane] & ((1 << STRIDE) - 1)).count_ones()));
            mix(row(begin, seen), row(begin + passed, seen >> STRIDE as u32), y)
        };
        mix(layer(0, &windows[0]), layer(LAYER, &windows[1]), z)
    }

    /// Two shares of a row, of which the lowest bits of `seen` say whether they are kept; those that are begin here.
    #[inline(always)]
    fn pair(&self, begin: u32x8, seen: u32x8) -> [f32x8; 2] {
        let begin = begin.to_array();
        let kept = u32x8::new(per_lane(|lane| {
            let kept = &self.pool[begin[lane] as usize..][..2];
            u32::from(kept[0]) | u32::from(kept[1]) << 16
        }));
        let (low, high) = (kept & u32x8::splat(0xffff), kept >> 16_u32);
        let [one, two] = [1, 2].map(|bit| (seen & u32x8::splat(bit)).simd_eq(u32x8::splat(bit)));
        // The second one comes first if there is no first one.
        [low & one, ((high & one) | (low & !one)) & two].map(lanes::to_f32)
    }

    /// The cells of eight voxels.
    #[inline(always)]
    fn cells(&self, place: [u32x8; 3]) -> CellsX8<'_> {
        let numbers = self.places.at_lanes(place.map(|voxel| voxel >> SIDE.ilog2()));
        let [x, y, z] = place.map(|voxel| voxel & u32x8::splat(SIDE - 1));
        let stride = u32x8::splat(STRIDE as u32);
        let bricks = per_lane(|lane| &self.bricks[*numbers[lane] as usize]);
        CellsX8 { bricks, bits: ((z * stride + y) * stride + x).to_array() }
    }
}

impl CellsX8<'_> {
    /// The bits from those of the first corners on, and so many further.
    #[inline(always)]
    fn windows(&self, further: u32) -> [u64; LANES] {
        per_lane(|lane| self.bricks[lane].window(self.bits[lane] + further))
    }

    /// Where coarse or fine shares of what is kept from these bits on begin in the pool.
    #[inline(always)]
    fn begin<const IS_FINE: bool>(&self, further: u32) -> u32x8 {
        u32x8::new(per_lane(|lane| {
            let brick = self.bricks[lane];
            let fine = if IS_FINE && brick.has_fine() { brick.values() } else { 0 };
            brick.first + brick.rank(self.bits[lane] + further) + fine
        }))
    }
}

/// The lowest bits of windows.
#[inline(always)]
fn seen(windows: &[u64; LANES]) -> u32x8 {
    u32x8::new(per_lane(|lane| windows[lane] as u32))
}

/// Densities in eight cells, of coarse shares and, where there are any, fine ones.
#[inline(always)]
fn densities(cells: &CellsX8<'_>, coarse: f32x8, fine: impl Fn() -> f32x8) -> f32x8 {
    let step = f32x8::new(per_lane(|lane| cells.bricks[lane].step));
    let has_fine = per_lane(|lane| cells.bricks[lane].has_fine());
    if has_fine == [false; LANES] {
        return coarse * step;
    }
    // Of bricks without fine shares, what is found instead counts nothing.
    let unit = f32x8::new(has_fine.map(|has_fine| if has_fine { 1.0 / FINE } else { 0.0 }));
    fine().mul_add(unit, coarse) * step
}

/// The bit of a value at its place in a brick.
#[inline(always)]
fn bit([x, y, z]: [u32; 3]) -> u32 {
    let stride = STRIDE as u32;
    (z * stride + y) * stride + x
}

impl Brick {
    /// Adds the shares of `values` to the pool; none if they are all 0.
    fn new(values: &[f32; VALUES], pool: &mut Vec<u16>, largest_step: f32) -> Option<Self> {
        let step = values.iter().copied().fold(0.0, f32::max) / WHOLE;
        if step == 0.0 {
            return None;
        }
        let first = pool.len() as u32;
        let mut brick = Self { first, step, ..Self::default() };
        let mut count = 0;
        for (word, values) in values.chunks(64).enumerate() {
            let bits = values.iter().enumerate().filter(|(_, value)| **value != 0.0);
            brick.words[word] = bits.fold(0, |bits, (bit, _)| bits | 1 << bit);
            brick.before[word] = count;
            count += brick.words[word].count_ones() as u16;
        }
        let kept = values.iter().copied().filter(|value| *value != 0.0);
        if shares::store(pool, kept, [0.0, step], largest_step) {
            brick.words[WORDS - 1] |= HAS_FINE;
        }
        Some(brick)
    }

    #[inline(always)]
    fn has_fine(&self) -> bool {
        self.words[WORDS - 1] & HAS_FINE != 0
    }

    /// Whether a value is kept.
    #[inline(always)]
    fn has(&self, bit: u32) -> bool {
        self.words[bit as usize / 64] >> (bit % 64) & 1 != 0
    }

    /// The bits from this one on: those of two rows, at least, are right.
    #[inline(always)]
    fn window(&self, bit: u32) -> u64 {
        let (word, shift) = (bit as usize / 64, bit % 64);
        let next = self.words[(word + 1).min(WORDS - 1)];
        self.words[word] >> shift | next << 1 << (63 - shift)
    }

    /// How many values are kept before this one.
    #[inline(always)]
    fn rank(&self, bit: u32) -> u32 {
        let word = bit as usize / 64;
        u32::from(self.before[word]) + (self.words[word] & ((1 << (bit % 64)) - 1)).count_ones()
    }

    /// How many values are kept.
    #[inline(always)]
    fn values(&self) -> u32 {
        self.rank(VALUES as u32)
    }
}
