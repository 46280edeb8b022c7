//! The stages, one method each: what of the state a kernel may read and fill.

mod connect;
mod walk;
mod weigh;

use fogbow_kernels::lanes::LANES;

/// (rows, batches) of a queue of `len` rows.
pub(super) fn rows(len: usize) -> (usize, usize) {
    (len, len.div_ceil(LANES))
}
