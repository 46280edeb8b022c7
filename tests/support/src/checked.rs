//! A pipeline in which every stage checks itself: it runs its kernel and its twin on the same queues of a real frame and
//! compares what they filled. The frame goes on with what the kernel found.
//!
//! Stages are function pointers without state, so what they find is collected per thread; see [`take_log`].

use std::cell::RefCell;

use fogbow_kernels::columns::paths::{PathTable, VertexTable};
use fogbow_kernels::columns::queues::{Bucket, CandidateQueue, ChainTable};
use fogbow_kernels::columns::trail::TrailTable;
use fogbow_kernels::columns::{Column3, LANES};
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, sample as bridge_sample};
use fogbow_kernels::connect::buckets::{BucketTable, DROPPED};
use fogbow_kernels::connect::light_sample::{self, Reach, reference::cosine};
use fogbow_kernels::connect::lis::{Lis, sample as lis_sample};
use fogbow_kernels::connect::mvnee::{Mvnee, sample as mvnee_sample};
use fogbow_kernels::connect::omnee::sample as omnee_sample;
use fogbow_kernels::mis_weight::reference::position_before;
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD};
use fogbow_kernels::roulette::{self, Threshold};
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::tables::media::Medium;
use fogbow_kernels::tables::surfaces::Surfaces;
use fogbow_kernels::{
    PathLengths, Step, Walk, accumulate, extend, first_flight, generate, light_hit, medium_sample, mis_weight,
    occlusion, scatter, surface,
};

use crate::compare::{Save, Saved, difference, members};
use crate::tolerances::{self, Tolerance};

/// What the checked stages found.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// Rows compared.
    pub rows: u64,
    /// Rows about which kernel and twin decided differently.
    pub decisions: u64,
    /// Rows that are further apart than their tolerance.
    pub failures: Vec<String>,
}

thread_local! {
    static LOG: RefCell<Log> = RefCell::new(Log::default());
}

/// What the checked stages of this thread found since the last call.
pub fn take_log() -> Log {
    LOG.take()
}

fn count_rows(rows: usize) {
    LOG.with_borrow_mut(|log| log.rows += rows as u64);
}

fn count_decisions(rows: usize) {
    LOG.with_borrow_mut(|log| log.decisions += rows as u64);
}

fn fail(stage: &str, row: usize, text: &str) {
    LOG.with_borrow_mut(|log| log.failures.push(format!("{stage}, row {row}:\n{text}")));
}

/// Every stage, checked.
pub const CHECKED: Pipeline = Pipeline {
    generate: check_generate,
    medium_sample: check_medium_sample,
    first_flight: check_first_flight,
    extend: check_extend,
    light_hit: check_light_hit,
    scatter: check_scatter,
    surface: check_surface,
    light_sample: check_light_sample,
    mvnee_count: check_mvnee_count,
    mvnee_build: check_mvnee_build,
    omnee_build: check_omnee_build,
    bridge_count: check_bridge_count,
    bridge_build: check_bridge_build,
    lis_vertex: check_lis_vertex,
    lis_join: check_lis_join,
    mis_weight: check_mis_weight,
    roulette: check_roulette,
    occlusion: check_occlusion,
    accumulate: check_accumulate,
};

/// Runs kernel and twin of a stage on the same columns; gives what each left in the named tables.
macro_rules! run_both {
    ($stage:ident($($arg:expr),*), [$($table:ident),*], $columns:expr) => {{
        let before = ($($table.save(),)*);
        (SIMD.$stage)($($arg,)* $columns);
        let kernel = ($($table.save(),)*);
        run_both!(@restore before, $($table),*);
        (REFERENCE.$stage)($($arg,)* $columns);
        let twin = ($($table.save(),)*);
        run_both!(@restore kernel, $($table),*);
        (kernel, twin)
    }};
    (@restore $saved:ident, $a:ident) => { $a.restore(&$saved.0) };
    (@restore $saved:ident, $a:ident, $b:ident) => { $a.restore(&$saved.0); $b.restore(&$saved.1) };
    (@restore $saved:ident, $a:ident, $b:ident, $c:ident) => {
        $a.restore(&$saved.0); $b.restore(&$saved.1); $c.restore(&$saved.2)
    };
}

