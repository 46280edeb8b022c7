//! Levels of a session: how many samples its tiles have, and are to have.
//!
//! Levels are counted from the session's first sample, which in parts of a render is not that of the plan.

use core::ops::Range;
use std::sync::{MutexGuard, PoisonError};

use super::Session;
use crate::adaptive::{self, Plan, Probing};
use crate::film::{Coverage, Part};
use crate::render::Samples;
use crate::scene::schema::MOST_SAMPLES;

impl Session {
    pub(super) fn plan(&self) -> MutexGuard<'_, Plan> {
        self.plan.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether noisy tiles get more samples than others.
    pub fn is_adaptive(&self) -> bool {
        self.settings.adaptive
    }

    /// The level of which all pixels have all samples; in a render that is not adaptive, the number of samples that all
    /// pixels have.
    pub fn level(&self) -> u32 {
        let (plan, first) = (self.plan(), self.settings.first_sample);
        if plan.wanted(first).is_some() {
            return 0; // nothing was rendered yet
        }
        plan.level(first, plan.last_known(), &self.film.samples_of_tiles())
    }

    /// The largest number of samples of every pixel with which a round may end that begins with `done`.
    pub(super) fn last_of_round(&self, done: u32) -> u32 {
        let first = self.settings.first_sample;
        self.plan().next_probing(first + done).unwrap_or(MOST_SAMPLES) - first
    }

    /// Takes probes until something is known of `level`; whether that is so before the monitor says stop.
    pub(super) fn probe(&self, level: u32) -> bool {
        let pipeline = self.settings.reference.pipeline();
        let level = self.settings.first_sample + level;
        while let Some(probes) = { self.plan().wanted(level) } {
            let monitor = self.monitor.of_looks();
            let found = self.renderer.probe(&self.scene.frame, &pipeline, &self.film, probes, &monitor);
            let Some(cells) = found else { return false };
            self.plan().add(Probing::new(&adaptive::variances(&cells)));
        }
        true
    }

    /// The samples of all tiles up to `level`, of which something is known.
    pub(super) fn samples_until(&self, level: u32) -> Samples {
        let (plan, first) = (self.plan(), self.settings.first_sample);
        let ranges = plan.samples(first).into_iter().zip(plan.samples(first + level));
        Samples::MissingOf(ranges.map(|(first, end)| Range { start: first, end }).collect())
    }

    /// The level that it is beyond, if some pixels have more samples than at `level`; in a render that is not adaptive,
    /// the number of samples of the pixel with most.
    pub fn most_beyond(&self, level: u32) -> Option<u32> {
        let (plan, first) = (self.plan(), self.settings.first_sample);
        let known = plan.last_known();
        let before = plan.wanted(first).is_none().then(|| plan.samples(first))?;
        let at = |level: u32| plan.samples(first.saturating_add(level).min(known));
        let has = self.film.samples_of_tiles();
        let is_beyond =
            |level: u32| at(level).iter().zip(&before).zip(&has).any(|((n, before), has)| has > &(n - before));
        if !is_beyond(level) {
            return None;
        }
        // The first level that has all of them.
        let (mut low, mut high) = (level + 1, known.saturating_sub(first).max(level + 1));
        while low < high {
            let middle = low + (high - low) / 2;
            if is_beyond(middle) { low = middle + 1 } else { high = middle }
        }
        Some(low)
    }

    /// The levels that its film has, which are the same samples as those of its coverage: none unless it is adaptive and
    /// ended at a level, as a number of samples or a noise has it end, so that no tile has samples beyond it.
    pub fn levels(&self) -> Option<Coverage> {
        let (first, level) = (self.settings.first_sample, self.level());
        let is_whole = self.is_adaptive() && self.most_beyond(level).is_none();
        is_whole.then(|| Coverage::of(vec![Part { region: self.film.region(), samples: first..first + level }]))
    }

    /// Which samples its film has.
    pub fn coverage(&self) -> Coverage {
        let (plan, first) = (self.plan(), self.settings.first_sample);
        if plan.wanted(first).is_some() {
            return Coverage::default();
        }
        self.film.coverage(&plan.samples(first))
    }
}
