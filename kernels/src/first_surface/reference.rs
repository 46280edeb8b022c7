//! First flights that end on a surface, in f64.
//!
//! ```text
//! P(t > d) = (1 - share) e^{-c mu_t d} + share sum_l share_l atan2(D, d - delta) / span
//! weight = e^{-mu_t d} / P(t > d)
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::first_flight::Aim;
use crate::first_flight::reference::mixed_probability;
use crate::media::reference;
use crate::tables::lights::Lights;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, aim, requested, surface_hits, vertex, ray, .. } = columns;
    let Columns { weight: weights, density: densities, .. } = columns;
    let hits = (0..surface_hits.len).map(|row| surface_hits.row(row));
    for hit in hits.filter(|hit| requested.contains(hit.lane as usize)) {
        let lane = hit.lane as usize;
        let sight = (vertex.position.row(lane), ray.direction.row(lane));
        let sight = (DVec3::from(sight.0.map(f64::from)), DVec3::from(sight.1.map(f64::from)));
        let distance = f64::from(hit.distance);
        let in_channel = |channel: usize| medium.homogeneous_twin(channel);
        if medium.is_coloured() {
            let mixed = [0, 1, 2].map(|c| mixed_probability(&in_channel(c), lights, aim, sight, distance) as f32);
            densities.set_row(lane, mixed);
        } else {
            weights.rows_mut()[lane] = weight(&in_channel(0), lights, aim, sight, distance) as f32;
        }
    }
}

/// The probability that a free flight goes farther than `t` over that of the mixture, [0, 1 / (1 - share)].
pub fn weight(medium: &dyn reference::Medium, lights: &Lights, aim: Aim, sight: (DVec3, DVec3), t: f64) -> f64 {
    let free = (-medium.optical_depth(sight.0, sight.0 + t * sight.1)).exp();
    free / mixed_probability(medium, lights, aim, sight, t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::first_flight::reference as first_flight;
    use crate::first_flight::reference::tests::{cells, lights};
    use crate::media::reference::Homogeneous;

    /// Rays that pass the lights, and one that leaves both behind.
    fn sights() -> [(DVec3, DVec3); 3] {
        let side = DVec3::new(0.3, -0.1, 1.0).normalize();
        [(DVec3::ZERO, DVec3::Z), (DVec3::ZERO, side), (DVec3::new(0.1, 0.2, 12.0), DVec3::Z)]
    }

    #[test]
    fn as_many_flights_get_farther_as_the_mixture_says() {
        let (lights, extinction, aim) = (lights(), 0.2_f64, Aim { share: 0.5, thinned: 0.8 });
        let medium = Homogeneous::isotropic(extinction);
        for sight in sights() {
            for wall in [0.5, 3.0, 20.0] {
                let gets_there = |u: f64, v: f64| {
                    first_flight::flight(&lights, aim, sight.0, sight.1, medium.flight(v), [u, v]) > wall
                };
                let there = cells(40).map(|u| cells(5000).filter(|v| gets_there(u, *v)).count()).sum::<usize>();
                let found = there as f64 / 200_000.0;
                let expected = mixed_probability(&medium, &lights, aim, sight, wall);
                assert!((found - expected).abs() < 2e-4, "{found} of all flights beyond {wall}, expected {expected}");
            }
        }
    }

    /// In the mean, a first vertex in front of a wall and one on it count as much as they do without aim.
    #[test]
    fn weights_average_to_free_flights_on_either_side_of_a_wall() {
        let lights = lights();
        for sight in sights() {
            for (extinction, share, wall) in [(0.05, 0.5, 4.0), (1.0, 0.5, 2.0), (1.0, 0.05, 3.5), (4.0, 0.8, 0.3)] {
                let (medium, aim) = (Homogeneous::isotropic(extinction), Aim::in_the_open(share));
                let (mut before, mut on) = (0.0, 0.0);
                for (u, v) in cells(80).flat_map(|u| cells(2500).map(move |v| (u, v))) {
                    let t = first_flight::flight(&lights, aim, sight.0, sight.1, medium.flight(v), [u, v]);
                    if t < wall {
                        before += first_flight::weight(&medium, &lights, aim, sight, t) / 200_000.0;
                    } else {
                        on += weight(&medium, &lights, aim, sight, wall) / 200_000.0;
                    }
                }
                let expected = (-extinction * wall).exp();
                assert!((on - expected).abs() < 1e-3, "{on} on the wall, expected {expected}");
                assert!((before - (1.0 - expected)).abs() < 1e-3, "{before} before it, expected {}", 1.0 - expected);
            }
        }
    }

    #[test]
    fn weights_are_bounded_by_the_share_of_flights_that_are_not_aimed() {
        for sight in sights() {
            for (extinction, share) in [(1e-3, 0.1), (0.3, 0.5), (50.0, 0.99)] {
                for t in [1e-6, 0.1, 3.0, 40.0, 1e4] {
                    let weight =
                        weight(&Homogeneous::isotropic(extinction), &lights(), Aim::in_the_open(share), sight, t);
                    let bound = (1.0 + 1e-12) / (1.0 - f64::from(share));
                    assert!((0.0..=bound).contains(&weight), "{weight} at {t}, share {share}");
                }
            }
        }
    }
}
