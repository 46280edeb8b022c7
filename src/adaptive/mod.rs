//! How many samples which tile gets.
//!
//! An adaptive render gives noisy tiles more samples than others. How many, is a function of its *level*, the number
//! of samples of the mean pixel, and of nothing that is kept:
//!
//! - At levels 16, 32, 64 and so on, *probes* are taken: samples with numbers that no other sample has. They say how
//!   noisy the samples of every tile are, and are then thrown away. So the number of samples of a pixel does not depend
//!   on what these samples are, and their mean is that of a fixed number of samples: unbiased, as are the sums of
//!   squares from which standard errors come. Were it decided by samples that are kept, tiles that happen to look calm
//!   would be left alone with too little light.
//! - Between two such levels the samples of a tile rise in a straight line. Everything about a level is known without
//!   knowing how far a render will go, how it was split over time or machines, or how many threads there are: that is
//!   why adaptive renders can be stopped, resumed and merged to the same bits as others.
//!
//! Noise of an image is a root mean square over pixels. For a number of samples it is least if these are proportional
//! to the standard deviation of one sample of a pixel, relative to its mean (Neyman's allocation); in proportion to the
//! variance, which evens out the noise, it would be no less than with the same number for all. Shares are between an
//! eighth and eight times the mean, so that an error of the probes costs a bounded amount. Up to level 16 all tiles have
//! the same. There is a probe for every eight to sixteen samples that are kept, and none after level 512.

mod probe;

use serde::{Deserialize, Serialize};

use crate::scene::schema::MOST_SAMPLES;
pub use probe::{Cell, cells, variances};

/// Up to this level all tiles have the same number of samples. From there on probes are taken at every doubling.
pub const EVEN: u32 = 16;
/// Probes of every pixel that are taken at level [`EVEN`]; at every doubling as many again as there are.
const FIRST_PROBES: u32 = 2;
/// Number of times that probes are taken.
const PROBINGS: usize = 6;
/// Least and largest share of the samples, relative to the mean.
const SHARES: [f64; 2] = [0.125, 8.0];
/// Parts of a sample in which rates are counted.
const PARTS: u64 = 1 << 12;

/// Which samples tiles have at which level.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Pixels of the tiles.
    pixels: Vec<u64>,
    /// What probes found; none if all tiles get the same.
    probings: Option<Vec<Probing>>,
}

/// What probes of a level found: the variance of samples relative to the squares of their pixels' means, in the mean of
/// every tile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Probing(
    /// Bits of f32, which survive being written as text.
    Vec<u32>,
);

impl Probing {
    /// From the variance of every tile, finite and >= 0.
    pub fn new(variances: &[f64]) -> Self {
        Self(variances.iter().map(|variance| (*variance as f32).to_bits()).collect())
    }

    fn variance(&self, tile: usize) -> f64 {
        f32::from_bits(self.0[tile]).into()
    }

    /// Whether it is one of so many tiles, and its numbers are variances.
    fn fits(&self, tiles: usize) -> bool {
        let is_variance = |bits: &u32| f32::from_bits(*bits).is_finite() && f32::from_bits(*bits) >= 0.0;
        self.0.len() == tiles && self.0.iter().all(is_variance)
    }
}

impl Plan {
    /// The same number of samples for all tiles, or what probes are still to say, for tiles of so many pixels.
    pub fn new(pixels: Vec<u64>, is_adaptive: bool) -> Self {
        Self { pixels, probings: is_adaptive.then(Vec::new) }
    }

    /// What probes have found.
    pub fn probings(&self) -> &[Probing] {
        self.probings.as_deref().unwrap_or_default()
    }

    /// Takes over what probes of the same render found, if that makes sense.
    #[must_use]
    pub fn restore(&mut self, probings: Vec<Probing>) -> Option<()> {
        let fits = probings.len() <= PROBINGS && probings.iter().all(|probing| probing.fits(self.pixels.len()));
        match &mut self.probings {
            Some(own) if fits => *own = probings,
            None if probings.is_empty() => {}
            _ => return None,
        }
        Some(())
    }

    /// Adds what the probes found that [`Self::wanted`] wants next.
    pub fn add(&mut self, probing: Probing) {
        self.probings.as_mut().expect("only adaptive renders are probed").push(probing);
    }

    /// The numbers of the probes that have to be taken before anything is known of `level`; none if it is known.
    pub fn wanted(&self, level: u32) -> Option<core::ops::Range<u32>> {
        let done = self.probings.as_ref()?.len();
        let is_needed = done < PROBINGS && level > EVEN << done;
        is_needed.then(|| MOST_SAMPLES + probes(done)..MOST_SAMPLES + probes(done + 1))
    }

