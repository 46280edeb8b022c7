//! Counter-based random bits: a word is a function of (seed, pixel, sample, dimension) alone.
//!
//! Any decision of any sample can therefore be replayed on its own, and nothing depends on the order in which rows are
//! processed. The bits are integer arithmetic, the same in kernels and twins and on every machine.
//!
//! This page lists every dimension. A *block* is four words; its number is `depth << 16 | number of the purpose`, where
//! `depth` is the number of the vertex that asks (the camera is 0; segment `j` leaves vertex `j`). Blocks are asked for
//! by [`Purpose`], and there are no purposes but those listed here, so that every word that a stage may draw is in
//! [`PURPOSES`].
//!
//! Light importance sampling joins a start with its vertex as MVNEE or a bridge would, from the same blocks under
//! [`lis_seed`].

use wide::u32x8;

use crate::real::{Real, Word};
use crate::{LONGEST_BRIDGED_PATH, LONGEST_PATH};

/// What blocks of random words are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Purpose {
    /// Number of its first block at every depth.
    first: u32,
    /// Blocks in a row.
    blocks: u32,
    /// Whether another block, [`EMITTER`] farther on, is for the emitter of a light that has several.
    light: bool,
}

/// From the block of a light point to that whose first word picks the emitter.
const EMITTER: u32 = 0x80;

impl Purpose {
    const fn one(first: u32) -> Self {
        Self { first, blocks: 1, light: false }
    }

    const fn light_point(first: u32) -> Self {
        Self { light: true, ..Self::one(first) }
    }

    const fn row(first: u32, blocks: u32) -> Self {
        Self { blocks, ..Self::one(first) }
    }

    /// Block `k` of a row.
    ///
    /// # Panics
    /// If the row has no such block, which would be that of another decision. One comparison for eight rows is nothing
    /// next to their hash.
    #[inline(always)]
    pub const fn nth(self, k: u32) -> Self {
        assert!(k < self.blocks, "the row has no such block");
        Self::one(self.first + k)
    }

    /// The block whose first word picks the emitter of a light whose point these blocks are for.
    ///
    /// # Panics
    /// If they are for no light point.
    #[inline(always)]
    pub const fn emitter(self) -> Self {
        assert!(self.light, "the blocks are for no light point");
        Self::one(self.first + EMITTER)
    }

    /// Number of its first block at every depth.
    #[inline(always)]
    pub const fn number(self) -> u32 {
        self.first
    }

    /// Numbers of all blocks that it may ask for at a depth.
    pub fn numbers(self) -> impl Iterator<Item = u32> {
        (self.first..self.first + self.blocks).chain(self.light.then_some(self.first + EMITTER))
    }
}

