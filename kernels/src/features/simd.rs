//! ```text
//! clear = inf, or distance of what is solid
//! t     = min(flight, clear);   hit = t < inf
//! depth = near + t d . axis;    albedo = flight < clear ? albedo(x + t d) : 0;   normal = 0
//! what is solid with clear <= flight:  normal, albedo = those there
//! push view from x to x + min(clear, FAR) d, factor_c = e^{-tau_c}
//! ```
//!
//! 1. Solids are listed, and scattered to their lanes: distances first, then what they look like, one by one.
//! 2. Batches are taken for media in between. Lanes that are not requested hold what older samples have seen.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::paths::FeatureColumns;
use crate::columns::queues::{CandidateBatch, HitQueue, SurfaceHit, SurfaceHitQueue};
use crate::columns::{Column, Field};
use crate::media::{MediumLanes, MediumX8};
use crate::tables::geometry::TriangleHit;
use crate::tables::lights::{Emitter, FAR, Lights, Shape};
use crate::tables::surfaces::Surfaces;
use crate::trace::surface;
use crate::transcendental::exp;
use crate::vec3::Vec3x8;
use crate::{Step, lanes, with_medium};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    with_medium!(columns.medium, |medium| look(columns, medium));
}

#[inline(always)]
fn look<M: MediumLanes>(columns: Columns<'_, '_>, lanes_of_medium: M) {
    let Columns { camera, medium, lights, surfaces, requested, vertex, ray, flight, .. } = columns;
    let Columns { hits, surface_hits, features, views, worth, .. } = columns;
    views.len = 0;
    measure(features, requested, lights, hits, surface_hits);
    let (axis, near) = (Vec3x8::splat(camera.forward), f32x8::splat(camera.near));
    let albedos = medium.albedos_by_place();
    for (b, bits) in requested.each_batch() {
        let (origin, direction) = (vertex.position.batch(b), ray.direction.batch(b));
        let (flight, clear) = (flight.batch(b), features.clear.batch(b));
        let distance = flight.fast_min(clear);
        let hit = distance.simd_lt(f32x8::splat(f32::INFINITY));
        let depth = distance.mul_add(direction.dot(axis), near);
        let new = lanes::mask(bits);
        set(&mut features.depth, b, new, hit.select(depth, f32x8::ZERO));
        set(&mut features.hit, b, new, hit.select(f32x8::ONE, f32x8::ZERO));
        let normal = features.normal.batch(b);
        features.normal.set_batch(b, Vec3x8::select(new, Vec3x8::ZERO, normal));
        let within = flight.simd_lt(clear);
        let at = direction.mul_add(within.select(distance, f32x8::ZERO), origin);
        let albedo = albedos.map_or(medium.albedo.map(f32x8::splat), |albedos| albedos.at(at));
        let [red, green, blue] = albedo.map(|albedo| within.select(albedo, f32x8::ZERO));
        let before = features.albedo.batch(b);
        features.albedo.set_batch(b, Vec3x8::select(new, Vec3x8::new(red, green, blue), before));

        let length = clear.fast_min(f32x8::splat(FAR));
        let point = direction.mul_add(length, origin);
        let order = lanes::pack_order(bits);
        f32::store_packed(&mut worth.weight, views.len, order, f32x8::ONE);
        for (factor, c) in worth.factor.channels_mut().iter_mut().zip(0..) {
            let in_channel = lanes_of_medium.channel(c);
            f32::store_packed(factor, views.len, order, exp(-in_channel.optical_depth(origin, point, length)));
        }
        let (lane, emitter) = (lanes::indices(b), u32x8::splat(0));
        views.push_batch(bits, CandidateBatch { lane, emitter, start: origin, arriving: Vec3x8::ZERO, point });
    }
    for row in 0..hits.len {
        let (hit, lamp) = (hits.row(row), &lights.emitters()[hits.emitter.rows()[row] as usize]);
        let lane = hit.lane as usize;
        if is_lamp(lamp) && hit.distance <= flight.rows()[lane] {
            let (origin, direction) = (vertex.position.row(lane), ray.direction.row(lane));
            features.normal.set_row(lane, lamp_normal(lamp, origin, direction, hit.distance));
        }
    }
    for hit in (0..surface_hits.len).map(|row| surface_hits.row(row)) {
        let lane = hit.lane as usize;
        if hit.distance <= flight.rows()[lane] {
            let (normal, albedo) = appearance(surfaces, hit, ray.direction.row(lane));
            features.normal.set_row(lane, normal);
            features.albedo.set_row(lane, albedo);
        }
    }
}

/// Overwrites the lanes of a batch that are `new`: paths in the others are on their way.
#[inline(always)]
fn set(column: &mut Column<'_, f32>, b: usize, new: f32x8, value: f32x8) {
    let before = column.batch(b);
    column.set_batch(b, new.select(value, before));
}

/// How far rays go until they meet what is solid.
fn measure(
    features: &mut FeatureColumns<'_>,
    requested: &lanes::LaneSet<'_>,
    lights: &Lights,
    hits: &HitQueue<'_>,
    surface_hits: &SurfaceHitQueue<'_>,
) {
    for (b, bits) in requested.each_batch() {
        set(&mut features.clear, b, lanes::mask(bits), f32x8::splat(f32::INFINITY));
    }
    let clear = features.clear.rows_mut();
    for row in 0..hits.len {
        if is_lamp(&lights.emitters()[hits.emitter.rows()[row] as usize]) {
            clear[hits.lane.rows()[row] as usize] = hits.distance.rows()[row];
        }
    }
    for row in 0..surface_hits.len {
        clear[surface_hits.lane.rows()[row] as usize] = surface_hits.distance.rows()[row];
    }
}

/// Whether an emitter is opaque and black: triangles that shine are surfaces, and nothing ends at infinity.
fn is_lamp(emitter: &Emitter) -> bool {
    matches!(emitter.shape, Shape::Disk | Shape::Sphere)
}

/// The unit normal of a lamp where a ray meets it, on the ray's side.
fn lamp_normal(lamp: &Emitter, origin: [f32; 3], direction: [f32; 3], distance: f32) -> [f32; 3] {
    let from_center = |axis: usize| direction[axis].mul_add(distance, origin[axis] - lamp.origin[axis]);
    let outside = if lamp.shape == Shape::Sphere {
        let vector = [0, 1, 2].map(from_center);
        let length = dot(vector, vector).sqrt();
        vector.map(|component| component / length)
    } else {
        lamp.normal
    };
    if dot(outside, direction) > 0.0 { outside.map(|component| -component) } else { outside }
}

/// Normal and albedo of a surface where a ray in `direction` meets it.
fn appearance(surfaces: &Surfaces, hit: SurfaceHit, direction: [f32; 3]) -> ([f32; 3], [f32; 3]) {
    let SurfaceHit { triangle, distance, second, third, .. } = hit;
    let front = surface::normal(surfaces.geometry().corners(triangle as usize));
    let is_front = dot(front, direction) < 0.0;
    let normal = if is_front { front } else { front.map(|component| -component) };
    if !(is_front || surfaces.material(triangle).double_sided) {
        return (normal, [0.0; 3]);
    }
    (normal, surfaces.albedo(&TriangleHit { triangle, distance, barycentric: [second, third] }))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
