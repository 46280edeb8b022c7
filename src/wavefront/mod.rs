//! The bounce loop: who reads and who fills.
//!
//! [`Wavefront`] is all state of one worker. Its stages, one method each, are in `stages`: what of the state a kernel
//! may read and fill. `bounce` and `connect` are the order in which they run, `settle` is what becomes of complete
//! candidates.

mod aovs;
mod blocks;
mod bounce;
mod candidates;
mod connect;
mod looks;
mod settle;
mod stages;
mod work;

use core::ops::DerefMut;

use bumpalo::Bump;
use fogbow_kernels::Step;
use fogbow_kernels::columns::parts::PartTable;
use fogbow_kernels::columns::paths::{
    FeatureColumns, ImmersionColumns, LastSurfaceColumns, OutlookColumns, PassageColumns, PathColumns, RayTable,
    VertexTable,
};
use fogbow_kernels::columns::queues::{
    CandidateQueue, ChainTable, EndQueue, EstimateColumns, FlightTable, HitQueue, Request, RequestColumns,
    SurfaceHitQueue, WorthTable,
};
use fogbow_kernels::columns::trail::{PassageTrail, TrailTable};
use fogbow_kernels::columns::{Column, Spectrum};
use fogbow_kernels::connect::bridge::sample::walk::Pieces;
use fogbow_kernels::connect::buckets::BucketTable;
use fogbow_kernels::connect::suffix::Suffix;
use fogbow_kernels::lanes::{self, LANES, LaneSet};
use fogbow_kernels::media::Field;
use fogbow_kernels::pipeline::Pipeline;

pub use self::blocks::Blocks;
use self::blocks::{InFlight, One};
pub use self::candidates::{Candidates, Source};
pub use self::looks::{Looks, RaysOf};
use self::work::Work;
use crate::film::Tile;
use crate::film::aov::{Aov, Origin};
use crate::frame::Frame;
use crate::stats::Stats;

/// Paths in flight per worker, unless their trails would not fit in [`TRAIL_BYTES`]. Connections of one bounce fall into
/// about as many buckets as paths have segments, and a bucket of few rows leaves lanes empty: full buckets are worth more
/// than tables that fit in the second-level cache. Measured with MVNEE, 960, 1536, 2048 and 3072 paths of 15 segments take
/// 1.11, 1.03, 1 and 0.99 times as long; without connections all are alike.
const LANES_PER_WORKER: usize = 2048;

/// Share of vacant lanes, as a divisor, from which on single lanes are refilled. Below it only batches of eight vacant
/// lanes are: paths of one batch that were born together mostly die together, and a batch in step costs a quarter less.
const VACANT_DIVISOR: usize = 4;

/// Bounce clock at which a worker starts: late enough that a look back over all that is remembered stays above zero.
const FIRST_CLOCK: u32 = 1 << 12;

/// Bounce clock from which on a worker takes no more blocks, and starts anew once all paths have ended: early enough for
/// the longest path.
pub const LAST_CLOCK: u32 = 1 << 31;

/// Bytes that the trails of a worker should not exceed.
const TRAIL_BYTES: usize = 8 << 20;

/// Paths in flight per worker for `frame`.
pub fn default_lanes(frame: &Frame) -> usize {
    let bytes_per_path = 32 * remembered(frame).max(1);
    (TRAIL_BYTES / bytes_per_path / LANES * LANES).clamp(64, LANES_PER_WORKER)
}

/// Vertices of a path that some weight may look back at: none if every connection is weighed at its own start alone,
/// and no more than the longest connection could have made, the one before its start included.
fn remembered(frame: &Frame) -> usize {
    if frame.techniques.look_back() { longest_suffix(frame).min(frame.walk_segments() as usize) } else { 0 }
}

/// Vertices of a path that its weight may read, the point on the light left out.
fn longest_suffix(frame: &Frame) -> usize {
    frame.techniques.most_inserted(frame.lengths.max) + 2
}

