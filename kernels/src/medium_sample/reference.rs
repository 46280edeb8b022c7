//! Free flights in f64.
//!
//! ```text
//! flight = -ln(1 - u) / mu_t,      density mu_t exp(-mu_t flight) [1/m]
//! ```
//!
//! Before it, a path that has left the camera goes on if its fourth number is below the survival.

use super::Columns;
use crate::columns::queues::Flight;
use crate::{Step, Walk, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, walk, live, paths, flights } = columns;
    let lanes: Vec<usize> = live.each().collect();
    for lane in lanes {
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let depth = paths.depth_of(step.clock, lane);
        let [distance, cosine, azimuth, survival] = words(pixel, sample, depth, step.seed);
        if depth > 0 && !survives(walk, random::uniform(survival)) {
            live.remove(lane);
            continue;
        }
        let flight = flight(f64::from(medium.extinction), random::uniform(distance)) as f32;
        flights.set_row(lane, Flight { flight, cosine, azimuth });
    }
}

/// The random words of the segment that leaves the vertex at `depth`: flight, cosine, azimuth, survival.
pub fn words(pixel: u32, sample: u32, depth: u32, seed: u32) -> [u32; 4] {
    random::words(pixel, sample, random::block(depth, random::SEGMENT), seed)
}

/// Whether a walk goes on from a vertex whose number is `u`.
pub fn survives(walk: &Walk, u: f64) -> bool {
    u < f64::from(walk.survival)
}

/// The distance that a share `u` of all flights does not reach `[m]`; endless in vacuum.
pub fn flight(extinction: f64, u: f64) -> f64 {
    if extinction == 0.0 {
        return f64::INFINITY;
    }
    -(1.0 - u).ln() / extinction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::paths::{Path, PathColumns};
    use crate::columns::queues::FlightTable;
    use crate::lanes::LaneSet;
    use crate::phase::PhaseFunction;
    use crate::tables::media::Medium;
    use bumpalo::Bump;

    #[test]
    fn a_share_u_of_the_flights_is_shorter_than_the_flight_of_u() {
        for extinction in [0.01, 1.0, 40.0] {
            for u in [1e-7, 0.3, 0.999] {
                let share = -(-extinction * flight(extinction, u)).exp_m1();
                assert!((share - u).abs() < 1e-12 * (1.0 + u), "{share} at {u}");
            }
        }
        assert_eq!(flight(0.0, 0.5), f64::INFINITY);
    }

    #[test]
    fn all_vertices_but_the_camera_end_paths_as_often_as_they_should() {
        let arena = Bump::new();
        let lanes = 8000;
        let mut paths = PathColumns::new_in(&arena, lanes);
        let mut live = LaneSet::new_in(&arena, lanes);
        let mut flights = FlightTable::new_in(&arena, lanes);
        // A third each at the camera, after one segment and after four.
        for lane in 0..lanes {
            let depth = [0, 1, 4][lane % 3];
            paths.set_row(lane, Path { pixel: lane as u32, sample: 0, birth: 50 - depth });
            live.insert(lane);
        }
        let medium = Medium { extinction: 2.0, albedo: [1.0; 3], phase: PhaseFunction::henyey_greenstein(0.0) };
        let walk = Walk { segments: 9, starts: 1, survival: 0.75 };
        let columns = Columns { medium: &medium, walk: &walk, live: &mut live, paths: &paths, flights: &mut flights };
        run(Step { seed: 5, clock: 50 }, columns);
        let mut alive = [0; 3];
        for lane in 0..lanes {
            let lives = live.contains(lane);
            alive[lane % 3] += u32::from(lives);
            assert_eq!(flights.flight.rows()[lane] > 0.0, lives, "lane {lane}");
        }
        // Five standard deviations of a binomial count of 2666.
        let thinned = alive[1..].iter().all(|alive: &u32| alive.abs_diff(2000) < 112);
        assert!(alive[0] == 2667 && thinned, "{alive:?}");
    }
}
