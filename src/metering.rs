//! What an image is exposed for: a light meter that looks at the whole scene, whatever part of it is rendered.
//!
//! It renders the image small, with a seed and settings of its own, so that all crops, seeds and numbers of samples of
//! a scene are exposed alike.

use fogbow_kernels::pipeline::WIDEST;

use crate::film::{Film, tile_size};
use crate::frame::Frame;
use crate::image::tone::Exposure;
use crate::render::{Monitor, Renderer};

/// Longest side of the metered image in pixels.
const SIDE: u32 = 64;
/// Samples per pixel.
const SAMPLES: u32 = 16;
/// Vertices that connect: enough for all of a dark corner to get some light.
const STARTS: u32 = 4;
/// The seed of its samples.
const SEED: u32 = 0x1f12_3bb5;

/// The exposure of `frame`, an image of `size` pixels; from what was seen so far if `monitor` says stop.
pub fn exposure(frame: &Frame, size: [u32; 2], renderer: &Renderer, monitor: &Monitor) -> Exposure {
    let (frame, region) = frame.small(size, SIDE);
    let frame = Frame { seed: SEED, roulette: 0.0, ..frame }.with_walk(STARTS, 1.0);
    let film = Film::new(&frame, region, tile_size(region));
    renderer.render(&frame, &WIDEST, &film, 0..SAMPLES, &monitor.of_looks());
    let pixels: Vec<_> = film.pixels().map(|pixel| pixel.mean).collect();
    Exposure::metered(pixels.iter().copied())
}
