//! Arithmetic stages as anyone would write them first: one row at a time, f32, libm, structures of arrays. What the
//! kernels are measured against.

use core::f32::consts::{PI, TAU};

use fogbow::frame::Frame;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::random;
use glam::Vec3;

/// The columns of the stages, as plain vectors, and the scene.
pub struct State {
    pixel: Vec<u32>,
    sample: Vec<u32>,
    depth: Vec<u32>,
    position: Vec<Vec3>,
    direction: Vec<Vec3>,
    arriving: Vec<Vec3>,
    flight: Vec<f32>,
    words: Vec<[u32; 2]>,
    next_position: Vec<Vec3>,
    next_direction: Vec<Vec3>,
    hits: Vec<(usize, f32)>,
    points: Vec<Vec3>,
    weights: Vec<f32>,
    seed: u32,
    extinction: f32,
    g: f32,
    center: Vec3,
    normal: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    radius: f32,
}

impl State {
    /// Copies the tables of a recorded wavefront.
    pub fn record(w: &Wavefront<'_>, frame: &Frame) -> Self {
        let lanes = w.live.batches() * 8;
        let rows = |row: &dyn Fn(usize) -> Vec3| (0..lanes).map(row).collect::<Vec<_>>();
        let vertices = w.vertices.at(w.step.clock);
        let disk = &frame.lights.emitters()[0];
        let arriving = w.rays.at(w.step.clock - 1);
        Self {
            pixel: w.paths.pixel.rows().to_vec(),
            sample: w.paths.sample.rows().to_vec(),
            depth: (0..lanes).map(|lane| w.paths.depth_of(w.step.clock, lane)).collect(),
            position: rows(&|lane| vertices.position.row(lane).into()),
            direction: rows(&|lane| w.rays.at(w.step.clock).direction.row(lane).into()),
            arriving: rows(&|lane| arriving.direction.row(lane).into()),
            flight: vec![0.5; lanes],
            words: vec![[1 << 30, 1 << 29]; lanes],
            next_position: vec![Vec3::ZERO; lanes],
            next_direction: vec![Vec3::ZERO; lanes],
            hits: Vec::with_capacity(lanes),
            points: vec![disk.origin.into(); lanes],
            weights: vec![0.0; lanes],
            seed: frame.seed,
            extinction: frame.medium.largest_extinction(),
            g: frame.medium.phase.mean_cosine() as f32,
            center: disk.origin.into(),
            normal: disk.normal.into(),
            tangent: disk.tangent.into(),
            bitangent: disk.bitangent.into(),
            radius: disk.radius,
        }
    }

    pub fn medium_sample(&mut self) {
        for i in 0..self.flight.len() {
            let block = random::block(self.depth[i], random::SEGMENT);
            let [flight, cosine, azimuth, _] = random::words(self.pixel[i], self.sample[i], block, self.seed);
            self.flight[i] = -(1.0 - uniform(flight)).ln() / self.extinction;
            self.words[i] = [cosine, azimuth];
        }
    }

    pub fn extend(&mut self) {
        self.hits.clear();
        for i in 0..self.flight.len() {
            let from_center = self.position[i] - self.center;
            let distance = -from_center.dot(self.normal) / self.direction[i].dot(self.normal);
            let across = (from_center + distance * self.direction[i]).length_squared();
            if distance > 0.0 && distance < self.flight[i] && across <= self.radius * self.radius {
                self.hits.push((i, distance));
            }
        }
    }

    pub fn scatter(&mut self) {
        for i in 0..self.flight.len() {
            let direction = self.direction[i];
            self.next_position[i] = self.position[i] + self.flight[i] * direction;
            let [u, v] = self.words[i].map(uniform);
            let root = (1.0 - self.g * self.g) / (1.0 - self.g + 2.0 * self.g * u);
            let cosine = (1.0 + self.g * self.g - root * root) / (2.0 * self.g);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let (sin, cos) = (TAU * v).sin_cos();
            let (tangent, bitangent) = direction.any_orthonormal_pair();
            self.next_direction[i] = cosine * direction + sine * (cos * tangent + sin * bitangent);
        }
    }

    pub fn light_sample(&mut self) {
        for i in 0..self.flight.len() {
            let block = random::block(self.depth[i], random::NEE_LIGHT);
            let [_, radius, azimuth, _] = random::words(self.pixel[i], self.sample[i], block, self.seed);
            let r = self.radius * uniform(radius).sqrt();
            let (sin, cos) = (TAU * uniform(azimuth)).sin_cos();
            self.points[i] = self.center + r * (cos * self.tangent + sin * self.bitangent);
        }
    }

    pub fn weigh_nee(&mut self) {
        for i in 0..self.flight.len() {
            let way = self.points[i] - self.position[i];
            let distance = way.length();
            let direction = way / distance;
            let h = 1.0 + self.g * self.g - 2.0 * self.g * direction.dot(self.arriving[i]);
            let phase = (1.0 - self.g * self.g) / (4.0 * PI * h.powf(1.5));
            let cos_light = -direction.dot(self.normal);
            let area = PI * self.radius * self.radius;
            let ratio = distance * distance * (self.extinction * distance).exp() / (area * phase * cos_light);
            self.weights[i] = if cos_light > 0.0 { 1.0 / (1.0 + ratio) } else { 0.0 };
        }
    }
}

fn uniform(word: u32) -> f32 {
    ((word >> 9) as f32 + 0.5) / (1 << 23) as f32
}
