//! Rectangles of pixels, and the sums of one of them, layer by layer.

use core::ops::Range;
use std::collections::TryReserveError;

use super::sums::Sums;
use super::{Estimate, Exact, Kind, Layer, Pixel, RADIANCE, split};
use crate::error::{Error, Result};

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

    /// What `--crop x0,y0,x1,y1` leaves of an image of `width` x `height` pixels.
    ///
    /// # Errors
    /// If that is nothing, or not within the image.
    pub fn cropped([x0, y0, x1, y1]: [u32; 4], [width, height]: [u32; 2]) -> Result<Self> {
        if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height {
            return Ok(Self { x0, y0, x1, y1 });
        }
        let finding = format!("the window is empty or reaches outside the image of {width}x{height} pixels");
        let remedy = "give X0,Y0,X1,Y1 with 0 <= X0 < X1 <= width and 0 <= Y0 < Y1 <= height";
        Err(Error::usage(format!("--crop {x0},{y0},{x1},{y1}"), finding, remedy))
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

    /// The pixels of both; none if there are none.
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        let (x1, y1) = (self.x1.min(other.x1), self.y1.min(other.y1));
        (x0 < x1 && y0 < y1).then_some(Self { x0, y0, x1, y1 })
    }

    /// The smallest rectangle that covers both.
    pub fn hull(self, other: Self) -> Self {
        let (x0, y0) = (self.x0.min(other.x0), self.y0.min(other.y0));
        Self { x0, y0, x1: self.x1.max(other.x1), y1: self.y1.max(other.y1) }
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

/// The sums of the pixels of one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    region: Region,
    /// Samples of every pixel.
    samples: u32,
    /// Further samples of single pixels, as merged parts of an image have them; empty if there are none.
    more: Vec<u32>,
    layers: Vec<Sums>,
    /// Layers of every split of the radiance.
    splits: Vec<Range<usize>>,
}

impl Tile {
    /// An empty tile of `layers`.
    ///
    /// # Panics
    /// If there is not enough memory; see [`Self::try_new`].
    pub fn new(layers: &[Layer], region: Region) -> Self {
        Self::try_new(layers, region).expect("memory for a tile")
    }

