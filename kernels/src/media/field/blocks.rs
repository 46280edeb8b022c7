//! Bounds of extinctions, in blocks of 2^3 cells.
//!
//! Tracking crosses blocks and draws candidates by their bounds. It is faster in larger pieces than weights need means of:
//! a few candidates more cost less than eight times as many pieces, which no cache holds.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use wide::{f32x8, i32x8};

use super::bricks::Extent;
use super::cells::{Layout, Survey, place};
use super::cores::{Cores, Found};
use super::volume::Placed;
use crate::vec3::Vec3x8;

/// Cells along the edge of a block.
pub const EDGE: u32 = 2;

/// By how much bounds are widened: interpolation may round beyond the values at the corners.
const WIDER: f32 = 1.0 + 1e-5;

/// Optical depth by which the middle of a block may differ from its end at most if it is estimated about the mean. Each
/// such unit multiplies an estimate by up to two, and a few of them leave nothing but luck.
const UNEVEN: f32 = 1.0;

/// Bounds of the extinction in a block [1/m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// No extinction in it is larger: the majorant of free flights.
    pub most: f32,
    /// About what transmittances are estimated in it.
    pub residual: Residual,
}

/// About what transmittances are estimated in a block, and how far from it extinctions are [1/m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The mean, or in a block that is thick and uneven the extinction next to 0: the least, so that no estimate exceeds
    /// the transmittance of that, unless extinctions are negative, between channels.
    pub control: f32,
    /// No extinction is farther from `control`: the majorant of residuals. 0 where there is but one extinction.
    pub spread: f32,
}

impl Block {
    /// Of what extinctions range over, and of this `edge` `[m]`.
    fn new(Extent { least, most, mean }: Extent, edge: f32) -> Self {
        if least == most {
            return Self { most, residual: Residual { control: most, spread: 0.0 } };
        }
        let mean = mean.clamp(least, most);
        let spread = (most - mean).max(mean - least) * WIDER;
        if spread * edge <= UNEVEN {
            return Self { most: most * WIDER, residual: Residual { control: mean, spread } };
        }
        let control = 0.0_f32.clamp(least, most);
        let spread = (most - control).max(control - least) * WIDER;
        Self { most: most * WIDER, residual: Residual { control, spread } }
    }

    /// With the majorants multiplied by `factor` >= 1, and what is estimated about by `mean`.
    fn distorted(self, factor: f32, mean: f32) -> Self {
        let Residual { control, spread } = self.residual;
        let [low, high] = [control - spread, control + spread];
        let control = control * mean;
        let spread = (high - control).abs().max((control - low).abs()) * factor;
        Self { most: self.most * factor, residual: Residual { control, spread } }
    }
}

/// Bounds of all blocks, and behind them those of their `cores`: a column for each that is asked for by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Where the blocks are in the columns.
    pub layout: Layout,
    majorants: Vec<f32>,
    residuals: Vec<Residual>,
    /// Which volumes may be in them, bit by bit; empty where there is only one.
    volumes: Vec<u32>,
    /// Parts that are much denser than the rest of their blocks, if there are any.
    pub cores: Option<Cores>,
    /// Largest majorant of all [1/m].
    pub most: f32,
}

impl Blocks {
    /// Those of a survey; which volumes are where is remembered if there are `several`.
    pub fn new(survey: &Survey, several: bool) -> Self {
        let layout = Layout { dims: survey.dims.map(|dim| dim.div_ceil(EDGE)) };
        let count = layout.count();
        let outside = Extent { least: survey.outside, most: survey.outside, mean: survey.outside };
        let mut found: Vec<Option<(Extent, f32)>> = vec![None; count];
        let mut volumes = vec![0; if several { count } else { 0 }];
        for ((place, extent), present) in survey.places().zip(&survey.extents).zip(&survey.volumes) {
            let index = layout.index(place.map(|place| place / EDGE));
            found[index] = Some(with(found[index], *extent));
            if several {
                volumes[index] |= present;
            }
        }
        let block = |found: Option<(Extent, f32)>| Block::new(mean_of(found, outside), survey.edge * EDGE as f32);
        let blocks: Vec<Block> = found.into_iter().map(block).collect();
        Self::of(layout, &blocks, volumes, None)
    }

