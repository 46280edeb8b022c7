//! All queues on one page: the columns through which stages hand rows to each other.
//!
//! | queue | filled by | read by | rows |
//! |---|---|---|---|
//! | [`RequestColumns`] | the wavefront | generate | lanes to refill |
//! | [`FlightTable`] | medium_sample, first_flight | extend, light_hit, flight_weight, scatter, surface | one per lane |
//! | [`HitQueue`] | extend | light_hit, features | rays that meet a light |
//! | [`SurfaceHitQueue`] | extend | first_surface, surface, features | rays that meet a triangle |
//! | [`CandidateQueue`] | light_hit, light_sample, the techniques' build stages | theirs, sift, mis_weight, roulette, occlusion, accumulate | complete paths |
//! | [`WorthTable`] | light_hit, sift, mis_weight, roulette, occlusion, transmittance | roulette, occlusion, transmittance, accumulate | what the candidates count |
//! | [`EstimateColumns`] | transmittance | transmittance | what comes through one segment of each |
//! | [`EndQueue`] | lis_vertex | lis_join | light points of the connections of light importance sampling |
//! | [`ChainTable`] | the techniques' build stages, lis_join | mis_weight, occlusion | inserted vertices of the candidates |
//!
//! Rows that go on stay in their lane; only the exceptions are listed.

use bumpalo::Bump;
use wide::{f32x8, u32x8};

use super::{Column, Column3, ColumnMut, ColumnRef, ColumnSet, Field, Spectrum};
use crate::lanes::LANES;
use crate::{columns, lanes};

columns! {
    /// The sample that a vacant lane takes next.
    table RequestColumns of Request {
        /// Column of the pixel in the whole image.
        x: u32,
        /// Row of the pixel in the whole image.
        y: u32,
        /// Number of the sample in its pixel.
        sample: u32,
    }
}

impl RequestColumns<'_> {
    /// Fills batch `b` with eight samples of one pixel: `first` and those after it.
    #[inline(always)]
    pub fn set_eight(&mut self, b: usize, first: Request) {
        self.x.set_batch(b, u32x8::splat(first.x));
        self.y.set_batch(b, u32x8::splat(first.y));
        self.sample.set_batch(b, u32x8::splat(first.sample) + lanes::indices(0));
    }
}

columns! {
    /// The step that every path is about to take, one row per lane.
    table FlightTable of Flight {
        /// Free flight drawn for the current ray `[m]`, > 0.
        flight: f32,
        /// Random word for the cosine of the scattering at its end.
        cosine: u32,
        /// Random word for the azimuth of the scattering at its end.
        azimuth: u32,
    }
}

columns! {
    /// Rays that meet a light before their flight ends, or anywhere if they leave the camera.
    queue HitQueue of Hit, HitBatch {
        /// Lane of the path.
        lane: u32,
        /// Index of the emitter.
        emitter: u32,
        /// Distance from the ray's origin `[m]`, > 0.
        distance: f32,
    }
}

columns! {
    /// Rays that meet a triangle before their flight ends.
    queue SurfaceHitQueue of SurfaceHit, SurfaceHitBatch {
        /// Lane of the path.
        lane: u32,
        /// Index of the triangle.
        triangle: u32,
        /// Distance from the ray's origin `[m]`, > 0.
        distance: f32,
        /// Barycentric weight of the triangle's second corner, [0, 1].
        second: f32,
        /// Barycentric weight of its third corner, [0, 1].
        third: f32,
    }
}

columns! {
    /// Candidates: complete paths from the camera to a light, however they were made.
    ///
    /// Path vertices up to the *start* are those of the lane's history; then follow the inserted vertices, which stand
    /// in the same row of a [`ChainTable`], and the point on the light. All rows of one [`Bucket`] have the same number
    /// of inserted vertices.
    queue CandidateQueue of Candidate, CandidateBatch {
        /// Lane of the path.
        lane: u32,
        /// Index of the emitter.
        emitter: u32,
        /// Position of the start vertex, the path's current vertex `[m]`.
        start: [f32; 3],
        /// Unit direction in which the path arrives at the start.
        arriving: [f32; 3],
        /// Point on the emitter `[m]`.
        point: [f32; 3],
    }
}

/// What candidates count: in row `i` that in row `i` of a [`CandidateQueue`]. The contribution is
/// `weight factor Le T` per channel, with the throughput T of the path up to the start.
pub struct WorthTable<'q> {
    /// One over the sum of the densities with which all techniques make the path, relative to path tracing's, times the
    /// profile of the emitter, >= 0; 0 once it is found faint; of an emitter that the camera sees,
    /// the transmittance in the clearest channel times the profile.
    pub weight: Column<'q, f32>,
    /// What the throughput leaves out of f / p, in the channels in use: the albedos of the inserted vertices, their
    /// resampling weights, the quotient of channels where extinction is coloured, and whether anything is in the way.
    pub factor: Spectrum<'q>,
}

