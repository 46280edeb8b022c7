//! ```text
//! T = T * weight
//! ```

use wide::f32x8;

use super::Columns;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { requested, live, weight, throughput } = columns;
    for (b, bits) in requested.each_batch() {
        let factor = lanes::mask(bits & live.batch(b)).select(weight.batch(b), f32x8::ONE);
        for channel in throughput.channels_mut() {
            channel.set_batch(b, channel.batch(b) * factor);
        }
    }
}
