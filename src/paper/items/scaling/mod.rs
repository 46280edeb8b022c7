//! What a sample costs: against the longest path, the longest connection, threads, paths in flight, pixels, triangles
//! and lights.

mod ground;
mod law;
mod memory;
mod series;
mod timing;

use law::Power;
use series::Series;
use timing::{Cost, Setting};

use super::claim;
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::ratio::Verdict;
use crate::paper::section::{Cell, Claim, Column, Plot, Section, Show, Table};
use crate::plot::{self, Axis, Chart, Curve, Look};

const NAME: &str = "scaling";
/// Groups whose costs go by powers.
const OF_POWERS: [&str; 2] = ["longest path", "longest connection"];

/// The power of O(n^2).
const QUADRATIC: f64 = 2.0;

/// A series and what its settings cost.
type Measured<'a> = (&'a Series, Vec<Cost>);

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let all = series::all(bench)?;
    let settings: Vec<&Setting> = all.iter().flat_map(|series| &series.settings).collect();
    let mut costs = timing::measure(bench, &settings)?.into_iter();
    let measured: Vec<Measured<'_>> =
        all.iter().map(|series| (series, costs.by_ref().take(series.settings.len()).collect())).collect();
    let mut plots = Vec::new();
    let mut tables = Vec::new();
    for group in measured.chunk_by(|a, b| a.0.group == b.0.group) {
        plots.push(chart(bench, group)?);
        tables.push(table(group));
        if OF_POWERS.contains(&group[0].0.group) {
            tables.push(powers(group, "the time per sample", |cost| &cost.turns));
        }
    }
    let weighed: Vec<Measured<'_>> = measured.iter().filter(|(_, costs)| costs[0].weight() > 0.0).cloned().collect();
    if !weighed.is_empty() {
        plots.push(chart_of_weights(bench, &weighed)?);
        tables.push(powers(&weighed, "the time per weight", |cost| &cost.weights));
    }
    if !bench.tell.stops() {
        for (table, plot) in memory::measure(bench)? {
            tables.push(table);
            plots.push(plot);
        }
    }
    Ok(Section {
        text: vec![
            "Time per camera path, wall-clock time times threads, the median of turns and half the distance between \
             the fastest and the slowest one; settings take turns, so that a noisy machine slows all alike. All \
             vertices connect, and walks end only at the limit, so that settings differ in nothing but what is named."
                .into(),
            "Powers are those by which times grow between the last two points. Their interval is that of the mean of \
             turns at a confidence of 95 %. Times of weights are those of the stage that computes them, divided by all \
             lanes of its batches, whether they were in use or not."
                .into(),
        ],
        claims: claims(&measured),
        tables,
        plots,
        ..Section::default()
    })
}

fn chart(bench: &Bench<'_>, group: &[Measured<'_>]) -> Result<Plot> {
    let first = group[0].0;
    let caption = format!("{}{}", first.caption, gain_of_threads(group));
    let title = format!("time per sample: {}", first.group);
    let chart = curves(group, title, "processor time per sample [ns]", Cost::nanoseconds);
    bench.plot(NAME, first.file, caption, &chart)
}

fn chart_of_weights(bench: &Bench<'_>, weighed: &[Measured<'_>]) -> Result<Plot> {
    let chart = curves(weighed, "time per weight".into(), "processor time per weight [ns]", Cost::weight);
    let caption =
        "fog-facing, every vertex connects. What it takes to weigh a path, among all paths of up to K segments.";
    bench.plot(NAME, "weights", caption, &chart)
}

