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
//!    whatever the point: the others are packed before anything is drawn.

use wide::{f32x8, u32x8};

use super::lights::{LightsIn, OneDisk};
use super::{Columns, Scope, selection};
use crate::columns::Field;
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
    let (lights, scope) = (columns.lights, columns.scope);
    if scope.distant {
        return sample_in_place(step, columns, Beyond(lights));
    }
    match OneDisk::of(lights) {
        Some(lights) => sample_within(step, columns, Within { lights, scope }),
        None => sample_within(step, columns, Within { lights, scope }),
    }
}

#[inline(always)]
fn sample_within(step: Step, columns: Columns<'_, '_>, ends: impl Ends) {
    if columns.scope.max_distance.is_finite() {
        sample_packed(step, columns, ends);
    } else {
        sample_in_place(step, columns, ends);
    }
}

/// The far ends of connections.
trait Ends {
    /// Those of eight starts with these light sums: emitters, points, and which are kept, as a mask.
    fn of(&self, draw: &Draw<u32x8>, start: Vec3x8, light_sum: f32x8) -> (u32x8, Vec3x8, f32x8);
}

/// Directions to lights at infinity.
struct Beyond<'a>(&'a Lights);

impl Ends for Beyond<'_> {
    #[inline(always)]
    fn of(&self, draw: &Draw<u32x8>, start: Vec3x8, _: f32x8) -> (u32x8, Vec3x8, f32x8) {
        let (emitter, direction) = distant::simd::draw(self.0, draw.uniforms(), || draw.emitter_words());
        (emitter, direction.mul_add(f32x8::splat(FAR), start), lanes::mask(lanes::ALL))
    }
}

/// Points on lights, as far as the scope goes.
struct Within<L> {
    lights: L,
    scope: Scope,
}

impl<L: LightsIn<f32x8>> Ends for Within<L> {
    #[inline(always)]
    fn of(&self, draw: &Draw<u32x8>, start: Vec3x8, light_sum: f32x8) -> (u32x8, Vec3x8, f32x8) {
        let Scope { max_distance, reach, facing, .. } = self.scope;
        let (emitters, point, _) = draw.light_point(self.lights, start, light_sum);
        let to_start = start - point;
        let squared = to_start.length_squared();
        let mut keep = squared.simd_le(f32x8::splat(max_distance * max_distance));
        if let Some(reach) = &reach {
            keep &= reach.may_hold(start, point, squared);
        }
        if facing {
            keep &= self.lights.cosine(&emitters, point, -to_start).simd_gt(f32x8::ZERO);
        }
        (self.lights.indices(&[emitters], 0), point, keep)
    }
}

/// Connects every vertex that may start; nearly all of them are in reach.
#[inline(always)]
fn sample_in_place(step: Step, columns: Columns<'_, '_>, ends: impl Ends) {
    let Columns { lights, scope, live, paths, outlook, vertex, before, .. } = columns;
    let n = live.batches();
    let [pixel, sample] = [&paths.pixel, &paths.sample].map(|column| column.view(n));
    let depths = Depths::new(step, &columns);
    let connections = columns.connections;
    let (starts, arriving, light_sum) = (vertex.position.view(n), before.direction.view(n), outlook.light_sum.view(n));
    for (b, live) in live.each_batch() {
        let (depth, may) = depths.of(b);
        let live = live & may;
        if live == 0 {
            continue;
        }
        let start = starts.at(b);
        let draw = Draw { pixel: pixel[b], sample: sample[b], depth, purpose: scope.purpose, seed: step.seed };
        let sum = if lights.selection_depends_on_start() { light_sum[b] } else { f32x8::ONE };
        let (emitter, point, keep) = ends.of(&draw, start, sum);
        let batch = CandidateBatch { lane: lanes::indices(b), emitter, start, arriving: arriving.at(b), point };
        connections.push_batch(lanes::bits(keep) & live, batch);
    }
}

/// The same for vertices from which a light may be near, eight of them at a time: they are listed in the queue first,
/// where each gives way to its connection, or to that of another.
#[inline(always)]
fn sample_packed(step: Step, mut columns: Columns<'_, '_>, ends: impl Ends) {
    let listed = list_near(step, &mut columns);
    let Columns { lights, scope, paths, outlook, vertex, before, connections, .. } = columns;
    for b in 0..listed.div_ceil(LANES) {
        let rows = lanes::first(listed - b * LANES);
        let lane = connections.lane.batch(b) & lanes::as_integer_mask(lanes::mask(rows));
        let lane_of = lane.to_array();
        let [pixel, sample, birth] = [&paths.pixel, &paths.sample, &paths.birth].map(|column| column.gather(&lane_of));
        let start = vertex.position.gather(&lane_of);
        let depth = u32x8::splat(step.clock) - birth;
        let draw = Draw { pixel, sample, depth, purpose: scope.purpose, seed: step.seed };
        let depends = lights.selection_depends_on_start();
        let sum = if depends { outlook.light_sum.gather(&lane_of) } else { f32x8::ONE };
        let (emitter, point, keep) = ends.of(&draw, start, sum);
        let batch = CandidateBatch { lane, emitter, start, arriving: before.direction.gather(&lane_of), point };
        connections.push_batch(lanes::bits(keep) & rows, batch);
    }
}

/// Lists the lanes of the vertices that may connect, and from which a light may be near, in the lane column of the
/// queue. Gives their number.
#[inline(always)]
fn list_near(step: Step, columns: &mut Columns<'_, '_>) -> usize {
    let Columns { lights, scope, live, vertex, .. } = *columns;
    let starts = vertex.position.view(live.batches());
    let depths = Depths::new(step, columns);
    let lane = &mut columns.connections.lane;
    let mut listed = 0;
    for (b, live) in live.each_batch() {
        let near = selection::may_be_within(lights, scope.max_distance, starts.at(b));
        let bits = lanes::bits(near) & live & depths.of(b).1;
        if bits != 0 {
            u32::store_packed(lane, listed, lanes::pack_order(bits), lanes::indices(b));
            listed += bits.count_ones() as usize;
        }
    }
    listed
}

/// How deep vertices are, and whether these depths connect.
struct Depths<'a> {
    clock: u32x8,
    birth: &'a [u32x8],
    last_surface: &'a [u32x8],
    scope: Scope,
}

impl<'a> Depths<'a> {
    #[inline(always)]
    fn new(step: Step, columns: &Columns<'a, '_>) -> Self {
        let Columns { live, paths, last_surface, scope, .. } = *columns;
        let n = live.batches();
        let [birth, last_surface] = [&paths.birth, &last_surface.depth].map(|column| column.view(n));
        Self { clock: u32x8::splat(step.clock), birth, last_surface, scope }
    }

    /// Depths of batch `b`, and the bits of those that connect.
    #[inline(always)]
    fn of(&self, b: usize) -> (u32x8, u32) {
        let Scope { starts, max_depth, .. } = self.scope;
        let depth = self.clock - self.birth[b];
        if starts == u32::MAX && max_depth == u32::MAX {
            return (depth, lanes::ALL);
        }
        let nth = depth - self.last_surface[b].max(u32x8::splat(1));
        let may = nth.simd_lt(u32x8::splat(starts)) & depth.simd_le(u32x8::splat(max_depth));
        (depth, lanes::bits(lanes::as_mask(may)))
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
