//! The end of a render: its files, a last line, and whether all is well.

use std::path::Path;
use std::process::ExitCode;

use fogbow_kernels::accumulate::Dropped;

use super::checkpoints::Plan;
use super::denoising::{Denoising, Noisy};
use super::keeper::{self, Kept};
use super::outputs::ImageOutput;
use super::patience::Patience;
use super::progress::Reporter;
use super::signals::Signals;
use crate::error::{Error, Kind, Result};
use crate::figures::{duration, number, rate};
use crate::image::tone::Exposure;
use crate::session::{End, Outcome, Session};

/// Contributions that may be dropped for not being finite, as a share of the samples.
const TOLERATED_DROPS: f64 = 1e-6;

/// Exit code of a render that is to be gone on with: that of a temporary failure in `sysexits.h`.
const TO_BE_RESUMED: u8 = 75;

/// A render that has ended.
#[derive(Clone, Copy)]
pub struct Ending<'a> {
    pub session: &'a Session,
    pub outcome: &'a Outcome,
    pub signals: &'a Signals,
    pub plan: &'a Plan,
    /// What is to be denoised, if anything is.
    pub denoising: Option<&'a Denoising>,
    /// What became of the samples so far.
    pub kept: &'a Kept,
    pub patience: &'a Patience,
}

