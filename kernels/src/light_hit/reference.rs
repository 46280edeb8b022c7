//! Rays that met a light, in f64.
//!
//! ```text
//! front:  -d . n > 0, at the point that is met
//! view:   e^{-tau(t)}, the expectation of the event that the flight gets as far as t
//! end:    t <= flight, on a disk or sphere; what happens on a surface is its own matter
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::queues::Candidate;
use crate::connect::density::Density;
use crate::connect::distant;
use crate::emission::reference::{cosine, profile};
use crate::media::Medium;
use crate::media::reference::Medium as _;
use crate::tables::lights::{Emitter, Shape};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, hits, paths, vertex, ray, before, flight, outlined, share, live, .. } = columns;
    let Columns { views, worth, light_hits, .. } = columns;
    for hit in (0..hits.len).map(|row| hits.row(row)) {
        let (lane, emitter) = (hit.lane as usize, &lights.emitters()[hit.emitter as usize]);
        let start = vertex.position.row(lane);
        let direction = DVec3::from(ray.direction.row(lane).map(f64::from));
        let distance = f64::from(hit.distance);
        let point = DVec3::from(start.map(f64::from)) + distance * direction;
        if cosine(emitter, point, direction) > 0.0 {
            let candidate = Candidate {
                lane: hit.lane,
                emitter: hit.emitter,
                start,
                arriving: [0.0; 3],
                point: point.as_vec3().to_array(),
            };
            let at_camera = paths.depth_of(step.clock, lane) == 0;
            if at_camera && !outlined.contains(lane) {
                let profile = profile(emitter, point, direction);
                let arrives = transmittance(medium, DVec3::from(start.map(f64::from)), point);
                let clearest =
                    arrives.into_iter().reduce(|a, b| if b.over(a) > 1.0 { b } else { a }).expect("channels");
                worth.weight.rows_mut()[views.len] = (profile * clearest.value() * f64::from(share)) as f32;
                let colour = distant::reference::colour(lights, hit.emitter as usize, direction);
                let factor = [0, 1, 2].map(|channel| arrives[channel].over(clearest) * colour[channel]);
                worth.factor.set_row(views.len, factor.map(|channel| channel as f32));
                views.push(candidate);
            } else if !at_camera {
                light_hits.push(Candidate { arriving: before.direction.row(lane), ..candidate });
            }
        }
        if ends(emitter, f64::from(flight.rows()[lane]), distance) {
            live.remove(lane);
        }
    }
}

/// The share of light that the way between two points leaves, per channel.
pub fn transmittance(medium: &Medium, from: DVec3, to: DVec3) -> [Density; 3] {
    [0, 1, 2].map(|channel| Density::new(1.0).times_exp(-medium.twin(channel).optical_depth(from, to)))
}

/// Whether the flight ends on an emitter at this distance, which is black where it is not part of a surface.
pub fn ends(emitter: &Emitter, flight: f64, distance: f64) -> bool {
    matches!(emitter.shape, Shape::Disk | Shape::Sphere) && distance <= flight
}
