//! Renders in turn: each gets a little, then the next, again and again, so that whatever else the machine does slows
//! all of them alike. Sums are exact, so that many small runs make the very image of one.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::rmse::Rmse;
use super::{Tell, bench};
use crate::error::Result;
use crate::figures::{number, rate};
use crate::film::Film;
use crate::scene::LoadedScene;
use crate::session::{Limits, Outcome, Session, Settings, Target};

/// Length of a turn [s]: some of them fit into the time of every contender.
const TURN: f64 = 0.5;
/// Most turns of a contender.
const MOST_TURNS: f64 = 24.0;
/// Share of the rest of a turn that the next samples are to take, so that they do not take more.
const CAREFUL: f64 = 0.9;

/// Something to render in turn with others.
pub struct Contender {
    /// What it is called.
    pub name: String,
    /// What is rendered.
    pub scene: LoadedScene,
}

/// A render that goes on in turns.
pub struct Run {
    /// What it is called.
    pub name: String,
    session: Session,
    last: Option<Outcome>,
    /// Seconds of rendering so far.
    pub seconds: f64,
    /// Seconds that went before the first sample.
    pub preparation: f64,
    /// Samples per second in every turn.
    pub rates: Vec<f64>,
}

impl Run {
    /// Prepares a render.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn begin(contender: Contender, threads: usize, tell: &dyn Tell) -> Result<Self> {
        let (Contender { name, scene }, start) = (contender, Instant::now());
        let mut session = Session::new(scene, Settings { threads, ..Settings::default() })?;
        let stop = std::sync::Arc::clone(&session.monitor().stop);
        session.prepare(false, |_| stop.store(tell.stops(), Ordering::Relaxed));
        // It stops what prepares; turns ask for themselves.
        stop.store(false, Ordering::Relaxed);
        let preparation = start.elapsed().as_secs_f64();
        Ok(Self { name, session, last: None, seconds: 0.0, preparation, rates: Vec::new() })
    }

    /// What it has of the image.
    pub fn film(&self) -> &Film {
        &self.session.film
    }

    /// The render.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Samples per pixel.
    pub fn samples(&self) -> f64 {
        f64::from(self.session.level())
    }

    /// Camera paths so far.
    pub fn paths(&self) -> f64 {
        self.film().samples() as f64
    }

    /// Samples per second, the median over all turns.
    pub fn rate(&self) -> f64 {
        median(&self.rates)
    }

    /// Half the spread of the middle half of the rates, over their median.
    pub fn spread(&self) -> f64 {
        let mut rates = self.rates.clone();
        rates.sort_by(f64::total_cmp);
        let quarter = |k: usize| rates.get((k * rates.len().saturating_sub(1) + 2) / 4).copied().unwrap_or(0.0);
        0.5 * (quarter(3) - quarter(1)) / quarter(2).max(f64::MIN_POSITIVE)
    }

    /// Takes `samples` more of every pixel.
    pub fn take(&mut self, samples: u32) {
        let (start, level) = (Instant::now(), self.session.level());
        let outcome = self.session.run(Limits::from(Target::Samples(level + samples)), || false, |_| {});
        self.seconds += start.elapsed().as_secs_f64();
        self.last = Some(outcome);
    }

    /// Goes on until it has had `seconds`, at least for one sample of every pixel.
    pub fn until(&mut self, seconds: f64, tell: &dyn Tell) {
        while (self.seconds < seconds || self.last.is_none()) && !tell.stops() {
            self.turn(seconds.min(self.seconds + TURN));
        }
    }

    /// A turn, which ends once it has had `seconds` in all.
    fn turn(&mut self, seconds: f64) {
        let (paths, before) = (self.paths(), self.seconds);
        while self.seconds < seconds || self.last.is_none() {
            let per_sample = self.seconds / self.samples();
            let samples = CAREFUL * (seconds - self.seconds) / per_sample;
            // Nothing is known before the first sample, and less than one there cannot be.
            self.take(if samples.is_finite() { samples.clamp(1.0, 1e6) as u32 } else { 1 });
        }
        if self.seconds > before {
            self.rates.push((self.paths() - paths) / (self.seconds - before));
        }
    }

    /// Writes its image.
    ///
    /// # Errors
    /// If that is impossible.
    pub fn write(&self, path: &Path) -> Result<()> {
        let Some(outcome) = &self.last else { return Ok(()) };
        self.session.write(outcome, path, bench::FORMAT, || false)
    }
}

/// Has every run go on until each has had `seconds`: in turns, forwards and backwards.
pub fn equal_time(runs: &mut [Run], seconds: f64, tell: &dyn Tell) {
    let turns = (seconds / TURN).ceil().clamp(1.0, MOST_TURNS);
    for turn in 1..=turns as usize {
        in_turn(runs, turn, |run| run.turn(seconds * turn as f64 / turns), tell);
    }
}

