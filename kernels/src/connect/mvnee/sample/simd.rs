//! ```text
//! count: m = number of k with t_0 + .. + t_k < s,  t_k flights along the axis
//! build: seed k at t_0 + .. + t_k along the axis, moved by r (cos(2 pi v) tangent + sin(2 pi v) bitangent),
//!        r = width sqrt(u / (1 - u))  or  width sqrt(-2 ln(1 - u)),   width^2 = c^2 slope^2 L R / (L + R)
//! ```
//!
//! 1. Counting keeps nothing but the count; building draws the flights again. A hash and a logarithm per seed are
//!    cheaper than storing seeds by row and reading them back in bucket order.
//! 2. Building works on one bucket at a time: eight rows insert the same number of vertices, no lane waits.
//! 3. Flights through the coarse field are counted by depth, which needs no places: m of them add up to less than tau~.
//! 4. The first pass leaves step, L and place of each seed in the chain's own columns, the second walks back from the
//!    light, where R grows without a difference, and overwrites them with the vertex.

use wide::{f32x8, u32x8};

use crate::columns::Column3;
use crate::columns::queues::CandidateBatch;
use crate::connect::buckets::{BuildColumns, CountColumns, DROPPED};
use crate::connect::mvnee::{GGX_WIDTH, Mvnee, Offset, Seeds};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::media::{AxisX8, MediumLanes, MediumX8};
use crate::random;
use crate::transcendental::{neg_ln, sin_cos_turn};
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium};

/// Optical depths between the seeds 4 k .. 4 k + 4 of flights through the coarse field.
#[inline(always)]
fn flights(sequence: &Sequence, k: usize) -> [f32x8; 4] {
    sequence.uniforms(random::MVNEE_FLIGHTS.nth(k as u32)).map(|u| neg_ln(f32x8::ONE - u))
}

/// Goes from seed to seed.
struct Walk<A> {
    axis: A,
    seeds: Seeds,
    /// Mean free path at the first seed `[m]`, by which fast ones go on; none before it.
    mean_free_path: Option<f32x8>,
}

impl<A: AxisX8> Walk<A> {
    #[inline(always)]
    fn new(seeds: Seeds, axis: A) -> Self {
        Self { axis, seeds, mean_free_path: None }
    }

    /// Distance from one seed to the next `[m]`, after a flight of this `depth`.
    #[inline(always)]
    fn next(&mut self, depth: f32x8) -> f32x8 {
        if let Some(mean_free_path) = self.mean_free_path {
            return depth * mean_free_path;
        }
        let distance = self.axis.advance(depth);
        self.reach_first();
        distance
    }

    /// Remembers what fast seeds go on with, once they have reached the first one.
    #[inline(always)]
    fn reach_first(&mut self) {
        if A::VARIES && self.seeds == Seeds::Fast {
            self.mean_free_path = Some(f32x8::ONE / self.axis.reached());
        }
    }

    /// Whether seeds are counted by depth.
    #[inline(always)]
    fn by_depth(&self) -> bool {
        A::VARIES && self.seeds == Seeds::Coarse
    }

    /// How much nearer the end the first seed is, after a flight of this `depth`, and how far the end is, for an axis of
    /// this `length` `[m]`; and where that is no deeper than `most`, without which the others have no meaning.
    #[inline(always)]
    fn begin(&mut self, depth: f32x8, length: f32x8, most: f32x8) -> [f32x8; 3] {
        if self.by_depth() {
            let whole = self.axis.depth(most);
            return [depth, whole, whole.simd_le(most)];
        }
        let [distance, whole] = self.axis.first_advance(depth, most);
        self.reach_first();
        [distance, length, whole.simd_le(most)]
    }

    /// How much nearer the end each other one is.
    #[inline(always)]
    fn toward_end(&mut self, depth: f32x8) -> f32x8 {
        if self.by_depth() { depth } else { self.next(depth) }
    }
}

/// The SIMD kernel; see [`CountKernel`](super::CountKernel).
pub fn count(step: Step, columns: CountColumns<'_, '_, Mvnee>) {
    with_medium!(columns.medium, |medium| count_seeds(step, columns, medium));
}

#[inline(never)]
fn count_seeds(step: Step, columns: CountColumns<'_, '_, Mvnee>, medium: impl MediumLanes) {
    let CountColumns { technique, lengths, paths, immersion, connections, count: counts, .. } = columns;
    for b in 0..connections.len.div_ceil(LANES) {
        let lane_of = connections.lane.batch(b).to_array();
        let sequence = Sequence::new(step, paths, &lane_of);
        let medium = medium.in_channel(|| immersion.hero.gather(&lane_of));
        let (start, point) = (connections.start.batch(b), connections.point.batch(b));
        let longest = (u32x8::splat(lengths.max - 1) - sequence.depth).min(u32x8::splat(technique.max_inserted));
        let live = lanes::first(connections.len - b * LANES);
        let count = if medium.stays_even([start, point], live) {
            technique.count(medium.as_even(), &sequence, [start, point], live, longest)
        } else {
            technique.count(medium, &sequence, [start, point], live, longest)
        };
        counts.set_batch(b, count);
    }
}

