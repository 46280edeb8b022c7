//! What a render leaves behind besides pixels: header entries, statistics and a last line.

use std::path::Path;
use std::time::Duration;

use fogbow_kernels::pipeline::Stage;
use serde_json::{Value, json};

use super::figures::{duration, number, rate, starts};
use super::job::Preparation;
use super::values::ImageOutput;
use crate::error::Result;
use crate::film::Film;
use crate::output;
use crate::pilot::Trial;
use crate::scene::LoadedScene;
use crate::stats::{ConnectionStats, Connector, Stats};
use crate::truncation::Truncation;

/// A finished render.
pub struct Report<'a> {
    /// The scene.
    pub scene: &'a LoadedScene,
    /// The film.
    pub film: &'a Film,
    /// Worker threads.
    pub threads: usize,
    /// Time spent rendering.
    pub elapsed: Duration,
    /// Counters.
    pub stats: &'a Stats,
    /// What was settled before the first sample.
    pub preparation: &'a Preparation,
}

impl Report<'_> {
    /// Names of the active techniques, `path` if there is no other.
    pub fn techniques(&self) -> String {
        let active = Connector::ALL.into_iter().filter(|connector| connector.is_active(&self.scene.frame.techniques));
        let active: Vec<_> = active.map(Connector::name).collect();
        if active.is_empty() { "path".into() } else { active.join(",") }
    }

    /// Entries of an image's header.
    pub fn header(&self) -> Vec<(String, String)> {
        let region = self.film.region();
        let entries = [
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("scene", self.scene.name.clone()),
            ("scene_hash", self.scene.hash()),
            ("settings", self.scene.to_toml()),
            ("technique", self.techniques()),
            ("starts", starts(self.scene.frame.walk.starts)),
            ("survival", self.scene.frame.walk.survival.to_string()),
            ("aimed", self.scene.frame.aimed.to_string()),
            ("roulette", self.scene.frame.roulette.to_string()),
            ("reference", self.preparation.reference.clone()),
            ("left_out", self.left_out()),
            ("seed", self.scene.frame.seed.to_string()),
            // The last ones perhaps not of every pixel.
            ("sample_range", format!("0..{}", self.film.most_samples())),
            ("region", format!("{},{},{},{}", region.x0, region.y0, region.x1, region.y1)),
            ("samples", self.stats.samples.to_string()),
            ("seconds", format!("{:.3}", self.elapsed.as_secs_f64())),
            ("threads", self.threads.to_string()),
            ("cpu_features", crate::cpu::built_for().join(" ")),
        ];
        entries.into_iter().map(|(name, text)| (name.to_string(), text)).collect()
    }

    /// What the limit on the length of paths leaves out, for the header.
    fn left_out(&self) -> String {
        self.preparation.left_out.map_or_else(
            || "0".into(),
            |Truncation { share, error, max_segments, .. }| {
                format!("{} +- {} beyond {max_segments} segments", number(share, 2), number(error, 1))
            },
        )
    }

    /// What was rendered, in one line.
    pub fn summary(&self, outputs: &[ImageOutput]) -> String {
        let (samples, seconds) = (self.stats.samples as f64, self.elapsed.as_secs_f64());
        let names: Vec<_> = outputs.iter().map(|image| image.path.display().to_string()).collect();
        let per_pixel = match samples / self.film.region().pixels() as f64 {
            1.0 => "1 sample per pixel".into(),
            count => format!("{} samples per pixel", number(count, 4)),
        };
        // There is none with one sample per pixel, or in a black image.
        let noise = Some(self.film.relative_noise()).filter(|noise| noise.is_finite());
        let (mean, error) = self.film.mean();
        let mean = |channel: usize| match noise {
            None => number(mean[channel], 5),
            Some(_) => format!("{} +- {}", number(mean[channel], 5), number(error[channel], 2)),
        };
        let means: Vec<_> = (0..self.scene.frame.channels()).map(mean).collect();
        format!(
            "{}: {}, {per_pixel} in {}, {}, mean {}{}{}",
            names.join(", "),
            self.techniques(),
            duration(seconds),
            rate(samples / seconds),
            means.join(" | "),
            noise.map_or_else(String::new, |noise| format!(", noise {} %", number(100.0 * noise, 3))),
            self.preparation.exposure.map_or_else(String::new, |exposure| format!(", exposure {exposure}")),
        )
    }

    /// Writes the statistics as JSON.
    pub fn write_statistics(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(&self.statistics()).expect("numbers and names");
        output::write(path, |file| writeln!(file, "{text}").map_err(|error| error.to_string()))
    }

    /// Statistics as JSON.
    fn statistics(&self) -> Value {
        let (seconds, stats) = (self.elapsed.as_secs_f64(), self.stats);
        let stages: Vec<_> = Stage::ALL
            .iter()
            .zip(&stats.stages)
            .map(|(stage, work)| {
                json!({
                    "stage": stage.name(),
                    "calls": work.calls,
                    "rows": work.rows,
                    "live_lanes_per_batch": work.rows as f64 / work.batches.max(1) as f64,
                    "seconds": work.seconds,
                })
            })
            .collect();
        let (mean, standard_error) = self.film.mean();
        json!({
            "scene": self.scene.name,
            "technique": self.techniques(),
            "starts": starts(self.scene.frame.walk.starts),
            "survival": self.scene.frame.walk.survival,
            "aimed": self.scene.frame.aimed,
            "roulette": self.scene.frame.roulette,
            "reference": self.preparation.reference,
            "warnings": self.scene.warnings,
            "pilot": self.preparation.trials.iter().map(trial).collect::<Vec<_>>(),
            "left_out": self.preparation.left_out.map(left_out),
            "exposure": self.preparation.exposure.map(|exposure| exposure.0),
            "noise": Some(self.film.relative_noise()).filter(|noise| noise.is_finite()),
            "threads": self.threads,
            "seconds": seconds,
            "samples": stats.samples,
            "samples_per_second": stats.samples as f64 / seconds,
            "segments": stats.segments,
            "segments_per_second": stats.segments as f64 / seconds,
            "mean": mean,
            "standard_error": standard_error,
            "stages": stages,
            "connections": connections(stats),
            "dropped_non_finite": dropped(self),
        })
    }
}

fn trial(trial: &Trial) -> Value {
    json!({
        "starts": starts(trial.setting.starts),
        "survival": trial.setting.survival,
        "roulette": trial.setting.roulette,
        "variance": trial.variance,
        "variance_error": trial.variance_error,
        "mean": trial.mean,
        "mean_error": trial.mean_error,
        "cost": trial.cost,
        "efficiency": trial.efficiency(),
    })
}

fn left_out(Truncation { max_segments, share, error, sufficient }: Truncation) -> Value {
    json!({ "max_segments": max_segments, "share": share, "error": error, "sufficient_max_segments": sufficient })
}

fn connections(stats: &Stats) -> Value {
    let one = |connector: Connector| {
        let ConnectionStats { tried, weighted, faint, occluded } = stats.connections[connector as usize];
        let counts = json!({ "tried": tried, "weighted": weighted, "faint": faint, "occluded": occluded });
        (connector.name().to_string(), counts)
    };
    Value::Object(Connector::ALL.into_iter().map(one).collect())
}

fn dropped(report: &Report<'_>) -> Value {
    let width = report.scene.frame.camera.width;
    let first = report
        .stats
        .dropped
        .first
        .map(|(pixel, sample)| json!({ "x": pixel % width, "y": pixel / width, "sample": sample }));
    json!({ "count": report.stats.dropped.count, "first": first })
}
