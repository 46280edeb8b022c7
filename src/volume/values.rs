//! The values of a node: numbers in a row, some of which may be left out.

use half::f16;

use super::chunks::{Chunks, Packing};
use super::input::{DAMAGED, Input};
use crate::gltf::fault::{Checked, Fault};

/// Bytes of the largest chunk: the values of a node of 32^3.
const LARGEST: usize = 4 << 15;

/// Reads the values of nodes of one grid, whose background is 0.
pub struct Values {
    is_masked: bool,
    is_half: bool,
    chunks: Chunks,
    bytes: Vec<u8>,
}

/// Which value the inactive ones have that are left out: the first, or the second where the mask says so.
struct Inactive {
    values: [f32; 2],
    has_mask: bool,
}

impl Values {
    /// A reader of values that are packed like this, and saved as half floats or not.
    pub fn new(packing: Packing, is_half: bool) -> Self {
        let bytes = Vec::with_capacity(LARGEST);
        Self { is_masked: packing.is_masked, is_half, chunks: Chunks::new(packing.codec), bytes }
    }

    /// Fills `values` with those of the next node, of which the bits of `active` are set.
    pub fn read(&mut self, input: &mut Input, active: &[u64], values: &mut [f32]) -> Checked<()> {
        let inactive = Inactive::read(input)?;
        let Some(inactive) = inactive.filter(|_| self.is_masked) else {
            return self.all(input, values);
        };
        let mut second = [0; 512];
        let second = &mut second[..active.len()];
        if inactive.has_mask {
            input.mask(second)?;
        }
        let count = active.iter().map(|word| word.count_ones() as usize).sum();
        self.all(input, &mut values[..count])?;
        spread(active, count, values);
        for (index, value) in values.iter_mut().enumerate().filter(|(index, _)| !bit(active, *index)) {
            *value = inactive.values[usize::from(bit(second, index))];
        }
        Ok(())
    }

    /// Fills `values` with the next chunk.
    fn all(&mut self, input: &mut Input, values: &mut [f32]) -> Checked<()> {
        // No values are no chunk for half floats, and a chunk without content for others.
        if self.is_half && values.is_empty() {
            return Ok(());
        }
        self.bytes.resize(values.len() * if self.is_half { 2 } else { 4 }, 0);
        self.chunks.read(input, &mut self.bytes)?;
        if self.is_half {
            let halves = self.bytes.as_chunks().0.iter();
            values.iter_mut().zip(halves).for_each(|(value, bytes)| *value = f16::from_le_bytes(*bytes).to_f32());
        } else {
            let floats = self.bytes.as_chunks().0.iter();
            values.iter_mut().zip(floats).for_each(|(value, bytes)| *value = f32::from_le_bytes(*bytes));
        }
        Ok(())
    }
}

impl Inactive {
    /// Reads what a node says of its inactive values; none if all are there.
    fn read(input: &mut Input) -> Checked<Option<Self>> {
        // The background is 0, and so is its negative.
        let (given, has_mask) = match input.u8()? {
            0 | 1 => (0, false),
            2 => (1, false),
            3 => (0, true),
            4 => (1, true),
            5 => (2, true),
            6 => return Ok(None),
            other => return Err(Fault::new(format!("has a node of the unknown kind {other}"), DAMAGED)),
        };
        let mut values = [0.0; 2];
        values.iter_mut().take(given).try_for_each(|value| {
            *value = input.f32()?;
            Ok(())
        })?;
        Ok(Some(Self { values, has_mask }))
    }
}

/// Moves the first `count` values to the places whose bits are set, in order.
fn spread(active: &[u64], mut count: usize, values: &mut [f32]) {
    for index in (0..values.len()).rev().filter(|index| bit(active, *index)) {
        count -= 1;
        values[index] = values[count];
    }
}

/// Whether bit `index` of a mask is set.
pub fn bit(mask: &[u64], index: usize) -> bool {
    mask[index / 64] >> (index % 64) & 1 != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_to_the_places_of_set_bits() {
        let mut values = [1.0, 2.0, 3.0, 9.0, 9.0, 9.0];
        spread(&[0b11_0010], 3, &mut values);
        assert_eq!([values[1], values[4], values[5]], [1.0, 2.0, 3.0]);
    }
}
