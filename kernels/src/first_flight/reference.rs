//! First flights in f64.
//!
//! From a point D to the side of where the ray passes closest to the light's centre, the part of the ray beyond t spans
//! an angle that falls from `span` at the origin to 0 at infinity. An aimed flight ends where `(1 - v) span` is left:
//!
//! ```text
//! delta = (c - x) . d,      D^2 = |x + delta d - c|^2 + R^2
//! span = pi / 2 + atan(delta / D) = atan2(D, -delta)
//! t = delta + D cot((1 - v) span) = sqrt(delta^2 + D^2) sin(v span) / sin((1 - v) span)
//! weight = mu_t e^{-mu_t t} / ((1 - share) c mu_t e^{-c mu_t t} + share sum_l share_l q_l(t))
//! ```
//!
//! where the quotient of sines neither cancels nor becomes negative, and c is the thinning of the flights that are not
//! aimed.

use glam::DVec3;

use super::{Aim, Columns};
use crate::media::reference;
use crate::tables::lights::{Light, Lights};
use crate::{Step, random};

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, lights, aim, requested, paths, vertex, ray, flight: flights, .. } = columns;
    let Columns { weight: weights, density: densities, .. } = columns;
    for lane in requested.each() {
        let origin = DVec3::from(vertex.position.row(lane).map(f64::from));
        let direction = DVec3::from(ray.direction.row(lane).map(f64::from));
        let u = uniforms(paths.pixel.rows()[lane], paths.sample.rows()[lane], step.seed);
        let free = f64::from(flights.rows()[lane]);
        let flight = flight(lights, aim, origin, direction, free, u);
        flights.rows_mut()[lane] = flight as f32;
        let sight = (origin, direction);
        if medium.is_coloured() {
            let mixed =
                [0, 1, 2].map(|c| mixed_density(&medium.homogeneous_twin(c), lights, aim, sight, flight) as f32);
            densities.set_row(lane, mixed);
        } else {
            weights.rows_mut()[lane] = weight(&medium.homogeneous_twin(0), lights, aim, sight, flight) as f32;
        }
    }
}

/// The numbers that decide between free and aimed flight, and on the aimed one.
pub fn uniforms(pixel: u32, sample: u32, seed: u32) -> [f64; 2] {
    let [_, _, choice, aimed] = random::words(pixel, sample, random::block(0, random::CAMERA), seed);
    [choice, aimed].map(random::uniform)
}

/// The first flight of the ray `[m]`, >= 0: a stretched `free` one, or drawn towards a light if `u` says so.
pub fn flight(lights: &Lights, aim: Aim, origin: DVec3, direction: DVec3, free: f64, u: [f64; 2]) -> f64 {
    match choose_light(lights, f64::from(aim.share), u[0]) {
        Some(light) => aimed_flight(&lights.lights()[light], origin, direction, u[1]),
        None => free / f64::from(aim.thinned),
    }
}

/// The light that a flight with the number `u` is drawn towards; none if it is free.
///
/// Where rounding keeps the shares from adding up to one, the last light gets what is left.
fn choose_light(lights: &Lights, share: f64, u: f64) -> Option<usize> {
    if u >= share {
        return None;
    }
    let mut sum = 0.0;
    for (index, light) in lights.lights().iter().enumerate() {
        sum += f64::from(light.intensity);
        if u < share * sum {
            return Some(index);
        }
    }
    lights.lights().len().checked_sub(1)
}

/// The distance along the ray that a share `v` of the flights drawn towards `light` does not reach `[m]`.
fn aimed_flight(light: &Light, origin: DVec3, direction: DVec3, v: f64) -> f64 {
    let (delta, offset) = approach(light, origin, direction);
    let span = span(delta, offset);
    delta.hypot(offset) * (v * span).sin() / ((1.0 - v) * span).sin()
}

/// How far along the ray it is closest to the centre of the light, and D, how far it then passes, widened by the
/// light's radius `[m]`.
fn approach(light: &Light, origin: DVec3, direction: DVec3) -> (f64, f64) {
    let center = DVec3::from(light.center.map(f64::from));
    let delta = (center - origin).dot(direction);
    let miss = (origin + delta * direction - center).length();
    (delta, miss.hypot(f64::from(light.radius)))
}

/// The angle that the whole ray spans, (0, pi).
fn span(delta: f64, offset: f64) -> f64 {
    offset.atan2(-delta)
}

