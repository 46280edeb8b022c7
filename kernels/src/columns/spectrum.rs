//! A quantity of every path per channel.

use bumpalo::Bump;
use wide::f32x8;

use super::{Column, ColumnMut, ColumnRef, ColumnSet};
use crate::lanes::{self, LANES};

/// One column for every channel in use: a single one where everything is grey, red, green and blue otherwise.
pub struct Spectrum<'q> {
    channels: &'q mut [Column<'q, f32>],
}

impl<'q> Spectrum<'q> {
    /// Zeroed columns with room for at least `rows` rows.
    ///
    /// # Panics
    /// If there are neither 1 nor 3 channels.
    pub fn new_in(arena: &'q Bump, rows: usize, channels: usize) -> Self {
        assert!(channels == 1 || channels == 3, "{channels} channels; 1 or 3 are possible");
        Self { channels: arena.alloc_slice_fill_with(channels, |_| Column::new_in(arena, rows)) }
    }

    /// The columns in use, to read.
    #[inline(always)]
    pub fn channels(&self) -> &[Column<'q, f32>] {
        self.channels
    }

    /// The columns in use, to fill.
    #[inline(always)]
    pub fn channels_mut(&mut self) -> &mut [Column<'q, f32>] {
        self.channels
    }

    /// Whether row `row` is not 0 in every channel.
    #[inline(always)]
    pub fn any(&self, row: usize) -> bool {
        self.channels.iter().any(|channel| channel.rows()[row] != 0.0)
    }

    /// Rows of batch `b` that are not 0 in every channel, as bits.
    #[inline(always)]
    pub fn any_of_batch(&self, b: usize) -> u32 {
        let none = f32x8::ZERO;
        lanes::bits(self.channels.iter().fold(none, |any, channel| any | !channel.batch(b).simd_eq(none)))
    }

    /// Row `row`: red, green and blue, which are the same where one channel is in use.
    #[inline]
    pub fn row(&self, row: usize) -> [f32; 3] {
        match &*self.channels {
            [red, green, blue] => [red.rows()[row], green.rows()[row], blue.rows()[row]],
            channels => [channels[0].rows()[row]; 3],
        }
    }

    /// The rows of batch `b` set in `bits`, in one channel in use; 0 in the others.
    #[inline(always)]
    pub fn rows_of(&self, channel: usize, b: usize, bits: u32) -> [f32; LANES] {
        lanes::mask(bits).select(self.channels[channel].batch(b), f32x8::ZERO).to_array()
    }

    /// Overwrites row `row`, in the channels in use.
    pub fn set_row(&mut self, row: usize, value: [f32; 3]) {
        for (channel, value) in self.channels.iter_mut().zip(value) {
            channel.rows_mut()[row] = value;
        }
    }
}

impl ColumnSet for Spectrum<'_> {
    fn visit(&self, visit: &mut dyn FnMut(&'static str, ColumnRef<'_>)) {
        self.channels.iter().for_each(|channel| visit("channels", ColumnRef::F32(channel.rows())));
    }

    fn visit_mut(&mut self, visit: &mut dyn FnMut(&'static str, ColumnMut<'_>)) {
        self.channels.iter_mut().for_each(|channel| visit("channels", ColumnMut::F32(channel.rows_mut())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grey_spectrum_has_the_same_in_all_channels() {
        let arena = Bump::new();
        let [mut grey, mut coloured] = [1, 3].map(|channels| Spectrum::new_in(&arena, 8, channels));
        for spectrum in [&mut grey, &mut coloured] {
            spectrum.set_row(5, [0.5, 0.25, 2.0]);
        }
        assert_eq!((grey.row(5), coloured.row(5)), ([0.5; 3], [0.5, 0.25, 2.0]));
        assert_eq!((grey.channels().len(), coloured.channels().len()), (1, 3));
        coloured.set_row(2, [0.0, 0.0, -1.0]);
        coloured.set_row(7, [f32::NAN, 0.0, 0.0]);
        assert_eq!((grey.any_of_batch(0), coloured.any_of_batch(0)), (1 << 5, 1 << 5 | 1 << 2 | 1 << 7));
    }
}
