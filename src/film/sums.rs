//! The sums of one layer of a tile.

use std::collections::TryReserveError;

use super::{Estimate, ExactSquares, ExactSum, Layer};

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
        let Layer { channels, unit, .. } = self.layer;
        for (index, value) in (place * channels..).zip(&values[..channels]) {
            if *value != 0.0 {
                self.values[index].add(unit, *value);
                if let Some(squares) = self.squares.get_mut(index) {
                    squares.add(unit, *value);
                }
            }
        }
    }

    /// Adds the samples of the same layer of another tile.
    pub fn merge(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(sum, other)| sum.merge(other));
        self.squares.iter_mut().zip(&other.squares).for_each(|(sum, other)| sum.merge(other));
    }

    /// What is known of `channel` of the pixel at `place` after so many samples; channels after the last are like the
    /// last.
    pub fn estimate(&self, place: usize, channel: usize, samples: u32) -> Estimate {
        let Layer { channels, unit, .. } = self.layer;
        let index = place * channels + channel.min(channels - 1);
        let mean = self.values[index].mean(unit, samples.into());
        let squares = self.squares.get(index);
        let standard_error = squares.map(|squares| squares.standard_error(unit, mean, samples.into()));
        Estimate { mean, standard_error: standard_error.unwrap_or(f64::INFINITY) }
    }
}

/// So many zeros.
fn zeros<T: Clone + Default>(count: usize) -> Result<Vec<T>, TryReserveError> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(count)?;
    zeros.resize(count, T::default());
    Ok(zeros)
}
