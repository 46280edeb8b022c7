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
        let length = surface.unwrap_or(flight.rows()[lane]);
        let start = DVec3::from(vertex.position.row(lane).map(f64::from));
        let end = start + f64::from(length) * DVec3::from(ray.direction.row(lane).map(f64::from));
        let free = free_flights(medium, start, end, surface.is_none());
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
        let event = if scatters { medium.event(end) } else { 1.0 };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::PhaseFunction;

    const THIRDS: [f64; CHANNELS] = [1.0 / 3.0; CHANNELS];

    fn medium() -> Medium {
        Medium::coloured([0.2, 1.0, 3.0], [1.0; 3], PhaseFunction::isotropic())
    }

    /// ln posterior_c and f_k / P after a flight of this `length`, before which all heroes were as probable.
    fn after(medium: &Medium, length: f64, scatters: bool) -> ([f64; CHANNELS], [f64; CHANNELS]) {
        let free = free_flights(medium, DVec3::ZERO, length * DVec3::X, scatters);
        update(THIRDS.map(f64::ln), free, free)
    }

    #[test]
    fn where_channels_are_alike_flights_say_nothing() {
        let grey = Medium::homogeneous(0.7, [1.0; 3], PhaseFunction::isotropic());
        for scatters in [true, false] {
            let (posterior, quotients) = after(&grey, 1.3, scatters);
            for channel in 0..CHANNELS {
                assert!((posterior[channel].exp() - 1.0 / 3.0).abs() < 1e-15, "{posterior:?}");
                assert!((quotients[channel] - 1.0).abs() < 1e-15, "{quotients:?}");
            }
        }
    }

    #[test]
    fn long_flights_speak_for_the_clearest_channel_and_short_ones_for_the_densest() {
        let [long, short] = [40.0, 1e-3].map(|length| after(&medium(), length, true).0.map(f64::exp));
        assert!(long[0] > 0.999_999 && short[2] > short[1] && short[1] > short[0], "{long:?}, {short:?}");
        for posterior in [long, short] {
            assert!((posterior.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{posterior:?}");
        }
        // A thousand mean free paths are more than a double can tell from nothing.
        assert!(after(&medium(), 1000.0, true).0[2] < -2000.0);
    }

    /// Whichever channel is the hero, in the mean no channel gains or loses light: E[f_k / P] = 1, and e^{-tau_k} where
    /// a surface is met by the flights that get there.
    #[test]
    fn the_mean_throughput_of_every_channel_is_that_of_grey_flights() {
        let (medium, wall, cells) = (medium(), 0.8, 40_000);
        let (mut scattered, mut met) = ([0.0; CHANNELS], [0.0; CHANNELS]);
        for hero in 0..CHANNELS {
            for cell in 0..cells {
                let length = medium.homogeneous_twin(hero).flight((f64::from(cell) + 0.5) / f64::from(cells));
                let (_, quotients) = after(&medium, length.min(wall), length < wall);
                let sums = if length < wall { &mut scattered } else { &mut met };
                for (sum, quotient) in sums.iter_mut().zip(quotients) {
                    *sum += quotient / f64::from(cells) / 3.0;
                }
            }
        }
        for channel in 0..CHANNELS {
            let passes = (-medium.homogeneous_twin(channel).extinction * wall).exp();
            assert!((met[channel] - passes).abs() < 1e-4, "{met:?}");
            assert!((scattered[channel] + passes - 1.0).abs() < 1e-3, "{scattered:?}");
        }
    }
}
