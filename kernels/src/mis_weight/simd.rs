//! ```text
//! walk from the light towards the camera and collect, per vertex, arc length, p_w, l^2 / p_w
//! weight = 1 / (1 + sum over active techniques and starts of r)
//! ```
//!
//! 1. A bucket's rows have the same number of inserted vertices, so the walk meets the start at the same index in all
//!    lanes; what differs is only how many starts of the history are eligible.
//! 2. Inserted vertices and start are read as batches, history is gathered: position and inverse density, no more.
//! 3. Nothing is computed beyond the last start that an active technique can use.
//! 4. Zero-length segments get a zero direction instead of NaN; their ratios vanish with their squared length.

use wide::{f32x8, u32x8};

use super::Columns;
use super::suffix::{Arrival, Suffix, SuffixVertex};
use crate::columns::LANES;
use crate::columns::paths::{PathTable, VertexTable};
use crate::columns::queues::{CandidateQueue, ChainTable};
use crate::connect::light_sample::selection;
use crate::connect::{Techniques, mvnee, nee};
use crate::phase::HenyeyGreensteinX8;
use crate::tables::lights::Lights;
use crate::tables::media::Medium;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// Shortest length by which a segment's direction is normalised `[m]`.
const LEAST_LENGTH: f32 = 1e-30;

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, techniques: &Techniques, step: Step, columns: Columns<'_, '_>) {
    let Columns { bucket, candidates, chains, paths, vertices, suffix } = columns;
    let phase = HenyeyGreensteinX8::new(medium.phase);
    for (b, rows) in bucket.batches() {
        let batch = Batch {
            inserted: bucket.inserted,
            lane_of: candidates.lane.batch(b).to_array(),
            light_of: candidates.light.batch(b).to_array(),
            lights,
            phase,
        };
        let arrival = batch.walk_connection(b, candidates, chains, medium.extinction, suffix);
        let mut sum = f32x8::ZERO;
        if techniques.nee {
            suffix.vertices[1].selection = batch.selection(vertices, step, suffix, 1);
            sum += nee::simd::ratio(&arrival, &suffix.vertices[1]);
        }
        if let Some(mvnee) = &techniques.mvnee {
            let starts = batch.starts(paths, step, rows, mvnee.max_distance.is_finite());
            let longest = starts.reduce_max() as usize;
            batch.walk_history(vertices, step, suffix, longest);
            for a in 1..=longest {
                suffix.vertices[a].selection = batch.selection(vertices, step, suffix, a);
                suffix.vertices[a].eligible = lanes::as_mask(starts.simd_ge(u32x8::splat(a as u32)));
            }
            sum += mvnee::simd::ratios(mvnee, &arrival, suffix, longest);
        }
        let front = arrival.cos_light.simd_gt(f32x8::ZERO);
        let weight = f32x8::ONE / (f32x8::ONE + sum);
        candidates.weight.set_batch(b, front.select(weight, f32x8::ZERO));
    }
}

/// Eight candidates of one bucket.
struct Batch<'a> {
    inserted: usize,
    lane_of: [u32; LANES],
    light_of: [u32; LANES],
    lights: &'a Lights,
    phase: HenyeyGreensteinX8,
}

/// Length and unit direction of the segment from `from` to `to`.
#[inline(always)]
fn segment(from: Vec3x8, to: Vec3x8) -> (f32x8, Vec3x8) {
    let edge = to - from;
    let length = edge.length_squared().sqrt();
    (length, edge * (f32x8::ONE / length.fast_max(f32x8::splat(LEAST_LENGTH))))
}