/// q_l: the density of the flights drawn towards `light` at `t` [1/m].
pub fn density(light: &Light, origin: DVec3, direction: DVec3, t: f64) -> f64 {
    let (delta, offset) = approach(light, origin, direction);
    offset / (span(delta, offset) * (offset.powi(2) + (t - delta).powi(2)))
}

/// The probability that a flight drawn towards `light` goes farther than `t` [0, 1]: the angle that is left.
pub fn probability(light: &Light, origin: DVec3, direction: DVec3, t: f64) -> f64 {
    let (delta, offset) = approach(light, origin, direction);
    offset.atan2(t - delta) / span(delta, offset)
}

/// The density of a free flight over that of the mixture, at `t`, [0, 1 / (c (1 - share))]. There must be a medium.
pub fn weight(medium: &dyn reference::Medium, lights: &Lights, aim: Aim, sight: (DVec3, DVec3), t: f64) -> f64 {
    let (origin, direction) = sight;
    let end = origin + t * direction;
    let free = medium.extinction(end) * (-medium.optical_depth(origin, end)).exp();
    free / mixed_density(medium, lights, aim, sight, t)
}

/// The density of the mixture at `t` along a ray from an origin in a direction [1/m].
pub fn mixed_density(medium: &dyn reference::Medium, lights: &Lights, aim: Aim, sight: (DVec3, DVec3), t: f64) -> f64 {
    let end = end_of_free_flight(aim, sight, t);
    let free = f64::from(aim.thinned) * medium.extinction(end) * (-medium.optical_depth(sight.0, end)).exp();
    mix(lights, aim, free, |light| density(light, sight.0, sight.1, t))
}

/// The probability that a flight of the mixture goes farther than `t` [0, 1].
pub fn mixed_probability(
    medium: &dyn reference::Medium,
    lights: &Lights,
    aim: Aim,
    sight: (DVec3, DVec3),
    t: f64,
) -> f64 {
    let free = (-medium.optical_depth(sight.0, end_of_free_flight(aim, sight, t))).exp();
    mix(lights, aim, free, |light| probability(light, sight.0, sight.1, t))
}

/// Where the free flight ends that is stretched to `t`.
fn end_of_free_flight(aim: Aim, (origin, direction): (DVec3, DVec3), t: f64) -> DVec3 {
    origin + f64::from(aim.thinned) * t * direction
}