/// Everything one worker needs to render a frame: tables and queues of fixed capacity in one arena.
pub struct Wavefront<'q> {
    /// The scene.
    pub frame: &'q Frame,
    /// The kernels.
    pub pipeline: Pipeline,
    /// What was done so far.
    pub stats: Stats,
    /// Seed and bounce clock.
    pub step: Step,
    /// The lanes to refill.
    pub requested: LaneSet<'q>,
    /// The sample that each lane takes or has taken.
    pub requests: RequestColumns<'q>,
    /// The slot of the block that it is of.
    pub slots: Column<'q, u32>,
    /// Lanes whose path goes on.
    pub live: LaneSet<'q>,
    /// Lanes whose radiance is not yet on the film: the live ones, and those that ended since it was last collected.
    pub occupied: LaneSet<'q>,
    /// Which sample each path is.
    pub paths: PathColumns<'q>,
    /// What each is in, and for which channel its flights are drawn.
    pub immersion: ImmersionColumns<'q>,
    /// ln of the probability that a path was drawn for a channel, given its way so far; where extinction is coloured.
    pub log_posterior: Spectrum<'q>,
    /// The last surface of each.
    pub last_surface: LastSurfaceColumns<'q>,
    /// What their current vertices know of the lights.
    pub outlook: OutlookColumns<'q>,
    /// Product of f / p of all events so far: albedos, survivals, weights of first flights.
    pub throughput: Spectrum<'q>,
    /// Radiance found so far, in channels in use [W/(m^2 sr)].
    pub radiance: Spectrum<'q>,
    /// The same by what found it, and by the lengths of paths; empty where no layer of the film asks.
    pub parts: PartTable<'q>,
    /// The origins of which there are parts, in their order.
    pub origins: Vec<Origin>,
    /// What the camera sees first; empty where no layer of the film asks.
    pub features: FeatureColumns<'q>,
    /// How far looks at that go `[m]`: without end.
    pub endless: Column<'q, f32>,
    /// Where the paths are.
    pub vertices: VertexTable<'q>,
    /// Their rays.
    pub rays: RayTable<'q>,
    /// Where they were before.
    pub trail: TrailTable<'q>,
    /// What they have passed through, where extinction varies: as many sums as the field has.
    pub passages: Vec<PassageColumns<'q>>,
    /// What they had passed through before.
    pub passage_trails: Vec<PassageTrail<'q>>,
    /// The steps they are about to take.
    pub flights: FlightTable<'q>,
    /// What the first flights count, where extinction is grey.
    pub flight_weight: Column<'q, f32>,
    /// With what density they were drawn for any hero, where it is coloured [1/m].
    pub flight_density: Spectrum<'q>,
    /// How far they go, where media emit `[m]`.
    pub flown: Column<'q, f32>,
    /// What media emit along the way, in channels in use [W/(m^2 sr)].
    pub glowing: Spectrum<'q>,
    /// Lanes of new samples of pixels that outlines of lamps pass through.
    pub outlined: LaneSet<'q>,
    /// By which rays their lamps are seen.
    pub looks: Looks<'q>,
    /// Lanes whose flight ends on a surface.
    pub on_surface: LaneSet<'q>,
    /// Rays that met a light.
    pub hits: HitQueue<'q>,
    /// Rays that end on a surface.
    pub surface_hits: SurfaceHitQueue<'q>,
    /// Complete paths, and those about to be completed.
    pub candidates: Candidates<'q>,
    /// What the candidates at hand count.
    pub worth: WorthTable<'q>,
    /// What comes through one segment of each, where that is not known.
    pub estimates: EstimateColumns<'q>,
    /// Light points behind the connections of light importance sampling, which end at vertices made from them.
    pub ends: EndQueue<'q>,
    /// The connections, by number of inserted vertices.
    pub buckets: BucketTable<'q>,
    /// The inserted vertices of the candidates at hand.
    pub chains: ChainTable<'q>,
    /// Scratch of bridge_build.
    pub pieces: Pieces<'q>,
    /// Scratch of mis_weight.
    pub suffix: Suffix<'q>,
}

