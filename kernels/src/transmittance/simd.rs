//! ```text
//! factor_c *= prod over segments of product_c e^{k_c (tau~ - known)},      k_c = hue of channel c, or less the hero's
//! ```
//!
//! 1. The first segments of all rows that count go through the tracker, then the second ones: rays take the lanes of
//!    those that have ended, and still a row's factors are multiplied in the sequence of its segments.
//! 2. Their tau~ is found for whole batches afterwards.
//! 3. Segments in the even part of the field, whose factor is 1, are left out: in a block of fog, nearly all.
//! 4. A grey field has one hue. Where channels are apart they are estimated one after the other (`channels`).

use wide::{f32x8, u32x8};

use super::{Columns, channels};
use crate::columns::Column3;
use crate::columns::queues::{Bucket, CandidateQueue, ChainTable, WorthTable};
use crate::lanes::LANES;
use crate::media::MediumX8;
use crate::media::field::tracking::RaysX8;
use crate::media::field::tracking::simd::{factor, transmittances};
use crate::media::field::{EvenX8, Field, FieldX8};
use crate::media::spectral::CHANNELS;
use crate::random::{self, Stream};
use crate::vec3::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    match columns.field.apart() {
        Some(apart) => channels::estimate(step, columns, apart),
        None if columns.field.is_grey() => estimate::<1>(step, columns),
        None => estimate::<CHANNELS>(step, columns),
    }
}

fn estimate<const N: usize>(step: Step, columns: Columns<'_, '_>) {
    let Columns { field, flown, bucket, purpose, candidates, chains, paths, immersion, estimates, worth } = columns;
    let block = random::TRANSMITTANCE.nth(purpose.number());
    let vertex = |number| vertex(number, bucket, candidates, chains);
    let lane_of = |row: usize| candidates.lane.rows()[row] as usize;
    let hues_of = |row: usize| hues(field, flown.then(|| immersion.hero.rows()[lane_of(row)]));
    for segment in 0..=bucket.inserted {
        let (from, to) = (vertex(segment), vertex(segment + 1));
        let rays = bucket.batches().filter_map(|(b, rows)| {
            let (origin, end) = (from.batch(b), to.batch(b));
            let live = lanes::bits(asks(field, worth, b, rows, [origin, end]));
            if live == 0 {
                return None;
            }
            let of = candidates.lane.batch(b).to_array();
            let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.gather(&of));
            let block = random::block(u32x8::splat(step.clock) - birth, block);
            let hues = hues_x8(|lane| if live >> lane & 1 == 1 { hues_of(LANES * b + lane) } else { [0.0; CHANNELS] });
            Some(RaysX8 {
                first: LANES * b,
                live,
                origin,
                direction: end - origin,
                stream: Stream::new_x8(pixel, sample, block, step.seed, segment as u32),
                hues: core::array::from_fn(|hue| hues[hue]),
            })
        });
        transmittances(field, rays, |row, products: [f32; N], known| {
            estimates.product.set_row(row, [0, 1, 2].map(|c: usize| products[c.min(N - 1)]));
            estimates.depth.rows_mut()[row] = known;
        });
        for (b, rows) in bucket.batches() {
            let (from, to) = (from.batch(b), to.batch(b));
            let asked = asks(field, worth, b, rows, [from, to]);
            if !asked.any() {
                continue;
            }
            let depth = FieldX8::of(field).optical_depth(from, to, (to - from).length_squared().sqrt());
            let (products, known) = (estimates.product.batch(b), estimates.depth.batch(b));
            let products = [products.x, products.y, products.z];
            let hues = hues_x8(|lane| if rows >> lane & 1 == 1 { hues_of(LANES * b + lane) } else { [0.0; CHANNELS] });
            let through: [f32x8; N] = core::array::from_fn(|c| factor(products[c], hues[c], known, depth));
            for (c, channel) in worth.factor.channels_mut().iter_mut().enumerate() {
                let before = channel.batch(b);
                // Rows that do not ask were not estimated: what stands there is of no meaning.
                let counts = asked & !before.simd_eq(f32x8::ZERO);
                channel.set_batch(b, counts.select(before * through[c.min(N - 1)], before));
            }
        }
    }
}

/// Which of some `rows` of batch `b` count anything and are not settled, for a segment between two points.
#[inline(always)]
fn asks(field: &Field, worth: &WorthTable<'_>, b: usize, rows: u32, [from, to]: [Vec3x8; 2]) -> f32x8 {
    let counts = !worth.weight.batch(b).simd_eq(f32x8::ZERO);
    lanes::mask(rows & worth.factor.any_of_batch(b)) & counts & !EvenX8::new(field, f32x8::ONE).settles(from, to - from)
}

/// Vertex `number` of the connections of a bucket, counted from the start.
pub(super) fn vertex<'a, 'q>(
    number: usize,
    bucket: Bucket,
    candidates: &'a CandidateQueue<'q>,
    chains: &'a ChainTable<'q>,
) -> &'a Column3<'q> {
    match number {
        0 => &candidates.start,
        number if number <= bucket.inserted => &chains.vertices[number - 1],
        _ => &candidates.point,
    }
}

/// Extinctions over that of the field, less that of the `hero` if there is one.
#[inline(always)]
pub fn hues(field: &Field, hero: Option<u32>) -> [f32; CHANNELS] {
    let all = field.hues();
    let hero = hero.map_or(0.0, |hero| all[(hero as usize).min(CHANNELS - 1)]);
    all.map(|hue| hue - hero)
}

/// The hues of eight rows.
#[inline(always)]
pub fn hues_x8(of_lane: impl Fn(usize) -> [f32; CHANNELS]) -> [f32x8; CHANNELS] {
    let of_lanes: [[f32; CHANNELS]; LANES] = core::array::from_fn(of_lane);
    [0, 1, 2].map(|c| f32x8::new(of_lanes.map(|hues: [f32; CHANNELS]| hues[c])))
}
