//! The coarse field: cells with the mean and the extrema of the extinction in them.

use rayon::prelude::*;

use super::bricks::{Bricks, SIDE};
use super::voxels::Voxels;

/// What is known of a cell, as extinctions [1/m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Mean.
    pub mean: f32,
    /// No extinction in it is larger: the majorant of free flights.
    pub most: f32,
    /// About what transmittances are estimated: the mean, or in a cell that is thick and uneven the least extinction, so
    /// that no estimate exceeds the transmittance of that.
    pub control: f32,
    /// No extinction in it is farther from `control`: the majorant of residuals.
    pub spread: f32,
}

/// About what transmittances are estimated in a cell, and how far from it extinctions are, as in [`Cell`] [1/m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// What is known.
    pub control: f32,
    /// The majorant of the rest.
    pub spread: f32,
}

/// By how much bounds are widened: interpolation may round beyond the values at the corners.
const WIDER: f32 = 1.0 + 1e-5;

/// Optical thickness of a cell, at the largest majorant, up to which cells are made larger, and from which on they are
/// made smaller: a free flight has about as many candidates as it crosses cells.
pub const THICKNESS: f32 = 2.0;

/// Edges of cells, as powers of two in voxels.
const SIDES: core::ops::RangeInclusive<u32> = 1..=7;

/// Most cells of a grid.
const MOST_CELLS: u64 = 1 << 22;

/// Optical depth by which the middle of a cell may differ from its end at most if it is estimated about the mean. Each
/// such unit multiplies an estimate by up to two, and a few of them leave nothing but luck.
const UNEVEN: f32 = 1.0;

impl Cell {
    /// Of extinctions from `least` to `most`, with this `mean` [1/m], and of this `edge` `[m]`.
    pub fn new([least, most]: [f32; 2], mean: f32, edge: f32) -> Self {
        if least == most {
            return Self::even(most);
        }
        let spread = (most - mean).max(mean - least) * WIDER;
        let [control, spread] = if spread * edge > UNEVEN { [least, (most - least) * WIDER] } else { [mean, spread] };
        Self { mean, most: most * WIDER, control, spread }
    }

    /// Of one extinction everywhere [1/m].
    pub const fn even(extinction: f32) -> Self {
        Self { mean: extinction, most: extinction, control: extinction, spread: 0.0 }
    }

    fn residual(&self) -> Residual {
        Residual { control: self.control, spread: self.spread }
    }

    /// With the majorants multiplied by `factor` >= 1, and the mean by `mean`.
    fn distorted(self, factor: f32, mean: f32) -> Self {
        let [low, high] = [self.control - self.spread, self.most].map(|bound| bound.max(0.0));
        let control = if self.control == self.mean { self.mean * mean } else { self.control };
        let spread = (high - control).abs().max((control - low).abs()) * factor;
        Self { mean: self.mean * mean, most: self.most * factor, control, spread }
    }
}

/// Cells of one size in a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Cells along each axis.
    pub dims: [u32; 3],
    /// A column for each that is asked for by itself. x runs fastest, then y; with a layer of cells all around of what is
    /// outside, so that a ray that has just left the box, but for rounding, is still in one.
    means: Vec<f32>,
    majorants: Vec<f32>,
    residuals: Vec<Residual>,
    /// Which volumes may be in them, bit by bit; empty where there is only one.
    volumes: Vec<u32>,
    /// Largest extinction anywhere [1/m].
    pub most: f32,
}

impl Cells {
    /// So many along each axis, and `outside` around them. `survey` tells of each what is in it: a cell, and the volumes
    /// that may be there, which are remembered if there are `several`.
    pub fn new(dims: [u32; 3], outside: Cell, several: bool, survey: impl Fn([u32; 3]) -> (Cell, u32) + Sync) -> Self {
        let count = dims.iter().map(|dim| *dim as usize + 2).product();
        let volumes = vec![0; if several { count } else { 0 }];
        let mut found = Self {
            dims,
            means: vec![outside.mean; count],
            majorants: vec![outside.most; count],
            residuals: vec![outside.residual(); count],
            volumes,
            most: outside.most,
        };
        let places = (0..dims[2]).flat_map(|z| (0..dims[1]).flat_map(move |y| (0..dims[0]).map(move |x| [x, y, z])));
        let places: Vec<[u32; 3]> = places.collect();
        let surveyed: Vec<(Cell, u32)> = places.par_iter().map(|place| survey(*place)).collect();
        for (place, (cell, volumes)) in places.into_iter().zip(surveyed) {
            found.most = found.most.max(cell.most);
            let index = found.index(place);
            found.put(index, cell);
            if several {
                found.volumes[index] = volumes;
            }
        }
        found
    }

