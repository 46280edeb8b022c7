//! Light that media emit along flights, one path after the other, in f64.
//!
//! ```text
//! t = flight, or distance of what ends it
//! C = S / reach(depth + 1) * (sum_{i < n} e(x + (t0 + (i + u_i) / n (t1 - t0)) w) (t1 - t0) / n + e_around (t - (t1 - t0)))
//! S_c = T_c                                  in grey extinction
//! S_c = T_c / posterior_c if c = h, else 0   in coloured one
//! ```

use glam::DVec3;

use super::{Columns, MOST_POINTS};
use crate::connect::sequence::Draws;
use crate::light_hit::reference::ends;
use crate::media::spectral::CHANNELS;
use crate::media::{Field, Glow, Medium};
use crate::mis_weight::reference::reach;
use crate::random::{self, Stream};
use crate::{Step, accumulate};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, glow, lights, lengths, walk, live, paths, vertex, ray, flight, hits, .. } = columns;
    let Columns { surface_hits, throughput, immersion, log_posterior, flown, glowing, .. } = columns;
    let Columns { radiance, origin, parts, dropped, .. } = columns;
    for lane in live.each() {
        let free = f64::from(flight.rows()[lane]);
        let body = (0..hits.len).map(|row| hits.row(row)).find(|hit| {
            let emitter = &lights.emitters()[hit.emitter as usize];
            hit.lane as usize == lane && ends(emitter, free, f64::from(hit.distance))
        });
        let surface = (0..surface_hits.len).map(|row| surface_hits.row(row)).find(|hit| hit.lane as usize == lane);
        let end = body.map(|hit| hit.distance).or(surface.map(|hit| hit.distance));
        flown.rows_mut()[lane] = end.unwrap_or(free as f32);
        let depth = paths.depth_of(step.clock, lane);
        glowing.set_row(lane, [0.0; CHANNELS]);
        if !accumulate::reference::counts(lengths, depth, 0) {
            continue;
        }
        let [from, direction] =
            [vertex.position.row(lane), ray.direction.row(lane)].map(|v| DVec3::from(v.map(f64::from)));
        let met = along(medium, glow, (from, direction), f64::from(flown.rows()[lane]), &Draws::new(step, paths, lane));
        let reached = reach(walk, depth as usize + 1);
        let mut shares = throughput.row(lane).map(f64::from);
        if medium.is_coloured() {
            let hero = immersion.hero.rows()[lane] as usize;
            shares = of_hero(hero, shares, log_posterior.row(lane).map(f64::from));
        }
        let found = [0, 1, 2].map(|c| (met[c] * shares[c] / reached) as f32);
        if found[..radiance.channels().len()].iter().any(|channel| !channel.is_finite()) {
            dropped.note(paths.pixel.rows()[lane], paths.sample.rows()[lane]);
            continue;
        }
        glowing.set_row(lane, found);
        let before = radiance.row(lane);
        radiance.set_row(lane, [0, 1, 2].map(|c| before[c] + found[c]));
        for part in parts.of(origin, depth + 1) {
            let before = part.row(lane);
            part.set_row(lane, [0, 1, 2].map(|c| before[c] + found[c]));
        }
    }
}

/// What light that a flight has passed counts for where extinction is coloured: `T_h / posterior_h` in the channel of the
/// `hero`, whose flight it is, and nothing in the others.
pub fn of_hero(hero: usize, throughput: [f64; CHANNELS], log_posterior: [f64; CHANNELS]) -> [f64; CHANNELS] {
    let mut shares = [0.0; CHANNELS];
    shares[hero] = throughput[hero] * (-log_posterior[hero]).exp();
    shares
}

/// An estimate of the integral of emission along a ray (origin, unit direction) up to `length`, per channel.
pub fn along(medium: &Medium, glow: &Glow, ray: (DVec3, DVec3), length: f64, draws: &Draws) -> [f64; CHANNELS] {
    let (inside, part) = medium.field().map_or(([0.0; CHANNELS], 0.0), |field| within(field, glow, ray, length, draws));
    let around = glow.around().map(f64::from);
    [0, 1, 2].map(|c| inside[c] + if around[c] > 0.0 { around[c] * (length - part) } else { 0.0 })
}

/// The part of it where there may be any, and how long that is.
fn within(
    field: &Field,
    glow: &Glow,
    (origin, direction): (DVec3, DVec3),
    length: f64,
    draws: &Draws,
) -> ([f64; CHANNELS], f64) {
    let Some((enter, exit)) = glow.part_of_ray(field, origin, direction, length) else { return ([0.0; CHANNELS], 0.0) };
    let points = ((exit - enter) * f64::from(glow.rate())).ceil().clamp(1.0, f64::from(MOST_POINTS));
    let stratum = (exit - enter) / points;
    let block = random::block(draws.depth, random::GLOW);
    let stream = Stream::new(draws.pixel, draws.sample, block, draws.seed, 0);
    let mut sum = [0.0; CHANNELS];
    for i in 0..points as u32 {
        let u = random::uniform(stream.words(i / 4)[i as usize % 4]);
        let at = origin + (enter + (f64::from(i) + u) * stratum) * direction;
        let emission = glow.at_point(field.here(field.cells_of(at)).0, at);
        sum = [0, 1, 2].map(|c| sum[c] + emission[c] * stratum);
    }
    (sum, exit - enter)
}
