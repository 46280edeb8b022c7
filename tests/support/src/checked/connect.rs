//! Stages that make connections, checked.

use super::*;

pub(super) fn check_light_survey(step: Step, columns: light_survey::Columns<'_, '_>) {
    let light_survey::Columns { lights, near, starts, live, paths, last_surface, vertex, outlook } = columns;
    let [both] = run_both!(
        light_survey(step),
        [outlook],
        light_survey::Columns { lights, near, starts, live, paths, last_surface, vertex, outlook: &mut *outlook }
    );
    for lane in live.each() {
        let [kernel, twin] = [&both.0, &both.1].map(|saved| saved.row(0, lane)["first_near"].clone());
        count_rows(1);
        if kernel != twin {
            count_decisions(1);
        }
    }
    let mut sums = both;
    sums.0.forget("first_near");
    sums.1.forget("first_near");
    // The kernel fills whole batches, vertices that may not connect included.
    let may = |lane: &usize| paths.depth_of(step.clock, *lane) - last_surface.first_start(*lane) < starts;
    for lane in live.each().filter(may) {
        check_row("light_survey", (0, lane), &sums, &[("light_sum", tolerances::LIGHT_SUM)]);
    }
}

pub(super) fn check_light_sample(step: Step, columns: light_sample::Columns<'_, '_>) {
    let light_sample::Columns { lights, scope, live, paths, last_surface, .. } = columns;
    let light_sample::Columns { outlook, vertex, before, connections, .. } = columns;
    let [both] = run_both!(
        light_sample(step),
        [connections],
        light_sample::Columns {
            lights,
            scope,
            live,
            paths,
            last_surface,
            outlook,
            vertex,
            before,
            connections: &mut *connections,
        }
    );
    check_queue("light_sample", &both, &[("point", light_point(lights))]);
}

/// What kernel and twin add to paths that have found nothing so far, or list.
pub(super) fn check_nee(step: Step, columns: in_place::Columns<'_, '_>) {
    let in_place::Columns { medium, lights, walk, live, paths, outlook, last_surface, solid, .. } = columns;
    let in_place::Columns { blocked, threshold, vertex, before, throughput, .. } = columns;
    let in_place::Columns { radiance, candidates, worth, dropped, tally, .. } = columns;
    let found = radiance.save();
    radiance.channels_mut().iter_mut().for_each(|channel| channel.rows_mut().fill(0.0));
    let [added, listed, worths, dropped, tally] = run_both!(
        nee(step),
        [radiance, candidates, worth, dropped, tally],
        in_place::Columns {
            medium,
            lights,
            walk,
            live,
            paths,
            outlook,
            last_surface,
            solid,
            blocked,
            threshold,
            vertex,
            before,
            throughput,
            radiance: &mut *radiance,
            candidates: &mut *candidates,
            worth: &mut *worth,
            dropped: &mut *dropped,
            tally: &mut *tally,
        }
    );
    let tolerance = |lane: usize| {
        let depth = paths.depth_of(step.clock, lane);
        let (pixel, sample) = (paths.pixel.rows()[lane], paths.sample.rows()[lane]);
        let u = reference::uniforms(pixel, sample, depth, nee::SCOPE.purpose, step.seed);
        let start = glam::DVec3::from(vertex.position.row(lane).map(f64::from));
        reference::connect(lights, nee::SCOPE, start, u).map_or(tolerances::EXACT, |(emitter, point)| {
            let extent = [start.length().max(point.length()), start.distance(point)];
            let conditioning = weigh::conditioning(lights, emitter, [start, point], weigh::sharpest(medium), extent);
            let Tolerance { absolute, relative } = tolerances::WEIGHT;
            Tolerance { absolute, relative: relative + conditioning }
        })
    };
    for lane in live.each() {
        let (kernel, twin) = (&added.0.row(0, lane), &added.1.row(0, lane));
        let brings = |saved: &Saved| saved.vector("channels", lane).into_iter().any(|channel| channel != 0.0);
        count_rows(1);
        if threshold.is_some() && brings(&added.0) != brings(&added.1) {
            count_decisions(1); // The roulette kept only one of them.
        } else if let Some(text) = difference(kernel, twin, &[("channels", tolerance(lane))]) {
            fail("nee", lane, &text);
        }
    }
    check_queue("nee", &listed, &[("point", light_point(lights))]);
    let [kernel_lanes, twin_lanes] = [&listed.0, &listed.1].map(|saved| saved.indices("lane"));
    for (at, lane) in kernel_lanes.iter().enumerate() {
        let Some(other) = twin_lanes.iter().position(|other| other == lane) else { continue };
        let close = &[("weight", tolerance(*lane as usize)), ("factor", tolerances::EXACT)];
        if let Some(text) = difference(&worths.0.row(0, at), &worths.1.row(0, other), close) {
            fail("nee", *lane as usize, &text);
        }
    }
    if dropped.0 != dropped.1 {
        fail("nee", 0, &format!("    dropped {:?} and {:?}", dropped.0, dropped.1));
    }
    let counts = [&tally.0, &tally.1].map(|saved| saved.indices("tally"));
    count_decisions(counts[0].iter().zip(counts[1]).map(|(kernel, twin)| kernel.abs_diff(*twin) as usize).sum());
    let added = radiance.save();
    radiance.restore(&found);
    for lane in live.each() {
        let found = found.vector("channels", lane).into_iter().zip(added.vector("channels", lane));
        let sums = radiance.channels_mut().iter_mut().zip(found);
        sums.for_each(|(channel, (before, added))| channel.rows_mut()[lane] = before + added);
    }
}

