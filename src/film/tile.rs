//! Rectangles of pixels, and the sums of one of them.

use core::ops::Range;
use std::collections::TryReserveError;

use super::{ExactSum, Pixel, Unit};

/// A rectangle of pixels: columns `x0 .. x1`, rows `y0 .. y1` of the whole image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl Region {
    /// A whole image of `width` x `height` pixels.
    pub fn whole(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Its columns.
    pub fn columns(self) -> Range<u32> {
        self.x0..self.x1
    }

    /// Its rows.
    pub fn rows(self) -> Range<u32> {
        self.y0..self.y1
    }

    /// Its width in pixels.
    pub fn width(self) -> u32 {
        self.x1 - self.x0
    }

    /// Its height in pixels.
    pub fn height(self) -> u32 {
        self.y1 - self.y0
    }

    /// Number of pixels.
    pub fn pixels(self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Place of pixel (x, y) in the region, row-major.
    pub fn place(self, x: u32, y: u32) -> usize {
        (y - self.y0) as usize * self.width() as usize + (x - self.x0) as usize
    }

    /// The region cut into tiles of at most `size` x `size` pixels, row by row.
    pub fn tiles(self, size: u32) -> impl Iterator<Item = Region> {
        let cut = move |range: Range<u32>| range.clone().step_by(size as usize).map(move |start| (start, range.end));
        cut(self.rows()).flat_map(move |(y0, bottom)| {
            cut(self.columns()).map(move |(x0, right)| Region {
                x0,
                y0,
                x1: right.min(x0 + size),
                y1: bottom.min(y0 + size),
            })
        })
    }

    /// Index, in [`Self::tiles`], of the tile that covers pixel (x, y).
    pub fn tile_index(self, size: u32, x: u32, y: u32) -> usize {
        let across = self.width().div_ceil(size);
        ((y - self.y0) / size * across + (x - self.x0) / size) as usize
    }
}

/// The sums of the pixels of one tile; all have the same number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    region: Region,
    channels: usize,
    unit: Unit,
    samples: u32,
    sums: Vec<ExactSum>,
}

impl Tile {
    /// An empty tile of 1 (grey) or 3 channels.
    ///
    /// # Panics
    /// If there is not enough memory; see [`Self::try_new`].
    pub fn new(region: Region, channels: usize, unit: Unit) -> Self {
        Self::try_new(region, channels, unit).expect("memory for a tile")
    }

    /// An empty tile of 1 (grey) or 3 channels.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub fn try_new(region: Region, channels: usize, unit: Unit) -> Result<Self, TryReserveError> {
        let count = region.pixels() as usize * channels;
        let mut sums = Vec::new();
        sums.try_reserve_exact(count)?;
        sums.resize(count, ExactSum::default());
        Ok(Self { region, channels, unit, samples: 0, sums })
    }

    /// The pixels it covers.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Samples of each pixel.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds the radiance of one sample to the pixel at `place`, in the channels in use.
    #[inline]
    pub fn add(&mut self, place: usize, radiance: [f32; 3]) {
        let sums = &mut self.sums[place * self.channels..][..self.channels];
        for (sum, radiance) in sums.iter_mut().zip(radiance) {
            if radiance != 0.0 {
                sum.add(self.unit, radiance);
            }
        }
    }

    /// Notes that every pixel has had `samples` more samples.
    pub fn count(&mut self, samples: u32) {
        self.samples += samples;
    }

    /// Adds the samples of another tile of the same region.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.sums.iter_mut().zip(&other.sums).for_each(|(sum, other)| sum.merge(other));
    }

    /// What is known of pixel (x, y) of the whole image.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        let samples = u64::from(self.samples);
        let sums = &self.sums[self.region.place(x, y) * self.channels..][..self.channels];
        let channel = |c: usize| &sums[c.min(self.channels - 1)];
        Pixel {
            mean: [0, 1, 2].map(|c| channel(c).mean(self.unit, samples)),
            standard_error: [0, 1, 2].map(|c| channel(c).standard_error(self.unit, samples)),
            samples,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_region_once() {
        let region = Region { x0: 3, y0: 5, x1: 70, y1: 40 };
        let tiles: Vec<_> = region.tiles(32).collect();
        assert_eq!(tiles.iter().map(|tile| tile.pixels()).sum::<u64>(), region.pixels());
        for y in region.rows() {
            for x in region.columns() {
                let tile = tiles[region.tile_index(32, x, y)];
                assert!(tile.columns().contains(&x) && tile.rows().contains(&y), "({x}, {y})");
            }
        }
    }
}
