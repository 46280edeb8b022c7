//! Walks without lights, a wavefront at a time: what samplers are tested on.

use bumpalo::Bump;
use fogbow::frame::Frame;
use fogbow::wavefront::Wavefront;
use fogbow_kernels::columns::queues::Request;
use fogbow_kernels::pipeline::SIMD;
use glam::DVec3;

/// Lanes of a wavefront of walks, pixels of an image of 64 x 64.
pub const LANES: usize = 4096;

/// Starts a path in every lane, `round` telling apart successive wavefronts.
pub fn start(wavefront: &mut Wavefront<'_>, round: usize) {
    wavefront.requested.clear();
    for lane in 0..LANES {
        let request = Request { x: (lane % 64) as u32, y: (lane / 64) as u32, sample: round as u32 };
        wavefront.requests.set_row(lane, request);
        wavefront.requested.insert(lane);
    }
    wavefront.generate();
}

/// One scattering event of every path that survives until then.
pub fn walk(wavefront: &mut Wavefront<'_>) {
    wavefront.remember();
    wavefront.medium_sample();
    wavefront.scatter();
    wavefront.step.clock += 1;
    wavefront.light_survey();
}

/// Calls `visit` for wavefronts of `samples` walks in all, after `events` scattering events.
pub fn after_walks(frame: &Frame, samples: usize, events: usize, mut visit: impl FnMut(&mut Wavefront<'_>)) {
    let arena = Bump::new();
    let mut wavefront = Wavefront::new_in(&arena, frame, &SIMD, LANES);
    for round in 0..samples / LANES {
        start(&mut wavefront, round);
        (0..events).for_each(|_| walk(&mut wavefront));
        visit(&mut wavefront);
    }
}

/// A row as a vector of f64.
pub fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
