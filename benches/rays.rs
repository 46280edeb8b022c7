//! Rays of every kind, eight at a time as stages ask, against a million triangles and against a thousand; how fast the
//! tree is built; and few triangles, with the tree and without.
//!
//! ```text
//! cargo bench --bench rays
//! cargo bench --bench rays -- few
//! ```

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fogbow_kernels::lanes::{self, LANES};
use fogbow_kernels::tables::geometry::{Few, Geometry};
use fogbow_kernels::trace::{self, Ray, Rays, Search, ThroughTree};
use fogbow_testing::both_ways::batches;
use fogbow_testing::meshes;
use wide::u32x8;

/// Side of the camera's image, and square root of the number of the other rays.
const SIDE: u32 = 512;

/// What a path asks for: a view, then flights of a twentieth, of a third and of all of the scene's size of 2.
fn ray_sets() -> [(&'static str, Vec<Ray>); 4] {
    let flights = |flight: f64| meshes::flights((SIDE * SIDE) as usize, flight, 7);
    [
        ("camera", meshes::camera_rays(SIDE)),
        ("short", flights(0.05)),
        ("mid", flights(0.3)),
        ("long", flights(f64::INFINITY)),
    ]
}

fn tracing(c: &mut Criterion) {
    let thousand =
        [("sphere", meshes::bumpy_sphere(3)), ("room", meshes::room(1000)), ("soup", meshes::soup(1000, 0.2, 1))];
    for (place, mesh) in [("million", meshes::million())].into_iter().chain(thousand) {
        let geometry = mesh.geometry();
        println!("{place}: {} triangles of {} bytes", geometry.len(), geometry.bytes() / geometry.len());
        for (name, rays) in ray_sets() {
            let batches = batches(&rays);
            let group = format!("rays/{place}/{name}");
            search(c, &group, "tree", geometry.len(), &ThroughTree(&geometry), &batches);
            any(c, &group, &geometry, &batches);
        }
    }
}

/// Numbers of triangles in a room, and sides of landscapes of twice the square.
const ROOMS: [usize; 8] = [2, 10, 32, 64, 96, 128, 256, 1024];
const LANDSCAPES: [u32; 8] = [1, 2, 4, 6, 7, 8, 12, 23];
/// Rays by eight, so many that they stay in cache.
const BATCHES: usize = 1024;

/// Closest and any hits of eight rays at a time.
fn search(c: &mut Criterion, group: &str, way: &str, triangles: usize, search: &impl Search, rays: &[(Rays, u32)]) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
    group.throughput(Throughput::Elements((LANES * rays.len()) as u64));
    let met = |(rays, live): &(Rays, u32)| lanes::bits(search.closest(black_box(rays), *live).met).count_ones();
    group.bench_function(BenchmarkId::new(format!("closest, {way}"), triangles), |b| {
        b.iter(|| rays.iter().map(met).sum::<u32>());
    });
}

/// Whether eight rays at a time hit anything.
fn any(c: &mut Criterion, group: &str, geometry: &Geometry, rays: &[(Rays, u32)]) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10).throughput(Throughput::Elements((LANES * rays.len()) as u64));
    let hidden = |(rays, live): &(Rays, u32)| {
        trace::hidden(geometry, black_box(rays), *live, u32x8::splat(u32::MAX)).count_ones()
    };
    group.bench_function(BenchmarkId::new("any", geometry.len()), |b| {
        b.iter(|| rays.iter().map(hidden).sum::<u32>());
    });
}

fn few(c: &mut Criterion) {
    let rooms = ROOMS.map(|count| ("room", meshes::room(count)));
    let landscapes = LANDSCAPES.map(|side| ("landscape", meshes::landscape(side)));
    for (name, flight) in [("short", 0.1), ("long", f64::INFINITY)] {
        let rays = batches(&meshes::flights(LANES * BATCHES, flight, 7));
        for (place, mesh) in rooms.iter().chain(&landscapes) {
            let geometry = mesh.geometry();
            let (group, triangles) = (format!("few/{place}/{name}"), geometry.len());
            search(c, &group, "tree", triangles, &ThroughTree(&geometry), &rays);
            search(c, &group, "no tree", triangles, &Few::new(geometry.tree()), &rays);
            any(c, &group, &geometry, &rays);
        }
    }
}

fn building(c: &mut Criterion) {
    let mesh = meshes::million();
    let mut group = c.benchmark_group("rays");
    group.sample_size(10);
    group.bench_function("build", |b| b.iter(|| black_box(mesh.geometry())));
}

criterion_group!(benches, tracing, few, building);
criterion_main!(benches);