    /// The next level after `level` at which probes are taken; none if there is none.
    pub fn next_probing(&self, level: u32) -> Option<u32> {
        self.probings.as_ref()?;
        (0..PROBINGS).map(|stage| EVEN << stage).find(|next| *next > level)
    }

    /// Number of samples of every tile at `level`.
    ///
    /// # Panics
    /// If probes are wanted before.
    pub fn samples(&self, level: u32) -> Vec<u32> {
        assert_eq!(self.wanted(level), None, "probes before level {level}");
        let mut samples = vec![level.min(EVEN); self.pixels.len()];
        let mut start = EVEN;
        if self.probings.is_none() {
            return vec![level; self.pixels.len()];
        }
        for stage in 0.. {
            if level <= start {
                break;
            }
            let rates = self.rates(stage, start, &samples);
            let steps = u64::from((level - start).min(start));
            for (tile, (samples, rate)) in samples.iter_mut().zip(rates).enumerate() {
                let more = (steps * rate + phase(tile)) / PARTS;
                *samples = (u64::from(*samples) + more).min(MOST_SAMPLES.into()) as u32;
            }
            start = start.saturating_mul(2);
        }
        samples
    }

    /// The largest level up to `most` at which no tile has more samples than `has`, if those up to level `first` are
    /// not counted; relative to that level.
    pub fn level(&self, first: u32, most: u32, has: &[u32]) -> u32 {
        let before = self.samples(first);
        let is_reached = |level: u32| {
            let after = self.samples(level);
            after.iter().zip(&before).zip(has).all(|((after, before), has)| after - before <= *has)
        };
        let (mut low, mut high) = (first, most.max(first));
        while low < high {
            let middle = low + (high - low).div_ceil(2);
            if is_reached(middle) {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        low - first
    }

    /// The last level of which anything is known.
    pub fn last_known(&self) -> u32 {
        match &self.probings {
            Some(probings) if probings.len() < PROBINGS => EVEN << probings.len(),
            _ => MOST_SAMPLES,
        }
    }

    /// Samples per level between level `start`, where every tile has `samples`, and twice that, in [`PARTS`]: what takes
    /// every tile to its share of twice that, as far as it has not had more.
    fn rates(&self, stage: usize, start: u32, samples: &[u32]) -> Vec<u64> {
        let (pixels, level) = (|tile: usize| self.pixels[tile] as f64, f64::from(start));
        let goals = self.shares(stage).into_iter().map(|share| 2.0 * level * share);
        let missing: Vec<_> = goals.zip(samples).map(|(goal, has)| (goal - f64::from(*has)).max(0.0)).collect();
        let sum = |of: &dyn Fn(usize) -> f64| (0..samples.len()).map(|tile| of(tile) * pixels(tile)).sum::<f64>();
        let left = sum(&|tile| 2.0 * level - f64::from(samples[tile]));
        let scale = left / sum(&|tile| missing[tile]);
        missing.iter().map(|missing| (scale * missing / level * PARTS as f64).round() as u64).collect()
    }

    /// Share of every tile in the samples, relative to the mean pixel's.
    fn shares(&self, stage: usize) -> Vec<f64> {
        let probings = &self.probings()[..=stage.min(PROBINGS - 1)];
        let deviation = |tile: usize| {
            // The more probes, the better they know.
            let weighted = |sum: f64, (stage, probing): (usize, &Probing)| {
                sum + f64::from(probes(stage + 1) - probes(stage)) * probing.variance(tile)
            };
            (probings.iter().enumerate().fold(0.0, weighted) / f64::from(probes(probings.len()))).sqrt()
        };
        let shares: Vec<_> = (0..self.pixels.len()).map(deviation).collect();
        let mean = self.mean(&shares);
        if mean == 0.0 {
            return vec![1.0; shares.len()];
        }
        let shares: Vec<_> = shares.iter().map(|share| (share / mean).clamp(SHARES[0], SHARES[1])).collect();
        let mean = self.mean(&shares);
        shares.iter().map(|share| share / mean).collect()
    }

    /// The mean over pixels of a value per tile.
    fn mean(&self, values: &[f64]) -> f64 {
        let sum: f64 = values.iter().zip(&self.pixels).map(|(value, pixels)| value * *pixels as f64).sum();
        sum / self.pixels.iter().sum::<u64>() as f64
    }
}

/// Probes of every pixel, once they were taken so many times.
fn probes(times: usize) -> u32 {
    times.checked_sub(1).map_or(0, |doublings| FIRST_PROBES << doublings)
}

/// Where between two whole samples a tile begins, in [`PARTS`]: evenly spread, so that tiles do not all round alike.
fn phase(tile: usize) -> u64 {
    // Multiples of the golden ratio.
    (u64::from((tile as u32).wrapping_mul(0x9e37_79b9)) * PARTS) >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan of tiles of which a few are noisy, at the edge smaller, with all probes.
    fn plan() -> Plan {
        let tiles = 40;
        let pixels = (0..tiles).map(|tile| if tile % 8 == 7 { 256 } else { 1024 }).collect();
        let mut plan = Plan::new(pixels, true);
        for stage in 0..PROBINGS {
            let noise = |tile: usize| if tile % 5 == stage % 5 || tile == 3 { 9.0 } else { 1.0 };
            plan.add(Probing::new(&(0..tiles).map(noise).collect::<Vec<_>>()));
        }
        plan
    }

    fn mean(plan: &Plan, samples: &[u32]) -> f64 {
        plan.mean(&samples.iter().map(|samples| f64::from(*samples)).collect::<Vec<_>>())
    }

    #[test]
    fn the_level_is_the_mean_number_of_samples() {
        let plan = plan();
        for level in (0..3000).chain([10_000, 1 << 20]) {
            let found = mean(&plan, &plan.samples(level));
            assert!((found - f64::from(level)).abs() < 0.5 + 1e-4 * f64::from(level), "{found} at {level}");
        }
    }

    #[test]
    fn no_tile_ever_loses_samples() {
        let (plan, mut last) = (plan(), Vec::new());
        for level in 0..2100 {
            let next = plan.samples(level);
            assert!(last.iter().zip(&next).all(|(last, next)| last <= next), "at {level}");
            last = next;
        }
    }

    #[test]
    fn samples_follow_the_deviation_within_bounds() {
        let mut plan = Plan::new(vec![64; 4], true);
        for _ in 0..PROBINGS {
            plan.add(Probing::new(&[4.0, 1.0, 1.0, 1e-12]));
        }
        let [noisy, one, other, calm] = plan.samples(4096)[..] else { panic!("four tiles") };
        assert!((f64::from(noisy) / f64::from(one) - 2.0).abs() < 0.01 && one.abs_diff(other) <= 1);
        assert!((f64::from(calm) / f64::from(one) - 0.125).abs() < 0.01, "an eighth of the mean");
    }

    #[test]
    fn nothing_before_a_level_depends_on_what_comes_after() {
        let (all, mut some) = (plan(), Plan::new(plan().pixels, true));
        assert_eq!(some.samples(EVEN), vec![EVEN; 40]);
        for probing in all.probings() {
            let start = some.last_known();
            assert_eq!(some.next_probing(start - 1), Some(start));
            some.add(probing.clone());
            for level in [start + 1, start + 7, 2 * start] {
                assert_eq!(some.wanted(level), None);
                assert_eq!(some.samples(level), all.samples(level), "{level}");
            }
        }
        assert_eq!((some.wanted(u32::MAX), some.next_probing(1 << 10)), (None, None));
    }

    #[test]
    fn probes_are_samples_that_no_render_has() {
        let mut plan = Plan::new(vec![64], true);
        let (mut next, mut level) = (MOST_SAMPLES, EVEN);
        while let Some(probes) = plan.wanted(level + 1) {
            assert_eq!((plan.wanted(level), probes.start), (None, next));
            assert_eq!(8 * (probes.end - MOST_SAMPLES), level, "one in eight so far");
            (next, level) = (probes.end, 2 * level);
            plan.add(Probing::new(&[1.0]));
        }
        assert_eq!((level, plan.last_known()), (1 << 10, MOST_SAMPLES));
    }

    #[test]
    fn a_level_is_known_from_what_tiles_have() {
        for plan in [plan(), Plan::new(vec![64; 40], false)] {
            for (first, level) in [(0, 0), (0, 5), (0, 17), (0, 700), (40, 100), (64, 64)] {
                let (before, after) = (plan.samples(first), plan.samples(level));
                let has: Vec<_> = after.iter().zip(before).map(|(after, before)| after - before).collect();
                let found = first + plan.level(first, 1 << 20, &has);
                assert_eq!(plan.samples(found), after, "{first}..{level}");
                // A tile that lacks one is at a level before.
                let Some(tile) = has.iter().position(|has| *has > 0) else { continue };
                let mut less = has.clone();
                less[tile] -= 1;
                assert!(first + plan.level(first, 1 << 20, &less) < level, "{first}..{level}");
            }
        }
    }

    #[test]
    fn foreign_probes_are_refused() {
        let mut adaptive = Plan::new(vec![64; 2], true);
        assert!(adaptive.restore(vec![Probing::new(&[1.0, 2.0])]).is_some());
        assert!(adaptive.restore(vec![Probing::new(&[1.0])]).is_none());
        assert!(adaptive.restore(vec![Probing::new(&[1.0, f64::NAN])]).is_none());
        assert!(Plan::new(vec![64], false).restore(vec![Probing::new(&[1.0])]).is_none());
        assert!(Plan::new(vec![64], false).restore(Vec::new()).is_some());
    }
}
