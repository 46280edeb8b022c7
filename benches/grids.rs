//! Rays through grids of densities: flights, transmittances, and the stages that only grids have.

use std::hint::black_box;

use bumpalo::Bump;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fogbow::wavefront::Source;
use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::nee;
use fogbow_kernels::media::grid::tracking::{Ray, reference, simd};
use fogbow_kernels::media::grid::{Grid, Interpolation};
use fogbow_kernels::pipeline::REFERENCE;
use fogbow_kernels::random::{self, Stream, uniform};
use fogbow_testing::frames::clouds::{centred, clouds, leaves};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::recorded::wavefront;
use glam::DVec3;

const RAYS: u32 = 4096;
/// Paths in flight, and the segments behind them.
const ROWS: usize = 2048;
const BOUNCES: u32 = 3;

/// A lumpy cloud of 256^3 voxels in a cube of 2 m, with a mean free path of 2 cm where it is densest.
fn cloud() -> Grid {
    let density = |place: [i32; 3]| {
        let at = place.map(|component| (f64::from(component) - 127.5) / 127.5);
        let waves = (21.0 * at[0]).sin() * (17.0 * at[1] + 1.0).sin() * (19.0 * at[2] - 0.5).sin();
        let fade = 1.0 - at.map(|x| x * x).iter().sum::<f64>();
        (fade.max(0.0) * (0.4 + waves).max(0.0)) as f32
    };
    Grid::new(&leaves(32, density), &centred(256, 2.0, DVec3::ZERO), 50.0, Interpolation::Trilinear)
}

/// Rays in random directions from random points of the cloud, of this `length` `[m]`: flights have 1.
fn rays(length: f64) -> Vec<Ray> {
    let ray = |i: u32| {
        let words = [random::words(i, 1, 2, 3), random::words(i, 4, 5, 6)];
        let [origin, end] = words.map(|words| DVec3::from([0, 1, 2].map(|axis| 2.0 * uniform(words[axis]) - 1.0)));
        let direction = length * end.normalize();
        let [origin, direction] = [0.6 * origin, direction].map(|v| v.as_vec3().to_array());
        Ray { origin, direction, stream: Stream::new(i, 7, 8, 9, 0) }
    };
    (0..RAYS).map(ray).collect()
}

/// Candidates of the flights of `rays`, collisions or not: the densities that are asked for.
fn candidates(grid: &Grid, rays: &[Ray]) -> u64 {
    let count = |ray: &Ray| {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| DVec3::from(v.map(f64::from)));
        u64::from(reference::fly(grid, origin, direction, ray.stream).1)
    };
    rays.iter().map(count).sum()
}

fn tracking(c: &mut Criterion) {
    let grid = cloud();
    let mut group = c.benchmark_group("grid of 256^3 voxels");
    let flights = rays(1.0);
    group.throughput(Throughput::Elements(candidates(&grid, &flights)));
    group.bench_function("flights, candidates", |b| {
        b.iter(|| {
            simd::flights(&grid, flights.iter().copied().enumerate(), |row, flight| {
                black_box((row, flight));
            })
        });
    });
    let segments = rays(0.1);
    group.throughput(Throughput::Elements(segments.len() as u64));
    group.bench_function("transmittances of 10 cm", |b| {
        b.iter(|| {
            simd::transmittances(&grid, segments.iter().copied().enumerate(), |row, product, known| {
                black_box((row, product, known));
            });
        });
    });
    group.finish();
}

fn stages(c: &mut Criterion) {
    let [(_, cloud), _] = clouds([256, 256]);
    let frame = frames::with_techniques(&cloud, Active::Both, 4.0);
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    w.light_sample(nee::SCOPE);
    let bucket = Bucket { inserted: 0, start: 0, len: w.candidates.connections.len };
    w.mis_weight(Source::Connections, bucket);
    for (name, pipeline) in [("simd", w.pipeline), ("twin", REFERENCE)] {
        let mut group = c.benchmark_group(format!("cloud, {name}"));
        w.pipeline = pipeline;
        group.throughput(Throughput::Elements(w.live.count() as u64));
        group.bench_function("medium_sample", |b| b.iter(|| w.medium_sample()));
        group.bench_function("passage", |b| b.iter(|| w.passage()));
        group.throughput(Throughput::Elements(bucket.len as u64));
        group.bench_function("mis_weight, nee", |b| b.iter(|| w.mis_weight(Source::Connections, bucket)));
        group.bench_function("transmittance", |b| {
            b.iter(|| w.transmittance(Source::Connections, bucket, nee::SCOPE.purpose));
        });
        group.finish();
    }
}

criterion_group!(benches, tracking, stages);
criterion_main!(benches);
