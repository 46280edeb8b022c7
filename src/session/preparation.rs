//! What is decided before the first sample of a render, step by step, and how long that may take.

use std::sync::atomic::Ordering;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::checkpoint::Checkpoint;
use super::rounds::{TICK, watched};
use super::{Limits, Session, State};
use crate::figures::duration;
use crate::frame::Frame;
use crate::image::tone::Exposure;
use crate::metering;
use crate::pilot::{self, Setting, Trial};
use crate::render::Monitor;
use crate::scene::LoadedScene;
use crate::truncation::{self, Truncation};

/// Of the time that a render may take, what may go by before its first sample: one in so many parts.
const PARTS: u32 = 4;
/// Time that preparing may take however little there is.
const LEAST: Duration = Duration::from_millis(250);

/// A step of the preparation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The pilot tries how vertices connect and how walks end.
    Choosing,
    /// The light meter looks at the scene.
    Metering,
    /// What the limit on the length of paths leaves out is looked at.
    LongPaths,
}

impl Step {
    /// What is being done.
    pub fn name(self) -> &'static str {
        match self {
            Self::Choosing => "choosing how to connect",
            Self::Metering => "metering",
            Self::LongPaths => "looking at long paths",
        }
    }

    /// What follows if it was not finished.
    fn consequence(self) -> &'static str {
        match self {
            Self::Choosing => "how to connect is not chosen for the scene",
            Self::Metering => "PNG images are exposed for what is rendered of them",
            Self::LongPaths => "how much light longer paths would bring is not known",
        }
    }
}

/// What was decided before the first sample.
#[derive(Clone, Debug, Default)]
pub struct Preparation {
    /// What the pilot tried.
    pub trials: Vec<Trial>,
    /// What the limit on the length of paths leaves out.
    pub left_out: Option<Truncation>,
    /// Exposure of PNG images, if any is to be written and it is settled before they are rendered.
    pub exposure: Option<Exposure>,
    /// Whether there will be PNG images.
    pub has_png: bool,
    /// Steps for which there was not enough time, or which somebody stopped. What they had found is not used.
    pub unfinished: Vec<Step>,
    /// Time that it was given, if it was limited.
    pub given: Option<Duration>,
}

impl Preparation {
    /// What a person should know of what was not finished.
    pub fn warning(&self) -> Option<String> {
        let given = duration(self.given.filter(|_| !self.unfinished.is_empty())?.as_secs_f64());
        let consequences: Vec<_> = self.unfinished.iter().map(|step| step.consequence()).collect();
        let finding = format!("preparing may take {given} of the time, which was not enough");
        Some(format!("{finding}: {}; more time lets it finish", consequences.join("; ")))
    }

    /// What is left out, if that is worth a word and known as well as it can be.
    pub fn warning_of_left_out(&self) -> Option<Truncation> {
        let is_finished = !self.unfinished.contains(&Step::LongPaths);
        self.left_out.filter(|left_out| is_finished && left_out.matters())
    }
}

/// What is asked of a preparation.
#[derive(Default)]
struct Aims {
    has_png: bool,
    /// What was chosen before, if it is known.
    chosen: Option<Setting>,
    /// What is left out, if it is known.
    left_out: Option<Option<Truncation>>,
}

/// A running preparation.
struct Running {
    /// Says stop once its time is up, or the session's monitor says so.
    monitor: Monitor,
    step: Mutex<Option<Step>>,
}

impl Running {
    fn step(&self) -> Option<Step> {
        *self.step.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin(&self, step: Step) {
        *self.step.lock().unwrap_or_else(PoisonError::into_inner) = Some(step);
    }

    /// Takes a step; none if it was not finished, which is noted.
    fn take<T>(&self, step: Step, unfinished: &mut Vec<Step>, work: impl FnOnce(&Monitor) -> T) -> Option<T> {
        self.begin(step);
        let found = work(&self.monitor);
        if self.monitor.stops() {
            unfinished.push(step);
            return None;
        }
        Some(found)
    }
}

impl Session {
    /// Has the pilot choose what the scene leaves open, and looks at what the limit on the length of paths leaves out;
    /// meters the exposure if there will be a PNG image. Tells `look` now and then at which step it is. Of the time that
    /// `limits` have it takes a quarter, and at least a quarter of a second; it ends then, or once the session's monitor
    /// says stop, and what is not finished is not used.
    pub fn prepare(&mut self, has_png: bool, limits: impl Into<Limits>, look: impl FnMut(State)) {
        self.prepare_for(Aims { has_png, ..Aims::default() }, limits.into(), look);
    }

