//! ```text
//! depth' = depth + tau~(x, x'),   but 0 at the first vertex after the camera
//! log'   = log + ln mu_t(x'),     from 0 there; unchanged on a surface
//! ```

use wide::{f32x8, u32x8};

use super::Columns;
use crate::media::{MediumLanes, MediumX8 as _, log_event};
use crate::{Step, lanes, with_medium};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    with_medium!(columns.medium, |medium| add(step, columns, medium));
}

#[inline(always)]
fn add(step: Step, columns: Columns<'_, '_>, medium: impl MediumLanes) {
    let Columns { live, on_surface, paths, vertex, next, passages, trails, .. } = columns;
    for (b, rows) in live.each_batch() {
        let (from, to) = (vertex.position.batch(b), next.position.batch(b));
        let length = (to - from).length_squared().sqrt();
        let at_camera = lanes::as_mask(paths.birth.batch(b).simd_eq(u32x8::splat(step.clock)));
        let before = |depth: f32x8| at_camera.select(f32x8::ZERO, depth);
        for (sum, (passage, trail)) in passages.iter_mut().zip(trails.iter_mut()).enumerate() {
            let [passed, extinction] = medium.of_sum(sum).passed(rows, from, to, length);
            let passed = at_camera.select(f32x8::ZERO, passed);
            let event = lanes::mask(on_surface.batch(b)).select(f32x8::ZERO, log_event(extinction));
            let depth = before(passage.depth.batch(b)) + passed;
            let log_extinction = before(passage.log_extinction.batch(b)) + event;
            passage.depth.set_batch(b, depth);
            passage.log_extinction.set_batch(b, log_extinction);
            trail.set_batch(b, step.clock + 1, [depth, log_extinction]);
        }
    }
}
