//! The bounce loop: who reads and who fills.

use bumpalo::Bump;
use fogbow_kernels::columns::LANES;
use fogbow_kernels::columns::paths::{PathTable, RayTable, VertexTable};
use fogbow_kernels::columns::queues::{
    Bucket, CandidateQueue, ChainTable, FlightTable, HitQueue, Request, RequestTable,
};
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, sample as bridge_sample};
use fogbow_kernels::connect::buckets::BucketTable;
use fogbow_kernels::connect::light_sample::{self, Reach};
use fogbow_kernels::connect::mvnee::{Mvnee, sample as mvnee_sample};
use fogbow_kernels::connect::nee;
use fogbow_kernels::connect::omnee::{self, sample as omnee_sample};
use fogbow_kernels::lanes;
use fogbow_kernels::mis_weight::suffix::Suffix;
use fogbow_kernels::pipeline::{Pipeline, Stage};
use fogbow_kernels::roulette::{self, Threshold};
use fogbow_kernels::{Step, accumulate, extend, generate, light_hit, medium_sample, mis_weight, occlusion, scatter};

use crate::film::{Region, Tile};
use crate::frame::Frame;
use crate::stats::{Connector, Stats};

/// Paths in flight per worker, if the length limit does not make their histories too large. Measured with the columns
/// as they are: 256 to 1024 are equally fast, fewer pay for calls, more for cache misses.
pub const LANES_PER_WORKER: usize = 512;

/// Share of vacant lanes, as a divisor, from which on single lanes are refilled. Below it only batches of eight vacant
/// lanes are: paths of one batch that were born together mostly die together, and a batch in step costs a quarter less.
const VACANT_DIVISOR: usize = 4;

/// Bounce clock at which a block starts: early enough for a long block, late enough that a look back over the longest
/// history stays above zero.
const FIRST_CLOCK: u32 = 1 << 12;

/// Bytes that the histories of a worker should not exceed: half of a 512 KiB second-level cache.
const HISTORY_BYTES: usize = 256 << 10;

/// Paths in flight per worker for `frame`.
pub fn default_lanes(frame: &Frame) -> usize {
    let bytes_per_path = 20 * (remembered(frame) + 2);
    (HISTORY_BYTES / bytes_per_path / LANES * LANES).clamp(64, LANES_PER_WORKER)
}

/// Vertices before the current one that some stage may read.
fn remembered(frame: &Frame) -> usize {
    if frame.techniques.any() { frame.walk_segments().max(2) as usize - 1 } else { 1 }
}

/// All state of one worker: tables and queues of fixed capacity in one arena.
pub struct Wavefront<'q> {
    /// The sample that each lane takes or has taken, and the lanes to refill.
    pub requests: RequestTable<'q>,
    /// The paths.
    pub paths: PathTable<'q>,
    /// Their histories.
    pub vertices: VertexTable<'q>,
    /// Their rays.
    pub rays: RayTable<'q>,
    /// The steps they are about to take.
    pub flights: FlightTable<'q>,
    /// Rays that met a disk.
    pub hits: HitQueue<'q>,
    /// Lights seen by the camera.
    pub views: CandidateQueue<'q>,
    /// Lights hit by scattered paths.
    pub light_hits: CandidateQueue<'q>,
    /// Starts and light points of the technique at hand; of next event estimation these are complete candidates.
    pub connections: CandidateQueue<'q>,
    /// The connections, by number of inserted vertices.
    pub buckets: BucketTable<'q>,
    /// Connections with inserted vertices, bucket by bucket.
    pub bridged: CandidateQueue<'q>,
    /// Their inserted vertices.
    pub chains: ChainTable<'q>,
    /// Scratch of mis_weight.
    pub suffix: Suffix<'q>,
    /// Seed and bounce clock.
    pub step: Step,
}

/// The samples of a block that no lane has taken yet: all samples of a pixel before the next pixel, so that neighbouring
/// lanes see similar things and sums stay in cache.
struct Work {
    region: Region,
    samples: core::ops::Range<u32>,
    next: Request,
}