impl<'q> Wavefront<'q> {
    /// A worker's state for `frame`, with `lanes` paths in flight (rounded up to whole batches) and nothing counted
    /// yet.
    pub fn new_in(arena: &'q Bump, frame: &'q Frame, pipeline: &Pipeline, lanes: usize) -> Self {
        let lanes = lanes.max(1).next_multiple_of(LANES);
        let channels = frame.channels();
        let longest = frame.techniques.most_inserted(frame.lengths.max);
        let bridged = BucketTable::rows(lanes, longest);
        let met = lanes * frame.lights.most_met();
        let origins = if frame.aovs.has(Aov::Technique) { Origin::of(frame) } else { Vec::new() };
        let sums = frame.medium.field().map_or(0, Field::sums);
        let seen = if frame.aovs.see() { lanes } else { 0 };
        let mut endless = Column::new_in(arena, seen);
        endless.rows_mut().fill(f32::INFINITY);
        Self {
            frame,
            pipeline: *pipeline,
            stats: Stats::new(false),
            step: Step { seed: frame.seed, clock: FIRST_CLOCK },
            requested: LaneSet::new_in(arena, lanes),
            requests: RequestColumns::new_in(arena, lanes),
            slots: Column::new_in(arena, lanes),
            live: LaneSet::new_in(arena, lanes),
            occupied: LaneSet::new_in(arena, lanes),
            paths: PathColumns::new_in(arena, lanes),
            immersion: ImmersionColumns::new_in(arena, lanes),
            log_posterior: Spectrum::new_in(arena, lanes, channels),
            last_surface: LastSurfaceColumns::new_in(arena, lanes),
            outlook: OutlookColumns::new_in(arena, lanes),
            throughput: Spectrum::new_in(arena, lanes, channels),
            radiance: Spectrum::new_in(arena, lanes, channels),
            parts: PartTable::new_in(arena, lanes, channels, origins.len(), frame.aovs.has(Aov::Length)),
            origins,
            features: FeatureColumns::new_in(arena, seen),
            endless,
            vertices: VertexTable::new_in(arena, lanes),
            rays: RayTable::new_in(arena, lanes),
            trail: TrailTable::new_in(arena, lanes, remembered(frame)),
            passages: (0..sums).map(|_| PassageColumns::new_in(arena, lanes)).collect(),
            passage_trails: (0..sums).map(|_| PassageTrail::new_in(arena, lanes, remembered(frame))).collect(),
            flights: FlightTable::new_in(arena, lanes),
            flight_weight: Column::new_in(arena, lanes),
            flight_density: Spectrum::new_in(arena, lanes, channels),
            flown: Column::new_in(arena, if frame.emits() { lanes } else { 0 }),
            glowing: Spectrum::new_in(arena, if frame.emits() { lanes } else { 0 }, channels),
            outlined: LaneSet::new_in(arena, lanes),
            looks: Looks::new_in(arena, if frame.outlines.is_some() { lanes } else { 0 }),
            on_surface: LaneSet::new_in(arena, lanes),
            hits: HitQueue::new_in(arena, met),
            surface_hits: SurfaceHitQueue::new_in(arena, lanes),
            candidates: Candidates {
                views: CandidateQueue::new_in(arena, met),
                light_hits: CandidateQueue::new_in(arena, met),
                connections: CandidateQueue::new_in(arena, lanes),
                bridged: CandidateQueue::new_in(arena, bridged),
            },
            worth: WorthTable::new_in(arena, bridged.max(met), channels),
            estimates: EstimateColumns::new_in(arena, if frame.varies() { bridged.max(met) + LANES } else { 0 }),
            ends: EndQueue::new_in(arena, lanes),
            buckets: BucketTable::new_in(arena, lanes, longest),
            chains: ChainTable::new_in(arena, bridged, longest),
            pieces: Pieces::new_in(arena, longest),
            suffix: Suffix::new_in(arena, longest_suffix(frame)),
        }
    }

    /// Takes the sample numbers `samples` of every pixel of `tile`.
    pub fn render(&mut self, samples: core::ops::Range<u32>, tile: &mut Tile) {
        self.render_while(samples, tile, || true);
    }

    /// The same as long as `goes_on` says so before every segment, and whether it always did: if not, the tile has part
    /// of them, and paths are left in flight.
    pub fn render_while(
        &mut self,
        samples: core::ops::Range<u32>,
        tile: &mut Tile,
        goes_on: impl FnMut() -> bool,
    ) -> bool {
        self.render_blocks(&mut One { block: Some((tile, samples)), goes_on })
    }

    /// Takes the samples of all `blocks`, and says whether they always said to go on. Dead lanes are refilled until
    /// nothing is left.
    pub fn render_blocks<B: Blocks>(&mut self, blocks: &mut B) -> bool {
        let mut in_flight = InFlight::none(blocks.most());
        while blocks.goes_on() {
            self.collect(&mut in_flight);
            in_flight.end(|sums, samples| blocks.end(sums, samples, &mut self.stats));
            self.refill(&mut in_flight, blocks);
            if !self.live.is_empty() {
                self.bounce();
            } else if self.step.clock < LAST_CLOCK {
                return true;
            } else {
                self.step.clock = FIRST_CLOCK;
            }
        }
        false
    }

    /// The same from the start, but for at most `bounces` segments: a look into the middle of a render.
    pub fn advance(&mut self, samples: core::ops::Range<u32>, tile: &mut Tile, bounces: u32) {
        let mut left = 0..bounces;
        self.render_while(samples, tile, || left.next().is_some());
    }

