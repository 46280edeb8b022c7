//! ```text
//! light sum  = sum over lights of share / distance
//! first near = min(first near, depth) if |x - c_l| <= (near + R_l) 1.0001 for any light l
//! ```
//!
//! 1. Batches in which no vertex may connect are left alone; in others all light sums are filled, as nobody reads those
//!    of vertices that may not.

use wide::u32x8;

use super::Columns;
use crate::connect::light_sample::selection;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { lights, near, starts, live, paths, last_surface, vertex, outlook } = columns;
    let n = live.batches();
    let (birth, last_surface, position) = (paths.birth.view(n), last_surface.depth.view(n), vertex.position.view(n));
    let (light_sum, first_near) = (outlook.light_sum.view_mut(n), outlook.first_near.view_mut(n));
    for (b, live) in live.each_batch() {
        let depth = u32x8::splat(step.clock) - birth[b];
        let nth = depth - last_surface[b].max(u32x8::splat(1));
        let may = lanes::as_mask(nth.simd_lt(u32x8::splat(starts)));
        if lanes::bits(may) & live == 0 {
            continue;
        }
        let position = position.at(b);
        if lights.selection_depends_on_start() {
            light_sum[b] = selection::light_sum(lights, position);
        }
        if near.is_finite() {
            let near = lanes::as_integer_mask(selection::may_be_within(lights, near, position) & may);
            first_near[b] = near.select(first_near[b].min(depth), first_near[b]);
        }
    }
}
