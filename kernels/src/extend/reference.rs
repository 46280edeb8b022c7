//! Ray against disk and sphere in f64.
//!
//! The ray `x + t d` meets the plane through `c` with normal `n` at
//!
//! ```text
//! t = (c - x) . n / (d . n)
//! ```
//!
//! and the disk of radius R if there `|x + t d - c| <= R`; a sphere where `|x + t d - c| = R`, that is at the roots of
//!
//! ```text
//! t^2 + 2 t (x - c) . d + |x - c|^2 - R^2
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::queues::{Hit, SurfaceHit};
use crate::connect::distant;
use crate::tables::lights::{Emitter, FAR, Lights, Shape};
use crate::tables::surfaces::Surfaces;
use crate::trace::{self, Ray};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, surfaces, live, paths, vertex, ray, flight, on_surface, hits, surface_hits } = columns;
    on_surface.clear();
    for lane in live.each() {
        let origin = DVec3::from(vertex.position.row(lane).map(f64::from));
        let direction = DVec3::from(ray.direction.row(lane).map(f64::from));
        let leaves_camera = paths.depth_of(step.clock, lane) == 0;
        let flight = f64::from(flight.rows()[lane]);
        let bound = if leaves_camera { f64::INFINITY } else { flight };
        let Met { lights, surface } = meet(lights, surfaces, origin, direction, bound, flight);
        for (emitter, distance) in lights {
            hits.push(Hit { lane: lane as u32, emitter: emitter as u32, distance: distance as f32 });
        }
        if let Some(hit) = surface {
            on_surface.insert(lane);
            surface_hits.push(SurfaceHit { lane: lane as u32, ..hit });
        }
    }
}

/// What a ray meets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Met {
    /// Emitters, and how far away they are `[m]`: more than one only at infinity.
    pub lights: Vec<(usize, f64)>,
    /// The surface on which it ends.
    pub surface: Option<SurfaceHit>,
}

/// What a ray meets: the emitter that it sees within `bound`, unless something is in front of it, all those at infinity
/// where there is no bound and nothing else, and the surface on which it ends, unless `flight` or a disk or sphere ends
/// it before. The surface's lane is left open.
pub fn meet(lights: &Lights, surfaces: &Surfaces, origin: DVec3, direction: DVec3, bound: f64, flight: f64) -> Met {
    let body = closest(lights, origin, direction, bound);
    let towards = direction;
    let [origin, direction] = [origin, direction].map(|v| v.as_vec3().to_array());
    let ray = Ray { origin, direction, max: f32::INFINITY };
    let hit = trace::reference::closest(surfaces.geometry(), &ray);
    let hit = hit.filter(|hit| body.is_none_or(|(_, distance)| distance > hit.distance));
    let Some(hit) = hit else {
        let is_open = body.is_none() && bound.is_infinite();
        let distant = distant::reference::met(lights, towards).filter(|_| is_open);
        let distant = distant.map(|emitter| (emitter, f64::from(FAR)));
        return Met { lights: body.into_iter().chain(distant).collect(), surface: None };
    };
    let [second, third] = hit.barycentric.map(|weight| weight as f32);
    let met = SurfaceHit { lane: 0, triangle: hit.triangle as u32, distance: hit.distance as f32, second, third };
    let shining = lights.of_triangle(met.triangle).filter(|_| hit.distance < bound);
    let light = shining.map(|emitter| (emitter as usize, hit.distance));
    Met { lights: light.into_iter().collect(), surface: (hit.distance < flight).then_some(met) }
}

/// The first disk or sphere that the ray meets before `bound`, and how far away `[m]`.
pub fn closest(lights: &Lights, origin: DVec3, direction: DVec3, bound: f64) -> Option<(usize, f64)> {
    let mut found = None;
    let mut bound = bound;
    for (index, body) in lights.bodies().iter().enumerate() {
        if let Some(distance) = meet_body(body, origin, direction)
            && distance < bound
        {
            bound = distance;
            found = Some((index, distance));
        }
    }
    found
}

/// Distance at which the ray meets a disk or sphere, front or back `[m]`. None from a disk's plane itself, or along it.
pub fn meet_body(body: &Emitter, origin: DVec3, direction: DVec3) -> Option<f64> {
    let center = DVec3::from(body.origin.map(f64::from));
    let normal = DVec3::from(body.normal.map(f64::from));
    let radius = f64::from(body.radius);
    if body.shape == Shape::Sphere {
        return meet_sphere(center, radius, origin, direction);
    }
    let towards = direction.dot(normal);
    let height = (center - origin).dot(normal);
    if towards == 0.0 || height == 0.0 {
        return None;
    }
    let distance = height / towards;
    if distance <= 0.0 || (origin + distance * direction - center).length() > radius {
        return None;
    }
    Some(distance)
}

/// Distance at which the ray meets a sphere, from outside or inside `[m]`.
fn meet_sphere(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
    let from_center = origin - center;
    let half = from_center.dot(direction);
    let discriminant = half * half - from_center.length_squared() + radius * radius;
    if discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    [-half - root, -half + root].into_iter().find(|distance| *distance > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::lights::Selection;

    #[test]
    fn the_closest_disk_within_the_bound_is_met() {
        let disk = |z: f64| Emitter::disk(DVec3::new(0.0, 0.0, z), DVec3::Z, 1.0, [1.0; 3]);
        let lights = Lights::new(vec![disk(3.0), disk(2.0), disk(-1.0)], Selection::Uniform);
        let ray = |x: f64, bound: f64| closest(&lights, DVec3::new(x, 0.0, 0.0), DVec3::Z, bound);
        assert_eq!(ray(0.5, f64::INFINITY), Some((1, 2.0)));
        assert_eq!(ray(0.5, 2.0), None);
        assert_eq!(ray(1.5, f64::INFINITY), None);
        assert_eq!(closest(&lights, DVec3::new(0.0, 0.0, 2.0), DVec3::Z, 9.0), Some((0, 1.0)), "starts in a plane");
        assert_eq!(closest(&lights, DVec3::new(-5.0, 0.0, 2.0), DVec3::X, 9.0), None, "runs along a plane");
    }

    #[test]
    fn spheres_are_met_from_outside_and_from_inside() {
        let lights = Lights::new(vec![Emitter::sphere(5.0 * DVec3::Z, 1.0, [1.0; 3])], Selection::Uniform);
        let ray = |z: f64, direction: DVec3| closest(&lights, DVec3::new(0.6, 0.0, z), direction, f64::INFINITY);
        let distance = |found: Option<(usize, f64)>| found.map_or(f64::NAN, |(_, distance)| distance);
        assert!((distance(ray(0.0, DVec3::Z)) - 4.2).abs() < 1e-6);
        assert!((distance(ray(5.0, DVec3::Z)) - 0.8).abs() < 1e-6, "from inside");
        assert_eq!([ray(0.0, DVec3::NEG_Z), ray(9.0, DVec3::Z), ray(0.0, DVec3::X)], [None; 3]);
    }
}
