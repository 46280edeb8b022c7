//! What is told of a render besides its pixels: entries of headers, and statistics.

use std::path::Path;

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::connect::Technique;
use fogbow_kernels::pipeline::Stage;
use fogbow_kernels::survival::Survival;
use serde_json::{Value, json};

use super::identity::{Entry, FILES};
use super::{Outcome, Session};
use crate::error::Result;
use crate::figures::{starts, survival};
use crate::film::Film;
use crate::output;
use crate::pilot::Trial;
use crate::stats::{ConnectionStats, StageStats, Stats};
use crate::truncation::{Share, Truncation};

/// The entry with the levels of an adaptive image.
pub const LEVELS: &str = "levels";

impl Session {
    /// What its samples depend on, as entries of headers.
    pub fn identity(&self) -> Vec<Entry> {
        let Self { scene, film, settings, .. } = self;
        let (region, frame) = (film.region(), &scene.frame);
        let entries = [
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("scene", scene.name.clone()),
            ("scene_hash", self.hash.get_or_init(|| scene.hash()).clone()),
            ("settings", scene.to_toml()),
            ("technique", self.techniques()),
            ("starts", starts(frame.walk.starts)),
            ("survival", survival(&frame.walk.survival)),
            ("aimed", frame.aimed.to_string()),
            ("roulette", frame.roulette.to_string()),
            ("reference", settings.reference.name().to_string()),
            ("aov", frame.aovs.to_string()),
            ("seed", frame.seed.to_string()),
            ("region", format!("{},{},{},{}", region.x0, region.y0, region.x1, region.y1)),
            ("cpu_features", crate::cpu::built_for().join(" ")),
        ];
        let frame = settings.frame.map(|frame| ("frame", frame.to_string()));
        let files = Some((FILES, scene.file_hashes.clone())).filter(|(_, hashes)| !hashes.is_empty());
        entries.into_iter().chain(files).chain(frame).map(|(name, text)| (name.to_string(), text)).collect()
    }

    /// Names of the active techniques, `path` if there is no other.
    pub fn techniques(&self) -> String {
        let active: Vec<_> = self.scene.frame.techniques.rows().map(|(technique, _)| technique.name()).collect();
        if active.is_empty() { "path".into() } else { active.join(",") }
    }
}

/// A finished render.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    pub(super) session: &'a Session,
    pub(super) outcome: &'a Outcome,
}

impl Report<'_> {
    /// Names of the active techniques, `path` if there is no other.
    pub fn techniques(&self) -> String {
        self.session.techniques()
    }

    /// Entries of an image's header.
    pub fn header(&self) -> Vec<(String, String)> {
        let Session { film, settings, .. } = self.session;
        let (elapsed, coverage) = (self.outcome.elapsed, self.session.coverage());
        let hull = coverage.hull().map_or(settings.first_sample..settings.first_sample, |hull| hull.samples);
        let entries = [
            ("left_out", self.left_out()),
            ("adaptive", settings.adaptive.to_string()),
            ("limits", self.session.limits().to_string()),
            ("ended_by", self.outcome.end.to_string()),
            // The last ones perhaps not of every pixel.
            ("sample_range", format!("{}..{}", hull.start, hull.end)),
            // All of them.
            ("coverage", coverage.to_string()),
            ("samples", film.samples().to_string()),
            ("seconds", format!("{:.3}", elapsed.as_secs_f64())),
            ("threads", self.session.threads().to_string()),
        ];
        let levels = self.session.levels().map(|levels| (LEVELS, levels.to_string()));
        let entries = entries.into_iter().chain(levels).map(|(name, text)| (name.to_string(), text));
        self.session.identity().into_iter().chain(entries).collect()
    }

    /// What the limit on the length of paths leaves out, for the header.
    fn left_out(&self) -> String {
        self.session.preparation.left_out.map_or_else(|| "0".into(), |left_out| left_out.entry())
    }

    /// Writes the statistics as JSON; waits as [`Session::write`] does.
    ///
    /// # Errors
    /// If they cannot be written, or the wait was interrupted.
    pub fn write_statistics(&self, path: &Path, interrupted: impl Fn() -> bool) -> Result<()> {
        let text = serde_json::to_string_pretty(&self.statistics()).expect("numbers and names");
        output::write(path, interrupted, |file| writeln!(file, "{text}").map_err(|error| error.to_string()))
    }

    /// Statistics as JSON.
    fn statistics(&self) -> Value {
        let Session { scene, film, settings, preparation, .. } = self.session;
        let Outcome { stats, end, elapsed, sampling } = self.outcome;
        let (seconds, sampling, frame) = (elapsed.as_secs_f64(), sampling.as_secs_f64(), &scene.frame);
        let (mean, standard_error) = film.mean();
        json!({
            "scene": scene.name,
            "frame": settings.frame,
            "technique": self.techniques(),
            "starts": starts(frame.walk.starts),
            "survival": survival_value(&frame.walk.survival),
            "aimed": frame.aimed,
            "roulette": frame.roulette,
            "reference": settings.reference.name(),
            "warnings": scene.warnings,
            "pilot": preparation.trials.iter().map(trial).collect::<Vec<_>>(),
            "left_out": preparation.left_out.map(left_out),
            "exposure": self.session.png_exposure().map(|exposure| exposure.0),
            "unfinished": preparation.unfinished.iter().map(|step| step.name()).collect::<Vec<_>>(),
            "noise": Some(film.relative_noise()).filter(|noise| noise.is_finite()),
            "threads": self.session.threads(),
            "ended_by": end.to_string(),
            "adaptive": settings.adaptive,
            "seconds": seconds,
            "seconds_of_preparation": seconds - sampling,
            "samples": film.samples(),
            "samples_per_pixel": samples_per_pixel(film),
            "samples_per_second": stats.samples as f64 / sampling,
            "segments": stats.segments,
            "segments_per_second": stats.segments as f64 / sampling,
            "mean": mean,
            "standard_error": standard_error,
            "stages": stages(stats),
            "connections": connections(stats),
            "dropped_non_finite": dropped(self),
        })
    }
}

