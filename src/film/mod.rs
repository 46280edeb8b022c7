//! The film: per pixel and layer, exact sums of the samples' values and, for standard errors, of their squares.

pub mod aov;
mod coverage;
mod exact;
mod layer;
mod noise;
mod split;
mod sums;
#[cfg(test)]
mod tests;
mod tile;

use std::collections::TryReserveError;
use std::sync::{Mutex, MutexGuard};

use crate::frame::Frame;
pub use coverage::{Coverage, Gap, Part};
pub use exact::{ExactSquares, ExactSum, Unit};
pub use layer::{Kind, Layer, LayerForm, MOST_LAYERS, RADIANCE, layers};
pub(crate) use noise::{DARK, NOISIEST, dark, length};
pub use sums::Exact;
use sums::Sums;
pub use tile::{Region, Tile};

/// Side of a tile in pixels: a tile is what one worker fills at a time.
pub const TILE_SIZE: u32 = 32;

/// Smallest side of a tile: one that is worth a worker's while.
const SMALLEST_TILE: u32 = 8;

/// Tiles that an image should have, so that all workers have something to do.
const ENOUGH_TILES: usize = 32;

/// Side of the tiles for an image of `region`: smaller ones where the image is small.
pub fn tile_size(region: Region) -> u32 {
    let enough = |size: &u32| region.tiles(*size).count() >= ENOUGH_TILES;
    let sizes = core::iter::successors(Some(TILE_SIZE), |size| Some(size / 2)).take_while(|size| *size > SMALLEST_TILE);
    sizes.into_iter().find(enough).unwrap_or(SMALLEST_TILE)
}

/// About how many pixels a glimpse of the noise takes in.
const GLIMPSED: u64 = 1 << 15;

/// What is known of a pixel in one channel of a layer, in the unit of the layer's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean of its samples.
    pub mean: f64,
    /// Standard error of the mean; infinite if the layer keeps no squares.
    pub standard_error: f64,
}

/// The radiance of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Mean radiance, red, green, blue [W/(m^2 sr)].
    pub mean: [f64; 3],
    /// Standard error of the mean.
    pub standard_error: [f64; 3],
    /// Number of samples.
    pub samples: u64,
}

/// The sums of a region of the image, tile by tile.
#[derive(Debug)]
pub struct Film {
    region: Region,
    tile_size: u32,
    layers: Vec<Layer>,
    tiles: Vec<Mutex<Tile>>,
}

impl Film {
    /// An empty film for the radiance of `region` of the image of `frame`.
    ///
    /// # Panics
    /// If there is not enough memory; see [`Self::try_new`].
    pub fn new(frame: &Frame, region: Region, tile_size: u32) -> Self {
        Self::try_new(&layers(frame)[..=RADIANCE], region, tile_size).expect("memory for a film")
    }

    /// An empty film of `layers`, radiance first, for `region` of an image.
    ///
    /// # Errors
    /// If the system refuses the memory, [`Self::bytes`].
    pub fn try_new(layers: &[Layer], region: Region, tile_size: u32) -> Result<Self, TryReserveError> {
        let mut tiles = Vec::new();
        tiles.try_reserve_exact(region.tiles(tile_size).count())?;
        for region in region.tiles(tile_size) {
            tiles.push(Mutex::new(Tile::try_new(layers, region)?));
        }
        Ok(Self { region, tile_size, layers: layers.to_vec(), tiles })
    }

    /// Bytes that a film of `pixels` pixels takes.
    pub fn bytes(layers: &[Layer], pixels: u64) -> u64 {
        pixels * layers.iter().map(Sums::bytes).sum::<usize>() as u64
    }

    /// What it keeps.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The part of the image that it covers.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// Tile `index`, for one at a time: workers are at it while they add a block.
    pub fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        self.tiles[index].lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Adds the samples of another film of the same layers, region and tile size.
    ///
    /// # Panics
    /// If they differ.
    pub fn merge(&mut self, other: &Self) {
        let same_shape = (self.region, self.tile_size) == (other.region, other.tile_size);
        assert!(same_shape && self.layers == other.layers, "only films of the same shape can be merged");
        for index in 0..self.tiles.len() {
            self.tile(index).merge(&other.tile(index));
        }
    }

    /// Whether another film of the same layers, region and tile size has the same sums of as many samples.
    pub fn is_same(&self, other: &Self) -> bool {
        self.tiles.len() == other.tiles.len()
            && (0..self.tiles.len()).all(|index| *self.tile(index) == *other.tile(index))
    }