/// What flights that are not aimed have, and those that are aimed at each light.
fn mix(lights: &Lights, aim: Aim, free: f64, aimed: impl Fn(&Light) -> f64) -> f64 {
    let share = f64::from(aim.share);
    let aimed: f64 = lights.lights().iter().map(|light| f64::from(light.intensity) * aimed(light)).sum();
    (1.0 - share) * free + share * aimed
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::columns::paths::{Path, PathColumns, RayColumns, VertexColumns};
    use crate::columns::{Column, Spectrum};
    use crate::lanes::LaneSet;
    use crate::media::Medium;
    use crate::media::reference::Homogeneous;
    use crate::phase::PhaseFunction;
    use crate::tables::lights::{Emitter, Selection};
    use bumpalo::Bump;

    /// Shares of the intensity: a quarter and three quarters.
    pub(crate) fn lights() -> Lights {
        let disk = |x: f64, z: f64, radius: f64, radiance: f64| {
            Emitter::disk(DVec3::new(x, 0.5, z), DVec3::new(0.3, -0.2, -1.0), radius, [radiance; 3])
        };
        Lights::new(vec![disk(0.5, 3.0, 0.25, 4.0), disk(-1.0, 9.0, 0.5, 3.0)], Selection::Uniform)
    }

    /// Rays that pass the first light, that meet its centre, that leave it behind, and that start on it.
    fn rays() -> [(DVec3, DVec3); 5] {
        let center = DVec3::new(0.5, 0.5, 3.0);
        let side = DVec3::new(0.3, -0.1, 1.0).normalize();
        [
            (DVec3::ZERO, DVec3::Z),
            (center - 40.0 * side, side),
            (center - 2.0 * DVec3::Z + 0.01 * DVec3::X, DVec3::Z),
            (center + 30.0 * side + 0.2 * DVec3::X, side),
            (center, side),
        ]
    }

    /// Integral of `f` over (0, t): two Gauss points in each cell of the logarithm.
    fn integral(t: f64, f: impl Fn(f64) -> f64) -> f64 {
        let width = 40.0 / 200_000.0;
        let gauss = [-0.5, 0.5].map(|side| 0.5 + side / 3.0_f64.sqrt());
        let points = (0..200_000).flat_map(|i| gauss.map(|point| t * (-width * (f64::from(i) + point)).exp()));
        points.map(|s| s * f(s) * width / 2.0).sum()
    }

    /// The middles of `count` cells.
    pub(crate) fn cells(count: u32) -> impl Iterator<Item = f64> {
        (0..count).map(move |i| (f64::from(i) + 0.5) / f64::from(count))
    }

    #[test]
    fn aimed_densities_integrate_to_one() {
        for (origin, direction) in rays() {
            for light in lights().lights() {
                let sum = integral(1e9, |t| density(light, origin, direction, t));
                assert!((sum - 1.0).abs() < 1e-6, "{sum} from {origin}");
            }
        }
    }

    #[test]
    fn a_share_v_of_the_density_lies_below_the_flight_of_v() {
        for (origin, direction) in rays() {
            for light in lights().lights() {
                for v in [random::uniform(0), 0.003, 0.3, 0.8, 0.9999] {
                    let t = aimed_flight(light, origin, direction, v);
                    let share = integral(t, |s| density(light, origin, direction, s));
                    assert!(t > 0.0 && (share - v).abs() < 1e-6 * v, "{share} at {v} from {origin}");
                }
            }
        }
    }

    #[test]
    fn flights_are_those_of_the_papers_formula_and_never_negative() {
        for (origin, direction) in rays() {
            for light in lights().lights() {
                let (delta, offset) = approach(light, origin, direction);
                let span = core::f64::consts::FRAC_PI_2 + (delta / offset).atan();
                for v in cells(50).chain([random::uniform(0), random::uniform(u32::MAX)]) {
                    let t = aimed_flight(light, origin, direction, v);
                    let expected = delta + offset / ((1.0 - v) * span).tan();
                    assert!(t > 0.0 && (t - expected).abs() < 1e-7 * (t + delta.abs()), "{t}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn as_many_flights_end_below_t_as_the_mixture_says() {
        let (lights, extinction) = (lights(), 0.2_f64);
        let aim = Aim { share: 0.5, thinned: 0.8 };
        let share = f64::from(aim.share);
        for (origin, direction) in rays() {
            for t in [0.5, 3.0, 20.0] {
                let mut expected = (1.0 - share) * -(-f64::from(aim.thinned) * extinction * t).exp_m1();
                for (light, part) in lights.lights().iter().zip([0.25, 0.75]) {
                    expected += share * part * integral(t, |s| density(light, origin, direction, s));
                }
                // No flight takes both numbers, so that they may be the same.
                let ends_below = |u: f64, v: f64| {
                    let free = Homogeneous::isotropic(extinction).flight(v);
                    flight(&lights, aim, origin, direction, free, [u, v]) < t
                };
                let below = cells(40).map(|u| cells(5000).filter(|v| ends_below(u, *v)).count()).sum::<usize>();
                let found = below as f64 / 200_000.0;
                assert!((found - expected).abs() < 2e-4, "{found} of all flights below {t}, expected {expected}");
            }
        }
    }

    #[test]
    fn weights_average_to_one_under_the_mixture() {
        let lights = lights();
        for (origin, direction) in rays() {
            for (extinction, share) in [(0.05, 0.5), (1.0, 0.5), (4.0, 0.8)] {
                let aim = Aim::in_the_open(share);
                let mut mean = 0.0;
                for (u, v) in cells(40).flat_map(|u| cells(5000).map(move |v| (u, v))) {
                    let free = Homogeneous::isotropic(extinction).flight(v);
                    let t = flight(&lights, aim, origin, direction, free, [u, v]);
                    mean +=
                        weight(&Homogeneous::isotropic(extinction), &lights, aim, (origin, direction), t) / 200_000.0;
                }
                assert!((mean - 1.0).abs() < 1e-3, "{mean} from {origin} at extinction {extinction}");
            }
        }
    }

    #[test]
    fn weights_are_bounded_by_the_share_of_flights_that_are_not_aimed() {
        let lights = lights();
        for (origin, direction) in rays() {
            for (extinction, share) in [(1e-3, 0.1), (0.3, 0.5), (50.0, 0.99)] {
                let aim = Aim::in_the_open(share);
                let bound = 1.0 / (f64::from(aim.thinned) * (1.0 - f64::from(share)));
                for t in [0.0, 1e-6, 0.1, 3.0, 40.0, 1e4] {
                    let weight = weight(&Homogeneous::isotropic(extinction), &lights, aim, (origin, direction), t);
                    assert!((0.0..=bound * (1.0 + 1e-15)).contains(&weight), "{weight} at {t}, share {share}");
                }
            }
        }
        // Dense fog, far from all lights: next to no aimed flight ends here.
        let far = weight(
            &Homogeneous::isotropic(50.0),
            &lights,
            Aim::in_the_open(0.5),
            (DVec3::new(0.0, 0.0, -900.0), DVec3::Z),
            0.01,
        );
        let expected = 2.0 / 0.75 * (-0.25_f64 * 50.0 * 0.01).exp();
        assert!((far - expected).abs() < 1e-4, "{far}, expected {expected}");
    }

    #[test]
    fn each_light_gets_its_share_of_the_aimed_flights() {
        let lights = lights();
        let count = |light: Option<usize>| cells(4000).filter(|u| choose_light(&lights, 0.4, *u) == light).count();
        let found = [Some(0), Some(1), None].map(count);
        assert!(found.iter().zip([400, 1200, 2400]).all(|(found, n)| found.abs_diff(n) <= 1), "{found:?}");
        assert_eq!(choose_light(&Lights::new(Vec::new(), Selection::Uniform), 0.4, 0.1), None);
    }

    #[test]
    fn film_and_flight_use_different_words() {
        let words = random::words(5, 6, random::block(0, random::CAMERA), 7);
        assert_eq!(uniforms(5, 6, 7), [random::uniform(words[2]), random::uniform(words[3])]);
    }

    #[test]
    fn only_requested_lanes_are_written() {
        let arena = Bump::new();
        let lanes = 4000;
        let step = Step { seed: 5, clock: 50 };
        let aim = Aim { share: 0.25, thinned: 0.9 };
        let mut requested = LaneSet::new_in(&arena, lanes);
        let mut paths = PathColumns::new_in(&arena, lanes);
        let mut vertex = VertexColumns::new_in(&arena, lanes);
        let mut ray = RayColumns::new_in(&arena, lanes);
        let (mut flights, mut weights) = (Column::new_in(&arena, lanes), Column::new_in(&arena, lanes));
        let mut density = Spectrum::new_in(&arena, lanes, 1);
        let before = (0.7, -1.0);
        let origin = |lane: usize| [0.0, 0.0, 1e-3 * lane as f32];
        for lane in 0..lanes {
            paths.set_row(lane, Path { pixel: lane as u32, sample: 3, birth: step.clock });
            vertex.position.set_row(lane, origin(lane));
            ray.direction.set_row(lane, [0.0, 0.0, 1.0]);
            (flights.rows_mut()[lane], weights.rows_mut()[lane]) = before;
            if lane % 2 == 0 {
                requested.insert(lane);
            }
        }
        let medium = Medium::homogeneous(0.5, [1.0; 3], PhaseFunction::henyey_greenstein(0.0));
        let columns = Columns {
            medium: &medium,
            lights: &lights(),
            aim,
            requested: &requested,
            paths: &paths,
            vertex: &vertex,
            ray: &ray,
            flight: &mut flights,
            weight: &mut weights,
            density: &mut density,
        };
        run(step, columns);
        let mut aimed = 0_u32;
        for lane in 0..lanes {
            let (flight, found) = (flights.rows()[lane], weights.rows()[lane]);
            if lane % 2 == 1 {
                assert_eq!((flight, found), before, "lane {lane} is not requested");
                continue;
            }
            let [u, _] = uniforms(lane as u32, 3, step.seed);
            let stretched = (flight - before.0 / aim.thinned).abs() < 1e-6;
            assert_eq!(stretched, u >= 0.25, "lane {lane}: {flight}");
            let start = DVec3::from(origin(lane).map(f64::from));
            let expected = weight(&Homogeneous::isotropic(0.5), &lights(), aim, (start, DVec3::Z), f64::from(flight));
            assert!((f64::from(found) - expected).abs() < 1e-5, "lane {lane}: {found}");
            aimed += u32::from(u < 0.25);
        }
        // Five standard deviations of a binomial count of 2000.
        assert!(aimed.abs_diff(500) < 97, "{aimed}");
    }
}