impl Work {
    fn new(region: Region, samples: core::ops::Range<u32>) -> Self {
        let next = Request { x: region.x0, y: region.y0, sample: samples.start };
        Self { region, samples, next }
    }

    #[inline]
    fn next(&mut self) -> Option<Request> {
        if self.next.y >= self.region.y1 || self.samples.is_empty() {
            return None;
        }
        let request = self.next;
        self.next.sample += 1;
        if self.next.sample == self.samples.end {
            self.next = Request { x: self.next.x + 1, sample: self.samples.start, ..self.next };
        }
        if self.next.x == self.region.x1 {
            self.next = Request { x: self.region.x0, y: self.next.y + 1, ..self.next };
        }
        Some(request)
    }
}

impl<'q> Wavefront<'q> {
    /// A worker's state for `frame`, with `lanes` paths in flight (rounded up to whole batches).
    pub fn new_in(arena: &'q Bump, frame: &Frame, lanes: usize) -> Self {
        let lanes = lanes.max(1).next_multiple_of(LANES);
        let segments = frame.lengths.max as usize;
        let longest = match frame.techniques {
            Techniques { mvnee: None, bridge: None, omnee, .. } => usize::from(omnee),
            _ => segments.saturating_sub(2),
        };
        let bridged = BucketTable::rows(lanes, longest);
        Self {
            requests: RequestTable::new_in(arena, lanes),
            paths: PathTable::new_in(arena, lanes, frame.channels()),
            rays: RayTable::new_in(arena, lanes),
            flights: FlightTable::new_in(arena, lanes),
            hits: HitQueue::new_in(arena, lanes),
            views: CandidateQueue::new_in(arena, lanes),
            light_hits: CandidateQueue::new_in(arena, lanes),
            connections: CandidateQueue::new_in(arena, lanes),
            buckets: BucketTable::new_in(arena, lanes, longest),
            bridged: CandidateQueue::new_in(arena, bridged),
            chains: ChainTable::new_in(arena, bridged, longest),
            suffix: Suffix::new_in(arena, segments),
            step: Step { seed: frame.seed, clock: FIRST_CLOCK },
            vertices: VertexTable::new_in(arena, lanes, remembered(frame)),
        }
    }

    /// Takes the sample numbers `samples` of every pixel of `tile`. Dead lanes are refilled until nothing is left.
    pub fn render(
        &mut self,
        frame: &Frame,
        pipeline: &Pipeline,
        samples: core::ops::Range<u32>,
        tile: &mut Tile,
        stats: &mut Stats,
    ) {
        self.advance(frame, pipeline, samples.clone(), tile, stats, u32::MAX);
        tile.count(samples.len() as u32);
    }

    /// The same from the start, but for at most `bounces` segments: a look into the middle of a render.
    pub fn advance(
        &mut self,
        frame: &Frame,
        pipeline: &Pipeline,
        samples: core::ops::Range<u32>,
        tile: &mut Tile,
        stats: &mut Stats,
        bounces: u32,
    ) {
        self.step.clock = FIRST_CLOCK;
        let mut work = Work::new(tile.region(), samples);
        for _ in 0..bounces {
            self.collect(tile);
            self.refill(frame, pipeline, &mut work, stats);
            if self.paths.live.is_empty() {
                break;
            }
            self.bounce(frame, pipeline, stats);
        }
    }

    /// Hands the radiance of ended paths to their pixels.
    fn collect(&mut self, tile: &mut Tile) {
        let region = tile.region();
        for lane in self.paths.occupied.without(&self.paths.live).map(|lane| lane as usize) {
            let Request { x, y, .. } = self.requests.columns.row(lane);
            tile.add(region.place(x, y), self.paths.columns.radiance.row(lane));
        }
        self.paths.occupied.copy_from(&self.paths.live);
    }

