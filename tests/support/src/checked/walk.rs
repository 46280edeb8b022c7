//! Stages of the walk, checked.

use super::*;

pub(super) fn check_generate(step: Step, columns: generate::Columns<'_, '_>) {
    let generate::Columns { camera, medium, requested, requests, live, occupied, paths, .. } = columns;
    let generate::Columns { immersion, log_posterior, last_surface, outlook, .. } = columns;
    let generate::Columns { throughput, radiance, vertex, ray, .. } = columns;
    let [live_both, occupied_both, tables @ ..] = run_both!(
        generate(step),
        [live, occupied, paths, immersion, log_posterior, last_surface, outlook, throughput, radiance, vertex, ray],
        generate::Columns {
            camera,
            medium,
            requested,
            requests,
            live: &mut *live,
            occupied: &mut *occupied,
            paths: &mut *paths,
            immersion: &mut *immersion,
            log_posterior: &mut *log_posterior,
            last_surface: &mut *last_surface,
            outlook: &mut *outlook,
            throughput: &mut *throughput,
            radiance: &mut *radiance,
            vertex: &mut *vertex,
            ray: &mut *ray,
        }
    );
    let close = [("position", tolerances::POSITION), ("direction", tolerances::DIRECTION)];
    for lane in lanes(live) {
        let allowed = if requested.contains(lane) { close.as_slice() } else { &[] };
        for both in &tables {
            check_row("generate", (0, lane), both, allowed);
        }
    }
    check_set("generate", &live_both);
    check_set("generate", &occupied_both);
}

pub(super) fn check_outline(step: Step, columns: outline::Columns<'_, '_>) {
    let outline::Columns { camera, cell, outlined, requests, vertex, ray } = columns;
    let tables = run_both!(
        outline(step),
        [vertex, ray],
        outline::Columns { camera, cell, outlined, requests, vertex: &mut *vertex, ray: &mut *ray }
    );
    let close = [("position", tolerances::POSITION), ("direction", tolerances::DIRECTION)];
    for lane in outlined.each() {
        tables.iter().for_each(|both| check_row("outline", (0, lane), both, &close));
    }
}

pub(super) fn check_remember(step: Step, columns: remember::Columns<'_, '_>) {
    let remember::Columns { live, vertex, ray, outlook, trail } = columns;
    let [both] =
        run_both!(remember(step), [trail], remember::Columns { live, vertex, ray, outlook, trail: &mut *trail });
    for lane in live.each() {
        check_row("remember", (slot(step.clock, trail.slots()), lane), &both, &[]);
    }
}

pub(super) fn check_extend(step: Step, columns: extend::Columns<'_, '_>) {
    let extend::Columns { lights, surfaces, live, paths, vertex, ray, flight, .. } = columns;
    let extend::Columns { on_surface, hits, surface_hits, .. } = columns;
    let [on_surface_both, hits_both, surface_hits_both] = run_both!(
        extend(step),
        [on_surface, hits, surface_hits],
        extend::Columns {
            lights,
            surfaces,
            live,
            paths,
            vertex,
            ray,
            flight,
            on_surface: &mut *on_surface,
            hits: &mut *hits,
            surface_hits: &mut *surface_hits,
        }
    );
    check_queue("extend", &hits_both, &[("distance", tolerances::DISTANCE)]);
    let met =
        [("distance", tolerances::DISTANCE), ("second", tolerances::BARYCENTRIC), ("third", tolerances::BARYCENTRIC)];
    check_rows("extend", &surface_hits_both, &met);
    for listed in [&surface_hits_both.0, &surface_hits_both.1] {
        let mut lanes = listed.indices("lane").to_vec();
        lanes.sort_unstable();
        if let Some(pair) = lanes.windows(2).find(|pair| pair[0] == pair[1]) {
            fail("extend", pair[0] as usize, "    a flight ends on surfaces twice");
        }
    }
    for (found, listed) in [(&on_surface_both.0, &surface_hits_both.0), (&on_surface_both.1, &surface_hits_both.1)] {
        for lane in lanes(live) {
            if found.contains(lane) != listed.indices("lane").contains(&(lane as u32)) {
                fail("extend", lane, "    the set of lanes on a surface and their list differ");
            }
        }
    }
    count_rows(live.count());
}

