//! Converged images that others are measured against. They are kept, and added to: sums are exact, so that many runs make
//! the image of one.

use std::path::Path;

use super::bench::{Bench, TIMES};
use super::rmse::{self, Rmse};
use super::run::{Contender, LeftOut, Run};
use crate::error::Result;
use crate::figures::number;
use crate::film::Pixel;
use crate::image;
use crate::scene::LoadedScene;
use crate::session::checkpoint::Checkpoint;

/// Time between looks at the error `[s]`.
const LOOK: f64 = 1.0;

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

    /// What is said of it below the table of those that it judges.
    pub fn note(&self) -> String {
        format!(
            "Errors are against a reference of {} samples per pixel; its own error, {}, is subtracted.",
            number(self.samples, 4),
            number(self.error(), 2)
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
    runs.iter().map(squared).fold(rmse::own(judge.film().pixels()), f64::min) / TIMES
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
        let cached = cached(&path).map(|pixels| Reference::of(file.clone(), pixels));
        if let Some(reference) = cached.filter(|reference| reference.squared() <= goal) {
            return Ok(reference);
        }
        self.tell.line(&format!("  reference of {}", scene.name));
        let sums = path.with_extension("checkpoint");
        let mut run = self.resumed(scene, left_out, &sums)?;
        while run.seconds() < seconds && !self.tell.stops() {
            run.until((run.seconds() + LOOK).min(seconds), self.tell);
            if rmse::own(run.film().pixels()) <= goal {
                break;
            }
        }
        let reference = Reference::of(file, run.film().pixels().collect());
        // What there is when somebody stops it counts, too.
        if run.seconds() > 0.0 {
            run.session().write_checkpoint(&sums)?;
            run.write(&path)?;
        }
        Ok(reference)
    }

    /// A render of `scene` that goes on from the sums at `path`, if they are its own.
    fn resumed(&self, scene: LoadedScene, left_out: &LeftOut, path: &Path) -> Result<Run> {
        let contender = Contender { name: "reference".into(), scene };
        let mut run = Run::begin(contender, left_out, self.workers, self.tell)?;
        if path.is_file() {
            let resumed = Checkpoint::open(path).and_then(|mut checkpoint| run.resume(&mut checkpoint));
            if let Err(error) = resumed {
                self.tell.line(&format!("  begun anew: {error}"));
            }
        }
        Ok(run)
    }
}

/// The pixels of the reference at `path`, if this version of the program made it.
fn cached(path: &Path) -> Option<Vec<Pixel>> {
    let image = image::exr::read_image(path).ok()?;
    let name = format!("{}version", image::exr::PREFIX);
    let version = image.header.iter().find(|(entry, _)| *entry == name).map(|(_, text)| text.as_str());
    if version == Some(env!("CARGO_PKG_VERSION")) { pixels(&image) } else { None }
}

/// The pixels of an EXR image with standard errors.
fn pixels(image: &image::Image) -> Option<Vec<Pixel>> {
    let planes = |prefix: &str| {
        let [red, green, blue] = ["R", "G", "B"].map(|name| image.channel(&format!("{prefix}{name}")));
        Some([red?, green?, blue?])
    };
    let (means, errors, samples) = (planes("")?, planes("SE.")?, image.channel("N")?);
    let at = |planes: [&[f32]; 3], i: usize| planes.map(|plane| f64::from(plane[i]));
    let pixel = |i| Pixel { mean: at(means, i), standard_error: at(errors, i), samples: samples[i] as u64 };
    Some((0..image.width * image.height).map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::time::Duration;

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

    fn scene(bench: &Bench<'_>) -> LoadedScene {
        let size = ("film.size", Value::from(vec![24, 24]));
        bench.scenes.load("spotlight", &[size, ("render.technique", "bridge".into())]).expect("a scene")
    }

    #[test]
    fn what_is_kept_is_added_to_until_the_goal_is_reached() {
        with_bench(|bench| {
            let reference = |goal| bench.reference(scene(bench), &LeftOut::new(), goal, 0.2).expect("a reference");
            let first = reference(0.0);
            let second = reference(0.0);
            assert!(first.samples >= 1.0 && second.samples > first.samples, "{} {}", first.samples, second.samples);
            assert_eq!(reference(2.0 * second.squared()).samples, second.samples, "it is good enough");
            // The very image of one run of as many samples.
            let contender = Contender { name: "one run".into(), scene: scene(bench) };
            let mut run = Run::begin(contender, &LeftOut::new(), 1, &Quiet).expect("a run");
            run.take(second.samples as u32).expect("a render");
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

    /// A run that has not found the light takes its error for 0; the one that has knows better.
    #[test]
    fn the_goal_is_below_the_least_error_that_is_true() {
        with_bench(|bench| {
            let run = |technique: &str, samples| {
                let keys = [("film.size", Value::from(vec![24, 24])), ("render.technique", technique.into())];
                let scene = bench.scenes.load("spotlight", &keys).expect("a scene");
                let contender = Contender { name: technique.into(), scene };
                let mut run = Run::begin(contender, &LeftOut::new(), 1, &Quiet).expect("a run");
                run.take(samples).expect("a render");
                run
            };
            let runs = [run("path", 2), run("bridge", 64)];
            let own = rmse::own(runs[1].film().pixels());
            assert!((goal(&runs, &runs[1]) * TIMES / own - 1.0).abs() < 1e-9);
        });
    }
}
