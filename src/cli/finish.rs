//! The end of a render: its files, a last line, and whether all is well.

use std::path::Path;
use std::process::ExitCode;

use super::progress::Reporter;
use super::values::ImageOutput;
use crate::error::{Error, Result};
use crate::figures::{duration, number, rate};
use crate::session::{Outcome, Session};

/// Contributions that may be dropped for not being finite, as a share of the samples.
const TOLERATED_DROPS: f64 = 1e-6;

/// Writes what there is and says so; `stopped` is the exit code of the signal that ended it.
pub fn finish(
    session: &Session,
    outcome: &Outcome,
    stopped: Option<u8>,
    outputs: &[ImageOutput],
    stats: Option<&Path>,
    reporter: &Reporter,
) -> Result<ExitCode> {
    if stopped.is_some() {
        reporter.line(format!("stopped after {} samples; writing the results so far", outcome.stats.samples));
    }
    // What can be written is, also if something else cannot.
    let images: Vec<_> = outputs.iter().map(|image| session.write(outcome, &image.path, image.format)).collect();
    let statistics = stats.map_or(Ok(()), |path| session.report(outcome).write_statistics(path));
    images.into_iter().chain([statistics]).collect::<Result<()>>()?;
    reporter.line(summary(session, outcome, outputs));
    if stopped.is_none() && session.film.mean().0 == [0.0; 3] {
        reporter.warn("the image is black: no path reached a light");
    }
    refuse_drops(session, outcome, reporter)?;
    Ok(stopped.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// What was rendered, in one line.
fn summary(session: &Session, outcome: &Outcome, outputs: &[ImageOutput]) -> String {
    let (samples, seconds) = (outcome.stats.samples as f64, outcome.elapsed.as_secs_f64());
    let names: Vec<_> = outputs.iter().map(|image| image.path.display().to_string()).collect();
    let per_pixel = match samples / session.film.region().pixels() as f64 {
        1.0 => "1 sample per pixel".into(),
        count => format!("{} samples per pixel", number(count, 4)),
    };
    // There is none with one sample per pixel, or in a black image.
    let noise = Some(session.film.relative_noise()).filter(|noise| noise.is_finite());
    let (mean, error) = session.film.mean();
    let mean = |channel: usize| match noise {
        None => number(mean[channel], 5),
        Some(_) => format!("{} +- {}", number(mean[channel], 5), number(error[channel], 2)),
    };
    let means: Vec<_> = (0..session.scene.frame.channels()).map(mean).collect();
    let noise = noise.map_or_else(String::new, |noise| format!(", noise {} %", number(100.0 * noise, 3)));
    let exposure = session.preparation().exposure.map_or_else(String::new, |stops| format!(", exposure {stops}"));
    format!(
        "{}: {}, {per_pixel} in {}, {}, mean {}{noise}{exposure}",
        names.join(", "),
        session.report(outcome).techniques(),
        duration(seconds),
        rate(samples / seconds),
        means.join(" | "),
    )
}

fn refuse_drops(session: &Session, outcome: &Outcome, reporter: &Reporter) -> Result<()> {
    let Outcome { stats, .. } = outcome;
    let Some((pixel, sample)) = stats.dropped.first else { return Ok(()) };
    let width = session.scene.frame.camera.width;
    let finding = format!(
        "non-finite contributions were dropped: {}, one of them in sample {sample} of pixel ({}, {})",
        stats.dropped.count,
        pixel % width,
        pixel / width
    );
    if stats.dropped.count as f64 > TOLERATED_DROPS * stats.samples as f64 {
        let remedy = "do not trust the image that was written, and please report the scene";
        return Err(Error::failure(&session.scene.name, finding, remedy));
    }
    reporter.warn(finding);
    Ok(())
}
