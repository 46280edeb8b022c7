//! ```text
//! for each disk: t = ((c - o) . n) / (d . n);  hit if 0 < t < bound and |o + t d - c| <= R
//! keep the nearest
//! ```
//!
//! 1. Eight rays against one disk at a time, so lanes are full whatever the number of disks.
//! 2. Triangles are traced one ray at a time, up to the disk or the end of the flight: as far as anything may matter.
//! 3. A ray in the disk's plane gives t = +-inf or NaN, and every comparison with it fails.

use wide::{f32x8, u32x8};

use super::Columns;
use crate::columns::LANES;
use crate::columns::queues::{HitBatch, SurfaceHit, SurfaceHitQueue};
use crate::tables::lights::{Disk, Lights};
use crate::tables::surfaces::Surfaces;
use crate::trace::{self, Ray};
use crate::vec3x8::Vec3x8;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(lights: &Lights, surfaces: &Surfaces, step: Step, columns: Columns<'_, '_>) {
    let Columns { paths, vertices, rays, flights, hits, surface_hits } = columns;
    paths.on_surface.clear();
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
        let mut met_any = lanes::bits(any) & live;
        if !surfaces.is_empty() {
            let disks = any.select(nearest, f32x8::splat(f32::INFINITY));
            let beams = Beams { b, origin, direction, flight: flight[b], disks, at_camera: lanes::bits(at_camera) };
            let (hidden, on_surface) = beams.trace(surfaces, live, surface_hits);
            met_any &= !hidden;
            paths.on_surface.insert_batch(b, on_surface);
        }
        hits.push_batch(met_any, HitBatch { lane: lanes::indices(b), disk: met, distance: nearest });
    }
}

/// Eight rays, and what is known of them before any triangle is.
struct Beams {
    b: usize,
    origin: Vec3x8,
    direction: Vec3x8,
    flight: f32x8,
    /// Distance of the disk that each meets, infinite where there is none.
    disks: f32x8,
    /// Rays that leave the camera.
    at_camera: u32,
}

impl Beams {
    /// Lists the surfaces at which flights end; gives the rays whose disk is hidden, and those that end on a surface.
    #[inline(always)]
    fn trace(&self, surfaces: &Surfaces, live: u32, found: &mut SurfaceHitQueue<'_>) -> (u32, u32) {
        let ([x, y, z], [dx, dy, dz]) = (self.origin.to_arrays(), self.direction.to_arrays());
        let (flight, disks) = (self.flight.to_array(), self.disks.to_array());
        let (mut hidden, mut on_surface) = (0, 0);
        for i in lanes::each(live) {
            // The camera sees a disk at any distance, so what may hide it counts as far.
            let sees_disk = self.at_camera >> i & 1 == 1 && disks[i].is_finite();
            let max = if sees_disk { disks[i] } else { flight[i].min(disks[i]) };
            let ray = Ray { origin: [x[i], y[i], z[i]], direction: [dx[i], dy[i], dz[i]], max };
            let Some(hit) = trace::closest(surfaces.geometry(), &ray) else { continue };
            hidden |= 1 << i;
            if hit.distance < flight[i] {
                on_surface |= 1 << i;
                let (lane, [second, third]) = ((self.b * LANES + i) as u32, hit.barycentric);
                found.push(SurfaceHit { lane, triangle: hit.triangle, distance: hit.distance, second, third });
            }
        }
        (hidden, on_surface)
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