impl Batch<'_> {
    /// Fills the suffix from the light to the start: positions, arc lengths, densities, spreads.
    #[inline(always)]
    fn walk_connection(
        &self,
        b: usize,
        candidates: &CandidateQueue<'_>,
        chains: &ChainTable<'_>,
        extinction: f32,
        suffix: &mut Suffix<'_>,
    ) -> Arrival {
        let point = candidates.point.batch(b);
        let (mut arc, mut leaving, mut last) = (f32x8::ZERO, Vec3x8::ZERO, f32x8::ZERO);
        let mut cos_light = f32x8::ZERO;
        let mut next = point;
        suffix.vertices[0].position = point;
        for a in 1..=self.inserted + 1 {
            let is_start = a > self.inserted;
            let position =
                if is_start { candidates.start.batch(b) } else { chains.vertices[self.inserted - a].batch(b) };
            let (length, direction) = segment(position, next);
            if a == 1 {
                let normal = self.lights.gather3(&self.light_of, |disk| disk.normal);
                (last, cos_light) = (length, -direction.dot(normal));
            } else {
                self.arrive(&mut suffix.vertices[a - 1], length * length, direction, leaving);
            }
            arc += length;
            suffix.vertices[a].position = position;
            suffix.vertices[a].arc = arc;
            (next, leaving) = (position, direction);
        }
        let start = &mut suffix.vertices[self.inserted + 1];
        let h = self.phase.h(candidates.arriving.batch(b), leaving);
        start.inverse_density = self.phase.inverse_density(h);

        let inverse_area = |radius: f32| core::f32::consts::FRAC_1_PI / (radius * radius);
        Arrival {
            extinction: f32x8::splat(extinction),
            inverse_area: self.lights.gather(&self.light_of, |disk| inverse_area(disk.radius)),
            last_squared: last * last,
            cos_light,
        }
    }

    /// Completes an inserted vertex once the segment that arrives there is known.
    #[inline(always)]
    fn arrive(&self, vertex: &mut SuffixVertex, length_squared: f32x8, arriving: Vec3x8, leaving: Vec3x8) {
        vertex.inverse_density = self.phase.inverse_density(self.phase.h(arriving, leaving));
        vertex.spread = length_squared * vertex.inverse_density;
    }

    /// Number of eligible starts of each row, 0 in dead rows: those behind the last surface and, where the reach is
    /// limited, not before the first vertex near a light.
    #[inline(always)]
    fn starts(&self, paths: &PathTable<'_>, step: Step, rows: u32, limited: bool) -> u32x8 {
        let path = &paths.columns;
        let segments = u32x8::splat(step.clock + self.inserted as u32 + 1) - path.birth.gather(&self.lane_of);
        let mut first = path.last_surface.gather(&self.lane_of).max(u32x8::splat(1));
        if limited {
            first = first.max(path.first_near.gather(&self.lane_of));
        }
        let live: u32x8 = bytemuck::cast(lanes::mask(rows));
        segments.saturating_sub(first) & live
    }

    /// Extends the suffix beyond the start, along the history, to `longest` segments.
    #[inline(always)]
    fn walk_history(&self, vertices: &VertexTable<'_>, step: Step, suffix: &mut Suffix<'_>, longest: usize) {
        for a in self.inserted + 2..=longest {
            let slot = vertices.at(self.clock_of(step, a));
            let position = slot.position.gather(&self.lane_of);
            let inverse_density = slot.inverse_density.gather(&self.lane_of);
            let after = &mut suffix.vertices[a - 1];
            let length_squared = (after.position - position).length_squared();
            after.spread = length_squared * after.inverse_density;
            let arc = after.arc + length_squared.sqrt();
            let vertex = &mut suffix.vertices[a];
            (vertex.position, vertex.inverse_density, vertex.arc) = (position, inverse_density, arc);
        }
    }

    /// The clock of suffix vertex `a`, which is the start or lies before it.
    #[inline(always)]
    fn clock_of(&self, step: Step, a: usize) -> u32 {
        step.clock - (a - self.inserted - 1) as u32
    }

    /// Probability of selecting the candidates' lights from suffix vertex `a`.
    #[inline(always)]
    fn selection(&self, vertices: &VertexTable<'_>, step: Step, suffix: &Suffix<'_>, a: usize) -> f32x8 {
        let position = suffix.vertices[a].position;
        let sum = if !self.lights.selection_depends_on_start() {
            f32x8::ONE
        } else if a <= self.inserted {
            selection::light_sum(self.lights, position)
        } else {
            vertices.at(self.clock_of(step, a)).light_sum.gather(&self.lane_of)
        };
        selection::probability(self.lights, &self.light_of, position, sum)
    }
}
