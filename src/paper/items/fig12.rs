//! Paths with exactly 100 vertices between a start and a light, by every technique, and what they contribute.
//!
//! All techniques estimate the same integral over such paths,
//!
//! ```text
//! I = integral of  prod phase(c) mu_s^100 exp(-mu_t L) cos_light / prod l^2
//! ```
//!
//! from the turn at the start on, for a light of radiance 1; a sample is the integrand over the density of making the
//! path, given that it has 100 vertices. Path tracing draws all of them and connects the last one with the light.

use fogbow_kernels::connect::bridge::reference::{self as bridge, Start};
use fogbow_kernels::connect::bridge::{Bridge, Roll, sample::reference as bridge_sample};
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

use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::section::{Plot, Section, Table};
use crate::plot::{self, Axis, Chart, Corner, Curve, Look, Panel, Range};

const NAME: &str = "fig12";
/// Vertices between start and light.
const VERTICES: usize = 100;
/// Mean cosine.
const G: f64 = 0.9;
/// Distance of the light in mean free paths of 1 m, and its radius `[m]`.
const DISTANCE: f64 = 15.0;
const RADIUS: f64 = 2.0;
/// Direction in which the path arrives at the start: 45 degrees to the way to the light.
const ARRIVING: DVec3 = DVec3::new(0.0, core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2);
/// Samples of each technique.
const SAMPLES: u32 = 40_000;
/// Paths that are drawn.
const DRAWN: usize = 10;
const SEED: u32 = 12;

/// A technique, as it makes paths of exactly so many vertices.
struct Maker {
    name: &'static str,
    make: fn(&World, u32) -> Sample,
}

/// A path and the natural logarithm of what it contributes; minus infinity for nothing.
struct Sample {
    path: Vec<DVec3>,
    ln: f64,
}

const MAKERS: [Maker; 4] = [
    Maker { name: "path tracing and NEE", make: traced },
    Maker { name: "MVNEE", make: mvnee },
    Maker { name: "bridges", make: |world, sample| bridged(world, &world.uniform, sample) },
    Maker { name: "bridges, aligned", make: |world, sample| bridged(world, &world.aligned, sample) },
];

/// What paths are made in.
struct World {
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
    fn new(vertices: usize, distance: f64, radius: f64, g: f64) -> Self {
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

/// Seeds are as many as there are to be, spread evenly: flights of a rate at which these are likely, until so many are
/// found, have the same law.
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
    let density = mvnee::density(&world.mvnee, &medium, &path, world.on_light());
    // Given their number: over its Poisson probability.
    let mean = rate * point.length();
    let ln_factorial: f64 = (1..=world.vertices).map(|k| (k as f64).ln()).sum();
    let ln_count = world.vertices as f64 * mean.ln() - mean - ln_factorial;
    sample_of(world, path, density.times_exp(-ln_count))
}

fn bridged(world: &World, bridge: &Bridge, sample: u32) -> Sample {
    let point = world.light_point(sample);
    let start = Start { depth: 1, position: DVec3::ZERO, arriving: ARRIVING, on_surface: false };
    let mut inner = vec![DVec3::ZERO; world.vertices];
    bridge_sample::place(bridge, &world.phase, &start, point, &draws(sample), &mut inner);
    let path = [&[DVec3::ZERO], inner.as_slice(), &[point]].concat();
    let (medium, longest) = (world.medium(), world.vertices as u32 + 2);
    let count = bridge::count_probability(bridge, &medium, longest, &start, point, world.vertices as u32 + 1);
    let density = bridge::density(bridge, &medium, longest, &start, &path, world.on_light() / count);
    sample_of(world, path, density)
}

fn sample_of(world: &World, path: Vec<DVec3>, density: Density) -> Sample {
    let ln = if density.is_zero() { f64::NEG_INFINITY } else { world.integrand(&path).ln() - density.ln() };
    Sample { path, ln }
}

/// All samples of a technique, and their sums.
struct Made {
    name: &'static str,
    samples: Vec<Sample>,
}

impl Made {
    /// Mean and standard error, as multiples of e to the power `unit`.
    fn mean(&self, unit: f64) -> (f64, f64) {
        let count = self.samples.len() as f64;
        let (sum, squares) = self
            .samples
            .iter()
            .map(|sample| (sample.ln - unit).exp())
            .fold((0.0, 0.0), |sums, x| (sums.0 + x, sums.1 + x * x));
        let mean = sum / count;
        (mean, ((squares / count - mean * mean) / count).max(0.0).sqrt())
    }

