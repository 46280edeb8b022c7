//! `fogbow render`

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::thread;

use super::checkpoints::Plan;
use super::denoising::{DENOISE, Denoising};
use super::destinations::{self, Destination};
use super::done;
use super::finish::{Ending, finish, nothing, per_pixel};
use super::frames::{self, Sequence};
use super::keeper::{Keeper, Kept};
use super::loading;
use super::onlookers::Onlookers;
use super::outputs::ImageOutput;
use super::patience::Patience;
use super::progress::Reporter;
use super::signals::Signals;
use super::values::Checkpoints;
use super::{Progress, RenderArgs, say, warning_text};
use crate::adaptive;
use crate::cpu;
use crate::denoise::GUIDES;
use crate::error::{Error, Result};
use crate::film::Region;
use crate::image::Format;
use crate::live::{Phase, Turn};
use crate::scene::document::Override;
use crate::scene::{self, LoadedScene};
use crate::session::checkpoint::Checkpoint;
use crate::session::{Limits, Outcome, Session, Settings, State};

pub fn run(args: &RenderArgs) -> Result<ExitCode> {
    if args.help_scene {
        return help_scene();
    }
    let sequence = Sequence::new(args)?;
    let (reporter, signals) = (Reporter::new(args.progress), Signals::watch()?);
    let onlookers = Onlookers::invite(args, &reporter)?;
    let mut run = Run { args, reporter, signals, onlookers, told: BTreeSet::new(), noisy: None };
    let code = match sequence {
        Some(sequence) => run.render_all(&sequence),
        None => run.render(None),
    };
    let end = match &code {
        _ if run.signals.came() => Phase::Stopped,
        Ok(code) if *code == ExitCode::SUCCESS && run.noisy.is_none() => Phase::Finished,
        _ => Phase::Failed,
    };
    run.onlookers.leave(end, &run.reporter);
    let code = code?;
    run.noisy.map_or(Ok(code), Err)
}

/// One run of the program: a render, or one for every frame.
struct Run<'a> {
    args: &'a RenderArgs,
    reporter: Reporter,
    signals: Signals,
    onlookers: Onlookers,
    /// Warnings of scenes that were told: frames have most of them in common.
    told: BTreeSet<String>,
    /// Why the first image that was to be denoised was not. Everything else is done all the same.
    noisy: Option<Error>,
}

/// What is asked of a render of one scene.
struct Request {
    outputs: Vec<ImageOutput>,
    statistics: Option<PathBuf>,
    settings: Settings,
    limits: Limits,
    plan: Plan,
    denoising: Option<Denoising>,
}

impl Request {
    fn has_png(&self) -> bool {
        self.outputs.iter().any(|image| image.format == Format::Png)
    }

    /// Results beside its images.
    fn others(&self) -> impl Iterator<Item = Destination<'_>> {
        let denoised = self.denoising.iter().flat_map(Denoising::destinations);
        denoised.chain(self.statistics.iter().map(|path| Destination { flag: "--stats", path }))
    }

    /// Those that can be there.
    fn possible_others(&self) -> impl Iterator<Item = Destination<'_>> {
        let is_possible = self.denoising.as_ref().is_some_and(|denoising| denoising.obstacle().is_none());
        self.others().filter(move |other| is_possible || other.flag != DENOISE)
    }
}

