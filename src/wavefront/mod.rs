//! The bounce loop: who reads and who fills.

mod connect;
mod settle;

use bumpalo::Bump;
use fogbow_kernels::columns::LANES;
use fogbow_kernels::columns::paths::{PathTable, RayTable, VertexTable};
use fogbow_kernels::columns::queues::{
    CandidateQueue, ChainTable, EndQueue, FlightTable, HitQueue, Request, RequestTable, SurfaceHitQueue,
};
use fogbow_kernels::columns::trail::TrailTable;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::buckets::BucketTable;
use fogbow_kernels::lanes;
use fogbow_kernels::mis_weight::suffix::Suffix;
use fogbow_kernels::pipeline::{Pipeline, Stage};
use fogbow_kernels::{Step, extend, first_flight, generate, light_hit, medium_sample, scatter, surface};

use crate::film::{Region, Tile};
use crate::frame::Frame;
use crate::stats::Stats;
use settle::Settle;

/// Paths in flight per worker. Measured, 512 to 3072 are alike on short paths; more fall out of the cache.
const LANES_PER_WORKER: core::ops::RangeInclusive<usize> = 512..=2048;

/// Paths in flight per segment of the longest path. Connections of one bounce fall into about as many buckets, and a bucket
/// of few rows leaves lanes empty: with 100 segments, 2048 paths render three to four times as fast as 80, although their
/// trails are in no second-level cache.
const LANES_PER_SEGMENT: usize = 64;

/// Share of vacant lanes, as a divisor, from which on single lanes are refilled. Below it only batches of eight vacant
/// lanes are: paths of one batch that were born together mostly die together, and a batch in step costs a quarter less.
const VACANT_DIVISOR: usize = 4;

/// Bounce clock at which a block starts: early enough for a long block, late enough that a look back over the longest
/// history stays above zero.
const FIRST_CLOCK: u32 = 1 << 12;

/// Bytes that the trails of a worker should not exceed.
const TRAIL_BYTES: usize = 8 << 20;

/// Paths in flight per worker for `frame`.
pub fn default_lanes(frame: &Frame) -> usize {
    let bytes_per_path = 32 * remembered(frame).max(1);
    let wanted = LANES_PER_SEGMENT.saturating_mul(frame.lengths.max as usize);
    let wanted = wanted.clamp(*LANES_PER_WORKER.start(), *LANES_PER_WORKER.end());
    (TRAIL_BYTES / bytes_per_path / LANES * LANES).clamp(64, wanted)
}

/// Vertices of a path that some weight may look back at: none if every connection is weighed at its own start alone.
fn remembered(frame: &Frame) -> usize {
    let Techniques { nee: _, mvnee, omnee, bridge, lis } = &frame.techniques;
    let looks_back = mvnee.is_some() || *omnee || bridge.is_some() || lis.is_some();
    if looks_back { frame.walk_segments() as usize } else { 0 }
}