/// Writes what there is and says so; the exit code is that of the signal that ended it, if one did. Why an image cannot
/// be denoised is put down as `noisy`, unless there is something: all else goes on.
pub fn finish(
    ending: &Ending<'_>,
    outputs: &[ImageOutput],
    stats: Option<&Path>,
    reporter: &Reporter,
    noisy: &mut Option<Error>,
) -> Result<ExitCode> {
    let Ending { session, outcome, signals, plan, denoising, kept, .. } = *ending;
    let stopped = signals.exit_code();
    if stopped.is_some() && session.film.samples() == 0 {
        return Ok(nothing(signals, plan.is_asked_for(), reporter));
    }
    if kept.is_all() && signals.ended_by_others() {
        reporter.line(format!("stopped after {}; --resume goes on from {}", per_pixel(session), checkpoint(plan)));
        return Ok(ExitCode::from(TO_BE_RESUMED));
    }
    if stopped.is_some() {
        reporter.line(format!("stopped after {}; writing the results so far", per_pixel(session)));
    }
    let errors = write(ending, outputs, stats, reporter);
    if !errors.is_empty() {
        keep(ending, reporter);
        return Ok(tell_all(&errors, signals, reporter));
    }
    reporter.line(summary(session, outcome, outputs));
    kept.tell(reporter);
    if kept.is_all() {
        reporter.line(format!("--resume goes on from {}, --overwrite-checkpoint starts anew", checkpoint(plan)));
    }
    if stopped.is_none() {
        plan.remove(reporter);
        if session.film.is_black() {
            reporter.warn("the image is black: no path reached a light");
        }
    }
    refuse_drops(session, reporter)?;
    if let Some(denoising) = denoising {
        let (size, header) = (session.scene.scene.film.size, session.report(outcome).header());
        let exposure = session.png_exposure().unwrap_or(Exposure(0.0));
        let (film, threads) = (&session.film, session.threads());
        let image = Noisy { film, size, header: &header, exposure, threads };
        if let Err(error) = denoising.finish(&image, || signals.came(), reporter) {
            noisy.get_or_insert(error);
        }
    }
    Ok(stopped.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Where the checkpoint is.
fn checkpoint(plan: &Plan) -> String {
    plan.path().map_or_else(String::new, |path| path.display().to_string())
}

/// The end of a render without samples, because of a signal: an image of before is worth more than a black one. Whether
/// it is to be gone on with, as far as there is anything, is for those to say who started it.
pub fn nothing(signals: &Signals, is_to_be_resumed: bool, reporter: &Reporter) -> ExitCode {
    reporter.line("stopped before the first sample; nothing is written");
    if is_to_be_resumed && signals.ended_by_others() {
        return ExitCode::from(TO_BE_RESUMED);
    }
    signals.exit_code().map_or(ExitCode::FAILURE, ExitCode::from)
}

/// Writes all results; what can be written is, also if something else cannot. Returns what went wrong.
fn write(
    &Ending { session, outcome, signals, patience, .. }: &Ending<'_>,
    outputs: &[ImageOutput],
    stats: Option<&Path>,
    reporter: &Reporter,
) -> Vec<Error> {
    let came = || signals.came();
    let image = |image: &ImageOutput| session.write(outcome, &image.path, image.format, came);
    let images = outputs.iter().map(|output| patience.retry(reporter, || image(output)));
    let statistics = |path: &Path| session.report(outcome).write_statistics(path, came);
    let statistics = stats.iter().map(|path| patience.retry(reporter, || statistics(path)));
    images.chain(statistics).filter_map(Result::err).collect()
}

/// Keeps the samples of a render whose results could not be written in a checkpoint, if it is to have any, and says so.
fn keep(&Ending { session, signals, plan, kept, .. }: &Ending<'_>, reporter: &Reporter) {
    let is_worth_it = plan.is_asked_for() || plan.has_checkpoint();
    // That of a render that was stopped has just been tried.
    let is_tried = kept.is_all() || (signals.came() && !matches!(kept, Kept::No));
    let kept = match plan.slot() {
        Some(slot) if is_worth_it && !is_tried => &keeper::write(slot, session, kept),
        _ => kept,
    };
    kept.tell(reporter);
    if kept.is_all() {
        reporter.line(format!("the samples are kept in {}, from which --resume goes on", checkpoint(plan)));
    }
}

/// Prints all `errors` and gives their exit code: that of the signal if there are only waits that it ended.
fn tell_all(errors: &[Error], signals: &Signals, reporter: &Reporter) -> ExitCode {
    errors.iter().for_each(|error| reporter.error(error));
    let only_waits = errors.iter().all(|error| error.kind == Kind::Interrupted);
    signals.exit_code().filter(|_| only_waits).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// How many samples there are, as people ask for them.
pub fn per_pixel(session: &Session) -> String {
    let film = &session.film;
    match film.samples() as f64 / film.region().pixels() as f64 {
        1.0 => "1 sample per pixel".into(),
        count if session.is_adaptive() => {
            let (least, most) = (film.fewest_samples(), film.most_samples());
            format!("{} samples per pixel ({least} to {most})", number(count, 4))
        }
        count @ 1e6.. => format!("{count:.0} samples per pixel"),
        count => format!("{} samples per pixel", number(count, 4)),
    }
}

/// What was rendered, in one line.
fn summary(session: &Session, outcome: &Outcome, outputs: &[ImageOutput]) -> String {
    let seconds = outcome.elapsed.as_secs_f64();
    let names: Vec<_> = outputs.iter().map(|image| image.path.display().to_string()).collect();
    let per_pixel = per_pixel(session);
    // There is none with one sample per pixel, or in a black image.
    let noise = Some(session.film.relative_noise()).filter(|noise| noise.is_finite());
    let (mean, error) = session.film.mean();
    let mean = |channel: usize| match noise {
        None => number(mean[channel], 5),
        Some(_) => format!("{} +- {}", number(mean[channel], 5), number(error[channel], 2)),
    };
    let means: Vec<_> = (0..session.scene.frame.channels()).map(mean).collect();
    let noise = noise.map_or_else(String::new, |noise| format!(", noise {} %", number(100.0 * noise, 3)));
    let end = match outcome.end {
        End::Met(target) if session.limits().are_several() => format!(", ended by {}", target.name()),
        _ => String::new(),
    };
    let exposure = session.png_exposure().map_or_else(String::new, |stops| format!(", exposure {stops}"));
    format!(
        "{}: {}, {per_pixel} in {}{end}, {}, mean {}{noise}{exposure}",
        names.join(", "),
        session.report(outcome).techniques(),
        duration(seconds),
        rate(outcome.stats.samples as f64 / outcome.sampling.as_secs_f64()),
        means.join(" | "),
    )
}

fn refuse_drops(session: &Session, reporter: &Reporter) -> Result<()> {
    let Dropped { count, first } = session.dropped();
    let Some((pixel, sample)) = first else { return Ok(()) };
    let width = session.scene.frame.camera.width;
    let finding = format!(
        "non-finite contributions were dropped: {count}, one of them in sample {sample} of pixel ({}, {})",
        pixel % width,
        pixel / width
    );
    if count as f64 > TOLERATED_DROPS * session.film.samples() as f64 {
        let remedy = "do not trust the image that was written, and please report the scene";
        return Err(Error::failure(&session.scene.name, finding, remedy));
    }
    reporter.warn(finding);
    Ok(())
}
