//! Every stage on queues recorded from a real frame: kernel and twin, by live lanes and rows; arithmetic stages also
//! against the same algorithm as a plain f32 loop with libm.
//!
//! ```text
//! cargo bench --bench stages
//! ```

#[path = "support/plain.rs"]
mod plain;

use bumpalo::Bump;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fogbow::frame::Frame;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::columns::queues::{Bucket, Request};
use fogbow_kernels::connect::{
    bridge::sample as bridge_sample, light_sample, lis, mvnee::sample as mvnee_sample, nee, omnee,
};
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD};
use fogbow_kernels::roulette::{self, Threshold};
use fogbow_kernels::{
    accumulate, extend, first_flight, generate, medium_sample, mis_weight, occlusion, random, scatter,
};
use fogbow_testing::frames::{self, Active};
use fogbow_testing::recorded::{build_bridges, build_lis, build_mvnee, connect, thin_out, wavefront};

/// Rows of the recorded tables.
const ROWS: usize = 512;
/// Segments after which they are recorded.
const BOUNCES: u32 = 6;

fn mvnee_frame() -> Frame {
    frames::fog_facing(0.0, 0.9, [256, 256])
}

fn nee_frame() -> Frame {
    frames::with_techniques(&mvnee_frame(), Active::Nee, 4.0)
}

/// One stage as a function of pipeline and state.
type Stage = fn(&Pipeline, &Frame, &mut Wavefront<'_>);

/// The stages that work on lanes.
const LANE_STAGES: [(&str, Stage); 6] = [
    ("generate", |pipeline, frame, w| {
        let Wavefront { requests, paths, vertices, rays, step, .. } = w;
        (pipeline.generate)(&frame.camera, *step, generate::Columns { requests, paths, vertices, rays });
    }),
    ("medium_sample", |pipeline, frame, w| {
        let Wavefront { paths, flights, step, .. } = w;
        (pipeline.medium_sample)(&frame.medium, &frame.walk, *step, medium_sample::Columns { paths, flights });
    }),
    ("first_flight", |pipeline, frame, w| {
        let Wavefront { requests, paths, vertices, rays, flights, step, .. } = w;
        let columns = first_flight::Columns { requests, paths, vertices, rays, flights };
        (pipeline.first_flight)(&frame.medium, &frame.lights, 0.05, *step, columns);
    }),
    ("extend", |pipeline, frame, w| {
        let Wavefront { paths, vertices, rays, flights, hits, surface_hits, step, .. } = w;
        (hits.len, surface_hits.len) = (0, 0);
        let columns = extend::Columns { paths, vertices, rays, flights, hits, surface_hits };
        (pipeline.extend)(&frame.lights, &frame.surfaces, *step, columns);
    }),
    ("scatter", |pipeline, frame, w| {
        let Wavefront { flights, paths, vertices, rays, step, .. } = w;
        (pipeline.scatter)(&frame.medium, *step, scatter::Columns { flights, paths, vertices, rays });
    }),
    ("light_sample", |pipeline, frame, w| {
        let Wavefront { paths, vertices, rays, connections, step, .. } = w;
        connections.len = 0;
        let columns = light_sample::Columns { paths, vertices, rays, connections };
        (pipeline.light_sample)(&frame.lights, nee::REACH, *step, columns);
    }),
];

fn request_all(w: &mut Wavefront<'_>, live: usize) {
    w.requests.lanes.clear();
    for lane in (0..ROWS).filter(|lane| lane % 8 < live) {
        w.requests.columns.set_row(lane, Request { x: lane as u32 % 256, y: 0, sample: 1 });
        w.requests.lanes.insert(lane as u32);
    }
}

fn lane_stages(c: &mut Criterion) {
    let frame = nee_frame();
    for (name, stage) in LANE_STAGES {
        let mut group = c.benchmark_group(name);
        for live in 1..=8 {
            let arena = Bump::new();
            let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
            thin_out(&mut w, live);
            request_all(&mut w, live);
            group.throughput(Throughput::Elements((ROWS / 8 * live) as u64));
            group.bench_function(BenchmarkId::new("simd, live lanes of 8", live), |b| {
                b.iter(|| stage(&SIMD, &frame, &mut w));
            });
        }
        let arena = Bump::new();
        let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
        request_all(&mut w, 8);
        group.bench_function("twin", |b| b.iter(|| stage(&REFERENCE, &frame, &mut w)));
        group.finish();
    }
}

fn plain_loops(c: &mut Criterion) {
    let frame = nee_frame();
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    connect(&mut w, &frame, nee::REACH);
    let mut state = plain::State::record(&w, &frame);
    let mut group = c.benchmark_group("plain f32 loops");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("medium_sample", |b| b.iter(|| state.medium_sample()));
    group.bench_function("extend", |b| b.iter(|| state.extend()));
    group.bench_function("scatter", |b| b.iter(|| state.scatter()));
    group.bench_function("light_sample", |b| b.iter(|| state.light_sample()));
    group.bench_function("mis_weight, nee", |b| b.iter(|| state.weigh_nee()));
    group.finish();
}

/// NEE's candidates, cut to so many rows.
fn direct_rows(c: &mut Criterion) {
    let frame = nee_frame();
    let mut group = c.benchmark_group("mis_weight, nee");
    for rows in [1, 8, 17, 64, 256, 400] {
        let arena = Bump::new();
        let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
        connect(&mut w, &frame, nee::REACH);
        let rows = rows.min(w.connections.len);
        let bucket = Bucket { inserted: 0, start: 0, len: rows };
        group.throughput(Throughput::Elements(rows as u64));
        for (name, pipeline) in [("simd, rows", SIMD), ("twin, rows", REFERENCE)] {
            group.bench_function(BenchmarkId::new(name, rows), |b| {
                b.iter(|| weigh(&pipeline, &frame, &mut w, bucket, false))
            });
        }
    }
    group.finish();
}

/// OMNEE's stages and the roulette, on as many connections as a table of that size has.
fn single_vertex(c: &mut Criterion) {
    let frame = frames::with_techniques(&mvnee_frame(), Active::Omnee, 4.0);
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    connect(&mut w, &frame, omnee::reach(frame.lengths));
    let bucket = Bucket { inserted: 1, ..w.connections.direct() };
    let mut group = c.benchmark_group("omnee");
    group.throughput(Throughput::Elements(bucket.len as u64));
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        group.bench_function(BenchmarkId::new("build", name), |b| {
            let Wavefront { paths, connections, chains, step, .. } = &mut w;
            b.iter(|| {
                let columns = omnee::sample::BuildColumns { paths, connections, chains };
                (pipeline.omnee_build)(&frame.medium, *step, columns);
            });
        });
        group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
            b.iter(|| weigh(&pipeline, &frame, &mut w, bucket, false));
        });
        group.bench_function(BenchmarkId::new("roulette", name), |b| {
            let Wavefront { paths, connections, step, .. } = &mut w;
            // All weights are below one, so that every batch draws.
            let threshold = Threshold { contribution: 1e6, purpose: random::OMNEE_LIGHT };
            b.iter(|| {
                connections.weight.rows_mut().fill(0.5);
                let columns = roulette::Columns { bucket, candidates: connections, paths };
                (pipeline.roulette)(&frame.medium, &frame.lights, threshold, *step, columns);
            });
        });
    }
    group.finish();
}

