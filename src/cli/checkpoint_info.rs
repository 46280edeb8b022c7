//! `fogbow info` of a checkpoint.

use std::path::Path;
use std::time::SystemTime;

use super::say;
use crate::error::Result;
use crate::figures::{duration, number, percent};
use crate::film::{Film, Region};
use crate::session::checkpoint::{Checkpoint, Summary};
use crate::session::identity;
use crate::session::{Limits, Target};

pub fn describe(path: &Path) -> Result<()> {
    let summary = Checkpoint::open(path)?.summary()?;
    let Summary { identity, size: [width, height], film, limits, elapsed, written } = &summary;
    let entry = |name: &str| identity::text(identity, name).unwrap_or("unknown").to_string();
    say(format!("{}: checkpoint of {}, fogbow {}", path.display(), entry("scene"), entry("version")))?;
    let part = match film.region() {
        region if region == Region::whole(*width, *height) => String::new(),
        Region { x0, y0, x1, y1 } => format!(", of which {x0},{y0},{x1},{y1}"),
    };
    say(format!("size: {width}x{height} pixels{part}"))?;
    say(format!("scene_hash: {}", entry("scene_hash")))?;
    say(format!("technique: {}", entry("technique")))?;
    say(format!("aov: {}", entry("aov")))?;
    say(format!("seed: {}", entry("seed")))?;
    say(format!("samples: {}", samples(film, &entry("adaptive"), &entry("first_sample"))))?;
    say(format!("progress: {}", progress(&summary, *limits)))?;
    let noise = Some(film.relative_noise()).filter(|noise| noise.is_finite());
    say(format!("noise: {}", noise.map_or_else(|| "unknown".into(), percent)))?;
    say(format!("time: {}", duration(elapsed.as_secs_f64())))?;
    let ago = SystemTime::now().duration_since(*written).unwrap_or_default();
    let time = humantime::format_rfc3339_seconds(*written);
    say(format!("written: {time}, {} ago", duration(ago.as_secs_f64().round())))
}

/// How many samples there are, and of which tiles.
fn samples(film: &Film, adaptive: &str, first: &str) -> String {
    let (least, most) = (film.fewest_samples(), film.most_samples());
    let mean = number(mean(film), 4);
    let tiles = film.tile_count();
    let kind = if adaptive == "true" { ", adaptive" } else { "" };
    let from = if first == "0" { String::new() } else { format!(", from sample {first} on") };
    format!("{mean} per pixel, {least} to {most} in {tiles} tiles{kind}{from}; {} in all", film.samples())
}

/// Samples of the mean pixel.
fn mean(film: &Film) -> f64 {
    film.samples() as f64 / film.region().pixels() as f64
}

/// How far it is to whatever was to end it.
fn progress(summary: &Summary, limits: Limits) -> String {
    let Summary { film, elapsed, .. } = summary;
    let targets = [limits.samples.map(Target::Samples), limits.time.map(Target::Time), limits.noise.map(Target::Noise)];
    let told = targets.into_iter().flatten().map(|target| match target {
        Target::Samples(samples) => {
            let share = mean(film) / f64::from(samples);
            format!("{} of {samples} samples per pixel", percent(share.min(1.0)))
        }
        Target::Time(time) => {
            let share = elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9);
            format!("{} of {}", percent(share.min(1.0)), duration(time.as_secs_f64()))
        }
        Target::Noise(target) => {
            // Noise falls with the root of the number of samples.
            let share = (target / film.relative_noise()).powi(2);
            format!("about {} of the way to a noise of {}", percent(share.min(1.0)), percent(target))
        }
    });
    let told: Vec<_> = told.collect();
    if told.is_empty() { "without end".into() } else { told.join(", or ") }
}
