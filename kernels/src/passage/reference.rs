//! Running sums in f64.
//!
//! ```text
//! from x to x':    depth += tau~(x, x'),    log += ln mu_t(x')
//! ```
//!
//! The segment from the camera does not count, nor does the extinction at a surface.

use glam::DVec3;

use super::Columns;
use crate::Step;
use crate::columns::paths::Passage;
use crate::media::reference::Medium as _;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { medium, live, on_surface, paths, vertex, next, passages, trails } = columns;
    for (number, (passage, trail)) in passages.iter_mut().zip(trails).enumerate() {
        let medium = medium.twin_of_sum(number);
        for lane in live.each() {
            let [from, to] = [vertex, next].map(|v| DVec3::from(v.position.row(lane).map(f64::from)));
            let is_first = paths.depth_of(step.clock, lane) == 0;
            let Passage { depth, log_extinction } = passage.row(lane);
            let (mut sum, mut log) = (0.0, 0.0);
            if !is_first {
                sum = f64::from(depth) + medium.optical_depth(from, to);
                log = f64::from(log_extinction);
            }
            if !on_surface.contains(lane) {
                log += medium.event(to).ln();
            }
            let after = Passage { depth: sum as f32, log_extinction: log as f32 };
            passage.set_row(lane, after);
            trail.set_row(lane, step.clock + 1, [after.depth, after.log_extinction]);
        }
    }
}
