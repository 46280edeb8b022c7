//! Scattering events in f64.
//!
//! ```text
//! x' = x + flight d,      d' = d turned by c(u_1) at azimuth 2 pi u_2,      T' = T albedo
//! ```
//!
//! The turn is drawn from the phase function itself, so `f / p` is the albedo.

use glam::DVec3;

use super::Columns;
use crate::media::Medium;
use crate::phase::reference::turn;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, live, on_surface, paths, flights, vertex, next, ray, next_ray, throughput } = columns;
    for lane in live.without(on_surface) {
        let flight = flights.row(lane);
        let event = scatter(
            medium,
            DVec3::from(vertex.position.row(lane).map(f64::from)),
            DVec3::from(ray.direction.row(lane).map(f64::from)),
            f64::from(flight.flight),
            [flight.cosine, flight.azimuth].map(random::uniform),
        );
        next.position.set_row(lane, event.position.as_vec3().to_array());
        next_ray.direction.set_row(lane, event.direction.as_vec3().to_array());
        let leaves_camera = paths.depth_of(step.clock, lane) == 0;
        let arc = if leaves_camera { 0.0 } else { f64::from(vertex.arc.rows()[lane]) + f64::from(flight.flight) };
        next.arc.rows_mut()[lane] = arc as f32;
        for (channel, albedo) in throughput.channels_mut().iter_mut().zip(medium.albedo_at(event.position)) {
            let throughput = &mut channel.rows_mut()[lane];
            *throughput = (f64::from(*throughput) * albedo) as f32;
        }
    }
}

/// A vertex in the medium, and how the path leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Where it is `[m]`.
    pub position: DVec3,
    /// Unit direction in which the path goes on.
    pub direction: DVec3,
}

/// The event at the end of `flight` from `origin` in `direction`; `u` decides on cosine and azimuth.
pub fn scatter(medium: &Medium, origin: DVec3, direction: DVec3, flight: f64, u: [f64; 2]) -> Event {
    let position = origin + flight * direction;
    let cosine = medium.phase_at(position).sample_cosine(u[0]);
    Event { position, direction: turn(direction, cosine, u[1]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::PhaseFunction;

    #[test]
    fn the_mean_of_the_next_direction_is_g_times_the_old_one() {
        let direction = DVec3::new(0.3, -0.4, 0.5).normalize();
        for g in [-0.5, 0.0, 0.85] {
            let medium = Medium::homogeneous(1.0, [1.0; 3], PhaseFunction::henyey_greenstein(g));
            let mut mean = DVec3::ZERO;
            for (i, j) in (0..1000).flat_map(|i| (0..8).map(move |j| (i, j))) {
                let u = [(f64::from(i) + 0.5) / 1000.0, (f64::from(j) + 0.5) / 8.0];
                mean += scatter(&medium, DVec3::ZERO, direction, 1.0, u).direction / 8000.0;
            }
            assert!((mean - medium.phase.mean_cosine() * direction).length() < 1e-5, "{mean}");
        }
    }
}
