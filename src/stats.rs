//! What a render did: rows, lanes and time per stage, and the fate of connections.

use std::time::Instant;

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::lanes::LaneSet;
use fogbow_kernels::pipeline::Stage;

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
    /// Starts that drew a light point within reach.
    pub tried: u64,
    /// Connections that were built and weighed: not longer than the length limit.
    pub weighted: u64,
    /// Of these, connections that a disk blocked.
    pub occluded: u64,
}

impl ConnectionStats {
    /// Adds other connections.
    pub fn add(&mut self, other: Self) {
        self.tried += other.tried;
        self.weighted += other.weighted;
        self.occluded += other.occluded;
    }
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
    /// Next event estimation; only filled if detailed.
    pub nee: ConnectionStats,
    /// Multiple-vertex next event estimation; only filled if detailed.
    pub mvnee: ConnectionStats,
    /// Contributions that were not finite.
    pub dropped: Dropped,
}

impl Stats {
    /// All zero.
    pub fn new(detailed: bool) -> Self {
        Self {
            detailed,
            samples: 0,
            segments: 0,
            stages: vec![StageStats::default(); Stage::ALL.len()],
            nee: ConnectionStats::default(),
            mvnee: ConnectionStats::default(),
            dropped: Dropped::default(),
        }
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
        self.nee.add(other.nee);
        self.mvnee.add(other.mvnee);
        self.dropped.merge(&other.dropped);
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
