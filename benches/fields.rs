//! Rays through grids of densities: flights, transmittances, and the stages that only grids have; points in closed
//! meshes.

use std::hint::black_box;

use bumpalo::Bump;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fogbow::wavefront::Source;
use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::mvnee::{Mvnee, Seeds};
use fogbow_kernels::connect::nee;
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::media::closed_mesh::ClosedMesh;
use fogbow_kernels::media::field::tracking::{FlightsX8, Ray, RaysX8, batches, first_budget, reference, simd};
use fogbow_kernels::media::field::{Field, Interpolation, Voxels};
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::pipeline::REFERENCE;
use fogbow_kernels::random::{self, Stream, uniform};
use fogbow_kernels::vec3::Vec3x8;
use fogbow_testing::frames::clouds::{centred, clouds, leaves};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::meshes::{Random, bumpy_sphere};
use fogbow_testing::recorded::wavefront;
use glam::DVec3;
use wide::f32x8;

const RAYS: u32 = 4096;
/// Paths in flight, and the segments behind them.
const ROWS: usize = 2048;
const BOUNCES: u32 = 3;

/// A lumpy cloud of 256^3 voxels in a cube of 2 m, with a mean free path of 2 cm where it is densest.
fn cloud() -> Field {
    let density = |place: [i32; 3]| {
        let at = place.map(|component| (f64::from(component) - 127.5) / 127.5);
        let waves = (21.0 * at[0]).sin() * (17.0 * at[1] + 1.0).sin() * (19.0 * at[2] - 0.5).sin();
        let fade = 1.0 - at.map(|x| x * x).iter().sum::<f64>();
        (fade.max(0.0) * (0.4 + waves).max(0.0)) as f32
    };
    Field::grid(Voxels::new(&leaves(32, density), &centred(256, 2.0, DVec3::ZERO), Interpolation::Trilinear), 50.0)
}

/// Rays in random directions from random points of the cloud, of this `length` `[m]`: flights have 1.
fn rays(length: f64) -> Vec<Ray> {
    let ray = |i: u32| {
        let words = [random::words(i, 1, 2, 3), random::words(i, 4, 5, 6)];
        let [origin, end] = words.map(|words| DVec3::from([0, 1, 2].map(|axis| 2.0 * uniform(words[axis]) - 1.0)));
        let direction = length * end.normalize();
        let [origin, direction] = [0.6 * origin, direction].map(|v| v.as_vec3().to_array());
        Ray { origin, direction, stream: Stream::new(i, 7, 8, 9, 0), hues: [1.0; 3] }
    };
    (0..RAYS).map(ray).collect()
}

/// Candidates of the flights of `rays`, collisions or not: the densities that are asked for.
fn candidates(grid: &Field, rays: &[Ray]) -> u64 {
    let count = |ray: &Ray| {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| DVec3::from(v.map(f64::from)));
        u64::from(reference::fly(grid, 1.0, origin, direction, first_budget(ray.stream), ray.stream).1)
    };
    rays.iter().map(count).sum()
}

fn tracking(c: &mut Criterion) {
    let grid = cloud();
    let mut group = c.benchmark_group("grid of 256^3 voxels");
    let flights = rays(1.0);
    group.throughput(Throughput::Elements(candidates(&grid, &flights)));
    let batched: Vec<RaysX8<1>> = batches(&flights).collect();
    group.bench_function("flights, candidates", |b| {
        b.iter(|| {
            let of = |batch: &RaysX8<1>| FlightsX8::from(*batch);
            simd::flights(
                &grid,
                batched.iter().map(of),
                |first| batched[first / LANES].stream,
                |first, ended, flights| {
                    black_box((first, ended, flights));
                },
            )
        });
    });
    let segments = rays(0.1);
    group.throughput(Throughput::Elements(segments.len() as u64));
    group.bench_function("transmittances of 10 cm", |b| {
        b.iter(|| {
            simd::transmittances(&grid, batches(&segments), |row, product: [f32; 1], known| {
                black_box((row, product, known));
            });
        });
    });
    group.finish();
}

