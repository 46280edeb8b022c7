//! ```text
//! count: u < eps ? floor(v room) : drawn from the table at tau(s) and gamma
//! build: x = 0, (t, b, d) = unit vectors; per edge: x += -ln(1 - u) d, (t, b, d) turned by the phase function
//!        e = x_N / |x_N|, p = (z - (z.e) e) / |..|, q = e x p
//!        vertex = start + s / |x_N| (w (x.e) + a (x.p) + b (x.q))
//! roll:  psi as the phase function has it,  or tan(psi / 2) = tan(pi (u - 1/2)) at a surface
//! ```
//!
//! 1. Building works on one bucket at a time: eight bridges of the same number of edges, no lane waits.
//! 2. The walk's vertices wait in the chain's own columns for the rotation, which is known only at its end. Before them
//!    the numbers that make its edges are there: edges need each other's directions, but not each other's numbers, whose
//!    logarithms would hold up the turns.
//! 3. p and q have closed forms because the walk leaves along z: `p = (-x z, -y z, r^2) / r`, `q = (y, -x, 0) / r` for
//!    `e = (x, y, z)`, `r^2 = x^2 + y^2`.
//! 4. Rotation, scale and roll are one matrix, multiplied once per vertex.

use wide::{f32x8, u32x8};

use crate::columns::Column3;
use crate::columns::queues::CandidateBatch;
use crate::connect::bridge::{Bridge, Roll};
use crate::connect::buckets::{BuildColumns, CountColumns, DROPPED};
use crate::connect::sequence::Sequence;
use crate::lanes::LANES;
use crate::media::{MediumLanes, MediumX8};
use crate::phase::henyey_greenstein::roll_by;
use crate::phase::{PhaseX8, PlaneAngle};
use crate::random;
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium, with_phase};

/// Least sine or length that is divided by.
const LEAST: f32 = 1e-30;

/// The SIMD kernel; see [`CountKernel`](super::CountKernel).
pub fn count(step: Step, columns: CountColumns<'_, '_, Bridge>) {
    let phase = &columns.medium.phase;
    with_medium!(columns.medium, |medium| with_phase!(phase, |phase| count_edges(step, columns, medium, phase)));
}

#[inline(always)]
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

#[inline(always)]
fn build_walks(step: Step, columns: BuildColumns<'_, '_, Bridge>, phase: impl PhaseX8) {
    let BuildColumns { technique: bridge, solid, paths, last_surface, .. } = columns;
    let BuildColumns { connections, buckets, candidates, chains, .. } = columns;
    for bucket in buckets.buckets() {
        for (b, _) in bucket.batches() {
            let candidate = connections.gather(&buckets.order.batch(b).to_array());
            candidates.set_batch(b, candidate);
            if bucket.inserted > 0 {
                let lane_of = candidate.lane.to_array();
                let sequence = Sequence::new(step, paths, &lane_of);
                let on_surface = if solid { sequence.on_surface(last_surface, &lane_of) } else { f32x8::ZERO };
                let chain = &mut chains.vertices[..bucket.inserted];
                let end = walk(&sequence, &phase, chain, b);
                let [.., roll, _] = sequence.uniforms(random::BRIDGE_COUNT);
                let placement = Placement::new(&phase, bridge.roll, on_surface, &candidate, end, roll);
                place(&placement, candidate.start, chain, b);
            }
        }
    }
}