    /// Share of the samples that make up half of the sum.
    fn half(&self) -> f64 {
        let mut logs: Vec<_> = self.samples.iter().map(|sample| sample.ln).collect();
        logs.sort_by(|a, b| b.total_cmp(a));
        let unit = logs.first().copied().unwrap_or(0.0);
        let (mut sum, total) = (0.0, logs.iter().map(|ln| (ln - unit).exp()).sum::<f64>());
        let count = logs.iter().take_while(|ln| {
            let is_below = sum < 0.5 * total;
            sum += (*ln - unit).exp();
            is_below
        });
        count.count() as f64 / logs.len() as f64
    }
}

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let world = World::new(VERTICES, DISTANCE, RADIUS, G);
    let all: Vec<_> = MAKERS
        .iter()
        .map(|maker| Made {
            name: maker.name,
            samples: (0..SAMPLES).map(|sample| (maker.make)(&world, sample)).collect(),
        })
        .collect();
    // Relative to what bridges find, of all the surest.
    let unit = all[3].mean(0.0).0.ln();
    Ok(Section {
        text: vec![
            format!(
                "Paths with exactly {VERTICES} vertices between a start and a light {DISTANCE} mean free paths away, \
                 in fog of g = {G}; they arrive at the start at 45 degrees to the way to the light. Distance, radius \
                 and g are ours. All techniques estimate the same integral; what differs is how far single samples \
                 are from it."
            ),
            format!(
                "Path tracing walks {VERTICES} vertices and then connects: random ones end anywhere, and the best of \
                 {SAMPLES} look like those that bridges make each time."
            ),
            "MVNEE moves every seed by itself. So many of them crumple a chain, and each of its sharp turns is rare in \
             forward scattering: what it finds is orders of magnitude below the plot. Nor does it make paths that \
             turn back along their axis. The paper limits connections to a few expected segments, where neither \
             matters much."
                .into(),
        ],
        tables: vec![table(&all, unit)],
        plots: vec![drawing(bench, &all)?, histogram(bench, &all, unit)?],
        ..Section::default()
    })
}

fn table(all: &[Made], unit: f64) -> Table {
    let row = |made: &Made| {
        let (mean, error) = made.mean(unit);
        let variance = (error / mean).powi(2) * made.samples.len() as f64;
        let mean = format!("{} +- {}", number(mean, 3), number(error, 2));
        vec![made.name.to_string(), mean, number(variance, 3), crate::figures::percent(made.half())]
    };
    let columns = ["technique", "mean, relative", "relative variance of a sample", "samples that make half of the sum"];
    Table {
        caption: format!(
            "{SAMPLES} samples each. Where few samples make half of the sum, mean and error are themselves uncertain, \
             and rather too small."
        ),
        columns: columns.map(String::from).to_vec(),
        rows: all.iter().map(row).collect(),
    }
}

fn drawing(bench: &Bench<'_>, all: &[Made]) -> Result<Plot> {
    let mut best: Vec<&Sample> = all[0].samples.iter().collect();
    best.sort_by(|a, b| b.ln.total_cmp(&a.ln));
    let first = |made: &'_ Made| made.samples.iter().map(|sample| sample.path.clone()).take(DRAWN).collect::<Vec<_>>();
    let best = best.iter().take(DRAWN).map(|sample| sample.path.clone()).collect();
    let panels = [
        (format!("path tracing and NEE: the best {DRAWN} of {SAMPLES}"), best, "path"),
        (format!("path tracing and NEE: {DRAWN} random ones"), first(&all[0]), "nee"),
        (format!("MVNEE: {DRAWN} random ones"), first(&all[1]), "mvnee"),
        (format!("bridges, aligned: {DRAWN} random ones"), first(&all[3]), "bridge"),
    ]
    .map(|(title, paths, name)| panel(title, &paths, name));
    let caption = "To scale. The start is black, the light orange, seen from its edge.";
    bench.drawing(NAME, "paths", caption, plot::paths_svg(&panels))
}