fn closed_mesh(c: &mut Criterion) {
    let shape = bumpy_sphere(5);
    let corner = |corner: u32| shape.positions[corner as usize];
    let triangles: Vec<_> = shape.corners.iter().map(|corners| corners.map(corner)).collect();
    let mesh = ClosedMesh::new(&triangles).expect("a closed mesh");
    let mut random = Random::new(1);
    let mut batch = || {
        let points: [[f32; 3]; 8] = core::array::from_fn(|_| random.in_cube().as_vec3().to_array());
        let [x, y, z] = [0, 1, 2].map(|axis| f32x8::new(points.map(|at| at[axis])));
        Vec3x8::new(x, y, z)
    };
    let points: Vec<Vec3x8> = (0..4096).map(|_| batch()).collect();
    let mut group = c.benchmark_group(format!("closed mesh of {} triangles", triangles.len()));
    group.throughput(Throughput::Elements(8 * points.len() as u64));
    group.bench_function("points", |b| b.iter(|| points.iter().for_each(|at| _ = black_box(mesh.contains(*at)))));
    group.throughput(Throughput::Elements(32 * 32 * 32));
    group.bench_function("boxes", |b| {
        let low = |i: i32| [i % 32, i / 32 % 32, i / 1024].map(|place| place as f32 / 16.0 - 1.0);
        let fill = |i: i32| mesh.fills(low(i), low(i).map(|x| x + 1.0 / 16.0));
        b.iter(|| (0..32 * 32 * 32).for_each(|i| _ = black_box(fill(i))));
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
    w.mis_weight(Competing::All, Source::Connections, bucket);
    for (name, pipeline) in [("simd", w.pipeline), ("twin", REFERENCE)] {
        let mut group = c.benchmark_group(format!("cloud, {name}"));
        w.pipeline = pipeline;
        group.throughput(Throughput::Elements(w.live.count() as u64));
        group.bench_function("medium_sample", |b| b.iter(|| w.medium_sample()));
        group.bench_function("passage", |b| b.iter(|| w.passage()));
        group.throughput(Throughput::Elements(bucket.len as u64));
        group.bench_function("mis_weight, nee", |b| {
            b.iter(|| w.mis_weight(Competing::All, Source::Connections, bucket))
        });
        group.bench_function("transmittance", |b| {
            b.iter(|| w.transmittance(Source::Connections, bucket, nee::SCOPE.purpose));
        });
        group.finish();
    }
}

/// Making MVNEE's connections through the cloud, with seeds of either kind, and bridges.
fn connections(c: &mut Criterion) {
    let [(_, cloud), _] = clouds([256, 256]);
    let arena = Bump::new();
    let mut group = c.benchmark_group("cloud, joined");
    for (name, seeds) in [("coarse seeds", Seeds::Coarse), ("fast seeds", Seeds::Fast)] {
        let frame = frames::with_techniques(&cloud, Active::Mvnee, 4.0);
        let mvnee = Mvnee { seeds, ..frame.techniques.mvnee.expect("an MVNEE frame") };
        let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
        w.light_sample(mvnee.scope());
        group.throughput(Throughput::Elements(w.candidates.connections.len as u64));
        group.bench_function(name, |b| b.iter(|| w.join(&mvnee, Some(&frame.lights), frame.lengths, w.step)));
    }
    let frame = frames::with_techniques(&cloud, Active::Bridge, 4.0);
    let bridge = frame.techniques.bridge.clone().expect("a frame with bridges");
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    w.light_sample(bridge.scope());
    group.throughput(Throughput::Elements(w.candidates.connections.len as u64));
    group.bench_function("bridges", |b| b.iter(|| w.join(&bridge, Some(&frame.lights), frame.lengths, w.step)));
    group.finish();
}

criterion_group!(benches, tracking, closed_mesh, stages, connections);
criterion_main!(benches);
