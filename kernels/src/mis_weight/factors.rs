//! Factors that follow from where a candidate's vertices are, and how they were chosen.
//!
//! ```text
//! factor = resampling weight * product over inserted vertices of the albedo there
//! ```

use wide::f32x8;

use crate::columns::queues::{Bucket, ChainTable, WorthTable};
use crate::media::{AlbedosX8, Medium};

/// What the throughput leaves out of a bucket's candidates: the albedos of their inserted vertices, and their resampling
/// weights.
pub(super) fn fill(medium: &Medium, bucket: Bucket, chains: &ChainTable<'_>, worth: &mut WorthTable<'_>) {
    if let Some(albedos) = medium.albedos_by_place() {
        return fill_by_place(albedos, bucket, chains, worth);
    }
    for (factor, albedos) in worth.factor.channels_mut().iter_mut().zip(medium.albedos(bucket.inserted)) {
        let inserted = f32x8::splat(albedos);
        bucket.batches().for_each(|(b, _)| factor.set_batch(b, inserted * resampling(chains, bucket, b)));
    }
}

/// Resampling weights of batch `b`; nothing is known of rows without inserted vertices, which are not chosen.
#[inline(always)]
fn resampling(chains: &ChainTable<'_>, bucket: Bucket, b: usize) -> f32x8 {
    if bucket.inserted > 0 { chains.resampling.batch(b) } else { f32x8::ONE }
}

/// The same where albedos differ between places.
fn fill_by_place(albedos: AlbedosX8<'_>, bucket: Bucket, chains: &ChainTable<'_>, worth: &mut WorthTable<'_>) {
    for (b, _) in bucket.batches() {
        let mut product = [resampling(chains, bucket, b); 3];
        for vertex in &chains.vertices[..bucket.inserted] {
            let albedo = albedos.at(vertex.batch(b));
            product = core::array::from_fn(|c| product[c] * albedo[c]);
        }
        for (factor, product) in worth.factor.channels_mut().iter_mut().zip(product) {
            factor.set_batch(b, product);
        }
    }
}