    /// The same for a render that goes on from `checkpoint`, by what was chosen then.
    pub fn prepare_to_resume(
        &mut self,
        checkpoint: &Checkpoint,
        has_png: bool,
        limits: impl Into<Limits>,
        look: impl FnMut(State),
    ) {
        let aims = Aims { has_png, chosen: checkpoint.setting(), ..Aims::default() };
        self.prepare_for(aims, limits.into(), look);
    }

    /// As [`Self::prepare`] without an exposure, where `left_out` is known of the same light, rendered in another way.
    pub fn prepare_knowing(&mut self, left_out: Option<Truncation>, look: impl FnMut(State)) {
        self.prepare_for(Aims { left_out: Some(left_out), ..Aims::default() }, Limits::default(), look);
    }

    /// What the limit on the length of paths leaves out, in whatever way the scene is rendered; `None` where nothing
    /// turns light.
    pub fn find_left_out(&self, look: impl FnMut(State)) -> Option<Truncation> {
        let mut unfinished = Vec::new();
        self.watch_preparation(None, look, |running| self.leaves_out(&self.scene.frame, running, &mut unfinished))
    }

    /// The exposure of its images, as far as it is settled before they are rendered.
    pub fn exposure(&self) -> Option<Exposure> {
        self.preparation.exposure.or(self.scene.scene.film.exposure.0.map(Exposure))
    }

    /// The exposure of PNG images that are written now; none if there are to be none.
    pub fn png_exposure(&self) -> Option<Exposure> {
        let metered = || Exposure::metered(self.film.pixels().map(|pixel| pixel.mean).collect::<Vec<_>>().into_iter());
        self.preparation.has_png.then(|| self.exposure().unwrap_or_else(metered))
    }

    fn prepare_for(&mut self, aims: Aims, limits: Limits, look: impl FnMut(State)) {
        let given = limits.time.map(|time| (time / PARTS).max(LEAST));
        let (frame, preparation) = self.watch_preparation(given, look, |running| self.prepared(&aims, running));
        self.scene.frame = frame;
        self.preparation = Preparation { given, ..preparation };
    }

    /// The frame with what the scene left open, and what is known before the first sample.
    fn prepared(&self, aims: &Aims, running: &Running) -> (Frame, Preparation) {
        let Self { scene: LoadedScene { scene, frame, .. }, renderer, .. } = self;
        let (size, choices, mut unfinished) = (scene.film.size, self.scene.choices(), Vec::new());
        let (chosen, trials) = match aims.chosen {
            Some(setting) => (setting.apply(frame), Vec::new()),
            None if !choices.matter_to(frame) => (frame.clone(), Vec::new()),
            None => running
                .take(Step::Choosing, &mut unfinished, |monitor| pilot::choose(frame, size, choices, renderer, monitor))
                .unwrap_or_else(|| (pilot::untried(frame, choices), Vec::new())),
        };
        let metered = |monitor: &Monitor| metering::exposure(frame, size, renderer, monitor);
        let exposure = match scene.film.exposure.0 {
            _ if !aims.has_png => None,
            Some(stops) => Some(Exposure(stops)),
            None => running.take(Step::Metering, &mut unfinished, metered),
        };
        let left_out = aims.left_out.unwrap_or_else(|| self.leaves_out(&chosen, running, &mut unfinished));
        let has_png = aims.has_png;
        (chosen, Preparation { trials, left_out, exposure, has_png, unfinished, given: None })
    }

    /// What the limit leaves out of the light of `frame`; unknown if that was not finished.
    fn leaves_out(&self, frame: &Frame, running: &Running, unfinished: &mut Vec<Step>) -> Option<Truncation> {
        running.begin(Step::LongPaths);
        let found = truncation::estimate(frame, self.scene.scene.film.size, &self.renderer, &running.monitor);
        unfinished.extend((found.is_some() && running.monitor.stops()).then_some(Step::LongPaths));
        found
    }

    /// Prepares, in so much time if it is `given`, telling `look` now and then that it does.
    fn watch_preparation<T: Send>(
        &self,
        given: Option<Duration>,
        mut look: impl FnMut(State),
        prepare: impl FnOnce(&Running) -> T + Send,
    ) -> T {
        let running = Running { monitor: Monitor::default(), step: Mutex::default() };
        running.monitor.stop.store(self.monitor.stops(), Ordering::Relaxed);
        let end = given.and_then(|given| Instant::now().checked_add(given));
        watched(
            || prepare(&running),
            TICK,
            || {
                look(State { preparing: true, step: running.step(), elapsed: self.elapsed(), ..State::default() });
                let is_late = end.is_some_and(|end| Instant::now() >= end);
                if is_late || self.monitor.stops() {
                    running.monitor.stop.store(true, Ordering::Relaxed);
                }
                TICK
            },
        )
    }
}
