//! What the camera sees first, in f64.
//!
//! ```text
//! s = distance of the first surface or lamp, t = free flight
//! s <= t < inf or s < inf = t:  depth = near + s d . axis,   n and albedo of what is there
//! t < s:                        depth = near + t d . axis,   n = 0, albedo of the medium at x + t d
//! t = s = inf:                  no depth, nothing
//! e^{-tau_c(x, x + s d)}:       transmittance
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::paths::Feature;
use crate::columns::queues::{Candidate, SurfaceHit};
use crate::light_hit::reference::transmittance;
use crate::media::Medium;
use crate::surface::reference as surface;
use crate::tables::camera::Camera;
use crate::tables::lights::{Emitter, FAR, Lights, Shape};
use crate::tables::surfaces::Surfaces;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { camera, medium, lights, surfaces, requested, vertex, ray, flight, .. } = columns;
    let Columns { hits, surface_hits, features, views, worth, .. } = columns;
    views.len = 0;
    for lane in requested.each() {
        let start = vertex.position.row(lane);
        let direction = DVec3::from(ray.direction.row(lane).map(f64::from));
        let origin = DVec3::from(start.map(f64::from));
        let lamp = (0..hits.len)
            .map(|row| hits.row(row))
            .find(|hit| hit.lane as usize == lane && is_lamp(&lights.emitters()[hit.emitter as usize]));
        let hit = (0..surface_hits.len).map(|row| surface_hits.row(row)).find(|hit| hit.lane as usize == lane);
        let solid = match (lamp, hit) {
            (_, Some(hit)) => Some(Solid::Surface(hit)),
            (Some(lamp), None) => Some(Solid::Lamp(lamp.emitter as usize, f64::from(lamp.distance))),
            (None, None) => None,
        };
        let scene = Scene { camera, medium, lights, surfaces };
        let seen = first(&scene, (origin, direction), f64::from(flight.rows()[lane]), solid);
        features.set_row(lane, Feature { transmittance: features.transmittance.row(lane), ..seen });
        let end = origin + f64::from(seen.clear.min(FAR)) * direction;
        let through = transmittance(medium, origin, end).map(|through| through.value() as f32);
        worth.weight.rows_mut()[views.len] = 1.0;
        worth.factor.set_row(views.len, through);
        let point = end.as_vec3().to_array();
        views.push(Candidate { lane: lane as u32, emitter: 0, start, arriving: [0.0; 3], point });
    }
}

/// What there is to see.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The medium around everything.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a Lights,
    /// The surfaces.
    pub surfaces: &'a Surfaces,
}

/// What is solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A disk or sphere, by its index among the emitters, at this distance `[m]`.
    Lamp(usize, f64),
    /// A point of a triangle.
    Surface(SurfaceHit),
}

/// Whether an emitter is opaque and black.
fn is_lamp(emitter: &Emitter) -> bool {
    matches!(emitter.shape, Shape::Disk | Shape::Sphere)
}

/// What a ray of the camera (origin, unit direction) with this free `flight` meets first, where `solid` is the first
/// that is solid; transmittance 0.
pub fn first(scene: &Scene<'_>, (origin, direction): (DVec3, DVec3), flight: f64, solid: Option<Solid>) -> Feature {
    let Scene { camera, medium, lights, surfaces } = *scene;
    let clear = match solid {
        None => f64::INFINITY,
        Some(Solid::Lamp(_, distance)) => distance,
        Some(Solid::Surface(hit)) => f64::from(hit.distance),
    };
    let nothing = Feature {
        clear: clear as f32,
        depth: 0.0,
        hit: 0.0,
        normal: [0.0; 3],
        albedo: [0.0; 3],
        transmittance: [0.0; 3],
    };
    let distance = flight.min(clear);
    if distance.is_infinite() {
        return nothing;
    }
    let axis = DVec3::from(camera.forward.map(f64::from));
    let depth = f64::from(camera.near) + distance * direction.dot(axis);
    let (normal, albedo) = match solid.filter(|_| clear <= flight) {
        None => (DVec3::ZERO, medium.albedo_at(origin + distance * direction)),
        Some(Solid::Lamp(emitter, _)) => {
            (lamp_normal(&lights.emitters()[emitter], origin + distance * direction, direction), [0.0; 3])
        }
        Some(Solid::Surface(hit)) => {
            let side = surface::side(surfaces.geometry().corners(hit.triangle as usize), direction);
            let is_black = surface::is_black(surfaces, hit, direction);
            (side, if is_black { [0.0; 3] } else { surface::albedo(surfaces, hit).map(f64::from) })
        }
    };
    let normal = normal.as_vec3().to_array();
    Feature { depth: depth as f32, hit: 1.0, normal, albedo: albedo.map(|albedo| albedo as f32), ..nothing }
}

/// The unit normal of a disk or sphere at a point of it, on the side from which `direction` comes.
fn lamp_normal(lamp: &Emitter, point: DVec3, direction: DVec3) -> DVec3 {
    let outside = match lamp.shape {
        Shape::Sphere => (point - DVec3::from(lamp.origin.map(f64::from))).normalize(),
        _ => DVec3::from(lamp.normal.map(f64::from)),
    };
    if outside.dot(direction) > 0.0 { -outside } else { outside }
}
