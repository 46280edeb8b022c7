//! Renders in turn: each gets a little, then the next, again and again, so that whatever else the machine does slows
//! all of them alike. Sums are exact, so that many small runs make the very image of one.

use super::Tell;
use super::ratio::Turn;
use super::rmse::{self, Rmse};
use crate::film::Pixel;

type Outcome<T> = core::result::Result<T, String>;

/// Length of a turn `[s]`: some of them fit into the time of every contender.
pub const TURN: f64 = 0.5;
/// Fewest and most turns of a contender: from the spread of them comes how sure a comparison is.
pub const TURNS: [u32; 2] = [8, 12];
/// Share of the rest of a turn that the next samples are to take, so that they do not take more.
const CAREFUL: f64 = 0.9;
/// Most samples of every pixel that are taken at a time.
const MOST_SAMPLES: f64 = 1e6;

/// Something that renders a few samples when it is told to: fogbow, or another program.
pub trait Renders {
    /// Takes about `samples` more of every pixel, at least one. Says how many it took, and in how many seconds.
    ///
    /// # Errors
    /// What is wrong with another program.
    fn take(&mut self, samples: u32) -> Outcome<(f64, f64)>;

    /// The image so far, row by row [W/(m^2 sr)].
    ///
    /// # Errors
    /// What is wrong with another program.
    fn means(&mut self) -> Outcome<Vec<[f32; 3]>>;

    /// What it has done.
    fn log(&mut self) -> &mut Log;
}

/// What a render has done so far, turn by turn.
#[derive(Default)]
pub struct Log {
    /// Seconds of rendering.
    pub seconds: f64,
    /// Samples of every pixel.
    pub samples: f64,
    parts: Vec<Part>,
    /// The image after the last turn.
    pub means: Vec<[f32; 3]>,
}

/// One turn.
struct Part {
    seconds: f64,
    samples: f64,
    /// The image of its own samples.
    means: Vec<[f32; 3]>,
}

impl Log {
    /// Adds what was taken, and how long that took.
    pub fn note(&mut self, samples: f64, seconds: f64) {
        self.samples += samples;
        self.seconds += seconds;
    }

    /// Ends a turn that began after `seconds` and `samples`, and left an image of these `means`.
    fn end(&mut self, (seconds, samples): (f64, f64), means: Vec<[f32; 3]>) {
        let before = core::mem::take(&mut self.means);
        let taken = self.samples - samples;
        let own = means.iter().enumerate().map(|(pixel, after)| {
            let before = before.get(pixel).copied().unwrap_or_default();
            [0, 1, 2].map(|c| {
                let sum = self.samples * f64::from(after[c]) - samples * f64::from(before[c]);
                (sum / taken) as f32
            })
        });
        self.parts.push(Part { seconds: self.seconds - seconds, samples: taken, means: own.collect() });
        self.means = means;
    }

    /// Seconds after every turn, and the error of the image of all samples until then.
    pub fn course(&self, reference: &[Pixel]) -> Vec<(f64, f64)> {
        let (mut seconds, mut samples, mut sums) = (0.0, 0.0, vec![[0.0; 3]; reference.len()]);
        let point = |part: &Part| {
            seconds += part.seconds;
            samples += part.samples;
            for (sum, mean) in sums.iter_mut().zip(&part.means) {
                (0..3).for_each(|c| sum[c] += part.samples * f64::from(mean[c]));
            }
            let means = sums.iter().map(|sum| sum.map(|channel: f64| channel / samples));
            (seconds, Rmse::of(means, reference).root())
        };
        self.parts.iter().map(point).collect()
    }

    /// Every turn, and how far its image is from `reference`.
    pub fn turns(&self, reference: Option<&[Pixel]>) -> Vec<Turn> {
        let squared =
            |part: &Part| reference.map_or(f64::NAN, |pixels| Rmse::of(rmse::wide(&part.means), pixels).squared);
        let turn = |part: &Part| Turn { seconds: part.seconds, samples: part.samples, squared: squared(part) };
        self.parts.iter().map(turn).collect()
    }
}

/// Has `one` go on until it has had `seconds` in all, at least for one sample of every pixel.
///
/// # Errors
/// What is wrong with another program.
pub fn go_on(one: &mut dyn Renders, seconds: f64) -> Outcome<()> {
    loop {
        let Log { seconds: before, samples, .. } = *one.log();
        let wanted = CAREFUL * (seconds - before) * samples / before;
        // Nothing is known before the first sample, and less than one there cannot be.
        let wanted = if wanted.is_finite() { wanted.clamp(1.0, MOST_SAMPLES) as u32 } else { 1 };
        let (samples, took) = one.take(wanted)?;
        one.log().note(samples, took);
        if one.log().seconds >= seconds {
            return Ok(());
        }
    }
}

/// A turn, in which `one` does what `go` says.
fn turn(one: &mut dyn Renders, go: impl Fn(&mut dyn Renders) -> Outcome<()>) -> Outcome<()> {
    let before = (one.log().seconds, one.log().samples);
    go(one)?;
    let means = one.means()?;
    one.log().end(before, means);
    Ok(())
}

