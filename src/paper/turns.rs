//! Renders in turn: each gets a little, then the next, again and again, so that whatever else the machine does slows
//! all of them alike. Sums are exact, so that many small runs make the very image of one.

use super::Tell;
use super::ratio::Turn;
use super::rmse::{self, Rmse};
use super::size;
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
    /// Takes about `samples` more of every pixel, at least one unless `tell` stops it. Says how many it took, and in
    /// how many seconds.
    ///
    /// # Errors
    /// What is wrong with another program.
    fn take(&mut self, samples: u32, tell: &dyn Tell) -> Outcome<(f64, f64)>;

    /// The image so far, row by row [W/(m^2 sr)].
    ///
    /// # Errors
    /// What is wrong with another program.
    fn means(&mut self) -> Outcome<Vec<[f32; 3]>>;

    /// What it has done.
    fn log(&mut self) -> &mut Log;
}

/// What a render has done so far, turn by turn. What another run did before it went on from there does not count.
#[derive(Default)]
pub struct Log {
    /// Seconds of rendering.
    pub seconds: f64,
    /// Samples of every pixel that were taken in them.
    pub samples: f64,
    /// Fewest samples of every pixel that were taken at a time.
    grain: f64,
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
        self.grain = if self.samples > 0.0 { self.grain.min(samples) } else { samples };
        self.samples += samples;
        self.seconds += seconds;
    }

    /// Seconds that the least takes that is taken at a time; not a number before the first sample.
    pub fn step(&self) -> f64 {
        self.seconds / self.samples * self.grain
    }

    /// Whether it has had `seconds`, as nearly as it can be told to: with more it would be farther off.
    pub fn has_had(&self, seconds: f64) -> bool {
        self.samples > 0.0 && self.seconds + 0.5 * self.step() >= seconds
    }

    /// Ends a turn, which left an image of these `means`: all that was done since the last one ended.
    fn end(&mut self, means: Vec<[f32; 3]>) {
        let ended = |sum: fn(&Part) -> f64| self.parts.iter().map(sum).sum::<f64>();
        let (seconds, samples) = (ended(|part| part.seconds), ended(|part| part.samples));
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
        let turn = |part: &Part| {
            let Part { seconds, samples, means } = part;
            let rmse = reference.map(|pixels| Rmse::of(rmse::wide(means), pixels));
            let [squared, green] = rmse.map_or([f64::NAN; 2], |rmse| [rmse.squared, rmse.green]);
            Turn { seconds: *seconds, samples: *samples, squared, green }
        };
        self.parts.iter().map(turn).collect()
    }
}

/// Has `one` go on until it has had `seconds` in all, as nearly as can be, at least for one sample of every pixel, or
/// until `tell` stops it.
///
/// # Errors
/// What is wrong with another program.
pub fn go_on(one: &mut dyn Renders, seconds: f64, tell: &dyn Tell) -> Outcome<()> {
    loop {
        let Log { seconds: before, samples, .. } = *one.log();
        let wanted = CAREFUL * (seconds - before) * samples / before;
        // Nothing is known before the first sample, and less than one there cannot be.
        let wanted = if wanted.is_finite() { wanted.clamp(1.0, MOST_SAMPLES) as u32 } else { 1 };
        let (samples, took) = one.take(wanted, tell)?;
        one.log().note(samples, took);
        if one.log().has_had(seconds) || tell.stops() {
            return Ok(());
        }
    }
}

/// A turn, in which `one` does what `go` says.
fn turn(one: &mut dyn Renders, go: impl Fn(&mut dyn Renders) -> Outcome<()>) -> Outcome<()> {
    go(one)?;
    let means = one.means()?;
    one.log().end(means);
    Ok(())
}

/// The first samples of all of them, which count, of `seconds` that each is to have: the longest time that one of them
/// needs for the least that it takes at a time `[s]`.
///
/// # Errors
/// What is wrong with another program.
pub fn slowest_step(all: &mut [&mut dyn Renders], seconds: f64, tell: &dyn Tell) -> Outcome<f64> {
    let mut slowest = 0.0;
    for one in all {
        if tell.stops() {
            break;
        }
        let mut step = first_step(*one, tell)?;
        if step > size::longest_step(seconds) {
            // The first one wakes threads and fills caches, too.
            step = step.min(first_step(*one, tell)?);
        }
        slowest = f64::max(slowest, step);
    }
    Ok(slowest)
}