impl Mvnee {
    /// How many seeds there are between the two ends of every connection of the `live` rows, or [`DROPPED`] if these are
    /// too deep or insert more than `longest`.
    #[inline(always)]
    fn count(
        &self,
        medium: impl MediumX8,
        sequence: &Sequence,
        [start, point]: [Vec3x8; 2],
        live: u32,
        longest: u32x8,
    ) -> u32x8 {
        let distance = (point - start).length_squared().sqrt();
        let mut walk = Walk::new(self.seeds, medium.axis(start, point, distance));
        let most = f32x8::splat(self.max_depth) * medium.over_clearest();
        let [first, others @ ..] = flights(sequence, 0);
        let [first, end, near] = walk.begin(first, distance, most);

        let mut seeds = Counted { inside: lanes::mask(live) & near, along: f32x8::ZERO, count: u32x8::splat(0) };
        seeds.add(first, end, longest);
        others.into_iter().for_each(|flight| seeds.add(walk.toward_end(flight), end, longest));
        for k in 1.. {
            if !seeds.inside.any() {
                break;
            }
            flights(sequence, k).into_iter().for_each(|flight| seeds.add(walk.toward_end(flight), end, longest));
        }
        let fits = seeds.count.simd_le(longest) & lanes::as_integer_mask(near);
        fits.select(seeds.count, u32x8::splat(DROPPED))
    }
}

/// Seeds counted so far.
struct Counted {
    /// Rows of which the end is not reached.
    inside: f32x8,
    /// How far the last one is, as a depth or as a distance `[m]`.
    along: f32x8,
    /// How many there are.
    count: u32x8,
}

impl Counted {
    /// Goes on by a `step`: to one more where that is before the `end`, and there are no more than `longest`.
    #[inline(always)]
    fn add(&mut self, step: f32x8, end: f32x8, longest: u32x8) {
        self.along += step;
        self.inside &= self.along.simd_lt(end) & lanes::as_mask(self.count.simd_le(longest));
        self.count -= bytemuck::cast::<f32x8, u32x8>(self.inside); // a mask of all ones is -1
    }
}

/// The SIMD kernel; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_, Mvnee>) {
    with_medium!(columns.medium, |medium| place_seeds(step, columns, medium));
}

#[inline(never)]
fn place_seeds(step: Step, columns: BuildColumns<'_, '_, Mvnee>, medium: impl MediumLanes) {
    let BuildColumns { technique: mvnee, paths, immersion, connections, buckets, candidates, chains, .. } = columns;
    for bucket in buckets.buckets() {
        for (b, rows) in bucket.batches() {
            let candidate = connections.gather(&buckets.order.batch(b).to_array());
            candidates.set_batch(b, candidate);
            chains.resampling.set_batch(b, f32x8::ONE);
            if bucket.inserted > 0 {
                let lane_of = candidate.lane.to_array();
                let sequence = Sequence::new(step, paths, &lane_of);
                let medium = medium.in_channel(|| immersion.hero.gather(&lane_of));
                let chain = &mut chains.vertices[..bucket.inserted];
                if medium.stays_even([candidate.start, candidate.point], rows) {
                    place(&sequence, mvnee, medium.as_even(), &candidate, chain, b);
                } else {
                    place(&sequence, mvnee, medium, &candidate, chain, b);
                }
            }
        }
    }
}

/// Fills batch `b` of the chain: the vertices between start and point.
#[inline(always)]
fn place(
    sequence: &Sequence,
    mvnee: &Mvnee,
    medium: impl MediumX8,
    candidate: &CandidateBatch,
    chain: &mut [Column3<'_>],
    b: usize,
) {
    let to_light = candidate.point - candidate.start;
    let distance = to_light.length_squared().sqrt();
    let axis = to_light * (f32x8::ONE / distance);
    let mut walk = Walk::new(mvnee.seeds, medium.axis(candidate.start, candidate.point, distance));
    let (tangent, bitangent) = axis.frame();

    // Leave (step, L, place on the axis) of every seed in its place in the chain.
    let (mut along, mut before) = (f32x8::ZERO, f32x8::ZERO);
    for (k, four) in chain.chunks_mut(4).enumerate() {
        for (seed, flight) in four.iter_mut().zip(flights(sequence, k)) {
            let step = walk.next(flight);
            along += step;
            before = step.mul_add(step, before);
            seed.set_batch(b, Vec3x8::new(step, before, along));
        }
    }

    // Walk back from the light and move every seed off the axis.
    let last = distance - along;
    let mut after = last * last;
    let inverse_total = f32x8::ONE / (before + after);
    for (k, two) in chain.chunks_mut(2).enumerate().rev() {
        let [radius_0, azimuth_0, radius_1, azimuth_1] = sequence.uniforms(random::MVNEE_OFFSETS.nth(k as u32));
        let draws = [(radius_0, azimuth_0), (radius_1, azimuth_1)];
        for (vertex, (u, v)) in two.iter_mut().zip(draws).rev() {
            let Vec3x8 { x: step, y: before, z: along } = vertex.batch(b);
            let radius = (mvnee.offset_squared(u) * before * (after * inverse_total)).sqrt();
            let (sin, cos) = sin_cos_turn(v);
            let across = tangent.mul_add(radius * cos, bitangent * (radius * sin));
            vertex.set_batch(b, axis.mul_add(along, candidate.start) + across);
            after = step.mul_add(step, after);
        }
    }
}

impl Mvnee {
    /// Squared perturbation for a uniform number `u`, where L R / (L + R) is one: the inverse of the distribution.
    #[inline(always)]
    fn offset_squared(&self, u: f32x8) -> f32x8 {
        let rest = f32x8::ONE - u;
        match self.offset {
            Offset::Ggx => {
                let width = GGX_WIDTH as f32 * self.slope;
                f32x8::splat(width * width) * u / rest
            }
            Offset::Gaussian => f32x8::splat(2.0 * self.slope * self.slope) * neg_ln(rest),
        }
    }
}
