//! What flights leave out of other channels, one path after the other, in f64.
//!
//! ```text
//! T_c *= T'_c e^{tau~_c}      for extinctions mu_c - mu_h along the flight
//! ```

use glam::DVec3;

use super::Columns;
use crate::media::field::Field;
use crate::media::spectral::CHANNELS;
use crate::random::{self, Stream};
use crate::transmittance::reference::estimate;
use crate::{Step, connect::sequence::Draws};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { field, live, paths, immersion, flight, surface_hits, vertex, ray, throughput, .. } = columns;
    for lane in live.each() {
        let hit = (0..surface_hits.len).map(|row| surface_hits.row(row)).find(|hit| hit.lane as usize == lane);
        let length = hit.map_or(flight.rows()[lane], |hit| hit.distance);
        let start = DVec3::from(vertex.position.row(lane).map(f64::from));
        let end = start + f64::from(length) * DVec3::from(ray.direction.row(lane).map(f64::from));
        let hero = immersion.hero.rows()[lane] as usize;
        let missing = missing(field, hero, start, end, &Draws::new(step, paths, lane));
        let before = throughput.row(lane);
        throughput.set_row(lane, core::array::from_fn(|c| (f64::from(before[c]) * missing[c]) as f32));
    }
}

/// What the way from `start` to `end`, flown for the `hero`, leaves of light over what is counted, per channel.
pub fn missing(field: &Field, hero: usize, start: DVec3, end: DVec3, draws: &Draws) -> [f64; CHANNELS] {
    let block = random::block(draws.depth, random::TRACKING);
    let stream = Stream::new(draws.pixel, draws.sample, block, draws.seed, 1);
    estimate(field, Some(hero), start, end, stream)
}
