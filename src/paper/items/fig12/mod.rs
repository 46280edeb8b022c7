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

mod skew;
mod world;

use glam::DVec3;

use crate::error::Result;
use crate::figures::percent;
use crate::paper::bench::Bench;
use crate::paper::section::{Cell, Column, Plot, Section, Show, Table};
use crate::plot::{self, Axis, Chart, Corner, Curve, Look, Panel, Range};
use world::{MAKERS, Maker, Sample, World};

const NAME: &str = "fig12";
/// Vertices between start and light.
const VERTICES: usize = 100;
/// Mean cosine.
const G: f64 = 0.9;
/// Distance of the light in mean free paths of 1 m, and its radius `[m]`.
const DISTANCE: f64 = 15.0;
const RADIUS: f64 = 2.0;
/// Samples of each technique.
const SAMPLES: u32 = 40_000;
/// Share of the samples, the largest, of which the table says what they hold.
const LARGEST: f64 = 1e-3;
/// Paths that are drawn.
const DRAWN: usize = 10;

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

    /// Share of the sum that the largest samples hold, so `many` of all.
    fn held(&self, many: f64) -> f64 {
        let mut logs: Vec<_> = self.samples.iter().map(|sample| sample.ln).collect();
        logs.sort_by(|a, b| b.total_cmp(a));
        let largest = logs.first().copied().unwrap_or(0.0);
        let sum = |logs: &[f64]| logs.iter().map(|ln| (ln - largest).exp()).sum::<f64>();
        sum(&logs[..(many * logs.len() as f64).ceil() as usize]) / sum(&logs)
    }

    /// The logarithm to base 10 of samples over e to the power `unit`, as far as they contribute.
    fn logs(&self, unit: f64) -> Vec<f64> {
        let logs = self.samples.iter().map(|sample| (sample.ln - unit) / core::f64::consts::LN_10);
        logs.filter(|log| log.is_finite()).collect()
    }
}

/// `samples` samples of every technique.
fn all_made(world: &World, samples: u32) -> Vec<Made> {
    let made = |maker: &Maker| {
        let samples = (0..samples).map(|sample| (maker.make)(world, sample)).collect();
        Made { name: maker.name, samples }
    };
    MAKERS.iter().map(made).collect()
}

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let world = World::new(VERTICES, DISTANCE, RADIUS, G);
    let all = all_made(&world, SAMPLES);
    // Relative to what bridges find, of all the surest.
    let unit = all[3].mean(0.0).0.ln();
    let never = skew::never_made(&world, &all[3].samples);
    let (skew_table, skew_plot) = skew::of_few_vertices(bench, NAME)?;
    Ok(Section {
        text: vec![
            format!(
                "Paths with exactly {VERTICES} vertices between a start and a light {DISTANCE} mean free paths away, \
                 in fog of g = {G}; they arrive at the start at 45 degrees to the way to the light. Distance, radius \
                 and g are ours. All techniques estimate the same integral, MVNEE as far as it makes such paths; what \
                 differs is how far single samples are from it."
            ),
            format!(
                "Path tracing walks {VERTICES} vertices and then connects: random ones end anywhere, and the best of \
                 {SAMPLES} look like those that bridges make each time."
            ),
            format!(
                "MVNEE moves every seed by itself. So many of them crumple a chain, and each of its sharp turns is \
                 rare in forward scattering: what it finds is orders of magnitude below the mean. Nor does it make \
                 paths that turn back along their axis, and with so many vertices these are {} of the integral, by \
                 the samples of bridges: in renders other techniques find them. The paper limits connections to a few \
                 expected segments, where neither matters much.",
                percent(never)
            ),
            "With few vertices MVNEE makes most paths, but its mean is still below that of the others for as many \
             samples as one has. The last table and plot show that this is skew, and no error of its density: below \
             any limit on contributions it finds as much as bridges say that it has to."
                .into(),
        ],
        tables: vec![table(&all, unit), skew_table],
        plots: vec![drawing(bench, &all)?, histogram(bench, &all, unit)?, skew_plot],
        ..Section::default()
    })
}

