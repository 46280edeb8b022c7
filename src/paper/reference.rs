//! Converged images that others are measured against. They are kept, and added to: sums are exact, so that many runs
//! make the image of one.

use std::path::Path;

use super::Tell;
use super::again::takes_again;
use super::bench::{Bench, TIMES};
use super::measure::Measured;
use super::rmse::{self, Rmse};
use super::run::{Contender, LeftOut, Run};
use super::turns::{Renders, go_on};
use crate::error::{Error, Result};
use crate::figures::{number, percent};
use crate::film::Pixel;
use crate::scene::LoadedScene;
use crate::session::checkpoint::Checkpoint;

/// Share of the least error that it judges which its own is to have at most.
const SHARE: f64 = 1.0 / 3.0;
/// Time between looks at the error `[s]`.
const LOOK: f64 = 1.0;
/// Fewest samples of every pixel: one tells nothing of its error.
const LEAST: f64 = 2.0;

/// An image that others are measured against.
pub struct Reference {
    /// Its file, in the folder of the report.
    pub file: String,
    /// Its pixels.
    pub pixels: Vec<Pixel>,
    /// Samples per pixel.
    pub samples: f64,
}

impl Reference {
    fn of(file: String, pixels: Vec<Pixel>) -> Self {
        let samples = pixels.iter().map(|pixel| pixel.samples as f64).sum::<f64>() / pixels.len() as f64;
        Self { file, pixels, samples }
    }

    /// Its own mean squared error.
    pub fn squared(&self) -> f64 {
        rmse::own(self.pixels.iter().copied())
    }

    /// The root of that.
    pub fn error(&self) -> f64 {
        self.squared().sqrt()
    }

    /// What is said of it above the table of those that it judges.
    pub fn note(&self, judged: &[Measured]) -> String {
        let share = self.error() / judged.iter().filter_map(Measured::error).fold(f64::INFINITY, f64::min);
        let (samples, error) = (number(self.samples, 4), number(self.error(), 2));
        // Where the least error is not known either, so is its share.
        let more = if share <= SHARE { "" } else { " With more --references it would be less." };
        format!(
            "Errors are against a reference of {samples} samples per pixel; its own error, {error}, is subtracted. It \
             is {} of the least.{more}",
            percent(share)
        )
    }
}

/// The squared error that the reference of `runs` may have: so far below the least of theirs that it hardly counts. A
/// run that has hardly found the light does not know its error; `judge`, one of them, is surely not such a one.
pub fn goal(runs: &[Run], judge: &Run) -> f64 {
    let pixels: Vec<_> = judge.film().pixels().collect();
    let squared = |run: &Run| {
        let by_judge = Rmse::of(run.film().pixels().map(|pixel| pixel.mean), &pixels);
        // Where the judge is the noisier one it tells nothing.
        let told = if by_judge.squared > by_judge.reference { by_judge.squared } else { 0.0 };
        rmse::own(run.film().pixels()).max(told)
    };
    let least = runs.iter().map(squared).fold(rmse::own(judge.film().pixels()), f64::min);
    // As good as there is time for where no error is known.
    if least.is_finite() { least / TIMES } else { 0.0 }
}

impl Bench<'_> {
    /// The converged image of `scene`: what there is of it, and up to `seconds` more of it until its squared error is
    /// at most `goal`. What is left out of it is looked at unless that is known.
    ///
    /// # Errors
    /// If it cannot be rendered or written.
    pub fn reference(&self, scene: LoadedScene, left_out: &LeftOut, goal: f64, seconds: f64) -> Result<Reference> {
        let name = format!("{}-{}", scene.name, &scene.hash()[..16]);
        let file = self.folder.reference(&name);
        let path = self.folder.path(&file);
        let sums = path.with_extension("checkpoint");
        let mut run = self.resumed(scene, left_out, &sums)?;
        if !is_good(&run, goal) || !path.is_file() {
            self.tell.line(&format!("  reference of {name}"));
            add_to(&mut run, goal, seconds, self.tell);
            // Pixels without samples would look like pixels without light.
            if run.samples() >= LEAST {
                run.session().write_checkpoint(&sums)?;
                run.write(&path)?;
            }
        }
        Ok(Reference::of(file, run.film().pixels().collect()))
    }

    /// A render of `scene` that goes on from the sums at `path`, if they are its own and those of this program.
    fn resumed(&self, scene: LoadedScene, left_out: &LeftOut, path: &Path) -> Result<Run> {
        let begin = |scene| {
            let contender = Contender { name: "reference".into(), scene };
            Run::begin(contender, left_out, self.workers, self.tell)
        };
        let (mut run, anew) = (begin(scene.clone())?, || begin(scene));
        // What is chosen in a hurry is not what was chosen before.
        if !path.is_file() || self.tell.stops() {
            return Ok(run);
        }
        let finding = match Checkpoint::open(path).and_then(|mut checkpoint| run.resume(&mut checkpoint)) {
            Ok(()) if takes_again(&run)? => return Ok(run),
            Ok(()) => "has samples that this program takes otherwise".to_string(),
            Err(Error { finding, .. }) => finding,
        };
        self.tell.line(&format!("  {} {finding}: begun anew", path.display()));
        anew()
    }
}

/// Whether the squared error of `run` is known, and at most `goal`.
fn is_good(run: &Run, goal: f64) -> bool {
    run.samples() >= LEAST && rmse::own(run.film().pixels()) <= goal
}