/// Fills batch `b` of the chain with the inner vertices of a free walk along z; returns its end.
#[inline(always)]
fn walk(sequence: &Sequence, phase: &impl PhaseX8, chain: &mut [Column3<'_>], b: usize) -> Vec3x8 {
    // Length of an edge, and cosine and azimuth of the turn at its end, as uniform numbers.
    let edge = |k: u32| {
        let [length, cosine, azimuth, _] = sequence.uniforms(random::BRIDGE_WALK.nth(k));
        Vec3x8::new(neg_ln(f32x8::ONE - length), cosine, azimuth)
    };
    for (k, vertex) in (0..).zip(&mut *chain) {
        vertex.set_batch(b, edge(k));
    }
    let last = edge(chain.len() as u32).x;
    let mut frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3x8::splat);
    let mut position = Vec3x8::ZERO;
    for vertex in chain {
        let Vec3x8 { x: length, y: cosine, z: azimuth } = vertex.batch(b);
        position = frame[2].mul_add(length, position);
        vertex.set_batch(b, position);
        frame = phase.sample(cosine).carry(frame, azimuth);
    }
    frame[2].mul_add(last, position)
}

/// Moves the vertices of a walk to their places.
#[inline(always)]
fn place(placement: &Placement, start: Vec3x8, chain: &mut [Column3<'_>], b: usize) {
    for vertex in chain {
        let Vec3x8 { x, y, z } = vertex.batch(b);
        vertex.set_batch(b, placement.x.mul_add(x, placement.y.mul_add(y, placement.z.mul_add(z, start))));
    }
}

/// Rotation, scale and roll of a walk: where its unit vectors go.
struct Placement {
    x: Vec3x8,
    y: Vec3x8,
    z: Vec3x8,
}

impl Placement {
    /// The one that takes a walk to `end` along z from the candidate's start to its light point; starts `on_surface`
    /// roll uniformly.
    #[inline(always)]
    fn new(
        phase: &impl PhaseX8,
        roll: Roll,
        on_surface: f32x8,
        candidate: &CandidateBatch,
        end: Vec3x8,
        u: f32x8,
    ) -> Self {
        let (distance, axis) = (candidate.point - candidate.start).length_and_direction();
        let (tangent, bitangent) = axis.frame();
        let (x, y) = (candidate.arriving.dot(tangent), candidate.arriving.dot(bitangent));
        let arriving = PlaneAngle { cosine: candidate.arriving.dot(axis), sine: x.mul_add(x, y * y).sqrt() };

        let (span, along) = end.length_and_direction();
        let leaving = PlaneAngle { cosine: along.z, sine: along.x.mul_add(along.x, along.y * along.y).sqrt() };
        let least = f32x8::splat(LEAST);
        let inverse_sine = f32x8::ONE / leaving.sine.fast_max(least);
        let (px, py) = (along.x * inverse_sine, along.y * inverse_sine);

        // Azimuth of the first edge in the frame of the axis: that of the arriving direction plus the roll.
        let (sin, cos) = match roll {
            Roll::Aligned if on_surface.any() => {
                let [aligned, uniform] = [phase.roll(arriving, leaving, u), roll_uniformly(u)];
                (on_surface.select(uniform.0, aligned.0), on_surface.select(uniform.1, aligned.1))
            }
            Roll::Aligned => phase.roll(arriving, leaving, u),
            Roll::Uniform => roll_uniformly(u),
        };
        let on_axis = arriving.sine.simd_le(least);
        let inverse_sine = f32x8::ONE / arriving.sine.fast_max(least);
        let (cos_phi, sin_phi) = (on_axis.select(f32x8::ONE, x * inverse_sine), y * inverse_sine);
        let cos_azimuth = cos_phi.mul_sub(cos, sin_phi * sin);
        let sin_azimuth = sin_phi.mul_add(cos, cos_phi * sin);
        let a = tangent.mul_add(cos_azimuth, bitangent * sin_azimuth);
        let b = bitangent.mul_add(cos_azimuth, -(tangent * sin_azimuth));

        let scale = distance / span.fast_max(least);
        let (axis, a, b) = (axis * scale, a * scale, b * scale);
        Self {
            x: axis.mul_add(along.x, b.mul_add(py, -(a * (px * along.z)))),
            y: axis.mul_add(along.y, b.mul_neg_add(px, -(a * (py * along.z)))),
            z: axis.mul_add(along.z, a * leaving.sine),
        }
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
