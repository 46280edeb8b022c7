//! Stages on queues recorded from a real frame, all but light_hit, first_surface and surface, whose rows are few: kernel,
//! for eight rows and for the widest registers, and twin, by live lanes and rows; arithmetic stages also against the same
//! algorithm as a plain f32 loop with libm.
//!
//! ```text
//! cargo bench --bench stages
//! ```

#[path = "support/plain.rs"]
mod plain;

use bumpalo::Bump;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fogbow::film::aov::Origin;
use fogbow::frame::Frame;
use fogbow::wavefront::{RaysOf, Source, Wavefront};
use fogbow_kernels::columns::queues::{Bucket, Request};
use fogbow_kernels::connect::{Technique, lis, nee, omnee};
use fogbow_kernels::media::Medium;
use fogbow_kernels::mis_weight::Competing;
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::pipeline::{Joint, Pipeline, REFERENCE, SIMD, WIDEST};
use fogbow_kernels::random;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::recorded::{build_bridges, build_lis, build_mvnee, thin_out, wavefront};

/// Kernels and twins.
const PIPELINES: [(&str, Pipeline); 2] = [("simd", SIMD), ("twin", REFERENCE)];

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

/// The same in fog of three extinctions.
fn coloured_frame() -> Frame {
    let grey = nee_frame();
    let medium = Medium::coloured([1.2, 1.7, 2.4], [1.0; 3], PhaseFunction::henyey_greenstein(0.9));
    frames::with_techniques(&frames::with_medium(&grey, medium), Active::Nee, 4.0)
}

/// One stage as a function of the state.
type Stage = fn(&mut Wavefront<'_>);

/// The stages that work on lanes.
const LANE_STAGES: [(&str, Stage); 13] = [
    ("generate", |w| w.generate()),
    ("remember", |w| w.remember()),
    ("medium_sample", |w| w.medium_sample()),
    ("features", |w| w.features()),
    ("first_flight", |w| w.first_flight()),
    ("extend", |w| w.extend(RaysOf::Paths)),
    ("prune", |w| w.prune()),
    ("flight_weight", |w| w.flight_weight()),
    ("spectral_weight", |w| w.spectral_weight()),
    ("scatter", |w| w.scatter()),
    ("light_survey", |w| w.light_survey()),
    ("light_sample", |w| w.light_sample(nee::SCOPE)),
    ("nee", |w| {
        w.nee(false);
    }),
];

fn request_all(w: &mut Wavefront<'_>, live: usize) {
    w.requested.clear();
    for lane in (0..ROWS).filter(|lane| lane % 8 < live) {
        w.requests.set_row(lane, Request { x: lane as u32 % 256, y: 0, sample: 1 });
        w.requested.insert(lane);
    }
}

fn lane_stages(c: &mut Criterion) {
    let [grey, coloured, layered] = [nee_frame(), coloured_frame(), frames::with_all_layers(&nee_frame())];
    for (name, stage) in LANE_STAGES {
        let frame = match name {
            "spectral_weight" => &coloured,
            "features" => &layered,
            _ => &grey,
        };
        let mut group = c.benchmark_group(name);
        for live in 1..=8 {
            let arena = Bump::new();
            let mut w = wavefront(&arena, frame, ROWS, BOUNCES);
            thin_out(&mut w, live);
            request_all(&mut w, live);
            group.throughput(Throughput::Elements((ROWS / 8 * live) as u64));
            group.bench_function(BenchmarkId::new("simd, live lanes of 8", live), |b| {
                b.iter(|| stage(&mut w));
            });
        }
        for (pipeline, table) in [("widest registers", WIDEST), ("twin", REFERENCE)] {
            let arena = Bump::new();
            let mut w = wavefront(&arena, frame, ROWS, BOUNCES);
            request_all(&mut w, 8);
            w.pipeline = table;
            group.bench_function(pipeline, |b| b.iter(|| stage(&mut w)));
        }
        group.finish();
    }
}

fn plain_loops(c: &mut Criterion) {
    let frame = nee_frame();
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    w.light_sample(nee::SCOPE);
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
        w.light_sample(nee::SCOPE);
        let rows = rows.min(w.candidates.connections.len);
        let bucket = Bucket { inserted: 0, start: 0, len: rows };
        group.throughput(Throughput::Elements(rows as u64));
        for (name, pipeline) in [("simd, rows", SIMD), ("twin, rows", REFERENCE)] {
            w.pipeline = pipeline;
            group.bench_function(BenchmarkId::new(name, rows), |b| {
                b.iter(|| w.mis_weight(Competing::All, Source::Connections, bucket));
            });
        }
    }
    group.finish();
}

