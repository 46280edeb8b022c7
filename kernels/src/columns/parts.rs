//! The radiance of every path once more, by what made it and by how long it is: for layers of the film beside radiance.

use bumpalo::Bump;

use super::{ColumnMut, ColumnRef, ColumnSet, Spectrum};
use crate::lanes::LaneSet;

/// Classes of path lengths: 1, 2, 3 to 4, 5 to 8 segments, and 9 or more.
pub const LENGTH_CLASSES: usize = 5;

/// The class of paths of so many `segments`, >= 1: every class but the last ends at a power of two.
#[inline(always)]
pub fn length_class(segments: u32) -> usize {
    let doublings = u32::BITS - (segments - 1).leading_zeros();
    (doublings as usize).min(LENGTH_CLASSES - 1)
}

/// Parts of the radiance of every path, in channels in use [W/(m^2 sr)]. Either list is empty where nothing asks for
/// it; the parts of a list add up to the radiance, but for rounding.
pub struct PartTable<'q> {
    /// One for every origin of light: what made its paths.
    pub origins: &'q mut [Spectrum<'q>],
    /// One for every [class](length_class) of lengths.
    pub lengths: &'q mut [Spectrum<'q>],
}

impl<'q> PartTable<'q> {
    /// Zeroed columns for so many origins, and for lengths if they are asked for.
    pub fn new_in(arena: &'q Bump, rows: usize, channels: usize, origins: usize, has_lengths: bool) -> Self {
        let lengths = if has_lengths { LENGTH_CLASSES } else { 0 };
        let spectra = |count: usize| arena.alloc_slice_fill_with(count, |_| Spectrum::new_in(arena, rows, channels));
        Self { origins: spectra(origins), lengths: spectra(lengths) }
    }

    /// Whether nothing asks for parts.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty() && self.lengths.is_empty()
    }

    /// The two parts that light of this origin on paths of so many segments belongs to, as far as they are asked for.
    #[inline(always)]
    pub fn of(&mut self, origin: usize, segments: u32) -> impl Iterator<Item = &mut Spectrum<'q>> {
        let length = self.lengths.get_mut(length_class(segments));
        self.origins.get_mut(origin).into_iter().chain(length)
    }

    /// Sets the parts of these lanes to 0.
    pub fn clear(&mut self, lanes: &LaneSet<'_>) {
        for part in self.origins.iter_mut().chain(self.lengths.iter_mut()) {
            lanes.each().for_each(|lane| part.set_row(lane, [0.0; 3]));
        }
    }
}

impl ColumnSet for PartTable<'_> {
    fn visit(&self, visit: &mut dyn FnMut(&'static str, ColumnRef<'_>)) {
        self.origins.iter().chain(self.lengths.iter()).for_each(|part| part.visit(visit));
    }

    fn visit_mut(&mut self, visit: &mut dyn FnMut(&'static str, ColumnMut<'_>)) {
        self.origins.iter_mut().chain(self.lengths.iter_mut()).for_each(|part| part.visit_mut(visit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_end_at_powers_of_two() {
        let classes = [1, 2, 3, 4, 5, 8, 9, 16, 17, 65536].map(length_class);
        assert_eq!(classes, [0, 1, 2, 2, 3, 3, 4, 4, 4, 4]);
    }

    #[test]
    fn only_what_is_asked_for_is_kept() {
        let arena = Bump::new();
        let count = |origins, has_lengths| PartTable::new_in(&arena, 8, 1, origins, has_lengths).of(1, 3).count();
        assert_eq!([count(0, false), count(3, false), count(0, true), count(3, true)], [0, 1, 1, 2]);
        assert!(PartTable::new_in(&arena, 8, 3, 0, false).is_empty());
    }
}
