//! Stages of the walk, checked.

use super::*;

pub(super) fn check_generate(camera: &Camera, step: Step, columns: generate::Columns<'_, '_>) {
    let generate::Columns { requests, paths, vertices, rays } = columns;
    let (kernel, twin) = run_both!(
        generate(camera, step),
        [paths, vertices, rays],
        generate::Columns { requests, paths: &mut *paths, vertices: &mut *vertices, rays: &mut *rays }
    );
    let close = [("position", tolerances::POSITION), ("direction", tolerances::DIRECTION)];
    for lane in lanes(paths) {
        let allowed = if requests.lanes.contains(lane as u32) { close.as_slice() } else { &[] };
        check_row("generate", (0, lane), (&kernel.0, &twin.0), &[]);
        check_row("generate", (slot(step.clock, vertices.slots()), lane), (&kernel.1, &twin.1), allowed);
        check_row("generate", (slot(step.clock, rays.slots()), lane), (&kernel.2, &twin.2), allowed);
        if [0, 1].map(|set| kernel.0.contains(set, lane)) != [0, 1].map(|set| twin.0.contains(set, lane)) {
            fail("generate", lane, "    live or occupied differ");
        }
    }
}

pub(super) fn check_medium_sample(medium: &Medium, walk: &Walk, step: Step, columns: medium_sample::Columns<'_, '_>) {
    let medium_sample::Columns { paths, flights } = columns;
    let (kernel, twin) = run_both!(
        medium_sample(medium, walk, step),
        [flights, paths],
        medium_sample::Columns { paths: &mut *paths, flights: &mut *flights }
    );
    let allowed = [("flight", tolerances::FLIGHT)];
    for lane in members(&paths.live) {
        check_row("medium_sample", (0, lane), (&kernel.0, &twin.0), &allowed);
    }
    for lane in lanes(paths) {
        // The number and the probability are the same to the bit in kernel and twin.
        if kernel.1.contains(0, lane) != twin.1.contains(0, lane) {
            fail("medium_sample", lane, "    only one of kernel and twin ends the path");
        }
    }
}

pub(super) fn check_first_flight(
    medium: &Medium,
    lights: &Lights,
    share: f32,
    step: Step,
    columns: first_flight::Columns<'_, '_>,
) {
    let first_flight::Columns { requests, paths, vertices, rays, flights } = columns;
    let (kernel, twin) = run_both!(
        first_flight(medium, lights, share, step),
        [flights],
        first_flight::Columns { requests, paths, vertices, rays, flights: &mut *flights }
    );
    let aimed = [("flight", tolerances::AIMED_FLIGHT), ("weight", tolerances::AIMED_WEIGHT)];
    for lane in lanes(paths) {
        let allowed = if requests.lanes.contains(lane as u32) { aimed.as_slice() } else { &[] };
        check_row("first_flight", (0, lane), (&kernel.0, &twin.0), allowed);
    }
}

pub(super) fn check_extend(lights: &Lights, surfaces: &Surfaces, step: Step, columns: extend::Columns<'_, '_>) {
    let extend::Columns { paths, vertices, rays, flights, hits, surface_hits } = columns;
    let (kernel, twin) = run_both!(
        extend(lights, surfaces, step),
        [hits, surface_hits, paths],
        extend::Columns {
            paths: &mut *paths,
            vertices,
            rays,
            flights,
            hits: &mut *hits,
            surface_hits: &mut *surface_hits
        }
    );
    check_queue("extend", (&kernel.0, &twin.0), &[("distance", tolerances::DISTANCE)]);
    let met =
        [("distance", tolerances::DISTANCE), ("second", tolerances::BARYCENTRIC), ("third", tolerances::BARYCENTRIC)];
    check_queue("extend", (&kernel.1, &twin.1), &met);
    for lane in lanes(paths) {
        let listed = kernel.1.indices("lane").contains(&(lane as u32));
        if kernel.2.contains(2, lane) != listed {
            fail("extend", lane, "    the set of lanes on a surface and their list differ");
        }
    }
    count_rows(paths.live.count());
}