/// OMNEE's stages, the sieve and the roulette, on as many connections as a table of that size has.
fn single_vertex(c: &mut Criterion) {
    let frame = frames::with_techniques(&mvnee_frame(), Active::Omnee, 4.0);
    // All weights are below one, so that every batch of the roulette draws.
    let frame = Frame { roulette: 1e6, ..frame };
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, ROWS, BOUNCES);
    w.light_sample(omnee::scope(frame.lengths));
    let bucket = Bucket { inserted: 1, ..w.candidates.connections.direct() };
    let mut group = c.benchmark_group("omnee");
    group.throughput(Throughput::Elements(bucket.len as u64));
    for (name, pipeline) in PIPELINES {
        w.pipeline = pipeline;
        group.bench_function(BenchmarkId::new("build", name), |b| b.iter(|| w.omnee_build()));
        group.bench_function(BenchmarkId::new("sift", name), |b| b.iter(|| w.sift(Source::Connections, bucket)));
        group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
            b.iter(|| w.mis_weight(Competing::All, Source::Connections, bucket));
        });
        group.bench_function(BenchmarkId::new("roulette", name), |b| {
            b.iter(|| {
                w.worth.weight.rows_mut().fill(0.5);
                w.roulette(Source::Connections, bucket, random::OMNEE_LIGHT);
            });
        });
    }
    group.finish();
}

/// Counting and placing the vertices of connections, all buckets together.
fn join<T: Joint>(c: &mut Criterion, name: &str, w: &mut Wavefront<'_>, technique: &T) {
    let mut group = c.benchmark_group(format!("{name}, count and build per edge"));
    let edges: usize = w.buckets.buckets().iter().map(|bucket| bucket.len * (bucket.inserted + 1)).sum();
    group.throughput(Throughput::Elements(edges as u64));
    for (name, pipeline) in PIPELINES {
        w.pipeline = pipeline;
        group.bench_function(name, |b| b.iter(|| w.join(technique, Some(&w.frame.lights), w.frame.lengths, w.step)));
    }
    group.finish();
}

/// Weight, shadow test and contribution of MVNEE, bucket by bucket.
fn mvnee_stages(c: &mut Criterion) {
    let frame = mvnee_frame();
    let mvnee = frame.techniques.mvnee.expect("an MVNEE frame");
    let arena = Bump::new();
    // More paths than a worker has, so that every bucket is filled.
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    build_mvnee(&mut w, &mvnee);
    join(c, "mvnee", &mut w, &mvnee);
    for inserted in [0, 1, 2, 4, 6] {
        let bucket = w.buckets.buckets()[inserted];
        let mut group = c.benchmark_group(format!("mvnee, {inserted} inserted"));
        group.throughput(Throughput::Elements(bucket.len as u64));
        for (name, pipeline) in PIPELINES {
            w.pipeline = pipeline;
            for (stage, competing) in [("mis_weight, own start", Competing::Own), ("mis_weight", Competing::All)] {
                group.bench_function(BenchmarkId::new(stage, name), |b| {
                    b.iter(|| w.mis_weight(competing, Source::Bridged, bucket));
                });
            }
            group.bench_function(BenchmarkId::new("occlusion", name), |b| {
                b.iter(|| w.occlusion(Source::Bridged, bucket));
            });
            group.bench_function(BenchmarkId::new("accumulate", name), |b| {
                b.iter(|| w.accumulate(Origin::Connection(Technique::Bridge), Source::Bridged, bucket));
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
    for (name, pipeline) in PIPELINES {
        w.pipeline = SIMD;
        w.light_sample(lis::scope(frame.lengths));
        w.pipeline = pipeline;
        group.throughput(Throughput::Elements(w.candidates.connections.len as u64));
        group.bench_function(BenchmarkId::new("vertex", name), |b| b.iter(|| w.lis_vertex(&settings)));
        w.pipeline = SIMD;
        build_lis(&mut w, &settings);
        w.pipeline = pipeline;
        group.bench_function(BenchmarkId::new("join", name), |b| b.iter(|| w.lis_join()));
    }
    group.finish();
    w.pipeline = SIMD;
    build_lis(&mut w, &settings);
    let bucket = w.buckets.buckets()[3];
    let mut group = c.benchmark_group("lis, 4 inserted");
    group.throughput(Throughput::Elements(bucket.len as u64));
    for (name, pipeline) in PIPELINES {
        w.pipeline = pipeline;
        group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
            b.iter(|| w.mis_weight(Competing::All, Source::Bridged, Bucket { inserted: 4, ..bucket }));
        });
    }
    group.finish();
}

/// Bridges: making them, and their weights; elements of the latter are starts, of which every row has those of its path
/// and those that the bridge inserts.
fn bridge_stages(c: &mut Criterion) {
    let frame = frames::with_techniques(&mvnee_frame(), Active::Bridge, 4.0);
    let bridge = frame.techniques.bridge.clone().expect("a frame with bridges");
    let arena = Bump::new();
    let mut w = wavefront(&arena, &frame, 8 * ROWS, BOUNCES);
    build_bridges(&mut w, &bridge);
    join(c, "bridge", &mut w, &bridge);
    for inserted in [0, 1, 2, 4, 6] {
        let bucket = w.buckets.buckets()[inserted];
        let depth = BOUNCES as usize + 1;
        let mut group = c.benchmark_group(format!("bridge, weight per start, {inserted} inserted"));
        group.throughput(Throughput::Elements((bucket.len * (depth + inserted)) as u64));
        for (name, pipeline) in PIPELINES {
            w.pipeline = pipeline;
            group.bench_function(BenchmarkId::new("mis_weight", name), |b| {
                b.iter(|| w.mis_weight(Competing::All, Source::Bridged, bucket));
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
    targets = lane_stages, plain_loops, direct_rows, single_vertex, mvnee_stages, lis_stages, bridge_stages
}
criterion_main!(benches);
