//! The stages that make candidates of lights that were met, and contributions of candidates.

use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::media::field::Field;
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::outline::LOOKS;
use fogbow_kernels::pipeline::Stage;
use fogbow_kernels::random::Purpose;
use fogbow_kernels::roulette::Threshold;
use fogbow_kernels::{accumulate, light_hit, mis_weight, occlusion, phase_quotient, roulette, sift, transmittance};

use super::rows;
use crate::film::aov::Origin;
use crate::wavefront::{Looks, RaysOf, Source, Wavefront};

impl Wavefront<'_> {
    /// Hits become candidates, and end paths.
    pub fn light_hit(&mut self, of: RaysOf) {
        (self.candidates.views.len, self.candidates.light_hits.len) = (0, 0);
        let [before, ray] = self.rays.last_two(self.step.clock);
        let Looks { vertex: from, ray: along, flight: none, lanes, nobody } = &mut self.looks;
        let (vertex, ray, flight, live, outlined, share) = match of {
            RaysOf::Paths => {
                let vertex = self.vertices.at(self.step.clock);
                (vertex, ray, &self.flights.flight, &mut self.live, &self.outlined, 1.0)
            }
            RaysOf::Looks => (&*from, &*along, &*none, lanes, &*nobody, 1.0 / LOOKS as f32),
            RaysOf::First => unreachable!("what comes first is no candidate"),
        };
        self.stats.run(Stage::LightHit, rows(self.hits.len), || {
            let columns = light_hit::Columns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                hits: &self.hits,
                paths: &self.paths,
                vertex,
                ray,
                before,
                flight,
                outlined,
                share,
                live,
                views: &mut self.candidates.views,
                worth: &mut self.worth,
                light_hits: &mut self.candidates.light_hits,
            };
            (self.pipeline.light_hit)(self.step, columns);
        });
    }

    /// Connections that cannot count weigh nothing.
    pub fn sift(&mut self, source: Source, bucket: Bucket) {
        self.stats.run(Stage::Sift, rows(bucket.len), || {
            let columns = sift::Columns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                bucket,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                worth: &mut self.worth,
            };
            (self.pipeline.sift)(self.step, columns);
        });
    }

    /// One weight per candidate, where these starts compete.
    pub fn mis_weight(&mut self, competing: Competing, source: Source, bucket: Bucket) {
        self.stats.run(Stage::MisWeight, rows(bucket.len), || {
            let columns = mis_weight::Columns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                techniques: &self.frame.techniques,
                walk: &self.frame.walk,
                competing,
                lengths: self.frame.lengths,
                solid: self.frame.is_solid(),
                bucket,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                paths: &self.paths,
                log_posterior: &self.log_posterior,
                last_surface: &self.last_surface,
                outlook: &self.outlook,
                vertex: self.vertices.at(self.step.clock),
                trail: &self.trail,
                passages: &self.passages,
                passage_trails: &self.passage_trails,
                suffix: &mut self.suffix,
                worth: &mut self.worth,
            };
            (self.pipeline.mis_weight)(self.step, columns);
        });
    }

    /// What turns count by the phase function of the medium that they are in.
    pub fn phase_quotient(&mut self, source: Source, bucket: Bucket) {
        if self.frame.medium.phases.is_none() {
            return;
        }
        self.stats.run(Stage::PhaseQuotient, rows(bucket.len), || {
            let columns = phase_quotient::Columns {
                medium: &self.frame.medium,
                solid: self.frame.is_solid(),
                bucket,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                paths: &self.paths,
                last_surface: &self.last_surface,
                worth: &mut self.worth,
            };
            (self.pipeline.phase_quotient)(self.step, columns);
        });
    }

    /// Faint connections to light points of `purpose` are dropped.
    pub fn roulette(&mut self, source: Source, bucket: Bucket, purpose: Purpose) {
        self.stats.run(Stage::Roulette, rows(bucket.len), || {
            let columns = roulette::Columns {
                lights: &self.frame.lights,
                threshold: Threshold { contribution: self.frame.roulette, purpose },
                bucket,
                candidates: self.candidates.of(source),
                paths: &self.paths,
                throughput: &self.throughput,
                worth: &mut self.worth,
            };
            (self.pipeline.roulette)(self.step, columns);
        });
    }

    /// Blocked connections count nothing.
    pub fn occlusion(&mut self, source: Source, bucket: Bucket) {
        self.stats.run(Stage::Occlusion, rows(bucket.len), || {
            let columns = occlusion::Columns {
                lights: &self.frame.lights,
                surfaces: &self.frame.surfaces,
                bucket,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                worth: &mut self.worth,
            };
            (self.pipeline.occlusion)(self.step, columns);
        });
    }

    /// What comes through of candidates with light points of `purpose`, where nobody knows how much.
    pub fn transmittance(&mut self, source: Source, bucket: Bucket, purpose: Purpose) {
        let unknown = |field: &&Field| bucket.len > 0 && !field.is_known();
        let Some(field) = self.frame.medium.field().filter(unknown) else { return };
        // Grey light that a walk met has come through.
        let flown = source == Source::LightHits;
        if flown && field.is_grey() {
            return;
        }
        self.stats.run(Stage::Transmittance, rows(bucket.len), || {
            let columns = transmittance::Columns {
                field,
                flown,
                bucket,
                purpose,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                paths: &self.paths,
                immersion: &self.immersion,
                estimates: &mut self.estimates,
                worth: &mut self.worth,
            };
            (self.pipeline.transmittance)(self.step, columns);
        });
    }

    /// Contributions reach their paths.
    pub fn accumulate(&mut self, origin: Origin, source: Source, bucket: Bucket) {
        let (origin, mut dropped) = (self.part_of(origin), self.stats.dropped);
        self.stats.run(Stage::Accumulate, rows(bucket.len), || {
            let columns = accumulate::Columns {
                lights: &self.frame.lights,
                lengths: self.frame.lengths,
                bucket,
                candidates: self.candidates.of(source),
                worth: &self.worth,
                paths: &self.paths,
                throughput: &self.throughput,
                radiance: &mut self.radiance,
                origin,
                parts: &mut self.parts,
                dropped: &mut dropped,
            };
            (self.pipeline.accumulate)(self.step, columns);
        });
        self.stats.dropped = dropped;
    }
}