fn curves(group: &[Measured<'_>], title: String, y: &str, value: fn(&Cost) -> f64) -> Chart {
    let curve = |(index, (series, costs)): (usize, &Measured<'_>)| {
        let points = series.settings.iter().zip(costs).map(|(setting, cost)| (setting.x, value(cost))).collect();
        Curve::new(&series.name, points, Look::MarkedLine, plot::colour(&series.name, index))
    };
    Chart {
        title,
        x: Axis::logarithmic(group[0].0.axis),
        y: Axis::logarithmic(y),
        curves: group.iter().enumerate().map(curve).collect(),
        from_zero: false,
    }
}

/// How much faster most threads are than one, in words, where it is threads that differ.
fn gain_of_threads(group: &[Measured<'_>]) -> String {
    let gain = |(Series { name, settings, .. }, costs): &Measured<'_>| match (settings.as_slice(), costs.as_slice()) {
        ([_, .., last], [one, .., most]) => {
            format!("{} with {name}", number(last.x * one.nanoseconds() / most.nanoseconds(), 2))
        }
        _ => String::new(),
    };
    let Some(most) = group[0].0.settings.last().filter(|_| group[0].0.group == series::THREADS) else {
        return String::new();
    };
    let gains: Vec<_> = group.iter().map(gain).collect();
    format!(" {} threads take as many times the samples of one: {}.", most.x, gains.join(", "))
}

fn table(group: &[Measured<'_>]) -> Table {
    let first = group[0].0;
    let columns = group.iter().flat_map(|(Series { name, .. }, _)| {
        [(format!("{name} [ns]"), Show::Digits(3)), (format!("{name}, half spread [ns]"), Show::PlusMinus(2))]
    });
    let columns = core::iter::once((first.axis.to_string(), Show::Digits(7))).chain(columns);
    let row = |index: usize| {
        let cells = group.iter().flat_map(|(_, costs)| [costs[index].nanoseconds(), costs[index].spread()]);
        core::iter::once(first.settings[index].x).chain(cells).map(Cell::from).collect()
    };
    Table {
        caption: format!("Processor time per sample: {}.", first.group),
        columns: Column::all(columns),
        rows: (0..first.settings.len()).map(row).collect(),
    }
}

/// What is measured of a series, turn by turn.
fn turns(costs: &[Cost], of: fn(&Cost) -> &Vec<f64>) -> Vec<Vec<f64>> {
    let count = costs.iter().map(|cost| of(cost).len()).min().unwrap_or(0);
    (0..count).map(|turn| costs.iter().map(|cost| of(cost)[turn]).collect()).collect()
}

fn power((series, costs): &Measured<'_>, of: fn(&Cost) -> &Vec<f64>) -> Power {
    let places: Vec<f64> = series.settings.iter().map(|setting| setting.x).collect();
    Power::of(&places, &turns(costs, of))
}

fn powers(group: &[Measured<'_>], what: &str, of: fn(&Cost) -> &Vec<f64>) -> Table {
    let row = |measured: &Measured<'_>| {
        let Power { value, reach } = power(measured, of);
        vec![Cell::from(measured.0.name.as_str()), Cell::from(value), Cell::from(reach)]
    };
    let Series { axis, settings, .. } = group[0].0;
    let [.., a, b] = settings.as_slice() else { return Table::default() };
    Table {
        caption: format!("Power by which {what} grows from {} to {}: {axis}.", a.x, b.x),
        columns: Column::all([
            ("technique", Show::Digits(1)),
            ("power", Show::Digits(3)),
            ("reach of its interval", Show::PlusMinus(2)),
        ]),
        rows: group.iter().map(row).collect(),
    }
}

fn claims(measured: &[Measured<'_>]) -> Vec<Claim> {
    let named = |name: &str| measured.iter().find(|(series, _)| series.name == name);
    let (Some(mvnee), Some(bridges)) = (named(series::LONG_MVNEE), named(series::LONG_BRIDGES)) else {
        return Vec::new();
    };
    let [of_mvnee, of_bridges] = [mvnee, bridges].map(|measured| power(measured, |cost| &cost.weights));
    let verdict = match of_mvnee {
        Power { value, reach } if !value.is_finite() || reach > 1.0 => Verdict::Undecided,
        power => Verdict::of(power.may_be(QUADRATIC)),
    };
    let text = |Power { value, reach }: Power| format!("{} +- {}", number(value, 3), number(reach, 2));
    let [(_, of_mvnee_in_ns), (_, of_bridges_in_ns)] = [mvnee, bridges];
    let last = |costs: &[Cost]| costs.last().map_or(f64::NAN, Cost::weight);
    vec![claim(
        "Weights of MVNEE take O(n^2) per path of n vertices.",
        super::PAPER,
        verdict,
        format!(
            "Between the two longest limits K on paths, the time of a weight grows with K to the power {} with MVNEE \
             of any length, and {} with bridges, whose weights are O(n). At the longest one takes {} ns with MVNEE, \
             and {} with bridges.",
            text(of_mvnee),
            text(of_bridges),
            number(last(of_mvnee_in_ns), 3),
            number(last(of_bridges_in_ns), 3)
        ),
        "Sums over the vertices of a path end as soon as a suffix turns back along its axis: MVNEE makes none of \
         these, and of long paths few suffixes do not.",
    )]
}
