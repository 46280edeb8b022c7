//! What becomes of complete candidates.

use fogbow_kernels::accumulate::reference::{contribution, counts};
use fogbow_kernels::columns::paths::{PathTable, VertexTable};
use fogbow_kernels::columns::queues::{Bucket, CandidateQueue, ChainTable};
use fogbow_kernels::columns::trail::TrailTable;
use fogbow_kernels::mis_weight::suffix::Suffix;
use fogbow_kernels::pipeline::{Pipeline, Stage};
use fogbow_kernels::random::Purpose;
use fogbow_kernels::roulette::{self, Threshold};
use fogbow_kernels::{Step, accumulate, mis_weight, occlusion};

use super::rows;
use crate::frame::Frame;
use crate::stats::{Connector, LightByLength, Stats};

/// A weight, a roulette, a shadow test, a contribution.
pub(super) struct Settle<'a, 'q> {
    pub frame: &'a Frame,
    pub pipeline: &'a Pipeline,
    pub step: Step,
    pub paths: &'a mut PathTable<'q>,
    pub vertices: &'a VertexTable<'q>,
    pub trail: &'a TrailTable<'q>,
    pub chains: &'a mut ChainTable<'q>,
    pub suffix: &'a mut Suffix<'q>,
    pub stats: &'a mut Stats,
}

impl<'q> Settle<'_, 'q> {
    /// All of them, for candidates with light points of `purpose` that nothing has traced yet.
    pub fn connection(
        &mut self,
        connector: Connector,
        purpose: Purpose,
        mut bucket: Bucket,
        candidates: &mut CandidateQueue<'q>,
    ) {
        self.count_work(bucket, candidates);
        self.weigh(bucket, candidates);
        let weighted = self.count(bucket, candidates);
        if self.frame.roulette > 0.0 {
            self.drop_faint(purpose, bucket, candidates);
        }
        let kept = self.count(bucket, candidates);
        if !self.frame.surfaces.is_empty() {
            // Tracing is dear, and few may be left.
            bucket = bucket.pack(candidates, self.chains);
            self.stats.work.traced += bucket.len as u64 * (bucket.inserted as u64 + 1);
        }
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

    /// Counts what the connections of a bucket cost, row by row: the sum is the same however rows fall into buckets.
    fn count_work(&mut self, bucket: Bucket, candidates: &CandidateQueue<'q>) {
        let (rows, edges) = (bucket.len as u64, bucket.inserted as u64 + 1);
        let starts = u64::from(self.frame.walk.starts);
        // Starts at depths 1 .. depth + edges - 1, as far as they connect.
        let depth = |lane: &u32| u64::from(self.paths.depth(self.step.clock, *lane as usize));
        let terms = |lane: &u32| (depth(lane) + edges - 1).min(starts);
        let terms: u64 = candidates.lane.rows()[bucket.rows()].iter().map(terms).sum();
        let work = &mut self.stats.work;
        work.connections += rows;
        work.edges += rows * edges;
        work.terms += terms;
    }

    fn drop_faint(&mut self, purpose: Purpose, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, .. } = self;
        let threshold = Threshold { contribution: frame.roulette, purpose };
        self.stats.run(Stage::Roulette, rows(bucket.len), || {
            let columns = roulette::Columns { bucket, candidates, paths };
            (pipeline.roulette)(&frame.medium, &frame.lights, threshold, *step, columns);
        });
    }

    pub fn weigh(&mut self, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, vertices, trail, chains, suffix, .. } = self;
        self.stats.run(Stage::MisWeight, rows(bucket.len), || {
            let columns = mis_weight::Columns { bucket, candidates, chains, paths, vertices, trail, suffix };
            let Frame { medium, lights, techniques, walk, lengths, .. } = frame;
            (pipeline.mis_weight)(medium, lights, techniques, walk, *lengths, *step, columns);
        });
    }

    /// Nothing lies between a point in front of the only disk and that disk, where nothing is solid.
    fn may_be_blocked(&self, bucket: Bucket) -> bool {
        bucket.inserted > 0 || self.frame.lights.emitters().len() > 1 || !self.frame.surfaces.is_empty()
    }

    fn occlude(&mut self, bucket: Bucket, candidates: &mut CandidateQueue<'q>) {
        let Self { frame, pipeline, chains, .. } = self;
        self.stats.run(Stage::Occlusion, rows(bucket.len), || {
            let columns = occlusion::Columns { bucket, candidates, chains };
            (pipeline.occlusion)(&frame.lights, &frame.surfaces, columns);
        });
    }

    pub fn accumulate(&mut self, bucket: Bucket, candidates: &CandidateQueue<'q>) {
        let Self { frame, pipeline, step, paths, .. } = self;
        let mut dropped = self.stats.dropped;
        self.stats.run(Stage::Accumulate, rows(bucket.len), || {
            let columns = accumulate::Columns { bucket, candidates, paths, dropped: &mut dropped };
            (pipeline.accumulate)(&frame.medium, &frame.lights, frame.lengths, *step, columns);
        });
        self.stats.dropped = dropped;
        if let Some(light) = &mut self.stats.light_by_length {
            note_lengths(self.frame, self.paths, self.step, bucket, candidates, light);
        }
    }

    /// Candidates of the bucket that weigh something; only counted if statistics are detailed.
    fn count(&self, bucket: Bucket, candidates: &CandidateQueue<'q>) -> u64 {
        if !self.stats.detailed {
            return 0;
        }
        candidates.weight.rows()[bucket.rows()].iter().filter(|weight| **weight != 0.0).count() as u64
    }
}

/// Notes the contributions of a bucket by the lengths of their paths; a look that is taken at small images only.
fn note_lengths(
    frame: &Frame,
    paths: &PathTable<'_>,
    step: Step,
    bucket: Bucket,
    candidates: &CandidateQueue<'_>,
    light: &mut LightByLength,
) {
    for row in bucket.rows() {
        let (lane, weight) = (candidates.lane.rows()[row] as usize, f64::from(candidates.weight.rows()[row]));
        let depth = paths.depth(step.clock, lane);
        if weight == 0.0 || !weight.is_finite() || !counts(frame.lengths, depth, bucket.inserted) {
            continue;
        }
        let emitter = &frame.lights.emitters()[candidates.emitter.rows()[row] as usize];
        let radiance = emitter.radiance.map(f64::from);
        let throughput = paths.columns.throughput.row(lane).map(f64::from);
        let albedo = frame.medium.albedo.map(f64::from);
        let contribution = contribution(weight, radiance, throughput, albedo, bucket.inserted);
        light.add(depth as usize + bucket.inserted + 1, contribution);
    }
}
