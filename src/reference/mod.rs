//! One path at a time, in f64: the whole renderer as a chain of the stages' twins.
//!
//! It draws the same random bits as the wavefront, so the two agree sample by sample, but for rounding. A walk of
//! segments j = 0, 1, .. tries, in this order, at each of them
//!
//! 1. to survive the vertex it leaves, x_j with j > 0;
//! 2. to meet a light: a view from the camera by expectation, later a candidate path of j + 1 segments;
//! 3. to scatter, or to be reflected by the surface on which the flight ended, unless that was a disk or black or the
//!    walk is over;
//! 4. to connect the new vertex x_{j+1} with a light, once per active technique, if it is among the starts.
//!
//! A first flight that is drawn towards the lights leaves its weight, the density of a free flight over its own, in the
//! throughput of all that follows; a view from the camera needs no flight, and no weight. Where extinction is coloured,
//! every flight leaves one per channel.
//!
//! Whatever made it, a candidate path X of n segments counts `C(X) = Le T factor / (reach(n) + sum of reach(i) r_i)`.
//! Connections play roulette on it before they are tested for occlusion.

use fogbow_kernels::columns::queues::SurfaceHit;
use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::bridge::sample::reference as bridge_sample;
use fogbow_kernels::connect::density::Density;
use fogbow_kernels::connect::light_sample::{Scope, reference as light_sample};
use fogbow_kernels::connect::lis::{Connector, Lis, sample::reference as lis_sample};
use fogbow_kernels::connect::mvnee::Mvnee;
use fogbow_kernels::connect::mvnee::sample::reference as mvnee_sample;
use fogbow_kernels::connect::omnee::sample::reference as omnee_sample;
use fogbow_kernels::connect::sequence::Draws;
use fogbow_kernels::connect::{bridge, lis, nee, omnee};
use fogbow_kernels::emission::reference as emission;
use fogbow_kernels::media::reference::{Homogeneous, Medium as _};
use fogbow_kernels::media::spectral::{CHANNELS, SHARE};
use fogbow_kernels::mis_weight::reference::{Competition, CompletePath, Worth};
use fogbow_kernels::random::Purpose;
use fogbow_kernels::surface::reference as surface_stage;
use fogbow_kernels::{
    PathLengths, accumulate, extend, first_flight, generate, light_hit, medium_sample, occlusion, random, roulette,
    scatter, spectral_weight,
};
use glam::DVec3;

use crate::frame::Frame;

/// What made a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// The walk itself, which met a light.
    Path,
    /// Next event estimation.
    Nee,
    /// Multiple-vertex next event estimation.
    Mvnee,
    /// Once-more next event estimation.
    Omnee,
    /// A bridge.
    Bridge,
    /// Light importance sampling, or its companion.
    Lis,
}

/// What one complete path adds to its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Segments of the path, camera and light segment included.
    pub segments: u32,
    /// What made it.
    pub technique: Technique,
    /// Weighted radiance per channel [W/(m^2 sr)].
    pub radiance: [f64; 3],
}

/// The value of one sample: the sum of its [`contributions`], per channel [W/(m^2 sr)].
pub fn radiance(frame: &Frame, pixel: u32, sample: u32) -> [f64; 3] {
    contributions(frame, pixel, sample).iter().fold([0.0; 3], |sum: [f64; 3], contribution| {
        core::array::from_fn(|channel| sum[channel] + contribution.radiance[channel])
    })
}

/// Everything that the path of `sample` of `pixel` finds.
pub fn contributions(frame: &Frame, pixel: u32, sample: u32) -> Vec<Contribution> {
    let (origin, direction) = generate::reference::camera_ray(&frame.camera, pixel, sample, frame.seed);
    let mut walk = Walk {
        frame,
        pixel,
        sample,
        path: vec![origin],
        direction,
        last_surface: None,
        throughput: [1.0; 3],
        hero: if frame.medium().is_coloured() { generate::reference::hero(pixel, sample, frame.seed) } else { 0 }
            as usize,
        log_posterior: [f64::from(SHARE.ln()); CHANNELS],
        found: Vec::new(),
    };
    for segment in 0..frame.walk_segments() {
        let words = medium_sample::reference::words(pixel, sample, segment, frame.seed);
        if segment > 0 && !medium_sample::reference::survives(&frame.walk, random::uniform(words[3])) {
            break;
        }
        let mut flight = walk.medium().flight(random::uniform(words[0]));
        let aims = segment == 0 && frame.aims();
        if aims {
            flight = walk.aim(flight);
        }
        let (ended, surface) = walk.meet(segment, flight);
        if ended || segment + 1 == frame.walk_segments() {
            break;
        }
        walk.weigh_flight(flight, surface.as_ref(), aims);
        let u = [words[1], words[2]].map(random::uniform);
        match surface {
            Some(hit) if surface_stage::is_black(&frame.surfaces, hit, walk.direction) => break,
            Some(hit) => walk.reflect(hit, u),
            None if frame.medium().never_scatters() => break,
            None => walk.scatter(flight, u),
        }
        if frame.techniques.nee {
            walk.connect_straight(Technique::Nee, nee::SCOPE);
        }
        if let Some(mvnee) = &frame.techniques.mvnee {
            walk.connect_through_medium(mvnee);
        }
        if frame.techniques.omnee {
            walk.connect_once_more();
        }
        if let Some(bridge) = &frame.techniques.bridge {
            walk.connect_by_bridge(bridge);
        }
        if let Some(lis) = &frame.techniques.lis {
            walk.connect_from_light(lis);
        }
        if let Some(scope) = frame.techniques.companion() {
            walk.connect_straight(Technique::Lis, scope);
        }
    }
    walk.found
}