fn weigh(pipeline: &Pipeline, frame: &Frame, w: &mut Wavefront<'_>, bucket: Bucket, bridged: bool) {
    let Wavefront { connections, bridged: built, chains, paths, vertices, trail, suffix, step, .. } = w;
    let candidates = if bridged { built } else { connections };
    let columns = mis_weight::Columns { bucket, candidates, chains, paths, vertices, trail, suffix };
    let Frame { medium, lights, techniques, walk, lengths, .. } = frame;
    (pipeline.mis_weight)(medium, lights, techniques, walk, *lengths, *step, columns);
}

/// MVNEE's stages, bucket by bucket.
fn mvnee_stages(c: &mut Criterion) {
    let frame = mvnee_frame();
    let mvnee = frame.techniques.mvnee.expect("an MVNEE frame");
    let arena = Bump::new();
    // More paths than a worker has, so that every bucket is filled.
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    build_mvnee(&mut w, &frame, &mvnee);
    let mut group = c.benchmark_group("mvnee");
    group.throughput(Throughput::Elements(w.connections.len as u64));
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        group.bench_function(BenchmarkId::new("count", name), |b| {
            let Wavefront { paths, connections, buckets, step, .. } = &mut w;
            b.iter(|| {
                let columns = mvnee_sample::CountColumns { paths, connections, buckets };
                (pipeline.mvnee_count)(&frame.medium, frame.lengths, *step, columns);
            });
        });
        build_mvnee(&mut w, &frame, &mvnee);
        group.bench_function(BenchmarkId::new("build", name), |b| {
            let Wavefront { paths, connections, buckets, bridged, chains, step, .. } = &mut w;
            b.iter(|| {
                let columns = mvnee_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
                (pipeline.mvnee_build)(&frame.medium, &mvnee, *step, columns);
            });
        });
    }
    group.finish();

    for inserted in [0, 1, 2, 4, 6] {
        let bucket = w.buckets.buckets()[inserted];
        let mut group = c.benchmark_group(format!("mvnee, {inserted} inserted"));
        group.throughput(Throughput::Elements(bucket.len as u64));
        for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
            group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
                b.iter(|| weigh(&pipeline, &frame, &mut w, bucket, true));
            });
            group.bench_function(BenchmarkId::new("occlusion", name), |b| {
                let Wavefront { bridged, chains, .. } = &mut w;
                b.iter(|| {
                    let columns = occlusion::Columns { bucket, candidates: bridged, chains };
                    (pipeline.occlusion)(&frame.lights, &frame.surfaces, columns)
                });
            });
            group.bench_function(BenchmarkId::new("accumulate", name), |b| {
                let Wavefront { bridged, paths, step, .. } = &mut w;
                let mut dropped = accumulate::Dropped::default();
                b.iter(|| {
                    let columns = accumulate::Columns { bucket, candidates: bridged, paths, dropped: &mut dropped };
                    (pipeline.accumulate)(&frame.medium, &frame.lights, frame.lengths, *step, columns);
                });
            });
        }
        group.finish();
    }
}

