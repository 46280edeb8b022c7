//! Light through a perforated plate in dense fog, at equal time.

use super::{
    ALIGNED, BRIDGES, Contest, MVNEE_2, MVNEE_4, MVNEE_6, MVNEE_8, Match, NEE, OMNEE, PAPER, PATH, PROGRAM, Published,
    Technique, beside_published, claim, convergence, factor, gain, gain_of_green, of, speed, table,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::section::{Claim, Section};

const NAME: &str = "fig8";

const PUBLISHED: [Published; 6] = [
    (&PATH, 713.0, Some(23.2)),
    (&NEE, 412.0, Some(15.6)),
    (&MVNEE_2, 531.0, Some(12.9)),
    (&MVNEE_4, 357.0, Some(4.63)),
    (&MVNEE_6, 171.0, Some(3.24)),
    (&MVNEE_8, 121.0, Some(3.08)),
];

/// Why MVNEE gains more here than published.
const WHY: &str = "Variances are nearly the same; what differs is what samples cost. NEE connects all vertices, 19 per \
                   sample, and traces every connection, which is most of its time. Of the few connections that MVNEE-4 \
                   makes the weights are known before they are traced, and nine in ten are too small to be: they play \
                   roulette, which the published program does not.";

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [PATH, NEE, MVNEE_2, MVNEE_4, MVNEE_6, MVNEE_8, OMNEE, BRIDGES, ALIGNED];
    let times = bench.times(1.0, techniques.len());
    let mut contest = Contest::new(bench, ("dense-plate", &[]), &techniques, &ALIGNED, times);
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
        tables: vec![table(&caption, &measured, &NEE, &reference), beside_published(&PUBLISHED, &measured, "")],
        plots: vec![convergence(bench, NAME, "rmse", "dense-plate", &measured)?],
        galleries: vec![gallery],
        turns: Measured::all_turns(&measured),
        ..Section::default()
    })
}

fn claims(measured: &[Measured]) -> Vec<Claim> {
    let over_nee = gain_of_green(measured, &MVNEE_4, &NEE);
    let longest = gain_of_green(measured, &MVNEE_8, &MVNEE_4);
    let best = measured.first().map_or("-", |one| one.name.as_str());
    let [over_path, bridges] = [(&MVNEE_4, &PATH), (&ALIGNED, &MVNEE_4)].map(|(a, b)| gain(measured, a, b));
    let (of_nee, of_mvnee) = (rate_over_published(measured, &NEE), rate_over_published(measured, &MVNEE_4));
    vec![
        claim(
            "MVNEE renders this scene with less error than NEE in the same time: MVNEE-4 is 3.0 times as efficient.",
            PROGRAM,
            over_nee.is_about(3.0),
            format!(
                "In green MVNEE-4 is {} as efficient as NEE. Rates are {} times the published one with NEE, and {} \
                 times with MVNEE-4.",
                factor(over_nee),
                number(of_nee, 2),
                number(of_mvnee, 2)
            ),
            WHY,
        ),
        claim(
            "Longer connections pay up to MESC 4; weights of longer ones, O(n^2) each, cost more than they gain: \
             MVNEE-8 has half the efficiency of MVNEE-4.",
            PROGRAM,
            longest.is_about(0.5),
            format!(
                "In green MVNEE-8 is {} as efficient as MVNEE-4, at {} its rate.",
                factor(longest),
                factor(speed(measured, &MVNEE_8, &MVNEE_4))
            ),
            "Weights are summed here for eight paths at once, and vertices that are farther from the light than MESC \
             cost only a test, so that long connections lose less time than in the published program, which has a \
             third of the rate at MESC 8.",
        ),
        claim(
            "Of path tracing, NEE and MVNEE, the last is the best.",
            PAPER,
            gain(measured, &MVNEE_4, &NEE).is_above(1.0).and(over_path.is_above(1.0)),
            format!(
                "MVNEE-4 is {} as efficient as path tracing. Of all techniques the least error is that of {best}. \
                 Aligned bridges, which are younger than the paper, are {} as efficient as MVNEE-4.",
                factor(over_path),
                factor(bridges)
            ),
            WHY,
        ),
    ]
}

/// How many times the published rate that of `technique` is.
fn rate_over_published(measured: &[Measured], technique: &Technique) -> f64 {
    let published = PUBLISHED.iter().find(|one| one.0.name == technique.name).map_or(f64::NAN, |one| 1e3 * one.1);
    of(measured, technique).map_or(f64::NAN, Measured::rate) / published
}
