//! Rays that met a disk, in f64.
//!
//! ```text
//! front:  d . n < 0
//! view:   exp(-mu_t t), the expectation of the event that the flight gets as far as t
//! end:    t <= flight
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::queues::Candidate;
use crate::mis_weight::reference::profile;
use crate::tables::lights::{Disk, Lights};
use crate::tables::media::Medium;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, lights: &Lights, step: Step, columns: Columns<'_, '_>) {
    let Columns { hits, vertices, rays, flights, paths, views, light_hits } = columns;
    for row in 0..hits.len {
        let hit = hits.row(row);
        let lane = hit.lane as usize;
        let start = vertices.at(step.clock).position.row(lane);
        let direction = DVec3::from(rays.at(step.clock).direction.row(lane).map(f64::from));
        let distance = f64::from(hit.distance);
        if shows_front(&lights.disks()[hit.disk as usize], direction) {
            let point = DVec3::from(start.map(f64::from)) + distance * direction;
            let candidate = Candidate {
                lane: hit.lane,
                light: hit.disk,
                start,
                arriving: [0.0; 3],
                point: point.as_vec3().to_array(),
                weight: 0.0,
            };
            if paths.depth(step.clock, lane) == 0 {
                let profile = profile(&lights.disks()[hit.disk as usize], direction);
                let weight = (profile * transmittance(f64::from(medium.extinction), distance)) as f32;
                views.push(Candidate { weight, ..candidate });
            } else {
                let arriving = rays.at(step.clock - 1).direction.row(lane);
                light_hits.push(Candidate { arriving, ..candidate });
            }
        }
        if ends(f64::from(flights.flight.rows()[lane]), distance) {
            paths.live.remove(hit.lane);
        }
    }
}

/// Whether a ray in `direction` arrives at the side of the disk that emits.
pub fn shows_front(disk: &Disk, direction: DVec3) -> bool {
    direction.dot(DVec3::from(disk.normal.map(f64::from))) < 0.0
}

/// The share of light that a way of length `distance` `[m]` leaves.
pub fn transmittance(extinction: f64, distance: f64) -> f64 {
    (-extinction * distance).exp()
}

/// Whether the flight gets as far as the disk.
pub fn ends(flight: f64, distance: f64) -> bool {
    distance <= flight
}
