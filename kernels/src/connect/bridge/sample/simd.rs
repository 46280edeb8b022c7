//! ```text
//! count: u < eps ? floor(v room) : drawn from the table at tau(s) and gamma
//! walk:  x_0 .. x_N, a free walk                                                                            (walk.rs)
//! ends:  x_k = x_N - x_{N-k} where u >= P(first);  f, the direction of the first edge, is then that of the last
//! place: e = x_N / |x_N|, p = (f - (f.e) e) / |..|, q = e x p
//!        vertex = start + s / |x_N| (w (x.e) + a (x.p) + b (x.q))
//! roll:  psi as the phase function has it,  or tan(psi / 2) = tan(pi (u - 1/2)) at a surface
//! ```
//!
//! 1. Building works on one bucket at a time: eight bridges of the same number of edges, no lane waits. Candidates are
//!    gathered for all buckets before, so that no walk waits for them.
//! 2. Rotation, scale and roll are one matrix, multiplied once per vertex.
//! 3. Vertices k and N - k change places where the walk's ends do, so that they are placed together.

use wide::{f32x8, u32x8};

use super::walk::FreeWalk;
use crate::columns::Column3;
use crate::columns::queues::{Bucket, CandidateBatch};
use crate::connect::bridge::ends::Ends;
use crate::connect::bridge::suit::Suit;
use crate::connect::bridge::{Bridge, MOST_ALTERNATIVES, Roll};
use crate::connect::buckets::{BuildColumns, CountColumns, DROPPED};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::media::{MediumLanes, MediumX8};
use crate::phase::henyey_greenstein::roll_by;
use crate::phase::{PhaseX8, PlaneAngle};
use crate::random;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium, with_phase};

/// Least sine or length that is divided by.
const LEAST: f32 = 1e-30;

/// The SIMD kernel; see [`CountKernel`](super::CountKernel).
pub fn count(step: Step, columns: CountColumns<'_, '_, Bridge>) {
    let phase = &columns.medium.phase;
    with_medium!(columns.medium, |medium| with_phase!(phase, |phase| count_edges(step, columns, medium, phase)));
}

#[inline(never)]
fn count_edges(step: Step, columns: CountColumns<'_, '_, Bridge>, medium: impl MediumLanes, phase: impl PhaseX8) {
    let CountColumns { technique: bridge, lengths, solid, paths, immersion, last_surface, .. } = columns;
    let CountColumns { connections, count, .. } = columns;
    let most = bridge.max_inserted.saturating_add(1);
    let lobe = phase.lobe();
    for b in 0..connections.len.div_ceil(LANES) {
        let lane_of = connections.lane.batch(b).to_array();
        let sequence = Sequence::new(step, paths, &lane_of);
        let on_surface = if solid { sequence.on_surface(last_surface, &lane_of) } else { f32x8::ZERO };
        let [choice, number, _, along] = sequence.uniforms(random::BRIDGE_COUNT);
        let room = (u32x8::splat(lengths.max) - sequence.depth).min(u32x8::splat(most));
        let medium = medium.in_channel(|| immersion.hero.gather(&lane_of));
        let (start, point) = (connections.start.batch(b), connections.point.batch(b));
        let (distance, axis) = (point - start).length_and_direction();
        let h = lobe.h(connections.arriving.batch(b), axis);
        let depth = medium.optical_depth(start, point, distance);
        let cell = bridge.counts.cell(depth, h, on_surface);

        let uniform = choice.simd_lt(f32x8::splat(bridge.defensive));
        let across = (choice - f32x8::splat(bridge.defensive)) * f32x8::splat(1.0 / (1.0 - bridge.defensive));
        let spread = floor(number * lanes::to_f32(room)).min(room - u32x8::splat(1));
        let tabled = bridge.counts.draw(&cell, [along, across], number);
        let inserted = lanes::as_integer_mask(uniform).select(spread, tabled);
        let near = lanes::as_integer_mask(depth.simd_le(f32x8::splat(bridge.max_depth) * medium.over_clearest()));
        let fits = inserted.simd_lt(room) & near;
        count.set_batch(b, fits.select(inserted, u32x8::splat(DROPPED)));
    }
}

/// The SIMD kernel; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_, Bridge>) {
    with_phase!(&columns.medium.phase, |phase| build_walks(step, columns, phase));
}

