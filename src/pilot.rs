//! The pilot: a short look at a scene that picks what is most efficient for it.
//!
//! How many vertices should connect, and how readily a walk should end, belong to the scene: in open fog the first
//! vertex suffices, behind a perforated plate the later ones find the holes. A pilot renders the whole image small,
//! once per setting, and keeps the setting with the smallest product of variance and cost.
//!
//! Where there are surfaces, connections have to be traced, in a grid their transmittance has to be estimated, and
//! weights of MVNEE look at every vertex from every start. Connections that contribute less than a quarter of the mean of
//! the image may play roulette before. More would save little, as nearly all that is faint is fainter than that, and
//! would be seen: what plays roulette is bright in the dark parts of an image.
//!
//! A look so short may miss the rare samples that make a setting bad, and would then take it for the best. So the
//! noisiest hundredth of the pixels, in which a few such samples would decide, count no more than the noisiest of the
//! others; a variance counts with twice its standard error, from the spread over parts of the samples; and a setting
//! whose mean is not that of the one which leaves least to luck, most starts, longest walks and no roulette, found
//! something else than the image.
//!
//! The cost is counted work, not time, and the pilot's samples are those of a seed of its own: the choice is the same
//! on every machine, for every split of the samples, and independent of the samples that are kept.

mod cost;
mod depths;
mod trial;

use core::ops::Range;

use fogbow_kernels::PathLengths;
use fogbow_kernels::pipeline::WIDEST;
use fogbow_kernels::survival::Survival;

use crate::film::{Film, Region, tile_size};
use crate::frame::Frame;
use crate::render::{Monitor, Renderer};
use crate::stats::Stats;
use cost::cost;
use trial::Look;
pub use trial::{Trial, best};

/// Numbers of starts to try; the last is all.
const STARTS: [u32; 6] = [1, 2, 3, 4, 8, u32::MAX];
/// Longest paths, in segments, for which all starts are tried: their cost grows with the square of that number, and
/// beyond it is more than a hundred times that of eight starts.
const LONGEST_FOR_ALL: u32 = 128;
/// Survival probabilities to try.
const SURVIVALS: [f32; 3] = [1.0, 0.9, 0.75];
/// Longest side of the pilot's image in pixels.
const SIDE: u32 = 24;
/// Most samples per pixel and setting, in parts.
const SAMPLES: u32 = 32;
/// Most work of a trial in about nanoseconds of one core, where a sample may take any time.
const MOST_WORK_OF_TRIAL: f64 = 2e10;
/// Parts whose spread tells how well a variance is known.
const PARTS: u32 = 4;
/// Samples per pixel in a part.
const SHARE: u32 = SAMPLES / PARTS;
/// Parts after which a trial that is far from the best ends.
const FIRST_PARTS: u32 = 2;
/// Far means less than this share of the best efficiency, even if its variance is no more than it seems.
const FAR: f64 = 0.8;
/// Contribution below which connections play roulette, over the mean of the image.
const FAINT: f64 = 0.25;
/// Share of the best efficiency that is as good as the best.
const NEARLY: f64 = 0.9;
/// Makes the pilot's seed another than the frame's.
const SEED: u32 = 0x9e37_79b9;

/// The seed of the pilot's samples for a frame of `seed`: another one, under which light importance sampling draws
/// nothing either.
pub fn seed(seed: u32) -> u32 {
    seed ^ SEED
}

/// What is left to the pilot; everything else stays as the frame has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choices {
    /// How many vertices connect.
    pub starts: bool,
    /// How readily a walk ends.
    pub survival: bool,
    /// What plays roulette.
    pub roulette: bool,
}

impl Choices {
    /// Whether any of them matters to `frame`.
    pub fn matter_to(self, frame: &Frame) -> bool {
        self.that_matter(frame) != Self::default()
    }

    /// Those that matter to `frame`. Without bridges, which need lights that have a place, there are no starts and
    /// survivals to try: techniques that do not reach every path need every walk. Where there are volumes every vertex
    /// connects: bridges through vacuum count nothing, and few starts may see next to nothing of a volume without any
    /// variance that tells. Without surfaces or volumes next to nothing is traced, and roulette is tried for the weights
    /// of MVNEE alone.
    fn that_matter(self, frame: &Frame) -> Self {
        let scatters = !frame.stays_straight() && frame.lengths.max > 2;
        let bridges = scatters && frame.techniques.bridge.is_some() && !frame.lights.lights().is_empty();
        let is_dear = frame.is_solid() || frame.varies() || frame.techniques.mvnee.is_some();
        let plays = scatters && frame.techniques.any() && is_dear;
        let Self { starts, survival, roulette } = self;
        let starts = bridges && starts && !frame.wanders() && !frame.varies();
        Self { starts, survival: (bridges || frame.wanders()) && survival, roulette: plays && roulette }
    }
}