/// The state of the path.
struct Walk<'a> {
    frame: &'a Frame,
    pixel: u32,
    sample: u32,
    /// Vertices so far, the camera first.
    path: Vec<DVec3>,
    /// Direction of the ray that leaves the last vertex.
    direction: DVec3,
    /// Depth of the last vertex on a surface, and the normal there.
    last_surface: Option<(u32, DVec3)>,
    /// Product of the albedos so far, and the weights of flights that were drawn from another density.
    throughput: [f64; 3],
    /// The channel for which flights are drawn.
    hero: usize,
    /// ln of the probability that the path was drawn for a channel, where extinction is coloured.
    log_posterior: [f64; CHANNELS],
    found: Vec<Contribution>,
}

impl Walk<'_> {
    /// The medium around everything, in the channel of the hero.
    fn medium(&self) -> Homogeneous<'_> {
        self.frame.medium().twin(self.hero)
    }

    /// Depth of the last vertex.
    fn depth(&self) -> u32 {
        self.path.len() as u32 - 1
    }

    fn last(&self) -> DVec3 {
        self.path[self.path.len() - 1]
    }

    /// The camera's flight: `free`, or one drawn towards a light.
    fn aim(&self, free: f64) -> f64 {
        let u = first_flight::reference::uniforms(self.pixel, self.sample, self.frame.seed);
        let share = f64::from(self.frame.aimed);
        first_flight::reference::flight(&self.frame.lights, share, self.last(), self.direction, free, u)
    }

    /// Weighs everything that comes after a flight that may have ended on a surface before: the camera's where it was
    /// aimed, and all where extinction is coloured.
    fn weigh_flight(&mut self, flight: f64, surface: Option<&SurfaceHit>, aimed: bool) {
        let Frame { lights, aimed: share, .. } = self.frame;
        let (medium, share, sight) = (self.frame.medium(), f64::from(*share), (self.last(), self.direction));
        let mut quotients = [1.0; CHANNELS];
        if medium.is_coloured() {
            let surface = surface.filter(|_| !aimed);
            let length = surface.map_or(flight, |hit| f64::from(hit.distance));
            let end = sight.0 + length * sight.1;
            let free = spectral_weight::reference::free_flights(medium, sight.0, end, surface.is_none());
            let mixed =
                |c: usize| first_flight::reference::mixed_density(&medium.twin(c), lights, share, sight, flight);
            let drawn = if aimed { [0, 1, 2].map(|c| Density::new(mixed(c))) } else { free };
            (self.log_posterior, quotients) = spectral_weight::reference::update(self.log_posterior, drawn, free);
        } else if aimed {
            quotients = [first_flight::reference::weight(&medium.twin(0), lights, share, sight, flight); CHANNELS];
        }
        for (throughput, quotient) in self.throughput.iter_mut().zip(quotients) {
            *throughput *= quotient;
        }
    }

    /// Adds what the current ray sees of a light; tells whether the path ends on it, or else the surface it meets.
    fn meet(&mut self, segment: u32, flight: f64) -> (bool, Option<SurfaceHit>) {
        let Frame { lights, surfaces, .. } = self.frame;
        let bound = if segment == 0 { f64::INFINITY } else { flight };
        let (light, surface) =
            extend::reference::meet_first(lights, surfaces, self.last(), self.direction, bound, flight);
        let Some((index, distance)) = light else {
            return (false, surface);
        };
        let emitter = &lights.emitters()[index];
        let point = self.last() + distance * self.direction;
        if emission::cosine(emitter, point, self.direction) > 0.0 {
            let worth = match segment {
                0 => {
                    let weight = emission::profile(emitter, point, self.direction);
                    let factor = light_hit::reference::transmittance(self.frame.medium(), self.last(), point);
                    Worth { weight, factor: factor.map(Density::value) }
                }
                _ => self.weigh(index, &[point]),
            };
            self.add(Technique::Path, index, worth, 0);
        }
        (light_hit::reference::ends(emitter, flight, distance), surface)
    }

    /// Appends the vertex on a surface.
    fn reflect(&mut self, hit: SurfaceHit, u: [f64; 2]) {
        let triangle = self.frame.surfaces.geometry().corners(hit.triangle as usize);
        let normal = surface_stage::side(triangle, self.direction);
        let barycentric = [hit.second, hit.third].map(f64::from);
        let clearance = surface_stage::clearance(triangle, barycentric, normal);
        self.path.push(surface_stage::point(triangle, barycentric) + clearance * normal);
        self.direction = surface_stage::reflect(normal, u);
        self.last_surface = Some((self.depth(), normal));
        for (throughput, albedo) in self.throughput.iter_mut().zip(surface_stage::albedo(&self.frame.surfaces, hit)) {
            *throughput *= f64::from(albedo);
        }
    }

    /// Depth of the first vertex that may start a connection.
    fn first_start(&self) -> u32 {
        self.last_surface.map_or(1, |(depth, _)| depth)
    }

    /// Appends the vertex at the end of the flight.
    fn scatter(&mut self, flight: f64, u: [f64; 2]) {
        let medium = self.frame.medium();
        let event = scatter::reference::scatter(medium.phase.twin(), self.last(), self.direction, flight, u);
        self.path.push(event.position);
        self.direction = event.direction;
        for (throughput, albedo) in self.throughput.iter_mut().zip(medium.albedo) {
            *throughput *= f64::from(albedo);
        }
    }

    /// Connects the last vertex in a straight line.
    fn connect_straight(&mut self, technique: Technique, scope: Scope) {
        if let Some((emitter, point)) = self.light_point(scope) {
            self.try_connection(technique, scope.purpose, emitter, &[point]);
        }
    }

    /// Connects the last vertex by multiple-vertex next event estimation.
    fn connect_through_medium(&mut self, mvnee: &Mvnee) {
        let Some((emitter, point)) = self.light_point(mvnee.scope()) else {
            return;
        };
        if let Some(mut rest) = self.seeds_to(mvnee, point, self.frame.lengths, self.frame.seed) {
            rest.push(point);
            self.try_connection(Technique::Mvnee, random::MVNEE_LIGHT, emitter, &rest);
        }
    }

    /// The vertices that multiple-vertex next event estimation inserts between the last one and `point`, in a path of
    /// `lengths` up to there.
    fn seeds_to(&self, mvnee: &Mvnee, point: DVec3, lengths: PathLengths, seed: u32) -> Option<Vec<DVec3>> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed };
        let count = mvnee_sample::count_seeds(&medium, (point - start).length(), lengths, &draws)?;
        let mut inserted = vec![point; count as usize];
        mvnee_sample::place(&mvnee.into(), &medium, start, point, &draws, &mut inserted);
        Some(inserted)
    }

    /// Connects the last vertex through one inserted vertex.
    fn connect_once_more(&mut self) {
        let Some((emitter, point)) = self.light_point(omnee::scope(self.frame.lengths)) else {
            return;
        };
        let u = omnee_sample::uniforms(self.pixel, self.sample, self.depth(), self.frame.seed);
        let vertex = omnee_sample::place(self.frame.medium().phase.twin(), self.last(), point, u);
        self.try_connection(Technique::Omnee, random::OMNEE_LIGHT, emitter, &[vertex, point]);
    }

    /// Connects the last vertex by a bridge.
    fn connect_by_bridge(&mut self, bridge: &Bridge) {
        let Some((emitter, point)) = self.light_point(bridge.scope()) else {
            return;
        };
        if let Some(mut rest) = self.bridge_to(bridge, point, self.frame.lengths, self.frame.seed) {
            rest.push(point);
            self.try_connection(Technique::Bridge, random::BRIDGE_LIGHT, emitter, &rest);
        }
    }

    /// The vertices of a bridge between the last one and `point`, in a path of `lengths` up to there.
    fn bridge_to(&self, bridge: &Bridge, point: DVec3, lengths: PathLengths, seed: u32) -> Option<Vec<DVec3>> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed };
        let arriving = (start - self.path[self.path.len() - 2]).normalize();
        let on_surface = self.first_start() == self.depth() && self.last_surface.is_some();
        let from = bridge::reference::Start { depth: self.depth(), position: start, arriving, on_surface };
        let count = bridge_sample::count_edges(bridge, &medium, lengths, &from, point, &draws)?;
        let mut inserted = vec![point; count as usize];
        bridge_sample::place(bridge, medium.phase, &from, point, &draws, &mut inserted);
        Some(inserted)
    }

    /// Connects the last vertex with one made from a light.
    fn connect_from_light(&mut self, lis: &Lis) {
        let Frame { lights, lengths, seed, .. } = self.frame;
        let Some((emitter, point)) = self.light_point(lis::scope(*lengths)) else {
            return;
        };
        let u = lis_sample::uniforms(self.pixel, self.sample, self.depth(), *seed);
        let vertex = lis_sample::place(&lights.emitters()[emitter], &self.medium(), point, u);
        if !lis_sample::is_within_reach(lis, self.last(), vertex) {
            return;
        }
        let (lengths, seed) = (lis::before_last(*lengths), random::lis_seed(*seed));
        let inserted = match &lis.connector {
            Connector::Bridge(bridge) => self.bridge_to(bridge, vertex, lengths, seed),
            Connector::Mvnee(mvnee) => self.seeds_to(mvnee, vertex, lengths, seed),
        };
        if let Some(mut rest) = inserted {
            rest.extend([vertex, point]);
            self.try_connection(Technique::Lis, random::LIS_LIGHT, emitter, &rest);
        }
    }

    /// The light, and the point on it, that a technique connects the last vertex with, if that is a start.
    fn light_point(&self, scope: Scope) -> Option<(usize, DVec3)> {
        if !light_sample::may_start(scope.from_first(self.frame.walk.starts), self.depth(), self.first_start()) {
            return None;
        }
        let u = light_sample::uniforms(self.pixel, self.sample, self.depth(), scope.purpose, self.frame.seed);
        light_sample::connect(&self.frame.lights, scope, self.last(), u)
    }

    /// Adds the path that goes on from the last vertex through `rest`, whose last point is on the light, if it survives
    /// the roulette and is free. `purpose` is the random dimension of the technique's light point.
    fn try_connection(&mut self, technique: Technique, purpose: Purpose, emitter: usize, rest: &[DVec3]) {
        let mut worth = self.weigh(emitter, rest);
        let contribution = roulette::reference::largest(&self.contribution(emitter, worth));
        let survival = roulette::reference::survival(f64::from(self.frame.roulette), contribution);
        let (pixel, sample, seed) = (self.pixel, self.sample, self.frame.seed);
        if roulette::reference::uniform(pixel, sample, self.depth(), purpose, seed) >= survival {
            return;
        }
        worth.weight /= survival;
        let mut chain = vec![self.last()];
        chain.extend_from_slice(rest);
        let Frame { lights, surfaces, .. } = self.frame;
        let occluded = occlusion::reference::is_occluded(lights, emitter, &chain);
        if !occluded && !occlusion::reference::is_hidden(lights, surfaces, emitter, &chain) {
            self.add(technique, emitter, worth, rest.len() - 1);
        }
    }

    /// What the path counts that goes on from the last vertex through `rest`.
    fn weigh(&self, emitter: usize, rest: &[DVec3]) -> Worth {
        let Frame { lights, techniques, walk, lengths, .. } = self.frame;
        let medium = self.frame.medium();
        let competition = Competition { medium, lights, techniques, walk, lengths: *lengths };
        competition.worth(&CompletePath {
            vertices: &[self.path.as_slice(), rest].concat(),
            first_start: self.first_start() as usize,
            surface: self.last_surface.map(|(_, normal)| normal),
            emitter,
            current: self.depth() as usize,
            log_posterior: self.log_posterior,
        })
    }

    /// What a candidate of this worth adds to the pixel.
    fn contribution(&self, emitter: usize, Worth { weight, factor }: Worth) -> [f64; 3] {
        let emitted = self.frame.lights.emitters()[emitter].radiance.map(f64::from);
        accumulate::reference::contribution(weight, factor, emitted, self.throughput)
    }

    /// Adds a candidate with `inserted` vertices after the last one.
    fn add(&mut self, technique: Technique, emitter: usize, worth: Worth, inserted: usize) {
        if worth.weight == 0.0 || !accumulate::reference::counts(self.frame.lengths, self.depth(), inserted) {
            return;
        }
        let radiance = self.contribution(emitter, worth);
        if radiance.iter().all(|channel| channel.is_finite()) {
            self.found.push(Contribution { segments: self.depth() + inserted as u32 + 1, technique, radiance });
        }
    }
}

#[cfg(test)]
mod tests;
