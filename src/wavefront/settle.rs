//! What becomes of complete candidates.

use fogbow_kernels::accumulate::reference::{contribution, counts};
use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::Connection;
use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::random::Purpose;

use super::{Source, Wavefront};
use crate::film::aov::Origin;

impl Wavefront<'_> {
    /// A sieve, a weight, a roulette, a shadow test, a contribution, for connections that nothing has traced yet.
    pub(super) fn settle(&mut self, connection: &Connection<'_>, source: Source, mut bucket: Bucket) {
        let Connection { technique, scope: Scope { purpose, .. }, .. } = *connection;
        if bucket.len == 0 {
            return; // Paths may be too short for what the technique inserts, and chains with them.
        }
        if self.stats.work.is_some() {
            self.count_work(source, bucket);
        }
        if may_fail(connection, bucket) {
            self.sift(source, bucket);
            bucket = bucket.pack(self.candidates.of_mut(source), &mut self.chains, &mut self.worth);
        }
        let weighted = if self.frame.plays_before_weights() {
            // What falls by what it weighs at most, by the same number, falls by what it weighs.
            let weighted = self.weigh_and_play(Competing::Own, source, bucket, purpose);
            bucket = bucket.pack(self.candidates.of_mut(source), &mut self.chains, &mut self.worth);
            self.count_terms(Competing::All, source, bucket);
            self.weigh_and_play(Competing::All, source, bucket, purpose);
            weighted
        } else {
            self.weigh_and_play(Competing::All, source, bucket, purpose)
        };
        let kept = self.count(bucket);
        if self.frame.is_solid() || self.frame.varies() {
            // Tracing and tracking are dear, and few may be left.
            bucket = bucket.pack(self.candidates.of_mut(source), &mut self.chains, &mut self.worth);
            if let Some(work) = &mut self.stats.work {
                work.traced += bucket.len as u64 * (bucket.inserted as u64 + 1);
            }
        }
        if self.may_be_blocked(bucket) {
            self.occlusion(source, bucket);
        }
        self.transmittance(source, bucket, purpose);
        let free = self.count(bucket);
        self.contribute(Origin::Connection(technique), source, bucket);
        let stats = self.stats.connections(technique);
        stats.weighted += weighted;
        stats.faint += weighted - kept;
        stats.occluded += kept - free;
    }

    /// A weight, where these starts compete, and a roulette. Gives how many connections weigh anything before that; only
    /// counted if statistics are detailed.
    fn weigh_and_play(&mut self, competing: Competing, source: Source, bucket: Bucket, purpose: Purpose) -> u64 {
        self.mis_weight(competing, source, bucket);
        self.phase_quotient(source, bucket);
        let weighted = self.count(bucket);
        if self.frame.roulette > 0.0 {
            self.roulette(source, bucket, purpose);
        }
        weighted
    }

    /// Adds what candidates of this origin count to their paths.
    pub(super) fn contribute(&mut self, origin: Origin, source: Source, bucket: Bucket) {
        self.accumulate(origin, source, bucket);
        if self.stats.light_by_length.is_some() || self.stats.by_depth.is_some() {
            self.note(source, bucket);
        }
    }

    /// Counts what the connections of a bucket cost, row by row: the sum is the same however rows fall into buckets.
    fn count_work(&mut self, source: Source, bucket: Bucket) {
        let (rows, edges) = (bucket.len as u64, bucket.inserted as u64 + 1);
        if let Some(work) = &mut self.stats.work {
            work.connections += rows;
            work.edges += rows * edges;
        }
        let competing = if self.frame.plays_before_weights() { Competing::Own } else { Competing::All };
        self.count_terms(competing, source, bucket);
    }

    /// Counts the starts over which the weights of a bucket are summed, if costs are counted.
    fn count_terms(&mut self, competing: Competing, source: Source, bucket: Bucket) {
        if self.stats.work.is_none() {
            return;
        }
        let terms = match competing {
            Competing::Own => bucket.len as u64,
            Competing::All => self.competing_starts(source, bucket),
        };
        self.stats.work.iter_mut().for_each(|work| work.terms += terms);
    }

    /// Starts of the rows of a bucket: those at depths 1 .. depth + edges - 1, as far as they connect, and are remembered.
    fn competing_starts(&self, source: Source, bucket: Bucket) -> u64 {
        let (frame, edges) = (self.frame, bucket.inserted as u64 + 1);
        let remembered = frame.techniques.most_inserted(frame.lengths.max) as u64 + 1;
        let starts = u64::from(frame.walk.starts);
        let starts = if frame.wanders() { starts.min(remembered) } else { starts };
        let depth = |lane: &u32| u64::from(self.paths.depth_of(self.step.clock, *lane as usize));
        let terms = |lane: &u32| (depth(lane) + edges - 1).min(starts);
        self.candidates.of(source).lane.rows()[bucket.rows()].iter().map(terms).sum()
    }

    /// Nothing lies between a point in front of a light and that light where nothing is solid and lights hide nothing of
    /// each other.
    fn may_be_blocked(&self, bucket: Bucket) -> bool {
        bucket.inserted > 0 || !self.frame.lights.are_clear() || self.frame.is_solid()
    }

    /// Candidates of the bucket that count anything; only counted if statistics are detailed.
    fn count(&self, bucket: Bucket) -> u64 {
        if self.stats.detailed { self.worth.count(bucket) } else { 0 }
    }

    /// Notes what media emitted along flights, by the lengths of their paths and the depths that walks had to get to.
    pub(super) fn note_glow(&mut self) {
        if !self.frame.emits() || self.stats.light_by_length.is_none() && self.stats.by_depth.is_none() {
            return;
        }
        for lane in self.live.each() {
            let segments = self.paths.depth_of(self.step.clock, lane) as usize + 1;
            let found = self.glowing.row(lane).map(f64::from);
            if found == [0.0; 3] {
                continue;
            }
            if let Some(light) = &mut self.stats.light_by_length {
                light.add(segments, found);
            }
            if let Some(sums) = &mut self.stats.by_depth {
                sums.add(segments as u32, found.into_iter().fold(0.0, f64::max));
            }
        }
    }

    /// Notes the contributions of a bucket by the lengths of their paths, and by the depth that walks had to get to;
    /// looks that are taken at small images only.
    fn note(&mut self, source: Source, bucket: Bucket) {
        let candidates = self.candidates.of(source);
        let lanes = &candidates.lane.rows()[bucket.rows()];
        let weights = &self.worth.weight.rows()[bucket.rows()];
        for ((row, lane), weight) in bucket.rows().zip(lanes).zip(weights) {
            let (lane, weight) = (*lane as usize, f64::from(*weight));
            if weight == 0.0 || !weight.is_finite() {
                continue;
            }
            let depth = self.paths.depth_of(self.step.clock, lane);
            if !counts(self.frame.lengths, depth, bucket.inserted) {
                continue;
            }
            let emitter = &self.frame.lights.emitters()[candidates.emitter.rows()[row] as usize];
            let radiance = emitter.radiance.map(f64::from);
            let throughput = self.throughput.row(lane).map(f64::from);
            let factor = self.worth.factor.row(row).map(f64::from);
            let contribution = contribution(weight, factor, radiance, throughput);
            if let Some(light) = &mut self.stats.light_by_length {
                light.add(depth as usize + bucket.inserted + 1, contribution);
            }
            if let Some(sums) = &mut self.stats.by_depth {
                let walked = depth + u32::from(source == Source::LightHits);
                sums.add(walked.max(1), contribution.into_iter().fold(0.0, f64::max));
            }
        }
    }
}

/// Whether connections of a bucket may be found to count nothing before they are weighed: by the vertices that they
/// insert, or as nobody has asked which way the light faces.
fn may_fail(connection: &Connection<'_>, bucket: Bucket) -> bool {
    bucket.inserted > 0 || !(connection.scope.facing || connection.scope.distant)
}
