//! Free flights in f64.
//!
//! ```text
//! flight = -ln(1 - u) / mu_t,      density mu_t exp(-mu_t flight) [1/m]
//! ```

use super::Columns;
use crate::columns::LANES;
use crate::columns::queues::Flight;
use crate::tables::media::Medium;
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(medium: &Medium, step: Step, columns: Columns<'_, '_>) {
    let Columns { paths, flights } = columns;
    for lane in 0..paths.batches() * LANES {
        if !paths.live.contains(lane as u32) {
            continue;
        }
        let (pixel, sample) = (paths.columns.pixel.rows()[lane], paths.columns.sample.rows()[lane]);
        let [distance, cosine, azimuth, _] = words(pixel, sample, paths.depth(step.clock, lane), step.seed);
        let flight = flight(f64::from(medium.extinction), random::uniform(distance)) as f32;
        flights.set_row(lane, Flight { flight, cosine, azimuth });
    }
}

/// The random words of the segment that leaves the vertex at `depth`: flight, cosine, azimuth, unused.
pub fn words(pixel: u32, sample: u32, depth: u32, seed: u32) -> [u32; 4] {
    random::words(pixel, sample, random::block(depth, random::SEGMENT), seed)
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
}
