//! The same bits whatever the threads, the wavefront, the tiles and the split of the samples.

use core::ops::Range;

use bumpalo::Bump;
use fogbow::film::{Film, Pixel, Region, TILE_SIZE, Tile};
use fogbow::frame::Frame;
use fogbow::pilot::{self, Trial};
use fogbow::render::{Monitor, Renderer, Samples, Workers};
use fogbow::scene::{self, LoadedScene, document::Override};
use fogbow::stats::Stats;
use fogbow::wavefront::{Blocks, LAST_CLOCK, Wavefront};
use fogbow_kernels::mis_weight::{self, Competing};
use fogbow_kernels::pipeline::{Pipeline, SIMD};
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{WORKERS, render, render_with};

const SIZE: [u32; 2] = [70, 41];
const SMALL: [u32; 2] = [12, 9];

fn frames() -> Vec<Frame> {
    vec![
        frames::fog_facing(0.0, 0.9, SIZE),
        frames::three_lights(0.6, Selection::IntensityDistance, SIZE),
        frames::with_techniques(&frames::fog_facing(0.0, 0.9, SIZE), Active::Nee, 4.0),
        bridges(Active::Bridge, 0.8, 0.3),
        bridges(Active::Every, 0.6, 0.05),
        under_a_sky(),
    ]
}

/// A cloud under all lights at infinity at once, whose connections play roulette.
fn under_a_sky() -> Frame {
    let (_, cloud) = frames::skies::clouds(SIZE).pop().expect("clouds");
    Frame { roulette: 0.05, ..frames::with_techniques(&cloud, Active::Bridge, 4.0) }.with_walk(2, 0.8)
}

/// A frame whose walks end early and whose connections play roulette.
fn bridges(active: Active, survival: f32, roulette: f32) -> Frame {
    let lights = frames::three_lights(0.6, Selection::IntensityDistance, SIZE);
    Frame { roulette, ..frames::with_techniques(&lights, active, 3.0) }.with_walk(3, survival)
}

fn pixels(film: &Film) -> Vec<Pixel> {
    film.pixels().collect()
}

#[test]
fn one_thread_renders_the_same_bits_as_many() {
    for frame in frames() {
        let with = |threads: usize| {
            let workers = Workers { threads, ..WORKERS };
            pixels(&render_with(&frame, &SIMD, workers, SIZE, TILE_SIZE, 0..20).0)
        };
        let one = with(1);
        assert_eq!(one, with(2));
        assert_eq!(one, with(5));
    }
}

#[test]
fn what_is_dropped_before_it_is_weighed_leaves_no_trace() {
    let keeps_all = Pipeline { sift: |_, columns| columns.worth.weight.rows_mut().fill(1.0), ..SIMD };
    for (name, frame) in frames::variety(SMALL) {
        let with = |pipeline: &Pipeline| pixels(&render_with(&frame, pipeline, WORKERS, SMALL, TILE_SIZE, 0..6).0);
        assert_eq!(with(&SIMD), with(&keeps_all), "{name}");
    }
}

#[test]
fn what_falls_before_it_is_weighed_would_have_fallen_after() {
    let weighs_first: mis_weight::Kernel = |step, columns| match columns.competing {
        Competing::All => mis_weight::simd::run(step, columns),
        Competing::Own => {
            columns.worth.weight.rows_mut().fill(f32::MAX);
            columns.worth.factor.channels_mut().iter_mut().for_each(|factor| factor.rows_mut().fill(1.0));
        }
    };
    let keeps_all = Pipeline { mis_weight: weighs_first, ..SIMD };
    let coloured = frames::clouds::colours(SMALL).into_iter().map(|colours| (colours.name, colours.frame));
    let clouds = frames::clouds::clouds(SMALL).into_iter().chain(coloured);
    let clouds = clouds.map(|(name, cloud)| (name.to_string(), frames::with_techniques(&cloud, Active::Both, 4.0)));
    let mut compared = 0;
    for (name, frame) in frames::variety(SMALL).into_iter().chain(clouds) {
        let frame = Frame { roulette: 0.2, ..frame };
        if !frame.plays_before_weights() {
            continue;
        }
        let with = |pipeline: &Pipeline| pixels(&render_with(&frame, pipeline, WORKERS, SMALL, TILE_SIZE, 0..6).0);
        assert_eq!(with(&SIMD), with(&keeps_all), "{name}");
        compared += 1;
    }
    assert!(compared > 20, "only {compared} frames play before they weigh");
}