/// Has every run go on until each has `samples` samples per pixel, in turns.
pub fn equal_samples(runs: &mut [Run], samples: u32, tell: &dyn Tell) {
    let turns = samples.min(8);
    for turn in 1..=turns {
        let until = u64::from(samples) * u64::from(turn) / u64::from(turns);
        in_turn(
            runs,
            turn as usize,
            |run| {
                let (paths, before) = (run.paths(), run.seconds);
                run.take((until as u32).saturating_sub(run.session.level()));
                run.rates.push((run.paths() - paths) / (run.seconds - before).max(1e-9));
            },
            tell,
        );
    }
}

/// One turn of every run, every other one in reverse order.
fn in_turn(runs: &mut [Run], turn: usize, go: impl Fn(&mut Run), tell: &dyn Tell) {
    let count = runs.len();
    for place in 0..count {
        if tell.stops() {
            return;
        }
        go(&mut runs[if turn.is_multiple_of(2) { count - 1 - place } else { place }]);
    }
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// A run, and how far it is from the reference.
pub struct Measured {
    /// What its files are called.
    pub file: String,
    /// The run.
    pub run: Run,
    /// Its error, if there is a reference.
    pub rmse: Option<Rmse>,
}

impl Measured {
    /// What is printed on its picture.
    pub fn note(&self) -> String {
        let rmse = self.rmse.map_or_else(String::new, |rmse| format!("RMSE {}, ", number(rmse.root(), 3)));
        format!("{rmse}{} samples", number(self.run.samples(), 4))
    }

    /// Mean squared error of one sample per pixel: what its error would be after one.
    pub fn variance(&self) -> f64 {
        self.rmse.map_or(f64::NAN, |rmse| rmse.squared.max(0.0)) * self.run.samples()
    }

    /// The same of green alone, which is what was published for some scenes.
    pub fn variance_of_green(&self) -> f64 {
        self.rmse.map_or(f64::NAN, |rmse| rmse.green.max(0.0)) * self.run.samples()
    }

    /// One over the product of squared error and time per camera path: what a second is worth.
    pub fn efficiency(&self) -> f64 {
        self.run.rate() / self.variance()
    }

    /// Its squared error, for those who sort by it.
    pub fn squared(&self) -> f64 {
        self.rmse.map_or(f64::INFINITY, |rmse| rmse.squared)
    }

    /// Its row in a table: name, samples, rate, RMSE, variance, and efficiency over `base`.
    pub fn row(&self, base: f64) -> Vec<String> {
        vec![
            self.run.name.clone(),
            number(self.run.samples(), 4),
            format!("{} +- {}", rate(self.run.rate()), crate::figures::percent(self.run.spread())),
            self.rmse.map_or_else(|| "-".into(), |rmse| number(rmse.root(), 3)),
            number(self.variance_of_green(), 3),
            format!("{} x", number(self.efficiency() / base, 3)),
        ]
    }

    /// Titles of the columns of [`Self::row`].
    pub fn columns(base: &str) -> Vec<String> {
        let last = format!("efficiency over {base}");
        ["technique", "samples per pixel", "rate", "RMSE", "variance of green", &last].map(String::from).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Region;
    use crate::scene;

    struct Quiet;

    impl Tell for Quiet {
        fn line(&self, _: &str) {}
        fn stops(&self) -> bool {
            false
        }
    }

    fn contender(name: &str, technique: &str) -> Contender {
        let text = format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nvertical_fov_deg = 50\n\
             [film]\nsize = [16, 16]\n[medium]\nscattering = 1.0\n[[light]]\ntype = \"disk\"\ncenter = [0, 0, -3]\n\
             normal = [0, 0, 1]\nradius = 1.0\nradiance = 5.0\n[render]\nmax_segments = 8\ntechnique = \"{technique}\""
        );
        let scene = scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        Contender { name: name.into(), scene }
    }

    fn runs() -> Vec<Run> {
        let both = [contender("a", "path"), contender("b", "nee")];
        both.into_iter().map(|one| Run::begin(one, 1, &Quiet).expect("a run")).collect()
    }

    #[test]
    fn many_turns_make_the_image_of_one_run() {
        let (mut turns, mut whole) = (runs(), runs());
        equal_samples(&mut turns, 21, &Quiet);
        for (turns, whole) in turns.iter().zip(&mut whole) {
            whole.take(21);
            assert_eq!((turns.samples(), turns.rates.len()), (21.0, 8));
            assert!(turns.film().is_same(whole.film()), "{}", turns.name);
        }
    }

    #[test]
    fn all_get_the_same_time_to_within_a_turn() {
        let mut runs = runs();
        equal_time(&mut runs, 1.2, &Quiet);
        for run in &runs {
            assert!(run.seconds >= 1.2 && run.rates.len() == 3 && run.rate() > 0.0, "{}", run.seconds);
            assert!(run.samples() >= 1.0 && run.film().region() == Region::whole(16, 16));
        }
    }
}