pub(super) fn check_mvnee_count(step: Step, columns: mvnee_sample::CountColumns<'_, '_, Mvnee>) {
    let (longest, paths, connections) = (columns.lengths.max, columns.paths, columns.connections);
    let left = |at: usize| longest - 1 - paths.depth_of(step.clock, connections.lane.rows()[at] as usize);
    let seeds = columns.technique.max_inserted;
    let most = |at: usize| left(at).min(seeds);
    check_count("mvnee_count", (SIMD.mvnee_count, REFERENCE.mvnee_count), step, columns, most);
}

pub(super) fn check_bridge_count(step: Step, columns: bridge_sample::CountColumns<'_, '_, Bridge>) {
    let (longest, paths, connections) = (columns.lengths.max, columns.paths, columns.connections);
    let depth = |at: usize| paths.depth_of(step.clock, connections.lane.rows()[at] as usize);
    let bridge = columns.technique;
    let most = |at: usize| bridge.room(longest, depth(at)) - 1;
    check_count("bridge_count", (SIMD.bridge_count, REFERENCE.bridge_count), step, columns, most);
}

/// Compares counts, of which that of row `at` may be `most(at)` at most.
fn check_count<T>(
    stage: &str,
    (simd, reference): Both<fn(Step, CountColumns<'_, '_, T>)>,
    step: Step,
    columns: CountColumns<'_, '_, T>,
    most: impl Fn(usize) -> u32,
) {
    let CountColumns { technique, medium, lengths, solid, paths, immersion, last_surface, .. } = columns;
    let CountColumns { connections, count, .. } = columns;
    let [both] = run_both!(
        (simd, reference)(step),
        [count],
        CountColumns {
            technique,
            medium,
            lengths,
            solid,
            paths,
            immersion,
            last_surface,
            connections,
            count: &mut *count,
        }
    );
    for at in 0..connections.len {
        count_rows(1);
        if both.0.row(0, at) != both.1.row(0, at) {
            count_decisions(1);
        }
        let count = count.rows()[at];
        if count != DROPPED && count > most(at) {
            fail(stage, at, &format!("    {count} vertices where {} fit", most(at)));
        }
    }
}

pub(super) fn check_mvnee_build(step: Step, columns: mvnee_sample::BuildColumns<'_, '_, Mvnee>) {
    check_build("mvnee_build", (SIMD.mvnee_build, REFERENCE.mvnee_build), step, columns, |_, _| tolerances::CHAIN);
}

pub(super) fn check_bridge_build(step: Step, columns: bridge_sample::BuildColumns<'_, '_, Bridge>) {
    let phase = &columns.medium.phase;
    let blown_up = |[start, point]: [glam::Vec3; 2], chain: &[glam::Vec3]| {
        let bridge: Vec<_> = [&[start], chain, &[point]].concat().into_iter().map(glam::Vec3::as_dvec3).collect();
        tolerances::bridge_vertex(phase, &bridge)
    };
    check_build("bridge_build", (SIMD.bridge_build, REFERENCE.bridge_build), step, columns, blown_up);
}

/// Compares the chains of connections; `tolerance` is that of the vertices of a chain between two ends.
fn check_build<T>(
    stage: &str,
    (simd, reference): Both<fn(Step, BuildColumns<'_, '_, T>)>,
    step: Step,
    columns: BuildColumns<'_, '_, T>,
    tolerance: impl Fn([glam::Vec3; 2], &[glam::Vec3]) -> Tolerance,
) {
    let BuildColumns { technique, medium, lights, solid, paths, immersion, last_surface, .. } = columns;
    let BuildColumns { connections, buckets, candidates, chains, pieces, .. } = columns;
    let [candidates_both, chains_both] = run_both!(
        (simd, reference)(step),
        [candidates, chains],
        BuildColumns {
            technique,
            medium,
            lights,
            solid,
            paths,
            immersion,
            last_surface,
            connections,
            buckets,
            candidates: &mut *candidates,
            chains: &mut *chains,
            pieces: &mut *pieces,
        }
    );
    let of_row = |bucket: Bucket, at: usize| {
        let chain: Vec<_> = chains.vertices[..bucket.inserted].iter().map(|vertex| vertex.row(at).into()).collect();
        tolerance([candidates.start.row(at).into(), candidates.point.row(at).into()], &chain)
    };
    let check_vertex = |at: (usize, usize), close: Tolerances<'_>| match medium.field() {
        Some(_) => check_found(at, &chains_both, close),
        None => check_row(stage, at, &chains_both, close),
    };
    // Walks are as likely as their weights say, so that another weight is another walk.
    let weights = chains.vertices.len();
    let alike = |at: usize| {
        let [kernel, twin] = [&chains_both.0, &chains_both.1].map(|saved| saved.row(weights, at));
        difference(&kernel, &twin, &[("resampling", tolerances::RESAMPLING)]).is_none()
    };
    check_chains(stage, buckets, 0, &candidates_both, |bucket, at, vertex| {
        if alike(at) {
            check_vertex((vertex, at), &[("vertex", of_row(bucket, at))]);
        }
    });
    count_decisions(buckets.buckets().iter().flat_map(|bucket| bucket.rows()).filter(|at| !alike(*at)).count());
}

