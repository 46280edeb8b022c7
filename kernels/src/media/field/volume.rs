//! A volume, alone and among others: the extinction in it, and where it is.

use glam::{DAffine3, DVec3};
use wide::{f32x8, u32x8};

use super::map::Map;
use super::shape::Shape;
use super::voxels::Voxels;
use crate::lanes;
use crate::media::closed_mesh::Fill;
use crate::vec3::Vec3x8;

/// A medium with bounds: those of its shape, or where the voxels that give its densities are not 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// What bounds it.
    pub shape: Option<Shape>,
    /// Densities; 1 everywhere without.
    pub voxels: Option<Voxels>,
    /// Extinction of density 1 [1/m], >= 0, but for what lies [between](super::Apart) channels.
    pub extinction: f32,
}

/// What extinctions range over in a box, and whether all of the box is in the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least extinction [1/m].
    pub least: f32,
    /// Largest extinction [1/m].
    pub most: f32,
    /// Whether nothing else shows.
    pub covers: bool,
}

/// A volume, as points in cells see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The volume.
    pub volume: Volume,
    /// From cells to what its shape counts in.
    to_shape: Map,
    /// From cells to voxels.
    to_voxels: Map,
}

impl Volume {
    /// Corners of the box around it `[m]`.
    ///
    /// # Panics
    /// If it has neither a shape nor voxels.
    pub fn bounds(&self) -> [DVec3; 2] {
        let all = [DVec3::NEG_INFINITY, DVec3::INFINITY];
        let [shape, voxels] = [self.shape.as_ref().map(Shape::bounds), self.voxels.as_ref().map(Voxels::bounds)]
            .map(|b| b.unwrap_or(all));
        let bounds = match self.shape {
            // Nothing shows through a shape where the densities in it are 0.
            Some(_) => shape,
            None => voxels,
        };
        assert!(bounds[0].is_finite(), "a volume has a shape or voxels");
        bounds
    }

    /// What is in a box of the world; none if nothing.
    pub fn range(&self, low: DVec3, high: DVec3) -> Option<Range> {
        let covers = match self.shape.as_ref().map(|shape| shape.fills(low, high)) {
            Some(Fill::Outside) => return None,
            Some(Fill::Inside) | None => true,
            Some(Fill::Part) => false,
        };
        let Some(voxels) = &self.voxels else {
            return Some(Range { least: self.extinction, most: self.extinction, covers });
        };
        let extent = voxels.extent(low, high);
        let bounded = self.shape.is_some();
        let [a, b] = [extent.least, extent.most].map(|density| density * self.extinction);
        (bounded || extent.most > 0.0).then_some(Range {
            least: a.min(b),
            most: a.max(b),
            covers: covers && (bounded || extent.least > 0.0),
        })
    }

    /// As seen from cells, to which `to_cells` leads from the world.
    pub fn placed(self, to_cells: &DAffine3) -> Placed {
        let from_cells = to_cells.inverse();
        let map = |to_own: Option<DAffine3>| Map::new(&to_own.map_or(DAffine3::IDENTITY, |to_own| to_own * from_cells));
        let to_shape = map(self.shape.as_ref().map(Shape::to_own));
        let to_voxels = map(self.voxels.as_ref().map(|voxels| voxels.to_own));
        Placed { volume: self, to_shape, to_voxels }
    }

    /// As seen from cells of `side` voxels.
    pub fn placed_in_voxels(self, side: f64) -> Placed {
        let to_voxels = Map::new(&DAffine3::from_scale(DVec3::splat(side)));
        Placed { volume: self, to_shape: to_voxels, to_voxels }
    }

    /// Hands everything that extinctions depend on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(&self.extinction.to_le_bytes());
        digest(&[u8::from(self.shape.is_some()), u8::from(self.voxels.is_some())]);
        if let Some(shape) = &self.shape {
            shape.digest(digest);
        }
        if let Some(voxels) = &self.voxels {
            voxels.digest(digest);
        }
    }

    /// The voxels of its densities and of its shape.
    pub fn all_voxels(&self) -> impl Iterator<Item = &Voxels> {
        let of_shape = self
            .shape
            .as_ref()
            .and_then(|shape| if let Shape::Voxels(voxels) = shape { Some(&**voxels) } else { None });
        self.voxels.iter().chain(of_shape)
    }

    /// Bytes that it takes besides voxels.
    pub fn bytes_besides_voxels(&self) -> usize {
        self.shape.as_ref().map_or(0, Shape::bytes_besides_voxels)
    }
}

impl Placed {
    /// Extinction at points in cells [1/m], and which of those in `asked` are in the volume.
    #[inline(always)]
    pub fn extinction(&self, at: Vec3x8, asked: f32x8) -> (f32x8, f32x8) {
        let mut inside = asked;
        let mut extinction = f32x8::splat(self.volume.extinction);
        if let Some(shape) = &self.volume.shape {
            inside &= shape.contains(self.to_shape.points(at));
        }
        if let Some(voxels) = &self.volume.voxels {
            let density = voxels.density(self.to_voxels.points(at));
            extinction = density * extinction;
            if self.volume.shape.is_none() {
                inside &= density.simd_gt(f32x8::ZERO);
            }
        }
        (extinction, inside)
    }

    /// Extinction at a point in cells [1/m], for twins; none outside.
    pub fn extinction_at(&self, at: DVec3) -> Option<f64> {
        let bounded = self.volume.shape.as_ref().map(|shape| shape.contains_point(self.to_shape.point(at)));
        if bounded == Some(false) {
            return None;
        }
        let density = self.volume.voxels.as_ref().map_or(1.0, |voxels| voxels.density_at(self.to_voxels.point(at)));
        (bounded.is_some() || density > 0.0).then(|| density * f64::from(self.volume.extinction))
    }
}

/// Extinction at points in cells [1/m] where `around` is what is around the volumes of the bits `present`, row by row,
/// and who is there: 0 for what is around, or the number of the volume, from 1 on.
#[inline(always)]
pub fn extinction(volumes: &[Placed], around: f32, present: u32x8, at: Vec3x8) -> (f32x8, u32x8) {
    let (mut extinction, mut who) = (f32x8::splat(around), u32x8::splat(0));
    let mut open = lanes::mask(lanes::ALL);
    for (number, placed) in volumes.iter().enumerate() {
        let bit = u32x8::splat(1 << number);
        let asked = open & lanes::as_mask((present & bit).simd_eq(bit));
        if !asked.any() {
            continue;
        }
        let (there, inside) = placed.extinction(at, asked);
        extinction = inside.select(there, extinction);
        who = lanes::as_integer_mask(inside).select(u32x8::splat(number as u32 + 1), who);
        open &= !inside;
        if !open.any() {
            break;
        }
    }
    (extinction, who)
}