    /// Starts new paths in vacant lanes.
    fn refill(&mut self, frame: &Frame, pipeline: &Pipeline, work: &mut Work, stats: &mut Stats) {
        let Self { requests, paths, vertices, rays, step, .. } = self;
        requests.lanes.clear();
        let capacity = paths.batches() * LANES;
        let refill_single_lanes = capacity - paths.live.count() > capacity / VACANT_DIVISOR;
        let mut count = 0;
        for b in 0..paths.batches() {
            let vacant = !paths.occupied.batch(b) & lanes::ALL;
            if vacant != lanes::ALL && !refill_single_lanes {
                continue;
            }
            for lane in lanes::each(vacant) {
                let Some(request) = work.next() else { break };
                requests.columns.set_row(b * LANES + lane, request);
                requests.lanes.insert((b * LANES + lane) as u32);
                count += 1;
            }
        }
        stats.samples += count;
        if count > 0 {
            let size = stats.lane_rows(&requests.lanes);
            stats.run(Stage::Generate, size, || {
                (pipeline.generate)(&frame.camera, *step, generate::Columns { requests, paths, vertices, rays });
            });
        }
    }

    /// One segment of every live path, and everything that connects from its end.
    pub fn bounce(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        stats.segments += self.paths.live.count() as u64;
        self.fly(frame, pipeline, stats);
        self.extend(frame, pipeline, stats);
        self.hit_lights(frame, pipeline, stats);
        self.paths.end_after(self.step.clock, frame.walk_segments());
        if self.paths.live.is_empty() {
            self.step.clock += 1;
            return;
        }
        self.scatter(frame, pipeline, stats);
        self.step.clock += 1;
        // MVNEE first: it notes which vertices are near a light, and the weights of all candidates rely on that.
        if let Some(mvnee) = frame.techniques.mvnee {
            self.connect_mvnee(frame, pipeline, &mvnee, stats);
        }
        if frame.techniques.nee {
            self.connect_nee(frame, pipeline, stats);
        }
        if frame.techniques.omnee {
            self.connect_omnee(frame, pipeline, stats);
        }
        if let Some(bridge) = frame.techniques.bridge {
            self.connect_bridge(frame, pipeline, &bridge, stats);
        }
    }

    fn fly(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { paths, flights, step, .. } = self;
        let size = stats.lane_rows(&paths.live);
        stats.run(Stage::MediumSample, size, || {
            (pipeline.medium_sample)(&frame.medium, &frame.walk, *step, medium_sample::Columns { paths, flights });
        });
    }

    fn extend(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { paths, vertices, rays, flights, hits, step, .. } = self;
        hits.len = 0;
        let size = stats.lane_rows(&paths.live);
        stats.run(Stage::Extend, size, || {
            (pipeline.extend)(&frame.lights, *step, extend::Columns { paths, vertices, rays, flights, hits });
        });
    }

