//! ```text
//! r = p_A P_l s^2 exp(tau(s)) / (p_w cos_light)          at the vertex next to the light
//! ```

use wide::f32x8;

use crate::connect::suffix::{Arrival, SuffixVertex};
use crate::media::MediumX8;
use crate::transcendental::exp;

/// Ratio of the one start that next event estimation has: the vertex next to the light.
#[inline(always)]
pub fn ratio<M: MediumX8>(arrival: &Arrival<'_, M>, start: &SuffixVertex) -> f32x8 {
    let Arrival { inverse_area, last_squared, cos_light, .. } = *arrival;
    let geometry = inverse_area * start.attempt * last_squared / cos_light;
    geometry * start.inverse_density * exp(start.depth)
}
