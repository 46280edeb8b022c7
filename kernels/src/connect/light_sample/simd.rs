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

use super::{Columns, selection};
use crate::columns::queues::CandidateBatch;
use crate::connect::distant;
use crate::lanes::LANES;
use crate::random::{self, uniform_x8};
use crate::tables::lights::{FAR, Lights, Places};
use crate::transcendental::sin_cos_turn;
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
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
        let block = random::block_x8(depth, scope.purpose);
        let [choice, u, v, _] = random::words_x8(pixel[b], sample[b], block, step.seed).map(uniform_x8);
        let (lane, arriving) = (lanes::indices(b), arriving.at(b));
        if scope.distant {
            let words = || {
                let block = random::block_x8(depth, scope.purpose.emitter());
                random::words_x8(pixel[b], sample[b], block, step.seed)
            };
            let (emitter, direction) = distant::simd::draw(lights, [choice, u, v], words);
            let point = direction.mul_add(f32x8::splat(FAR), start);
            connections.push_batch(live, CandidateBatch { lane, emitter, start, arriving, point });
            continue;
        }
        let sum = if lights.selection_depends_on_start() { light_sum[b] } else { f32x8::ONE };
        let mut emitter = selection::choose(lights, start, sum, choice);
        if lights.groups {
            let block = random::block_x8(depth, scope.purpose.emitter());
            let [words, ..] = random::words_x8(pixel[b], sample[b], block, step.seed);
            emitter = emitters_of(lights, emitter, words);
        }
        let point = point_on(lights, &emitter.to_array(), u, v);
        let to_start = start - point;
        let squared = to_start.length_squared();
        let mut keep = squared.simd_le(f32x8::splat(scope.max_distance * scope.max_distance));
        if let Some(reach) = &scope.reach {
            keep &= reach.may_hold(start, point, squared);
        }
        if scope.facing {
            keep &= lights.cosine(&emitter.to_array(), point, -to_start).simd_gt(f32x8::ZERO);
        }
        let batch = CandidateBatch { lane, emitter, start, arriving, point };
        connections.push_batch(lanes::bits(keep) & live, batch);
    }
}

/// One emitter of each light.
#[inline(always)]
fn emitters_of(lights: &Lights, light: u32x8, words: u32x8) -> u32x8 {
    let (light, words) = (light.to_array(), words.to_array());
    u32x8::new(core::array::from_fn(|i| lights.choose_emitter(light[i], words[i])))
}

/// Points on emitters, uniform in area.
#[inline(always)]
fn point_on(lights: &Lights, emitters: &[u32; LANES], u: f32x8, v: f32x8) -> Vec3x8 {
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
