//! The stages that take paths from one vertex to the next.

use fogbow_kernels::pipeline::Stage;
use fogbow_kernels::{
    extend, features, first_flight, first_surface, flight_hue, flight_weight, generate, glow, medium_sample, outline,
    passage, prune, remember, scatter, spectral_weight, surface,
};

use super::rows;
use crate::film::aov::Origin;
use crate::wavefront::{RaysOf, Wavefront};

impl Wavefront<'_> {
    /// Camera rays for the requested lanes.
    pub fn generate(&mut self) {
        let size = self.stats.lane_rows(&self.requested);
        let (vertex, ray) = (self.vertices.at_mut(self.step.clock), self.rays.at_mut(self.step.clock));
        self.stats.run(Stage::Generate, size, || {
            let columns = generate::Columns {
                camera: &self.frame.camera,
                medium: &self.frame.medium,
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

    /// Rays through a cell of the pixels that outlines of lamps pass through.
    pub fn outline(&mut self, cell: u32) {
        let size = self.stats.lane_rows(&self.outlined);
        self.looks.lanes.copy_from(&self.outlined);
        self.stats.run(Stage::Outline, size, || {
            let columns = outline::Columns {
                camera: &self.frame.camera,
                cell,
                outlined: &self.outlined,
                requests: &self.requests,
                vertex: &mut self.looks.vertex,
                ray: &mut self.looks.ray,
            };
            (self.pipeline.outline)(self.step, columns);
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
                medium: &self.frame.medium,
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
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                aim: self.frame.aim(),
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

    /// What the camera sees first, of what new rays without end have met; the way up to there goes to the views.
    pub fn features(&mut self) {
        let size = self.stats.lane_rows(&self.requested);
        self.stats.run(Stage::Features, size, || {
            let columns = features::Columns {
                camera: &self.frame.camera,
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                surfaces: &self.frame.surfaces,
                requested: &self.requested,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                flight: &self.flights.flight,
                hits: &self.hits,
                surface_hits: &self.surface_hits,
                features: &mut self.features,
                views: &mut self.candidates.views,
                worth: &mut self.worth,
            };
            (self.pipeline.features)(self.step, columns);
        });
    }

    /// Closest light and closest triangle within the flight.
    pub fn extend(&mut self, of: RaysOf) {
        (self.hits.len, self.surface_hits.len) = (0, 0);
        let (live, vertex, ray, flight) = match of {
            RaysOf::Paths => {
                let clock = self.step.clock;
                (&self.live, self.vertices.at(clock), self.rays.at(clock), &self.flights.flight)
            }
            RaysOf::Looks => (&self.looks.lanes, &self.looks.vertex, &self.looks.ray, &self.looks.flight),
            RaysOf::First => {
                let clock = self.step.clock;
                (&self.requested, self.vertices.at(clock), self.rays.at(clock), &self.endless)
            }
        };
        let size = self.stats.lane_rows(live);
        self.stats.run(Stage::Extend, size, || {
            let columns = extend::Columns {
                lights: &self.frame.lights,
                surfaces: &self.frame.surfaces,
                live,
                paths: &self.paths,
                vertex,
                ray,
                flight,
                on_surface: &mut self.on_surface,
                hits: &mut self.hits,
                surface_hits: &mut self.surface_hits,
            };
            (self.pipeline.extend)(self.step, columns);
        });
    }

    /// What media emit along the flights of live paths goes to their radiance, if any of them does.
    pub fn glow(&mut self) {
        let Some(glow) = &self.frame.medium.glow else { return };
        let size = self.stats.lane_rows(&self.live);
        let (origin, mut dropped) = (self.part_of(Origin::Emission), self.stats.dropped);
        self.stats.run(Stage::Glow, size, || {
            let columns = glow::Columns {
                medium: &self.frame.medium,
                glow,
                lights: &self.frame.lights,
                lengths: self.frame.lengths,
                walk: &self.frame.walk,
                live: &self.live,
                paths: &self.paths,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                flight: &self.flights.flight,
                hits: &self.hits,
                surface_hits: &self.surface_hits,
                throughput: &self.throughput,
                immersion: &self.immersion,
                log_posterior: &self.log_posterior,
                flown: &mut self.flown,
                glowing: &mut self.glowing,
                radiance: &mut self.radiance,
                origin,
                parts: &mut self.parts,
                dropped: &mut dropped,
            };
            (self.pipeline.glow)(self.step, columns);
        });
        self.stats.dropped = dropped;
    }

    /// Paths that have come far enough end.
    pub fn prune(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::Prune, size, || {
            let columns = prune::Columns {
                segments: self.frame.walk_segments(),
                scatters: !self.frame.medium.never_scatters(),
                flights: &self.flights,
                on_surface: &self.on_surface,
                paths: &self.paths,
                live: &mut self.live,
            };
            (self.pipeline.prune)(self.step, columns);
        });
    }

    /// What first flights count that end on a surface.
    pub fn first_surface(&mut self) {
        self.stats.run(Stage::FirstSurface, rows(self.surface_hits.len), || {
            let columns = first_surface::Columns {
                medium: &self.frame.medium,
                lights: &self.frame.lights,
                aim: self.frame.aim(),
                requested: &self.requested,
                surface_hits: &self.surface_hits,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                weight: &mut self.flight_weight,
                density: &mut self.flight_density,
            };
            (self.pipeline.first_surface)(self.step, columns);
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
                medium: &self.frame.medium,
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

    /// What flights leave out of other channels goes to the throughput, where nobody knows how much.
    pub fn flight_hue(&mut self) {
        let Some(field) = self.frame.medium.field().filter(|field| !field.is_known()) else { return };
        let size = self.stats.lane_rows(&self.live);
        self.stats.run(Stage::FlightHue, size, || {
            let columns = flight_hue::Columns {
                field,
                live: &self.live,
                paths: &self.paths,
                immersion: &self.immersion,
                flight: &self.flights.flight,
                surface_hits: &self.surface_hits,
                vertex: self.vertices.at(self.step.clock),
                ray: self.rays.at(self.step.clock),
                estimates: &mut self.estimates,
                throughput: &mut self.throughput,
            };
            (self.pipeline.flight_hue)(self.step, columns);
        });
    }

    /// Next vertex and direction.
    pub fn scatter(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        let (vertex, next) = self.vertices.step(self.step.clock);
        let (ray, next_ray) = self.rays.step(self.step.clock);
        self.stats.run(Stage::Scatter, size, || {
            let columns = scatter::Columns {
                medium: &self.frame.medium,
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

    /// What the paths have passed through on their way to the next vertex.
    pub fn passage(&mut self) {
        let size = self.stats.lane_rows(&self.live);
        let (vertex, next) = self.vertices.step(self.step.clock);
        self.stats.run(Stage::Passage, size, || {
            let columns = passage::Columns {
                medium: &self.frame.medium,
                live: &self.live,
                on_surface: &self.on_surface,
                paths: &self.paths,
                vertex,
                next,
                passages: &mut self.passages,
                trails: &mut self.passage_trails,
            };
            (self.pipeline.passage)(self.step, columns);
        });
    }
}
