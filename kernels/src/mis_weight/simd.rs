//! ```text
//! walk from the light towards the camera and collect, per vertex, arc length, direction, p_w, l^2 / p_w
//! weight = profile / (reach(n) + sum over active techniques and starts i of reach(i) r_i)
//! at infinity:    weight = 1 / (reach(n) + reach(n - 1) p_dir P_l e^tau / p_w)
//! reach(i) = product of the survivals at vertices 1 .. i - 1
//! ```
//!
//! 1. A bucket's rows have the same number of inserted vertices, so the walk meets the start at the same index in all
//!    lanes; what differs is only which starts are eligible.
//! 2. Inserted vertices and start are read as batches, history as rows of the trail, which knows directions and
//!    lengths.
//! 3. Nothing is computed before the first or beyond the last start that an active technique can use, and phase
//!    functions only for the techniques that ask for them: bridges do not.
//! 4. Batches that end at infinity skip what others need. In mixed ones, the rows that do take another sum in the end.
//! 5. Where next event estimation alone competes a shorter way does (`straight`).
//! 6. Zero-length segments get a zero direction instead of NaN; their ratios vanish with their squared length.

use wide::{f32x8, u32x8};

use super::colours::Colours;
use super::passages::Passages;
use super::starts::Starts;
use super::{Columns, Competing, factors, straight};
use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, VertexColumns};
use crate::columns::queues::{CandidateQueue, ChainTable};
use crate::columns::trail::TrailTable;
use crate::connect::light_sample::selection;
use crate::connect::ratios::simd::Competition;
use crate::connect::suffix::{Arrival, Passage, Suffix, SuffixVertex};
use crate::connect::{Densities, distant};
use crate::lanes::LANES;
use crate::media::{Even, MediumLanes, MediumX8};
use crate::phase::PhaseX8;
use crate::survival::LogSurvival;
use crate::tables::lights::{Choices, Lights};
use crate::transcendental::exp;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium, with_phase};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let phase = &columns.medium.phase;
    with_medium!(columns.medium, |medium| with_phase!(phase, |phase| weigh(step, columns, medium, phase)));
}

#[inline(never)]
fn weigh<M: MediumLanes, P: PhaseX8>(step: Step, columns: Columns<'_, '_>, media: M, phase: P) {
    if straight::suffices::<M>(&columns) {
        return straight::weigh(step, columns, media, phase);
    }
    let mut columns = columns;
    let Columns { medium, lights, techniques, walk, bucket, candidates, chains, paths, .. } = columns;
    let Columns { last_surface, outlook, vertex, trail, .. } = columns;
    factors::fill(medium, bucket, chains, columns.worth);
    let (densities, usable) = (techniques.densities(), techniques.most_edges());
    let (near, usable_near) = (techniques.near(), techniques.most_edges_near());
    let reaches_far = lights.has_distant();
    for (b, rows) in bucket.batches() {
        let batch = Batch {
            inserted: bucket.inserted,
            lane_of: candidates.lane.batch(b).to_array(),
            emitter_of: candidates.emitter.batch(b).to_array(),
            lights,
            phase,
            densities: densities == Densities::All,
            last_density: densities >= Densities::Last || reaches_far,
            survival: LogSurvival::of(&walk.survival),
        };
        let starts = Starts::new(&batch.lane_of, rows, bucket.inserted, paths, last_surface, walk, step);
        let near = batch.most_edges_near(near, outlook, &starts).min(usable_near);
        let far = if reaches_far { lights.are_distant(&batch.emitter_of) } else { f32x8::ZERO };
        let all_far = reaches_far && far.all();
        let (mut fewest, mut needed) = (starts.fewest_edges(), starts.most_edges().min(usable).max(near));
        if columns.competing == Competing::Own {
            (fewest, needed) = (fewest.max(bucket.inserted + 1), needed.min(bucket.inserted + 1));
        }
        if all_far {
            needed = 0;
        }

        let suffix = &mut *columns.suffix;
        let (last_length, cos_light) = batch.walk_connection(b, candidates, chains, suffix);
        batch.walk_history(outlook, vertex, trail, step, suffix, needed);
        let walked = Walked { starts, fewest, needed, near: near.min(needed), last_length, cos_light, far, all_far };
        let points = suffix.vertices[..=needed.max(bucket.inserted + 1)].iter().map(|vertex| vertex.position);
        if media.own().stays_even(points, rows) {
            batch.compete(step, &mut columns, Even(media), b, &walked);
        } else {
            batch.compete(step, &mut columns, media, b, &walked);
        }
    }
}

