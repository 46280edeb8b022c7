//! The stages that make connections.

use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::connect::lis::{Lis, sample as lis_sample};
use fogbow_kernels::connect::nee::SCOPE;
use fogbow_kernels::connect::nee::in_place::{self, Tally};
use fogbow_kernels::connect::omnee::sample as omnee_sample;
use fogbow_kernels::connect::{light_sample, light_survey};
use fogbow_kernels::pipeline::Stage;
use fogbow_kernels::roulette::Threshold;

use super::rows;
use crate::wavefront::Wavefront;

impl Wavefront<'_> {
    /// What the current vertices know of the lights.
    pub fn light_survey(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::LightSurvey, size, || {
            let columns = light_survey::Columns {
                lights: &self.frame.lights,
                near: self.frame.techniques.near(),
                starts: self.frame.walk.starts,
                live: &self.live,
                paths: &self.paths,
                last_surface: &self.last_surface,
                vertex: self.vertices.at(self.step.clock),
                outlook: &mut self.outlook,
            };
            (self.pipeline.light_survey)(self.step, columns);
        });
    }

    /// A light point for every vertex within `scope`.
    pub fn light_sample(&mut self, scope: Scope) {
        self.candidates.connections.len = 0;
        let size = self.stats.lane_rows(&self.live);
        let [ray, _] = self.rays.last_two(self.step.clock);
        self.stats.run(Stage::LightSample, size, || {
            let columns = light_sample::Columns {
                lights: &self.frame.lights,
                scope: scope.from_first(self.frame.walk.starts),
                live: &self.live,
                paths: &self.paths,
                last_surface: &self.last_surface,
                outlook: &self.outlook,
                vertex: self.vertices.at(self.step.clock),
                before: ray,
                connections: &mut self.candidates.connections,
            };
            (self.pipeline.light_sample)(self.step, columns);
        });
    }

    /// Next event estimation at once, where that is all; says how many connections there were. Those that something may
    /// block are listed, where it may.
    pub fn nee(&mut self, blocked: bool) -> Tally {
        let size = self.stats.lane_rows(&self.live);
        let [ray, _] = self.rays.last_two(self.step.clock);
        let contribution = self.frame.roulette;
        let threshold = (contribution > 0.0).then_some(Threshold { contribution, purpose: SCOPE.purpose });
        self.candidates.connections.len = 0;
        let (mut dropped, mut tally) = (self.stats.dropped, Tally::default());
        self.stats.run(Stage::Nee, size, || {
            let columns = in_place::Columns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                walk: &self.frame.walk,
                live: &self.live,
                paths: &self.paths,
                outlook: &self.outlook,
                last_surface: &self.last_surface,
                solid: self.frame.is_solid(),
                blocked,
                threshold,
                vertex: self.vertices.at(self.step.clock),
                before: ray,
                throughput: &self.throughput,
                radiance: &mut self.radiance,
                candidates: &mut self.candidates.connections,
                worth: &mut self.worth,
                dropped: &mut dropped,
                tally: &mut tally,
            };
            (self.pipeline.nee)(self.step, columns);
        });
        self.stats.dropped = dropped;
        tally
    }

    /// Where the one vertex is that OMNEE inserts into every connection.
    pub fn omnee_build(&mut self) {
        self.stats.run(Stage::OmneeBuild, rows(self.candidates.connections.len), || {
            let columns = omnee_sample::BuildColumns {
                medium: &self.frame.medium,
                paths: &self.paths,
                connections: &self.candidates.connections,
                chains: &mut self.chains,
            };
            (self.pipeline.omnee_build)(self.step, columns);
        });
    }

    /// A vertex from the light for every connection of light importance sampling.
    pub fn lis_vertex(&mut self, lis: &Lis) {
        self.stats.run(Stage::LisVertex, rows(self.candidates.connections.len), || {
            let columns = lis_sample::VertexColumns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                lis,
                paths: &self.paths,
                immersion: &self.immersion,
                connections: &mut self.candidates.connections,
                ends: &mut self.ends,
            };
            (self.pipeline.lis_vertex)(self.step, columns);
        });
    }

    /// The light points behind these vertices.
    pub fn lis_join(&mut self) {
        self.stats.run(Stage::LisJoin, rows(self.candidates.bridged.len), || {
            let columns = lis_sample::JoinColumns {
                buckets: &self.buckets,
                ends: &self.ends,
                candidates: &mut self.candidates.bridged,
                chains: &mut self.chains,
            };
            (self.pipeline.lis_join)(self.step, columns);
        });
    }
}
