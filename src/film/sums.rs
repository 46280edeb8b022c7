//! The sums of one layer of a tile.

use std::collections::TryReserveError;

use super::{Estimate, ExactSquares, ExactSum, Kind, Layer};

/// The sums of one channel of a pixel; no squares where the layer keeps none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exact {
    /// Sum of the samples' values.
    pub sum: ExactSum,
    /// Sum of their squares.
    pub squares: ExactSquares,
}

/// Sums of all channels of a layer, pixel by pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    layer: Layer,
    values: Vec<ExactSum>,
    /// Empty if the layer keeps none.
    squares: Vec<ExactSquares>,
}

impl Sums {
    /// No samples yet.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub fn try_new(layer: Layer, pixels: usize) -> Result<Self, TryReserveError> {
        let count = pixels * layer.channels;
        Ok(Self { layer, values: zeros(count)?, squares: zeros(if layer.squares { count } else { 0 })? })
    }

    /// Bytes that a pixel takes.
    pub fn bytes(layer: &Layer) -> usize {
        layer.channels * (size_of::<ExactSum>() + if layer.squares { size_of::<ExactSquares>() } else { 0 })
    }

    /// Adds a sample to the pixel at `place`.
    ///
    /// # Panics
    /// If there are fewer values than channels.
    #[inline]
    pub fn add(&mut self, place: usize, values: &[f32]) {
        let Layer { channels, unit, kind, .. } = self.layer;
        let offset = kind.offset();
        for (index, value) in (place * channels..).zip(&values[..channels]) {
            let value = value + offset;
            if value != 0.0 {
                self.values[index].add(unit, value);
                if let Some(squares) = self.squares.get_mut(index) {
                    squares.add(unit, value);
                }
            }
        }
    }

    /// Adds samples to `channel` of the pixel at `place`, in a layer whose values are >= 0.
    #[inline]
    pub fn add_samples(&mut self, place: usize, channel: usize, values: &[f32]) {
        let Layer { channels, unit, .. } = self.layer;
        let index = place * channels + channel;
        self.values[index].add_units(values.iter().map(|value| unit.units(*value)).fold(0, u128::saturating_add));
        if let Some(squares) = self.squares.get_mut(index) {
            squares.add_units(values.iter().map(|value| unit.square_units(*value)).fold(0, u128::saturating_add));
        }
    }

    /// Adds units of a sample to `channel` of the pixel at `place`, in a layer without squares.
    pub fn add_units(&mut self, place: usize, channel: usize, units: u128) {
        self.values[place * self.layer.channels + channel].add_units(units);
    }

    /// What it is the sums of.
    pub fn layer(&self) -> &Layer {
        &self.layer
    }

    /// Adds the samples of the same layer of another tile.
    pub fn merge(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(sum, other)| sum.merge(other));
        self.squares.iter_mut().zip(&other.squares).for_each(|(sum, other)| sum.merge(other));
    }

    /// The sums of `channel`, one that is kept, of the pixel at `place`.
    pub fn exact(&self, place: usize, channel: usize) -> Exact {
        let index = place * self.layer.channels + channel;
        Exact { sum: self.values[index], squares: self.squares.get(index).copied().unwrap_or_default() }
    }

    /// Adds the sums of other samples to those of `channel` of the pixel at `place`.
    pub fn add_exact(&mut self, place: usize, channel: usize, exact: &Exact) {
        let index = place * self.layer.channels + channel;
        self.values[index].merge(&exact.sum);
        if let Some(squares) = self.squares.get_mut(index) {
            squares.merge(&exact.squares);
        }
    }

    /// Appends all sums to `bytes`: limbs, little-endian.
    pub fn write(&self, bytes: &mut Vec<u8>) {
        self.values.iter().for_each(|sum| bytes.extend(sum.limbs().map(u32::to_le_bytes).as_flattened()));
        self.squares.iter().for_each(|squares| bytes.extend(squares.limbs().map(u32::to_le_bytes).as_flattened()));
    }

    /// Takes what [`Self::write`] wrote for the same layer and as many pixels from the front of `bytes`, in the place
    /// of what is there; none if there is not enough.
    #[must_use]
    pub fn read(&mut self, bytes: &mut &[u8]) -> Option<()> {
        for sum in &mut self.values {
            *sum = ExactSum::from_limbs(limbs(bytes)?);
        }
        for squares in &mut self.squares {
            *squares = ExactSquares::from_limbs(limbs(bytes)?);
        }
        Some(())
    }

    /// What is known of `channel` of the pixel at `place` after so many samples; channels after the last are like the
    /// last. Squares are kept of plain means alone.
    pub fn estimate(&self, place: usize, channel: usize, samples: u32) -> Estimate {
        let Layer { channels, unit, kind, .. } = self.layer;
        let (channel, last) = (channel.min(channels - 1), channels - 1);
        let index = place * channels + channel;
        let mut mean = self.values[index].mean(unit, samples.into());
        if samples > 0 {
            mean -= f64::from(kind.offset());
        }
        if kind == Kind::OfSome && channel < last && mean > 0.0 {
            mean /= self.values[place * channels + last].mean(unit, samples.into());
        }
        let squares = self.squares.get(index);
        let standard_error = squares.map(|squares| squares.standard_error(unit, mean, samples.into()));
        Estimate { mean, standard_error: standard_error.unwrap_or(f64::INFINITY) }
    }
}

/// Numbers from the front of `bytes`.
fn limbs<const N: usize>(bytes: &mut &[u8]) -> Option<[u32; N]> {
    let mut limbs = [0; N];
    for limb in &mut limbs {
        let (first, rest) = bytes.split_first_chunk()?;
        (*limb, *bytes) = (u32::from_le_bytes(*first), rest);
    }
    Some(limbs)
}

/// So many zeros.
fn zeros<T: Clone + Default>(count: usize) -> Result<Vec<T>, TryReserveError> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(count)?;
    zeros.resize(count, T::default());
    Ok(zeros)
}