pub(super) fn check_glow(step: Step, columns: glow::Columns<'_, '_>) {
    let glow::Columns { medium, glow, lights, lengths, walk, live, paths, vertex, ray, flight, hits, .. } = columns;
    let glow::Columns { surface_hits, throughput, immersion, log_posterior, flown, glowing, .. } = columns;
    let glow::Columns { radiance, origin, parts, dropped, .. } = columns;
    let [flown_both, dropped_both, glowing_both, radiance_both, parts_both] = run_both!(
        glow(step),
        [flown, dropped, glowing, radiance, parts],
        glow::Columns {
            medium,
            glow,
            lights,
            lengths,
            walk,
            live,
            paths,
            vertex,
            ray,
            flight,
            hits,
            surface_hits,
            throughput,
            immersion,
            log_posterior,
            flown: &mut *flown,
            glowing: &mut *glowing,
            radiance: &mut *radiance,
            origin,
            parts: &mut *parts,
            dropped: &mut *dropped,
        }
    );
    for lane in live.each() {
        check_row("glow", (0, lane), &flown_both, &[]);
        for both in [&glowing_both, &radiance_both, &parts_both] {
            if medium.field().is_some() {
                check_found((0, lane), both, &[("channels", tolerances::GLOW)]);
            } else {
                check_row("glow", (0, lane), both, &[("channels", tolerances::CONTRIBUTION)]);
            }
        }
    }
    // All other paths keep their radiance to the bit.
    for lane in lanes(live).filter(|lane| !live.contains(*lane)) {
        check_row("glow", (0, lane), &radiance_both, &[]);
        check_row("glow", (0, lane), &parts_both, &[]);
    }
    if dropped_both.0 != dropped_both.1 {
        fail("glow", 0, &format!("    dropped {:?} and {:?}", dropped_both.0, dropped_both.1));
    }
}

pub(super) fn check_light_hit(step: Step, columns: light_hit::Columns<'_, '_>) {
    let light_hit::Columns { medium, lights, hits, paths, vertex, ray, before, flight, .. } = columns;
    let light_hit::Columns { outlined, share, live, views, worth, light_hits, .. } = columns;
    let [live_both, views_both, worth_both, light_hits_both] = run_both!(
        light_hit(step),
        [live, views, worth, light_hits],
        light_hit::Columns {
            medium,
            lights,
            hits,
            paths,
            vertex,
            ray,
            before,
            flight,
            outlined,
            share,
            live: &mut *live,
            views: &mut *views,
            worth: &mut *worth,
            light_hits: &mut *light_hits,
        }
    );
    let close = [("point", light_point(lights))];
    check_queue("light_hit", &views_both, &close);
    check_queue("light_hit", &light_hits_both, &close);
    if views_both.0.indices("lane") == views_both.1.indices("lane") {
        for at in 0..views.len {
            let through = |plain| tolerances::through(medium, tolerances::KNOWN_SHAPE, plain);
            let close = [("weight", through(tolerances::TRANSMITTANCE)), ("factor", through(tolerances::QUOTIENT))];
            check_row("light_hit", (0, at), &worth_both, &close);
        }
    }
    check_set("light_hit", &live_both);
}

pub(super) fn check_prune(step: Step, columns: prune::Columns<'_, '_>) {
    let prune::Columns { segments, scatters, flights, on_surface, paths, live } = columns;
    let [both] = run_both!(
        prune(step),
        [live],
        prune::Columns { segments, scatters, flights, on_surface, paths, live: &mut *live }
    );
    check_set("prune", &both);
}

