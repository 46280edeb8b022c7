//! What the camera sees first.

use super::*;

pub(super) fn check_features(step: Step, columns: features::Columns<'_, '_>) {
    let features::Columns { camera, medium, lights, surfaces, requested, vertex, ray, flight, .. } = columns;
    let features::Columns { hits, surface_hits, features, views, worth, .. } = columns;
    let [features_both, views_both, worth_both] = run_both!(
        features(step),
        [features, views, worth],
        features::Columns {
            camera,
            medium,
            lights,
            surfaces,
            requested,
            vertex,
            ray,
            flight,
            hits,
            surface_hits,
            features: &mut *features,
            views: &mut *views,
            worth: &mut *worth,
        }
    );
    for lane in lanes(requested) {
        if !requested.contains(lane) {
            check_row("features", (0, lane), &features_both, &[]);
            continue;
        }
        let close = [("depth", tolerances::DEPTH), ("normal", tolerances::NORMAL)];
        if medium.field().is_some() {
            // The volume that a point is in is a decision.
            check_found((0, lane), &features_both, &close);
        } else {
            check_row("features", (0, lane), &features_both, &close);
        }
    }
    check_queue("features", &views_both, &[("point", light_point(lights))]);
    if views_both.0.indices("lane") != requested.each().map(|lane| lane as u32).collect::<Vec<_>>() {
        fail("features", 0, "    not every new sample has a view");
    }
    for at in 0..views.len {
        check_row("features", (0, at), &worth_both, &[("factor", tolerances::QUOTIENT)]);
    }
}