impl<'q> WorthTable<'q> {
    /// A zeroed table of at least `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize, channels: usize) -> Self {
        let rows = rows + LANES;
        Self { weight: Column::new_in(arena, rows), factor: Spectrum::new_in(arena, rows, channels) }
    }

    /// Overwrites eight rows from row `at` on with these weights in the sequence `order`, and factors of 1.
    #[inline(always)]
    pub fn store_packed(&mut self, at: usize, order: u32x8, weight: f32x8) {
        f32::store_packed(&mut self.weight, at, order, weight);
        let factors = self.factor.channels_mut().iter_mut();
        factors.for_each(|factor| f32::store_packed(factor, at, order, f32x8::ONE));
    }

    /// How many candidates of a bucket count anything.
    pub fn count(&self, bucket: Bucket) -> u64 {
        let of_batch = |(b, rows): (usize, u32)| {
            let weigh = lanes::bits(!self.weight.batch(b).simd_eq(f32x8::ZERO));
            u64::from((weigh & self.factor.any_of_batch(b) & rows).count_ones())
        };
        bucket.batches().map(of_batch).sum()
    }
}

impl ColumnSet for WorthTable<'_> {
    fn visit(&self, visit: &mut dyn FnMut(&'static str, ColumnRef<'_>)) {
        visit("weight", ColumnRef::F32(self.weight.rows()));
        self.factor.visit(&mut |_, column| visit("factor", column));
    }

    fn visit_mut(&mut self, visit: &mut dyn FnMut(&'static str, ColumnMut<'_>)) {
        visit("weight", ColumnMut::F32(self.weight.rows_mut()));
        self.factor.visit_mut(&mut |_, column| visit("factor", column));
    }
}

columns! {
    /// Estimated transmittances of one segment of every candidate, or one flight of every path: `T' = product e^{-hue
    /// depth}`.
    table EstimateColumns of Estimate {
        /// What is random of it, >= 0, per hue.
        product: [f32; 3],
        /// Optical depth of the coarse field.
        depth: f32,
        /// Length of the flight `[m]`.
        length: f32,
    }
}

columns! {
    /// Light points behind the vertices that light importance sampling made from them, in the rows of its connections.
    queue EndQueue of End, EndBatch {
        /// Lane of the path.
        lane: u32,
        /// Point on the emitter `[m]`.
        point: [f32; 3],
    }
}

/// Rows of a [`CandidateQueue`] that have the same number of inserted vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bucket {
    /// Inserted vertices of each row.
    pub inserted: usize,
    /// First row, a multiple of [`LANES`].
    pub start: usize,
    /// Number of rows.
    pub len: usize,
}

impl CandidateQueue<'_> {
    /// The rows that `row_of` names, as a batch.
    #[inline(always)]
    pub fn gather(&self, row_of: &[u32; LANES]) -> CandidateBatch {
        CandidateBatch {
            lane: self.lane.gather(row_of),
            emitter: self.emitter.gather(row_of),
            start: self.start.gather(row_of),
            arriving: self.arriving.gather(row_of),
            point: self.point.gather(row_of),
        }
    }

    /// Batch `b`.
    #[inline(always)]
    pub fn batch(&self, b: usize) -> CandidateBatch {
        CandidateBatch {
            lane: self.lane.batch(b),
            emitter: self.emitter.batch(b),
            start: self.start.batch(b),
            arriving: self.arriving.batch(b),
            point: self.point.batch(b),
        }
    }

    /// All rows as one bucket of candidates without inserted vertices.
    pub fn direct(&self) -> Bucket {
        Bucket { inserted: 0, start: 0, len: self.len }
    }
}

impl Bucket {
    /// The batches of the bucket, each with the bits of its rows.
    pub fn batches(self) -> impl Iterator<Item = (usize, u32)> {
        let first = self.start / LANES;
        (0..self.len.div_ceil(LANES)).map(move |b| (first + b, lanes::first(self.len - b * LANES)))
    }