/// Has `run` go on for `seconds` or until it is good, at least to where its error is known.
fn add_to(run: &mut Run, goal: f64, seconds: f64, tell: &dyn Tell) {
    let is_over = |run: &mut Run| run.samples() >= LEAST && run.log().has_had(seconds);
    while !is_good(run, goal) && !is_over(run) && !tell.stops() {
        let until = (run.seconds() + LOOK).min(seconds);
        // Our own renders do not fail.
        let _ = go_on(run, until, tell);
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::time::{Duration, Instant};

    use toml::Value;

    use super::*;
    use crate::paper::folder::Folder;
    use crate::paper::run::tests::Quiet;
    use crate::paper::scenes::Scenes;
    use crate::paper::turns::Renders;

    /// A bench in a folder of its own.
    fn with_bench<T>(test: impl FnOnce(&Bench<'_>) -> T) -> T {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("a folder");
        let scenes = Scenes::find(Some(&PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes")));
        let (budget, references) = (Duration::ZERO, Duration::ZERO);
        test(&Bench { folder: &folder, scenes: &scenes, budget, references, workers: 1, tell: &Quiet })
    }

    fn size() -> (&'static str, Value) {
        ("film.size", Value::from(vec![24, 24]))
    }

    fn technique() -> (&'static str, Value) {
        ("render.technique", "bridge".into())
    }

    fn scene(bench: &Bench<'_>) -> LoadedScene {
        bench.scenes.load("spotlight", &[size(), technique()]).expect("a scene")
    }

    #[test]
    fn what_is_kept_is_added_to_until_the_goal_is_reached() {
        with_bench(|bench| {
            let reference = |goal| bench.reference(scene(bench), &LeftOut::new(), goal, 0.2).expect("a reference");
            let first = reference(0.0);
            let second = reference(0.0);
            // As much again in the same time, on a machine that is not many times faster then.
            let more = second.samples / first.samples;
            assert!(first.samples >= 2.0 && more > 1.0 && more < 10.0, "{} {}", first.samples, second.samples);
            assert_eq!(reference(2.0 * second.squared()).samples, second.samples, "it is good enough");
            // The very image of one run of as many samples.
            let contender = Contender { name: "one run".into(), scene: scene(bench) };
            let mut run = Run::begin(contender, &LeftOut::new(), 1, &Quiet).expect("a run");
            run.take(second.samples as u32, &Quiet).expect("a render");
            assert!(run.film().pixels().map(|pixel| pixel.mean).eq(second.pixels.iter().map(|pixel| pixel.mean)));
        });
    }

    #[test]
    fn what_cannot_be_gone_on_with_is_begun_anew() {
        with_bench(|bench| {
            let first = bench.reference(scene(bench), &LeftOut::new(), 0.0, 0.1).expect("a reference");
            let sums = bench.folder.path(&first.file).with_extension("checkpoint");
            std::fs::write(&sums, "torn").expect("a file");
            let second = bench.reference(scene(bench), &LeftOut::new(), 0.0, 0.1).expect("a reference");
            assert!(second.samples >= 1.0 && Checkpoint::open(&sums).is_ok());
        });
    }

    #[test]
    fn samples_of_another_program_are_not_gone_on_with() {
        with_bench(|bench| {
            let first = bench.reference(scene(bench), &LeftOut::new(), 0.0, 0.1).expect("a reference");
            let sums = bench.folder.path(&first.file).with_extension("checkpoint");
            // The checkpoint of the same scene, as it says, with other samples.
            let seed = ("render.seed", Value::from(7));
            let mut other = scene(bench);
            other.frame = bench.scenes.load("spotlight", &[size(), technique(), seed]).expect("a scene").frame;
            let contender = Contender { name: "other".into(), scene: other };
            let mut run = Run::begin(contender, &LeftOut::new(), 1, &Quiet).expect("a run");
            run.take(1000, &Quiet).expect("a render");
            run.session().write_checkpoint(&sums).expect("a checkpoint");
            let second = bench.reference(scene(bench), &LeftOut::new(), 0.0, 0.1).expect("a reference");
            assert!(second.samples < 1000.0, "begun anew");
        });
    }

    /// Somebody who wants it to end some time from now.
    struct Impatient(Instant);

    impl Tell for Impatient {
        fn line(&self, _: &str) {}
        fn stops(&self) -> bool {
            Instant::now() >= self.0
        }
    }

    #[test]
    fn what_is_there_when_somebody_stops_it_is_kept() {
        with_bench(|bench| {
            let stopped = |after: f64| {
                let tell = Impatient(Instant::now() + Duration::from_secs_f64(after));
                let bench = Bench { tell: &tell, ..*bench };
                let reference = bench.reference(scene(&bench), &LeftOut::new(), 0.0, 600.0).expect("a reference");
                assert!(tell.0.elapsed() < Duration::from_secs(60), "{} s too late", tell.0.elapsed().as_secs());
                reference.samples
            };
            // Preparing takes a moment, and may take all of it.
            let samples = [2.0, 0.0, 2.0].map(stopped);
            assert!(samples[0] >= 2.0 && samples[1] == 0.0 && samples[2] > samples[0], "{samples:?}");
        });
    }

    /// A run that has not found the light takes its error for 0; the one that has knows better.
    #[test]
    fn the_goal_is_below_the_least_error_that_is_true() {
        with_bench(|bench| {
            let run = |technique: &str, samples| {
                let keys = [("film.size", Value::from(vec![24, 24])), ("render.technique", technique.into())];
                let scene = bench.scenes.load("spotlight", &keys).expect("a scene");
                let contender = Contender { name: technique.into(), scene };
                let mut run = Run::begin(contender, &LeftOut::new(), 1, &Quiet).expect("a run");
                run.take(samples, &Quiet).expect("a render");
                run
            };
            let runs = [run("path", 2), run("bridge", 64)];
            let own = rmse::own(runs[1].film().pixels());
            assert!((goal(&runs, &runs[1]) * TIMES / own - 1.0).abs() < 1e-9);
        });
    }
}