pub(super) fn check_passage(step: Step, columns: passage::Columns<'_, '_>) {
    let passage::Columns { medium, live, on_surface, paths, vertex, next, passages, trails } = columns;
    let [both] = run_both!(
        passage(step),
        [passages],
        passage::Columns {
            medium,
            live,
            on_surface,
            paths,
            vertex,
            next,
            passages: &mut *passages,
            trails: &mut *trails
        }
    );
    let sums = || passages.iter().zip(0..);
    for (lane, (passage, sum)) in live.each().flat_map(|lane| sums().map(move |sum| (lane, sum))) {
        check_found((sum, lane), &both, &[("depth", tolerances::PASSAGE), ("log_extinction", tolerances::PASSAGE)]);
        // The trail has what the columns have.
        if trails[sum].slots() > 0 {
            let row = passage.row(lane);
            trails[sum].set_row(lane, step.clock + 1, [row.depth, row.log_extinction]);
        }
    }
}

pub(super) fn check_scatter(step: Step, columns: scatter::Columns<'_, '_>) {
    let scatter::Columns { medium, live, on_surface, paths, flights, .. } = columns;
    let scatter::Columns { vertex, next, ray, next_ray, throughput, .. } = columns;
    let [next_both, ray_both, throughput_both] = run_both!(
        scatter(step),
        [next, next_ray, throughput],
        scatter::Columns {
            medium,
            live,
            on_surface,
            paths,
            flights,
            vertex,
            next: &mut *next,
            ray,
            next_ray: &mut *next_ray,
            throughput: &mut *throughput,
        }
    );
    let vector = |column: &Column3<'_>, lane: usize| glam::Vec3::from(column.row(lane)).as_dvec3();
    // Those that end on a surface are moved later.
    let scatters = |lane: usize| live.contains(lane) && !on_surface.contains(lane);
    for lane in lanes(live).filter(|lane| scatters(*lane)) {
        check_row("scatter", (0, lane), &next_both, &[("position", tolerances::POSITION), ("arc", tolerances::ARC)]);
        let cosine = vector(&ray.direction, lane).dot(vector(&next_ray.direction, lane));
        let Tolerance { absolute, relative } = tolerances::DIRECTION;
        let direction = Tolerance { absolute: absolute + tolerances::turn(&medium.phase, cosine), relative };
        check_row("scatter", (0, lane), &ray_both, &[("direction", direction)]);
    }
    // All other paths keep their throughput to the bit.
    for lane in lanes(live) {
        let allowed = if scatters(lane) { tolerances::CONTRIBUTION } else { tolerances::EXACT };
        check_row("scatter", (0, lane), &throughput_both, &[("channels", allowed)]);
    }
}

pub(super) fn check_surface(step: Step, columns: surface::Columns<'_, '_>) {
    let surface::Columns { surfaces, surface_hits, paths, flights, live, last_surface, .. } = columns;
    let surface::Columns { vertex, next, ray, next_ray, throughput, .. } = columns;
    let [live_both, surface_both, next_both, ray_both, throughput_both] = run_both!(
        surface(step),
        [live, last_surface, next, next_ray, throughput],
        surface::Columns {
            surfaces,
            surface_hits,
            paths,
            flights,
            live: &mut *live,
            last_surface: &mut *last_surface,
            vertex,
            next: &mut *next,
            ray,
            next_ray: &mut *next_ray,
            throughput: &mut *throughput,
        }
    );
    let allowed = [
        ("position", tolerances::SURFACE_POSITION),
        ("direction", tolerances::DIRECTION),
        ("normal", tolerances::DIRECTION),
        ("arc", tolerances::ARC),
        ("channels", tolerances::CONTRIBUTION),
    ];
    let met: Vec<_> = surface_hits.lane.rows()[..surface_hits.len].iter().map(|lane| *lane as usize).collect();
    for lane in lanes(live) {
        let allowed = if met.contains(&lane) { allowed.as_slice() } else { &[] };
        for both in [&surface_both, &next_both, &ray_both, &throughput_both] {
            check_row("surface", (0, lane), both, allowed);
        }
    }
    check_set("surface", &live_both);
}