#[inline(never)]
fn build_walks(step: Step, columns: BuildColumns<'_, '_, Bridge>, phase: impl PhaseX8) {
    let mut columns = columns;
    let BuildColumns { technique: bridge, connections, buckets, .. } = columns;
    for (b, _) in buckets.buckets().iter().flat_map(|bucket| bucket.batches()) {
        columns.candidates.set_batch(b, connections.gather(&buckets.order.batch(b).to_array()));
        columns.chains.resampling.set_batch(b, f32x8::ONE);
    }
    for bucket in buckets.buckets().iter().filter(|bucket| bucket.inserted > 0) {
        match bridge.alternatives_of(bucket.inserted + 1) {
            1 => build_bucket::<1, _>(step, &mut columns, phase, *bucket),
            _ => build_bucket::<MOST_ALTERNATIVES, _>(step, &mut columns, phase, *bucket),
        }
    }
}

/// Builds the bridges of a bucket from walks of `M` alternatives.
#[inline(never)]
fn build_bucket<const M: usize, P: PhaseX8>(
    step: Step,
    columns: &mut BuildColumns<'_, '_, Bridge>,
    phase: P,
    bucket: Bucket,
) {
    let BuildColumns { technique: bridge, lights, solid, paths, last_surface, .. } = *columns;
    let (candidates, chains, pieces) = (&*columns.candidates, &mut *columns.chains, &mut *columns.pieces);
    let lobe = phase.lobe();
    for (b, _) in bucket.batches() {
        let candidate = candidates.batch(b);
        let lane_of = candidate.lane.to_array();
        let sequence = Sequence::new(step, paths, &lane_of);
        let course = Course::new(&candidate);
        let on_surface = if solid { sequence.on_surface(last_surface, &lane_of) } else { f32x8::ZERO };
        let ends = Ends { lobe: &lobe, arriving: course.arriving };
        let light = lights.filter(|_| M > 1).map(|lights| {
            PlaneAngle::of_cosine(lights.cosine(&candidate.emitter.to_array(), candidate.point, course.axis))
        });
        let suit = Suit { ends, light };
        let free =
            FreeWalk::<M>::new(&sequence, &phase, pieces, bucket.inserted + 1, |first, last| suit.of(first, last));

        let (span, along) = free.end.length_and_direction();
        let lead = match bridge.roll {
            Roll::Aligned => Lead::chosen(&free, along, on_surface, &ends),
            Roll::Uniform => Lead::first(along),
        };
        let [.., u, _] = sequence.uniforms(random::BRIDGE_COUNT);
        let rolled = course.roll(&phase, bridge.roll, on_surface, lead.angle, u);
        let placement = Placement::new(&course, &lead, rolled, span, along, free.end);
        place(&placement, candidate.start, &free, &mut chains.vertices[..bucket.inserted], b);
        chains.resampling.set_batch(b, free.resampling);
    }
}

/// The way of eight bridges from start to light point.
struct Course {
    distance: f32x8,
    axis: Vec3x8,
    /// Unit vectors across the axis.
    across: [Vec3x8; 2],
    /// What the direction in which the path arrives is along them.
    beside: [f32x8; 2],
    /// gamma: its angle to the axis.
    arriving: PlaneAngle,
}

impl Course {
    #[inline(always)]
    fn new(candidate: &CandidateBatch) -> Self {
        let (distance, axis) = (candidate.point - candidate.start).length_and_direction();
        let (tangent, bitangent) = axis.frame();
        let (x, y) = (candidate.arriving.dot(tangent), candidate.arriving.dot(bitangent));
        let arriving = PlaneAngle { cosine: candidate.arriving.dot(axis), sine: x.mul_add(x, y * y).sqrt() };
        Self { distance, axis, across: [tangent, bitangent], beside: [x, y], arriving }
    }

    /// Unit vectors across the axis, the first of them where the first edge goes, which leaves at the angle `leaving`: by
    /// the number u, and for starts `on_surface` uniformly.
    #[inline(always)]
    fn roll(&self, phase: &impl PhaseX8, roll: Roll, on_surface: f32x8, leaving: PlaneAngle, u: f32x8) -> [Vec3x8; 2] {
        let (sin, cos) = match roll {
            Roll::Aligned if on_surface.any() => {
                let [aligned, uniform] = [phase.roll(self.arriving, leaving, u), roll_uniformly(u)];
                (on_surface.select(uniform.0, aligned.0), on_surface.select(uniform.1, aligned.1))
            }
            Roll::Aligned => phase.roll(self.arriving, leaving, u),
            Roll::Uniform => roll_uniformly(u),
        };
        let ([tangent, bitangent], [x, y]) = (self.across, self.beside);
        let least = f32x8::splat(LEAST);
        let on_axis = self.arriving.sine.simd_le(least);
        let inverse_sine = f32x8::ONE / self.arriving.sine.fast_max(least);
        let (cos_phi, sin_phi) = (on_axis.select(f32x8::ONE, x * inverse_sine), y * inverse_sine);
        let cos_azimuth = cos_phi.mul_sub(cos, sin_phi * sin);
        let sin_azimuth = sin_phi.mul_add(cos, cos_phi * sin);
        [
            tangent.mul_add(cos_azimuth, bitangent * sin_azimuth),
            bitangent.mul_add(cos_azimuth, -(tangent * sin_azimuth)),
        ]
    }
}

