//! ```text
//! for each disk: t = ((c - o) . n) / (d . n);  hit if 0 < t < bound and |o + t d - c| <= R
//! keep the nearest
//! ```
//!
//! 1. Eight rays against one disk at a time, so lanes are full whatever the number of disks.
//! 2. A ray in the disk's plane gives t = +-inf or NaN, and every comparison with it fails.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::queues::HitBatch;
use crate::tables::lights::{Disk, Lights};
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(lights: &Lights, step: Step, columns: Columns<'_, '_>) {
    let Columns { paths, vertices, rays, flights, hits } = columns;
    let n = paths.batches();
    let origins = vertices.at(step.clock).position.view(n);
    let directions = rays.at(step.clock).direction.view(n);
    let (birth, flight) = (paths.columns.birth.view(n), flights.flight.view(n));
    for (b, live) in paths.live.each_batch() {
        let (origin, direction) = (origins.at(b), directions.at(b));
        let at_camera = lanes::as_mask(birth[b].simd_eq(u32x8::splat(step.clock)));
        let mut nearest = at_camera.select(f32x8::splat(f32::INFINITY), flight[b]);
        let mut met = u32x8::splat(0);
        let mut any = f32x8::ZERO;
        for (index, disk) in lights.disks().iter().enumerate() {
            let distance = crossing(disk, origin, direction, nearest);
            let hit = distance.simd_lt(nearest);
            nearest = hit.select(distance, nearest);
            met = bytemuck::cast::<f32x8, u32x8>(hit).select(u32x8::splat(index as u32), met);
            any |= hit;
        }
        hits.push_batch(lanes::bits(any) & live, HitBatch { lane: lanes::indices(b), disk: met, distance: nearest });
    }
}

/// Distance to `disk`, or infinity where the ray does not meet it before `bound`.
#[inline(always)]
fn crossing(disk: &Disk, origin: Vec3x8, direction: Vec3x8, bound: f32x8) -> f32x8 {
    let normal = Vec3x8::splat(disk.normal);
    let from_center = origin - Vec3x8::splat(disk.center);
    let distance = -from_center.dot(normal) / direction.dot(normal);
    let across = direction.mul_add(distance, from_center).length_squared();
    let hit = distance.simd_gt(f32x8::ZERO)
        & distance.simd_lt(bound)
        & across.simd_le(f32x8::splat(disk.radius * disk.radius));
    hit.select(distance, f32x8::splat(f32::INFINITY))
}
