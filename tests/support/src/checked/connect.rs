//! Stages that make connections, checked.

use super::*;

pub(super) fn check_light_sample(lights: &Lights, reach: Reach, step: Step, columns: light_sample::Columns<'_, '_>) {
    let light_sample::Columns { paths, vertices, rays, connections } = columns;
    let (kernel, mut twin) = run_both!(
        light_sample(lights, reach, step),
        [paths, vertices, connections],
        light_sample::Columns { paths: &mut *paths, vertices: &mut *vertices, rays, connections: &mut *connections }
    );
    for lane in members(&paths.live) {
        let near = |saved: &Saved| saved.row(0, lane)["first_near"].clone();
        count_rows(1);
        if near(&kernel.0) != near(&twin.0) {
            count_decisions(1);
        }
        // A lane that no light is near has no light sum; the kernel fills whole batches.
        let is_near = paths.columns.first_near.rows()[lane] == paths.depth(step.clock, lane);
        if lights.selection_depends_on_start()
            && (is_near || reach.max_distance.is_infinite())
            && may_start(reach, paths, step, lane)
        {
            let at = (slot(step.clock, vertices.slots()), lane);
            check_row("light_sample", at, (&kernel.1, &twin.1), &[("light_sum", tolerances::LIGHT_SUM)]);
        }
    }
    // Connections have no weight yet.
    twin.2.forget("weight");
    let mut kernel = kernel.2;
    kernel.forget("weight");
    check_queue("light_sample", (&kernel, &twin.2), &[("point", tolerances::POSITION)]);
}

/// Whether the vertex of the clock may start a connection.
fn may_start(reach: Reach, paths: &PathTable<'_>, step: Step, lane: usize) -> bool {
    let depth = paths.depth(step.clock, lane);
    depth <= reach.max_depth && depth - paths.first_start(lane) < reach.starts
}

pub(super) fn check_mvnee_count(
    medium: &Medium,
    lengths: PathLengths,
    step: Step,
    columns: mvnee_sample::CountColumns<'_, '_>,
) {
    let mvnee_sample::CountColumns { paths, connections, buckets } = columns;
    let (kernel, twin) = run_both!(
        mvnee_count(medium, lengths, step),
        [buckets],
        mvnee_sample::CountColumns { paths, connections, buckets: &mut *buckets }
    );
    for at in 0..connections.len {
        count_rows(1);
        if kernel.0.row(0, at) != twin.0.row(0, at) {
            count_decisions(1);
        }
        let most = lengths.max - 1 - paths.depth(step.clock, connections.lane.rows()[at] as usize);
        let count = buckets.count.rows()[at];
        if count != DROPPED && count > most {
            fail("mvnee_count", at, &format!("    {count} seeds where {most} fit"));
        }
    }
}

pub(super) fn check_mvnee_build(
    medium: &Medium,
    mvnee: &Mvnee,
    step: Step,
    columns: mvnee_sample::BuildColumns<'_, '_>,
) {
    let mvnee_sample::BuildColumns { paths, connections, buckets, candidates, chains } = columns;
    let (kernel, twin) = run_both!(
        mvnee_build(medium, mvnee, step),
        [candidates, chains],
        mvnee_sample::BuildColumns { paths, connections, buckets, candidates: &mut *candidates, chains: &mut *chains }
    );
    check_chains("mvnee_build", buckets, 0, (kernel.0, twin.0), (&kernel.1, &twin.1), |_, _| tolerances::CHAIN);
}

/// Compares connections that were built in buckets, with `appended` more vertices than these say; `tolerance` is that
/// of the inserted vertices of a row.
fn check_chains(
    stage: &str,
    buckets: &BucketTable<'_>,
    appended: usize,
    (mut candidates, mut candidates_twin): (Saved, Saved),
    chains: (&Saved, &Saved),
    tolerance: impl Fn(Bucket, usize) -> Tolerance,
) {
    candidates.forget("weight");
    candidates_twin.forget("weight");
    for bucket in buckets.buckets() {
        for at in bucket.rows() {
            check_row(stage, (0, at), (&candidates, &candidates_twin), &[]);
            for vertex in 0..bucket.inserted + appended {
                check_row(stage, (vertex, at), chains, &[("vertex", tolerance(*bucket, at))]);
            }
        }
    }
}

