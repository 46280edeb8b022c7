//! Light through a perforated plate in dense fog, at equal time.

use super::{
    ALIGNED, BRIDGES, Contest, MVNEE_2, MVNEE_4, MVNEE_6, MVNEE_8, Match, NEE, OMNEE, PAPER, PATH, PROGRAM, claim,
    convergence, gain, over, table, times,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::ratio::Worth;
use crate::paper::section::{Cell, Claim, Column, Section, Show, Table};

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
    let times = bench.times(1.0, techniques.len());
    let contest = Contest { bench, scene: "dense-plate", changes: &[], techniques: &techniques, best: &ALIGNED, times };
    let Match { measured, reference } = contest.equal_times()?;
    let caption = format!("dense-plate, {} s each, sorted by RMSE.", number(times.each, 3));
    let gallery = bench.gallery(NAME, &caption, &measured, Some(&reference))?;
    Ok(Section {
        text: vec![
            "A disk light shines through 13 holes of a plate into fog of mean free path 0.5 m and g = 0.9. All \
             techniques get the same time, in turns. RMSE is against a longer render of our own, whose own error is \
             subtracted; efficiencies have the interval that their spread over turns leaves, at a confidence of 95 %."
                .into(),
        ],
        claims: claims(&measured),
        tables: vec![table(&caption, &measured, &NEE, &reference), published(&measured)],
        plots: vec![convergence(bench, NAME, "rmse", "dense-plate", &measured)?],
        galleries: vec![gallery],
        ..Section::default()
    })
}

/// What the published program does beside what is found.
fn published(measured: &[Measured]) -> Table {
    let row = |(name, rate, variance): &(&str, f64, f64)| {
        let own = measured.iter().find(|one| one.name == *name);
        let [own_rate, own_variance] = [own.map(Measured::rate), own.map(Measured::variance_of_green)];
        vec![
            Cell::from(*name),
            Cell::from(1e3 * rate),
            Cell::from(own_rate),
            Cell::from(*variance),
            Cell::from(own_variance),
        ]
    };
    Table {
        caption: format!("Beside {PROGRAM}. Rates depend on the machine, variances do not."),
        columns: Column::all([
            ("technique", Show::Digits(1)),
            ("published rate [1/s]", Show::Rate),
            ("our rate [1/s]", Show::Rate),
            ("published variance of green", Show::Digits(3)),
            ("our variance of green", Show::Digits(3)),
        ]),
        rows: PUBLISHED.iter().map(row).collect(),
    }
}

fn claims(measured: &[Measured]) -> Vec<Claim> {
    let over_nee = gain(measured, &MVNEE_4, &NEE);
    let longest = gain(measured, &MVNEE_8, &MVNEE_4);
    let best = measured.first().map_or("-", |one| one.name.as_str());
    let bridges = gain(measured, &ALIGNED, &MVNEE_4);
    let slower = over(measured, Worth::Rate, &MVNEE_8, &MVNEE_4);
    let over_path = gain(measured, &MVNEE_4, &PATH);
    vec![
        claim(
            "MVNEE renders this scene with less error than NEE in the same time: MVNEE-4 is 3.0 times as efficient.",
            PROGRAM,
            over_nee.is_above(1.0),
            format!("MVNEE-4 is {} as efficient as NEE.", times(over_nee)),
            "Both programs take the same samples; what differs is what they cost.",
        ),
        claim(
            "Longer connections pay up to MESC 4; weights of longer ones, O(n^2) each, cost more than they gain: \
             MVNEE-8 has half the efficiency of MVNEE-4.",
            PROGRAM,
            longest.is_below(1.0),
            format!(
                "MVNEE-8 is {} as efficient as MVNEE-4, at {} times its rate.",
                times(longest),
                number(slower.value, 2)
            ),
            "Weights are summed here for eight paths at once, and stop at the first vertex near a light, so that long \
             connections lose less time than the published program does, which has a third of the rate at MESC 8.",
        ),
        claim(
            "Of path tracing, NEE and MVNEE, the last is the best.",
            PAPER,
            over_nee.is_above(1.0).and(over_path.is_above(1.0)),
            format!(
                "MVNEE-4 is {} as efficient as path tracing. Of all techniques the least error is that of {best}. \
                 Aligned bridges, which are younger than the paper, are {} as efficient as MVNEE-4.",
                times(over_path),
                times(bridges)
            ),
            "Both programs take the same samples; what differs is what they cost.",
        ),
    ]
}
