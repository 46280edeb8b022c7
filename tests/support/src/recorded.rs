//! Queues recorded from a real frame: the state of a wavefront in the middle of its paths.

use bumpalo::Bump;
use fogbow::film::{Region, Tile, layers};
use fogbow::frame::Frame;
use fogbow::wavefront::{RaysOf, Wavefront};
use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::lis::{self, Lis};
use fogbow_kernels::connect::mvnee::Mvnee;
use fogbow_kernels::lanes::LANES;
use fogbow_kernels::pipeline::SIMD;

/// A wavefront of `lanes` paths of `frame` after `bounces` segments, at the moment when its next vertices have been
/// made and every queue is filled. Image: 256 x 256.
pub fn wavefront<'q>(arena: &'q Bump, frame: &'q Frame, lanes: usize, bounces: u32) -> Wavefront<'q> {
    let mut wavefront = Wavefront::new_in(arena, frame, &SIMD, lanes);
    let mut tile = Tile::new(&layers(frame), Region::whole(256, 256));
    wavefront.advance(0..1, &mut tile, bounces);
    wavefront.requested.clear();
    wavefront.remember();
    wavefront.medium_sample();
    wavefront.extend(RaysOf::Paths);
    wavefront.light_hit(RaysOf::Paths);
    wavefront.turn();
    wavefront.step.clock += 1;
    wavefront.light_survey();
    wavefront
}

/// Builds MVNEE's connections, bucket by bucket.
pub fn build_mvnee(wavefront: &mut Wavefront<'_>, mvnee: &Mvnee) {
    wavefront.light_sample(mvnee.scope());
    wavefront.join(mvnee, Some(&wavefront.frame.lights), wavefront.frame.lengths, wavefront.step);
}

/// Builds bridges, bucket by bucket.
pub fn build_bridges(wavefront: &mut Wavefront<'_>, bridge: &Bridge) {
    wavefront.light_sample(bridge.scope());
    wavefront.join(bridge, Some(&wavefront.frame.lights), wavefront.frame.lengths, wavefront.step);
}

/// Builds the connections of light importance sampling; a bucket's rows insert one vertex more than it says.
pub fn build_lis(wavefront: &mut Wavefront<'_>, lis: &Lis) {
    wavefront.light_sample(lis::scope(wavefront.frame.lengths));
    wavefront.join_from_light(lis);
}

/// Leaves only the first `live` lanes of every batch alive.
pub fn thin_out(wavefront: &mut Wavefront<'_>, live: usize) {
    for lane in 0..wavefront.live.batches() * LANES {
        if lane % LANES >= live {
            wavefront.live.remove(lane);
        }
    }
}
