//! Small renders for tests.

use bumpalo::Bump;
use fogbow::film::{Film, Region, TILE_SIZE};
use fogbow::frame::Frame;
use fogbow::render::{Monitor, Renderer, Workers};
use fogbow::stats::Stats;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::pipeline::{Pipeline, SIMD};

/// Worker threads as the machine has them.
pub const WORKERS: Workers = Workers { threads: 0, lanes: None, detailed_stats: false };

/// Renders `samples` of every pixel of an image of `size` with all threads.
pub fn render(frame: &Frame, size: [u32; 2], samples: core::ops::Range<u32>) -> (Film, Stats) {
    render_with(frame, &SIMD, WORKERS, size, TILE_SIZE, samples)
}

/// The same with everything chosen.
pub fn render_with(
    frame: &Frame,
    pipeline: &Pipeline,
    workers: Workers,
    size: [u32; 2],
    tile_size: u32,
    samples: core::ops::Range<u32>,
) -> (Film, Stats) {
    let film = Film::new(frame, Region::whole(size[0], size[1]), tile_size);
    let renderer = Renderer::new(workers).expect("threads start");
    let stats = renderer.render(frame, pipeline, &film, samples, &Monitor::default());
    (film, stats)
}

/// Renders on this thread, with `lanes` paths in flight.
pub fn render_here(frame: &Frame, pipeline: &Pipeline, lanes: usize, size: [u32; 2], samples: u32) -> Film {
    let film = Film::new(frame, Region::whole(size[0], size[1]), size[0].max(size[1]));
    let arena = Bump::new();
    Wavefront::new_in(&arena, frame, pipeline, lanes).render(0..samples, &mut film.tile(0));
    film
}

/// Image mean and its standard error in the green channel.
pub fn green(film: &Film) -> (f64, f64) {
    let (mean, error) = film.mean();
    (mean[1], error[1])
}