    /// The cells of a lone grid: cubes of 2^`log_side` voxels along each edge, with `unit` as the extinction of density 1
    /// [1/m].
    pub fn of_voxels(voxels: &Voxels, unit: f32, log_side: u32) -> Self {
        let survey = |place| (cell(voxels, unit, place, log_side), 1);
        Self::new(counts(&voxels.bricks, log_side), Cell::even(0.0), false, survey)
    }

    /// The edge of cells that is best for a lone grid, as a power of two in voxels.
    pub fn best_log_side(voxels: &Voxels, unit: f32) -> u32 {
        let coarse = Self::of_voxels(voxels, unit, SIDE.ilog2());
        if coarse.most == 0.0 {
            return SIDE.ilog2();
        }
        let thin = (THICKNESS / (coarse.most * voxels.edge() as f32)).log2().floor().max(0.0) as u32;
        let count = |log_side: &u32| -> u64 { counts(&voxels.bricks, *log_side).into_iter().map(u64::from).product() };
        let log_side = SIDES.filter(|log_side| *log_side >= thin && count(log_side) <= MOST_CELLS).min();
        log_side.unwrap_or(*SIDES.end())
    }

    /// From a cell to the next one along each axis, in any column.
    pub fn strides(&self) -> [i32; 3] {
        let [width, height, _] = self.dims.map(|dim| dim as i32 + 2);
        [1, width, width * height]
    }

    /// Where the cell at `place` is in any column.
    pub fn index(&self, place: [u32; 3]) -> usize {
        let strides = self.strides();
        (0..3).map(|axis| (place[axis] as usize + 1) * strides[axis] as usize).sum()
    }

    /// The cell at `place`, which is inside.
    pub fn at(&self, place: [u32; 3]) -> Cell {
        self.cell(self.index(place))
    }

    fn cell(&self, index: usize) -> Cell {
        let Residual { control, spread } = self.residuals[index];
        Cell { mean: self.means[index], most: self.majorants[index], control, spread }
    }

    fn put(&mut self, index: usize, cell: Cell) {
        (self.means[index], self.majorants[index]) = (cell.mean, cell.most);
        self.residuals[index] = cell.residual();
    }

    /// Means of all of them, and of those around.
    #[inline(always)]
    pub fn means(&self) -> &[f32] {
        &self.means
    }

    /// Their majorants of free flights.
    #[inline(always)]
    pub fn majorants(&self) -> &[f32] {
        &self.majorants
    }

    /// About what transmittances are estimated in them.
    #[inline(always)]
    pub fn residuals(&self) -> &[Residual] {
        &self.residuals
    }

    /// The volumes that may be in all of them; empty where there is only one.
    #[inline(always)]
    pub fn volumes(&self) -> &[u32] {
        &self.volumes
    }

    /// The same with all majorants multiplied by `factor` >= 1, and means by `mean`: what no image may depend on.
    pub fn distorted(mut self, factor: f32, mean: f32) -> Self {
        for index in 0..self.means.len() {
            self.put(index, self.cell(index).distorted(factor, mean));
        }
        self.most *= factor;
        self
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        let bounds = size_of_val(self.majorants.as_slice()) + size_of_val(self.residuals.as_slice());
        size_of_val(self.means.as_slice()) + bounds + size_of_val(self.volumes.as_slice())
    }
}

/// How many cells of 2^`log_side` voxels a grid has along each axis.
pub fn counts(bricks: &Bricks, log_side: u32) -> [u32; 3] {
    bricks.dims.map(|dim| (dim * SIDE).div_ceil(1 << log_side))
}

/// A cell from the voxels in it: those of one brick or a part of it, or of several bricks.
fn cell(voxels: &Voxels, unit: f32, place: [u32; 3], log_side: u32) -> Cell {
    let (bricks, smooth) = (&voxels.bricks, voxels.smooth());
    let edge = voxels.edge() as f32 * (1_u32 << log_side) as f32;
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
    let mean = (sum / f64::from(whole)) as f32;
    Cell::new([unit * least, unit * most], unit * mean, edge)
}