fn panel(title: String, paths: &[Vec<DVec3>], name: &str) -> Panel {
    let flat = |path: &Vec<DVec3>| path.iter().map(|vertex| [vertex.z, vertex.y]).collect();
    let light = vec![[DISTANCE, -RADIUS], [DISTANCE, RADIUS]];
    Panel { title, paths: paths.iter().map(flat).collect(), lights: vec![light], colour: plot::colour(name, 0) }
}

fn histogram(bench: &Bench<'_>, all: &[Made], unit: f64) -> Result<Plot> {
    let range = Range { low: -16.0, high: 10.0 };
    let curve = |(index, made): (usize, &Made)| {
        let logs: Vec<_> = made.samples.iter().map(|sample| (sample.ln - unit) / core::f64::consts::LN_10).collect();
        let colour = plot::COLOURS[[6, 0, 4, 2][index]];
        Curve { name: made.name.into(), points: plot::bars(&logs, range, 104), look: Look::Steps, colour }
    };
    let chart = Chart {
        title: format!("contributions of paths of {VERTICES} vertices"),
        x: Axis::linear("log10 of contribution over mean"),
        y: Axis::linear("density"),
        curves: all.iter().enumerate().map(curve).collect(),
        from_zero: true,
        legend: Corner::UpperRight,
    };
    let caption = "Contributions of single samples. A technique is good if all of them are near the mean, 0.";
    bench.plot(NAME, "contributions", caption, &chart)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_start_to_the_light_through_so_many_vertices() {
        let world = World::new(VERTICES, DISTANCE, RADIUS, G);
        for maker in &MAKERS {
            for sample in 0..20 {
                let Sample { path, ln } = (maker.make)(&world, sample);
                assert_eq!((path.len(), path[0]), (VERTICES + 2, DVec3::ZERO), "{}", maker.name);
                let end = path[VERTICES + 1];
                assert!((end.z - DISTANCE).abs() < 1e-9 && end.truncate().length() <= RADIUS, "{}", maker.name);
                assert!(!ln.is_nan() && ln < f64::INFINITY, "{}", maker.name);
            }
        }
    }

    /// Whether a path counts: without short edges, in which the variance of NEE and MVNEE has no end, and without
    /// turning back along its axis, as MVNEE makes no path that does.
    fn counts(path: &[DVec3]) -> bool {
        let axis = path[path.len() - 1] - path[0];
        let edges = || path.windows(2).map(|pair| pair[1] - pair[0]);
        edges().all(|edge| edge.dot(axis) > 0.0 && edge.length() >= 0.3)
    }

    /// Few vertices that turn far, so that all techniques find their mean.
    #[test]
    fn all_techniques_have_the_same_mean() {
        for vertices in [1, 3] {
            let world = World::new(vertices, 2.0, 1.0, 0.3);
            let sample = |make: fn(&World, u32) -> Sample, number| {
                let sample = make(&world, number);
                Sample { ln: if counts(&sample.path) { sample.ln } else { f64::NEG_INFINITY }, ..sample }
            };
            let made = MAKERS.map(|Maker { name, make }| Made {
                name,
                samples: (0..200_000).map(|number| sample(make, number)).collect(),
            });
            let unit = made[3].mean(0.0).0.ln();
            let means = made.each_ref().map(|made| (made.name, made.mean(unit)));
            for (name, (mean, error)) in means {
                let off = (mean - 1.0).abs() / error.hypot(means[3].1.1);
                assert!(off < 4.0 && error < 0.1, "{vertices} vertices, {name}: {means:?}");
            }
        }
    }
}
