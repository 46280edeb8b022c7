//! A cloud in a Cornell box, at equal samples and at equal time.

use super::{
    ALIGNED, FOR_REFERENCE, Key, MVNEE_4, NEE, PAPER, SEED_OF_REFERENCES, Technique, all_measured, claim, convergence,
    gain, of, sorted, table, times,
};
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::{Bench, Reference};
use crate::paper::measure::{Measured, equal_samples, equal_time};
use crate::paper::section::{Claim, Section};

const NAME: &str = "fig10";
const SCENE: &str = "cloud-box";
const FAST: Technique = Technique::new("MVNEE-4-FAST", "mvnee-4-fast", "mvnee")
    .with(&[("render.mesc", Key::Number(4.0)), ("render.seeds", Key::Word("fast"))]);

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let techniques = || [NEE, MVNEE_4, FAST, ALIGNED];
    let budget = bench.budget.as_secs_f64();
    let seconds = 0.5 * (1.0 - FOR_REFERENCE) * budget / techniques().len() as f64;
    let seed = [("render.seed", toml::Value::from(SEED_OF_REFERENCES))];
    let best = ALIGNED.contender(bench, SCENE, seconds, &seed)?;
    let reference = bench.reference(best.scene, FOR_REFERENCE * budget)?;
    let begin = || {
        let contenders: Result<Vec<_>> =
            techniques().iter().map(|technique| technique.contender(bench, SCENE, seconds, &[])).collect();
        bench.begin(contenders?)
    };
    let mut runs = begin()?;
    equal_time(&mut runs, seconds, bench.tell);
    // As many samples as all of them together would take the same time for.
    let per_sample: f64 = runs.iter().map(|run| run.seconds / run.samples()).sum();
    let samples = (seconds * techniques().len() as f64 / per_sample).max(1.0) as u32;
    let of_time = sorted(all_measured(bench, &techniques(), runs, &reference));
    let mut runs = begin()?;
    equal_samples(&mut runs, samples, bench.tell);
    let mut of_samples = sorted(all_measured(bench, &techniques(), runs, &reference));
    of_samples.iter_mut().for_each(|one| one.file = format!("samples-{}", one.file));
    section(bench, &of_time, &of_samples, &reference, samples)
}

fn section(
    bench: &Bench<'_>,
    of_time: &[Measured],
    of_samples: &[Measured],
    reference: &Reference,
    samples: u32,
) -> Result<Section> {
    let seconds = number(of_time.first().map_or(0.0, |one| one.run.seconds), 3);
    let captions =
        [format!("cloud-box at equal time, {seconds} s each."), format!("At equal samples, {samples} per pixel.")];
    let [time, samples] = &captions;
    Ok(Section {
        text: vec![
            "A cloud, of up to 5 collisions per metre, albedo 0.8 and g = 0.9, in a box with coloured walls. MVNEE's \
             seeds are flights through the means of coarse cells along their axis; FAST takes the density at the first \
             seed for all others. The cloud is ours, the paper's is not published."
                .into(),
        ],
        claims: claims(of_time, of_samples),
        tables: vec![table(time, of_time, &NEE), table(samples, of_samples, &NEE)],
        plots: vec![convergence(bench, NAME, "rmse", "cloud-box", of_time)?],
        galleries: vec![
            bench.gallery(NAME, time, of_time, Some(reference))?,
            bench.gallery(NAME, samples, of_samples, Some(reference))?,
        ],
        ..Section::default()
    })
}

fn claims(of_time: &[Measured], of_samples: &[Measured]) -> Vec<Claim> {
    let variance = |technique| of(of_samples, technique).map_or(f64::NAN, Measured::variance);
    let per_sample = variance(&NEE) / variance(&MVNEE_4);
    let rate = |technique| of(of_time, technique).map_or(f64::NAN, |one| one.run.rate());
    let faster = rate(&FAST) / rate(&MVNEE_4);
    let over_nee = gain(of_time, &MVNEE_4, &NEE);
    vec![
        claim(
            "MVNEE works in heterogeneous media: at equal samples it has less error than NEE.",
            PAPER,
            per_sample > 1.0,
            format!("At equal samples NEE's variance is {} that of MVNEE-4.", times(per_sample)),
            "The cloud and its box are not those of the paper.",
        ),
        claim(
            "The fast variant makes samples cheaper.",
            PAPER,
            faster > 1.0,
            format!("MVNEE-4-FAST has {} the rate of MVNEE-4.", times(faster)),
            "Weights and seeds read a coarse field of mean extinctions here, so that little is left to save.",
        ),
        claim(
            "At equal time MVNEE has less error than NEE.",
            PAPER,
            over_nee > 1.0,
            format!("MVNEE-4 is {} as efficient as NEE.", times(over_nee)),
            "A sample of MVNEE takes about twice the time of one of NEE in this scene; see BENCHMARKS.md.",
        ),
    ]
}