/// Has all of them go on until each has had `seconds`, in turns, forwards and backwards. What needs longer for a sample
/// of every pixel in each turn takes longer.
///
/// # Errors
/// What is wrong with another program.
pub fn equal_time(all: &mut [&mut dyn Renders], seconds: f64, tell: &dyn Tell) -> Outcome<()> {
    let turns = ((seconds / TURN).ceil() as u32).clamp(TURNS[0], TURNS[1]);
    let until = |turn: u32| seconds * f64::from(turn) / f64::from(turns);
    (1..=turns).try_for_each(|now| in_turn(all, now, |one| turn(one, |one| go_on(one, until(now))), tell))
}

/// Has all of them go on until each has `samples` samples per pixel, in turns.
///
/// # Errors
/// What is wrong with another program.
pub fn equal_samples(all: &mut [&mut dyn Renders], samples: u32, tell: &dyn Tell) -> Outcome<()> {
    let turns = samples.min(TURNS[0]);
    let until = |turn: u32| (u64::from(samples) * u64::from(turn) / u64::from(turns)) as u32;
    let take = |one: &mut dyn Renders, samples: u32| {
        let (samples, took) = one.take(samples)?;
        one.log().note(samples, took);
        Ok(())
    };
    (1..=turns)
        .try_for_each(|now| in_turn(all, now, |one| turn(one, |one| take(one, until(now) - until(now - 1))), tell))
}

/// One turn of each of them, every other one in reverse order.
fn in_turn(
    all: &mut [&mut dyn Renders],
    turn: u32,
    go: impl Fn(&mut dyn Renders) -> Outcome<()>,
    tell: &dyn Tell,
) -> Outcome<()> {
    let count = all.len();
    for place in 0..count {
        if tell.stops() {
            return Ok(());
        }
        go(&mut *all[if turn.is_multiple_of(2) { count - 1 - place } else { place }])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Region;
    use crate::paper::measure::Measured;
    use crate::paper::run::Run;
    use crate::paper::run::tests::{Quiet, runs};

    fn dynamic(runs: &mut [Run]) -> Vec<&mut dyn Renders> {
        runs.iter_mut().map(|run| run as &mut dyn Renders).collect()
    }

    #[test]
    fn many_turns_make_the_image_of_one_run() {
        let (mut turns, mut whole) = (runs(), runs());
        equal_samples(&mut dynamic(&mut turns), 21, &Quiet).expect("renders");
        for (turns, whole) in turns.iter_mut().zip(&mut whole) {
            whole.take(21).expect("a render");
            assert_eq!((turns.samples(), turns.log().parts.len()), (21.0, 8));
            assert!(turns.film().is_same(whole.film()), "{}", turns.name);
        }
    }

    #[test]
    fn all_get_the_same_time_to_within_a_turn() {
        let mut runs = runs();
        equal_time(&mut dynamic(&mut runs), 0.8, &Quiet).expect("renders");
        for run in runs {
            let region = run.film().region();
            assert!(run.samples() >= 8.0 && region == Region::whole(16, 16));
            let measured = Measured::of_run("a", run, None);
            assert!(measured.seconds >= 0.8 && measured.turns.len() == 8 && measured.rate() > 0.0);
            let sum: f64 = measured.turns.iter().map(|turn| turn.seconds).sum();
            assert!((sum - measured.seconds).abs() < 1e-9, "{sum} of {}", measured.seconds);
        }
    }

    /// With variance V of a sample the images of n samples have squared errors of V / n, those of turns as well as the
    /// whole.
    #[test]
    fn turns_have_images_of_their_own() {
        let mut log = Log::default();
        let mut sums = [0.0_f64; 4];
        let turns = [[1.0, 5.0, 2.0, 8.0], [3.0, -1.0, 0.0, 0.0], [2.0, 2.0, 2.0, 2.0]];
        for (turn, own) in turns.iter().enumerate() {
            let before = (log.seconds, log.samples);
            log.note(2.0, 0.5);
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += 2.0 * own);
            let means = sums.map(|sum| [(sum / (2.0 * (turn + 1) as f64)) as f32; 3]).to_vec();
            log.end(before, means);
            for (found, own) in log.parts[turn].means.iter().zip(own) {
                assert!((f64::from(found[1]) - own).abs() < 1e-5, "{found:?} {own}");
            }
        }
        let black = [Pixel { mean: [0.0; 3], standard_error: [0.0; 3], samples: 1 }; 4];
        let squared: Vec<_> = log.turns(Some(&black)).iter().map(|turn| turn.squared).collect();
        for (found, own) in squared.iter().zip(turns) {
            let squared = own.iter().map(|x| x * x).sum::<f64>() / 4.0;
            assert!((found - squared).abs() < 1e-5, "{found} {squared}");
        }
        // After two turns pixels are at 2, 2, 1, 4.
        let (seconds, error) = log.course(&black)[1];
        assert!(seconds == 1.0 && (error - 2.5).abs() < 1e-5, "{error}");
    }
}
