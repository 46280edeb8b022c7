//! Eight lanes: which are live, which passed a test, and how the survivors are packed to the left.
//!
//! A test on eight rows is an `f32x8` whose lanes are all ones or all zeros; its [`bits`] are the same as one `u32`,
//! lane 0 in bit 0.

use core::ops::Range;

use bumpalo::Bump;
use wide::{f32x8, u32x8};

/// Rows in a batch.
pub const LANES: usize = 8;

/// Batches that loops over single rows take in one go: enough rows for the widest registers to be full, and few enough
/// to leave out those that are dead.
pub const STRETCH: usize = 16;

/// Bits of eight live lanes.
pub const ALL: u32 = 0xff;

/// Lane mask as bits, lane 0 in bit 0.
#[inline(always)]
pub fn bits(mask: f32x8) -> u32 {
    mask.to_bitmask()
}

/// Bits of the first `count` lanes: the lanes of the last batch of `count` rows.
#[inline(always)]
pub fn first(count: usize) -> u32 {
    if count >= LANES { ALL } else { (1 << count) - 1 }
}

/// The mask whose bits are `bits`.
#[inline(always)]
pub fn mask(bits: u32) -> f32x8 {
    let lane = u32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
    as_mask((u32x8::splat(bits) & lane).simd_eq(lane))
}

/// An integer comparison as a mask of real lanes.
#[inline(always)]
pub fn as_mask(mask: u32x8) -> f32x8 {
    bytemuck::cast(mask)
}

/// The lanes that hold `number`.
#[inline(always)]
pub fn equal(words: u32x8, number: usize) -> u32 {
    bits(as_mask(words.simd_eq(u32x8::splat(number as u32))))
}

/// A mask of real lanes as one of integers.
#[inline(always)]
pub fn as_integer_mask(mask: f32x8) -> u32x8 {
    bytemuck::cast(mask)
}

/// Counts, below 2^24, as real numbers.
#[inline(always)]
pub fn to_f32(counts: u32x8) -> f32x8 {
    f32x8::from_i32x8(bytemuck::cast(counts))
}

/// The values of a column at these indices, which are within it.
#[inline(always)]
pub fn gather(column: &[f32], at: u32x8) -> f32x8 {
    let at = at.to_array();
    f32x8::new(per_lane(|lane| column[at[lane] as usize]))
}

/// What `of` makes of each lane. Written out, so that values go into registers and not through a loop over memory.
#[inline(always)]
pub fn per_lane<T>(mut of: impl FnMut(usize) -> T) -> [T; LANES] {
    [of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)]
}

/// The indices of the set bits, ascending.
#[inline(always)]
pub fn each(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        let found = (bits != 0).then_some(lane);
        bits &= bits.wrapping_sub(1);
        found
    })
}

/// The order that moves the lanes set in `bits` to the front and keeps their sequence.
#[inline(always)]
pub fn pack_order(bits: u32) -> u32x8 {
    u32x8::new(PACK_ORDER[(bits & ALL) as usize])
}

/// `value` with its lanes in the sequence `order`.
#[inline(always)]
pub fn reorder_f32(value: f32x8, order: u32x8) -> f32x8 {
    bytemuck::cast(bytemuck::cast::<f32x8, u32x8>(value).shuffle(order))
}