/// Declares every purpose, and the table of all of them.
macro_rules! purposes {
    ($($(#[$doc:meta])* $name:ident = $purpose:expr;)*) => {
        $($(#[$doc])* pub const $name: Purpose = $purpose;)*

        /// All purposes, by name.
        pub const PURPOSES: &[(&str, Purpose)] = &[$((stringify!($name), $name)),*];
    };
}

purposes! {
    /// The place of a sample on the film, and its first flight: film x, film y, free or aimed, the aimed one.
    CAMERA = Purpose::one(0);
    /// One step of the walk: free flight, cosine and azimuth of the scattering at its end, survival of the vertex it
    /// leaves.
    SEGMENT = Purpose::one(1);
    /// The light point of next event estimation: light, two for the point on it, roulette.
    NEE_LIGHT = Purpose::light_point(2);
    /// The same for multiple-vertex next event estimation.
    MVNEE_LIGHT = Purpose::light_point(3);
    /// The same for once-more next event estimation.
    OMNEE_LIGHT = Purpose::light_point(4);
    /// The same for bridges.
    BRIDGE_LIGHT = Purpose::light_point(5);
    /// The inserted vertex of once-more next event estimation: turn, first angle, azimuth, -.
    OMNEE_VERTEX = Purpose::one(6);
    /// How many edges a bridge has: uniform or tabulated and the table's turn, the count, roll, the table's distance.
    BRIDGE_COUNT = Purpose::one(7);
    /// The same for light importance sampling.
    LIS_LIGHT = Purpose::light_point(8);
    /// The same for its companion.
    LIS_NEAR_LIGHT = Purpose::light_point(9);
    /// The vertex made from the light: cosine, azimuth, flight, side.
    LIS_VERTEX = Purpose::one(10);
    /// The hero of a path: channel, -, -, -.
    HERO = Purpose::one(11);
    /// The streams of a flight's collisions.
    TRACKING = Purpose::one(12);
    /// The light point of connections to lights at infinity: light, two for the direction, roulette; the words for an
    /// emitter pick the pixel of an image.
    DISTANT_LIGHT = Purpose::light_point(13);
    /// The stream of the points at which a flight asks for emission.
    GLOW = Purpose::one(14);
    /// Names the streams of the transmittance of what the camera sees first; the block itself is not drawn from.
    FEATURES = Purpose::one(15);
    /// The streams of the transmittance of connections to light points of a purpose, one per segment; view the first.
    TRANSMITTANCE = Purpose::row(0x10, 0x10);
    /// The places of rays through the cells of a pixel that an outline passes through: film x, film y, -, -.
    OUTLINE = Purpose::row(0x20, crate::outline::LOOKS);
    /// The seeds' free flights: block k has those of seeds 4 k .. 4 k + 4.
    MVNEE_FLIGHTS = Purpose::row(0x100, LONGEST_BRIDGED_PATH / 4);
    /// The seeds' perturbations: block k has radius and azimuth of seed 2 k, then of seed 2 k + 1.
    MVNEE_OFFSETS = Purpose::row(0x200, LONGEST_BRIDGED_PATH / 2);
    /// A bridge's free walks: block k has length of edge k, azimuth of the turn at its end, and a cosine for each
    /// alternative; of the last edge, which walk is chosen, and which end comes first, in the place of cosines.
    BRIDGE_WALK = Purpose::row(0x400, LONGEST_BRIDGED_PATH);
}

/// Bits of a block's number that say what it is for.
const PURPOSE_BITS: u32 = 16;
const _: () = assert!(LONGEST_PATH - 1 <= u32::MAX >> PURPOSE_BITS, "every vertex has blocks of its own");

/// Number of the block that the vertex at `depth` uses for `purpose`, the first one of a row.
#[inline(always)]
pub fn block<W: Word>(depth: W, purpose: Purpose) -> W {
    depth.shifted_left(PURPOSE_BITS) | W::splat(purpose.first)
}

/// The seed under which light importance sampling draws its bridges and its seeds on the axis: with the frame's own
/// they would repeat what MVNEE and bridges draw for the same start.
#[inline(always)]
pub fn lis_seed(seed: u32) -> u32 {
    seed ^ 0x85eb_ca6b
}

const MULTIPLIER: u32 = 1_664_525;
const INCREMENT: u32 = 1_013_904_223;

/// Four words for a key of four: the hash pcg4d (Jarzynski and Olano, Hash Functions for GPU Rendering, JCGT 2020).
#[inline(always)]
pub fn words<W: Word>(pixel: W, sample: W, block: W, seed: u32) -> [W; 4] {
    hash([pixel, sample, block, W::splat(seed)])
}

#[inline(always)]
fn hash<W: Word>(key: [W; 4]) -> [W; 4] {
    let mut v = key.map(|v| v.wrapping_mul(W::splat(MULTIPLIER)).wrapping_add(W::splat(INCREMENT)));
    for _ in 0..2 {
        let [x, y, z, w] = v;
        let x = x.wrapping_add(y.wrapping_mul(w));
        let y = y.wrapping_add(z.wrapping_mul(x));
        let z = z.wrapping_add(x.wrapping_mul(y));
        let w = w.wrapping_add(y.wrapping_mul(z));
        v = [x, y, z, w].map(|v| v ^ v.shifted_right(16));
    }
    v
}

/// Words without end, for decisions of which nobody knows the number: those of a block, hashed again with a counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream(pub [u32; 4]);

impl Stream {
    /// Number `part` of the streams that belong to a block.
    pub fn new(pixel: u32, sample: u32, block: u32, seed: u32, part: u32) -> Self {
        let [a, b, c, d] = words(pixel, sample, block, seed);
        Self([a, b, c.wrapping_add(part), d])
    }

    /// The words of [`Stream::new`] for eight rows.
    #[inline(always)]
    pub fn new_x8(pixel: u32x8, sample: u32x8, block: u32x8, seed: u32, part: u32) -> [u32x8; 4] {
        let [a, b, c, d] = words(pixel, sample, block, seed);
        [a, b, c + u32x8::splat(part), d]
    }

    /// Words number `4 counter` and on.
    pub fn words(self, counter: u32) -> [u32; 4] {
        let [a, b, c, d] = self.0;
        hash([a, b, c, d.wrapping_add(counter)])
    }

    /// [`Stream::words`] of eight streams.
    #[inline(always)]
    pub fn words_x8([a, b, c, d]: [u32x8; 4], counter: u32x8) -> [u32x8; 4] {
        hash([a, b, c, d + counter])
    }
}

/// Bits dropped so that the centre of every cell is a representable number.
const DROPPED: u32 = 9;
/// Width of a cell: 2^-23.
const CELL: f32 = 1.0 / (1 << 23) as f32;

/// A uniform number in (0, 1): the centre of one of 2^23 equal cells.
///
/// It is exact in `f32`, as is `1 - u`, and neither is ever 0: no logarithm, division or square root behind it needs
/// an edge case. The longest free flight drawn from it is 16.6 mean free paths.
#[inline(always)]
pub fn uniform(word: u32) -> f64 {
    (f64::from(word >> DROPPED) + 0.5) * f64::from(CELL)
}

/// [`uniform`] as `f32`, in which it is exact.
#[inline(always)]
pub fn uniform_f32<W: Word>(word: W) -> W::Real {
    let (cell, half) = (W::Real::splat(CELL), W::Real::splat(0.5 * CELL));
    word.shifted_right(DROPPED).to_real().mul_add(cell, half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_decisions_of_a_sample_share_a_block() {
        // What asks is a vertex of a path, the camera is vertex 0 and the light asks nothing.
        for seed in [0, 1, u32::MAX] {
            let mut keys = Vec::new();
            for seed in [seed, lis_seed(seed)] {
                for depth in (0..600).chain(LONGEST_PATH - 600..LONGEST_PATH) {
                    let numbers = PURPOSES.iter().flat_map(|(_, purpose)| purpose.numbers());
                    keys.extend(numbers.map(|number| (seed, block(depth, Purpose::one(number)))));
                }
            }
            keys.sort_unstable();
            if let Some(pair) = keys.windows(2).find(|pair| pair[0] == pair[1]) {
                let block = pair[0].1;
                let (depth, number) = (block >> PURPOSE_BITS, block & ((1 << PURPOSE_BITS) - 1));
                let asks = |purpose: &Purpose| purpose.numbers().any(|other| other == number);
                let names: Vec<_> =
                    PURPOSES.iter().filter(|(_, purpose)| asks(purpose)).map(|(name, _)| name).collect();
                panic!("block {number:#x} at depth {depth} is asked for twice under one seed, by {names:?}");
            }
        }
    }

    #[test]
    fn a_block_that_is_not_declared_is_refused_in_every_build() {
        let refused = |ask: fn() -> Purpose| std::panic::catch_unwind(ask).is_err();
        assert!(
            !refused(|| BRIDGE_WALK.nth(LONGEST_BRIDGED_PATH - 1)) && refused(|| BRIDGE_WALK.nth(LONGEST_BRIDGED_PATH))
        );
        assert!(!refused(|| SEGMENT.nth(0)) && refused(|| SEGMENT.nth(1)));
        assert!(!refused(|| NEE_LIGHT.emitter()) && refused(|| BRIDGE_COUNT.emitter()));
    }

    #[test]
    fn rows_have_a_block_for_every_vertex_of_the_longest_connection() {
        // A connection starts behind the camera, so that it has fewer edges than the path has segments.
        let edges = LONGEST_BRIDGED_PATH - 1;
        let last = |purpose: Purpose| purpose.numbers().count() as u32 - 1;
        assert!(last(BRIDGE_WALK) >= edges - 1);
        // Counting looks for one seed more than fits.
        assert!(last(MVNEE_FLIGHTS) >= edges / 4 && last(MVNEE_OFFSETS) >= edges / 2);
    }

    #[test]
    fn blocks_of_lanes_are_those_of_rows() {
        let depths = [0, 1, 2, 3, 7, 100, 1000, LONGEST_PATH - 1];
        for (name, purpose) in PURPOSES {
            let lanes = block(u32x8::new(depths), *purpose).to_array();
            assert_eq!(lanes, depths.map(|depth| block(depth, *purpose)), "{name}");
        }
    }

    #[test]
    fn lanes_draw_the_same_words_as_rows() {
        let (pixel, sample, block) = ([0, 1, 2, 3, 500, 65_535, 1 << 20, u32::MAX], [7; 8], [block(3, SEGMENT); 8]);
        let lanes = words(u32x8::new(pixel), u32x8::new(sample), u32x8::new(block), 9).map(|w| w.to_array());
        for lane in 0..8 {
            let row = words(pixel[lane], sample[lane], block[lane], 9);
            assert_eq!(lanes.map(|word| word[lane]), row, "lane {lane}");
        }
    }

    #[test]
    fn uniform_numbers_are_exact_and_never_zero_or_one() {
        for word in [0, 1, 511, 512, 1 << 31, u32::MAX - 512, u32::MAX] {
            let u = uniform(word);
            assert!(u > 0.0 && u < 1.0, "{word} gives {u}");
            assert_eq!(f64::from(uniform_f32(u32x8::splat(word)).to_array()[0]), u);
            assert_eq!(f64::from(1.0 - u as f32), 1.0 - u);
        }
    }
}
