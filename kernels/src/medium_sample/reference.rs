//! Free flights in f64.
//!
//! ```text
//! flight = -ln(1 - u) / mu_t,      density mu_t exp(-mu_t flight) [1/m]
//! ```
//!
//! Before it, a path that has left the camera goes on if its fourth number is below the survival.

use super::Columns;
use crate::columns::LANES;
use crate::columns::queues::Flight;
use crate::tables::media::Medium;
use crate::{Step, Walk, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, walk: &Walk, step: Step, columns: Columns<'_, '_>) {
    let Columns { paths, flights } = columns;
    for lane in 0..paths.batches() * LANES {
        if !paths.live.contains(lane as u32) {
            continue;
        }
        let (pixel, sample) = (paths.columns.pixel.rows()[lane], paths.columns.sample.rows()[lane]);
        let depth = paths.depth(step.clock, lane);
        let [distance, cosine, azimuth, survival] = words(pixel, sample, depth, step.seed);
        if depth > 0 && !survives(walk, random::uniform(survival)) {
            paths.live.remove(lane as u32);
            continue;
        }
        let flight = flight(f64::from(medium.extinction), random::uniform(distance)) as f32;
        flights.set_row(lane, Flight { flight, cosine, azimuth, ..flights.row(lane) });
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
    use crate::columns::paths::PathTable;
    use crate::columns::queues::FlightTable;
    use crate::phase::HenyeyGreenstein;
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
        let mut paths = PathTable::new_in(&arena, lanes, 1);
        let mut flights = FlightTable::new_in(&arena, lanes);
        // A third each at the camera, at a surface and in the medium.
        for lane in 0..lanes {
            let depth = [0, 4, 4][lane % 3];
            paths.columns.pixel.rows_mut()[lane] = lane as u32;
            paths.columns.birth.rows_mut()[lane] = 50 - depth;
            paths.columns.last_surface.rows_mut()[lane] = [0, 4, 3][lane % 3];
            paths.live.insert(lane as u32);
        }
        let medium = Medium { extinction: 2.0, albedo: [1.0; 3], phase: HenyeyGreenstein { g: 0.0 } };
        let walk = Walk { segments: 9, starts: 1, survival: 0.75 };
        let columns = Columns { paths: &mut paths, flights: &mut flights };
        run(&medium, &walk, Step { seed: 5, clock: 50 }, columns);
        let mut alive = [0; 3];
        for lane in 0..lanes {
            let lives = paths.live.contains(lane as u32);
            alive[lane % 3] += u32::from(lives);
            assert_eq!(flights.flight.rows()[lane] > 0.0, lives, "lane {lane}");
        }
        // Five standard deviations of a binomial count of 2666.
        let thinned = alive[1..].iter().all(|alive: &u32| alive.abs_diff(2000) < 112);
        assert!(alive[0] == 2667 && thinned, "{alive:?}");
    }
}