fn table(all: &[Made], unit: f64) -> Table {
    let row = |made: &Made| {
        let (mean, error) = made.mean(unit);
        let variance = (error / mean).powi(2) * made.samples.len() as f64;
        let mut logs = made.logs(unit);
        logs.sort_by(f64::total_cmp);
        let median = logs.get(logs.len() / 2).copied().unwrap_or(f64::NAN);
        let numbers = [mean, error, variance, median, 100.0 * made.held(LARGEST)];
        core::iter::once(Cell::from(made.name)).chain(numbers.map(Cell::from)).collect()
    };
    Table {
        caption: format!(
            "{SAMPLES} samples each. Where the few largest samples hold most of the sum, mean and error are themselves \
             uncertain, and rather too small."
        ),
        columns: Column::all([
            ("technique", Show::Digits(1)),
            ("mean, relative", Show::Digits(3)),
            ("standard error of the mean", Show::PlusMinus(2)),
            ("relative variance of a sample", Show::Digits(3)),
            ("median, log10 over the mean", Show::Digits(3)),
            ("held by the largest 0.1 % [% of the sum]", Show::Digits(3)),
        ]),
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
    bench.paths(NAME, "paths", caption, &panels)
}

fn panel(title: String, paths: &[Vec<DVec3>], name: &str) -> Panel {
    let flat = |path: &Vec<DVec3>| path.iter().map(|vertex| [vertex.z, vertex.y]).collect();
    let light = vec![[DISTANCE, -RADIUS], [DISTANCE, RADIUS]];
    Panel { title, paths: paths.iter().map(flat).collect(), lights: vec![light], colour: plot::colour(name, 0) }
}

fn histogram(bench: &Bench<'_>, all: &[Made], unit: f64) -> Result<Plot> {
    let logs: Vec<Vec<f64>> = all.iter().map(|made| made.logs(unit)).collect();
    let range = shown(&logs);
    let bins = (2.0 * range.length()) as usize;
    let curve = |((index, made), logs): ((usize, &Made), &Vec<f64>)| {
        Curve::new(made.name, plot::bars(logs, range, bins), Look::Steps, plot::COLOURS[[6, 0, 4, 2][index]])
    };
    let chart = Chart {
        title: format!("contributions of paths of {VERTICES} vertices"),
        x: Axis::linear("log10 of contribution over mean"),
        y: Axis::linear("density"),
        curves: all.iter().enumerate().zip(&logs).map(curve).collect(),
        from_zero: true,
        legend: Corner::UpperMiddle,
    };
    let caption = "Contributions of single samples. A technique is good if all of them are near the mean, 0.";
    bench.plot(NAME, "contributions", caption, &chart)
}

/// What a histogram of all of `logs` shows: all of them but one in a hundred of the smallest.
fn shown(logs: &[Vec<f64>]) -> Range {
    let ends = logs.iter().filter(|logs| !logs.is_empty()).map(|logs| {
        let mut logs = logs.clone();
        logs.sort_by(f64::total_cmp);
        [logs[logs.len() / 100], logs[logs.len() - 1]]
    });
    let [low, high] = ends.fold([-4.0, 4.0], |[low, high], ends| [f64::min(low, ends[0]), f64::max(high, ends[1])]);
    Range { low: low.floor(), high: high.ceil() }
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

    #[test]
    fn what_the_largest_hold() {
        let sample = |ln: f64| Sample { path: Vec::new(), ln };
        let samples = (0..1000).map(|index| sample(if index == 7 { 1000.0_f64.ln() } else { 0.0 })).collect();
        let made = Made { name: "", samples };
        assert!((made.held(1e-3) - 1000.0 / 1999.0).abs() < 1e-9 && (made.held(1.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_histogram_shows_all_techniques() {
        let far = (0..100).map(|k| -60.0 - f64::from(k)).collect::<Vec<_>>();
        let range = shown(&[vec![0.0, 1.0], far, Vec::new()]);
        assert_eq!((range.low, range.high), (-158.0, 4.0));
    }
}
