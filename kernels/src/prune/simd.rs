//! ```text
//! end the path if depth + 1 == segments, or if it meets no surface and its flight is endless or ends in a medium that
//! does not scatter
//! ```

use wide::{f32x8, u32x8};

use super::Columns;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { segments, scatters, flights, on_surface, paths, live } = columns;
    let n = live.batches();
    let birth = paths.birth.view(n);
    let oldest = u32x8::splat((step.clock + 1).wrapping_sub(segments));
    for (b, birth) in birth.iter().enumerate() {
        let ended = lanes::bits(lanes::as_mask(birth.simd_eq(oldest)));
        let endless = lanes::bits(flights.flight.batch(b).simd_eq(f32x8::splat(f32::INFINITY)));
        let turns = on_surface.batch(b) | if scatters { !endless } else { 0 };
        live.remove_batch(b, ended | !turns);
    }
}
