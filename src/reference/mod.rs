//! One path at a time, in f64: the whole renderer as a chain of the stages' twins.
//!
//! It draws the same random bits as the wavefront, so the two agree sample by sample, but for rounding. A walk of
//! segments j = 0, 1, .. tries, in this order, at each of them
//!
//! 1. to survive the vertex it leaves, x_j with j > 0;
//! 2. to meet a light: a view from the camera by expectation, later a candidate path of j + 1 segments; and what media
//!    emit along the way, as light of a path of as many;
//! 3. to scatter, or to be reflected by the surface on which the flight ended, unless that was a light or black, or
//!    the walk is over;
//! 4. to connect the new vertex x_{j+1} with a light, once per active technique, if it is among the starts.
//!
//! A first flight that is drawn towards the lights leaves its weight, the density of a free flight over its own, in the
//! throughput of all that follows; a view from the camera needs no flight, and no weight. Where extinction is coloured,
//! every flight leaves one per channel.
//!
//! Whatever made it, a candidate path X of n segments counts `C(X) = Le T factor / (reach(n) + sum of reach(i) r_i)`.
//! Connections play roulette on it before they are tested for occlusion.

pub mod chains;
mod connect;

use fogbow_kernels::columns::queues::SurfaceHit;
use fogbow_kernels::connect::Technique;
use fogbow_kernels::connect::density::Density;
use fogbow_kernels::connect::distant;
use fogbow_kernels::connect::sequence::Draws;
use fogbow_kernels::emission::reference as emission;
use fogbow_kernels::first_flight::reference::{mixed_density, mixed_probability};
use fogbow_kernels::media::reference::Twin;
use fogbow_kernels::media::spectral::{CHANNELS, SHARE};
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::mis_weight::reference::{Competition, CompletePath, Worth, reach};
use fogbow_kernels::outline::LOOKS;
use fogbow_kernels::random::Purpose;
use fogbow_kernels::surface::reference as surface_stage;
use fogbow_kernels::{
    accumulate, extend, first_flight, first_surface, flight_hue, generate, glow, light_hit, medium_sample, outline,
    random, scatter, spectral_weight, transmittance,
};
use glam::DVec3;

use crate::frame::Frame;

