//! Rays against a million triangles: how fast the tree is built, and how fast rays of every kind go through it.
//!
//! ```text
//! cargo bench --bench rays
//! ```

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fogbow_kernels::trace::{self, Ray};
use fogbow_testing::meshes;

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
    let geometry = meshes::million().geometry();
    println!("{} bytes per triangle", geometry.bytes() / geometry.len());
    for (name, rays) in ray_sets() {
        let mut group = c.benchmark_group(format!("rays/{name}"));
        group.sample_size(10).throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function("closest", |b| {
            b.iter(|| rays.iter().filter(|ray| trace::closest(black_box(&geometry), ray).is_some()).count());
        });
        group.bench_function("any", |b| {
            b.iter(|| rays.iter().filter(|ray| trace::any(black_box(&geometry), ray)).count());
        });
    }
}

fn building(c: &mut Criterion) {
    let mesh = meshes::million();
    let mut group = c.benchmark_group("rays");
    group.sample_size(10);
    group.bench_function("build", |b| b.iter(|| black_box(mesh.geometry())));
}

criterion_group!(benches, tracing, building);
criterion_main!(benches);