/// What is known of eight candidates once their suffixes have been walked.
struct Walked {
    starts: Starts,
    /// The nearest start, counted from the light, that competes.
    fewest: usize,
    /// The farthest that any technique can use.
    needed: usize,
    /// The farthest that those can use which are limited in distance.
    near: usize,
    /// The last segment's length `[m]`.
    last_length: f32x8,
    /// Cosine at the light.
    cos_light: f32x8,
    /// Rows that end at infinity.
    far: f32x8,
    /// Whether all do.
    all_far: bool,
}

/// Eight candidates of one bucket.
#[derive(Clone, Copy)]
struct Batch<'a, P> {
    inserted: usize,
    lane_of: [u32; LANES],
    emitter_of: [u32; LANES],
    lights: &'a Lights,
    phase: P,
    /// Whether phase functions are asked for.
    densities: bool,
    /// Whether that of the vertex next to the light is.
    last_density: bool,
    survival: LogSurvival<'a>,
}

/// l^2 / (pi p_w) of a vertex where a segment of squared length l^2 arrives.
#[inline(always)]
fn spread(length_squared: f32x8, inverse_density: f32x8) -> f32x8 {
    length_squared * inverse_density * f32x8::FRAC_1_PI
}

impl<P: PhaseX8> Batch<'_, P> {
    /// Weighs batch `b`, whose suffix has been walked.
    #[inline(always)]
    fn compete<M: MediumLanes>(&self, step: Step, columns: &mut Columns<'_, '_>, media: M, b: usize, walked: &Walked) {
        let Columns { lights, techniques, walk, competing, lengths, solid, bucket, log_posterior, .. } = *columns;
        let Columns { last_surface, passages, passage_trails, .. } = *columns;
        let (suffix, worth) = (&mut *columns.suffix, &mut *columns.worth);
        let Walked { starts, fewest, needed, near, last_length, cos_light, far, all_far } = walked;
        let (fewest_edges, needed) = (*fewest, *needed);
        let (mut dense, mut apart) = (lanes::mask(lanes::ALL), false);
        if M::Channel::VARIES {
            let passages = Passages { lane_of: self.lane_of, current: passages, trail: passage_trails, step };
            dense = passages.fill(media, suffix, bucket.inserted, needed);
            apart = M::COLOURED && passages.are_apart();
        }
        let colours = M::COLOURED.then(|| {
            let log_posterior = core::array::from_fn(|c| log_posterior.channels()[c].gather(&self.lane_of));
            if apart {
                Colours::apart(bucket.inserted, log_posterior, suffix, needed)
            } else {
                Colours::new(bucket.inserted, media, log_posterior, suffix, *last_length)
            }
        });
        let medium = media.in_channel(|| colours.as_ref().map_or(u32x8::splat(0), |colours| colours.reference));
        let choices = lights.choices(&self.emitter_of);
        let last = &suffix.vertices[1];
        let arrival = Arrival {
            medium,
            hues: colours.as_ref().and_then(|colours| colours.hues()),
            inverse_area: choices.density,
            last_squared: *last_length * *last_length,
            last_depth: medium.optical_depth_along(*last_length, last.depth),
            cos_light: *cos_light,
            last_arc: *last_length,
            skipped: Passage::NOTHING,
        };
        for a in fewest_edges..=needed {
            let attempt = self.selection(&choices, suffix, a) * self.reach(starts, a);
            let vertex = &mut suffix.vertices[a];
            (vertex.attempt, vertex.eligible) = (attempt, starts.eligible(a));
            vertex.depth = medium.optical_depth_along(vertex.arc + *last_length, vertex.depth);
        }
        let mut sum = starts.reach_of_walk(self.survival, walk);
        if let Some(colours) = &colours {
            sum *= colours.walked_to_the_light(suffix);
            colours.share(fewest_edges..=needed, suffix);
            colours.fill_quotients(b, suffix, worth);
        }
        let by_walk = sum;
        let outside = if solid { self.reflect(last_surface, starts, suffix, needed) } else { lanes::mask(lanes::ALL) };
        if !all_far {
            let competition = Competition {
                techniques,
                phase: self.phase,
                lights,
                emitter_of: self.emitter_of,
                arrival,
                segments: starts.segments,
                longest: lengths.max,
                starts: fewest_edges..=needed,
                farthest_near: *near,
            };
            sum = competition.add_ratios(sum, suffix);
        }
        if lights.has_distant() {
            let start = &suffix.vertices[1];
            let seen = distant::simd::see(lights, &self.emitter_of, start.leaving);
            let connected = seen.density * self.reach(starts, 1) * start.inverse_density * exp(arrival.last_depth);
            let connects = if techniques.any() { *far } else { f32x8::ZERO };
            sum = far.select(by_walk + (connects & connected), sum);
            if lights.has_panorama() {
                seen.tint(b, &mut worth.factor);
            }
        }
        // Of a sum that is no number, neither is the weight: it is dropped and counted where it would have been added.
        let mut weighs = arrival.cos_light.simd_gt(f32x8::ZERO) & outside & dense;
        if competing == Competing::All {
            weighs &= !sum.simd_le(f32x8::ZERO);
        }
        let profile = lights.profile(&self.emitter_of, arrival.cos_light);
        worth.weight.set_batch(b, weighs.select(profile / sum, f32x8::ZERO));
    }

    /// Fills the suffix from the light to the start: positions, arc lengths, densities, spreads. Gives the last segment's
    /// length and the cosine at the light.
    #[inline(always)]
    fn walk_connection(
        &self,
        b: usize,
        candidates: &CandidateQueue<'_>,
        chains: &ChainTable<'_>,
        suffix: &mut Suffix<'_>,
    ) -> (f32x8, f32x8) {
        let point = candidates.point.batch(b);
        let (mut arc, mut leaving, mut last) = (f32x8::ZERO, Vec3x8::ZERO, f32x8::ZERO);
        let mut cos_light = f32x8::ZERO;
        let mut next = point;
        suffix.vertices[0].position = point;
        for a in 1..=self.inserted + 1 {
            let is_start = a > self.inserted;
            let position =
                if is_start { candidates.start.batch(b) } else { chains.vertices[self.inserted - a].batch(b) };
            let (length, direction) = (next - position).length_and_direction();
            if a == 1 {
                (last, cos_light) = (length, self.lights.cosine(&self.emitter_of, point, direction));
            } else {
                arc += length;
                if self.densities || a == 2 && self.last_density {
                    self.arrive(&mut suffix.vertices[a - 1], length * length, direction, leaving);
                }
            }
            let vertex = &mut suffix.vertices[a];
            (vertex.position, vertex.arc, vertex.leaving) = (position, arc, direction);
            (next, leaving) = (position, direction);
        }
        let arriving = candidates.arriving.batch(b);
        suffix.vertices[self.inserted + 2].leaving = arriving;
        if self.densities || self.last_density && self.inserted == 0 {
            let start = &mut suffix.vertices[self.inserted + 1];
            start.inverse_density = self.phase.inverse_density(arriving, leaving);
        }
        (last, cos_light)
    }

    /// Completes an inserted vertex once the segment that arrives there is known.
    #[inline(always)]
    fn arrive(&self, vertex: &mut SuffixVertex, length_squared: f32x8, arriving: Vec3x8, leaving: Vec3x8) {
        vertex.inverse_density = self.phase.inverse_density(arriving, leaving);
        vertex.spread = spread(length_squared, vertex.inverse_density);
    }

    /// Replaces the phase function by the reflection where a start is on a surface; gives the rows that leave their
    /// surface outwards, or have none.
    #[inline(always)]
    fn reflect(
        &self,
        last_surface: &LastSurfaceColumns<'_>,
        starts: &Starts,
        suffix: &mut Suffix<'_>,
        needed: usize,
    ) -> f32x8 {
        let mut outside = lanes::mask(lanes::ALL);
        let last = needed.max(self.inserted + 1);
        suffix.vertices[1..=last].iter_mut().for_each(|vertex| vertex.on_surface = f32x8::ZERO);
        let first = starts.first_on_surface();
        if first > last {
            return outside;
        }
        let normal = last_surface.normal.gather(&self.lane_of);
        for a in first..=last {
            let vertex = &mut suffix.vertices[a];
            vertex.on_surface = starts.surface & lanes::as_mask(starts.most_edges.simd_eq(u32x8::splat(a as u32)));
            if !vertex.on_surface.any() {
                continue;
            }
            let cosine = vertex.leaving.dot(normal);
            outside &= !vertex.on_surface | cosine.simd_gt(f32x8::ZERO);
            let inverse_density = f32x8::splat(core::f32::consts::PI) / cosine;
            vertex.inverse_density = vertex.on_surface.select(inverse_density, vertex.inverse_density);
        }
        outside
    }

    /// The farthest start, counted from the light, that may have a light within the distance `near`: an inserted
    /// vertex, or one of the walk from the first near one on.
    #[inline(always)]
    fn most_edges_near(&self, near: f32, outlook: &OutlookColumns<'_>, starts: &Starts) -> usize {
        if near.is_infinite() {
            return starts.most_edges();
        }
        let first_near = outlook.first_near.gather(&self.lane_of);
        let near = starts.segments.saturating_sub(first_near) & lanes::as_integer_mask(starts.live);
        near.max(u32x8::splat(self.inserted as u32)).min(starts.most_edges).reduce_max() as usize
    }

    /// Probability that a walk gets to start `a`.
    #[inline(always)]
    fn reach(&self, starts: &Starts, a: usize) -> f32x8 {
        self.survival.reach(starts.depth(a))
    }

    /// Extends the suffix beyond the start, along the history, to `most_edges` segments, and notes how the path arrives
    /// there.
    #[inline(always)]
    fn walk_history(
        &self,
        outlook: &OutlookColumns<'_>,
        current: &VertexColumns<'_>,
        trail: &TrailTable<'_>,
        step: Step,
        suffix: &mut Suffix<'_>,
        most_edges: usize,
    ) {
        let start = self.inserted + 1;
        if self.lights.selection_depends_on_start() {
            suffix.vertices[start].light_sum = outlook.light_sum.gather(&self.lane_of);
        }
        if most_edges <= start {
            return;
        }
        let whole = suffix.vertices[start].arc + current.arc.gather(&self.lane_of);
        for a in start + 1..=most_edges + 1 {
            let mark = trail.gather(&self.lane_of, self.clock_of(step, a));
            let vertex = &mut suffix.vertices[a];
            (vertex.position, vertex.arc) = (mark.position, whole - mark.arc);
            (vertex.leaving, vertex.light_sum) = (mark.leaving, mark.light_sum);
        }
        if self.densities {
            for a in start + 1..=most_edges {
                let [before, vertex, after] =
                    suffix.vertices.get_disjoint_mut([a - 1, a, a + 1]).expect("three vertices");
                let length_squared = (before.position - vertex.position).length_squared();
                before.spread = spread(length_squared, before.inverse_density);
                vertex.inverse_density = self.phase.inverse_density(after.leaving, vertex.leaving);
            }
        }
    }

    /// The clock of suffix vertex `a`, which is the start or lies before it.
    #[inline(always)]
    fn clock_of(&self, step: Step, a: usize) -> u32 {
        step.clock - (a - self.inserted - 1) as u32
    }

    /// Probability of selecting the candidates' lights from suffix vertex `a`.
    #[inline(always)]
    fn selection(&self, lights: &Choices, suffix: &Suffix<'_>, a: usize) -> f32x8 {
        let SuffixVertex { position, light_sum, .. } = suffix.vertices[a];
        let is_inserted = a <= self.inserted && self.lights.selection_depends_on_start();
        let sum = if is_inserted { selection::light_sum(self.lights, position) } else { light_sum };
        selection::probability(self.lights, lights, position, sum)
    }
}