#[test]
fn the_size_of_the_wavefront_leaves_no_trace() {
    for frame in frames() {
        let with = |lanes: Option<usize>| {
            let workers = Workers { lanes, ..WORKERS };
            pixels(&render_with(&frame, &SIMD, workers, SIZE, TILE_SIZE, 0..6).0)
        };
        let usual = with(None);
        for lanes in [1, 8, 72, 1000, 4096] {
            assert_eq!(usual, with(Some(lanes)), "{lanes} lanes");
        }
    }
}

#[test]
fn the_size_of_tiles_leaves_no_trace() {
    for frame in frames() {
        let with = |tile: u32| pixels(&render_with(&frame, &SIMD, WORKERS, SIZE, tile, 0..6).0);
        let usual = with(TILE_SIZE);
        for tile in [1, 7, 64, 500] {
            assert_eq!(usual, with(tile), "tiles of {tile}");
        }
    }
}

#[test]
fn a_split_of_the_samples_merges_to_the_same_bits_in_any_order() {
    for frame in frames() {
        let whole = pixels(&render(&frame, SIZE, 0..23).0);
        let parts = [0..5, 5..6, 6..21, 21..23];
        for order in [[0, 1, 2, 3], [3, 1, 0, 2], [2, 3, 1, 0]] {
            let mut film = render(&frame, SIZE, parts[order[0]].clone()).0;
            for part in &order[1..] {
                film.merge(&render(&frame, SIZE, parts[*part].clone()).0);
            }
            assert_eq!(whole, pixels(&film), "order {order:?}");
        }
    }
}

#[test]
fn a_block_that_is_given_up_counts_no_samples() {
    let frame = frames::three_lights(0.6, Selection::IntensityDistance, SIZE);
    for bounces in [0, 1, 3, 1000] {
        let (film, arena) = (Film::new(&frame, Region::whole(SIZE[0], SIZE[1]), TILE_SIZE), Bump::new());
        let (mut wavefront, mut tile) = (Wavefront::new_in(&arena, &frame, &SIMD, 64), film.tile(0));
        let mut left = 0..bounces;
        let is_done = wavefront.render_while(0..4, &mut tile, || left.next().is_some());
        assert_eq!((is_done, tile.samples()), if bounces == 1000 { (true, 4) } else { (false, 0) });
    }
}

/// Blocks of one tile each, of which two of three requests get none, unless the worker has nothing else to do.
struct InTurn<'t> {
    left: Vec<(&'t mut Tile, Range<u32>)>,
    ended: Vec<u32>,
    asked: u32,
}

impl<'t> Blocks for InTurn<'t> {
    type Sums = &'t mut Tile;

    fn most(&self) -> usize {
        7
    }

    fn goes_on(&mut self) -> bool {
        true
    }

    fn next(&mut self, waits: bool, _: &mut Stats) -> Option<(&'t mut Tile, Range<u32>)> {
        self.asked += 1;
        if waits || self.asked.is_multiple_of(3) { self.left.pop() } else { None }
    }

    fn end(&mut self, _: &'t mut Tile, samples: u32, _: &mut Stats) {
        self.ended.push(samples);
    }
}

/// Paths of several blocks are in flight at a time, and a worker whose clock has run for very long starts it anew.
#[test]
fn blocks_in_flight_together_have_the_same_bits_as_each_alone() {
    for frame in frames() {
        let film = Film::new(&frame, Region::whole(SIZE[0], SIZE[1]), 4);
        let tiles = || (0..film.tile_count()).map(|tile| Tile::new(film.layers(), film.tile(tile).region()));
        let samples = |tile: usize| 0..3 + 5 * tile as u32 % 17;
        let arena = Bump::new();
        let mut wavefront = Wavefront::new_in(&arena, &frame, &SIMD, 64);
        let mut alone: Vec<Tile> = tiles().collect();
        alone.iter_mut().enumerate().for_each(|(tile, sums)| wavefront.render(samples(tile), sums));
        for before_the_last in [3, 50, 1 << 20] {
            let mut together: Vec<Tile> = tiles().collect();
            let left = together.iter_mut().enumerate().map(|(tile, sums)| (sums, samples(tile))).collect();
            let mut blocks = InTurn { left, ended: Vec::new(), asked: 0 };
            wavefront.step.clock = LAST_CLOCK - before_the_last;
            assert!(wavefront.render_blocks(&mut blocks));
            assert_eq!(blocks.ended.len(), alone.len());
            assert_eq!(wavefront.step.clock < LAST_CLOCK / 2, before_the_last < 1 << 20, "the clock");
            assert!(alone == together, "{before_the_last} segments before the clock's last");
        }
    }
}

