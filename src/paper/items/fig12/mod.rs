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
use crate::plot::{self, Axis, Chart, Curve, Look, Panel, Range};
use world::{MAKERS, Maker, Sample, World};

const NAME: &str = "fig12";
/// Vertices between start and light.
const VERTICES: usize = 100;
/// Mean cosine.
const G: f64 = 0.9;

/// Where a light is.
struct Place {
    /// What its files are called.
    file: &'static str,
    /// Distance from the start in mean free paths of 1 m, and radius `[m]`.
    distance: f64,
    radius: f64,
}

/// So close that paths of so many vertices wander, and so far that MVNEE would insert about as many by itself.
const PLACES: [Place; 2] =
    [Place { file: "near", distance: 15.0, radius: 2.0 }, Place { file: "far", distance: 80.0, radius: 10.0 }];
/// Decades below the mean beyond which the contributions of a technique are out of sight.
const SIGHT: f64 = 60.0;

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

    /// The logarithm to base 10 of samples over e to the power `unit`, as far as they contribute, the smallest first.
    fn logs(&self, unit: f64) -> Vec<f64> {
        let logs = self.samples.iter().map(|sample| (sample.ln - unit) / core::f64::consts::LN_10);
        let mut logs: Vec<f64> = logs.filter(|log| log.is_finite()).collect();
        logs.sort_by(f64::total_cmp);
        logs
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

/// What was made for a light at one place.
struct Found {
    place: &'static Place,
    all: Vec<Made>,
    /// The logarithm of the mean of aligned bridges, of all the surest: others are given relative to it.
    unit: f64,
    /// Share of the integral in paths that MVNEE never makes.
    never: f64,
}

impl Found {
    fn of(place: &'static Place) -> Self {
        let world = World::new(VERTICES, place.distance, place.radius, G);
        let all = all_made(&world, SAMPLES);
        let unit = all[3].mean(0.0).0.ln();
        let never = skew::never_made(&world, &all[3].samples);
        Self { place, all, unit, never }
    }
}

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let mut found = Vec::new();
    for place in &PLACES {
        if bench.tell.stops() {
            return Ok(Section::default());
        }
        found.push(Found::of(place));
    }
    let (skew_table, skew_plot) = skew::of_few_vertices(bench, NAME)?;
    let mut plots = Vec::new();
    for found in &found {
        plots.extend([drawing(bench, found)?, histogram(bench, found)?]);
    }
    plots.push(skew_plot);
    let [near, far] = [0, 1].map(|place: usize| percent(found[place].never));
    Ok(Section {
        text: vec![
            format!(
                "Paths with exactly {VERTICES} vertices between a start and a light, in fog of g = {G}; they arrive at \
                 the start at 45 degrees to the way to the light. It is {} mean free paths away, so close that such \
                 paths wander, or {}, so far that MVNEE would insert about as many vertices by itself. Distances, \
                 radii and g are ours. All techniques estimate the same integral, MVNEE as far as it makes such paths; \
                 what differs is how far single samples are from it.",
                PLACES[0].distance, PLACES[1].distance
            ),
            format!(
                "Path tracing walks {VERTICES} vertices and then connects: random ones end anywhere, and the best of \
                 {SAMPLES} look like those that bridges make each time."
            ),
            format!(
                "MVNEE moves every seed by itself. So many of them crumple a chain, and each of its sharp turns is \
                 rare in forward scattering: what it finds is orders of magnitude below the mean. Nor does it make \
                 paths that turn back along their axis; by the samples of bridges these are {near} of the integral \
                 where the light is near, and {far} where it is far: in renders other techniques find them. The paper \
                 limits connections to a few expected segments, where neither matters much."
            ),
            "With few vertices MVNEE makes most paths, but its mean is still below that of the others for as many \
             samples as one has. The last table and plot show that this is skew, and no error of its density: below \
             any limit on contributions it finds as much as bridges say that it has to."
                .into(),
        ],
        tables: found.iter().map(table).chain([skew_table]).collect(),
        plots,
        ..Section::default()
    })
}