/// Of the pixels with the fewest and the most, and the mean.
fn samples_per_pixel(film: &Film) -> Value {
    let mean = film.samples() as f64 / film.region().pixels() as f64;
    json!({ "least": film.fewest_samples(), "mean": mean, "most": film.most_samples() })
}

/// The number, or the list of numbers by octave of depth.
fn survival_value(survival: &Survival) -> Value {
    survival.constant().map_or_else(|| json!(survival.octaves()), Value::from)
}

fn trial(trial: &Trial) -> Value {
    json!({
        "starts": starts(trial.setting.starts),
        "survival": survival_value(&trial.setting.survival),
        "roulette": trial.setting.roulette,
        "variance": trial.variance,
        "variance_error": trial.variance_error,
        "mean": trial.mean,
        "mean_error": trial.mean_error,
        "samples": trial.samples,
        "cost": trial.cost,
        "efficiency": trial.efficiency(),
    })
}

/// Of a share of which a lower bound is known, only that; of an unknown one, nothing.
fn left_out(Truncation { max_segments, share, sufficient, likely }: Truncation) -> Value {
    let (share, error, least) = match share {
        Share::About { share, error } => (Some(share), Some(error), None),
        Share::AtLeast(least) => (None, None, Some(least)),
        Share::Unknown => (None, None, None),
    };
    json!({
        "max_segments": max_segments,
        "share": share,
        "error": error,
        "at_least": least,
        "sufficient_max_segments": sufficient,
        "likely_max_segments": likely,
    })
}

/// Work of every stage.
pub fn stages(stats: &Stats) -> Value {
    let one = |(stage, work): (&Stage, &StageStats)| {
        json!({
            "stage": stage.name(),
            "calls": work.calls,
            "rows": work.rows,
            "live_lanes_per_batch": work.rows as f64 / work.batches.max(1) as f64,
            "seconds": work.seconds,
        })
    };
    Stage::ALL.iter().zip(&stats.stages).map(one).collect()
}

/// The fate of every technique's connections.
pub fn connections(stats: &Stats) -> Value {
    let one = |technique: Technique| {
        let ConnectionStats { tried, weighted, faint, occluded } = stats.connections[technique as usize];
        let counts = json!({ "tried": tried, "weighted": weighted, "faint": faint, "occluded": occluded });
        (technique.name().to_string(), counts)
    };
    Value::Object(Technique::ALL.into_iter().map(one).collect())
}

fn dropped(report: &Report<'_>) -> Value {
    let width = report.session.scene.frame.camera.width;
    let Dropped { count, first } = report.session.dropped();
    let first = first.map(|(pixel, sample)| json!({ "x": pixel % width, "y": pixel / width, "sample": sample }));
    json!({ "count": count, "first": first })
}
