//! What bounds a volume: whether points are inside, and whether boxes are.
//!
//! ```text
//! box:     |p_i| <= 1 along each axis, of points p counted from its centre in halves of its edges
//! sphere:  |p|^2 <= 1, of points p counted from its centre in radii
//! mesh:    the number of times that it winds about the point is not 0        (`closed_mesh`)
//! voxels:  the density is not 0
//! ```

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use wide::f32x8;

use super::voxels::Voxels;
use crate::media::closed_mesh::{ClosedMesh, Fill};
use crate::vec3::Vec3x8;

/// A bounded part of space, its border without thickness or effect on light.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A box with edges along the axes.
    Box {
        /// Corner with the smallest coordinates `[m]`.
        low: DVec3,
        /// Corner with the largest coordinates `[m]`.
        high: DVec3,
    },
    /// A ball.
    Sphere {
        /// Centre `[m]`.
        center: DVec3,
        /// Radius `[m]`, > 0.
        radius: f64,
    },
    /// The inside of a closed surface.
    Mesh(Arc<ClosedMesh>),
    /// Where these densities are not 0.
    Voxels(Arc<Voxels>),
}

/// By how much shapes reach farther: points that rounding has moved across a border of cells that is one of a shape,
/// too, are still inside.
const WIDER: f32 = 1.0 + 1e-6;

impl Shape {
    /// A box from corner `low` to corner `high` `[m]`.
    ///
    /// # Panics
    /// If it has no inside.
    pub fn block([low, high]: [[f64; 3]; 2]) -> Self {
        assert!((0..3).all(|axis| low[axis] < high[axis]), "a box has an inside");
        Self::Box { low: DVec3::from(low), high: DVec3::from(high) }
    }

    /// Corners of the box around it `[m]`.
    pub fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Box { low, high } => [*low, *high],
            Self::Sphere { center, radius } => [*center - *radius, *center + *radius],
            Self::Mesh(mesh) => mesh.bounds().map(|corner| DVec3::from(corner.map(f64::from))),
            Self::Voxels(voxels) => voxels.bounds(),
        }
    }

    /// From the world to what [`Self::contains`] counts in.
    pub fn to_own(&self) -> DAffine3 {
        match self {
            Self::Box { low, high } => (DAffine3::from_translation((*low + *high) / 2.0)
                * DAffine3::from_scale((*high - *low) / 2.0))
            .inverse(),
            Self::Sphere { center, radius } => {
                DAffine3::from_scale(DVec3::splat(1.0 / radius)) * DAffine3::from_translation(-*center)
            }
            Self::Mesh(_) => DAffine3::IDENTITY,
            Self::Voxels(voxels) => voxels.to_own,
        }
    }

    /// Which points are inside.
    #[inline(always)]
    pub fn contains(&self, at: Vec3x8) -> f32x8 {
        match self {
            Self::Box { .. } => {
                let far = at.x.abs().fast_max(at.y.abs()).fast_max(at.z.abs());
                far.simd_le(f32x8::splat(WIDER))
            }
            Self::Sphere { .. } => at.length_squared().simd_le(f32x8::splat(WIDER)),
            Self::Mesh(mesh) => mesh.contains(at),
            Self::Voxels(voxels) => voxels.density(at).simd_gt(f32x8::ZERO),
        }
    }

    /// Whether a point is inside, for twins.
    pub fn contains_point(&self, at: DVec3) -> bool {
        match self {
            Self::Box { .. } => at.abs().max_element() <= f64::from(WIDER),
            Self::Sphere { .. } => at.length_squared() <= f64::from(WIDER),
            Self::Mesh(mesh) => mesh.contains_reference(at),
            Self::Voxels(voxels) => voxels.density_at(at) > 0.0,
        }
    }

    /// How much of a box in the world is inside.
    pub fn fills(&self, low: DVec3, high: DVec3) -> Fill {
        match self {
            Self::Box { low: own_low, high: own_high } => {
                if low.cmpge(*own_low).all() && high.cmple(*own_high).all() {
                    Fill::Inside
                } else if low.cmpge(*own_high).any() || high.cmple(*own_low).any() {
                    Fill::Outside
                } else {
                    Fill::Part
                }
            }
            Self::Sphere { center, radius } => {
                let near = center.clamp(low, high).distance(*center);
                let far = (*center - low).abs().max((high - *center).abs()).length();
                if far <= *radius {
                    Fill::Inside
                } else if near >= *radius {
                    Fill::Outside
                } else {
                    Fill::Part
                }
            }
            Self::Mesh(mesh) => {
                // A little more than the box: corners are rounded.
                let more = 1e-4 * (high - low);
                mesh.fills((low - more).as_vec3().to_array(), (high + more).as_vec3().to_array())
            }
            Self::Voxels(voxels) => match voxels.extent(low, high) {
                extent if extent.most == 0.0 => Fill::Outside,
                extent if extent.least > 0.0 => Fill::Inside,
                _ => Fill::Part,
            },
        }
    }

    /// Hands the shape to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        let mut numbers = |numbers: &[f64]| numbers.iter().for_each(|x| digest(&x.to_le_bytes()));
        match self {
            Self::Box { low, high } => numbers(&[0.0, low.x, low.y, low.z, high.x, high.y, high.z]),
            Self::Sphere { center, radius } => numbers(&[1.0, center.x, center.y, center.z, *radius]),
            Self::Mesh(mesh) => mesh.digest(digest),
            Self::Voxels(voxels) => voxels.digest(digest),
        }
    }

    /// Bytes that it takes besides voxels.
    pub fn bytes_besides_voxels(&self) -> usize {
        match self {
            Self::Box { .. } | Self::Sphere { .. } | Self::Voxels(_) => 0,
            Self::Mesh(mesh) => mesh.bytes(),
        }
    }
}