impl Run<'_> {
    /// Renders all frames, up to one that fails or that a signal ends; if one comes between two, it ends the second.
    fn render_all(&mut self, sequence: &Sequence) -> Result<ExitCode> {
        for turn in sequence.turns() {
            let code = self.render(Some((turn, sequence.time(turn))))?;
            if code != ExitCode::SUCCESS {
                return Ok(code);
            }
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Renders the scene, perhaps as a frame at a time `[s]`.
    fn render(&mut self, moment: Option<(Turn, f64)>) -> Result<ExitCode> {
        let turn = moment.map(|(turn, _)| turn);
        let Some(scene) = self.load(moment)? else {
            return Ok(nothing(&self.signals, self.args.resume || is_kept(self.args), &self.reporter));
        };
        let request = self.request(&scene, turn)?;
        let mut session = Session::new(scene, request.settings)?;
        self.warn_of_no_effect(&session, request.limits);
        if self.args.resume && self.is_done(&session, &request) {
            let obstacle = request.denoising.as_ref().and_then(Denoising::obstacle);
            self.noisy = self.noisy.take().or(obstacle.cloned());
            self.reporter.finish(State::default().done());
            self.reporter.written();
            return Ok(ExitCode::SUCCESS);
        }
        let checkpoint = request.plan.existing(&session, &self.reporter)?;
        self.prepare(&mut session, &request, checkpoint.as_ref());
        if let Some(mut checkpoint) = checkpoint.filter(|_| !self.signals.came()) {
            session.resume(&mut checkpoint)?;
            request.plan.check_limits(&session, checkpoint.limits(), &self.reporter)?;
            self.reporter.line(format!("going on after {}", per_pixel(&session)));
        }
        let session = Arc::new(session);
        self.onlookers.show(&session, &self.reporter);
        let patience = Patience::default();
        let (outcome, kept) = self.sample(&session, &request, &patience);
        let Self { signals, reporter, noisy, .. } = self;
        let Request { plan, denoising, .. } = &request;
        let denoising = denoising.as_ref();
        let ending =
            Ending { session: &session, outcome: &outcome, signals, plan, denoising, kept: &kept, patience: &patience };
        let code = finish(&ending, &request.outputs, request.statistics.as_deref(), reporter, noisy)?;
        if code == ExitCode::SUCCESS && noisy.is_none() {
            reporter.written();
        }
        Ok(code)
    }

    /// The scene; none if a signal came meanwhile.
    fn load(&mut self, moment: Option<(Turn, f64)>) -> Result<Option<LoadedScene>> {
        let Self { args, reporter, signals, onlookers, .. } = self;
        let (turn, time) = moment.unzip();
        let path = args.scene.as_deref().unwrap_or_else(|| Path::new("."));
        reporter.turn(turn);
        onlookers.begin(&scene::name(path), turn);
        let scene = loading::load(path, overrides(args), time, reporter, || signals.came())?;
        let scene = if args.denoise { scene.map(|scene| scene.with_aovs(&GUIDES)) } else { scene };
        if let Some(scene) = &scene {
            reporter.begin(&scene.name);
            let warnings = scene.warnings.iter().map(|warning| warning_text(warning, args.verbose));
            let all: Vec<_> = cpu::advice().map(String::from).into_iter().chain(warnings).collect();
            all.into_iter().for_each(|warning| self.warn_once(warning));
        }
        Ok(scene)
    }

    /// What is asked of a render of `scene`, and whether it can be had.
    fn request(&mut self, scene: &LoadedScene, turn: Option<Turn>) -> Result<Request> {
        let args = self.args;
        let size @ [width, height] = scene.scene.film.size;
        let region = args.crop.map_or(Ok(Region::whole(width, height)), |crop| Region::cropped(crop, size))?;
        let (outputs, statistics) = (outputs(args, scene, turn), args.stats.as_ref().map(|path| named(path, turn)));
        let first_sample = args.sample_range.as_ref().map_or(0, |range| range.start);
        let limits = limits(args, scene, first_sample);
        let plan = Plan::new(args, &outputs, limits)?;
        let settings = Settings {
            region: Some(region),
            first_sample,
            adaptive: args.adaptive,
            frame: turn.map(|turn| turn.frame),
            threads: args.threads.unwrap_or(0) as usize,
            detailed_stats: args.stats.is_some(),
            reference: args.reference.unwrap_or_default(),
        };
        let denoising = args.denoise.then(|| Denoising::of(&outputs)).transpose()?;
        let request = Request { outputs, statistics, settings, limits, plan, denoising };
        check_destinations(args.progress, scene, &request)?;
        request.denoising.iter().filter_map(Denoising::warning).for_each(|warning| self.warn_once(warning));
        if let Some(stops) = args.exposure.as_ref().filter(|_| !request.has_png()).map(word) {
            let finding = "has no effect: only PNG images are exposed, and none is written";
            self.reporter.warn(format!("--exposure {stops} {finding}"));
        }
        let has_exr = request.outputs.iter().any(|image| image.format == Format::Exr);
        if let Some(names) = args.aov.as_ref().filter(|_| !has_exr) {
            let finding = "has no effect: layers are channels of EXR images, and none is written";
            let number = if turn.is_some() { ".####" } else { "" };
            self.warn_once(format!("--aov {names} {finding}; add -o {}{number}.exr, or leave it out", scene.name));
        }
        if turn.is_some_and(|turn| turn.count > 1) && request.has_png() && scene.scene.film.exposure.0.is_none() {
            let flicker = "PNG images of frames are each exposed for themselves: give all the same --exposure";
            self.warn_once(flicker.into());
        }
        Ok(request)
    }

    /// Warns of what all frames have in common.
    fn warn_once(&mut self, warning: String) {
        if self.told.insert(warning.clone()) {
            self.reporter.warn(warning);
        }
    }

    fn warn_of_no_effect(&self, session: &Session, limits: Limits) {
        let (first, even) = (self.args.sample_range.as_ref().map_or(0, |range| range.start), adaptive::EVEN);
        if session.is_adaptive() && limits.samples.is_some_and(|samples| first + samples <= even) {
            let finding = format!("has no effect: the first {even} samples are those of all pixels");
            self.reporter.warn(format!("--adaptive {finding}"));
        }
    }

    /// Whether all results are there, so that nothing is left to do.
    fn is_done(&mut self, session: &Session, request: &Request) -> bool {
        let Request { outputs, limits, plan, .. } = request;
        if plan.has_checkpoint() {
            return false;
        }
        let is_done = done::are_there(session, *limits, outputs, request.possible_others());
        if !is_done && done::are_silent(outputs) {
            let finding = "images are there that do not say what they are of, and are rendered again";
            self.warn_once(format!("--resume: {finding}; an EXR image beside them would, as with another -o"));
        }
        if is_done {
            let names: Vec<_> = outputs.iter().map(|image| image.path.display().to_string()).collect();
            self.reporter.line(format!("{}: already there, skipped", names.join(", ")));
        }
        is_done
    }

    fn prepare(&mut self, session: &mut Session, request: &Request, checkpoint: Option<&Checkpoint>) {
        let Self { reporter, signals, onlookers, .. } = self;
        session.stop_by(signals.stop());
        let look = |state| {
            reporter.update(state);
            onlookers.look(state, reporter);
        };
        match checkpoint {
            Some(checkpoint) => session.prepare_to_resume(checkpoint, request.has_png(), request.limits, look),
            None => session.prepare(request.has_png(), request.limits, look),
        }
        if !signals.came() {
            let preparation = session.preparation();
            preparation.warning_of_left_out().iter().for_each(|left_out| reporter.warn(left_out));
            preparation.warning().iter().for_each(|unfinished| reporter.warn(unfinished));
        }
    }

    /// Takes all samples; how that ended, and what became of them.
    fn sample(&mut self, session: &Session, request: &Request, patience: &Patience) -> (Outcome, Kept) {
        let Request { limits, plan, .. } = request;
        let Self { reporter, signals, onlookers, .. } = self;
        let mut last = State::default();
        thread::scope(|scope| {
            let mut keeper = Keeper::start(scope, session, plan);
            let look = |state| {
                last = state;
                reporter.update(state);
                onlookers.look(state, reporter);
                keeper.look(&state, signals, reporter);
            };
            let outcome = session.run(*limits, || signals.came(), look);
            let end = if signals.came() { last } else { last.done() };
            reporter.finish(end);
            onlookers.write(end, outcome.end);
            (outcome, keeper.end(session, &last, signals.came(), patience, reporter))
        })
    }
}

/// Whether checkpoints are asked for.
fn is_kept(args: &RenderArgs) -> bool {
    matches!(args.checkpoint, Some(Checkpoints::Every(_)))
}

/// When the render is done. What the scene says counts where nobody says anything else.
fn limits(args: &RenderArgs, scene: &LoadedScene, first_sample: u32) -> Limits {
    let says = args.samples.is_some() || args.sample_range.is_some() || (args.time.is_none() && args.noise.is_none());
    // The flags are among the keys of the scene by now.
    let last = args.sample_range.as_ref().map_or(scene.scene.render.samples, |range| range.end);
    Limits { samples: says.then(|| last - first_sample), time: args.time, noise: args.noise }
}

/// `--help-scene`
pub fn help_scene() -> Result<ExitCode> {
    say(scene::help::page().trim_end())?;
    Ok(ExitCode::SUCCESS)
}

/// The scene's keys that flags override, before those of `--set`.
fn overrides(args: &RenderArgs) -> Vec<Override> {
    let change =
        |key: &str, value: toml::Value, flag: String| Override { key: key.into(), value, flag, is_dedicated: true };
    let number = |key: &str, flag: &str, value: Option<i64>| {
        value.map(|value| change(key, value.into(), format!("--{flag} {value}")))
    };
    let technique =
        args.technique.as_ref().map(|t| change("render.technique", t.clone().into(), format!("--technique {t}")));
    let aov = args.aov.as_ref().map(|names| change("film.aov", names.clone().into(), format!("--aov {names}")));
    let mesc = args.mesc.map(|mesc| change("render.mesc", mesc.into(), format!("--mesc {mesc}")));
    let size = args.size.map(|[width, height]| {
        let value = vec![toml::Value::from(i64::from(width)), i64::from(height).into()];
        change("film.size", value.into(), format!("--size {width}x{height}"))
    });
    let exposure = args
        .exposure
        .as_ref()
        .map(|value| change("film.exposure", value.clone(), format!("--exposure {}", word(value))));
    let segments = args
        .max_segments
        .as_ref()
        .map(|value| change("render.max_segments", value.clone(), format!("--max-segments {}", word(value))));
    let range = args.sample_range.as_ref().map(|range| {
        change("render.samples", i64::from(range.end).into(), format!("--sample-range {}..{}", range.start, range.end))
    });
    let numbers = [number("render.samples", "samples", args.samples), number("render.seed", "seed", args.seed)];
    let flags = [technique, aov, mesc, segments, size, exposure, range].into_iter().chain(numbers).flatten();
    flags.chain(args.set.iter().cloned()).collect()
}

/// A number or a word as it is written after its flag.
fn word(value: &toml::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_string)
}

/// Where a result goes, or that of a frame.
fn named(path: &Path, turn: Option<Turn>) -> PathBuf {
    turn.map_or_else(|| path.into(), |turn| frames::numbered(path, turn.frame))
}

/// The images to write.
fn outputs(args: &RenderArgs, scene: &LoadedScene, turn: Option<Turn>) -> Vec<ImageOutput> {
    if args.output.is_empty() {
        let ending = if turn.is_some() { "####.exr" } else { "exr" };
        return vec![ImageOutput {
            path: named(Path::new(&format!("{}.{ending}", scene.name)), turn),
            format: Format::Exr,
        }];
    }
    args.output.iter().map(|image| ImageOutput { path: named(&image.path, turn), format: image.format }).collect()
}

/// Fails if a result cannot go where it is to go.
fn check_destinations(progress: Progress, scene: &LoadedScene, request: &Request) -> Result<()> {
    let images = request.outputs.iter().map(|image| Destination { flag: "--output", path: &image.path });
    let checkpoint = request.plan.path().map(|path| Destination { flag: "checkpoint", path });
    let all: Vec<_> = images.chain(request.others()).chain(checkpoint).collect();
    destinations::check(&all, &scene.files)?;
    destinations::check_lines(&all, progress)
}