type Tolerances<'a> = &'a [(&'a str, Tolerance)];

/// Compares row `row` of table `table`.
fn check_row(stage: &str, (table, row): (usize, usize), (kernel, twin): (&Saved, &Saved), tolerances: Tolerances<'_>) {
    count_rows(1);
    if let Some(text) = difference(&kernel.row(table, row), &twin.row(table, row), tolerances) {
        fail(stage, row, &text);
    }
}

/// Compares the rows of two queues that have the same lane; a lane that only one of them lists is another decision.
fn check_queue(stage: &str, (kernel, twin): (&Saved, &Saved), tolerances: Tolerances<'_>) {
    let (kernel_lanes, twin_lanes) = (kernel.indices("lane"), twin.indices("lane"));
    for (at, lane) in kernel_lanes.iter().enumerate() {
        let Some(other) = twin_lanes.iter().position(|other| other == lane) else {
            count_decisions(1);
            continue;
        };
        count_rows(1);
        if let Some(text) = difference(&kernel.row(0, at), &twin.row(0, other), tolerances) {
            fail(stage, at, &text);
        }
    }
    count_decisions(twin_lanes.iter().filter(|lane| !kernel_lanes.contains(lane)).count());
    if !kernel_lanes.is_sorted() || !twin_lanes.is_sorted() {
        fail(stage, 0, "    rows are not in lane order");
    }
}

fn lanes(paths: &PathTable<'_>) -> core::ops::Range<usize> {
    0..paths.batches() * LANES
}

/// The slot of `clock` in a ring of so many.
fn slot(clock: u32, slots: usize) -> usize {
    clock as usize % slots
}

fn check_generate(camera: &Camera, step: Step, columns: generate::Columns<'_, '_>) {
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

fn check_medium_sample(medium: &Medium, walk: &Walk, step: Step, columns: medium_sample::Columns<'_, '_>) {
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

fn check_first_flight(
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

fn check_extend(lights: &Lights, surfaces: &Surfaces, step: Step, columns: extend::Columns<'_, '_>) {
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

fn check_light_hit(medium: &Medium, lights: &Lights, step: Step, columns: light_hit::Columns<'_, '_>) {
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

fn check_scatter(medium: &Medium, step: Step, columns: scatter::Columns<'_, '_>) {
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

fn check_surface(surfaces: &Surfaces, step: Step, columns: surface::Columns<'_, '_>) {
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

fn check_light_sample(lights: &Lights, reach: Reach, step: Step, columns: light_sample::Columns<'_, '_>) {
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

fn check_mvnee_count(medium: &Medium, lengths: PathLengths, step: Step, columns: mvnee_sample::CountColumns<'_, '_>) {
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

fn check_mvnee_build(medium: &Medium, mvnee: &Mvnee, step: Step, columns: mvnee_sample::BuildColumns<'_, '_>) {
    let mvnee_sample::BuildColumns { paths, connections, buckets, candidates, chains } = columns;
    let (kernel, twin) = run_both!(
        mvnee_build(medium, mvnee, step),
        [candidates, chains],
        mvnee_sample::BuildColumns { paths, connections, buckets, candidates: &mut *candidates, chains: &mut *chains }
    );
    check_chains("mvnee_build", buckets, 0, (kernel.0, twin.0), (&kernel.1, &twin.1), |_, _| tolerances::CHAIN);
}

/// Compares connections that were built in buckets, with `appended` more vertices than these say; `tolerance` is that of the inserted vertices of a row.
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

fn check_omnee_build(medium: &Medium, step: Step, columns: omnee_sample::BuildColumns<'_, '_>) {
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

fn check_bridge_count(
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

fn check_bridge_build(medium: &Medium, bridge: &Bridge, step: Step, columns: bridge_sample::BuildColumns<'_, '_>) {
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

fn check_lis_vertex(
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

fn check_lis_join(columns: lis_sample::JoinColumns<'_, '_>) {
    let lis_sample::JoinColumns { buckets, ends, candidates, chains } = columns;
    let (kernel, twin) = run_both!(
        lis_join(),
        [candidates, chains],
        lis_sample::JoinColumns { buckets, ends, candidates: &mut *candidates, chains: &mut *chains }
    );
    let chains = (&kernel.1, &twin.1);
    check_chains("lis_join", buckets, 1, (kernel.0, twin.0), chains, |_, _| tolerances::EXACT);
}

fn check_roulette(
    medium: &Medium,
    lights: &Lights,
    threshold: Threshold,
    step: Step,
    columns: roulette::Columns<'_, '_>,
) {
    let roulette::Columns { bucket, candidates, paths } = columns;
    let (kernel, twin) = run_both!(
        roulette(medium, lights, threshold, step),
        [candidates],
        roulette::Columns { bucket, candidates: &mut *candidates, paths }
    );
    let (kernel, twin) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        let (weight, weight_twin) = (f64::from(kernel[at]), f64::from(twin[at]));
        let Tolerance { absolute, relative } = tolerances::CONTRIBUTION;
        if (weight == 0.0) != (weight_twin == 0.0) {
            count_decisions(1);
        } else if (weight - weight_twin).abs() > absolute + relative * weight {
            fail("roulette", at, &format!("    weight: kernel {weight:e}  twin {weight_twin:e}"));
        }
    }
}

fn check_mis_weight(
    medium: &Medium,
    lights: &Lights,
    techniques: &Techniques,
    walk: &Walk,
    lengths: PathLengths,
    step: Step,
    columns: mis_weight::Columns<'_, '_>,
) {
    let mis_weight::Columns { bucket, candidates, chains, paths, vertices, trail, suffix } = columns;
    let (kernel, twin) = run_both!(
        mis_weight(medium, lights, techniques, walk, lengths, step),
        [candidates],
        mis_weight::Columns {
            bucket,
            candidates: &mut *candidates,
            chains,
            paths,
            vertices,
            trail,
            suffix: &mut *suffix
        }
    );
    let sight = Sight { bucket, candidates, chains, paths, vertices, trail, lights, step };
    let (kernel_weights, twin_weights) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        let (weight, weight_twin) = (f64::from(kernel_weights[at]), f64::from(twin_weights[at]));
        let conditioning = sight.conditioning(f64::from(medium.phase.g), at);
        let Tolerance { absolute, relative } = tolerances::WEIGHT;
        let largest = weight.max(weight_twin);
        if (weight == 0.0) != (weight_twin == 0.0) && largest > absolute {
            count_decisions(1);
        } else if (weight - weight_twin).abs() > absolute + (relative + conditioning) * largest {
            let text = format!(
                "    weight: kernel {weight:e}  twin {weight_twin:e}, {} inserted, conditioning {conditioning:e}\n    {:?}\n    {:?}",
                bucket.inserted,
                kernel.0.row(0, at),
                sight.path(at),
            );
            fail("mis_weight", at, &text);
        }
    }
}

/// The complete paths of candidates.
struct Sight<'a, 'q> {
    bucket: Bucket,
    candidates: &'a CandidateQueue<'q>,
    chains: &'a ChainTable<'q>,
    paths: &'a PathTable<'q>,
    vertices: &'a VertexTable<'q>,
    trail: &'a TrailTable<'q>,
    lights: &'a Lights,
    step: Step,
}

impl Sight<'_, '_> {
    /// Vertices from the camera, as far as it is remembered, to the light.
    fn path(&self, at: usize) -> Vec<glam::DVec3> {
        let lane = self.candidates.lane.rows()[at] as usize;
        let depth = self.paths.depth(self.step.clock, lane);
        let before = |back| position_before(self.vertices, self.trail, self.step, lane, back);
        let history = (1..=depth).rev().filter_map(before).map(|position| position.map(|x| x as f32));
        let inserted = self.chains.vertices[..self.bucket.inserted].iter().map(|vertex| vertex.row(at));
        let ends = [self.candidates.start.row(at), self.candidates.point.row(at)];
        let path = history.chain([ends[0]]).chain(inserted).chain([ends[1]]);
        path.map(|position| glam::DVec3::from(position.map(f64::from))).collect()
    }

    fn conditioning(&self, g: f64, at: usize) -> f64 {
        let path = self.path(at);
        let distance = path.iter().map(|position| position.length()).fold(0.0, f64::max);
        let shortest = path.windows(2).map(|ends| ends[0].distance(ends[1])).fold(f64::INFINITY, f64::min);
        let emitter = &self.lights.emitters()[self.candidates.light.rows()[at] as usize];
        let [before, point] = [path[path.len() - 2], path[path.len() - 1]];
        let cos_light = cosine(emitter, point, point - before);
        tolerances::weight_conditioning(g, distance, shortest, cos_light)
    }
}

fn check_occlusion(lights: &Lights, surfaces: &Surfaces, columns: occlusion::Columns<'_, '_>) {
    let occlusion::Columns { bucket, candidates, chains } = columns;
    let before = candidates.weight.rows().to_vec();
    let (kernel, twin) = run_both!(
        occlusion(lights, surfaces),
        [candidates],
        occlusion::Columns { bucket, candidates: &mut *candidates, chains }
    );
    let (kernel, twin) = (kernel.0.reals("weight"), twin.0.reals("weight"));
    for at in bucket.rows() {
        count_rows(1);
        if kernel[at].to_bits() != twin[at].to_bits() {
            count_decisions(1);
        }
        if kernel[at] != 0.0 && kernel[at].to_bits() != before[at].to_bits() {
            fail("occlusion", at, &format!("    a free connection's weight became {}", kernel[at]));
        }
    }
}

fn check_accumulate(
    medium: &Medium,
    lights: &Lights,
    lengths: PathLengths,
    step: Step,
    columns: accumulate::Columns<'_, '_>,
) {
    let accumulate::Columns { bucket, candidates, paths, dropped } = columns;
    let (kernel, twin) = run_both!(
        accumulate(medium, lights, lengths, step),
        [paths, dropped],
        accumulate::Columns { bucket, candidates, paths: &mut *paths, dropped: &mut *dropped }
    );
    for lane in lanes(paths) {
        check_row("accumulate", (0, lane), (&kernel.0, &twin.0), &[("radiance", tolerances::CONTRIBUTION)]);
    }
    if kernel.1 != twin.1 {
        fail("accumulate", 0, &format!("    dropped {:?} and {:?}", kernel.1, twin.1));
    }
}
