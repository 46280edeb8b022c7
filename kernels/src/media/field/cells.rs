//! The coarse field: cells with the mean extinction in them, and how they are surveyed.

use rayon::prelude::*;
use wide::{f32x8, i32x8, u32x8};

use super::blocks::{Block, EDGE};
use super::bricks::{Bricks, Extent, SIDE};
use super::voxels::Voxels;
use crate::lanes::gather;
use crate::vec3::Vec3x8;

/// Optical thickness of a cell, at the largest extinction, up to which cells are made larger, and from which on they are
/// made smaller: what weights make of coarser means costs more than it saves.
pub const THICKNESS: f32 = 1.0;

/// Optical depth by which the mean of a cell may exceed its least extinction along its edge. Where it does by more, as at
/// the border of something dense, light comes by the thin part of the cell, of which the mean says nothing: an optical
/// depth that is much too large gives a connection next to no weight, until what comes through multiplies it by e to
/// that. Too small a one only has others count more.
const UNSURE: f32 = 1.0;

/// Edges of cells, as powers of two in voxels.
const SIDES: core::ops::RangeInclusive<u32> = 1..=7;

/// Most cells of a grid.
const MOST_CELLS: u64 = 1 << 22;

/// Memory that the cells of a sparse grid may take, as a share of that of its bricks; and how many are few enough in any
/// case.
const SHARE: f64 = 0.25;
const FEW_CELLS: u64 = 1 << 12;

/// Bytes per cell of means and bounds.
const BYTES: f64 = size_of::<f32>() as f64 + size_of::<Block>() as f64 / (EDGE * EDGE * EDGE) as f64;

/// Where the cells of a box are in a column: x runs fastest, then y; with a layer all around of what is outside, so that
/// a ray that has just left the box, but for rounding, is still in one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Cells along each axis.
    pub dims: [u32; 3],
}

/// What a survey finds in cells of one size in a box; x runs fastest, then y.
pub struct Survey {
    /// Cells along each axis.
    pub dims: [u32; 3],
    /// Length of the longest edge of a cell `[m]`.
    pub edge: f32,
    /// Extinction around all of them [1/m].
    pub outside: f32,
    /// What extinctions range over in each [1/m].
    pub extents: Vec<Extent>,
    /// The volumes that may be in each, bit by bit.
    pub volumes: Vec<u32>,
}

/// Mean extinctions of cells of one size in a box, less in a cell that is thick and uneven.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    layout: Layout,
    means: Vec<f32>,
}

/// Means of cells, by points that are in one of them, or of those around.
#[derive(Clone, Copy)]
pub struct Lookup<'a> {
    means: &'a [f32],
    /// From a cell to the next one along y, and along z.
    row: i32x8,
    layer: i32x8,
    /// The last of all means.
    last: u32x8,
}

impl Layout {
    /// From a cell to the next one along each axis.
    pub fn strides(&self) -> [i32; 3] {
        let [width, height, _] = self.dims.map(|dim| dim as i32 + 2);
        [1, width, width * height]
    }

    /// How many there are, with those around.
    pub fn count(&self) -> usize {
        self.dims.iter().map(|dim| *dim as usize + 2).product()
    }

    /// Where the cell at `place` is, which is inside.
    pub fn index(&self, place: [u32; 3]) -> usize {
        let strides = self.strides();
        (0..3).map(|axis| (place[axis] as usize + 1) * strides[axis] as usize).sum()
    }

    /// Where the cells are that points, in cells, are in; outside it is one of those around.
    #[inline(always)]
    pub fn indices(&self, at: Vec3x8) -> i32x8 {
        let mut index = i32x8::splat(0);
        for ((v, count), stride) in [at.x, at.y, at.z].into_iter().zip(self.dims).zip(self.strides()) {
            // One beyond the last is one of those around, and so is, moved by one, the one before the first.
            let kept = (v + f32x8::ONE).fast_max(f32x8::ZERO).fast_min(f32x8::splat((count + 1) as f32));
            index += kept.fast_trunc_int() * i32x8::splat(stride);
        }
        index
    }
}

impl Survey {
    /// So many cells along each axis, of this `edge` `[m]`, in what is `outside` [1/m]. `survey` tells of each what
    /// extinctions range over in it, and the volumes that may be there.
    pub fn new(
        dims: [u32; 3],
        edge: f32,
        outside: f32,
        survey: impl Fn([u32; 3]) -> (Extent, u32) + Sync + Send,
    ) -> Self {
        let count = dims.iter().map(|dim| *dim as usize).product::<usize>();
        let found = (0..count).into_par_iter().map(|index| survey(place(dims, index)));
        let (extents, volumes) = found.unzip();
        Self { dims, edge, outside, extents, volumes }
    }

    /// The cells of a lone grid: cubes of 2^`log_side` voxels along each edge, with `unit` as the extinction of density 1
    /// [1/m].
    pub fn of_voxels(voxels: &Voxels, unit: f32, log_side: u32) -> Self {
        let edge = voxels.edge() as f32 * (1_u32 << log_side) as f32;
        let dims = counts(&voxels.bricks, log_side);
        Self::new(dims, edge, 0.0, |place| (extent(voxels, unit, place, log_side), 1))
    }

