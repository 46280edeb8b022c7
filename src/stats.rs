//! What a render did: rows, lanes and time per stage, and the fate of connections.

mod by_depth;

use std::time::Instant;

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::connect::Technique;
use fogbow_kernels::lanes::LaneSet;
use fogbow_kernels::pipeline::Stage;

pub use self::by_depth::ByDepth;
use crate::film::{ExactSum, Unit};
use crate::frame::Frame;

/// Work of one stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageStats {
    /// Times the kernel ran.
    pub calls: u64,
    /// Rows that it processed.
    pub rows: u64,
    /// Batches of eight in which these rows stood.
    pub batches: u64,
    /// Time spent, summed over threads `[s]`.
    pub seconds: f64,
}

/// Connections of one technique.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConnectionStats {
    /// Starts that drew a light point within the scope.
    pub tried: u64,
    /// Connections that were built and weighed: not longer than the length limit.
    pub weighted: u64,
    /// Of these, connections that the roulette dropped before they were traced.
    pub faint: u64,
    /// Of the rest, connections that something blocked.
    pub occluded: u64,
}

impl ConnectionStats {
    /// Adds other connections.
    pub fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.weighted += other.weighted;
        self.faint += other.faint;
        self.occluded += other.occluded;
    }
}

/// What connections cost, counted: the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Connections that were built.
    pub connections: u64,
    /// Their edges.
    pub edges: u64,
    /// Starts over which their weights were summed.
    pub terms: u64,
    /// Edges of those that were left when they were to be traced.
    pub traced: u64,
}

/// Counters of one worker, or of all.
#[derive(Clone, Debug, PartialEq)]
pub struct Stats {
    /// Whether stages are timed and the fate of connections is counted.
    pub detailed: bool,
    /// Camera paths.
    pub samples: u64,
    /// Path segments traced.
    pub segments: u64,
    /// One entry for each of [`Stage::ALL`]; only filled if detailed.
    pub stages: Vec<StageStats>,
    /// One entry for each of [`Technique::ALL`]; all but `tried` only filled if detailed.
    pub connections: [ConnectionStats; Technique::ALL.len()],
    /// What connections cost, if anybody asked for it.
    pub work: Option<Work>,
    /// Contributions that were not finite.
    pub dropped: Dropped,
    /// Light by the length of its paths, if anybody asked for it.
    pub light_by_length: Option<LightByLength>,
    /// What walks found by their depth, if anybody asked for it.
    pub by_depth: Option<ByDepth>,
}

/// Contributions of all samples, summed over channels, by the number of segments of their paths; exact, so that it does
/// not depend on the order of work.
#[derive(Clone, Debug, PartialEq)]
pub struct LightByLength {
    unit: Unit,
    sums: Vec<ExactSum>,
}

impl LightByLength {
    /// None so far, of paths of up to `longest` segments in `frame`.
    pub fn new(frame: &Frame) -> Self {
        let sums = vec![ExactSum::default(); frame.lengths.max as usize + 1];
        Self { unit: Unit::for_largest(frame.largest_radiance()), sums }
    }

    /// Adds a contribution of a path of so many segments [W/(m^2 sr)].
    pub fn add(&mut self, segments: usize, contribution: [f64; 3]) {
        self.sums[segments].add(self.unit, contribution.into_iter().sum::<f64>() as f32);
    }

    fn merge(&mut self, other: &Self) {
        self.sums.iter_mut().zip(&other.sums).for_each(|(sum, other)| sum.merge(other));
    }

    /// The sums, by number of segments [W/(m^2 sr)].
    pub fn values(&self) -> Vec<f64> {
        self.sums.iter().map(|sum| sum.mean(self.unit, 1)).collect()
    }
}

impl Stats {
    /// All zero.
    pub fn new(detailed: bool) -> Self {
        Self {
            detailed,
            samples: 0,
            segments: 0,
            stages: vec![StageStats::default(); Stage::ALL.len()],
            connections: [ConnectionStats::default(); Technique::ALL.len()],
            work: None,
            dropped: Dropped::default(),
            light_by_length: None,
            by_depth: None,
        }
    }

    /// The same that also notes the light of `frame` by the length of its paths.
    pub fn by_length(self, frame: &Frame) -> Self {
        Self { light_by_length: Some(LightByLength::new(frame)), ..self }
    }

    /// The same that also counts what connections cost.
    pub fn with_work(self) -> Self {
        Self { work: Some(Work::default()), ..self }
    }

    /// Adds the counters of another worker.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.segments += other.segments;
        for (stage, other) in self.stages.iter_mut().zip(&other.stages) {
            stage.calls += other.calls;
            stage.rows += other.rows;
            stage.batches += other.batches;
            stage.seconds += other.seconds;
        }
        for (stats, other) in self.connections.iter_mut().zip(other.connections) {
            stats.add(other);
        }
        if let (Some(work), Some(other)) = (&mut self.work, other.work) {
            work.connections += other.connections;
            work.edges += other.edges;
            work.terms += other.terms;
            work.traced += other.traced;
        }
        self.dropped.merge(&other.dropped);
        if let (Some(light), Some(other)) = (&mut self.light_by_length, &other.light_by_length) {
            light.merge(other);
        }
        if let (Some(sums), Some(other)) = (&mut self.by_depth, &other.by_depth) {
            sums.merge(other);
        }
    }

    /// The counters of one technique's connections.
    pub fn connections(&mut self, technique: Technique) -> &mut ConnectionStats {
        &mut self.connections[technique as usize]
    }

    /// (rows, batches with a row) of a set of lanes; not counted unless statistics are detailed.
    pub fn lane_rows(&self, lanes: &LaneSet<'_>) -> (usize, usize) {
        if self.detailed { (lanes.count(), lanes.each_batch().count()) } else { (0, 0) }
    }

    /// Runs `kernel`, which processes so many rows in so many batches, and notes it.
    #[inline]
    pub fn run(&mut self, stage: Stage, (rows, batches): (usize, usize), kernel: impl FnOnce()) {
        if !self.detailed {
            return kernel();
        }
        let start = Instant::now();
        kernel();
        let stats = &mut self.stages[stage as usize];
        stats.calls += 1;
        stats.rows += rows as u64;
        stats.batches += batches as u64;
        stats.seconds += start.elapsed().as_secs_f64();
    }
}