const PACK_ORDER: [[u32; LANES]; 256] = {
    let mut table = [[0; LANES]; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut packed) = (0, 0);
        while lane < LANES {
            if bits >> lane & 1 == 1 {
                table[bits][packed] = lane as u32;
                packed += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// Lane indices `8 b .. 8 b + 8`.
#[inline(always)]
pub fn indices(batch: usize) -> u32x8 {
    u32x8::splat((batch * LANES) as u32) + u32x8::new([0, 1, 2, 3, 4, 5, 6, 7])
}

/// One bit per row of a table: eight rows a byte, eight bytes a word.
pub struct LaneSet<'q> {
    /// Bytes beyond the last batch are 0.
    words: &'q mut [u64],
    batches: usize,
}

/// Batches in a word.
const WORD: usize = size_of::<u64>();

impl<'q> LaneSet<'q> {
    /// The empty set over `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize) -> Self {
        let batches = rows.div_ceil(LANES);
        Self { words: arena.alloc_slice_fill_copy(batches.div_ceil(WORD), 0), batches }
    }

    /// Number of batches.
    #[inline(always)]
    pub fn batches(&self) -> usize {
        self.batches
    }

    #[inline(always)]
    fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(self.words)[..self.batches]
    }

    #[inline(always)]
    fn bytes_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(self.words)[..self.batches]
    }

    /// Indices and bits of the batches that hold any row.
    #[inline(always)]
    pub fn each_batch(&self) -> impl Iterator<Item = (usize, u32)> + '_ {
        self.bytes().iter().enumerate().filter(|(_, byte)| **byte != 0).map(|(b, byte)| (b, u32::from(*byte)))
    }

    /// Number of stretches, of [`STRETCH`] batches each but for the last one.
    #[inline(always)]
    pub fn stretches(&self) -> usize {
        self.batches.div_ceil(STRETCH)
    }

    /// The batches of stretch `k`, if any row of them is in the set.
    #[inline(always)]
    pub fn stretch(&self, k: usize) -> Option<Range<usize>> {
        let batches = k * STRETCH..self.batches.min((k + 1) * STRETCH);
        let words = batches.start / WORD..batches.end.div_ceil(WORD);
        self.words[words].iter().any(|word| *word != 0).then_some(batches)
    }

    /// The batches of all stretches that have rows in the set.
    #[inline(always)]
    pub fn each_stretch(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        (0..self.stretches()).filter_map(|k| self.stretch(k))
    }

    /// The rows in the set, ascending.
    pub fn each(&self) -> impl Iterator<Item = usize> + '_ {
        self.each_batch().flat_map(|(b, bits)| each(bits).map(move |lane| b * LANES + lane))
    }

    /// The bits of batch `b`.
    #[inline(always)]
    pub fn batch(&self, b: usize) -> u32 {
        u32::from(self.bytes()[b])
    }

    /// Whether row `lane` is in the set.
    #[inline(always)]
    pub fn contains(&self, lane: usize) -> bool {
        self.bytes()[lane / LANES] >> (lane % LANES) & 1 == 1
    }

    /// Which of the first `count` rows that `lane_of` names are in the set, as bits.
    #[inline(always)]
    pub fn among(&self, lane_of: &[u32; LANES], count: usize) -> u32 {
        (0..count).filter(|i| self.contains(lane_of[*i] as usize)).fold(0, |bits, i| bits | 1 << i)
    }

    /// Adds row `lane`.
    #[inline(always)]
    pub fn insert(&mut self, lane: usize) {
        self.bytes_mut()[lane / LANES] |= 1 << (lane % LANES);
    }

    /// Removes row `lane`.
    #[inline(always)]
    pub fn remove(&mut self, lane: usize) {
        self.bytes_mut()[lane / LANES] &= !(1 << (lane % LANES));
    }

    /// Adds the rows of batch `b` whose bit is set in `bits`.
    #[inline(always)]
    pub fn insert_batch(&mut self, b: usize, bits: u32) {
        self.bytes_mut()[b] |= bits as u8;
    }

    /// Removes all rows.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Adds exactly the rows of `other`, and removes all others.
    pub fn copy_from(&mut self, other: &LaneSet<'_>) {
        self.words.copy_from_slice(other.words);
    }

    /// Removes the rows of batch `b` whose bit is set in `bits`.
    #[inline(always)]
    pub fn remove_batch(&mut self, b: usize, bits: u32) {
        self.bytes_mut()[b] &= !(bits as u8);
    }

    /// Indices of the batches with rows that are in this set and not in `other`, and the bits of these rows.
    #[inline(always)]
    pub fn batches_without<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (usize, u32)> + 'a {
        let words = self.words.iter().zip(other.words.iter());
        batches_of(words.map(|(mine, other)| mine & !other))
    }

    /// The first batch from `first` on with rows that are not in this set, and the bits of these rows.
    #[inline(always)]
    pub fn vacant_from(&self, first: usize) -> Option<(usize, u32)> {
        let mut b = first;
        while b < self.batches {
            if b.is_multiple_of(WORD) && self.words[b / WORD] == u64::MAX {
                b += WORD;
                continue;
            }
            let vacant = !self.batch(b) & ALL;
            if vacant != 0 {
                return Some((b, vacant));
            }
            b += 1;
        }
        None
    }

    /// The rows that are in this set and not in `other`, ascending.
    pub fn without<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = usize> + 'a {
        self.batches_without(other).flat_map(|(b, bits)| each(bits).map(move |lane| b * LANES + lane))
    }

    /// Number of rows in the set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether no row is in the set.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }
}

