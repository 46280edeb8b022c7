//! What flights say of their channels, one path after the other, in f64.
//!
//! ```text
//! P = sum_c posterior_c p_c,      posterior_c' = posterior_c p_c / P,      T_k' = T_k f_k / P
//! ```

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::connect::density::Density;
use crate::media::Medium;
use crate::media::reference::Medium as _;
use crate::media::spectral::CHANNELS;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { medium, live, on_surface, aimed, density, flight, surface_hits, vertex, ray, .. } = columns;
    let Columns { log_posterior, throughput, .. } = columns;
    let mut weigh = |lane: usize, surface: Option<f32>| {
        let own = aimed.is_some_and(|aimed| aimed.contains(lane));
        let length = if own { None } else { surface }.unwrap_or(flight.rows()[lane]);
        let start = DVec3::from(vertex.position.row(lane).map(f64::from));
        let end = start + f64::from(length) * DVec3::from(ray.direction.row(lane).map(f64::from));
        let free = free_flights(medium, start, end, own || surface.is_none());
        let drawn = if own { density.row(lane).map(|density| Density::new(f64::from(density))) } else { free };
        let before = log_posterior.row(lane).map(f64::from);
        let (after, quotients) = update(before, drawn, free);
        let before = throughput.row(lane).map(f64::from);
        log_posterior.set_row(lane, after.map(|channel| channel as f32));
        throughput.set_row(lane, core::array::from_fn(|channel| (before[channel] * quotients[channel]) as f32));
    };
    live.without(on_surface).for_each(|lane| weigh(lane, None));
    for hit in (0..surface_hits.len).map(|row| surface_hits.row(row)) {
        weigh(hit.lane as usize, Some(hit.distance));
    }
}

/// f_c: the densities of free flights from `start` to `end`, or the probabilities that they go farther.
pub fn free_flights(medium: &Medium, start: DVec3, end: DVec3, scatters: bool) -> [Density; CHANNELS] {
    core::array::from_fn(|channel| {
        let medium = medium.twin(channel);
        let event = if scatters { medium.extinction(end) } else { 1.0 };
        Density::new(event).times_exp(-medium.optical_depth(start, end))
    })
}

/// ln posterior_c after a flight, and what throughputs take, f_k / P; `before` is ln posterior_c before.
pub fn update(
    before: [f64; CHANNELS],
    drawn: [Density; CHANNELS],
    free: [Density; CHANNELS],
) -> ([f64; CHANNELS], [f64; CHANNELS]) {
    let joint: [Density; CHANNELS] = core::array::from_fn(|channel| drawn[channel].times_exp(before[channel]));
    let largest = joint.into_iter().reduce(|a, b| if b.over(a) > 1.0 { b } else { a }).expect("there are channels");
    let sum = largest.times(joint.iter().map(|term| term.over(largest)).sum());
    (joint.map(|term| term.ln() - sum.ln()), free.map(|free| free.over(sum)))
}
