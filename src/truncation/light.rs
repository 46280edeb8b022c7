//! Light by the length of its paths, as looks saw it, and what is beyond a length.

use core::ops::Range;

use fogbow_kernels::LONGEST_PATH;

use super::tail::{Fate, SLOWEST, Tail};
use super::{Share, TOLERATED};

/// Relative standard error beyond which nothing is known of an amount of light.
const UNKNOWN: f64 = 0.5;
/// Standard errors by which what is said to be so is so.
const SURE: f64 = 2.0;
/// Share of the light of some paths of which a look that finds less does not see them.
const SEEN: f64 = 0.5;

/// Light by length, look by look.
pub struct Light {
    looks: Vec<Vec<f64>>,
    /// Whether long paths are seen if there are any.
    sees_far: bool,
    /// What becomes of the longest.
    fate: Fate,
    /// Whether enough was found to say anything at all.
    is_sound: bool,
    /// Whether there is an end to it in sight.
    is_known: bool,
    /// That of all looks together.
    all: Beyond,
    /// The same without each of them.
    without: Vec<Beyond>,
}

impl Light {
    /// Of `short` up to the length to which it goes, of `long` from there on.
    pub fn new(short: &[Vec<f64>], long: &[Vec<f64>], fate: Fate) -> Self {
        Self::joined(short, long, true, fate)
    }

    fn joined(short: &[Vec<f64>], long: &[Vec<f64>], sees_far: bool, fate: Fate) -> Self {
        let join = |(short, long): (&Vec<f64>, &Vec<f64>)| [short, &long[short.len()..]].concat();
        Self::of(short.iter().zip(long).map(join).collect(), sees_far, fate)
    }

    /// The same where either may miss what the other sees: up to that length it is, of every doubling, that of those who
    /// see it better ([`sees_better`]). If `long` hardly finds the light of the last doubling, it does not know what is
    /// beyond.
    pub fn of_the_better(short: &[Vec<f64>], long: &[Vec<f64>], fate: Fate) -> Self {
        let longest = short[0].len() - 1;
        let starts = core::iter::successors(Some(1), |start| Some(2 * start)).take_while(|start| *start < longest);
        let mut best = short.to_vec();
        for start in starts {
            let lengths = start + 1..(2 * start).min(longest) + 1;
            let [found, by_long] = [short, long].map(|looks| mean_and_error(sums(looks, lengths.clone())));
            if sees_better([by_long, found]) {
                let looks = best.iter_mut().zip(long);
                looks.for_each(|(look, long)| look[lengths.clone()].copy_from_slice(&long[lengths.clone()]));
            }
        }
        let last = || longest / 2 + 1..longest + 1;
        let [(found, error), (by_long, error_by_long)] = [short, long].map(|looks| mean_and_error(sums(looks, last())));
        let (all, _) = mean_and_error(sums(&best, 0..longest + 1));
        let surely = found - SURE * error;
        let sees_far = surely <= TOLERATED * all || by_long + SURE * error_by_long > SEEN * surely;
        Self::joined(&best, long, sees_far, fate)
    }

    fn of(looks: Vec<Vec<f64>>, sees_far: bool, fate: Fate) -> Self {
        let lengths = 0..looks[0].len();
        let all: Vec<f64> = lengths.map(|n| looks.iter().map(|look| look[n]).sum()).collect();
        let without = |look: &Vec<f64>| {
            let rest: Vec<f64> = all.iter().zip(look).map(|(all, one)| (all - one).max(0.0)).collect();
            Beyond::of(&rest, fate)
        };
        let (without, all) = (looks.iter().map(without).collect(), Beyond::of(&all, fate));
        let is_sound = sees_far && is_found(&looks);
        let is_known = is_sound && !grows(&looks);
        Self { looks, sees_far, fate, is_sound, is_known, all, without }
    }

    /// Whether no look found any.
    pub fn is_black(&self) -> bool {
        self.looks.iter().flatten().all(|light| *light == 0.0)
    }

    /// Whether there is an end to it in sight.
    pub fn is_known(&self) -> bool {
        self.is_known
    }

    /// The share of the light on paths of more than `limit` segments.
    pub fn share(&self, limit: u32) -> Share {
        if self.is_known {
            let (share, error) = self.jackknife(|beyond| beyond.share(limit));
            return Share::About { share, error };
        }
        let (share, error) = self.jackknife(|beyond| beyond.share_seen(limit));
        let least = share - SURE * error;
        if self.is_sound && least > TOLERATED { Share::AtLeast(least) } else { Share::Unknown }
    }

