//! Ray against disk in f64.
//!
//! The ray `x + t d` meets the plane through `c` with normal `n` at
//!
//! ```text
//! t = (c - x) . n / (d . n)
//! ```
//!
//! and the disk of radius R if there `|x + t d - c| <= R`.

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::LANES;
use crate::columns::queues::{Hit, SurfaceHit};
use crate::tables::lights::{Disk, Lights};
use crate::tables::surfaces::Surfaces;
use crate::trace::{self, Ray};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(lights: &Lights, surfaces: &Surfaces, step: Step, columns: Columns<'_, '_>) {
    let Columns { paths, vertices, rays, flights, hits, surface_hits } = columns;
    paths.on_surface.clear();
    let (vertices, rays) = (vertices.at(step.clock), rays.at(step.clock));
    for lane in 0..paths.batches() * LANES {
        if !paths.live.contains(lane as u32) {
            continue;
        }
        let origin = DVec3::from(vertices.position.row(lane).map(f64::from));
        let direction = DVec3::from(rays.direction.row(lane).map(f64::from));
        let leaves_camera = paths.depth(step.clock, lane) == 0;
        let flight = f64::from(flights.flight.rows()[lane]);
        let bound = if leaves_camera { f64::INFINITY } else { flight };
        let (disk, surface) = meet_first(lights, surfaces, origin, direction, bound, flight);
        if let Some((disk, distance)) = disk {
            hits.push(Hit { lane: lane as u32, disk: disk as u32, distance: distance as f32 });
        }
        if let Some(hit) = surface {
            paths.on_surface.insert(lane as u32);
            surface_hits.push(SurfaceHit { lane: lane as u32, ..hit });
        }
    }
}

/// What a ray meets: the disk that it sees within `bound`, unless a surface is in front of it, and the surface on which it
/// ends, unless `flight` or a disk ends it before. The surface's lane is left open.
pub fn meet_first(
    lights: &Lights,
    surfaces: &Surfaces,
    origin: DVec3,
    direction: DVec3,
    bound: f64,
    flight: f64,
) -> (Option<(usize, f64)>, Option<SurfaceHit>) {
    let disk = closest(lights, origin, direction, bound);
    let [origin, direction] = [origin, direction].map(|v| v.as_vec3().to_array());
    let Some(hit) = trace::reference::closest(surfaces.geometry(), &Ray { origin, direction, max: f32::INFINITY })
    else {
        return (disk, None);
    };
    if disk.is_some_and(|(_, distance)| distance <= hit.distance) {
        return (disk, None);
    }
    let [second, third] = hit.barycentric.map(|weight| weight as f32);
    let met = SurfaceHit { lane: 0, triangle: hit.triangle as u32, distance: hit.distance as f32, second, third };
    (None, (hit.distance < flight).then_some(met))
}

/// The first disk that the ray meets before `bound`, and how far away `[m]`.
pub fn closest(lights: &Lights, origin: DVec3, direction: DVec3, bound: f64) -> Option<(usize, f64)> {
    let mut found = None;
    let mut bound = bound;
    for (index, disk) in lights.disks().iter().enumerate() {
        if let Some(distance) = meet(disk, origin, direction)
            && distance < bound
        {
            bound = distance;
            found = Some((index, distance));
        }
    }
    found
}

/// Distance at which the ray meets the disk, front or back `[m]`. None from the disk's plane itself, or along it.
pub fn meet(disk: &Disk, origin: DVec3, direction: DVec3) -> Option<f64> {
    let center = DVec3::from(disk.center.map(f64::from));
    let normal = DVec3::from(disk.normal.map(f64::from));
    let towards = direction.dot(normal);
    let height = (center - origin).dot(normal);
    if towards == 0.0 || height == 0.0 {
        return None;
    }
    let distance = height / towards;
    if distance <= 0.0 || (origin + distance * direction - center).length() > f64::from(disk.radius) {
        return None;
    }
    Some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::lights::Selection;

    #[test]
    fn the_closest_disk_within_the_bound_is_met() {
        let disk = |z: f64| Disk::new(DVec3::new(0.0, 0.0, z), DVec3::Z, 1.0, [1.0; 3]);
        let lights = Lights::new(vec![disk(3.0), disk(2.0), disk(-1.0)], Selection::Uniform);
        let ray = |x: f64, bound: f64| closest(&lights, DVec3::new(x, 0.0, 0.0), DVec3::Z, bound);
        assert_eq!(ray(0.5, f64::INFINITY), Some((1, 2.0)));
        assert_eq!(ray(0.5, 2.0), None);
        assert_eq!(ray(1.5, f64::INFINITY), None);
        assert_eq!(closest(&lights, DVec3::new(0.0, 0.0, 2.0), DVec3::Z, 9.0), Some((0, 1.0)), "starts in a plane");
        assert_eq!(closest(&lights, DVec3::new(-5.0, 0.0, 2.0), DVec3::X, 9.0), None, "runs along a plane");
    }
}