    /// Hands what ended paths have found to their pixels. Where there are no layers but radiance, nothing has to be told
    /// of those that have found none, and most of a batch end together, in one pixel.
    fn collect(&mut self, in_flight: &mut InFlight<impl DerefMut<Target = Tile>>) {
        let has_aovs = !self.frame.aovs.list().is_empty();
        for (b, ended) in self.occupied.batches_without(&self.live) {
            let matter = if has_aovs { ended } else { ended & self.radiance.any_of_batch(b) };
            let first = b * LANES + ended.trailing_zeros() as usize;
            if !has_aovs && ended & !self.beside(b, first) == 0 {
                let tile = in_flight.count(self.slots.rows()[first], ended.count_ones());
                if matter != 0 {
                    let place = self.place(first, tile);
                    tile.add_radiance(place, |channel| self.radiance.rows_of(channel, b, matter));
                }
                continue;
            }
            for lane in lanes::each(ended).map(|i| b * LANES + i) {
                let tile = in_flight.count(self.slots.rows()[lane], 1);
                if matter >> (lane % LANES) & 1 == 0 {
                    continue;
                }
                let place = self.place(lane, tile);
                if has_aovs {
                    self.add_layers(tile, place, lane);
                } else {
                    tile.add(place, &[self.radiance.row(lane)]);
                }
            }
        }
        self.occupied.copy_from(&self.live);
    }

    /// The place in its tile of the pixel whose sample a lane has taken.
    fn place(&self, lane: usize, tile: &Tile) -> usize {
        let Request { x, y, .. } = self.requests.row(lane);
        tile.region().place(x, y)
    }

    /// Rows of batch `b` with samples of the pixel of `lane`, in the same block.
    fn beside(&self, b: usize, lane: usize) -> u32 {
        let Request { x, y, .. } = self.requests.row(lane);
        let block = lanes::equal(self.slots.batch(b), self.slots.rows()[lane] as usize);
        block & lanes::equal(self.requests.x.batch(b), x as usize) & lanes::equal(self.requests.y.batch(b), y as usize)
    }

    /// Starts new paths in vacant lanes.
    fn refill<B: Blocks>(&mut self, in_flight: &mut InFlight<B::Sums>, blocks: &mut B) {
        self.requested.clear();
        self.outlined.clear();
        let capacity = self.live.batches() * LANES;
        let refill_single_lanes = capacity - self.live.count() > capacity / VACANT_DIVISOR;
        let takes_blocks = self.step.clock < LAST_CLOCK;
        let mut count = 0;
        let mut first = 0;
        'batches: while let Some((b, mut vacant)) = self.occupied.vacant_from(first) {
            first = b + 1;
            if vacant != lanes::ALL && !refill_single_lanes {
                continue;
            }
            while vacant != 0 {
                let next = |waits| takes_blocks.then(|| blocks.next(waits, &mut self.stats)).flatten();
                let Some((slot, work)) = in_flight.work(next) else { break 'batches };
                let taken = self.take(b, vacant, slot, work);
                count += u64::from(taken.count_ones());
                vacant &= !taken;
            }
        }
        self.stats.samples += count;
        if count > 0 {
            self.generate();
            self.parts.clear(&self.requested);
        }
    }

    /// Takes samples of the block in this slot, of which some are left, in the `vacant` rows of batch `b`; gives the rows
    /// that have one now.
    #[inline(always)]
    fn take(&mut self, b: usize, vacant: u32, slot: u32, work: &mut Work) -> u32 {
        if vacant == lanes::ALL
            && let Some(first) = work.next_eight()
        {
            self.requests.set_eight(b, first);
            self.slots.rows_mut()[b * LANES..][..LANES].fill(slot);
            self.request(b, lanes::ALL, first);
            return lanes::ALL;
        }
        let mut taken = 0;
        for lane in lanes::each(vacant) {
            let Some(request) = work.next() else { break };
            self.requests.set_row(b * LANES + lane, request);
            self.slots.rows_mut()[b * LANES + lane] = slot;
            self.request(b, 1 << lane, request);
            taken |= 1 << lane;
        }
        taken
    }

    /// Notes that the rows of batch `b` set in `bits` take samples of the pixel of `request`.
    #[inline(always)]
    fn request(&mut self, b: usize, bits: u32, request: Request) {
        self.requested.insert_batch(b, bits);
        let pixel = request.y * self.frame.camera.width + request.x;
        if self.frame.outlines.as_ref().is_some_and(|outlines| outlines.contains(pixel)) {
            self.outlined.insert_batch(b, bits);
        }
    }
}