/// How a frame is rendered, as far as the pilot may choose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Vertices that connect; `u32::MAX` for all.
    pub starts: u32,
    /// Probability of going on from a vertex.
    pub survival: Survival,
    /// Contribution below which connections play roulette [W/(m^2 sr)].
    pub roulette: f32,
}

impl Setting {
    fn of(frame: &Frame) -> Self {
        Self { starts: frame.walk.starts, survival: frame.walk.survival, roulette: frame.roulette }
    }

    /// `frame` rendered like this.
    pub fn apply(self, frame: &Frame) -> Frame {
        Frame { roulette: self.roulette, ..frame.clone() }.with_walk(self.starts, self.survival)
    }
}

/// `frame` with the most efficient of the settings that `choices` allow, and the trials that led to it.
///
/// A roulette below a part of the mean of the image is tried with the first number of starts, then numbers of starts
/// with walks that go on, then survivals with the best of these, and where an early end is the best, the next numbers of
/// starts with that. All starts are tried before numbers in between, as means are judged by theirs, and these until one
/// is worse. What is far from the best ends after half of its samples. Walks of any length, and those in volumes, end by
/// their depth: in something dense, which bridges from outside rarely get deep into, the few walks of an early end that
/// get there would count as much as all of those that did not.
///
/// `size` is that of the whole image. Choices that make no difference to the frame are not tried. Once `monitor` says
/// stop no further setting is tried, and the one at hand does not count.
pub fn choose(
    frame: &Frame,
    size: [u32; 2],
    choices: Choices,
    renderer: &Renderer,
    monitor: &Monitor,
) -> (Frame, Vec<Trial>) {
    let mut choices = choices.that_matter(frame);
    let monitor = &monitor.of_looks();
    let pilot = Pilot::new(frame, size, renderer, monitor);
    let mut search = Search { pilot, trials: Vec::new(), setting: Setting::of(frame) };
    if (frame.wanders() || frame.varies()) && choices.survival {
        let cost = search.find_depths();
        choices.survival = false;
        choices.roulette &= search.pilot.can_afford(cost);
    }
    if choices != Choices::default() {
        search.begin(choices);
    }
    if choices.roulette {
        search.try_roulette();
    }
    if choices.starts {
        search.try_starts(frame.lengths.max);
    }
    if choices.survival && (search.setting.starts > 1 || !frame.surfaces.is_empty()) {
        search.try_survivals();
    }
    if choices.starts && choices.survival && !search.setting.survival.is_certain() {
        search.try_neighbours();
    }
    (search.setting.apply(frame), search.trials)
}

/// `frame` as it is rendered where there was no time to try what `choices` allow: as it is, but that no more vertices of
/// long paths connect than would have been tried.
pub fn untried(frame: &Frame, choices: Choices) -> Frame {
    let [.., most, _] = STARTS;
    let is_long = choices.that_matter(frame).starts && frame.lengths.max > LONGEST_FOR_ALL;
    let Setting { starts, .. } = Setting::of(frame);
    Setting { starts: if is_long { starts.min(most) } else { starts }, ..Setting::of(frame) }.apply(frame)
}

/// The next smaller and larger number of starts.
fn neighbours(starts: u32) -> (Option<u32>, Option<u32>) {
    let smaller = STARTS.into_iter().rev().find(|other| *other < starts);
    (smaller, STARTS.into_iter().find(|other| *other > starts && *other < u32::MAX))
}

/// What was tried so far, and how to try more.
struct Search<'a> {
    pilot: Pilot<'a>,
    trials: Vec<Trial>,
    /// The best so far.
    setting: Setting,
}