/// The stages of light importance sampling, and its weights, which are those of a bridge seen from another end.
fn lis_stages(c: &mut Criterion) {
    let frame = frames::focused(&frames::with_techniques(&mvnee_frame(), Active::Lis, 4.0), &[20.0]);
    let settings = frame.techniques.lis.clone().expect("a frame with light importance sampling");
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    let mut group = c.benchmark_group("lis");
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        connect(&mut w, &frame, lis::reach(frame.lengths));
        group.throughput(Throughput::Elements(w.connections.len as u64));
        group.bench_function(BenchmarkId::new("vertex", name), |b| {
            let Wavefront { paths, connections, ends, step, .. } = &mut w;
            b.iter(|| {
                let columns = lis::sample::VertexColumns { paths, connections, ends };
                (pipeline.lis_vertex)(&frame.medium, &frame.lights, &settings, *step, columns);
            });
        });
        build_lis(&mut w, &frame, &settings);
        group.bench_function(BenchmarkId::new("join", name), |b| {
            let Wavefront { buckets, ends, bridged, chains, .. } = &mut w;
            b.iter(|| (pipeline.lis_join)(lis::sample::JoinColumns { buckets, ends, candidates: bridged, chains }));
        });
    }
    group.finish();
    build_lis(&mut w, &frame, &settings);
    let bucket = w.buckets.buckets()[3];
    let mut group = c.benchmark_group("lis, 4 inserted");
    group.throughput(Throughput::Elements(bucket.len as u64));
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
            b.iter(|| weigh(&pipeline, &frame, &mut w, Bucket { inserted: 4, ..bucket }, true));
        });
    }
    group.finish();
}

fn bridge_frame() -> Frame {
    frames::with_techniques(&mvnee_frame(), Active::Bridge, 4.0)
}

/// The stages of bridges, bucket by bucket.
fn bridge_stages(c: &mut Criterion) {
    let frame = bridge_frame();
    let bridge = frame.techniques.bridge.clone().expect("a frame with bridges");
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    build_bridges(&mut w, &frame, &bridge);
    let mut group = c.benchmark_group("bridge");
    group.throughput(Throughput::Elements(w.connections.len as u64));
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        group.bench_function(BenchmarkId::new("count", name), |b| {
            let Wavefront { paths, connections, buckets, step, .. } = &mut w;
            b.iter(|| {
                let columns = bridge_sample::CountColumns { paths, connections, buckets };
                (pipeline.bridge_count)(&frame.medium, &bridge, frame.lengths, *step, columns);
            });
        });
    }
    group.finish();

    build_bridges(&mut w, &frame, &bridge);
    let edges: usize = w.buckets.buckets().iter().map(|bucket| bucket.len * (bucket.inserted + 1)).sum();
    let mut group = c.benchmark_group("bridge, per edge");
    group.throughput(Throughput::Elements(edges as u64));
    for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
        group.bench_function(BenchmarkId::new("build", name), |b| {
            let Wavefront { paths, connections, buckets, bridged, chains, step, .. } = &mut w;
            b.iter(|| {
                let columns = bridge_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
                (pipeline.bridge_build)(&frame.medium, &bridge, *step, columns);
            });
        });
    }
    group.finish();
}

/// Weights of bridges; elements are starts, of which every row has those of its path and those that the bridge inserts.
fn bridge_weights(c: &mut Criterion) {
    let frame = bridge_frame();
    let bridge = frame.techniques.bridge.clone().expect("a frame with bridges");
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    build_bridges(&mut w, &frame, &bridge);
    for inserted in [0, 1, 2, 4, 6] {
        let bucket = w.buckets.buckets()[inserted];
        let depth = BOUNCES as usize + 1;
        let mut group = c.benchmark_group(format!("bridge, weight per start, {inserted} inserted"));
        group.throughput(Throughput::Elements((bucket.len * (depth + inserted)) as u64));
        for (name, pipeline) in [("simd", SIMD), ("twin", REFERENCE)] {
            group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
                b.iter(|| weigh(&pipeline, &frame, &mut w, bucket, true));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(600));
    targets = lane_stages, plain_loops, direct_rows, single_vertex, mvnee_stages, lis_stages, bridge_stages, bridge_weights
}
criterion_main!(benches);
