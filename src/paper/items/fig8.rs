//! Light through a perforated plate in dense fog, at equal time.

use super::{
    ALIGNED, BRIDGES, FOR_REFERENCE, MVNEE_2, MVNEE_4, MVNEE_6, MVNEE_8, NEE, OMNEE, PAPER, PATH, PROGRAM, claim,
    convergence, equal_times, gain, of, sorted, table, times,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::section::{Claim, Section, Table};

const NAME: &str = "fig8";

/// Published samples per second, in thousands, and variance of a green sample, from the published program.
const PUBLISHED: [(&str, f64, f64); 6] = [
    ("path tracing", 713.0, 23.2),
    ("NEE", 412.0, 15.6),
    ("MVNEE-2", 531.0, 12.9),
    ("MVNEE-4", 357.0, 4.63),
    ("MVNEE-6", 171.0, 3.24),
    ("MVNEE-8", 121.0, 3.08),
];

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [PATH, NEE, MVNEE_2, MVNEE_4, MVNEE_6, MVNEE_8, OMNEE, BRIDGES, ALIGNED];
    let budget = bench.budget.as_secs_f64();
    let seconds = (1.0 - FOR_REFERENCE) * budget / techniques.len() as f64;
    let times = (seconds, FOR_REFERENCE * budget);
    let result = equal_times(bench, "dense-plate", &[], &techniques, times, &ALIGNED)?;
    let measured = sorted(result.measured);
    let caption = format!("dense-plate, {} s each, sorted by RMSE.", number(seconds, 3));
    let gallery = bench.gallery(NAME, &caption, &measured, Some(&result.reference))?;
    Ok(Section {
        text: vec![
            "A disk light shines through 13 holes of a plate into fog of mean free path 0.5 m and g = 0.9. All \
             techniques get the same time, in turns. RMSE is against our own longer reference, whose own error is \
             subtracted."
                .into(),
        ],
        claims: claims(&measured),
        tables: vec![table(caption, &measured, &NEE), published(&measured)],
        plots: vec![convergence(bench, NAME, "rmse", "dense-plate", &measured)?],
        galleries: vec![gallery],
        ..Section::default()
    })
}

/// What the published program does beside what is found.
fn published(measured: &[Measured]) -> Table {
    let row = |(name, rate, variance): &(&str, f64, f64)| {
        let own = measured.iter().find(|one| one.run.name == *name);
        let [own_rate, own_variance] = [own.map(|one| one.run.rate() / 1e3), own.map(Measured::variance_of_green)];
        let text = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| number(value, 3));
        vec![name.to_string(), number(*rate, 3), text(own_rate), number(*variance, 3), text(own_variance)]
    };
    let columns = ["technique", "published k samples/s", "ours", "published variance of green", "ours"];
    Table {
        caption: format!("Beside {PROGRAM}. Rates depend on the machine, variances do not."),
        columns: columns.map(String::from).to_vec(),
        rows: PUBLISHED.iter().map(row).collect(),
    }
}

fn claims(measured: &[Measured]) -> Vec<Claim> {
    let over_nee = gain(measured, &MVNEE_4, &NEE);
    let longest = gain(measured, &MVNEE_8, &MVNEE_4);
    let best = measured.first().map_or("-", |one| one.run.name.as_str());
    let bridges = gain(measured, &ALIGNED, &MVNEE_4);
    let (four, eight) = (of(measured, &MVNEE_4), of(measured, &MVNEE_8));
    let rate = |one: Option<&Measured>| one.map_or(f64::NAN, |one| one.run.rate());
    vec![
        claim(
            "MVNEE renders this scene with less error than NEE in the same time: MVNEE-4 is 3.0 times as efficient.",
            PROGRAM,
            over_nee > 1.0,
            format!("MVNEE-4 is {} as efficient as NEE.", times(over_nee)),
            "Fireflies decide over so short a render; give it more time.",
        ),
        claim(
            "Longer connections pay up to MESC 4; weights of longer ones, O(n^2) each, cost more than they gain: \
             MVNEE-8 has half the efficiency of MVNEE-4.",
            PROGRAM,
            longest < 1.0,
            format!(
                "MVNEE-8 is {} as efficient as MVNEE-4, at {} its rate.",
                times(longest),
                times(rate(eight) / rate(four))
            ),
            "Weights are summed here for eight paths at once, and stop at the first vertex near a light, so that long \
             connections lose less time than the published program does, which has a third of the rate at MESC 8.",
        ),
        claim(
            "Of path tracing, NEE and MVNEE, the last is the best.",
            PAPER,
            over_nee.max(gain(measured, &MVNEE_6, &NEE)) > gain(measured, &PATH, &NEE).max(1.0),
            format!(
                "Of all techniques the least error is that of {best}. Aligned bridges, which are younger than the \
                 paper, are {} as efficient as MVNEE-4.",
                times(bridges)
            ),
            "Fireflies decide over so short a render; give it more time.",
        ),
    ]
}