impl Search<'_> {
    /// Tries what the frame has, with as few starts as may be chosen.
    fn begin(&mut self, choices: Choices) {
        let starts = if choices.starts { STARTS[0] } else { self.setting.starts };
        self.attempt(Setting { starts, ..self.setting });
    }

    /// Has walks end by their depth. Says what a sample will cost.
    fn find_depths(&mut self) -> f64 {
        let Some((survival, cost)) = depths::survival(&self.pilot, self.setting) else { return 0.0 };
        self.setting.survival = survival;
        cost
    }

    fn try_roulette(&mut self) {
        let mean = self.trials.first().map_or(0.0, |trial| trial.mean);
        self.attempt(Setting { roulette: (FAINT * mean) as f32, ..self.setting });
    }

    /// Tries the other numbers of starts, for paths of up to `longest` segments: first the largest, whose mean is right if
    /// any is, then the others until one is less efficient.
    fn try_starts(&mut self, longest: u32) {
        let base = self.setting;
        let affordable = |starts: &u32| *starts < u32::MAX || longest <= LONGEST_FOR_ALL;
        let others: Vec<_> = STARTS[1..].iter().copied().filter(affordable).collect();
        let [fewer @ .., most] = &others[..] else { return };
        self.attempt(Setting { starts: *most, ..base });
        for starts in fewer {
            self.attempt(Setting { starts: *starts, ..base });
            let (last, best) = (self.trials.last(), best(&self.trials));
            if last.zip(best).is_some_and(|(last, best)| last.is_below(NEARLY * best.efficiency())) {
                return;
            }
        }
    }

    /// Tries shorter walks.
    fn try_survivals(&mut self) {
        let base = self.setting;
        let longest = base.survival.at(1);
        let shorter = SURVIVALS.into_iter().filter(|survival| *survival < longest);
        shorter.for_each(|survival| self.attempt(Setting { survival: survival.into(), ..base }));
    }

    /// Tries the next numbers of starts.
    fn try_neighbours(&mut self) {
        let base = self.setting;
        let (before, after) = neighbours(base.starts);
        [before, after].into_iter().flatten().for_each(|starts| self.attempt(Setting { starts, ..base }));
    }

    /// Tries a setting, and keeps the best so far.
    fn attempt(&mut self, setting: Setting) {
        if !self.pilot.monitor.stops() {
            let efficiency = best(&self.trials).map_or(0.0, |best| best.efficiency());
            let trial = self.pilot.attempt(setting, FAR * efficiency);
            self.trials.extend((!self.pilot.monitor.stops()).then_some(trial));
        }
        self.setting = best(&self.trials).map_or(setting, |best| best.setting);
    }
}

struct Pilot<'a> {
    frame: Frame,
    region: Region,
    renderer: &'a Renderer,
    monitor: &'a Monitor,
}

impl<'a> Pilot<'a> {
    fn new(frame: &Frame, size: [u32; 2], renderer: &'a Renderer, monitor: &'a Monitor) -> Self {
        let (frame, region) = frame.small(size, SIDE);
        // Directly seen light is the same in all trials, and its edge is coarse in a small image.
        let lengths = PathLengths { min: frame.lengths.min.max(2), ..frame.lengths };
        Self { frame: Frame { lengths, seed: seed(frame.seed), ..frame }, region, renderer, monitor }
    }

    /// Whether a trial of samples of this cost takes no longer than it should.
    fn can_afford(&self, cost: f64) -> bool {
        self.work(cost, SAMPLES) <= MOST_WORK_OF_TRIAL
    }

    /// The work of so many samples per pixel of this cost.
    fn work(&self, cost: f64, samples: u32) -> f64 {
        cost * f64::from(samples) * self.region.pixels() as f64
    }

    /// Tries a setting, with fewer samples if it turns out to have less than so much efficiency.
    fn attempt(&self, setting: Setting, least: f64) -> Trial {
        let mut looks = self.looks(setting, 0..FIRST_PARTS);
        let first = Trial::of(setting, &looks);
        if first.is_below(least) {
            return first;
        }
        looks.extend(self.looks(setting, FIRST_PARTS..PARTS));
        Trial::of(setting, &looks)
    }

    /// Looks at parts of the samples of a setting.
    fn looks(&self, setting: Setting, parts: Range<u32>) -> Vec<Look> {
        let frame = setting.apply(&self.frame);
        parts.map(|part| self.look(&frame, part)).collect()
    }

    fn look(&self, frame: &Frame, part: u32) -> Look {
        let film = Film::new(frame, self.region, tile_size(self.region));
        let samples = part * SHARE..(part + 1) * SHARE;
        let empty = Stats::new(false).with_work();
        let stats = self.renderer.render_counting(empty, frame, &WIDEST, &film, samples, self.monitor);
        let squares = |errors: [f64; 3]| errors.iter().map(|error| error * error).sum::<f64>();
        let variances = film.pixels().map(|pixel| squares(pixel.standard_error) * f64::from(SHARE)).collect();
        let cost = cost(&stats, frame) / stats.samples as f64;
        let (means, errors) = film.mean();
        let brightest = (1..3).fold(0, |best, channel| if means[channel] > means[best] { channel } else { best });
        Look { variances, cost, mean: means[brightest], mean_error: errors[brightest] }
    }
}
