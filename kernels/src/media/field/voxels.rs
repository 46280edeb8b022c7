//! Densities between voxels, wherever they are in the world.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use wide::f32x8;

use super::bricks::{Bricks, Extent, Leaf};
use super::map;
use crate::vec3::Vec3x8;

/// How densities between voxels are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Between the centres of the eight nearest voxels.
    Trilinear,
    /// That of the voxel that the point is in.
    Nearest,
}

/// Where voxels are: the affine map from the world `[m]` to index coordinates, row by row. Voxel i has its centre at
/// index coordinate i.
pub type ToIndex = [[f64; 4]; 3];

/// Voxels in the world. Copies, and others in other places, share their densities.
#[derive(Clone, Debug, PartialEq)]
pub struct Voxels {
    pub(super) bricks: Arc<Bricks>,
    pub(super) interpolation: Interpolation,
    /// From the world to voxels, counted from the first one.
    pub(super) to_own: DAffine3,
}

impl Voxels {
    /// The densities of `leaves`.
    ///
    /// # Panics
    /// If there is no leaf, or `to_index` has no inverse.
    pub fn new(leaves: &[Leaf], to_index: &ToIndex, interpolation: Interpolation) -> Self {
        Self::of(Arc::new(Bricks::new(leaves)), to_index, interpolation)
    }

    /// The densities of `bricks`.
    ///
    /// # Panics
    /// If `to_index` has no inverse.
    pub fn of(bricks: Arc<Bricks>, to_index: &ToIndex, interpolation: Interpolation) -> Self {
        // A voxel is half an index coordinate to either side of its centre.
        let half = if interpolation == Interpolation::Trilinear { 0.0 } else { 0.5 };
        let first = DVec3::from(bricks.origin.map(|along| along as f64));
        let to_own = DAffine3::from_translation(DVec3::splat(half) - first) * map::from_rows(to_index);
        assert!(to_own.matrix3.determinant() != 0.0, "voxels have an inside");
        Self { bricks, interpolation, to_own }
    }

    /// Whether densities are mixed between voxels.
    #[inline(always)]
    pub fn smooth(&self) -> bool {
        self.interpolation == Interpolation::Trilinear
    }

    /// Corners of the box around all voxels `[m]`.
    pub fn bounds(&self) -> [DVec3; 2] {
        let all = DVec3::from(self.bricks.voxels().map(f64::from));
        map::image(&self.to_own.inverse(), [DVec3::ZERO, all])
    }

    /// From the world to voxels, counted from the first one.
    pub fn to_own(&self) -> DAffine3 {
        self.to_own
    }

    /// Length of the shortest edge of a voxel `[m]`, about.
    pub fn edge(&self) -> f64 {
        let rows = self.to_own.matrix3.transpose();
        1.0 / [rows.x_axis, rows.y_axis, rows.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    /// Densities at points in voxels from the first one on; 0 outside.
    #[inline(always)]
    pub fn density(&self, at: Vec3x8) -> f32x8 {
        self.bricks.density(at, self.smooth())
    }

    /// What densities range over in a box of the world; the mean is of no meaning.
    pub fn extent(&self, low: DVec3, high: DVec3) -> Extent {
        let [low, high] = map::image(&self.to_own, [low, high]);
        self.bricks.extent_between(
            low.floor().as_i64vec3().to_array(),
            high.floor().as_i64vec3().to_array(),
            self.smooth(),
        )
    }

    /// Density at a point in voxels from the first one on, for twins.
    pub fn density_at(&self, at: DVec3) -> f64 {
        let first = at.floor();
        let value = |offset: DVec3| {
            let place = first + offset;
            self.bricks.value([place.x as i64, place.y as i64, place.z as i64])
        };
        if self.interpolation == Interpolation::Nearest {
            return value(DVec3::ZERO);
        }
        let share = at - first;
        let corners = (0..8).map(|corner| DVec3::from([0, 1, 2].map(|axis| f64::from(corner >> axis & 1))));
        let part = |corner: DVec3| {
            let near = (DVec3::ONE - corner) * (DVec3::ONE - share) + corner * share;
            near.x * near.y * near.z * value(corner)
        };
        corners.map(part).sum()
    }

    /// Hands everything that densities depend on to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(&[u8::from(self.smooth())]);
        map::Map::new(&self.to_own).digest(digest);
        self.bricks.digest(digest);
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.bricks.bytes()
    }
}

/// Bytes that all of these take: those that share their densities once.
pub fn bytes_of<'a>(all: impl Iterator<Item = &'a Voxels>) -> usize {
    let different: BTreeMap<_, _> = all.map(|voxels| (Arc::as_ptr(&voxels.bricks), voxels.bytes())).collect();
    different.values().sum()
}