/// Seconds of the least that `one` takes at a time.
fn first_step(one: &mut dyn Renders, tell: &dyn Tell) -> Outcome<f64> {
    let (samples, seconds) = one.take(1, tell)?;
    one.log().note(samples, seconds);
    Ok(seconds)
}

/// Has all of them go on until each has had `seconds`, in turns, forwards and backwards. What needs longer for a sample
/// of every pixel in each turn takes longer: see [`size::fitting`].
///
/// # Errors
/// What is wrong with another program.
pub fn equal_time(all: &mut [&mut dyn Renders], seconds: f64, tell: &dyn Tell) -> Outcome<()> {
    let turns = ((seconds / TURN).ceil() as u32).clamp(TURNS[0], TURNS[1]);
    let until = |turn: u32| seconds * f64::from(turn) / f64::from(turns);
    (1..=turns).try_for_each(|now| in_turn(all, now, |one| turn(one, |one| go_on(one, until(now), tell)), tell))
}

/// Has all of them go on until each has `samples` samples per pixel, in turns.
///
/// # Errors
/// What is wrong with another program.
pub fn equal_samples(all: &mut [&mut dyn Renders], samples: u32, tell: &dyn Tell) -> Outcome<()> {
    let turns = samples.min(TURNS[0]);
    let until = |turn: u32| (u64::from(samples) * u64::from(turn) / u64::from(turns)) as u32;
    let take = |one: &mut dyn Renders, samples: u32| {
        let (samples, took) = one.take(samples, tell)?;
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
            whole.take(21, &Quiet).expect("a render");
            assert_eq!((turns.samples(), turns.log().parts.len()), (21.0, 8));
            assert!(turns.film().is_same(whole.film()), "{}", turns.name);
        }
    }

    #[test]
    fn all_get_the_same_time_to_within_half_a_step() {
        let mut runs = runs();
        slowest_step(&mut dynamic(&mut runs), 1.0, &Quiet).expect("renders");
        equal_time(&mut dynamic(&mut runs), 0.8, &Quiet).expect("renders");
        for run in runs {
            let region = run.film().region();
            assert!(run.samples() >= 8.0 && region == Region::whole(16, 16));
            let measured = Measured::of_run("a", run, None);
            assert!((0.76..0.9).contains(&measured.seconds), "{}", measured.seconds);
            assert!(measured.turns.len() == 8 && measured.rate() > 0.0);
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
            log.note(2.0, 0.5);
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += 2.0 * own);
            let means = sums.map(|sum| [(sum / (2.0 * (turn + 1) as f64)) as f32; 3]).to_vec();
            log.end(means);
            for (found, own) in log.parts[turn].means.iter().zip(own) {
                assert!((f64::from(found[1]) - own).abs() < 1e-5, "{found:?} {own}");
            }
        }
        let black = [Pixel { mean: [0.0; 3], standard_error: [0.0; 3], samples: 9 }; 4];
        let squared: Vec<_> = log.turns(Some(&black)).iter().map(|turn| turn.squared).collect();
        for (found, own) in squared.iter().zip(turns) {
            let squared = own.iter().map(|x| x * x).sum::<f64>() / 4.0;
            assert!((found - squared).abs() < 1e-5, "{found} {squared}");
        }
        // After two turns pixels are at 2, 2, 1, 4.
        let (seconds, error) = log.course(&black)[1];
        assert!(seconds == 1.0 && (error - 2.5).abs() < 1e-5, "{error}");
    }

    /// A render of which a sample takes a while, by a clock of its own.
    struct Slow {
        seconds: f64,
        log: Log,
    }

    impl Renders for Slow {
        fn take(&mut self, samples: u32, _: &dyn Tell) -> Outcome<(f64, f64)> {
            Ok((f64::from(samples), f64::from(samples) * self.seconds))
        }

        fn means(&mut self) -> Outcome<Vec<[f32; 3]>> {
            Ok(vec![[1.0; 3]])
        }

        fn log(&mut self) -> &mut Log {
            &mut self.log
        }
    }

    #[test]
    fn slow_ones_stop_where_they_are_nearest_to_their_time() {
        for step in [0.003, 0.01, 0.19, 0.21, 0.4] {
            let mut slow = Slow { seconds: step, log: Log::default() };
            assert_eq!(slowest_step(&mut [&mut slow], 1.0, &Quiet), Ok(step));
            equal_time(&mut [&mut slow], 5.0, &Quiet).expect("a render");
            let Log { seconds, parts, .. } = slow.log;
            assert!((seconds - 5.0).abs() <= 0.5 * step + 1e-9 && parts.len() == 10, "{seconds} in steps of {step}");
        }
    }
}