/// The edge of a free walk that comes first in the bridge.
struct Lead {
    /// Whether that is its last.
    turned: f32x8,
    /// Its unit direction.
    direction: Vec3x8,
    /// Its angle to the walk's axis.
    angle: PlaneAngle,
}

impl Lead {
    /// The walk's own first edge; `along` is the unit vector to its end.
    #[inline(always)]
    fn first(along: Vec3x8) -> Self {
        let angle = PlaneAngle { cosine: along.z, sine: along.x.mul_add(along.x, along.y * along.y).sqrt() };
        Self { turned: f32x8::ZERO, direction: Vec3x8::splat([0.0, 0.0, 1.0]), angle }
    }

    /// That of the end which the walk's number chooses, but its own first where the start is `on_surface`.
    #[inline(always)]
    fn chosen<const M: usize>(free: &FreeWalk<'_, M>, along: Vec3x8, on_surface: f32x8, ends: &Ends<'_>) -> Self {
        let (first, last_angle) = (Self::first(along), PlaneAngle::between(free.last, along));
        let turned = !(free.choice.simd_lt(ends.share(first.angle, last_angle)) | on_surface);
        let either = |last: f32x8, first: f32x8| turned.select(last, first);
        Self {
            turned,
            direction: Vec3x8::select(turned, free.last, first.direction),
            angle: PlaneAngle {
                cosine: either(last_angle.cosine, first.angle.cosine),
                sine: either(last_angle.sine, first.angle.sine),
            },
        }
    }
}

/// Moves the inner vertices of a walk to their places in batch `b` of the chain.
#[inline(always)]
fn place<const M: usize>(
    placement: &Placement,
    start: Vec3x8,
    free: &FreeWalk<'_, M>,
    chain: &mut [Column3<'_>],
    b: usize,
) {
    let inner = chain.len();
    for k in 0..inner.div_ceil(2) {
        let opposite = inner - 1 - k;
        let (this, other) = (free.vertex(k), free.vertex(opposite));
        chain[k].set_batch(b, placement.of(start, this, other));
        chain[opposite].set_batch(b, placement.of(start, other, this));
    }
}

/// Where a walk goes.
struct Placement {
    /// Rotation, scale and roll: where its unit vectors go.
    axes: [Vec3x8; 3],
    /// Whether its last edge comes first.
    turned: f32x8,
    /// Its end.
    end: Vec3x8,
}

impl Placement {
    /// The one that takes a walk of the given `span` `along` a unit vector on its course, its first edge rolled towards
    /// the first of the vectors `rolled`.
    #[inline(always)]
    fn new(course: &Course, lead: &Lead, [a, b]: [Vec3x8; 2], span: f32x8, along: Vec3x8, end: Vec3x8) -> Self {
        // What is left of the first edge across the axis may be so little that it is mostly rounding, and is then not quite
        // across. In this order all are perpendicular to each other nevertheless.
        let across = along.mul_neg_add(lead.direction.dot(along), lead.direction);
        let (_, beside) = along.cross(across).length_and_direction();
        let aside = beside.cross(along);
        let scale = course.distance / span.fast_max(f32x8::splat(LEAST));
        let (axis, a, b) = (course.axis * scale, a * scale, b * scale);
        let column = |e: f32x8, p: f32x8, q: f32x8| axis.mul_add(e, a.mul_add(p, b * q));
        let axes = [
            column(along.x, aside.x, beside.x),
            column(along.y, aside.y, beside.y),
            column(along.z, aside.z, beside.z),
        ];
        Self { axes, turned: lead.turned, end }
    }

    /// The place of the vertex of a bridge from `start` that is `this` in the walk, and as many edges from its end as
    /// `other` is from its beginning.
    #[inline(always)]
    fn of(&self, start: Vec3x8, this: Vec3x8, other: Vec3x8) -> Vec3x8 {
        let Vec3x8 { x, y, z } = Vec3x8::select(self.turned, self.end - other, this);
        self.axes[0].mul_add(x, self.axes[1].mul_add(y, self.axes[2].mul_add(z, start)))
    }
}

/// `(sin, cos)` of a roll by which all angles are alike.
#[inline(always)]
fn roll_uniformly(u: f32x8) -> (f32x8, f32x8) {
    roll_by(f32x8::ONE, f32x8::ONE, u)
}

/// The whole part of a number >= 0.
#[inline(always)]
fn floor(x: f32x8) -> u32x8 {
    bytemuck::cast(x.fast_trunc_int())
}