pub(super) fn check_omnee_build(medium: &Medium, step: Step, columns: omnee_sample::BuildColumns<'_, '_>) {
    let omnee_sample::BuildColumns { paths, connections, chains } = columns;
    let (kernel, twin) = run_both!(
        omnee_build(medium, step),
        [chains],
        omnee_sample::BuildColumns { paths, connections, chains: &mut *chains }
    );
    for at in 0..connections.len {
        check_row("omnee_build", (0, at), (&kernel.0, &twin.0), &[("vertex", tolerances::CHAIN)]);
    }
}

pub(super) fn check_bridge_count(
    medium: &Medium,
    bridge: &Bridge,
    lengths: PathLengths,
    step: Step,
    columns: bridge_sample::CountColumns<'_, '_>,
) {
    let bridge_sample::CountColumns { paths, connections, buckets } = columns;
    let (kernel, twin) = run_both!(
        bridge_count(medium, bridge, lengths, step),
        [buckets],
        bridge_sample::CountColumns { paths, connections, buckets: &mut *buckets }
    );
    for at in 0..connections.len {
        count_rows(1);
        if kernel.0.row(0, at) != twin.0.row(0, at) {
            count_decisions(1);
        }
        let room = bridge.room(lengths.max, paths.depth(step.clock, connections.lane.rows()[at] as usize));
        let count = buckets.count.rows()[at];
        if count != DROPPED && count >= room {
            fail("bridge_count", at, &format!("    {count} vertices where {room} edges fit"));
        }
    }
}

pub(super) fn check_bridge_build(
    medium: &Medium,
    bridge: &Bridge,
    step: Step,
    columns: bridge_sample::BuildColumns<'_, '_>,
) {
    let bridge_sample::BuildColumns { paths, connections, buckets, candidates, chains } = columns;
    let (kernel, twin) = run_both!(
        bridge_build(medium, bridge, step),
        [candidates, chains],
        bridge_sample::BuildColumns { paths, connections, buckets, candidates: &mut *candidates, chains: &mut *chains }
    );
    // What the walk came to is scaled to the distance: a walk that ends near its origin is blown up, rounding included.
    let blown_up = |bucket: Bucket, at: usize| {
        let start = glam::Vec3::from(candidates.start.row(at));
        let reach = |vertex: &Column3<'_>| glam::Vec3::from(vertex.row(at)).distance(start);
        let extent = chains.vertices[..bucket.inserted].iter().map(reach).fold(0.0, f32::max);
        tolerances::bridge_vertex(f64::from(extent), f64::from(start.distance(candidates.point.row(at).into())))
    };
    check_chains("bridge_build", buckets, 0, (kernel.0, twin.0), (&kernel.1, &twin.1), blown_up);
}

pub(super) fn check_lis_vertex(
    medium: &Medium,
    lights: &Lights,
    lis: &Lis,
    step: Step,
    columns: lis_sample::VertexColumns<'_, '_>,
) {
    let lis_sample::VertexColumns { paths, connections, ends } = columns;
    let (mut kernel, mut twin) = run_both!(
        lis_vertex(medium, lights, lis, step),
        [connections, ends],
        lis_sample::VertexColumns { paths, connections: &mut *connections, ends: &mut *ends }
    );
    kernel.0.forget("weight");
    twin.0.forget("weight");
    // Points come from directions and flights, both drawn by powers and logarithms.
    check_queue("lis_vertex", (&kernel.0, &twin.0), &[("point", tolerances::CHAIN)]);
    check_queue("lis_vertex", (&kernel.1, &twin.1), &[]);
    if connections.lane.rows()[..connections.len] != ends.lane.rows()[..ends.len] {
        fail("lis_vertex", 0, "    connections and the points behind them are not in the same rows");
    }
}

pub(super) fn check_lis_join(columns: lis_sample::JoinColumns<'_, '_>) {
    let lis_sample::JoinColumns { buckets, ends, candidates, chains } = columns;
    let (kernel, twin) = run_both!(
        lis_join(),
        [candidates, chains],
        lis_sample::JoinColumns { buckets, ends, candidates: &mut *candidates, chains: &mut *chains }
    );
    let chains = (&kernel.1, &twin.1);
    check_chains("lis_join", buckets, 1, (kernel.0, twin.0), chains, |_, _| tolerances::EXACT);
}