    /// Drops the rows that weigh nothing: the others, with the vertices that they insert, move to the front in their
    /// sequence. A bucket's batches are full again.
    pub fn pack(
        self,
        candidates: &mut CandidateQueue<'_>,
        chains: &mut ChainTable<'_>,
        worth: &mut WorthTable<'_>,
    ) -> Self {
        let mut end = self.start;
        for (b, rows) in self.batches() {
            let weigh = !worth.weight.batch(b).simd_eq(f32x8::ZERO);
            let kept = lanes::bits(weigh) & rows;
            // Rows are stored no farther than they have been read.
            if kept != rows || end != b * LANES {
                let order = lanes::pack_order(kept);
                candidates.store_packed(end, order, candidates.batch(b));
                let weight = worth.weight.batch(b);
                f32::store_packed(&mut worth.weight, end, order, weight);
                for factor in worth.factor.channels_mut() {
                    let batch = factor.batch(b);
                    f32::store_packed(factor, end, order, batch);
                }
                let resampling = chains.resampling.batch(b);
                f32::store_packed(&mut chains.resampling, end, order, resampling);
                for vertex in &mut chains.vertices[..self.inserted] {
                    <[f32; 3]>::store_packed(vertex, end, order, vertex.batch(b));
                }
            }
            end += kept.count_ones() as usize;
        }
        Self { len: end - self.start, ..self }
    }

    /// The rows of the bucket.
    pub fn rows(self) -> core::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

/// Inserted vertices of candidates: vertex-major, so that the same vertex of eight rows is one batch; and how they were
/// chosen.
pub struct ChainTable<'q> {
    /// `vertices[j]` holds the `j`-th inserted vertex of every row, counted from the start `[m]`.
    pub vertices: &'q mut [Column3<'q>],
    /// Resampling weight of every row, > 0: the factor of its contribution that makes up for the choice of its vertices
    /// among several; 1 where nothing was chosen.
    pub resampling: Column<'q, f32>,
}

impl<'q> ChainTable<'q> {
    /// Room for `longest` inserted vertices in each of `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize, longest: usize) -> Self {
        Self {
            vertices: arena.alloc_slice_fill_with(longest, |_| Column3::new_in(arena, rows)),
            resampling: Column::new_in(arena, rows),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_drops_what_weighs_nothing_and_keeps_the_sequence() {
        let arena = Bump::new();
        let mut candidates = CandidateQueue::new_in(&arena, 40);
        let mut chains = ChainTable::new_in(&arena, 40, 2);
        let mut worth = WorthTable::new_in(&arena, 40, 3);
        // Batches that keep all, some, none, some; and a tail whose dead rows weigh something.
        let weighs = |row: usize| row < 16 || (row.is_multiple_of(3) && !(24..32).contains(&row)) || row >= 38;
        for row in 0..40 {
            let vector = [row as f32, 0.5, -1.0];
            let weight = if weighs(row) { 1.0 + row as f32 } else { 0.0 };
            let (lane, emitter) = (row as u32, 7 * row as u32);
            candidates.push(Candidate { lane, emitter, start: vector, arriving: vector, point: vector });
            worth.weight.rows_mut()[row] = weight;
            worth.factor.set_row(row, [0.5 * weight, 1.0, 2.0 + weight]);
            chains.vertices.iter_mut().for_each(|vertex| vertex.set_row(row, vector));
            chains.resampling.rows_mut()[row] = 0.25 * row as f32;
        }
        let packed = Bucket { inserted: 2, start: 8, len: 30 }.pack(&mut candidates, &mut chains, &mut worth);
        let expected: Vec<usize> = (8..38).filter(|row| weighs(*row)).collect();
        assert_eq!(packed, Bucket { inserted: 2, start: 8, len: expected.len() });
        for (row, from) in packed.rows().zip(expected) {
            let candidate = candidates.row(row);
            assert_eq!((candidate.lane, candidate.emitter), (from as u32, 7 * from as u32));
            let weight = 1.0 + from as f32;
            assert_eq!((worth.weight.rows()[row], worth.factor.row(row)), (weight, [0.5 * weight, 1.0, 2.0 + weight]));
            assert_eq!(candidate.point, [from as f32, 0.5, -1.0]);
            chains.vertices.iter().for_each(|vertex| assert_eq!(vertex.row(row), candidate.point));
            assert_eq!(chains.resampling.rows()[row], 0.25 * from as f32);
        }
    }

    #[test]
    fn what_counts_anything_is_counted_up_to_the_last_row() {
        let arena = Bump::new();
        for channels in [1, 3] {
            let mut worth = WorthTable::new_in(&arena, 40, channels);
            let weighs = |row: usize| !row.is_multiple_of(3);
            let passes = |row: usize| !row.is_multiple_of(5);
            for row in 0..40 {
                worth.weight.rows_mut()[row] = if weighs(row) { row as f32 } else { 0.0 };
                worth.factor.set_row(row, if passes(row) { [f32::NAN, 0.0, 0.0] } else { [0.0; 3] });
            }
            for len in 0..=24 {
                let bucket = Bucket { inserted: 1, start: 8, len };
                let expected = bucket.rows().filter(|row| weighs(*row) && passes(*row)).count() as u64;
                assert_eq!(worth.count(bucket), expected, "{channels} channels, {len} rows");
            }
        }
    }
}
