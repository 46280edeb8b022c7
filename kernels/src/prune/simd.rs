//! ```text
//! end the path if depth + 1 == segments, or if its flight ends in a medium that does not scatter
//! ```

use wide::u32x8;

use super::Columns;
use crate::{Step, lanes};

/// The SIMD kernel; see [`Kernel`](super::Kernel).
pub fn run(step: Step, columns: Columns<'_, '_>) {
    let Columns { segments, scatters, on_surface, paths, live } = columns;
    let n = live.batches();
    let birth = paths.birth.view(n);
    let oldest = u32x8::splat((step.clock + 1).wrapping_sub(segments));
    for (b, birth) in birth.iter().enumerate() {
        let ended = lanes::bits(lanes::as_mask(birth.simd_eq(oldest)));
        let stuck = if scatters { 0 } else { !on_surface.batch(b) };
        live.remove_batch(b, ended | stuck);
    }
}
