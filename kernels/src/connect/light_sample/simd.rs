//! ```text
//! l = light chosen by the first uniform,    e = one of its emitters
//! disk:      y = o + R sqrt(u) (cos(2 pi v) tangent + sin(2 pi v) bitangent)
//! sphere:    y = o + R (2 sqrt(u - u^2) (cos(2 pi v) tangent + sin(2 pi v) bitangent) + (1 - 2 u) z)
//! triangle:  y = o + sqrt(u) ((1 - v) edge_1 + v edge_2)
//! keep if depth <= max_depth and depth - first < starts, |y - x| <= max_distance or what the even part of a field allows,
//! and y shines towards x where the technique needs a facing light
//! ```
//!
//! 1. Where the distance is limited, rows farther than the limit plus the radius from every light are out of reach
//!    whatever the point; a batch of nothing else draws nothing.

use wide::{f32x8, u32x8};

use super::lights::{LightsIn, OneDisk};
use super::{Columns, Scope, selection};
use crate::columns::queues::CandidateBatch;
use crate::connect::distant;
use crate::lanes::LANES;
use crate::random::{self, Purpose, uniform_f32};
use crate::real::Word;
use crate::tables::lights::{FAR, Lights, Places};
use crate::transcendental::sin_cos_turn;
use crate::vec3::{Vec3, Vec3x8};
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let lights = columns.lights;
    if columns.scope.distant {
        return sample(step, columns, |draw, start, _| {
            let (emitter, direction) = distant::simd::draw(lights, draw.uniforms(), || draw.emitter_words());
            (emitter, direction.mul_add(f32x8::splat(FAR), start), lanes::mask(lanes::ALL))
        });
    }
    match OneDisk::of(lights) {
        Some(disk) => sample_within(step, columns, disk),
        None => sample_within(step, columns, lights),
    }
}

/// Points on `lights` as far as the scope goes.
#[inline(always)]
fn sample_within(step: Step, columns: Columns<'_, '_>, lights: impl LightsIn<f32x8>) {
    let Scope { max_distance, reach, facing, .. } = columns.scope;
    sample(step, columns, |draw, start, light_sum| {
        let (emitters, point, _) = draw.light_point(lights, start, light_sum);
        let to_start = start - point;
        let squared = to_start.length_squared();
        let mut keep = squared.simd_le(f32x8::splat(max_distance * max_distance));
        if let Some(reach) = &reach {
            keep &= reach.may_hold(start, point, squared);
        }
        if facing {
            keep &= lights.cosine(&emitters, point, -to_start).simd_gt(f32x8::ZERO);
        }
        (lights.indices(&[emitters], 0), point, keep)
    });
}

/// Connects every vertex that may start with what `connect` draws for it, a start and its light sum: emitter, point, and
/// whether it is kept.
#[inline(always)]
fn sample(
    step: Step,
    columns: Columns<'_, '_>,
    connect: impl Fn(&Draw<u32x8>, Vec3x8, f32x8) -> (u32x8, Vec3x8, f32x8),
) {
    let Columns { lights, scope, live, paths, last_surface, outlook, vertex, before, connections } = columns;
    let n = live.batches();
    let [pixel, sample, birth, last_surface] =
        [&paths.pixel, &paths.sample, &paths.birth, &last_surface.depth].map(|column| column.view(n));
    let limited = scope.starts < u32::MAX || scope.max_depth < u32::MAX;
    let (starts, arriving, light_sum) = (vertex.position.view(n), before.direction.view(n), outlook.light_sum.view(n));
    for (b, live) in live.each_batch() {
        let start = starts.at(b);
        let depth = u32x8::splat(step.clock) - birth[b];
        let mut live = live;
        if limited {
            let nth = depth - last_surface[b].max(u32x8::splat(1));
            let may = nth.simd_lt(u32x8::splat(scope.starts)) & depth.simd_le(u32x8::splat(scope.max_depth));
            live &= lanes::bits(lanes::as_mask(may));
            if live == 0 {
                continue;
            }
        }
        if scope.max_distance.is_finite() {
            let near = selection::may_be_within(lights, scope.max_distance, start);
            if lanes::bits(near) & live == 0 {
                continue;
            }
        }
        let draw = Draw { pixel: pixel[b], sample: sample[b], depth, purpose: scope.purpose, seed: step.seed };
        let sum = if lights.selection_depends_on_start() { light_sum[b] } else { f32x8::ONE };
        let (emitter, point, keep) = connect(&draw, start, sum);
        let batch = CandidateBatch { lane: lanes::indices(b), emitter, start, arriving: arriving.at(b), point };
        connections.push_batch(lanes::bits(keep) & live, batch);
    }
}

/// What decides on the light points of vertices.
#[derive(Clone, Copy)]
pub(crate) struct Draw<W> {
    /// Pixels of the paths.
    pub pixel: W,
    /// Their samples.
    pub sample: W,
    /// Depths of the vertices.
    pub depth: W,
    /// The random dimension of the light point.
    pub purpose: Purpose,
    /// Seed of the frame.
    pub seed: u32,
}

impl<W: Word> Draw<W> {
    /// Emitters and points on them, of lights that are chosen from `start` with the normalisation `sum`; and what is left
    /// of the block, the words for the roulette.
    #[inline(always)]
    pub fn light_point<L: LightsIn<W::Real>>(
        &self,
        lights: L,
        start: Vec3<W::Real>,
        sum: W::Real,
    ) -> (L::Emitters, Vec3<W::Real>, W) {
        let [choice, u, v, last] = self.words(self.purpose);
        let [choice, u, v] = [choice, u, v].map(uniform_f32);
        let emitters = lights.choose(start, sum, choice, || self.emitter_words()[0]);
        (emitters, lights.point(&emitters, u, v), last)
    }

    /// Uniform numbers for the light and the point.
    #[inline(always)]
    fn uniforms(&self) -> [W::Real; 3] {
        let [choice, u, v, _] = self.words(self.purpose);
        [choice, u, v].map(uniform_f32)
    }

    /// Random words for the emitter.
    #[inline(always)]
    fn emitter_words(&self) -> [W; 4] {
        self.words(self.purpose.emitter())
    }

    #[inline(always)]
    fn words(&self, purpose: Purpose) -> [W; 4] {
        random::words(self.pixel, self.sample, random::block(self.depth, purpose), self.seed)
    }
}

/// Points on emitters, uniform in area.
#[inline(always)]
pub(super) fn point_on(lights: &Lights, emitters: &[u32; LANES], u: f32x8, v: f32x8) -> Vec3x8 {
    let Places { origin, radius, curvature, .. } = lights.places(emitters);
    let [tangent, bitangent] = lights.axes(emitters);
    let (sin, cos) = sin_cos_turn(v);
    let root = u.sqrt();
    let mut r = radius * root;
    let mut axial = f32x8::ZERO;
    if lights.has_spheres() {
        let sphere = curvature.simd_gt(f32x8::ZERO);
        let across = root * (f32x8::ONE - u).sqrt();
        r = sphere.select((across + across) * radius, r);
        axial = sphere.select((f32x8::ONE - (u + u)) * radius, axial);
    }
    let [mut first, mut second] = [r * cos, r * sin];
    if lights.has_meshes() {
        let triangle = radius.simd_eq(f32x8::ZERO);
        first = triangle.select(root * (f32x8::ONE - v), first);
        second = triangle.select(root * v, second);
    }
    let point = tangent.mul_add(first, bitangent.mul_add(second, origin));
    Vec3x8::new(point.x, point.y, point.z + axial)
}
