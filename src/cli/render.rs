//! `fogbow render`

use std::path::Path;
use std::process::ExitCode;
use std::thread;

use super::checkpoints::{Keeper, Plan};
use super::denoising::Denoising;
use super::destinations::{self, Destination};
use super::finish::{Ending, finish, nothing};
use super::loading;
use super::progress::Reporter;
use super::signals::Signals;
use super::values::{Checkpoints, ImageOutput};
use super::{RenderArgs, say, warning_text};
use crate::adaptive;
use crate::cpu;
use crate::denoise::GUIDES;
use crate::error::{Error, Result};
use crate::film::Region;
use crate::image::Format;
use crate::scene::document::Override;
use crate::scene::{self, LoadedScene};
use crate::session::{Limits, Session, Settings, State};

pub fn run(args: &RenderArgs) -> Result<ExitCode> {
    if args.help_scene {
        return help_scene();
    }
    let path = args.scene.as_deref().unwrap_or_else(|| Path::new("."));
    let (mut reporter, signals) = (Reporter::new(args.progress), Signals::watch()?);
    let Some(mut scene) = loading::load(path, overrides(args), &mut reporter, || signals.came())? else {
        return Ok(nothing(&signals, args.resume || is_kept(args), &reporter));
    };
    reporter.begin(&scene.name);
    cpu::advice().iter().for_each(|advice| reporter.warn(advice));
    scene.warnings.iter().for_each(|warning| reporter.warn(warning_text(warning, args.verbose)));
    let region = region(args, scene.scene.film.size)?;
    let outputs = outputs(args, &scene);
    let first_sample = args.sample_range.as_ref().map_or(0, |range| range.start);
    let limits = limits(args, &scene, first_sample);
    let plan = Plan::new(args, &outputs, limits)?;
    let denoising = args.denoise.then(|| Denoising::of(&outputs)).transpose()?;
    if denoising.is_some() {
        scene = scene.with_aovs(&GUIDES);
    }
    check_destinations(args, &scene, &outputs, denoising.as_ref(), plan.path())?;
    denoising.iter().for_each(|denoising| denoising.warn(&reporter));
    let has_png = outputs.iter().any(|image| image.format == Format::Png);
    if let Some(stops) = args.exposure.as_ref().filter(|_| !has_png).map(word) {
        reporter.warn(format!("--exposure {stops} has no effect: only PNG images are exposed, and none is written"));
    }
    let mut session = Session::new(
        scene,
        Settings {
            region: Some(region),
            first_sample,
            adaptive: args.adaptive,
            threads: args.threads.unwrap_or(0) as usize,
            detailed_stats: args.stats.is_some(),
            reference: args.reference.unwrap_or_default(),
        },
    )?;
    if session.is_adaptive() && limits.samples.is_some_and(|samples| first_sample + samples <= adaptive::EVEN) {
        reporter
            .warn(format!("--adaptive has no effect: the first {} samples are those of all pixels", adaptive::EVEN));
    }
    let checkpoint = plan.existing(&session, &reporter)?;
    signals.set(&session.monitor().stop)?;
    session.prepare(has_png, |state| reporter.update(state));
    let left_out = session.preparation().left_out.filter(|left_out| left_out.matters() && !signals.came());
    left_out.iter().for_each(|left_out| reporter.warn(left_out));
    if let Some(mut checkpoint) = checkpoint.filter(|_| !signals.came()) {
        session.resume(&mut checkpoint)?;
        plan.check_samples(&session)?;
        reporter.line(format!("going on after {} samples", session.film.samples()));
    }
    let mut last = State::default();
    let (outcome, is_kept) = thread::scope(|scope| {
        let mut keeper = Keeper::start(scope, &session, &plan);
        let look = |state| {
            last = state;
            reporter.update(state);
            keeper.look(&state, &signals, &reporter);
        };
        let outcome = session.run(limits, || signals.came(), look);
        reporter.finish(if signals.came() { last } else { last.done() });
        (outcome, keeper.end(&session, &last, signals.came(), &reporter))
    });
    let (plan, denoising) = (&plan, denoising.as_ref());
    let ending = Ending { session: &session, outcome: &outcome, signals: &signals, plan, denoising, is_kept };
    finish(&ending, &outputs, args.stats.as_deref(), &reporter)
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

fn region(args: &RenderArgs, [width, height]: [u32; 2]) -> Result<Region> {
    let whole = Region::whole(width, height);
    let Some([x0, y0, x1, y1]) = args.crop else { return Ok(whole) };
    if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height {
        return Ok(Region { x0, y0, x1, y1 });
    }
    let finding = format!("the window is empty or reaches outside the image of {width}x{height} pixels");
    let remedy = "give X0,Y0,X1,Y1 with 0 <= X0 < X1 <= width and 0 <= Y0 < Y1 <= height";
    Err(Error::usage(format!("--crop {x0},{y0},{x1},{y1}"), finding, remedy))
}

/// The images to write.
fn outputs(args: &RenderArgs, scene: &LoadedScene) -> Vec<ImageOutput> {
    if args.output.is_empty() {
        return vec![ImageOutput { path: format!("{}.exr", scene.name).into(), format: Format::Exr }];
    }
    args.output.clone()
}

/// Fails if a result cannot go where it is to go.
fn check_destinations(
    args: &RenderArgs,
    scene: &LoadedScene,
    outputs: &[ImageOutput],
    denoising: Option<&Denoising>,
    checkpoint: Option<&Path>,
) -> Result<()> {
    let images = outputs.iter().map(|image| Destination { flag: "--output", path: &image.path });
    let denoised = denoising.iter().flat_map(|denoising| denoising.destinations());
    let stats = args.stats.iter().map(|path| Destination { flag: "--stats", path });
    let checkpoint = checkpoint.map(|path| Destination { flag: "checkpoint", path });
    let all: Vec<_> = images.chain(denoised).chain(stats).chain(checkpoint).collect();
    destinations::check(&all, &scene.files)?;
    destinations::check_lines(&all, args.progress)
}