    /// The tile that covers pixel (x, y) of the whole image.
    fn tile_at(&self, x: u32, y: u32) -> MutexGuard<'_, Tile> {
        self.tile(self.region.tile_index(self.tile_size, x, y))
    }

    /// What is known of pixel (x, y) of the whole image in `channel` of the layer with index `layer`.
    ///
    /// # Panics
    /// If the film does not cover the pixel, or has no such layer.
    pub fn estimate(&self, layer: usize, channel: usize, x: u32, y: u32) -> Estimate {
        self.tile_at(x, y).estimate(layer, channel, x, y)
    }

    /// The radiance of pixel (x, y) of the whole image.
    ///
    /// # Panics
    /// If the film does not cover it.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        self.tile_at(x, y).pixel(x, y)
    }

    /// Samples of pixel (x, y) of the whole image.
    ///
    /// # Panics
    /// If the film does not cover it.
    pub fn samples_of(&self, x: u32, y: u32) -> u32 {
        self.tile_at(x, y).samples_of(x, y)
    }

    /// Whether no pixel has any light.
    pub fn is_black(&self) -> bool {
        self.pixels().all(|pixel| pixel.mean == [0.0; 3])
    }

    /// The radiance of all pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.region.rows().flat_map(move |y| self.region.columns().map(move |x| self.pixel(x, y)))
    }

    /// The sums of pixel (x, y) of the whole image in `channel`, one that is kept, of the layer with index `layer`.
    ///
    /// # Panics
    /// If the film does not cover the pixel, or has no such channel.
    pub fn exact(&self, layer: usize, channel: usize, x: u32, y: u32) -> Exact {
        self.tile_at(x, y).exact(layer, channel, x, y)
    }

    /// Adds to these sums those of other samples, which [`Self::count`] is still to count.
    ///
    /// # Panics
    /// If the film does not cover the pixel, or has no such channel.
    pub fn add_exact(&self, layer: usize, channel: usize, x: u32, y: u32, exact: &Exact) {
        self.tile_at(x, y).add_exact(layer, channel, x, y, exact);
    }

    /// Notes that all pixels within `region` have had `samples` more samples.
    pub fn count(&self, region: Region, samples: u32) {
        self.each_tile().for_each(|mut tile| tile.count_within(region, samples));
    }

    fn each_tile(&self) -> impl Iterator<Item = MutexGuard<'_, Tile>> {
        (0..self.tiles.len()).map(|index| self.tile(index))
    }

    /// Samples of all pixels together.
    pub fn samples(&self) -> u64 {
        self.each_tile().map(|tile| tile.all_samples()).sum()
    }

    /// Samples of the pixel that has most.
    pub fn most_samples(&self) -> u32 {
        self.each_tile().map(|tile| tile.most_samples()).max().unwrap_or(0)
    }

    /// Samples that every pixel has.
    pub fn fewest_samples(&self) -> u32 {
        self.each_tile().map(|tile| tile.samples()).min().unwrap_or(0)
    }

    /// Samples that all pixels of a tile have, tile by tile.
    pub fn samples_of_tiles(&self) -> Vec<u32> {
        self.each_tile().map(|tile| tile.samples()).collect()
    }

    /// Which samples it has, those of the pixels of a tile beginning with the number that is in `firsts`.
    pub fn coverage(&self, firsts: &[u32]) -> Coverage {
        let part = |(tile, first): (MutexGuard<'_, Tile>, &u32)| Part {
            region: tile.region(),
            samples: *first..first + tile.samples(),
        };
        Coverage::of(self.each_tile().zip(firsts).map(part).collect())
    }

    /// [`Self::relative_noise`] by some of the pixels.
    pub fn glimpsed_noise(&self) -> f64 {
        let step = (self.region.pixels() / GLIMPSED).max(1) as usize;
        let some = |tile: MutexGuard<'_, Tile>| {
            let region = tile.region();
            let pixels = region.rows().flat_map(|y| region.columns().map(move |x| (x, y)));
            pixels.step_by(step).map(|(x, y)| tile.pixel(x, y)).collect::<Vec<_>>()
        };
        noise::relative(self.each_tile().flat_map(some))
    }

    /// Root mean square of the pixels' relative standard errors of radiance, without the noisiest hundredth of them;
    /// infinite if there is no error yet, as with one sample per pixel, or nothing but black. Dark pixels count as a
    /// tenth of the median.
    pub fn relative_noise(&self) -> f64 {
        noise::relative(self.pixels())
    }

    /// Mean radiance of the image per channel, and its standard error, from the pixels' errors [W/(m^2 sr)].
    pub fn mean(&self) -> ([f64; 3], [f64; 3]) {
        let (mut sum, mut variance) = ([0.0; 3], [0.0; 3]);
        for pixel in self.pixels() {
            for channel in 0..3 {
                sum[channel] += pixel.mean[channel];
                variance[channel] += pixel.standard_error[channel].powi(2);
            }
        }
        let count = self.region.pixels() as f64;
        (sum.map(|sum| sum / count), variance.map(|variance| variance.sqrt() / count))
    }
}
