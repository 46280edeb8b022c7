//! The film: per pixel, exact sums of the samples' radiances and of their squares.

mod exact;
mod noise;
mod tile;

use std::collections::TryReserveError;
use std::sync::{Mutex, MutexGuard};

use crate::frame::Frame;
pub use exact::{ExactSum, Unit};
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

/// What is known of a pixel.
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
    channels: usize,
    unit: Unit,
    tiles: Vec<Mutex<Tile>>,
}

impl Film {
    /// An empty film for `region` of the image of `frame`.
    ///
    /// # Panics
    /// If there is not enough memory; see [`Self::try_new`].
    pub fn new(frame: &Frame, region: Region, tile_size: u32) -> Self {
        Self::try_new(frame, region, tile_size).expect("memory for a film")
    }

    /// An empty film for `region` of the image of `frame`.
    ///
    /// # Errors
    /// If the system refuses the memory, [`Self::bytes`].
    pub fn try_new(frame: &Frame, region: Region, tile_size: u32) -> Result<Self, TryReserveError> {
        let unit = Unit::for_radiance(frame.lights.largest_radiance());
        let channels = frame.channels();
        let mut tiles = Vec::new();
        tiles.try_reserve_exact(region.tiles(tile_size).count())?;
        for region in region.tiles(tile_size) {
            tiles.push(Mutex::new(Tile::try_new(region, channels, unit)?));
        }
        Ok(Self { region, tile_size, channels, unit, tiles })
    }

    /// Bytes that a film of `pixels` pixels takes.
    pub fn bytes(frame: &Frame, pixels: u64) -> u64 {
        pixels * frame.channels() as u64 * size_of::<ExactSum>() as u64
    }

    /// The part of the image that it covers.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// Tile `index`, for one worker at a time.
    pub fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        self.tiles[index].lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Adds the samples of another film of the same frame, region and tile size.
    ///
    /// # Panics
    /// If they differ.
    pub fn merge(&mut self, other: &Self) {
        let shape = |film: &Self| (film.region, film.tile_size, film.channels, film.unit);
        assert_eq!(shape(self), shape(other), "only films of the same shape can be merged");
        for index in 0..self.tiles.len() {
            self.tile(index).merge(&other.tile(index));
        }
    }

    /// The pixel at (x, y) of the whole image.
    ///
    /// # Panics
    /// If the film does not cover it.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        self.tile(self.region.tile_index(self.tile_size, x, y)).pixel(x, y)
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.region.rows().flat_map(move |y| self.region.columns().map(move |x| self.pixel(x, y)))
    }

    /// Samples of all pixels together.
    pub fn samples(&self) -> u64 {
        (0..self.tiles.len())
            .map(|index| {
                let tile = self.tile(index);
                u64::from(tile.samples()) * tile.region().pixels()
            })
            .sum()
    }

    /// Samples of the pixel that has most.
    pub fn most_samples(&self) -> u32 {
        (0..self.tiles.len()).map(|index| self.tile(index).samples()).max().unwrap_or(0)
    }

    /// Root mean square of the pixels' relative standard errors, without the noisiest hundredth of them; infinite if there is
    /// no error yet, as with one sample per pixel, or nothing but black. Dark pixels count as a tenth of the median.
    pub fn relative_noise(&self) -> f64 {
        noise::relative(self.pixels())
    }

    /// Mean of the image per channel, and its standard error, from the pixels' errors.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_images_have_tiles_for_several_workers() {
        let tiles = |width: u32, height: u32| {
            let region = Region::whole(width, height);
            (tile_size(region), region.tiles(tile_size(region)).count())
        };
        assert_eq!(tiles(1920, 1080), (32, 2040));
        assert_eq!(tiles(100, 100), (16, 49));
        assert_eq!(tiles(32, 32), (8, 16));
        assert_eq!(tiles(1, 1), (8, 1));
    }
}