/// What one complete path adds to its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Segments of the path, camera and light segment included.
    pub segments: u32,
    /// The technique that made it; none where the walk itself met a light or emission.
    pub technique: Option<Technique>,
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
    let mut walk = Walk::leaving(frame, (pixel, sample), origin, direction);
    for segment in 0..frame.walk_segments() {
        let words = medium_sample::reference::words(pixel, sample, segment, frame.seed);
        if segment > 0 && !medium_sample::reference::survives(&frame.walk, segment, random::uniform(words[3])) {
            break;
        }
        let mut flight = walk.fly(random::uniform(words[0]));
        let aims = segment == 0 && frame.aims();
        if aims {
            flight = walk.aim(flight);
        }
        let (ended, surface) = walk.meet(segment, flight);
        walk.glow(ended.or(surface.map(|hit| f64::from(hit.distance))).unwrap_or(flight));
        if ended.is_some() || segment + 1 == frame.walk_segments() {
            break;
        }
        if surface.is_none() && (frame.medium.never_scatters() || flight.is_infinite()) {
            break;
        }
        walk.weigh_flight(flight, surface.as_ref(), aims);
        let u = [words[1], words[2]].map(random::uniform);
        match surface {
            Some(hit) if surface_stage::is_black(&frame.surfaces, hit, walk.direction) => break,
            Some(hit) => walk.reflect(hit, u),
            None => walk.scatter(flight, u),
        }
        walk.connect();
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

impl<'a> Walk<'a> {
    /// A walk with the random numbers of a sample of a pixel that leaves `origin` in the unit `direction`.
    fn leaving(frame: &'a Frame, (pixel, sample): (u32, u32), origin: DVec3, direction: DVec3) -> Self {
        let is_coloured = frame.medium.is_coloured();
        let hero = if is_coloured { generate::reference::hero(pixel, sample, frame.seed) } else { 0 } as usize;
        Self {
            frame,
            pixel,
            sample,
            path: vec![origin],
            direction,
            last_surface: None,
            throughput: [1.0; 3],
            hero,
            log_posterior: [f64::from(SHARE.ln()); CHANNELS],
            found: Vec::new(),
        }
    }
}

impl Walk<'_> {
    /// The medium by which connections are made.
    fn medium(&self) -> Twin<'_> {
        self.frame.medium.twin_of_connections(self.hero)
    }

    /// What the random numbers of the last vertex are drawn from.
    fn draws(&self) -> Draws {
        Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed: self.frame.seed }
    }

    /// Depth of the last vertex.
    fn depth(&self) -> u32 {
        self.path.len() as u32 - 1
    }

    fn last(&self) -> DVec3 {
        self.path[self.path.len() - 1]
    }

    /// A free flight, for a number `u`.
    fn fly(&self, u: f64) -> f64 {
        let ray = (self.last(), self.direction);
        medium_sample::reference::flight(&self.frame.medium, self.hero, ray, u, &self.draws())
    }

    /// The camera's flight: `free`, or one drawn towards a light.
    fn aim(&self, free: f64) -> f64 {
        let u = first_flight::reference::uniforms(self.pixel, self.sample, self.frame.seed);
        let aim = self.frame.aim();
        first_flight::reference::flight(&self.frame.lights, aim, self.last(), self.direction, free, u)
    }

    /// Weighs everything that comes after a flight that may have ended on a surface before: the camera's where it was
    /// aimed, and all where extinction is coloured.
    fn weigh_flight(&mut self, flight: f64, surface: Option<&SurfaceHit>, aimed: bool) {
        let (Frame { lights, medium, .. }, aim) = (self.frame, self.frame.aim());
        let sight = (self.last(), self.direction);
        let mut quotients = [1.0; CHANNELS];
        let length = surface.map_or(flight, |hit| f64::from(hit.distance));
        if medium.is_coloured() {
            let end = sight.0 + length * sight.1;
            let free = spectral_weight::reference::free_flights(medium, sight.0, end, surface.is_none());
            let mixed = if surface.is_some() { mixed_probability } else { mixed_density };
            let mixed = |c: usize| Density::new(mixed(&medium.homogeneous_twin(c), lights, aim, sight, length));
            let drawn = if aimed { [0, 1, 2].map(mixed) } else { free };
            (self.log_posterior, quotients) = spectral_weight::reference::update(self.log_posterior, drawn, free);
            if let Some(field) = medium.field() {
                let missing = flight_hue::reference::missing(field, self.hero, sight.0, end, &self.draws());
                quotients = [0, 1, 2].map(|c| quotients[c] * missing[c]);
            }
        } else if aimed {
            let weight =
                if surface.is_some() { first_surface::reference::weight } else { first_flight::reference::weight };
            quotients = [weight(&medium.homogeneous_twin(0), lights, aim, sight, length); CHANNELS];
        }
        for (throughput, quotient) in self.throughput.iter_mut().zip(quotients) {
            *throughput *= quotient;
        }
    }

    /// Adds what the current ray sees of lights; tells how far away the nearest one is if the path ends on it, or else the
    /// surface it meets.
    fn meet(&mut self, segment: u32, flight: f64) -> (Option<f64>, Option<SurfaceHit>) {
        let Frame { lights, surfaces, .. } = self.frame;
        let bound = if segment == 0 { f64::INFINITY } else { flight };
        let met = extend::reference::meet(lights, surfaces, self.last(), self.direction, bound, flight);
        let mut ended: Option<f64> = None;
        let outlines = self.frame.outlines.as_ref().filter(|_| segment == 0);
        let outlined = outlines.is_some_and(|outlines| outlines.contains(self.pixel));
        if outlined {
            self.look_around();
        }
        for (index, distance) in met.lights {
            if !outlined {
                self.see(segment, index, distance);
            }
            if light_hit::reference::ends(&lights.emitters()[index], flight, distance) {
                ended = Some(ended.map_or(distance, |nearest| nearest.min(distance)));
            }
        }
        (ended, met.surface)
    }

    /// Adds what the current ray sees of one emitter at this distance.
    fn see(&mut self, segment: u32, index: usize, distance: f64) {
        if segment == 0 {
            return self.view(index, (self.last(), self.direction), distance, 1.0);
        }
        let emitter = &self.frame.lights.emitters()[index];
        let point = self.last() + distance * self.direction;
        if emission::cosine(emitter, point, self.direction) > 0.0 {
            let Worth { weight, factor } = self.weigh(index, &[point]);
            let through = self.comes_through(&[self.last(), point], random::CAMERA, Some(self.hero));
            let worth = Worth { weight, factor: [0, 1, 2].map(|c| through[c] * factor[c]) };
            self.add(None, index, worth, 0);
        }
    }

    /// Adds a `share` of what a ray from the camera sees of one emitter at this distance.
    fn view(&mut self, index: usize, (origin, direction): (DVec3, DVec3), distance: f64, share: f64) {
        let lights = &self.frame.lights;
        let emitter = &lights.emitters()[index];
        let point = origin + distance * direction;
        if emission::cosine(emitter, point, direction) > 0.0 {
            let factor = light_hit::reference::transmittance(&self.frame.medium, origin, point);
            let through = self.comes_through(&[origin, point], random::CAMERA, None);
            let colour = distant::reference::colour(lights, index, direction);
            let weight = share * emission::profile(emitter, point, direction);
            let factor = [0, 1, 2].map(|c| through[c] * factor[c].value() * colour[c]);
            self.add(None, index, Worth { weight, factor }, 0);
        }
    }

    /// Adds what the sample sees of lights through all cells of its pixel.
    fn look_around(&mut self) {
        let Frame { camera, lights, surfaces, seed, .. } = self.frame;
        for cell in 0..LOOKS {
            let (origin, direction) = outline::reference::look(camera, self.pixel, self.sample, cell, *seed);
            let met = extend::reference::meet(lights, surfaces, origin, direction, f64::INFINITY, 0.0);
            for (index, distance) in met.lights {
                self.view(index, (origin, direction), distance, 1.0 / f64::from(LOOKS));
            }
        }
    }

    /// Adds what media emit along the way flown.
    fn glow(&mut self, flown: f64) {
        let Some(glow) = &self.frame.medium.glow else { return };
        if !accumulate::reference::counts(self.frame.lengths, self.depth(), 0) {
            return;
        }
        let ray = (self.last(), self.direction);
        let met = glow::reference::along(&self.frame.medium, glow, ray, flown, &self.draws());
        let reached = reach(&self.frame.walk, self.depth() as usize + 1);
        let shares = match self.frame.medium.is_coloured() {
            true => glow::reference::of_hero(self.hero, self.throughput, self.log_posterior),
            false => self.throughput,
        };
        let radiance = [0, 1, 2].map(|c| met[c] * shares[c] / reached);
        if radiance != [0.0; 3] && radiance.iter().all(|channel| channel.is_finite()) {
            self.found.push(Contribution { segments: self.depth() + 1, technique: None, radiance });
        }
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

    /// Whether the last vertex is on a surface.
    fn is_on_surface(&self) -> bool {
        self.last_surface.is_some_and(|(depth, _)| depth == self.depth())
    }

    /// Unit direction in which the path arrives at the last vertex.
    fn arriving(&self) -> DVec3 {
        (self.last() - self.path[self.path.len() - 2]).normalize()
    }

    /// Depth of the first vertex that may start a connection.
    fn first_start(&self) -> u32 {
        self.last_surface.map_or(1, |(depth, _)| depth)
    }

    /// Appends the vertex at the end of the flight.
    fn scatter(&mut self, flight: f64, u: [f64; 2]) {
        let medium = &self.frame.medium;
        let event = scatter::reference::scatter(medium, self.last(), self.direction, flight, u);
        self.path.push(event.position);
        self.direction = event.direction;
        for (throughput, albedo) in self.throughput.iter_mut().zip(medium.albedo_at(event.position)) {
            *throughput *= albedo;
        }
    }

    /// What the path counts that goes on from the last vertex through `rest`.
    fn weigh(&self, emitter: usize, rest: &[DVec3]) -> Worth {
        let Frame { lights, techniques, walk, lengths, .. } = self.frame;
        let medium = &self.frame.medium;
        let competition =
            Competition { medium, lights, techniques, walk, competing: Competing::All, lengths: *lengths };
        competition.worth(&CompletePath {
            vertices: &[self.path.as_slice(), rest].concat(),
            first_start: self.first_start() as usize,
            surface: self.last_surface.map(|(_, normal)| normal),
            emitter,
            current: self.depth() as usize,
            log_posterior: self.log_posterior,
        })
    }

    /// What a chain of segments leaves of light per channel, over what its weight takes that for; relative to the `hero`'s
    /// if its flights have got through.
    pub(super) fn comes_through(&self, chain: &[DVec3], purpose: Purpose, hero: Option<usize>) -> [f64; CHANNELS] {
        let factor = |field| transmittance::reference::factor(field, hero, chain, purpose, &self.draws());
        self.frame.medium.field().map_or([1.0; CHANNELS], factor)
    }

    /// What a candidate of this worth adds to the pixel.
    fn contribution(&self, emitter: usize, Worth { weight, factor }: Worth) -> [f64; 3] {
        let emitted = self.frame.lights.emitters()[emitter].radiance.map(f64::from);
        accumulate::reference::contribution(weight, factor, emitted, self.throughput)
    }

    /// Adds a candidate with `inserted` vertices after the last one.
    fn add(&mut self, technique: Option<Technique>, emitter: usize, worth: Worth, inserted: usize) {
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