    /// The same with cores where they spare candidates, of several `volumes`; `from_cells` leads from cells, which are
    /// along the axes of the world, there.
    pub fn with_cores(self, survey: &Survey, volumes: &[Placed], from_cells: &DAffine3) -> Self {
        if self.volumes.is_empty() {
            return self;
        }
        let dims = self.layout.dims;
        let count = dims.iter().map(|dim| *dim as usize).product::<usize>();
        let found = (0..count).into_par_iter().filter_map(|number| {
            let place = place(dims, number);
            let index = self.layout.index(place);
            let corners = [0, 1].map(|end| DVec3::from(place.map(|along| f64::from((along + end) * EDGE))));
            let corners = corners.map(|corner| from_cells.transform_point3(corner));
            Some((index, Found::new(volumes, survey.outside, self.volumes[index], corners)?))
        });
        let found: Vec<(usize, Found)> = found.collect();
        let mut blocks: Vec<Block> = (0..self.majorants.len()).map(|index| self.block(index)).collect();
        let mut cores = Cores::none(blocks.len());
        let to_cells = from_cells.inverse();
        for (index, Found { corners: [low, high], inside, outside }) in found {
            cores.add(index, [low, high].map(|corner| to_cells.transform_point3(corner)), blocks.len());
            blocks.push(Block::new(inside, (high - low).max_element() as f32));
            blocks.push(Block::new(outside, survey.edge * EDGE as f32));
        }
        Self::of(self.layout, &blocks, self.volumes, Some(cores).filter(|cores| !cores.is_empty()))
    }

    fn of(layout: Layout, blocks: &[Block], volumes: Vec<u32>, cores: Option<Cores>) -> Self {
        let majorants: Vec<f32> = blocks.iter().map(|block| block.most).collect();
        let most = majorants.iter().copied().fold(0.0, f32::max);
        Self { layout, majorants, residuals: blocks.iter().map(|block| block.residual).collect(), volumes, cores, most }
    }

    /// The bounds in a row: those of a block, or inside or outside of a core.
    pub fn block(&self, index: usize) -> Block {
        Block { most: self.majorants[index], residual: self.residuals[index] }
    }

    /// Majorants of free flights in all blocks, and those around [1/m].
    #[inline(always)]
    pub fn majorants(&self) -> &[f32] {
        &self.majorants
    }

    /// About what transmittances are estimated in them.
    #[inline(always)]
    pub fn residuals(&self) -> &[Residual] {
        &self.residuals
    }

    /// The volumes that may be in them; empty where there is only one.
    #[inline(always)]
    pub fn volumes(&self) -> &[u32] {
        &self.volumes
    }

    /// Where the blocks are that points, in cells, are in; outside it is one of those around.
    #[inline(always)]
    pub fn indices(&self, at: Vec3x8) -> i32x8 {
        self.layout.indices(at * f32x8::splat(1.0 / EDGE as f32))
    }

    /// The same with all majorants multiplied by `factor` >= 1, and what is estimated about by `mean`: what no image may
    /// depend on.
    pub fn distorted(self, factor: f32, mean: f32) -> Self {
        let blocks: Vec<Block> =
            (0..self.majorants.len()).map(|index| self.block(index).distorted(factor, mean)).collect();
        Self::of(self.layout, &blocks, self.volumes, self.cores)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.majorants.as_slice())
            + size_of_val(self.residuals.as_slice())
            + size_of_val(self.volumes.as_slice())
            + self.cores.as_ref().map_or(0, Cores::bytes)
    }
}

/// What has been found in the cells of a block, with the sum of their means and how many they are, and that of one more.
fn with(found: Option<(Extent, f32)>, cell: Extent) -> (Extent, f32) {
    let Some((all, count)) = found else { return (cell, 1.0) };
    let (least, most) = (all.least.min(cell.least), all.most.max(cell.most));
    (Extent { least, most, mean: all.mean + cell.mean }, count + 1.0)
}

/// The same with the mean for the sum; what is `outside` where no cell is.
fn mean_of(found: Option<(Extent, f32)>, outside: Extent) -> Extent {
    found.map_or(outside, |(all, count)| Extent { mean: all.mean / count, ..all })
}
