//! Where cells are, and how large.
//!
//! The cells of a lone grid are cubes of 2^k of its voxels, so that extrema are those of whole voxels; a lone box or ball
//! of one extinction has one cell; everything else has cells along the axes of the world in the box around all volumes.

use glam::{DAffine3, DVec3};
use wide::{f32x8, u32x8};

use super::bricks::Extent;
use super::cells::{Cells, Survey, THICKNESS, counts};
use super::known::OneShape;
use super::volume::{Placed, Volume, extinction};
use super::voxels::Voxels;
use crate::vec3::Vec3x8;

/// Fewest and most cells along the longest edge of a box around volumes.
const ALONG: [f64; 2] = [32.0, 96.0];

/// By how much of its edge a cell is taken to be smaller, so that a shape's border that is a cell's, too, is not in it
/// for rounding.
const ROUNDED: f64 = 1e-6;

/// How cells lie.
pub struct Lattice {
    kind: Kind,
    /// Cells along each axis.
    dims: [u32; 3],
    /// From the world to cells, counted from the first one.
    pub to_cells: DAffine3,
}

enum Kind {
    /// Of so many voxels of a lone grid along each edge, as a power of two.
    Voxels(u32),
    /// Along the axes of the world.
    World,
}

/// The voxels of a lone grid without a shape, in vacuum.
fn lone_grid(volumes: &[Volume], around: f32) -> Option<(&Voxels, f32)> {
    match volumes {
        [Volume { shape: None, voxels: Some(voxels), extinction }] if around == 0.0 => Some((voxels, *extinction)),
        _ => None,
    }
}

impl Lattice {
    /// The best one, as far as is known.
    pub fn best(volumes: &[Volume], around: f32) -> Self {
        if let Some((voxels, unit)) = lone_grid(volumes, around) {
            return Self::of_voxels(voxels, Cells::best_log_side(voxels, unit));
        }
        let bounds = bounds_of(volumes);
        if OneShape::of(volumes).is_some() {
            return Self::along_axes(bounds, [1; 3]);
        }
        let longest = (bounds[1] - bounds[0]).max_element();
        let most = |volume: &Volume| {
            let densest = volume.range(bounds[0], bounds[1]).map_or(0.0, |range| range.most);
            f64::from(densest)
        };
        let densest = volumes.iter().map(most).fold(0.0, f64::max);
        let edge = (f64::from(THICKNESS) / densest).clamp(longest / ALONG[1], longest / ALONG[0]);
        Self::of_edge(bounds, edge)
    }

    /// Another one: of 2^`log_side` voxels along each edge, or with so much smaller edges than the box around all.
    pub fn other(volumes: &[Volume], around: f32, log_side: u32) -> Self {
        if let Some((voxels, _)) = lone_grid(volumes, around) {
            return Self::of_voxels(voxels, log_side);
        }
        let bounds = bounds_of(volumes);
        Self::of_edge(bounds, (bounds[1] - bounds[0]).max_element() / f64::from(1 << log_side))
    }

    fn of_voxels(voxels: &Voxels, log_side: u32) -> Self {
        let side = f64::from(1 << log_side);
        let to_cells = DAffine3::from_scale(DVec3::splat(1.0 / side)) * voxels.to_own;
        Self { kind: Kind::Voxels(log_side), dims: counts(&voxels.bricks, log_side), to_cells }
    }

    fn of_edge(bounds: [DVec3; 2], edge: f64) -> Self {
        let dims = (bounds[1] - bounds[0]).to_array().map(|extent| (extent / edge).ceil().max(1.0) as u32);
        Self::along_axes(bounds, dims)
    }

    fn along_axes([low, high]: [DVec3; 2], dims: [u32; 3]) -> Self {
        let scale = DVec3::from(dims.map(f64::from)) / (high - low);
        let to_cells = DAffine3::from_scale(scale) * DAffine3::from_translation(-low);
        Self { kind: Kind::World, dims, to_cells }
    }

    /// The volumes as seen from the cells.
    pub fn place(&self, volumes: Vec<Volume>) -> Vec<Placed> {
        let place = |volume: Volume| match self.kind {
            Kind::Voxels(log_side) => volume.placed_in_voxels(f64::from(1 << log_side)),
            Kind::World => volume.placed(&self.to_cells),
        };
        volumes.into_iter().map(place).collect()
    }

    /// What is in the cells.
    pub fn survey(&self, volumes: &[Placed], around: f32) -> Survey {
        match (&self.kind, volumes) {
            (Kind::Voxels(log_side), [Placed { volume: Volume { voxels: Some(voxels), extinction, .. }, .. }]) => {
                Survey::of_voxels(voxels, *extinction, *log_side)
            }
            _ => {
                let from_cells = self.to_cells.inverse();
                let edge = from_cells.transform_vector3(DVec3::ONE).max_element();
                Survey::new(self.dims, edge as f32, around, |place| survey(volumes, around, place, &from_cells))
            }
        }
    }
}

/// Corners of the box around all of these `[m]`.
pub fn bounds_of<'a>(volumes: impl IntoIterator<Item = &'a Volume>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    volumes.into_iter().map(Volume::bounds).fold(none, |[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// What is in the cell at `place`, and the volumes that may be there.
fn survey(volumes: &[Placed], around: f32, place: [u32; 3], from_cells: &DAffine3) -> (Extent, u32) {
    let first = DVec3::from(place.map(f64::from));
    let corners = [first + ROUNDED, first + (1.0 - ROUNDED)].map(|corner| from_cells.transform_point3(corner));
    let (mut least, mut most, mut present, mut covered) = (f32::INFINITY, f32::NEG_INFINITY, 0, false);
    for (number, placed) in volumes.iter().enumerate() {
        let Some(range) = placed.volume.range(corners[0], corners[1]) else { continue };
        (least, most) = (least.min(range.least), most.max(range.most));
        present |= 1 << number;
        covered = range.covers;
        if covered {
            break;
        }
    }
    if !covered {
        (least, most) = (least.min(around), most.max(around));
    }
    let mean = if least == most { most } else { mean(volumes, around, present, first) };
    (Extent { least, most, mean: mean.clamp(least, most) }, present)
}

/// Mean extinction of the cell from `first` on, of some points in it.
fn mean(volumes: &[Placed], around: f32, present: u32, first: DVec3) -> f32 {
    let first = first.as_vec3().to_array();
    let layer = f32x8::new([0, 1, 2, 3, 0, 1, 2, 3].map(|i: u8| (f32::from(i) + 0.5) / 4.0));
    let row = f32x8::new([0, 0, 0, 0, 1, 1, 1, 1].map(|i: u8| f32::from(i)));
    let mut sum = 0.0;
    for (z, y) in (0..4_u8).flat_map(|z| [0_u8, 2].map(move |y| (z, y))) {
        let along = |axis: usize, offset: f32x8| f32x8::splat(first[axis]) + offset;
        let rows = (row + f32x8::splat(f32::from(y) + 0.5)) * f32x8::splat(0.25);
        let at = Vec3x8::new(along(0, layer), along(1, rows), along(2, f32x8::splat((f32::from(z) + 0.5) / 4.0)));
        sum += extinction(volumes, around, u32x8::splat(present), at).0.reduce_add();
    }
    sum / 64.0
}
