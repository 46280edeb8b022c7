//! Next event estimation with exact weights through null vertices: the other way to weigh paths in media whose
//! transmittance nobody knows (Miller, Georgiev, Jarosz, A null-scattering path integral formulation of light transport,
//! SIGGRAPH 2019), in f64 and with a majorant that is the same everywhere.
//!
//! ```text
//! along a segment, at the rate of the majorant m:   nulls = prod (1 - mu(x_k) / m)
//! a connection counts   T Le  p nulls / (p_light + p nulls),      a light that was met   T Le  p nulls / (p_light + p nulls)
//! ```
//!
//! with the density p of the direction at the vertex before and p_light of the same direction by a point on the light,
//! both per solid angle: a connection takes every candidate for a null vertex, of which a walk leaves out 1 - nulls.
//!
//! It is written from these formulas alone and shares geometry with the twins, but nothing that weighs or tracks.

use core::f64::consts::{PI, TAU};

use fogbow::frame::Frame;
use fogbow_kernels::media::field::Field;
use fogbow_kernels::surface::reference as surface;
use fogbow_kernels::tables::lights::{Emitter, Shape};
use fogbow_kernels::{extend, generate, occlusion};
use glam::DVec3;

use crate::random::Random;

/// The channel that is looked at.
const GREEN: usize = 1;

/// A frame with a field in vacuum and one disk as light, and the random numbers of one sample.
struct Walk<'a> {
    frame: &'a Frame,
    field: &'a Field,
    light: &'a Emitter,
    random: Random,
}

/// Where a path has come to, and how it leaves.
enum Vertex {
    Camera,
    /// In the medium, on the way in this direction.
    Medium(DVec3),
    /// On a surface with this normal.
    Surface(DVec3),
}

/// The value of one sample of a pixel in the green channel [W/(m^2 sr)].
///
/// # Panics
/// If `frame` has no field, or another light than one disk.
pub fn radiance(frame: &Frame, pixel: u32, sample: u32, random: Random) -> f64 {
    let [light] = frame.lights.emitters() else { panic!("one light") };
    assert_eq!(light.shape, Shape::Disk);
    let field = frame.medium.field().expect("a field");
    let (origin, direction) = generate::reference::camera_ray(&frame.camera, pixel, sample, frame.seed);
    Walk { frame, field, light, random }.follow(origin, direction)
}