    /// Lights met on the way: weighed and counted before the other paths scatter.
    fn hit_lights(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { hits, vertices, rays, flights, paths, views, light_hits, chains, suffix, step, .. } = self;
        if hits.len == 0 {
            return;
        }
        (views.len, light_hits.len) = (0, 0);
        stats.run(Stage::LightHit, rows(hits.len), || {
            let columns = light_hit::Columns { hits, vertices, rays, flights, paths, views, light_hits };
            (pipeline.light_hit)(&frame.medium, &frame.lights, *step, columns);
        });
        let bucket = light_hits.direct();
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, chains, suffix, stats };
        settle.weigh(bucket, light_hits);
        settle.accumulate(views.direct(), views);
        settle.accumulate(bucket, light_hits);
    }

    fn scatter(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { flights, paths, vertices, rays, step, .. } = self;
        let size = stats.lane_rows(&paths.live);
        stats.run(Stage::Scatter, size, || {
            (pipeline.scatter)(&frame.medium, *step, scatter::Columns { flights, paths, vertices, rays });
        });
    }

    /// A light point for every vertex within reach.
    fn sample_lights(&mut self, frame: &Frame, pipeline: &Pipeline, reach: Reach, stats: &mut Stats) {
        let Self { paths, vertices, rays, connections, step, .. } = self;
        connections.len = 0;
        let size = stats.lane_rows(&paths.live);
        let reach = reach.from_first(frame.walk.starts);
        stats.run(Stage::LightSample, size, || {
            let columns = light_sample::Columns { paths, vertices, rays, connections };
            (pipeline.light_sample)(&frame.lights, reach, *step, columns);
        });
    }

    fn connect_nee(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, nee::REACH, stats);
        let Self { connections, vertices, paths, chains, suffix, step, .. } = self;
        stats.connections(Connector::Nee).tried += connections.len as u64;
        let bucket = connections.direct();
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, chains, suffix, stats };
        settle.connection(Connector::Nee, bucket, connections);
    }

    fn connect_mvnee(&mut self, frame: &Frame, pipeline: &Pipeline, mvnee: &Mvnee, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, mvnee.reach(), stats);
        let Self { connections, buckets, bridged, paths, chains, step, .. } = self;
        stats.run(Stage::MvneeCount, rows(connections.len), || {
            let columns = mvnee_sample::CountColumns { paths, connections, buckets };
            (pipeline.mvnee_count)(&frame.medium, frame.lengths, *step, columns);
        });
        bridged.len = buckets.sort(connections.len);
        stats.run(Stage::MvneeBuild, rows(bridged.len), || {
            let columns = mvnee_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
            (pipeline.mvnee_build)(&frame.medium, mvnee, *step, columns);
        });
        self.settle_buckets(Connector::Mvnee, frame, pipeline, stats);
    }

    fn connect_bridge(&mut self, frame: &Frame, pipeline: &Pipeline, bridge: &Bridge, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, bridge.reach(), stats);
        let Self { connections, buckets, bridged, paths, chains, step, .. } = self;
        stats.run(Stage::BridgeCount, rows(connections.len), || {
            let columns = bridge_sample::CountColumns { paths, connections, buckets };
            (pipeline.bridge_count)(&frame.medium, bridge, frame.lengths, *step, columns);
        });
        bridged.len = buckets.sort(connections.len);
        stats.run(Stage::BridgeBuild, rows(bridged.len), || {
            let columns = bridge_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
            (pipeline.bridge_build)(&frame.medium, bridge, *step, columns);
        });
        self.settle_buckets(Connector::Bridge, frame, pipeline, stats);
    }

    fn connect_omnee(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, omnee::reach(frame.lengths), stats);
        let Self { connections, vertices, paths, chains, suffix, step, .. } = self;
        stats.connections(Connector::Omnee).tried += connections.len as u64;
        stats.run(Stage::OmneeBuild, rows(connections.len), || {
            let columns = omnee_sample::BuildColumns { paths, connections, chains };
            (pipeline.omnee_build)(&frame.medium, *step, columns);
        });
        let bucket = Bucket { inserted: 1, ..connections.direct() };
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, chains, suffix, stats };
        settle.connection(Connector::Omnee, bucket, connections);
    }

    /// What becomes of connections that were sorted and built.
    fn settle_buckets(&mut self, connector: Connector, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { connections, buckets, bridged, vertices, paths, chains, suffix, step, .. } = self;
        stats.connections(connector).tried += connections.len as u64;
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, chains, suffix, stats };
        for bucket in buckets.buckets().iter().filter(|bucket| bucket.len > 0) {
            settle.connection(connector, *bucket, bridged);
        }
    }
}

/// What becomes of complete candidates: a weight, a shadow test, a contribution.
struct Settle<'a, 'q> {
    frame: &'a Frame,
    pipeline: &'a Pipeline,
    step: Step,
    paths: &'a mut PathTable<'q>,
    vertices: &'a VertexTable<'q>,
    chains: &'a ChainTable<'q>,
    suffix: &'a mut Suffix<'q>,
    stats: &'a mut Stats,
}

