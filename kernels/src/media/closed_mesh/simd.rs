//! Eight points at once, one after the other from where their columns are known.
//!
//! ```text
//! outside unless within the bounds
//! number = 0
//! for layers of the column, from the highest down:
//!     if z >= high: stop
//!     if z >= low:  add the crossings of the layer's triangles above z, and stop
//!     number = the one below the layer
//! inside if number is not 0
//! ```
//!
//! 1. Eight points are in eight columns, of which most end after a comparison or two: there is nothing to share.

use wide::f32x8;

use super::ClosedMesh;
use crate::lanes;
use crate::vec3::Vec3x8;

impl ClosedMesh {
    /// All-ones lanes where the points are inside.
    #[inline]
    pub fn contains(&self, at: Vec3x8) -> f32x8 {
        let [x, y, z] = at.to_arrays();
        let mut inside = 0;
        for lane in lanes::each(lanes::bits(self.within_bounds(at))) {
            inside |= u32::from(self.winds_around([x[lane], y[lane], z[lane]])) << lane;
        }
        lanes::mask(inside)
    }

    #[inline(always)]
    fn within_bounds(&self, at: Vec3x8) -> f32x8 {
        let [low, high] = self.bounds.map(Vec3x8::splat);
        let x = at.x.simd_ge(low.x) & at.x.simd_le(high.x);
        let y = at.y.simd_ge(low.y) & at.y.simd_le(high.y);
        x & y & at.z.simd_ge(low.z) & at.z.simd_le(high.z)
    }

    /// Whether the surface winds around a point within its bounds.
    #[inline(always)]
    pub(super) fn winds_around(&self, at: [f32; 3]) -> bool {
        let at = self.view.place(at);
        let mut number = 0;
        for (layer, members) in self.columns.layers(self.columns.find(at)) {
            if at[2] >= layer.high {
                break;
            }
            if at[2] >= layer.low {
                number += self.crossings(members, at);
                break;
            }
            number = layer.below;
        }
        number != 0
    }

    /// Crossings of these triangles above a point of the view.
    #[inline(always)]
    fn crossings(&self, members: &[u32], at: [f32; 3]) -> i32 {
        members.iter().map(|facet| self.facets[*facet as usize].crossings(at)).sum()
    }
}
