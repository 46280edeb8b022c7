//! Samples that were taken before, once more.

use super::bench::size;
use super::run::Run;
use crate::error::{Error, Result};
use crate::film::{Film, Region, tile_size};
use crate::render::{Monitor, Renderer, Workers};
use fogbow_kernels::pipeline::WIDEST;

/// Side of the parts that are rendered again, in pixels; sides of tiles are multiples of it.
const PATCH: u32 = 2;

/// Whether the samples that `run` went on from are those that this program takes: of a few pixels they are taken again.
///
/// # Errors
/// If there is not enough memory.
pub fn takes_again(run: &Run) -> Result<bool> {
    let [width, height] = size(run.film());
    let quarters = [1, 3].into_iter().flat_map(|y| [1, 3].map(|x| [x, y]));
    let corners = quarters.map(|[x, y]| [x * width / 4, y * height / 4].map(|place| place / PATCH * PATCH));
    let patch = |[x, y]: [u32; 2]| Region { x0: x, y0: y, x1: (x + PATCH).min(width), y1: (y + PATCH).min(height) };
    let renderer = Renderer::new(Workers { threads: 1, lanes: None, detailed_stats: false }).map_err(|error| {
        Error::failure("fogbow paper", format!("cannot prepare to render: {error}"), "free some memory")
    })?;
    Ok(corners.map(patch).all(|region| is_same(run, region, &renderer)))
}

/// Whether `renderer` makes the same of `region`, which is part of one tile, as `run` has.
fn is_same(run: &Run, region: Region, renderer: &Renderer) -> bool {
    let frame = &run.session().scene.frame;
    let samples = run.film().pixel(region.x0, region.y0).samples as u32;
    let film = Film::new(frame, region, tile_size(region));
    renderer.render(frame, &WIDEST, &film, 0..samples, &Monitor::default());
    let places = region.rows().flat_map(|y| region.columns().map(move |x| (x, y)));
    places.into_iter().all(|(x, y)| film.pixel(x, y) == run.film().pixel(x, y))
}
