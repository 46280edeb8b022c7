//! Making paths of exactly so many vertices, and what they contribute.

use fogbow_kernels::connect::bridge::reference::{self as bridge, Start};
use fogbow_kernels::connect::bridge::sample::reference::{self as bridge_sample, End};
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::density::Density;
use fogbow_kernels::connect::mvnee::reference::{self as mvnee, Settings};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset, sample::reference as mvnee_sample};
use fogbow_kernels::connect::sequence::Draws;
use fogbow_kernels::media::Medium;
use fogbow_kernels::media::reference::Homogeneous;
use fogbow_kernels::phase::reference::{Phase, turn};
use fogbow_kernels::phase::{HenyeyGreenstein, PhaseFunction};
use fogbow_kernels::{PathLengths, medium_sample, random};
use glam::DVec3;

/// Direction in which paths arrive at the start: 45 degrees to the way to the light.
pub const ARRIVING: DVec3 = DVec3::new(0.0, core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2);
const SEED: u32 = 12;

/// A technique, as it makes paths of exactly so many vertices.
pub struct Maker {
    pub name: &'static str,
    pub make: fn(&World, u32) -> Sample,
}

/// A path and the natural logarithm of what it contributes; minus infinity for nothing.
#[derive(Clone)]
pub struct Sample {
    pub path: Vec<DVec3>,
    pub ln: f64,
}

pub const MAKERS: [Maker; 4] = [
    Maker { name: "path tracing and NEE", make: traced },
    Maker { name: "MVNEE", make: mvnee },
    Maker { name: "bridges", make: |world, sample| bridged(world, &world.uniform, sample) },
    Maker { name: "bridges, aligned", make: |world, sample| bridged(world, &world.aligned, sample) },
];

/// What paths are made in.
pub struct World {
    /// Vertices between start and light.
    vertices: usize,
    /// Distance of the light and its radius, in mean free paths of 1 m.
    distance: f64,
    radius: f64,
    phase: HenyeyGreenstein,
    mvnee: Settings,
    uniform: Bridge,
    aligned: Bridge,
}

impl World {
    /// Of paths with so many `vertices` between the start and a light.
    pub fn new(vertices: usize, distance: f64, radius: f64, g: f64) -> Self {
        let medium = Medium::homogeneous(1.0, [1.0; 3], PhaseFunction::henyey_greenstein(g as f32));
        let bridge = |roll| Bridge::new(roll, &medium, vertices as u32 + 2);
        Self {
            vertices,
            distance,
            radius,
            phase: HenyeyGreenstein { g: g as f32 },
            mvnee: Settings::from(&Mvnee::new(&medium, f64::INFINITY, Offset::Ggx)),
            uniform: bridge(Roll::Uniform),
            aligned: bridge(Roll::Aligned),
        }
    }

    fn medium(&self) -> Homogeneous<'_> {
        Homogeneous::new(1.0, &self.phase)
    }

    /// The integrand, for a path from the start to the light.
    fn integrand(&self, path: &[DVec3]) -> Density {
        let mut arriving = ARRIVING;
        let mut value = Density::new(1.0);
        for pair in path.windows(2) {
            let (edge, length) = (pair[1] - pair[0], pair[0].distance(pair[1]));
            let direction = edge / length;
            let density = self.phase.density(arriving.dot(direction));
            value = value.times(density).times_exp(-length).times(1.0 / (length * length));
            arriving = direction;
        }
        // The light faces the start.
        value.times(arriving.z.max(0.0))
    }

    /// Density of MVNEE's making `path`, given its number of vertices. Seeds are as many as there are to be, spread
    /// evenly: flights of a rate at which these are likely, until so many are found, have the same law.
    fn by_mvnee(&self, path: &[DVec3]) -> Density {
        let distance = path[path.len() - 1].length();
        let rate = self.vertices as f64 / distance;
        let density = mvnee::density(&self.mvnee, &Homogeneous::new(rate, &self.phase), path, self.on_light());
        // Over the Poisson probability of that number.
        let mean = rate * distance;
        let ln_factorial: f64 = (1..=self.vertices).map(|k| (k as f64).ln()).sum();
        density.times_exp(-(self.vertices as f64 * mean.ln() - mean - ln_factorial))
    }

    /// The natural logarithm of what `path` would contribute if MVNEE had made it; infinite if it never does.
    pub fn worth_by_mvnee(&self, path: &[DVec3]) -> f64 {
        self.integrand(path).ln() - self.by_mvnee(path).ln()
    }

    /// The point on the light.
    fn light_point(&self, sample: u32) -> DVec3 {
        let [_, _, u, v] = words(sample, 0);
        let (radius, azimuth) = (self.radius * u.sqrt(), core::f64::consts::TAU * v);
        DVec3::new(radius * azimuth.cos(), radius * azimuth.sin(), self.distance)
    }

    /// Its density [1/m^2].
    fn on_light(&self) -> f64 {
        1.0 / (core::f64::consts::PI * self.radius * self.radius)
    }
}

