//! The stages, one method each: what of the state a kernel may read and fill.

use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::connect::lis::{Lis, sample as lis_sample};
use fogbow_kernels::connect::omnee::sample as omnee_sample;
use fogbow_kernels::connect::{light_sample, light_survey};
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::pipeline::Stage;
use fogbow_kernels::random::Purpose;
use fogbow_kernels::roulette::Threshold;
use fogbow_kernels::{
    accumulate, extend, first_flight, flight_weight, generate, light_hit, medium_sample, mis_weight, occlusion,
    passage, prune, remember, roulette, scatter, spectral_weight, surface, transmittance,
};

use super::{Source, Wavefront};

/// (rows, batches) of a queue of `len` rows.
pub(super) fn rows(len: usize) -> (usize, usize) {
    (len, len.div_ceil(LANES))
}

impl Wavefront<'_> {
    /// Camera rays for the requested lanes.
    pub fn generate(&mut self) {
        let size = self.stats.lane_rows(&self.requested);
        let (vertex, ray) = (self.vertices.at_mut(self.step.clock), self.rays.at_mut(self.step.clock));
        self.stats.run(Stage::Generate, size, || {
            let columns = generate::Columns {
                camera: &self.frame.camera,
                medium: self.frame.medium(),
                requested: &self.requested,
                requests: &self.requests,
                live: &mut self.live,
                occupied: &mut self.occupied,
                paths: &mut self.paths,
                immersion: &mut self.immersion,
                log_posterior: &mut self.log_posterior,
                last_surface: &mut self.last_surface,
                outlook: &mut self.outlook,
                throughput: &mut self.throughput,
                radiance: &mut self.radiance,
                vertex,
                ray,
            };
            (self.pipeline.generate)(self.step, columns);
        });
    }

    /// The current vertices go into the trail, if anything looks back.
    pub fn remember(&mut self) {
        if self.trail.slots() == 0 {
            return;
        }
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::Remember, size, || {
            let columns = remember::Columns {
                live: &self.live,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                outlook: &self.outlook,
                trail: &mut self.trail,
            };
            (self.pipeline.remember)(self.step, columns);
        });
    }

    /// Free flights.
    pub fn medium_sample(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::MediumSample, size, || {
            let columns = medium_sample::Columns {
                medium: self.frame.medium(),
                walk: &self.frame.walk,
                live: &mut self.live,
                paths: &self.paths,
                immersion: &self.immersion,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                flights: &mut self.flights,
            };
            (self.pipeline.medium_sample)(self.step, columns);
        });
    }

    /// First flights towards the lights.
    pub fn first_flight(&mut self) {
        let size = self.stats.lane_rows(&self.requested);
        self.stats.run(Stage::FirstFlight, size, || {
            let columns = first_flight::Columns {
                medium: self.frame.medium(),
                lights: &self.frame.lights,
                share: self.frame.aimed,
                requested: &self.requested,
                paths: &self.paths,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                flight: &mut self.flights.flight,
                weight: &mut self.flight_weight,
                density: &mut self.flight_density,
            };
            (self.pipeline.first_flight)(self.step, columns);
        });
    }

    /// Closest light and closest triangle within the flight.
    pub fn extend(&mut self) {
        (self.hits.len, self.surface_hits.len) = (0, 0);
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::Extend, size, || {
            let columns = extend::Columns {
                lights: &self.frame.lights,
                surfaces: &self.frame.surfaces,
                live: &self.live,
                paths: &self.paths,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                flight: &self.flights.flight,
                on_surface: &mut self.on_surface,
                hits: &mut self.hits,
                surface_hits: &mut self.surface_hits,
            };
            (self.pipeline.extend)(self.step, columns);
        });
    }

    /// Hits become candidates, and end paths.
    pub fn light_hit(&mut self) {
        (self.candidates.views.len, self.candidates.light_hits.len) = (0, 0);
        let [before, ray] = self.rays.last_two(self.step.clock);
        self.stats.run(Stage::LightHit, rows(self.hits.len), || {
            let columns = light_hit::Columns {
                medium: self.frame.medium(),
                lights: &self.frame.lights,
                hits: &self.hits,
                paths: &self.paths,
                vertex: self.vertices.at(self.step.clock),
                ray,
                before,
                flight: &self.flights.flight,
                live: &mut self.live,
                views: &mut self.candidates.views,
                worth: &mut self.worth,
                light_hits: &mut self.candidates.light_hits,
            };
            (self.pipeline.light_hit)(self.step, columns);
        });
    }

    /// Paths that have come far enough end.
    pub fn prune(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::Prune, size, || {
            let columns = prune::Columns {
                segments: self.frame.walk_segments(),
                scatters: !self.frame.medium().never_scatters(),
                flights: &self.flights,
                on_surface: &self.on_surface,
                paths: &self.paths,
                live: &mut self.live,
            };
            (self.pipeline.prune)(self.step, columns);
        });
    }

    /// What first flights count goes to the throughput.
    pub fn flight_weight(&mut self) {
        let size = self.stats.lane_rows(&self.requested);
        self.stats.run(Stage::FlightWeight, size, || {
            let columns = flight_weight::Columns {
                requested: &self.requested,
                live: &self.live,
                weight: &self.flight_weight,
                throughput: &mut self.throughput,
            };
            (self.pipeline.flight_weight)(self.step, columns);
        });
    }

    /// What flights say of their channels goes to the throughput.
    pub fn spectral_weight(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::SpectralWeight, size, || {
            let columns = spectral_weight::Columns {
                medium: self.frame.medium(),
                live: &self.live,
                on_surface: &self.on_surface,
                aimed: self.frame.aims().then_some(&self.requested),
                density: &self.flight_density,
                flight: &self.flights.flight,
                surface_hits: &self.surface_hits,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                log_posterior: &mut self.log_posterior,
                throughput: &mut self.throughput,
            };
            (self.pipeline.spectral_weight)(self.step, columns);
        });
    }

    /// Next vertex and direction.
    pub fn scatter(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        let (vertex, next) = self.vertices.step(self.step.clock);
        let (ray, next_ray) = self.rays.step(self.step.clock);
        self.stats.run(Stage::Scatter, size, || {
            let columns = scatter::Columns {
                medium: self.frame.medium(),
                live: &self.live,
                on_surface: &self.on_surface,
                paths: &self.paths,
                flights: &self.flights,
                vertex,
                next,
                ray,
                next_ray,
                throughput: &mut self.throughput,
            };
            (self.pipeline.scatter)(self.step, columns);
        });
    }

    /// Reflection, for paths that met a surface.
    pub fn surface(&mut self) {
        let (vertex, next) = self.vertices.step(self.step.clock);
        let (ray, next_ray) = self.rays.step(self.step.clock);
        self.stats.run(Stage::Surface, rows(self.surface_hits.len), || {
            let columns = surface::Columns {
                surfaces: &self.frame.surfaces,
                surface_hits: &self.surface_hits,
                paths: &self.paths,
                flights: &self.flights,
                live: &mut self.live,
                last_surface: &mut self.last_surface,
                vertex,
                next,
                ray,
                next_ray,
                throughput: &mut self.throughput,
            };
            (self.pipeline.surface)(self.step, columns);
        });
    }

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

    /// Where the one vertex is that OMNEE inserts into every connection.
    pub fn omnee_build(&mut self) {
        self.stats.run(Stage::OmneeBuild, rows(self.candidates.connections.len), || {
            let columns = omnee_sample::BuildColumns {
                medium: self.frame.medium(),
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
                medium: self.frame.medium(),
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

    /// One weight per candidate.
    pub fn mis_weight(&mut self, source: Source, bucket: Bucket) {
        self.stats.run(Stage::MisWeight, rows(bucket.len), || {
            let columns = mis_weight::Columns {
                medium: self.frame.medium(),
                lights: &self.frame.lights,
                techniques: &self.frame.techniques,
                walk: &self.frame.walk,
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
                passage: &self.passage,
                passage_trail: &self.passage_trail,
                suffix: &mut self.suffix,
                worth: &mut self.worth,
            };
            (self.pipeline.mis_weight)(self.step, columns);
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

    /// What the paths have passed through on their way to the next vertex.
    pub fn passage(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        let (vertex, next) = self.vertices.step(self.step.clock);
        self.stats.run(Stage::Passage, size, || {
            let columns = passage::Columns {
                medium: self.frame.medium(),
                live: &self.live,
                on_surface: &self.on_surface,
                paths: &self.paths,
                vertex,
                next,
                passage: &mut self.passage,
                trail: &mut self.passage_trail,
            };
            (self.pipeline.passage)(self.step, columns);
        });
    }

    /// What comes through of candidates with light points of `purpose`, where nobody knows how much.
    pub fn transmittance(&mut self, source: Source, bucket: Bucket, purpose: Purpose) {
        let Some(grid) = self.frame.medium().grid().filter(|_| bucket.len > 0) else { return };
        self.stats.run(Stage::Transmittance, rows(bucket.len), || {
            let columns = transmittance::Columns {
                grid,
                bucket,
                purpose,
                candidates: self.candidates.of(source),
                chains: &self.chains,
                paths: &self.paths,
                estimates: &mut self.estimates,
                worth: &mut self.worth,
            };
            (self.pipeline.transmittance)(self.step, columns);
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

    /// Contributions reach their paths.
    pub fn accumulate(&mut self, source: Source, bucket: Bucket) {
        let mut dropped = self.stats.dropped;
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
                dropped: &mut dropped,
            };
            (self.pipeline.accumulate)(self.step, columns);
        });
        self.stats.dropped = dropped;
    }
}
