//! ```text
//! r = p_A P_l s (sin theta / theta) exp(tau(L)) / (F p_w mu_t cos_light)      two edges from the light, cos theta > -blur
//! ```
//!
//! 1. The blur of an angle is that of positions over the lengths of the edges.

use wide::f32x8;

use crate::connect::BLUR;
use crate::connect::suffix::{Arrival, Suffix};
use crate::media::MediumX8;
use crate::transcendental::exp;

/// Ratio of the one start that the technique has, two edges from the light; `forward_share` is F.
#[inline(always)]
pub fn ratio<M: MediumX8>(arrival: &Arrival<'_, M>, suffix: &Suffix<'_>, forward_share: f32x8) -> f32x8 {
    let Arrival { medium, inverse_area, last_squared, cos_light, .. } = *arrival;
    let (point, inserted, start) = (&suffix.vertices[0], &suffix.vertices[1], &suffix.vertices[2]);
    let cosine = inserted.leaving.dot(start.leaving);
    let sine = start.leaving.mul_neg_add(cosine, inserted.leaving).length_squared().sqrt();
    let theta = sine.atan2(cosine);
    let straight = sine.simd_le(f32x8::splat(1e-6));
    let sinc = straight.select(f32x8::ONE, sine / theta);
    let distance = (point.position - start.position).length_squared().sqrt();
    let first = (inserted.position - start.position).length_squared().sqrt();
    let second = last_squared.sqrt();
    let blur = (point.position.length_squared().sqrt() + distance) * f32x8::splat(BLUR);
    let forward = (cosine * first * second).simd_gt(-blur * (first + second));
    let geometry = inverse_area * start.attempt * distance * sinc * start.inverse_density;
    // Walks and the connection may see different extinctions: the suffix knows the one that walks see.
    let walked = if M::VARIES {
        exp(start.depth - medium.log_extinction_along(1, start.log_extinction))
    } else {
        exp(start.depth) / medium.extinction(inserted.position)
    };
    let ratio = geometry * walked / (forward_share * cos_light);
    (start.eligible & forward).select(ratio, f32x8::ZERO)
}
