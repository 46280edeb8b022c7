//! Tables filled with rows that no frame would happen to hold: edge values chained with random ones.

use core::f32::consts::FRAC_1_SQRT_2;

use fogbow::frame::Frame;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::columns::paths::{Immersion, LastSurface, Outlook, Path, Ray, Vertex};
use fogbow_kernels::columns::queues::{Flight, Request};
use fogbow_kernels::columns::trail::Mark;
use fogbow_kernels::connect::light_sample::reference::light_sum;
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::random;
use glam::DVec3;

/// Directions along which formulas are tempted to divide by zero.
const DIRECTIONS: [[f32; 3]; 10] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2],
    [0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [1e-4, 0.0, -1.0],
    [0.0, -1e-4, 1.0],
];

/// Random words at the ends and in the middle of the range.
const WORDS: [u32; 6] = [0, 1, 511, 1 << 31, u32::MAX - 512, u32::MAX];

/// A source of reproducible numbers.
pub struct Numbers {
    seed: u32,
    drawn: u32,
}

impl Numbers {
    /// The sequence of `seed`.
    pub fn new(seed: u32) -> Self {
        Self { seed, drawn: 0 }
    }

    /// A random word.
    pub fn word(&mut self) -> u32 {
        self.drawn += 1;
        random::words(self.drawn, 77, 3, self.seed)[1]
    }

    /// A number in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        random::uniform(self.word())
    }

    /// A whole number below `end`.
    pub fn below(&mut self, end: u32) -> u32 {
        (self.uniform() * f64::from(end)) as u32
    }

    /// A point in the cube of side 8 around (0, 0, 2).
    fn point(&mut self) -> DVec3 {
        DVec3::new(0.0, 0.0, 2.0) + 8.0 * (DVec3::new(self.uniform(), self.uniform(), self.uniform()) - 0.5)
    }

    /// A unit vector: every fourth is an edge value.
    fn direction(&mut self) -> [f32; 3] {
        if self.below(4) == 0 {
            return DIRECTIONS[self.below(DIRECTIONS.len() as u32) as usize];
        }
        (self.point() - DVec3::new(0.0, 0.0, 2.0)).normalize().as_vec3().to_array()
    }

    /// Logarithms of three probabilities, which add up to 1; one may be as good as none.
    fn log_posterior(&mut self) -> [f32; 3] {
        let shares = [0, 1, 2].map(|_| if self.below(6) == 0 { 1e-30 } else { self.uniform() });
        let sum: f64 = shares.iter().sum();
        shares.map(|share| (share / sum).ln() as f32)
    }

    fn edge_word(&mut self) -> u32 {
        if self.below(2) == 0 { WORDS[self.below(WORDS.len() as u32) as usize] } else { self.word() }
    }
}

/// Fills all tables of `wavefront` for `frame`, with live paths of any depth in the lanes that `live` names.
pub fn fill(wavefront: &mut Wavefront<'_>, frame: &Frame, seed: u32, live: &[usize]) {
    let numbers = &mut Numbers::new(seed);
    let lanes = wavefront.live.batches() * LANES;
    wavefront.step.clock = 3000 + seed;
    let clock = wavefront.step.clock;
    wavefront.live.clear();
    wavefront.occupied.clear();
    for lane in 0..lanes {
        if live.contains(&lane) {
            wavefront.live.insert(lane);
            wavefront.occupied.insert(lane);
        }
        let depth = numbers.below(frame.walk_segments());
        let sample = numbers.below(1000);
        wavefront.requests.set_row(lane, Request { x: lane as u32, y: 0, sample });
        wavefront.paths.set_row(lane, Path { pixel: lane as u32, sample, birth: clock - depth });
        let hero = if frame.medium.is_coloured() { numbers.below(3) } else { 0 };
        wavefront.immersion.set_row(lane, Immersion { hero });
        wavefront.log_posterior.set_row(lane, numbers.log_posterior());
        let last_surface = if numbers.below(2) == 0 { 0 } else { numbers.below(depth + 1) };
        wavefront.last_surface.set_row(lane, LastSurface { depth: last_surface, normal: numbers.direction() });
        wavefront.throughput.set_row(lane, [0, 1, 2].map(|_| numbers.uniform() as f32));
        wavefront.radiance.set_row(lane, [0, 1, 2].map(|_| numbers.uniform() as f32));
        let flight = Flight {
            flight: (4.0 * numbers.uniform()) as f32,
            cosine: numbers.edge_word(),
            azimuth: numbers.edge_word(),
        };
        wavefront.flights.set_row(lane, flight);
        wavefront.flight_weight.rows_mut()[lane] = numbers.uniform() as f32;
        fill_history(wavefront, frame, numbers, lane, depth);
    }
}

/// A trail of `depth` vertices, the current vertex, and the rays that go with them.
fn fill_history(wavefront: &mut Wavefront<'_>, frame: &Frame, numbers: &mut Numbers, lane: usize, depth: u32) {
    let clock = wavefront.step.clock;
    let points: Vec<DVec3> = (0..=depth).map(|_| numbers.point().as_vec3().as_dvec3()).collect();
    let ray = numbers.direction();
    let mut leaving: Vec<DVec3> = points.windows(2).map(|ends| (ends[1] - ends[0]).normalize()).collect();
    leaving.push(DVec3::from(ray.map(f64::from)));
    let mut arc = 0.0;
    for j in 0..points.len() {
        if j > 1 {
            arc += points[j].distance(points[j - 1]);
        }
        let [position, direction] = [points[j], leaving[j]].map(|v| v.as_vec3().to_array());
        let (arc, light_sum) = (arc as f32, light_sum(&frame.lights, points[j]) as f32);
        let back = points.len() - 1 - j;
        let at = clock - back as u32;
        if back < 2 {
            wavefront.vertices.at_mut(at).set_row(lane, Vertex { position, arc });
        }
        if back == 0 {
            // All remembered vertices may be near a light: the first of them certainly is not too late.
            let first_near = if depth > 0 { 1 } else { u32::MAX };
            wavefront.outlook.set_row(lane, Outlook { light_sum, first_near });
        }
        if (1..wavefront.trail.slots()).contains(&back) {
            wavefront.trail.set_row(lane, at, Mark { position, arc, leaving: direction, light_sum });
        }
    }
    let before = if depth > 0 { leaving[depth as usize - 1] } else { DVec3::Z };
    wavefront.rays.at_mut(clock - 1).set_row(lane, Ray { direction: before.as_vec3().to_array() });
    wavefront.rays.at_mut(clock).set_row(lane, Ray { direction: ray });
}