/// All state of one worker: tables and queues of fixed capacity in one arena.
pub struct Wavefront<'q> {
    /// The sample that each lane takes or has taken, and the lanes to refill.
    pub requests: RequestTable<'q>,
    /// The paths.
    pub paths: PathTable<'q>,
    /// Where they are.
    pub vertices: VertexTable<'q>,
    /// Their rays.
    pub rays: RayTable<'q>,
    /// Where they were before.
    pub trail: TrailTable<'q>,
    /// The steps they are about to take.
    pub flights: FlightTable<'q>,
    /// Rays that met a disk.
    pub hits: HitQueue<'q>,
    /// Rays that end on a surface.
    pub surface_hits: SurfaceHitQueue<'q>,
    /// Lights seen by the camera.
    pub views: CandidateQueue<'q>,
    /// Lights hit by scattered paths.
    pub light_hits: CandidateQueue<'q>,
    /// Starts and light points of the technique at hand; of next event estimation these are complete candidates.
    pub connections: CandidateQueue<'q>,
    /// Light points behind the connections of light importance sampling, which end at vertices made from them.
    pub ends: EndQueue<'q>,
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
            Techniques { mvnee: None, bridge: None, lis: None, omnee, .. } => usize::from(omnee),
            _ => segments.saturating_sub(2),
        };
        let bridged = BucketTable::rows(lanes, longest);
        Self {
            requests: RequestTable::new_in(arena, lanes),
            paths: PathTable {
                has_surfaces: !frame.surfaces.is_empty(),
                ..PathTable::new_in(arena, lanes, frame.channels())
            },
            vertices: VertexTable::new_in(arena, lanes),
            rays: RayTable::new_in(arena, lanes),
            trail: TrailTable::new_in(arena, lanes, remembered(frame)),
            flights: FlightTable::new_in(arena, lanes),
            hits: HitQueue::new_in(arena, lanes),
            surface_hits: SurfaceHitQueue::new_in(arena, lanes),
            views: CandidateQueue::new_in(arena, lanes),
            light_hits: CandidateQueue::new_in(arena, lanes),
            connections: CandidateQueue::new_in(arena, lanes),
            ends: EndQueue::new_in(arena, lanes),
            buckets: BucketTable::new_in(arena, lanes, longest),
            bridged: CandidateQueue::new_in(arena, bridged),
            chains: ChainTable::new_in(arena, bridged, longest),
            suffix: Suffix::new_in(arena, segments),
            step: Step { seed: frame.seed, clock: FIRST_CLOCK },
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
            tile.add(region.place(x, y), &[&self.paths.columns.radiance.row(lane)]);
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
        self.trail.remember(self.step.clock, &self.paths.live, &self.vertices, &self.rays);
        self.fly(frame, pipeline, stats);
        self.extend(frame, pipeline, stats);
        self.hit_lights(frame, pipeline, stats);
        self.paths.end_after(self.step.clock, frame.walk_segments());
        if self.paths.live.is_empty() {
            self.step.clock += 1;
            return;
        }
        if frame.medium.never_scatters() {
            self.paths.end_in_medium();
        }
        if frame.aims() {
            self.paths.scale_throughput(&self.requests.lanes, &self.flights.weight);
        }
        self.scatter(frame, pipeline, stats);
        self.reflect(frame, pipeline, stats);
        self.step.clock += 1;
        self.connect(frame, pipeline, stats);
    }

    fn fly(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { requests, paths, vertices, rays, flights, step, .. } = self;
        let size = stats.lane_rows(&paths.live);
        stats.run(Stage::MediumSample, size, || {
            (pipeline.medium_sample)(&frame.medium, &frame.walk, *step, medium_sample::Columns { paths, flights });
        });
        if frame.aims() && !requests.lanes.is_empty() {
            let size = stats.lane_rows(&requests.lanes);
            stats.run(Stage::FirstFlight, size, || {
                let columns = first_flight::Columns { requests, paths, vertices, rays, flights };
                (pipeline.first_flight)(&frame.medium, &frame.lights, frame.aimed, *step, columns);
            });
        }
    }

    fn extend(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { paths, vertices, rays, flights, hits, surface_hits, step, .. } = self;
        (hits.len, surface_hits.len) = (0, 0);
        let size = stats.lane_rows(&paths.live);
        stats.run(Stage::Extend, size, || {
            let columns = extend::Columns { paths, vertices, rays, flights, hits, surface_hits };
            (pipeline.extend)(&frame.lights, &frame.surfaces, *step, columns);
        });
    }

    /// Lights met on the way: weighed and counted before the other paths scatter.
    fn hit_lights(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { hits, vertices, rays, trail, flights, paths, views, light_hits, chains, suffix, step, .. } = self;
        if hits.len == 0 {
            return;
        }
        (views.len, light_hits.len) = (0, 0);
        stats.run(Stage::LightHit, rows(hits.len), || {
            let columns = light_hit::Columns { hits, vertices, rays, flights, paths, views, light_hits };
            (pipeline.light_hit)(&frame.medium, &frame.lights, *step, columns);
        });
        let bucket = light_hits.direct();
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, trail, chains, suffix, stats };
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

    /// Paths that met a surface go on from there.
    fn reflect(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        let Self { surface_hits, flights, paths, vertices, rays, step, .. } = self;
        if surface_hits.len == 0 {
            return;
        }
        stats.run(Stage::Surface, rows(surface_hits.len), || {
            let columns = surface::Columns { surface_hits, flights, paths, vertices, rays };
            (pipeline.surface)(&frame.surfaces, *step, columns);
        });
    }
}

/// (rows, batches) of a queue of `len` rows.
fn rows(len: usize) -> (usize, usize) {
    (len, len.div_ceil(LANES))
}
