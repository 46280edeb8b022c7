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
use crate::plot::{self, Axis, Chart, Corner, Curve, Look};

const NAME: &str = "scaling";
/// Groups whose costs go by powers.
const OF_POWERS: [&str; 2] = ["longest path", "longest connection"];

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
            tables.push(powers(group));
        }
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
            "Powers are those of the best law a + b x^p through all points of a turn: a is what every sample costs, \
             however short its path is. Their interval is that of the mean of turns at a confidence of 95 %."
                .into(),
        ],
        claims: claims(&measured),
        tables,
        plots,
        ..Section::default()
    })
}

fn chart(bench: &Bench<'_>, group: &[Measured<'_>]) -> Result<Plot> {
    let curve = |(index, (series, costs)): (usize, &Measured<'_>)| {
        let points = series.settings.iter().zip(costs).map(|(setting, cost)| (setting.x, cost.nanoseconds())).collect();
        Curve::new(&series.name, points, Look::MarkedLine, plot::colour(&series.name, index))
    };
    let first = group[0].0;
    let chart = Chart {
        title: format!("time per sample: {}", first.group),
        x: Axis::logarithmic(first.axis),
        y: Axis::logarithmic("processor time per sample [ns]"),
        curves: group.iter().enumerate().map(curve).collect(),
        from_zero: false,
        legend: Corner::UpperLeft,
    };
    bench.plot(NAME, first.file, first.caption, &chart)
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

/// The times of a series turn by turn.
fn turns(costs: &[Cost]) -> Vec<Vec<f64>> {
    let count = costs.iter().map(|cost| cost.turns.len()).min().unwrap_or(0);
    (0..count).map(|turn| costs.iter().map(|cost| cost.turns[turn]).collect()).collect()
}

fn places(series: &Series) -> Vec<f64> {
    series.settings.iter().map(|setting| setting.x).collect()
}

fn powers(group: &[Measured<'_>]) -> Table {
    let row = |(series, costs): &Measured<'_>| {
        let Power { value, reach } = Power::of(&places(series), &turns(costs));
        vec![Cell::from(series.name.as_str()), Cell::from(value), Cell::from(reach)]
    };
    Table {
        caption: format!("Power p of the law a + b x^p of the time per sample: {}.", group[0].0.group),
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
    let (Some((series, mvnee)), Some((_, bridges))) = (named(series::LONG_MVNEE), named(series::LONG_BRIDGES)) else {
        return Vec::new();
    };
    let places = places(series);
    let [mvnee, bridges] = [mvnee, bridges].map(|costs| turns(costs));
    let more = mvnee.iter().zip(&bridges).map(|(a, b)| law::fitted(&places, a) - law::fitted(&places, b)).collect();
    let more = Power::mean(more);
    let verdict = match more.value {
        value if !value.is_finite() || value.abs() <= more.reach => Verdict::Undecided,
        value => Verdict::of(value > 0.0),
    };
    let [mvnee, bridges] = [mvnee, bridges].map(|turns| Power::of(&places, &turns));
    let text = |Power { value, reach }: Power| format!("{} +- {}", number(value, 3), number(reach, 2));
    vec![claim(
        "Weights of MVNEE take O(n^2) per path of n vertices.",
        super::PAPER,
        verdict,
        format!(
            "What a sample costs beyond a constant grows with the longest path K to the power {} with MVNEE of any \
             length, and {} with bridges, whose weights are O(n); the difference is {}. All of up to K vertices \
             connect, each by a chain and a weight.",
            text(mvnee),
            text(bridges),
            text(more)
        ),
        "At these lengths building chains takes longer than weighing them.",
    )]
}
