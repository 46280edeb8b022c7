//! Queues recorded from a real frame: the state of a wavefront in the middle of its paths.

use bumpalo::Bump;
use fogbow::film::{Region, Tile, layers};
use fogbow::frame::Frame;
use fogbow::stats::Stats;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::columns::LANES;
use fogbow_kernels::connect::bridge::{Bridge, sample as bridge_sample};
use fogbow_kernels::connect::buckets;
use fogbow_kernels::connect::light_sample::{self, Reach};
use fogbow_kernels::connect::lis::{self, Lis, Shape, sample as lis_sample};
use fogbow_kernels::connect::mvnee::{Mvnee, sample as mvnee_sample};
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::{Step, extend, light_hit, medium_sample, random, scatter, surface};

/// A wavefront of `lanes` paths of `frame` after `bounces` segments, at the moment when its next vertices have been made
/// and every queue is filled. Image: 256 x 256.
pub fn wavefront<'q>(arena: &'q Bump, frame: &Frame, lanes: usize, bounces: u32) -> Wavefront<'q> {
    let mut wavefront = Wavefront::new_in(arena, frame, lanes);
    let mut tile = Tile::new(&layers(frame), Region::whole(256, 256));
    let mut stats = Stats::new(false);
    wavefront.advance(frame, &SIMD, 0..1, &mut tile, &mut stats, bounces);
    let Wavefront { paths, vertices, rays, trail, flights, hits, surface_hits, views, light_hits, step, .. } =
        &mut wavefront;
    trail.remember(step.clock, &paths.live, vertices, rays);
    (SIMD.medium_sample)(&frame.medium, &frame.walk, *step, medium_sample::Columns { paths, flights });
    hits.len = 0;
    let columns = extend::Columns { paths, vertices, rays, flights, hits, surface_hits };
    (SIMD.extend)(&frame.lights, &frame.surfaces, *step, columns);
    (views.len, light_hits.len) = (0, 0);
    let columns = light_hit::Columns { hits, vertices, rays, flights, paths, views, light_hits };
    (SIMD.light_hit)(&frame.medium, &frame.lights, *step, columns);
    (SIMD.scatter)(&frame.medium, *step, scatter::Columns { flights, paths, vertices, rays });
    (SIMD.surface)(&frame.surfaces, *step, surface::Columns { surface_hits, flights, paths, vertices, rays });
    step.clock += 1;
    wavefront
}

/// Fills the connections of a technique for the vertices of the clock.
pub fn connect(wavefront: &mut Wavefront<'_>, frame: &Frame, reach: Reach) {
    let Wavefront { paths, vertices, rays, connections, step, .. } = wavefront;
    connections.len = 0;
    let columns = light_sample::Columns { paths, vertices, rays, connections };
    (SIMD.light_sample)(&frame.lights, reach, *step, columns);
}

/// Builds MVNEE's connections, bucket by bucket.
pub fn build_mvnee(wavefront: &mut Wavefront<'_>, frame: &Frame, mvnee: &Mvnee) {
    connect(wavefront, frame, mvnee.reach());
    let Wavefront { paths, connections, buckets, bridged, chains, step, .. } = wavefront;
    let columns = mvnee_sample::CountColumns { paths, connections, buckets };
    (SIMD.mvnee_count)(&frame.medium, frame.lengths, *step, columns);
    bridged.len = buckets.sort(connections.len);
    let columns = mvnee_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
    (SIMD.mvnee_build)(&frame.medium, mvnee, *step, columns);
}

/// Builds bridges, bucket by bucket.
pub fn build_bridges(wavefront: &mut Wavefront<'_>, frame: &Frame, bridge: &Bridge) {
    connect(wavefront, frame, bridge.reach());
    let Wavefront { paths, connections, buckets, bridged, chains, step, .. } = wavefront;
    let columns = bridge_sample::CountColumns { paths, connections, buckets };
    (SIMD.bridge_count)(&frame.medium, bridge, frame.lengths, *step, columns);
    bridged.len = buckets.sort(connections.len);
    let columns = bridge_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
    (SIMD.bridge_build)(&frame.medium, bridge, *step, columns);
}

/// Builds the connections of light importance sampling; a bucket's rows insert one vertex more than it says.
pub fn build_lis(wavefront: &mut Wavefront<'_>, frame: &Frame, settings: &Lis) {
    connect(wavefront, frame, lis::reach(frame.lengths));
    let Wavefront { paths, connections, ends, buckets, bridged, chains, step, .. } = wavefront;
    let columns = lis_sample::VertexColumns { paths, connections, ends };
    (SIMD.lis_vertex)(&frame.medium, &frame.lights, settings, *step, columns);
    let (lengths, step) = (lis::before_last(frame.lengths), Step { seed: random::lis_seed(step.seed), ..*step });
    let count = buckets::CountColumns { paths, connections, buckets };
    match &settings.shape {
        Shape::Bridge(bridge) => (SIMD.bridge_count)(&frame.medium, bridge, lengths, step, count),
        Shape::Mvnee(_) => (SIMD.mvnee_count)(&frame.medium, lengths, step, count),
    }
    bridged.len = buckets.sort(connections.len);
    let build = buckets::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
    match &settings.shape {
        Shape::Bridge(bridge) => (SIMD.bridge_build)(&frame.medium, bridge, step, build),
        Shape::Mvnee(mvnee) => (SIMD.mvnee_build)(&frame.medium, mvnee, step, build),
    }
    (SIMD.lis_join)(lis_sample::JoinColumns { buckets, ends, candidates: bridged, chains });
}

/// Leaves only the first `live` lanes of every batch alive.
pub fn thin_out(wavefront: &mut Wavefront<'_>, live: usize) {
    for lane in 0..wavefront.paths.batches() * LANES {
        if lane % LANES >= live {
            wavefront.paths.live.remove(lane as u32);
        }
    }
}
