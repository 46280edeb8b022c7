//! What a sample costs: against the longest path, the longest connection, threads, paths in flight, pixels and lights.

mod series;
mod timing;

use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::section::{Claim, Plot, Section, Table};
use crate::plot::{self, Axis, Chart, Corner, Curve, Look};
use series::Series;
use timing::{Cost, Setting};

use super::claim;

const NAME: &str = "scaling";

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let all = series::all(bench)?;
    let settings: Vec<&Setting> = all.iter().flat_map(|series| &series.settings).collect();
    let mut costs = timing::measure(bench, &settings)?.into_iter();
    let measured: Vec<(&Series, Vec<Cost>)> =
        all.iter().map(|series| (series, costs.by_ref().take(series.settings.len()).collect())).collect();
    let mut plots = Vec::new();
    let mut tables = Vec::new();
    for group in measured.chunk_by(|a, b| a.0.group == b.0.group) {
        plots.push(chart(bench, group)?);
        tables.push(table(group));
    }
    Ok(Section {
        text: vec![
            "Time per camera path, wall-clock time times threads, the median of turns; settings take turns, so that a \
             noisy machine slows all alike. All vertices connect, and walks end only at the limit, so that settings \
             differ in nothing but what is named."
                .into(),
        ],
        claims: claims(&measured),
        tables,
        plots,
        ..Section::default()
    })
}

fn chart(bench: &Bench<'_>, group: &[(&Series, Vec<Cost>)]) -> Result<Plot> {
    let curve = |(index, (series, costs)): (usize, &(&Series, Vec<Cost>))| Curve {
        name: series.name.clone(),
        points: series.settings.iter().zip(costs).map(|(setting, cost)| (setting.x, cost.nanoseconds)).collect(),
        look: Look::MarkedLine,
        colour: plot::colour(&series.name, index),
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

fn table(group: &[(&Series, Vec<Cost>)]) -> Table {
    let first = group[0].0;
    let names = group.iter().map(|(series, _)| format!("{} [ns]", series.name));
    let row = |index: usize| {
        let cost = |costs: &Vec<Cost>| {
            let Cost { nanoseconds, spread } = costs[index];
            format!("{} +- {}", number(nanoseconds, 3), crate::figures::percent(spread))
        };
        let x = number(first.settings[index].x, 4);
        core::iter::once(x).chain(group.iter().map(|(_, costs)| cost(costs))).collect()
    };
    Table {
        caption: format!("Processor time per sample: {}.", first.group),
        columns: core::iter::once(first.axis.to_string()).chain(names).collect(),
        rows: (0..first.settings.len()).map(row).collect(),
    }
}

/// The exponent of a power law through the last two points of a series.
fn exponent(measured: &[(&Series, Vec<Cost>)], name: &str) -> f64 {
    let found = measured.iter().find(|(series, _)| series.name == name);
    let Some((series, costs)) = found else { return f64::NAN };
    let [.., (a, p), (b, q)] = series.settings.iter().zip(costs).collect::<Vec<_>>()[..] else { return f64::NAN };
    (q.nanoseconds / p.nanoseconds).ln() / (b.x / a.x).ln()
}

fn claims(measured: &[(&Series, Vec<Cost>)]) -> Vec<Claim> {
    let [mvnee, bridges] = [series::LONG_MVNEE, series::LONG_BRIDGES].map(|name| exponent(measured, name));
    vec![claim(
        "Weights of MVNEE take O(n^2) per path of n vertices.",
        super::PAPER,
        mvnee > bridges,
        format!(
            "Between the two longest limits the time per sample grows as K^{} with MVNEE, and as K^{} with bridges, \
             whose weights are O(n). K vertices connect, each by a chain and a weight.",
            number(mvnee, 2),
            number(bridges, 2)
        ),
        "At these lengths building chains takes longer than weighing them.",
    )]
}
