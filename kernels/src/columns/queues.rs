//! All queues on one page: the columns through which stages hand rows to each other.
//!
//! | queue | filled by | read by | rows |
//! |---|---|---|---|
//! | [`RequestTable`] | the wavefront | generate | lanes to refill |
//! | [`FlightTable`] | medium_sample | extend, light_hit, scatter, surface | one per lane |
//! | [`HitQueue`] | extend | light_hit | rays that meet a light |
//! | [`SurfaceHitQueue`] | extend | surface | rays that meet a triangle |
//! | [`CandidateQueue`] | light_hit, light_sample, mvnee_build | mvnee_*, mis_weight, occlusion, accumulate | complete paths |
//! | [`EndQueue`] | lis_vertex | lis_join | light points of the connections of light importance sampling |
//! | [`ChainTable`] | mvnee_build | mis_weight, occlusion | inserted vertices of the candidates |
//!
//! Rows that go on stay in their lane; only the exceptions are listed.

use bumpalo::Bump;

use super::Column3;
use crate::columns;
use crate::lanes::LaneSet;

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

/// Lanes that get a new path.
pub struct RequestTable<'q> {
    /// Which sample each takes, one row per lane.
    pub columns: RequestColumns<'q>,
    /// Lanes that are asked for.
    pub lanes: LaneSet<'q>,
}

impl<'q> RequestTable<'q> {
    /// No requests for any of `lanes` lanes.
    pub fn new_in(arena: &'q Bump, lanes: usize) -> Self {
        Self { columns: RequestColumns::new_in(arena, lanes), lanes: LaneSet::new_in(arena, lanes) }
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
        /// Density of a free flight over the density with which this one was drawn, >= 0; filled for camera rays only,
        /// and only where some are aimed.
        weight: f32,
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
        /// Point on the light `[m]`.
        point: [f32; 3],
        /// What the candidate counts, >= 0: one over the sum of the densities with which all techniques make it, relative
        /// to path tracing's; 0 once it is found faint or occluded; the transmittance of a directly seen light.
        weight: f32,
    }
}

columns! {
    /// Light points behind the vertices that light importance sampling made from them, in the rows of its connections.
    queue EndQueue of End, EndBatch {
        /// Lane of the path.
        lane: u32,
        /// Point on the light `[m]`.
        point: [f32; 3],
    }
}

/// Rows of a [`CandidateQueue`] that have the same number of inserted vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bucket {
    /// Inserted vertices of each row.
    pub inserted: usize,
    /// First row, a multiple of [`LANES`](super::LANES).
    pub start: usize,
    /// Number of rows.
    pub len: usize,
}

impl CandidateQueue<'_> {
    /// The rows that `row_of` names, as a batch.
    #[inline(always)]
    pub fn gather(&self, row_of: &[u32; super::LANES]) -> CandidateBatch {
        CandidateBatch {
            lane: self.lane.gather(row_of),
            emitter: self.emitter.gather(row_of),
            start: self.start.gather(row_of),
            arriving: self.arriving.gather(row_of),
            point: self.point.gather(row_of),
            weight: self.weight.gather(row_of),
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
            weight: self.weight.batch(b),
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
        let first = self.start / super::LANES;
        (0..self.len.div_ceil(super::LANES)).map(move |b| (first + b, crate::lanes::first(self.len - b * super::LANES)))
    }

    /// The rows of the bucket.
    pub fn rows(self) -> core::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

/// Inserted vertices of candidates: vertex-major, so that the same vertex of eight rows is one batch.
pub struct ChainTable<'q> {
    /// `vertices[j]` holds the `j`-th inserted vertex of every row, counted from the start `[m]`.
    pub vertices: &'q mut [Column3<'q>],
}

impl<'q> ChainTable<'q> {
    /// Room for `longest` inserted vertices in each of `rows` rows.
    pub fn new_in(arena: &'q Bump, rows: usize, longest: usize) -> Self {
        Self { vertices: arena.alloc_slice_fill_with(longest, |_| Column3::new_in(arena, rows)) }
    }
}