impl<'q> Settle<'_, 'q> {
    /// All three, for candidates that nothing has traced yet.
    fn connection(&mut self, connector: Connector, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        self.count_work(bucket, candidates);
        self.weigh(bucket, candidates);
        let weighted = self.count(bucket, candidates);
        if self.frame.roulette > 0.0 {
            self.drop_faint(connector, bucket, candidates);
        }
        let kept = self.count(bucket, candidates);
        if self.may_be_blocked(bucket) {
            self.occlude(bucket, candidates);
        }
        let free = self.count(bucket, candidates);
        self.accumulate(bucket, candidates);
        let stats = self.stats.connections(connector);
        stats.weighted += weighted;
        stats.faint += weighted - kept;
        stats.occluded += kept - free;
    }

    /// Work by arithmetic on whole buckets, but for the depths of the starts.
    fn count_work(&mut self, bucket: Bucket, candidates: &CandidateQueue<'q>) {
        let (rows, edges) = (bucket.len as u64, bucket.inserted as u64 + 1);
        let depths: u64 = candidates.lane.rows()[bucket.rows()]
            .iter()
            .map(|lane| u64::from(self.paths.depth(self.step.clock, *lane as usize)))
            .sum();
        let work = &mut self.stats.work;
        work.connections += rows;
        work.edges += rows * edges;
        // Starts at depths 1 .. depth + edges - 1, as far as they connect.
        work.terms += (depths + rows * (edges - 1)).min(rows * u64::from(self.frame.walk.starts));
    }

    fn drop_faint(&mut self, connector: Connector, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, .. } = self;
        let threshold = Threshold { contribution: frame.roulette, purpose: connector.light_purpose() };
        self.stats.run(Stage::Roulette, rows(bucket.len), || {
            let columns = roulette::Columns { bucket, candidates, paths };
            (pipeline.roulette)(&frame.medium, &frame.lights, threshold, *step, columns);
        });
    }

    fn weigh(&mut self, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, vertices, chains, suffix, .. } = self;
        self.stats.run(Stage::MisWeight, rows(bucket.len), || {
            let columns = mis_weight::Columns { bucket, candidates, chains, paths, vertices, suffix };
            let Frame { medium, lights, techniques, walk, lengths, .. } = frame;
            (pipeline.mis_weight)(medium, lights, techniques, walk, *lengths, *step, columns);
        });
    }

    /// Nothing lies between a point in front of the only disk and that disk.
    fn may_be_blocked(&self, bucket: Bucket) -> bool {
        bucket.inserted > 0 || self.frame.lights.disks().len() > 1
    }

    fn occlude(&mut self, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, chains, .. } = self;
        self.stats.run(Stage::Occlusion, rows(bucket.len), || {
            (pipeline.occlusion)(&frame.lights, occlusion::Columns { bucket, candidates, chains });
        });
    }

    fn accumulate(&mut self, bucket: Bucket, candidates: &CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, .. } = self;
        let mut dropped = self.stats.dropped;
        self.stats.run(Stage::Accumulate, rows(bucket.len), || {
            let columns = accumulate::Columns { bucket, candidates, paths, dropped: &mut dropped };
            (pipeline.accumulate)(&frame.medium, &frame.lights, frame.lengths, *step, columns);
        });
        self.stats.dropped = dropped;
    }

    /// Candidates of the bucket that weigh something; only counted if statistics are detailed.
    fn count(&self, bucket: Bucket, candidates: &CandidateQueue<'q>) -> u64 {
        if !self.stats.detailed {
            return 0;
        }
        candidates.weight.rows()[bucket.rows()].iter().filter(|weight| **weight != 0.0).count() as u64
    }
}

/// (rows, batches) of a queue of `len` rows.
fn rows(len: usize) -> (usize, usize) {
    (len, len.div_ceil(LANES))
}