/// What the random numbers of a sample are drawn from.
fn draws(sample: u32) -> Draws {
    Draws { pixel: 0, sample, depth: 1, seed: SEED }
}

/// Four numbers for vertex `depth` of a walk.
fn words(sample: u32, depth: u32) -> [f64; 4] {
    medium_sample::reference::words(1, sample, depth, SEED).map(random::uniform)
}

fn traced(world: &World, sample: u32) -> Sample {
    let (mut path, mut direction) = (vec![DVec3::ZERO], ARRIVING);
    for vertex in 1..=world.vertices as u32 {
        let [length, cosine, azimuth, _] = words(sample, vertex);
        direction = turn(direction, world.phase.sample_cosine(cosine), azimuth);
        path.push(path[path.len() - 1] - (1.0 - length).ln() * direction);
    }
    let point = world.light_point(sample);
    let last = path[world.vertices];
    path.push(point);
    let (edge, length) = (point - last, last.distance(point));
    let worth = world.phase.density(direction.dot(edge / length));
    let worth = worth * (edge.z / length).max(0.0) / (length * length * world.on_light());
    Sample { path, ln: worth.ln() - length }
}

fn mvnee(world: &World, sample: u32) -> Sample {
    let point = world.light_point(sample);
    let rate = world.vertices as f64 / point.length();
    let medium = Homogeneous::new(rate, &world.phase);
    let lengths = PathLengths { min: 1, max: u32::MAX };
    let wanted = |attempt: &u32| {
        let draws = Draws { pixel: 2 + attempt, ..draws(sample) };
        mvnee_sample::count_seeds(&world.mvnee, &medium, DVec3::ZERO, point, lengths, &draws)
            == Some(world.vertices as u32)
    };
    let attempt = (0..).find(wanted).unwrap_or_default();
    let mut inner = vec![DVec3::ZERO; world.vertices];
    let draws = Draws { pixel: 2 + attempt, ..draws(sample) };
    mvnee_sample::place(&world.mvnee, &medium, DVec3::ZERO, point, &draws, &mut inner);
    let path = [&[DVec3::ZERO], inner.as_slice(), &[point]].concat();
    let density = world.by_mvnee(&path);
    sample_of(world, path, density)
}

fn bridged(world: &World, bridge: &Bridge, sample: u32) -> Sample {
    let point = world.light_point(sample);
    let start = Start { depth: 1, position: DVec3::ZERO, arriving: ARRIVING, on_surface: false };
    let mut inner = vec![DVec3::ZERO; world.vertices];
    let end = End { point, normal: Some(DVec3::NEG_Z) };
    let resampling = bridge_sample::place(bridge, &world.phase, &start, &end, &draws(sample), &mut inner);
    let path = [&[DVec3::ZERO], inner.as_slice(), &[point]].concat();
    let (medium, longest) = (world.medium(), world.vertices as u32 + 2);
    let count = bridge::count_probability(bridge, &medium, longest, &start, point, world.vertices as u32 + 1);
    let density = bridge::density(bridge, &medium, longest, &start, &path, world.on_light() / count);
    let Sample { path, ln } = sample_of(world, path, density);
    Sample { path, ln: ln + resampling.ln() }
}

fn sample_of(world: &World, path: Vec<DVec3>, density: Density) -> Sample {
    let ln = if density.is_zero() { f64::NEG_INFINITY } else { world.integrand(&path).ln() - density.ln() };
    Sample { path, ln }
}