/// Compares connections that were built in buckets, with `appended` more vertices than these say; `check_vertex` looks at
/// a vertex inserted into a row.
fn check_chains(
    stage: &str,
    buckets: &BucketTable<'_>,
    appended: usize,
    candidates: &Both<Saved>,
    check_vertex: impl Fn(Bucket, usize, usize),
) {
    for bucket in buckets.buckets() {
        for at in bucket.rows() {
            check_row(stage, (0, at), candidates, &[]);
            for vertex in 0..bucket.inserted + appended {
                check_vertex(*bucket, at, vertex);
            }
        }
    }
}

pub(super) fn check_omnee_build(step: Step, columns: omnee_sample::BuildColumns<'_, '_>) {
    let omnee_sample::BuildColumns { medium, paths, connections, chains } = columns;
    let [both] = run_both!(
        omnee_build(step),
        [chains],
        omnee_sample::BuildColumns { medium, paths, connections, chains: &mut *chains }
    );
    for at in 0..connections.len {
        let [start, vertex, point] = [&connections.start, &chains.vertices[0], &connections.point]
            .map(|column| glam::Vec3::from(column.row(at)).as_dvec3());
        let cosine = (vertex - start).normalize_or_zero().dot((point - vertex).normalize_or_zero());
        let vertex = tolerances::turned_vertex(&medium.phase, cosine, start.distance(point));
        check_row("omnee_build", (0, at), &both, &[("vertex", vertex)]);
    }
}

pub(super) fn check_lis_vertex(step: Step, columns: lis_sample::VertexColumns<'_, '_>) {
    let lis_sample::VertexColumns { medium, lights, lis, paths, immersion, connections, ends } = columns;
    let [connections_both, ends_both] = run_both!(
        lis_vertex(step),
        [connections, ends],
        lis_sample::VertexColumns {
            medium,
            lights,
            lis,
            paths,
            immersion,
            connections: &mut *connections,
            ends: &mut *ends,
        }
    );
    match medium.field() {
        Some(_) => check_found_vertices(&connections_both),
        // Points come from directions and flights, both drawn by powers and logarithms.
        None => check_queue("lis_vertex", &connections_both, &[("point", tolerances::CHAIN)]),
    }
    check_queue("lis_vertex", &ends_both, &[]);
    if connections.lane.rows()[..connections.len] != ends.lane.rows()[..ends.len] {
        fail("lis_vertex", 0, "    connections and the points behind them are not in the same rows");
    }
}

/// Compares vertices made from lights in a field, where the stratum that a flight ends in is a decision.
fn check_found_vertices(both: &Both<Saved>) {
    let mut others = both.clone();
    others.0.forget("point");
    others.1.forget("point");
    check_queue("lis_vertex", &others, &[]);
    let [kernel_lanes, twin_lanes] = [&both.0, &both.1].map(|queue| queue.indices("lane"));
    for (at, lane) in kernel_lanes.iter().enumerate() {
        let Some(other) = twin_lanes.iter().position(|other| other == lane) else { continue };
        let close = &[("point", tolerances::TRACKED)];
        if difference(&both.0.row(0, at), &both.1.row(0, other), close).is_some() {
            count_decisions(1);
        }
    }
}

pub(super) fn check_lis_join(step: Step, columns: lis_sample::JoinColumns<'_, '_>) {
    let lis_sample::JoinColumns { buckets, ends, candidates, chains } = columns;
    let [candidates_both, chains_both] = run_both!(
        lis_join(step),
        [candidates, chains],
        lis_sample::JoinColumns { buckets, ends, candidates: &mut *candidates, chains: &mut *chains }
    );
    check_chains("lis_join", buckets, 1, &candidates_both, |_, at, vertex| {
        check_row("lis_join", (vertex, at), &chains_both, &[("vertex", tolerances::EXACT)]);
    });
}
