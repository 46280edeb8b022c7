//! Whole frames: fog-facing, 256 x 256, g .9, K 15, and dense-plate, per technique; a lamp of 2 and of 10 082
//! triangles; three lights and swarms of more; fog as a grid of equal voxels beside fog itself; and the bare walk that no
//! renderer can beat.
//!
//! ```text
//! cargo bench --bench frame
//! ```

#[path = "support/floor.rs"]
mod floor;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use fogbow::film::{Film, Region, TILE_SIZE};
use fogbow::frame::Frame;
use fogbow::render::{Monitor, Renderer, Workers};
use fogbow_kernels::media::field::{Field, Interpolation, Voxels};
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD};
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::frames::clouds::{centred, leaves, with_field};
use fogbow_testing::frames::{self, Active};
use glam::DVec3;

const SIZE: [u32; 2] = [256, 256];

type Frames = Vec<(&'static str, Frame)>;

fn fog_facing() -> Frames {
    let base = frames::fog_facing(0.0, 0.9, SIZE);
    vec![
        ("path", frames::with_techniques(&base, Active::Path, 4.0)),
        ("nee", frames::with_techniques(&base, Active::Nee, 4.0)),
        ("mvnee-2", frames::with_techniques(&base, Active::Mvnee, 2.0)),
        ("mvnee-4", frames::with_techniques(&base, Active::Mvnee, 4.0)),
        ("mvnee-8", frames::with_techniques(&base, Active::Mvnee, 8.0)),
        ("nee and omnee", frames::with_techniques(&base, Active::Omnee, 4.0)),
        ("bridge, all starts", frames::with_techniques(&base, Active::Bridge, 4.0)),
        ("bridge, 1 start", frames::with_techniques(&base, Active::Bridge, 4.0).with_walk(1, 1.0)),
    ]
}

/// The fog of fog-facing, and a grid of 64^3 equal voxels that has it in a cube of 40 m.
fn constant_grid() -> Frames {
    let fog = frames::fog_facing(0.0, 0.9, SIZE);
    let voxels = Voxels::new(&leaves(8, |_| 1.0), &centred(64, 40.0, DVec3::ZERO), Interpolation::Trilinear);
    let grid = with_field(&fog, Field::grid(voxels, fog.medium.largest_extinction()));
    let of = |base: &Frame, active: Active| {
        let mut frame = frames::with_techniques(base, active, 4.0);
        // In a field the companion has no limit.
        frame.techniques.lis.iter_mut().for_each(|lis| lis.near = f32::INFINITY);
        frame
    };
    vec![
        ("fog, path", of(&fog, Active::Path)),
        ("grid, path", of(&grid, Active::Path)),
        ("fog, nee", of(&fog, Active::Nee)),
        ("grid, nee", of(&grid, Active::Nee)),
        ("fog, mvnee-4", of(&fog, Active::Mvnee)),
        ("grid, mvnee-4", of(&grid, Active::Mvnee)),
        ("fog, bridge", of(&fog, Active::Bridge)),
        ("grid, bridge", of(&grid, Active::Bridge)),
        ("fog, lis", of(&fog, Active::Lis)),
        ("grid, lis", of(&grid, Active::Lis)),
        ("fog, nee and omnee", of(&fog, Active::Omnee)),
        ("grid, nee and omnee", of(&grid, Active::Omnee)),
    ]
}

fn dense_plate() -> Frames {
    let base = frames::shipped("dense-plate", SIZE, Active::Path);
    let bridge = frames::with_techniques(&base, Active::Bridge, 4.0);
    vec![
        ("nee", frames::with_techniques(&base, Active::Nee, 4.0)),
        ("mvnee-4", frames::with_techniques(&base, Active::Mvnee, 4.0)),
        ("mvnee-8", frames::with_techniques(&base, Active::Mvnee, 8.0)),
        ("bridge, all starts", bridge.clone()),
        ("bridge, all starts, roulette .1", Frame { roulette: 0.1, ..bridge }),
    ]
}

fn lamp() -> Frames {
    vec![("2 triangles", frames::panel(1, SIZE)), ("10 082 triangles", frames::panel(71, SIZE))]
}

fn swarms() -> Frames {
    let swarm = |count: u32| {
        let frame = frames::swarm(count, Selection::IntensityDistance, SIZE);
        frames::with_techniques(&frame, Active::Nee, 4.0)
    };
    vec![("3", swarm(0)), ("67", swarm(64)), ("1003", swarm(1000)), ("10 003", swarm(10_000))]
}

fn bench(c: &mut Criterion, group: &str, frames: Frames, pipeline: &Pipeline, samples: u32, threads: &[usize]) {
    let mut group = c.benchmark_group(group);
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.throughput(Throughput::Elements(u64::from(SIZE[0] * SIZE[1] * samples)));
    for (name, frame) in frames {
        for threads in threads {
            let workers = Workers { threads: *threads, lanes: None, detailed_stats: false };
            let renderer = Renderer::new(workers).expect("threads start");
            let film = Film::new(&frame, Region::whole(SIZE[0], SIZE[1]), TILE_SIZE);
            group.bench_function(BenchmarkId::new(name, format!("{threads} threads")), |b| {
                b.iter(|| renderer.render(&frame, pipeline, &film, 0..samples, &Monitor::default()));
            });
        }
    }
    group.finish();
}

/// Elements are camera samples.
fn frame(c: &mut Criterion) {
    bench(c, "fog-facing", fog_facing(), &SIMD, 16, &[1, 2]);
    bench(c, "dense-plate", dense_plate(), &SIMD, 4, &[2]);
    bench(c, "lamp", lamp(), &SIMD, 4, &[2]);
    bench(c, "lights", swarms(), &SIMD, 4, &[2]);
    bench(c, "constant grid", constant_grid(), &SIMD, 8, &[1]);
    bench(c, "fog-facing, twins", fog_facing(), &REFERENCE, 1, &[1]);
}

/// Elements are walks of 15 segments: random words, flight, one disk, scattering, and nothing else.
fn floor(c: &mut Criterion) {
    let mut group = c.benchmark_group("bare walk");
    let mut walk = floor::WalkLimits::new(512);
    group.throughput(Throughput::Elements(512));
    group.bench_function("15 segments", |b| b.iter(|| walk.run(15)));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(4));
    targets = floor, frame
}
criterion_main!(benches);
