//! Variance of one camera sample, by technique, mean cosine and light radius, and by the law of the numbers of edges:
//! the tables of docs/bridges.md.
//!
//! ```text
//! cargo run --release --example variance
//! ```
//!
//! Scene fog-facing, camera on its near plane 0, K = 15, radiance in inverse proportion to the light's area. A figure
//! is the mean over the pixels of the variance of a sample. Where techniques are far from the light's shape, variances
//! come from a few rare samples: the figure in brackets is its relative spread over eight parts of the samples.

use std::sync::Arc;

use fogbow::film::{Film, Region, tile_size};
use fogbow::frame::Frame;
use fogbow::render::{Monitor, Renderer, Workers};
use fogbow::scene::{self, document::Override};
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::pipeline::SIMD;

/// Side of the image in pixels.
const SIDE: u32 = 64;
/// Parts whose spread tells how well a variance is known.
const PARTS: u32 = 8;
/// Samples per pixel and part.
const SAMPLES: u32 = 64;

const TECHNIQUES: [(&str, &[&str]); 7] = [
    ("path", &["render.technique=path"]),
    ("NEE", &["render.technique=nee"]),
    ("MVNEE-4", &["render.technique=mvnee", "render.mesc=4"]),
    ("MVNEE-8", &["render.technique=mvnee", "render.mesc=8"]),
    ("bridge, uniform roll", &["render.technique=bridge", "render.roll=uniform", "render.starts=all"]),
    ("bridge, aligned", &["render.technique=bridge", "render.starts=all"]),
    ("bridge, aligned, 1 start", &["render.technique=bridge", "render.starts=1"]),
];

/// Bridges with Poisson counts of mean mu_t s, and with those of the table, by vertices that connect.
const COUNTS: [(&str, bool, &str); 4] = [
    ("Poisson, 1 start", true, "render.starts=1"),
    ("table, 1 start", false, "render.starts=1"),
    ("Poisson, all starts", true, "render.starts=all"),
    ("table, all starts", false, "render.starts=all"),
];

fn main() {
    let workers = Workers { threads: 0, lanes: None, detailed_stats: false };
    let renderer = Renderer::new(workers).expect("threads start");
    for radius in [0.5, 0.05] {
        println!("\nlight radius {radius} m\n\n| technique | g .5 | g .8 | g .9 | g .95 |\n|---|---|---|---|---|");
        for (name, settings) in TECHNIQUES {
            let cells = [0.5, 0.8, 0.9, 0.95].map(|g| cell(&frame(radius, g, settings), &renderer));
            println!("| {name} | {} |", cells.join(" | "));
        }
    }
    println!("\n| counts | g 0 | g .5 | g .9 | g .95 |\n|---|---|---|---|---|");
    for (name, poisson, starts) in COUNTS {
        let cells = [0.0, 0.5, 0.9, 0.95].map(|g| {
            let frame = frame(0.5, g, &["render.technique=bridge", starts]);
            cell(&if poisson { with_poisson_counts(frame) } else { frame }, &renderer)
        });
        println!("| {name} | {} |", cells.join(" | "));
    }
}

/// `frame` with Poisson counts of mean mu_t s in the place of those from the table.
fn with_poisson_counts(mut frame: Frame) -> Frame {
    let counts = CountTable::poisson(frame.medium.phase.twin().lobe());
    frame.techniques.bridge.iter_mut().for_each(|bridge| bridge.counts = Arc::new(counts.clone()));
    frame
}

fn frame(radius: f64, g: f64, settings: &[&str]) -> Frame {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-facing");
    let own = [
        format!("film.size=[{SIDE}, {SIDE}]"),
        format!("medium.phase.g={g}"),
        format!("light[0].radius={radius}"),
        format!("light[0].radiance={}", 20.0 / (radius * radius)),
    ];
    let settings = settings.iter().map(|setting| (*setting).to_string()).chain(own);
    let overrides = settings.map(|setting| Override::parse(&setting).expect("a key and a value")).collect();
    scene::load(&path, overrides).unwrap_or_else(|error| panic!("{error}")).frame
}

/// Variance per sample and its relative spread.
fn cell(frame: &Frame, renderer: &Renderer) -> String {
    let region = Region::whole(SIDE, SIDE);
    let variances: Vec<f64> = (0..PARTS)
        .map(|part| {
            let film = Film::new(frame, region, tile_size(region));
            renderer.render(frame, &SIMD, &film, part * SAMPLES..(part + 1) * SAMPLES, &Monitor::default());
            let sum: f64 = film.pixels().map(|pixel| pixel.standard_error[1].powi(2)).sum();
            sum / region.pixels() as f64 * f64::from(SAMPLES)
        })
        .collect();
    let mean = variances.iter().sum::<f64>() / f64::from(PARTS);
    let spread = variances.iter().map(|variance| (variance - mean).powi(2)).sum::<f64>() / f64::from(PARTS - 1);
    format!("{mean:.3} ({:.0} %)", 100.0 * (spread / f64::from(PARTS)).sqrt() / mean)
}