impl Walk<'_> {
    fn follow(&mut self, mut position: DVec3, mut direction: DVec3) -> f64 {
        let (mut vertex, mut throughput, mut found) = (Vertex::Camera, 1.0, 0.0);
        for segment in 1..=self.frame.lengths.max {
            let frame = self.frame;
            let (lights, surfaces, open) = (&frame.lights, &frame.surfaces, f64::INFINITY);
            let met = extend::reference::meet(lights, surfaces, position, direction, open, open);
            let seen = met.lights.first().map(|(_, distance)| *distance);
            let end = seen.or(met.surface.map(|hit| f64::from(hit.distance))).unwrap_or(f64::INFINITY);
            let (flown, nulls) = self.fly(position, direction, end);
            let cosine = -direction.dot(DVec3::from(self.light.normal.map(f64::from)));
            let at = position + flown * direction;
            match (flown < end, seen, met.surface) {
                (true, ..) => {
                    throughput *= frame.medium.albedo_at(at)[GREEN];
                    (position, vertex) = (at, Vertex::Medium(direction));
                }
                (false, Some(distance), _) => {
                    let scattered = self.density(&vertex, direction) * nulls;
                    let drawn = distance * distance / (cosine * self.area());
                    let weight = if segment == 1 { 1.0 } else { scattered / (scattered + drawn) };
                    let counts = cosine > 0.0 && segment >= frame.lengths.min;
                    return if counts { found + throughput * self.emitted() * weight } else { found };
                }
                (false, None, Some(hit)) => {
                    if surface::is_black(surfaces, hit, direction) {
                        return found;
                    }
                    let triangle = surfaces.geometry().corners(hit.triangle as usize);
                    let (normal, weights) =
                        (surface::side(triangle, direction), [hit.second, hit.third].map(f64::from));
                    throughput *= f64::from(surface::albedo(surfaces, hit)[GREEN]);
                    let clearance = surface::clearance(triangle, weights, normal);
                    (position, vertex) =
                        (surface::point(triangle, weights) + clearance * normal, Vertex::Surface(normal));
                }
                (false, None, None) => return found,
            }
            if (frame.lengths.min..frame.lengths.max + 1).contains(&(segment + 1)) {
                found += throughput * self.connect(position, &vertex);
            }
            direction = self.leave(&vertex);
        }
        found
    }

    fn uniform(&mut self) -> f64 {
        ((self.random.next() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    fn area(&self) -> f64 {
        PI * f64::from(self.light.radius).powi(2)
    }

    fn emitted(&self) -> f64 {
        f64::from(self.light.radiance[GREEN])
    }

    /// How far a flight gets before `end`, and the null vertices on its way.
    fn fly(&mut self, position: DVec3, direction: DVec3, end: f64) -> (f64, f64) {
        let majorant = f64::from(self.field.blocks().most);
        let (mut flown, mut nulls) = (0.0, 1.0);
        loop {
            let Some(next) = self.step(position, direction, flown, end, majorant) else { return (end, nulls) };
            let share = self.share(position + next * direction, majorant);
            if self.uniform() < share {
                return (next, nulls);
            }
            (flown, nulls) = (next, nulls * (1.0 - share));
        }
    }

    /// The next candidate, if there is one before `end`; none lies beyond all volumes.
    fn step(&mut self, position: DVec3, direction: DVec3, flown: f64, end: f64, majorant: f64) -> Option<f64> {
        let cells = |at: DVec3| self.field.cells_of(at);
        let way = self.field.cells_along(direction);
        let (enter, exit) = self.field.part_within(cells(position), way, [0.0; 2], end.min(1e9))?;
        let next = flown.max(enter) - (1.0 - self.uniform()).ln() / majorant;
        (next < exit).then_some(next)
    }

    /// Extinction over the majorant.
    fn share(&self, at: DVec3, majorant: f64) -> f64 {
        self.field.extinction_at(self.field.cells_of(at)) / majorant
    }

    /// Density of a direction in which a path leaves [1/sr].
    fn density(&self, vertex: &Vertex, direction: DVec3) -> f64 {
        match vertex {
            Vertex::Camera => 0.0,
            Vertex::Medium(arriving) => self.frame.medium.phase.twin().density(arriving.dot(direction)),
            Vertex::Surface(normal) => normal.dot(direction).max(0.0) / PI,
        }
    }

    /// A direction of that density.
    fn leave(&mut self, vertex: &Vertex) -> DVec3 {
        let u = [self.uniform(), self.uniform()];
        match vertex {
            Vertex::Camera => unreachable!("paths leave the camera once"),
            Vertex::Medium(arriving) => {
                let cosine = self.frame.medium.phase.twin().sample_cosine(u[0]);
                fogbow_kernels::phase::reference::turn(*arriving, cosine, u[1])
            }
            Vertex::Surface(normal) => surface::reflect(*normal, u),
        }
    }

    /// What a connection with a point on the light counts.
    fn connect(&mut self, position: DVec3, vertex: &Vertex) -> f64 {
        let (u, v) = (self.uniform().sqrt() * f64::from(self.light.radius), self.uniform() * TAU);
        let [center, x, y, normal] =
            [self.light.origin, self.light.tangent, self.light.bitangent, self.light.normal].map(|v| v.map(f64::from));
        let point = DVec3::from(center) + u * (v.cos() * DVec3::from(x) + v.sin() * DVec3::from(y));
        let distance = position.distance(point);
        let direction = (point - position) / distance;
        let cosine = -direction.dot(DVec3::from(normal));
        let chain = [position, point];
        let (lights, surfaces) = (&self.frame.lights, &self.frame.surfaces);
        let blocked = |walk: &Self| {
            cosine <= 0.0
                || walk.density(vertex, direction) == 0.0
                || occlusion::reference::is_occluded(lights, 0, &chain)
                || occlusion::reference::is_hidden(lights, surfaces, 0, &chain)
        };
        if blocked(self) {
            return 0.0;
        }
        let majorant = f64::from(self.field.blocks().most);
        let (mut flown, mut nulls) = (0.0, 1.0);
        while let Some(next) = self.step(position, direction, flown, distance, majorant) {
            nulls *= 1.0 - self.share(position + next * direction, majorant);
            flown = next;
        }
        let (scattered, drawn) =
            (self.density(vertex, direction) * nulls, distance * distance / (cosine * self.area()));
        self.emitted() * scattered / (scattered + drawn)
    }
}