#[test]
fn a_render_that_is_stopped_again_and_again_goes_on_to_the_same_bits() {
    let region = Region { x0: 3, y0: 4, x1: 14, y1: 9 };
    let frame = frames::three_lights(0.6, Selection::IntensityDistance, SIZE);
    // More workers than tiles.
    let renderer = Renderer::new(Workers { threads: 5, ..WORKERS }).expect("threads start");
    let whole = Film::new(&frame, region, TILE_SIZE);
    renderer.render(&frame, &SIMD, &whole, 7..2007, &Monitor::default());
    for tile in [TILE_SIZE, 4] {
        let (film, mut stops) = (Film::new(&frame, region, tile), 0);
        while film.fewest_samples() < 2000 {
            let monitor = Monitor::default();
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(std::time::Duration::from_millis(10));
                    monitor.stop.store(true, std::sync::atomic::Ordering::Relaxed);
                });
                renderer.render(&frame, &SIMD, &film, Samples::Missing(7..2007), &monitor);
            });
            stops += 1;
        }
        assert!(stops > 2, "{stops}");
        assert_eq!(pixels(&whole), pixels(&film), "tiles of {tile}");
        assert_eq!(film.coverage(&vec![7; film.tile_count()]).to_string(), "3,4,14,9:7..2007");
    }
}

#[test]
fn every_sample_can_be_replayed_alone() {
    let frame = frames::fog_facing(0.0, 0.9, SIZE);
    let sum: Vec<f64> = pixels(&render(&frame, SIZE, 0..4).0).iter().map(|pixel| 4.0 * pixel.mean[0]).collect();
    let mut replayed = vec![0.0; sum.len()];
    for sample in (0..4).rev() {
        let alone = pixels(&render(&frame, SIZE, sample..sample + 1).0);
        replayed.iter_mut().zip(alone).for_each(|(sum, pixel)| *sum += pixel.mean[0]);
    }
    assert_eq!(sum, replayed);
}

#[test]
fn a_window_of_the_image_has_the_pixels_of_the_whole() {
    let frame = frames::three_lights(0.6, Selection::Intensity, SIZE);
    let whole = render(&frame, SIZE, 0..5).0;
    let window = Film::new(&frame, Region { x0: 33, y0: 7, x1: 68, y1: 40 }, TILE_SIZE);
    let renderer = Renderer::new(WORKERS).expect("threads start");
    renderer.render(&frame, &SIMD, &window, 0..5, &Monitor::default());
    for y in 7..40 {
        for x in 33..68 {
            assert_eq!(whole.pixel(x, y), window.pixel(x, y), "({x}, {y})");
        }
    }
}

/// The facing fog scene with these settings.
fn scene(settings: &[&str]) -> LoadedScene {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-facing");
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// What the pilot makes of `scene`.
fn piloted(scene: &LoadedScene, workers: Workers) -> (Frame, Vec<Trial>) {
    let renderer = Renderer::new(workers).expect("threads start");
    pilot::choose(&scene.frame, scene.scene.film.size, scene.choices(), &renderer, &Monitor::default())
}

#[test]
fn the_pilot_chooses_by_scene_and_seed_alone() {
    let fog = scene(&[]);
    let usual = piloted(&fog, Workers { threads: 1, ..WORKERS });
    assert!(!usual.1.is_empty());
    for workers in [
        Workers { threads: 2, ..WORKERS },
        Workers { threads: 5, ..WORKERS },
        Workers { lanes: Some(8), ..WORKERS },
        Workers { detailed_stats: true, ..WORKERS },
    ] {
        assert_eq!(piloted(&fog, workers), usual, "{workers:?}");
    }
    assert_eq!(piloted(&scene(&["render.samples=1000"]), WORKERS), usual, "the number of samples");
    let reseeded = piloted(&scene(&["render.seed=2"]), WORKERS);
    assert_ne!(reseeded.1, usual.1, "another seed is another look");
}
