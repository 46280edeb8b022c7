//! Counter-based random bits: a word is a function of (seed, pixel, sample, dimension) alone.
//!
//! Any decision of any sample can therefore be replayed on its own, and nothing depends on the order in which rows are
//! processed. The bits are integer arithmetic, the same in kernels and twins and on every machine.
//!
//! This page lists every dimension. A *block* is four words; its number is `depth << 16 | purpose`, where `depth` is
//! the number of the vertex that asks (the camera is 0; segment `j` leaves vertex `j`).
//!
//! | purpose | words |
//! |---|---|
//! | [`CAMERA`] | film x, film y, free or aimed first flight, the aimed one |
//! | [`SEGMENT`] | free flight, cosine and azimuth of the scattering at its end, survival of the vertex it leaves |
//! | [`NEE_LIGHT`] | light, two for the point on it, roulette |
//! | [`MVNEE_LIGHT`] | the same for MVNEE |
//! | [`OMNEE_LIGHT`] | the same for OMNEE |
//! | [`BRIDGE_LIGHT`] | the same for bridges |
//! | [`LIS_LIGHT`], [`LIS_NEAR_LIGHT`] | the same for light importance sampling and its companion |
//! | any of these ` + `[`EMITTER`] | emitter of the light, -, -, - |
//! | [`OMNEE_VERTEX`] | turn, first angle and azimuth of the inserted vertex, - |
//! | [`LIS_VERTEX`] | cosine, azimuth, flight and side of the vertex made from the light |
//! | [`BRIDGE_COUNT`] | uniform or tabulated count and the table's turn, the count, roll, the table's distance |
//! | [`MVNEE_FLIGHTS`]` + k` | free flights of the seeds 4 k .. 4 k + 4 |
//! | [`MVNEE_OFFSETS`]` + k` | radius and azimuth of the perturbation of seeds 2 k and 2 k + 1 |
//! | [`BRIDGE_WALK`]` + k` | length of edge k, cosine and azimuth of the turn at its end, - |
//!
//! Light importance sampling joins a start with its vertex as MVNEE or a bridge would, from the same blocks under
//! [`lis_seed`].

use wide::{f32x8, i32x8, u32x8};

/// The place of a sample on the film, and its first flight.
pub const CAMERA: u32 = 0;
/// One step of the walk.
pub const SEGMENT: u32 = 1;
/// The light point of next event estimation.
pub const NEE_LIGHT: u32 = 2;
/// The light point of multiple-vertex next event estimation.
pub const MVNEE_LIGHT: u32 = 3;
/// The light point of once-more next event estimation.
pub const OMNEE_LIGHT: u32 = 4;
/// The light point of a bridge.
pub const BRIDGE_LIGHT: u32 = 5;
/// The inserted vertex of once-more next event estimation.
pub const OMNEE_VERTEX: u32 = 6;
/// How many edges a bridge has, by which knots of the table, and how it is rolled.
pub const BRIDGE_COUNT: u32 = 7;
/// The light point of light importance sampling.
pub const LIS_LIGHT: u32 = 8;
/// The light point of its companion.
pub const LIS_NEAR_LIGHT: u32 = 9;
/// The vertex made from the light.
pub const LIS_VERTEX: u32 = 10;
/// Added to the purpose of a light point: the emitter of a light that has several.
pub const EMITTER: u32 = 0x80;
/// First block of the seeds' free flights; room for 1024 seeds.
pub const MVNEE_FLIGHTS: u32 = 0x100;
/// First block of the seeds' perturbations; room for 1024 seeds.
pub const MVNEE_OFFSETS: u32 = 0x200;
/// First block of a bridge's free walk; room for 1024 edges.
pub const BRIDGE_WALK: u32 = 0x400;

/// Number of the block that the vertex at `depth` uses for `purpose`.
#[inline(always)]
pub fn block(depth: u32, purpose: u32) -> u32 {
    depth << 16 | purpose
}

/// The seed under which light importance sampling draws its bridges and its seeds on the axis: with the frame's own they
/// would repeat what MVNEE and bridges draw for the same start.
#[inline(always)]
pub fn lis_seed(seed: u32) -> u32 {
    seed ^ 0x85eb_ca6b
}

const MULTIPLIER: u32 = 1_664_525;
const INCREMENT: u32 = 1_013_904_223;

/// Four words for a key of four: the hash pcg4d (Jarzynski and Olano, Hash Functions for GPU Rendering, JCGT 2020).
pub fn words(pixel: u32, sample: u32, block: u32, seed: u32) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] =
        [pixel, sample, block, seed].map(|v| v.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT));
    let mut round = || {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        [x, y, z, w] = [x, y, z, w].map(|v| v ^ v >> 16);
        [x, y, z, w]
    };
    round();
    let [x, y, z, w] = round();
    [x, y, z, w]
}

/// [`words`] for eight rows.
#[inline(always)]
pub fn words_x8(pixel: u32x8, sample: u32x8, block: u32x8, seed: u32) -> [u32x8; 4] {
    let lcg = |v: u32x8| v * u32x8::splat(MULTIPLIER) + u32x8::splat(INCREMENT);
    let mut v = [lcg(pixel), lcg(sample), lcg(block), lcg(u32x8::splat(seed))];
    for _ in 0..2 {
        let [x, y, z, w] = v;
        let x = x + y * w;
        let y = y + z * x;
        let z = z + x * y;
        let w = w + y * z;
        v = [x, y, z, w].map(|v| v ^ v >> 16_u32);
    }
    v
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

/// [`uniform`] for eight rows.
#[inline(always)]
pub fn uniform_x8(word: u32x8) -> f32x8 {
    let cell: i32x8 = bytemuck::cast(word >> DROPPED);
    (f32x8::from_i32x8(cell) + f32x8::splat(0.5)) * f32x8::splat(CELL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_draw_the_same_words_as_rows() {
        let (pixel, sample, block) = ([0, 1, 2, 3, 500, 65_535, 1 << 20, u32::MAX], [7; 8], [block(3, SEGMENT); 8]);
        let lanes = words_x8(u32x8::new(pixel), u32x8::new(sample), u32x8::new(block), 9).map(|w| w.to_array());
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
            assert_eq!(f64::from(uniform_x8(u32x8::splat(word)).to_array()[0]), u);
            assert_eq!(f64::from(1.0 - u as f32), 1.0 - u);
        }
    }
}