    /// Whether `limit` leaves out no more than is tolerated if the estimate is right.
    pub fn is_enough(&self, limit: u32) -> bool {
        matches!(self.share(limit), Share::About { share, .. } if share <= TOLERATED)
    }

    /// A round limit that surely leaves out no more than is tolerated: so say all looks together, and either half of
    /// them alone confirms it. A few looks that happened to miss rare long paths would otherwise be sure of too little.
    pub fn sufficient(&self) -> Option<u32> {
        let half =
            |odd: usize| Self::of(self.looks.iter().skip(odd).step_by(2).cloned().collect(), self.sees_far, self.fate);
        let limits = [self.first(SURE), half(0).first(SURE), half(1).first(SURE)];
        limits.into_iter().try_fold(0, |largest, limit| Some(largest.max(limit?)))
    }

    /// A round limit that leaves out no more than is tolerated if the estimate is right.
    pub fn likely(&self) -> Option<u32> {
        self.first(0.0)
    }

    /// The first limit, in eighths of a power of two, that leaves out no more than is tolerated, should the share be
    /// more than estimated by so many standard `errors`.
    fn first(&self, errors: f64) -> Option<u32> {
        let next = |n: &u32| Some(n + ((n + 1).next_power_of_two() / 16).max(1));
        let limits = core::iter::successors(Some(1), next).take_while(|n| *n <= LONGEST_PATH);
        let is_enough = |limit: &u32| match self.share(*limit) {
            Share::About { share, error } => share + errors * error <= TOLERATED,
            Share::AtLeast(_) | Share::Unknown => false,
        };
        limits.into_iter().find(is_enough)
    }

    /// A figure of all looks together, and its standard error from what it is without each of them.
    fn jackknife(&self, figure: impl Fn(&Beyond) -> f64) -> (f64, f64) {
        let (_, error) = mean_and_error(self.without.iter().map(&figure));
        (figure(&self.all), error * (self.looks.len() - 1) as f64)
    }
}

/// Whether looks found light enough to say anything of it.
fn is_found(looks: &[Vec<f64>]) -> bool {
    let (mean, error) = mean_and_error(looks.iter().map(|look| look.iter().sum()));
    mean > 0.0 && error < UNKNOWN * mean
}

/// Whether one of two kinds of looks, each with mean and standard error, sees light better than the other: the brighter,
/// as either may miss some; but if that is no more than its noise, such as a single bright path in all looks, the one
/// that is surer of what it found, if it found any.
fn sees_better([one, other]: [(f64, f64); 2]) -> bool {
    let [(found, error), (found_by_other, error_of_other)] = [one, other];
    if (found - found_by_other).abs() > error.hypot(error_of_other) {
        return found > found_by_other;
    }
    let doubt = |(found, error): (f64, f64)| if found > 0.0 { error / found } else { f64::INFINITY };
    doubt(one) < doubt(other)
}

/// Whether the last doublings surely bring more than they may where light fades.
fn grows(looks: &[Vec<f64>]) -> bool {
    let excess = |look: &Vec<f64>| {
        let [early, .., last] = octaves(look);
        last - SLOWEST * SLOWEST * early
    };
    let (excess, error) = mean_and_error(looks.iter().map(excess));
    excess > SURE * error
}

/// The light beyond each length.
struct Beyond {
    /// That of paths longer than so many segments, extrapolated light included.
    longer_than: Vec<f64>,
    /// What is extrapolated.
    tail: Tail,
}

impl Beyond {
    /// Of the light at each length.
    fn of(light: &[f64], fate: Fate) -> Self {
        let tail = Tail::of(octaves(light), fate);
        let light = light.iter().rev();
        let mut longer_than: Vec<f64> =
            light.scan(tail.after(0), |sum, light| Some(core::mem::replace(sum, *sum + light))).collect();
        longer_than.reverse();
        Self { longer_than, tail }
    }

    /// Share of all light of paths longer than `limit`.
    fn share(&self, limit: u32) -> f64 {
        let longest = (self.longer_than.len() - 1) as f64;
        let farther = || self.tail.beyond(f64::from(limit) / longest);
        let beyond = self.longer_than.get(limit as usize).copied().unwrap_or_else(farther);
        fraction(beyond, self.longer_than[0])
    }

