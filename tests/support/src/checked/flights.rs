//! Flights: how far they go, and what that counts.

use super::*;

pub(super) fn check_medium_sample(step: Step, columns: medium_sample::Columns<'_, '_>) {
    let medium_sample::Columns { medium, walk, live, paths, immersion, vertex, ray, flights } = columns;
    let [live_both, both] = run_both!(
        medium_sample(step),
        [live, flights],
        medium_sample::Columns {
            medium,
            walk,
            live: &mut *live,
            paths,
            immersion,
            vertex,
            ray,
            flights: &mut *flights,
        }
    );
    for lane in live.each() {
        if medium.field().is_some() {
            check_found((0, lane), &both, &[("flight", tolerances::TRACKED)]);
        } else {
            check_row("medium_sample", (0, lane), &both, &[("flight", tolerances::FLIGHT)]);
        }
    }
    // The number and the probability are the same to the bit in kernel and twin.
    check_set("medium_sample", &live_both);
}

pub(super) fn check_first_flight(step: Step, columns: first_flight::Columns<'_, '_>) {
    let first_flight::Columns { medium, lights, aim, requested, paths, vertex, ray, .. } = columns;
    let first_flight::Columns { flight, weight, density, .. } = columns;
    let [flight_both, weight_both, density_both] = run_both!(
        first_flight(step),
        [flight, weight, density],
        first_flight::Columns {
            medium,
            lights,
            aim,
            requested,
            paths,
            vertex,
            ray,
            flight: &mut *flight,
            weight: &mut *weight,
            density: &mut *density,
        }
    );
    for lane in lanes(requested) {
        let allowed = |tolerance| if requested.contains(lane) { tolerance } else { tolerances::EXACT };
        check_row("first_flight", (0, lane), &flight_both, &[("values", allowed(tolerances::AIMED_FLIGHT))]);
        check_row("first_flight", (0, lane), &weight_both, &[("values", allowed(tolerances::AIMED_WEIGHT))]);
        check_row("first_flight", (0, lane), &density_both, &[("channels", allowed(tolerances::AIMED_WEIGHT))]);
    }
}

pub(super) fn check_first_surface(step: Step, columns: first_surface::Columns<'_, '_>) {
    let first_surface::Columns { medium, lights, aim, requested, surface_hits, vertex, ray, .. } = columns;
    let first_surface::Columns { weight, density, .. } = columns;
    let [weight_both, density_both] = run_both!(
        first_surface(step),
        [weight, density],
        first_surface::Columns {
            medium,
            lights,
            aim,
            requested,
            surface_hits,
            vertex,
            ray,
            weight: &mut *weight,
            density: &mut *density,
        }
    );
    let ends: Vec<_> = (0..surface_hits.len).map(|row| surface_hits.row(row).lane as usize).collect();
    for lane in lanes(requested) {
        let weighed = requested.contains(lane) && ends.contains(&lane);
        let allowed = if weighed { tolerances::AIMED_WEIGHT } else { tolerances::EXACT };
        check_row("first_surface", (0, lane), &weight_both, &[("values", allowed)]);
        check_row("first_surface", (0, lane), &density_both, &[("channels", allowed)]);
    }
}

pub(super) fn check_flight_weight(step: Step, columns: flight_weight::Columns<'_, '_>) {
    let flight_weight::Columns { requested, live, weight, throughput } = columns;
    let [both] = run_both!(
        flight_weight(step),
        [throughput],
        flight_weight::Columns { requested, live, weight, throughput: &mut *throughput }
    );
    // All other paths keep their throughput to the bit.
    for lane in lanes(live) {
        let weighed = requested.contains(lane) && live.contains(lane);
        let allowed = if weighed { tolerances::CONTRIBUTION } else { tolerances::EXACT };
        check_row("flight_weight", (0, lane), &both, &[("channels", allowed)]);
    }
}

pub(super) fn check_spectral_weight(step: Step, columns: spectral_weight::Columns<'_, '_>) {
    let spectral_weight::Columns { medium, live, on_surface, aimed, density, flight, surface_hits, .. } = columns;
    let spectral_weight::Columns { vertex, ray, log_posterior, throughput, .. } = columns;
    let [posterior_both, throughput_both] = run_both!(
        spectral_weight(step),
        [log_posterior, throughput],
        spectral_weight::Columns {
            medium,
            live,
            on_surface,
            aimed,
            density,
            flight,
            surface_hits,
            vertex,
            ray,
            log_posterior: &mut *log_posterior,
            throughput: &mut *throughput,
        }
    );
    let log_posterior = tolerances::through(medium, tolerances::KNOWN_DEPTH, tolerances::LOG_POSTERIOR);
    let quotient = tolerances::through(medium, tolerances::KNOWN_SHAPE, tolerances::QUOTIENT);
    for lane in lanes(live) {
        let weighed = live.contains(lane) || on_surface.contains(lane);
        let allowed = |tolerance| if weighed { tolerance } else { tolerances::EXACT };
        check_row("spectral_weight", (0, lane), &posterior_both, &[("channels", allowed(log_posterior))]);
        check_row("spectral_weight", (0, lane), &throughput_both, &[("channels", allowed(quotient))]);
    }
}

pub(super) fn check_flight_hue(step: Step, columns: flight_hue::Columns<'_, '_>) {
    let flight_hue::Columns { field, live, paths, immersion, flight, surface_hits, vertex, ray, .. } = columns;
    let flight_hue::Columns { estimates, throughput, .. } = columns;
    let [both] = run_both!(
        flight_hue(step),
        [throughput],
        flight_hue::Columns {
            field,
            live,
            paths,
            immersion,
            flight,
            surface_hits,
            vertex,
            ray,
            estimates: &mut *estimates,
            throughput: &mut *throughput,
        }
    );
    for lane in live.each() {
        check_found((0, lane), &both, &[("channels", tolerances::ESTIMATE)]);
    }
}