pub(super) fn check_light_hit(medium: &Medium, lights: &Lights, step: Step, columns: light_hit::Columns<'_, '_>) {
    let light_hit::Columns { hits, vertices, rays, flights, paths, views, light_hits } = columns;
    let (kernel, twin) = run_both!(
        light_hit(medium, lights, step),
        [paths, views, light_hits],
        light_hit::Columns {
            hits,
            vertices,
            rays,
            flights,
            paths: &mut *paths,
            views: &mut *views,
            light_hits: &mut *light_hits,
        }
    );
    let allowed = [("point", tolerances::POSITION), ("weight", tolerances::TRANSMITTANCE)];
    check_queue("light_hit", (&kernel.1, &twin.1), &allowed);
    check_queue("light_hit", (&kernel.2, &twin.2), &allowed);
    for lane in lanes(paths) {
        if kernel.0.contains(0, lane) != twin.0.contains(0, lane) {
            fail("light_hit", lane, "    only one of kernel and twin ends the path");
        }
    }
}

pub(super) fn check_scatter(medium: &Medium, step: Step, columns: scatter::Columns<'_, '_>) {
    let scatter::Columns { flights, paths, vertices, rays } = columns;
    let (kernel, twin) = run_both!(
        scatter(medium, step),
        [paths, vertices, rays],
        scatter::Columns { flights, paths: &mut *paths, vertices: &mut *vertices, rays: &mut *rays }
    );
    let allowed = [
        ("position", tolerances::POSITION),
        ("direction", tolerances::DIRECTION),
        ("arc", tolerances::ARC),
        ("throughput", tolerances::CONTRIBUTION),
    ];
    let next = step.clock + 1;
    // Those that end on a surface are moved later.
    let scatters = |lane: usize| paths.live.contains(lane as u32) && !paths.on_surface.contains(lane as u32);
    for lane in lanes(paths).filter(|lane| scatters(*lane)) {
        check_row("scatter", (slot(next, vertices.slots()), lane), (&kernel.1, &twin.1), &allowed);
        check_row("scatter", (slot(next, rays.slots()), lane), (&kernel.2, &twin.2), &allowed);
    }
    // All other paths keep their throughput to the bit.
    lanes(paths).for_each(|lane| {
        let allowed = if scatters(lane) { allowed.as_slice() } else { &[] };
        check_row("scatter", (0, lane), (&kernel.0, &twin.0), allowed);
    });
}

pub(super) fn check_surface(surfaces: &Surfaces, step: Step, columns: surface::Columns<'_, '_>) {
    let surface::Columns { surface_hits, flights, paths, vertices, rays } = columns;
    let (kernel, twin) = run_both!(
        surface(surfaces, step),
        [paths, vertices, rays],
        surface::Columns { surface_hits, flights, paths: &mut *paths, vertices: &mut *vertices, rays: &mut *rays }
    );
    let allowed = [
        ("position", tolerances::SURFACE_POSITION),
        ("direction", tolerances::DIRECTION),
        ("surface_normal", tolerances::DIRECTION),
        ("arc", tolerances::ARC),
        ("throughput", tolerances::CONTRIBUTION),
    ];
    let next = step.clock + 1;
    let met: Vec<_> = surface_hits.lane.rows()[..surface_hits.len].iter().map(|lane| *lane as usize).collect();
    for lane in lanes(paths) {
        let allowed = if met.contains(&lane) { allowed.as_slice() } else { &[] };
        check_row("surface", (slot(next, vertices.slots()), lane), (&kernel.1, &twin.1), allowed);
        check_row("surface", (slot(next, rays.slots()), lane), (&kernel.2, &twin.2), allowed);
        check_row("surface", (0, lane), (&kernel.0, &twin.0), allowed);
        if kernel.0.contains(0, lane) != twin.0.contains(0, lane) {
            fail("surface", lane, "    only one of kernel and twin ends the path");
        }
    }
}
