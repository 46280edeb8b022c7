//! Rays that met a light, in f64.
//!
//! ```text
//! front:  -d . n > 0, at the point that is met
//! view:   exp(-mu_t t), the expectation of the event that the flight gets as far as t
//! end:    t <= flight, on a disk or sphere; what happens on a surface is its own matter
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::queues::Candidate;
use crate::connect::light_sample::reference::cosine;
use crate::mis_weight::reference::profile;
use crate::tables::lights::{Emitter, Lights, Shape};
use crate::tables::media::Medium;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, step: Step, columns: Columns<'_, '_>) {
    let Columns { hits, vertices, rays, flights, paths, views, light_hits } = columns;
    for row in 0..hits.len {
        let hit = hits.row(row);
        let (lane, emitter) = (hit.lane as usize, &lights.emitters()[hit.emitter as usize]);
        let start = vertices.at(step.clock).position.row(lane);
        let direction = DVec3::from(rays.at(step.clock).direction.row(lane).map(f64::from));
        let distance = f64::from(hit.distance);
        let point = DVec3::from(start.map(f64::from)) + distance * direction;
        if cosine(emitter, point, direction) > 0.0 {
            let candidate = Candidate {
                lane: hit.lane,
                emitter: hit.emitter,
                start,
                arriving: [0.0; 3],
                point: point.as_vec3().to_array(),
                weight: 0.0,
            };
            if paths.depth(step.clock, lane) == 0 {
                let profile = profile(emitter, point, direction);
                let weight = (profile * transmittance(f64::from(medium.extinction), distance)) as f32;
                views.push(Candidate { weight, ..candidate });
            } else {
                let arriving = rays.at(step.clock - 1).direction.row(lane);
                light_hits.push(Candidate { arriving, ..candidate });
            }
        }
        if ends(emitter, f64::from(flights.flight.rows()[lane]), distance) {
            paths.live.remove(hit.lane);
        }
    }
}

/// The share of light that a way of length `distance` `[m]` leaves.
pub fn transmittance(extinction: f64, distance: f64) -> f64 {
    (-extinction * distance).exp()
}

/// Whether the flight ends on an emitter at this distance, which is black where it is not part of a surface.
pub fn ends(emitter: &Emitter, flight: f64, distance: f64) -> bool {
    emitter.shape != Shape::Triangle && distance <= flight
}