    /// What extinctions range over in the cell at `place` [1/m].
    pub fn at(&self, [x, y, z]: [u32; 3]) -> Extent {
        let [width, height, _] = self.dims.map(|dim| dim as usize);
        self.extents[(z as usize * height + y as usize) * width + x as usize]
    }

    /// Places of all cells, in their order.
    pub fn places(&self) -> impl Iterator<Item = [u32; 3]> {
        let dims = self.dims;
        (0..self.extents.len()).map(move |index| place(dims, index))
    }
}

/// The place of number `index` of all cells, or blocks.
pub fn place([width, height, _]: [u32; 3], index: usize) -> [u32; 3] {
    let [width, height] = [width, height].map(|dim| dim as usize);
    [index % width, index / width % height, index / (width * height)].map(|place| place as u32)
}

impl Cells {
    /// The means that a survey has found.
    pub fn new(survey: &Survey) -> Self {
        let layout = Layout { dims: survey.dims };
        let mut means = vec![survey.outside; layout.count()];
        for (place, extent) in survey.places().zip(&survey.extents) {
            means[layout.index(place)] = extent.mean.min(extent.least + UNSURE / survey.edge);
        }
        Self { layout, means }
    }

    /// The edge of cells that is best for a lone grid, as a power of two in voxels.
    pub fn best_log_side(voxels: &Voxels, unit: f32) -> u32 {
        let most = unit * voxels.bricks.most();
        if most == 0.0 {
            return SIDE.ilog2();
        }
        let thin = (THICKNESS / (most * voxels.edge() as f32)).log2().floor().max(0.0) as u32;
        let room = (SHARE * voxels.bytes() as f64 / BYTES) as u64;
        let most = room.clamp(FEW_CELLS, MOST_CELLS);
        let count = |log_side: &u32| -> u64 { counts(&voxels.bricks, *log_side).into_iter().map(u64::from).product() };
        SIDES.filter(|log_side| *log_side >= thin && count(log_side) <= most).min().unwrap_or(*SIDES.end())
    }

    /// Cells along each axis.
    #[inline(always)]
    pub fn dims(&self) -> [u32; 3] {
        self.layout.dims
    }

    /// Mean extinction of the cell at `place`, which is inside [1/m].
    pub fn mean(&self, place: [u32; 3]) -> f32 {
        self.means[self.layout.index(place)]
    }

    /// For looking up the means of many.
    #[inline(always)]
    pub fn lookup(&self) -> Lookup<'_> {
        let [_, row, layer] = self.layout.strides();
        let [row, layer] = [row, layer].map(i32x8::splat);
        Lookup { means: &self.means, row, layer, last: u32x8::splat(self.means.len() as u32 - 1) }
    }

    /// The same with all means multiplied by `factor`: what no image may depend on.
    pub fn distorted(mut self, factor: f32) -> Self {
        self.means.iter_mut().for_each(|mean| *mean *= factor);
        self
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.means.as_slice())
    }
}

impl Lookup<'_> {
    /// Mean extinctions [1/m] of the cells of points, which count from the first of the cells around on; any mean where a
    /// point is in none.
    #[inline(always)]
    pub fn at(&self, at: Vec3x8) -> f32x8 {
        let [x, y, z] = [at.x, at.y, at.z].map(|v| v.fast_trunc_int());
        let index: u32x8 = bytemuck::cast(z * self.layer + y * self.row + x);
        gather(self.means, index.min(self.last))
    }
}

/// How many cells of 2^`log_side` voxels a grid has along each axis.
pub fn counts(bricks: &Bricks, log_side: u32) -> [u32; 3] {
    bricks.dims.map(|dim| (dim * SIDE).div_ceil(1 << log_side))
}

/// What extinctions range over in a cell, from the voxels in it: those of one brick or a part of it, or of several bricks.
fn extent(voxels: &Voxels, unit: f32, place: [u32; 3], log_side: u32) -> Extent {
    let (bricks, smooth) = (&voxels.bricks, voxels.smooth());
    let side = 1_u32 << log_side;
    let part = side.min(SIDE);
    let range = |axis: usize| {
        let end = ((place[axis] + 1) << log_side).min(bricks.dims[axis] * SIDE);
        (place[axis] << log_side..end).step_by(part as usize)
    };
    let parts = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
    let (mut least, mut most, mut sum, mut filled) = (f32::INFINITY, 0.0_f32, 0.0_f64, 0);
    for extent in parts.map(|first| bricks.extent(first, part, smooth)) {
        (least, most) = (least.min(extent.least), most.max(extent.most));
        sum += f64::from(extent.mean);
        filled += 1;
    }
    let whole = (side / part).pow(3);
    if filled < whole {
        least = 0.0;
    }
    let [least, most, mean] = [least, most, (sum / f64::from(whole)) as f32].map(|density| unit * density);
    Extent { least, most, mean: mean.clamp(least, most) }
}