    /// An empty tile of `layers`.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub fn try_new(layers: &[Layer], region: Region) -> core::result::Result<Self, TryReserveError> {
        let mut sums = Vec::new();
        sums.try_reserve_exact(layers.len())?;
        for layer in layers {
            sums.push(Sums::try_new(*layer, region.pixels() as usize)?);
        }
        Ok(Self { region, samples: 0, more: Vec::new(), layers: sums, splits: splits(layers) })
    }

    /// The pixels it covers.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Samples that every pixel has.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Samples of the pixel at `place`.
    fn samples_at(&self, place: usize) -> u32 {
        self.samples + self.more.get(place).copied().unwrap_or(0)
    }

    /// Samples of the pixel that has most.
    pub fn most_samples(&self) -> u32 {
        self.samples + self.more.iter().copied().max().unwrap_or(0)
    }

    /// Samples of all pixels together.
    pub fn all_samples(&self) -> u64 {
        let more = self.more.iter().copied().map(u64::from).sum::<u64>();
        u64::from(self.samples) * self.region.pixels() + more
    }

    /// Adds one sample to the pixel at `place`: for each layer, in the order of the film, the values of its channels,
    /// finite and >= 0. What is there beyond the tile's layers and channels is not kept.
    ///
    /// # Panics
    /// If values are missing.
    #[inline]
    pub fn add(&mut self, place: usize, values: &[impl AsRef<[f32]>]) {
        let values = &values[..self.layers.len()];
        let whole = self.splits.first().map_or(self.layers.len(), |split| split.start);
        self.layers[..whole].iter_mut().zip(values).for_each(|(sums, values)| sums.add(place, values.as_ref()));
        for split in &self.splits {
            split::add(&mut self.layers[split.clone()], place, values[RADIANCE].as_ref(), &values[split.clone()]);
        }
    }

    /// Adds some samples to the pixel at `place` of a tile that has no layer but radiance: `values` gives those of a
    /// channel, finite and >= 0.
    #[inline]
    pub fn add_radiance<const N: usize>(&mut self, place: usize, values: impl Fn(usize) -> [f32; N]) {
        let radiance = &mut self.layers[RADIANCE];
        (0..radiance.layer().channels).for_each(|channel| radiance.add_samples(place, channel, &values(channel)));
    }

    /// Notes that every pixel has had `samples` more samples.
    pub fn count(&mut self, samples: u32) {
        self.samples += samples;
    }

    /// Notes that the pixels within `region` have had `samples` more samples.
    pub fn count_within(&mut self, region: Region, samples: u32) {
        let Some(part) = self.region.intersection(region) else { return };
        if part == self.region {
            return self.count(samples);
        }
        self.more.resize(self.region.pixels() as usize, 0);
        for (y, x) in part.rows().flat_map(|y| part.columns().map(move |x| (y, x))) {
            self.more[self.region.place(x, y)] += samples;
        }
    }

    /// Adds the samples of another tile of the same layers and region.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        if !other.more.is_empty() {
            self.more.resize(other.more.len(), 0);
            self.more.iter_mut().zip(&other.more).for_each(|(more, other)| *more += other);
        }
        self.layers.iter_mut().zip(&other.layers).for_each(|(sums, other)| sums.merge(other));
    }

    /// What is known of pixel (x, y) of the whole image in `channel` of the layer with index `layer`.
    pub fn estimate(&self, layer: usize, channel: usize, x: u32, y: u32) -> Estimate {
        let place = self.region.place(x, y);
        self.layers[layer].estimate(place, channel, self.samples_at(place))
    }

    /// The sums of pixel (x, y) of the whole image in `channel`, one that is kept, of the layer with index `layer`.
    pub fn exact(&self, layer: usize, channel: usize, x: u32, y: u32) -> Exact {
        self.layers[layer].exact(self.region.place(x, y), channel)
    }

    /// Adds to these sums those of other samples, which are still to be counted.
    pub fn add_exact(&mut self, layer: usize, channel: usize, x: u32, y: u32, exact: &Exact) {
        self.layers[layer].add_exact(self.region.place(x, y), channel, exact);
    }

    /// Appends the number of samples and all sums to `bytes`.
    ///
    /// # Panics
    /// If not all pixels have as many samples.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        assert!(self.more.is_empty(), "a render gives all pixels of a tile as many samples");
        bytes.extend(self.samples.to_le_bytes());
        self.layers.iter().for_each(|sums| sums.write(bytes));
    }

    /// Takes what [`Self::write`] wrote for the same layers and region from `bytes`, in the place of what is there;
    /// none if it is too short or too long.
    #[must_use]
    pub fn read(&mut self, mut bytes: &[u8]) -> Option<()> {
        let samples = bytes.split_off(..size_of::<u32>())?;
        self.samples = u32::from_le_bytes(samples.try_into().ok()?);
        self.layers.iter_mut().try_for_each(|sums| sums.read(&mut bytes))?;
        bytes.is_empty().then_some(())
    }

    /// Bytes that [`Self::write`] appends for a tile of so many pixels.
    pub fn bytes(layers: &[Layer], pixels: u64) -> u64 {
        size_of::<u32>() as u64 + pixels * layers.iter().map(Sums::bytes).sum::<usize>() as u64
    }

    /// Samples of pixel (x, y) of the whole image.
    pub fn samples_of(&self, x: u32, y: u32) -> u32 {
        self.samples_at(self.region.place(x, y))
    }

    /// The radiance of pixel (x, y) of the whole image.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        let rgb = [0, 1, 2].map(|channel| self.estimate(RADIANCE, channel, x, y));
        Pixel {
            mean: rgb.map(|channel| channel.mean),
            standard_error: rgb.map(|channel| channel.standard_error),
            samples: self.samples_at(self.region.place(x, y)).into(),
        }
    }
}

/// Where the layers of every split of the radiance are, which come after all others.
fn splits(layers: &[Layer]) -> Vec<Range<usize>> {
    let split = |layer: &Layer| if let Kind::Part(split) = layer.kind { Some(split) } else { None };
    let mut start = 0;
    let runs = layers.chunk_by(|a, b| split(a) == split(b)).map(|run| {
        start += run.len();
        start - run.len()..start
    });
    runs.filter(|run| split(&layers[run.start]).is_some()).collect()
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