/// Indices and bits of the batches that hold any row, in the words of a set.
#[inline(always)]
fn batches_of(words: impl Iterator<Item = u64>) -> impl Iterator<Item = (usize, u32)> {
    (0..).step_by(WORD).zip(words).filter(|(_, word)| *word != 0).flat_map(|(first, word)| {
        let bytes = word.to_ne_bytes().into_iter().enumerate();
        bytes.filter(|(_, byte)| *byte != 0).map(move |(b, byte)| (first + b, u32::from(byte)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mask_packs_its_lanes_to_the_front_in_order() {
        for bits in 0..=ALL {
            let expected: Vec<u32> = (0..8).filter(|lane| bits >> lane & 1 == 1).collect();
            let order = pack_order(bits).to_array();
            assert_eq!(&order[..expected.len()], &expected[..], "bits {bits:08b}");
            assert_eq!(each(bits).map(|lane| lane as u32).collect::<Vec<_>>(), expected);
            assert_eq!(super::bits(mask(bits)), bits);
        }
    }

    #[test]
    fn tails_cover_exactly_their_rows() {
        for count in 0..=17 {
            assert_eq!(first(count).count_ones() as usize, count.min(LANES));
        }
    }

    #[test]
    fn batches_of_lane_sets_are_found_word_by_word() {
        let arena = Bump::new();
        for rows in [1, 8, 60, 64, 65, 150, 520] {
            let [mut mine, mut other] = [(); 2].map(|()| LaneSet::new_in(&arena, rows));
            (0..rows).filter(|row| row % 5 < 2 || row % 70 > 40).for_each(|row| mine.insert(row));
            (0..rows).filter(|row| row % 3 == 0 || row % 90 > 50).for_each(|row| other.insert(row));
            let lanes = |b: usize| b * LANES..(b + 1) * LANES;
            let bits = |b: usize, of: &dyn Fn(usize) -> bool| {
                lanes(b).enumerate().filter(|(_, row)| of(*row)).fold(0, |bits, (i, _)| bits | 1 << i)
            };
            let expected = |of: &dyn Fn(usize) -> bool| -> Vec<(usize, u32)> {
                (0..mine.batches()).map(|b| (b, bits(b, of))).filter(|(_, bits)| *bits != 0).collect()
            };
            let without = expected(&|row| mine.contains(row) && !other.contains(row));
            assert_eq!(mine.batches_without(&other).collect::<Vec<_>>(), without, "{rows} rows");
            let vacant = expected(&|row| !mine.contains(row));
            let next = |found: &(usize, u32)| mine.vacant_from(found.0 + 1);
            assert!(core::iter::successors(mine.vacant_from(0), next).eq(vacant), "{rows} rows");
            assert_eq!(mine.count(), mine.each().count(), "{rows} rows");
            assert_eq!(mine.is_empty(), mine.each().next().is_none(), "{rows} rows");
            for k in 0..mine.stretches() {
                let batches = k * STRETCH..mine.batches().min((k + 1) * STRETCH);
                let any = batches.clone().any(|b| mine.batch(b) != 0);
                assert_eq!(mine.stretch(k), any.then_some(batches), "{rows} rows, stretch {k}");
            }
        }
    }

    #[test]
    fn a_lane_set_holds_what_was_inserted() {
        let arena = Bump::new();
        let mut set = LaneSet::new_in(&arena, 20);
        for lane in [0, 7, 8, 19] {
            set.insert(lane);
        }
        assert_eq!((set.count(), set.batches()), (4, 3));
        set.remove(7);
        set.remove_batch(1, 1);
        assert_eq!(set.each().collect::<Vec<_>>(), [0, 19]);
        assert!(set.contains(0) && set.contains(19) && !set.contains(7) && !set.contains(8));
        let lane_of = [19, 7, 0, 8, 19, 3, 0, 0];
        assert_eq!([8, 5, 2, 0].map(|count| set.among(&lane_of, count)), [0b1101_0101, 0b1_0101, 1, 0]);
    }
}