fn table(Found { place, all, unit, .. }: &Found) -> Table {
    let row = |made: &Made| {
        let (mean, error) = made.mean(*unit);
        let variance = (error / mean).powi(2) * made.samples.len() as f64;
        let numbers = [mean, error, variance, median(&made.logs(*unit)), 100.0 * made.held(LARGEST)];
        core::iter::once(Cell::from(made.name)).chain(numbers.map(Cell::from)).collect()
    };
    Table {
        caption: format!(
            "A light {} mean free paths away, {SAMPLES} samples each. Where the few largest samples hold most of the \
             sum, mean and error are themselves uncertain, and rather too small.",
            place.distance
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

fn median(logs: &[f64]) -> f64 {
    logs.get(logs.len() / 2).copied().unwrap_or(f64::NAN)
}

fn drawing(bench: &Bench<'_>, Found { place, all, .. }: &Found) -> Result<Plot> {
    let mut best: Vec<&Sample> = all[0].samples.iter().collect();
    best.sort_by(|a, b| b.ln.total_cmp(&a.ln));
    let first = |made: &'_ Made| made.samples.iter().map(|sample| sample.path.clone()).take(DRAWN).collect::<Vec<_>>();
    let best = best.iter().take(DRAWN).map(|sample| sample.path.clone()).collect();
    let panels = [
        (format!("path tracing and NEE: the best {DRAWN} of {SAMPLES}"), best, "path", false),
        (format!("path tracing and NEE: {DRAWN} random ones"), first(&all[0]), "nee", true),
        (format!("MVNEE: {DRAWN} random ones"), first(&all[1]), "mvnee", false),
        (format!("bridges, aligned: {DRAWN} random ones"), first(&all[3]), "bridge", false),
    ]
    .map(|(title, paths, name, is_cut)| Panel { is_cut, ..panel(place, title, &paths, name) });
    let caption = format!(
        "A light {} mean free paths away, to scale. The arrow is the direction in which paths arrive at the start; the \
         light is orange, seen from its edge. Random path-traced ones are cut off where they leave the view of the \
         others.",
        place.distance
    );
    bench.paths(NAME, &format!("paths-{}", place.file), caption, &panels)
}

fn panel(place: &Place, title: String, paths: &[Vec<DVec3>], name: &str) -> Panel {
    let flat = |point: &DVec3| [point.z, point.y];
    let light = vec![[place.distance, -place.radius], [place.distance, place.radius]];
    Panel {
        title,
        paths: paths.iter().map(|path| path.iter().map(flat).collect()).collect(),
        lights: vec![light],
        colour: plot::colour(name, 0),
        arrow: Some(flat(&world::ARRIVING)),
        is_cut: false,
    }
}

fn histogram(bench: &Bench<'_>, Found { place, all, unit, .. }: &Found) -> Result<Plot> {
    let logs: Vec<Vec<f64>> = all.iter().map(|made| made.logs(*unit)).collect();
    let range = shown(&logs);
    let bins = (2.0 * range.length()) as usize;
    let curve = |((index, made), logs): ((usize, &Made), &Vec<f64>)| {
        let (name, points) = if is_in_sight(logs) {
            (made.name.into(), plot::bars(logs, range, bins))
        } else {
            (format!("{}: out of sight, about 1e{}", made.name, median(logs).round()), Vec::new())
        };
        Curve::new(name, points, Look::Steps, plot::COLOURS[[6, 0, 4, 2][index]])
    };
    let chart = Chart {
        title: format!("contributions of paths of {VERTICES} vertices, {} mean free paths", place.distance),
        x: Axis::linear("log10 of contribution over mean"),
        y: Axis::linear("density"),
        curves: all.iter().enumerate().zip(&logs).map(curve).collect(),
        from_zero: true,
    };
    let caption = format!(
        "Contributions of single samples, a light {} mean free paths away. A technique is good if all of them are near \
         the mean, 0. What is below 1e-{SIGHT} is not shown.",
        place.distance
    );
    bench.plot(NAME, &format!("contributions-{}", place.file), caption, &chart)
}

/// Whether some of the contributions of a technique are near those of others, given their logarithms in order.
fn is_in_sight(logs: &[f64]) -> bool {
    median(logs) > -SIGHT
}

/// What a histogram of `logs`, each in order, shows: all that is in sight but one in a hundred of the smallest.
fn shown(logs: &[Vec<f64>]) -> Range {
    let ends = logs.iter().filter(|logs| is_in_sight(logs)).map(|logs| [logs[logs.len() / 100], logs[logs.len() - 1]]);
    let [low, high] = ends.fold([-4.0, 4.0], |[low, high], ends| [f64::min(low, ends[0]), f64::max(high, ends[1])]);
    Range { low: low.floor().max(-SIGHT), high: high.ceil() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_start_to_the_light_through_so_many_vertices() {
        for (place, maker) in PLACES.iter().flat_map(|place| MAKERS.iter().map(move |maker| (place, maker))) {
            let world = World::new(VERTICES, place.distance, place.radius, G);
            for sample in 0..10 {
                let Sample { path, ln } = (maker.make)(&world, sample);
                assert_eq!((path.len(), path[0]), (VERTICES + 2, DVec3::ZERO), "{}", maker.name);
                let end = path[VERTICES + 1];
                assert!(
                    (end.z - place.distance).abs() < 1e-9 && end.truncate().length() <= place.radius,
                    "{}",
                    maker.name
                );
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
    fn the_histogram_shows_what_is_in_sight() {
        let low = (0..100).map(|k| -50.0 + 0.5 * f64::from(k)).collect::<Vec<_>>();
        let far = (0..100).map(|k| -190.0 + f64::from(k)).collect::<Vec<_>>();
        let range = shown(&[vec![0.0, 1.0], low, far.clone(), Vec::new()]);
        assert_eq!((range.low, range.high), (-50.0, 4.0));
        let long = (0..100).map(|k| -99.0 + f64::from(k)).collect::<Vec<_>>();
        assert_eq!(shown(&[long]).low, -SIGHT, "tails end where sight does");
        assert!(!is_in_sight(&far) && !is_in_sight(&[]));
    }
}