    /// The same of the light that was seen.
    fn share_seen(&self, limit: u32) -> f64 {
        let tail = self.tail.after(0);
        let beyond = self.longer_than.get(limit as usize).map_or(0.0, |beyond| beyond - tail);
        fraction(beyond, self.longer_than[0] - tail)
    }
}

fn fraction(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// The light at some lengths, look by look.
fn sums(looks: &[Vec<f64>], lengths: Range<usize>) -> impl Iterator<Item = f64> {
    looks.iter().map(move |look| look[lengths.clone()].iter().sum())
}

/// The light of the last doublings of the length.
fn octaves(light: &[f64]) -> [f64; 3] {
    let longest = light.len() - 1;
    [4, 2, 1].map(|part| light[longest / part / 2 + 1..=longest / part].iter().sum())
}

/// Mean and its standard error.
fn mean_and_error(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, (spread / (count - 1.0) / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light that falls with a power of the length.
    fn algebraic(power: f64, longest: u32) -> Vec<f64> {
        (0..=longest).map(|n| if n == 0 { 0.0 } else { f64::from(n).powf(-power) }).collect()
    }

    /// The light seen by looks that differ by `spread`, alternately.
    fn looks(light: &[f64], spread: f64) -> Light {
        let factor = |look: u32| 1.0 + if look.is_multiple_of(2) { spread } else { -spread };
        let look = |number: u32| {
            let parts = light.iter().enumerate();
            parts.map(|(n, light)| if n > 32 { factor(number) * light } else { *light }).collect()
        };
        Light::of((0..16).map(look).collect(), true, Fate::Stays)
    }

    #[test]
    fn an_algebraic_tail_is_extrapolated() {
        for power in [1.5, 2.0, 3.0] {
            let truth = algebraic(power, 10_000_000);
            let all: f64 = truth.iter().sum();
            let beyond = Beyond::of(&truth[..=256], Fate::Stays);
            for limit in [15, 100, 255, 256, 500] {
                let share = truth[limit + 1..].iter().sum::<f64>() / all;
                let found = beyond.share(limit as u32);
                assert!((found / share - 1.0).abs() < 0.03, "{found} of {share} beyond {limit}, power {power}");
            }
        }
    }

    /// Paths in something thick and white that ends, of which looks saw the beginning of the end.
    #[test]
    fn light_that_leaves_falls_exponentially() {
        for scale in [20.0, 40.0, 80.0] {
            let light: Vec<f64> = (0..=256).map(|n| f64::exp(-f64::from(n) / scale)).collect();
            let truth = |limit: f64| f64::exp(-limit / scale);
            let beyond = Beyond::of(&light, Fate::Leaves);
            for limit in [20, 256, 512, 1024] {
                let (found, truth) = (beyond.share(limit), truth(f64::from(limit)));
                assert!((found - truth).abs() < 0.01 * truth + 1e-6, "{found} of {truth} beyond {limit}, {scale}");
            }
            let as_if_it_stayed = Beyond::of(&light, Fate::Stays).share(1024);
            assert!(scale < 80.0 || as_if_it_stayed > 0.03, "{as_if_it_stayed}");
        }
    }

    #[test]
    fn light_that_falls_faster_has_no_tail() {
        let light: Vec<f64> = (0..=256).map(|n| 0.9_f64.powi(n)).collect();
        let light = looks(&light, 0.0);
        let Share::About { share, error } = light.share(20) else { panic!("{:?}", light.share(20)) };
        assert!((share / 0.9_f64.powi(20) - 1.0).abs() < 1e-2 && error < 1e-9, "{share} +- {error}");
        assert!((44..=48).contains(&light.sufficient().expect("a limit")), "{:?}", light.sufficient());
    }

    #[test]
    fn light_that_still_grows_has_no_end_in_sight() {
        let light: Vec<f64> = (0..=256).map(f64::from).collect();
        let light = looks(&light, 0.1);
        assert!(!light.is_known());
        let Share::AtLeast(least) = light.share(24) else { panic!("{:?}", light.share(24)) };
        assert!((0.97..0.992).contains(&least), "{least} of 0.991");
        assert_eq!((light.share(256), light.share(1000), light.sufficient()), (Share::Unknown, Share::Unknown, None));
    }

    #[test]
    fn where_no_light_or_that_of_a_single_path_was_found_nothing_is_known() {
        let mut light = looks(&[0.0; 257], 0.0);
        assert!(light.is_black() && !light.is_known());
        assert_eq!((light.share(8), light.sufficient()), (Share::Unknown, None));
        light.looks[3][200] = 1.0;
        let light = Light::of(light.looks, true, Fate::Stays);
        assert!(!light.is_black());
        assert_eq!((light.share(8), light.sufficient()), (Share::Unknown, None));
    }

    #[test]
    fn a_limit_that_half_of_the_looks_do_not_confirm_is_not_offered() {
        let mut light = looks(&(0..=256).map(|n| 0.9_f64.powi(n)).collect::<Vec<_>>(), 0.0);
        let early = light.sufficient().expect("a limit");
        light.looks.iter_mut().step_by(2).for_each(|look| look[100] = 0.25);
        light.looks.iter_mut().skip(2).step_by(2).for_each(|look| look[100] = 0.0);
        let light = Light::of(light.looks, true, Fate::Stays);
        assert!(light.sufficient().is_none_or(|limit| limit > 90 && limit > early), "{:?}", light.sufficient());
    }

    #[test]
    fn light_that_one_kind_of_look_misses_is_that_of_the_other() {
        let falls = |n: i32| 0.9_f64.powi(n);
        let looks = |light: &dyn Fn(i32) -> f64, longest: i32| vec![(0..=longest).map(light).collect::<Vec<_>>(); 8];
        let (short, long) = (looks(&falls, 32), looks(&falls, 256));
        let truth = Light::new(&short, &long, Fate::Stays).share(20);
        let misses = |n: i32| if n > 4 { 1e-3 * falls(n) } else { falls(n) };
        let by_long = Light::of_the_better(&looks(&misses, 32), &long, Fate::Stays);
        assert!(by_long.is_known() && by_long.share(20) == truth, "{:?}, not {truth:?}", by_long.share(20));
        // The long ones see nothing there, so what they see beyond is nothing to go by.
        let blind = Light::of_the_better(&short, &looks(&misses, 256), Fate::Stays);
        assert!(!blind.is_known() && blind.sufficient().is_none());
        assert_eq!(blind.share(20), Share::Unknown);
        // Where hardly any light is as long, it does not matter who sees it.
        let ends = |n: i32| if n > 12 { 1e-6 } else { falls(n) };
        let none = |n: i32| if n > 12 { 0.0 } else { falls(n) };
        assert!(Light::of_the_better(&looks(&ends, 32), &looks(&none, 256), Fate::Stays).is_known());
    }

    #[test]
    fn a_single_bright_path_does_not_make_looks_see_better() {
        let looks = |longest: usize| vec![(0..=longest).map(|n| 0.9_f64.powi(n as i32)).collect::<Vec<_>>(); 8];
        let (mut short, mut long) = (looks(32), looks(256));
        // Walks are a little uncertain everywhere.
        long.iter_mut().step_by(2).flatten().for_each(|light| *light *= 1.01);
        short[5][20] += 8.0;
        let truth = 0.9_f64.powi(16);
        let light = Light::of_the_better(&short, &long, Fate::Stays);
        let Share::About { share, error } = light.share(16) else { panic!("{:?}", light.share(16)) };
        assert!((share - truth).abs() < 0.01 * truth && error < 0.01 * truth, "{share} +- {error} of {truth}");
    }

    #[test]
    fn those_who_found_nothing_never_see_better() {
        let single = mean_and_error([0.0, 0.0, 5.0, 0.0].into_iter());
        let nothing = (0.0, 0.0);
        assert!(sees_better([single, nothing]) && !sees_better([nothing, single]));
        assert!(!sees_better([nothing, nothing]));
    }

    /// A limit is offered where two standard errors more would still be tolerated.
    #[test]
    fn noise_asks_for_a_larger_limit() {
        let light = algebraic(1.8, 256);
        let limits = [0.0, 0.5].map(|spread| looks(&light, spread).sufficient().expect("a limit"));
        assert!(limits[0] < limits[1], "{limits:?}");
        let likely = looks(&light, 0.5).likely().expect("a limit");
        assert!(likely < limits[1], "{likely} and {limits:?}");
        let Share::About { share, error } = looks(&light, 0.5).share(limits[1]) else { panic!("unknown") };
        assert!(error > 0.0 && share + 2.0 * error <= TOLERATED, "{share} +- {error}");
    }
}
