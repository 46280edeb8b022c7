//! A cloud in a Cornell box, at equal samples and at equal time.

use super::{
    ALIGNED, Contest, Key, MVNEE_4, NEE, NO_FAILURE, PAPER, Technique, claim, convergence, factor, gain, over, speed,
    table, turn_takers,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::Bench;
use crate::paper::measure::Measured;
use crate::paper::ratio::{Channels, Worth};
use crate::paper::reference::Reference;
use crate::paper::section::{Claim, Section};
use crate::paper::turns::{equal_samples, equal_time};

const NAME: &str = "fig10";
const SCENE: &str = "cloud-box";
const FAST: Technique = Technique::new("MVNEE-4-FAST", "mvnee-4-fast", "mvnee")
    .with(&[("render.mesc", Key::Number(4.0)), ("render.seeds", Key::Word("fast"))]);

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = [NEE, MVNEE_4, FAST, ALIGNED];
    let times = bench.times(1.0, 2 * techniques.len());
    let mut contest = Contest::new(bench, (SCENE, &[]), &techniques, &ALIGNED, times);
    let mut of_time = contest.begin()?;
    equal_time(&mut turn_takers(&mut of_time), times.each, bench.tell).expect(NO_FAILURE);
    // As many samples as all of them together would take the same time for.
    let per_sample: f64 = of_time.iter().map(|run| run.seconds() / run.samples()).sum();
    let samples = (times.each * techniques.len() as f64 / per_sample).max(1.0) as u32;
    let mut of_samples = contest.prepared(contest.size)?;
    equal_samples(&mut turn_takers(&mut of_samples), samples, bench.tell).expect(NO_FAILURE);
    let reference = contest.reference(&of_time)?;
    let of_time = contest.measured(of_time, &reference);
    let mut of_samples = contest.measured(of_samples, &reference);
    of_samples.iter_mut().for_each(|one| one.file = format!("samples-{}", one.file));
    let captions = [
        format!("cloud-box at equal time, {} s each.", number(times.each, 3)),
        format!("At equal samples, {samples} per pixel."),
    ];
    section(bench, captions, &of_time, &of_samples, &reference)
}

fn section(
    bench: &Bench<'_>,
    [time, samples]: [String; 2],
    of_time: &[Measured],
    of_samples: &[Measured],
    reference: &Reference,
) -> Result<Section> {
    Ok(Section {
        text: vec![
            "A cloud, of up to 5 collisions per metre, albedo 0.8 and g = 0.9, in a box with coloured walls. MVNEE's \
             seeds are flights through the means of coarse cells along their axis; FAST takes the density at the first \
             seed for all others, so that it puts vertices where the cloud is thin and leaves them out where it is \
             dense. The cloud is ours, the paper's is not published."
                .into(),
        ],
        claims: claims(of_time, of_samples),
        tables: [(&time, of_time), (&samples, of_samples)]
            .map(|(caption, measured)| table(caption, measured, &NEE, reference))
            .to_vec(),
        plots: vec![convergence(bench, NAME, "rmse", "cloud-box", of_time)?],
        galleries: vec![
            bench.gallery(NAME, time, of_time, Some(reference))?,
            bench.gallery(NAME, samples, of_samples, Some(reference))?,
        ],
        turns: Measured::all_turns(of_time.iter().chain(of_samples)),
        ..Section::default()
    })
}

fn claims(of_time: &[Measured], of_samples: &[Measured]) -> Vec<Claim> {
    let of_one = (Worth::Sample, Channels::All);
    let per_sample = over(of_samples, of_one, &MVNEE_4, &NEE);
    let faster = speed(of_time, &FAST, &MVNEE_4);
    let over_nee = gain(of_time, &MVNEE_4, &NEE);
    vec![
        claim(
            "MVNEE works in heterogeneous media: at equal samples it has less error than NEE.",
            PAPER,
            per_sample.is_above(1.0),
            format!("At equal samples NEE's variance is {} that of MVNEE-4.", factor(per_sample)),
            "The cloud and its box are not those of the paper.",
        ),
        claim(
            "The fast variant makes samples cheaper.",
            PAPER,
            faster.is_above(1.0),
            format!(
                "MVNEE-4-FAST has {} the rate of MVNEE-4, but {} its variance: it is {} as efficient as MVNEE-4, and \
                 {} as efficient as NEE.",
                factor(faster),
                factor(over(of_samples, of_one, &FAST, &MVNEE_4).inverse()),
                factor(gain(of_time, &FAST, &MVNEE_4)),
                factor(gain(of_time, &FAST, &NEE))
            ),
            "Weights and seeds read a coarse field of mean extinctions here, so that little is left to save.",
        ),
        claim(
            "At equal time MVNEE has less error than NEE.",
            PAPER,
            over_nee.is_above(1.0),
            format!("MVNEE-4 is {} as efficient as NEE.", factor(over_nee)),
            "A sample of MVNEE takes about twice the time of one of NEE in this scene; see BENCHMARKS.md.",
        ),
    ]
}
