//! What is known of each brick of a grid, empty ones included.
//!
//! Entries of bricks that are close together are a dense table. Where they are scattered, most of that would be for nothing:
//! then it is cut into pages of 4^3 entries, of which all that are empty share the first one.
//!
//! ```text
//! dense:     entries[(z height + y) width + x]
//! in pages:  X, Y, Z = x / 4, y / 4, z / 4
//!            entries[pages[(Z HEIGHT + Y) WIDTH + X] + (z % 4 * 4 + y % 4) * 4 + x % 4]
//! ```

use wide::u32x8;

use crate::lanes::{LANES, per_lane};

/// Entries along the edge of a page.
const EDGE: u32 = 4;
/// Entries of a page.
const PAGE: usize = (EDGE * EDGE * EDGE) as usize;
/// So much smaller pages have to be than a dense table, which is faster.
const WORTH_IT: usize = 2;

/// An entry for each brick of a box; that of an empty one is the default.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<T> {
    /// Bricks along each axis.
    dims: [u32; 3],
    /// Where each page begins; none for a dense table.
    pages: Option<Vec<u32>>,
    entries: Vec<T>,
}

impl<T: Copy + Default> Table<T> {
    /// Those of the `filled` bricks at their places, each of which is below `dims`; all others are empty.
    ///
    /// # Panics
    /// If there are more than 2^31 bricks, empty ones included, or more than 2^32 entries in pages.
    pub fn new(dims: [u32; 3], filled: &[([u32; 3], T)]) -> Self {
        let paged = Self::in_pages(dims, filled);
        let dense = count(dims).saturating_mul(size_of::<T>());
        if WORTH_IT * paged.bytes() <= dense { paged } else { Self::dense(dims, filled) }
    }

    fn dense(dims: [u32; 3], filled: &[([u32; 3], T)]) -> Self {
        let mut entries = vec![T::default(); count(dims)];
        for (place, entry) in filled {
            entries[index(dims, *place)] = *entry;
        }
        Self { dims, pages: None, entries }
    }

    fn in_pages(dims: [u32; 3], filled: &[([u32; 3], T)]) -> Self {
        let across = pages_across(dims);
        let mut pages = vec![0; count(across)];
        let mut entries = vec![T::default(); PAGE];
        for (place, entry) in filled {
            let page = &mut pages[index(across, place.map(|along| along / EDGE))];
            if *page == 0 {
                *page = u32::try_from(entries.len()).expect("fewer than 2^32 entries");
                entries.resize(entries.len() + PAGE, T::default());
            }
            entries[*page as usize + index([EDGE; 3], place.map(|along| along % EDGE))] = *entry;
        }
        entries.shrink_to_fit();
        Self { dims, pages: Some(pages), entries }
    }

    /// That of the brick at `place`, which is below `dims`.
    pub fn at(&self, place: [u32; 3]) -> &T {
        let index = match &self.pages {
            None => index(self.dims, place),
            Some(pages) => {
                let page = pages[index(pages_across(self.dims), place.map(|along| along / EDGE))];
                page as usize + index([EDGE; 3], place.map(|along| along % EDGE))
            }
        };
        &self.entries[index]
    }

    /// Those of eight bricks.
    #[inline(always)]
    pub fn at_lanes(&self, place: [u32x8; 3]) -> [&T; LANES] {
        let index = match &self.pages {
            None => index_x8(self.dims, place),
            Some(pages) => {
                let page = index_x8(pages_across(self.dims), place.map(|along| along >> EDGE.ilog2())).to_array();
                let page = u32x8::new(per_lane(|lane| pages[page[lane] as usize]));
                page + index_x8([EDGE; 3], place.map(|along| along & u32x8::splat(EDGE - 1)))
            }
        };
        let index = index.to_array();
        per_lane(|lane| &self.entries[index[lane] as usize])
    }

    /// All of them, and empty ones.
    pub fn all(&self) -> &[T] {
        &self.entries
    }

    /// Where pages begin, if there are any.
    pub fn pages(&self) -> &[u32] {
        self.pages.as_deref().unwrap_or_default()
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice()) + size_of_val(self.pages())
    }
}

/// Pages along each axis, of entries for so many bricks.
#[inline(always)]
fn pages_across(dims: [u32; 3]) -> [u32; 3] {
    dims.map(|dim| dim.div_ceil(EDGE))
}

/// Places of a box.
fn count(dims: [u32; 3]) -> usize {
    let count = dims.iter().map(|dim| u64::from(*dim)).product::<u64>();
    usize::try_from(count).expect("fewer than 2^31 places")
}

/// Where a place is in the sequence of all of a box, x fastest, then y.
fn index([width, height, _]: [u32; 3], [x, y, z]: [u32; 3]) -> usize {
    (z as usize * height as usize + y as usize) * width as usize + x as usize
}

#[inline(always)]
fn index_x8([width, height, _]: [u32; 3], [x, y, z]: [u32x8; 3]) -> u32x8 {
    (z * u32x8::splat(height) + y) * u32x8::splat(width) + x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    const DIMS: [u32; 3] = [9, 4, 6];

    fn places() -> impl Iterator<Item = [u32; 3]> {
        (0..DIMS[2]).flat_map(|z| (0..DIMS[1]).flat_map(move |y| (0..DIMS[0]).map(move |x| [x, y, z])))
    }

    /// About one brick of `share`, each with an entry of its own.
    fn one_of(share: u32) -> Vec<([u32; 3], u32)> {
        places().zip(1..).filter(|(_, number)| random::words(*number, 5, 0, 0)[0].is_multiple_of(share)).collect()
    }

    #[test]
    fn pages_hold_what_a_dense_table_holds() {
        for share in [1, 3, 40, 1000] {
            let filled = one_of(share);
            let (dense, paged) = (Table::dense(DIMS, &filled), Table::in_pages(DIMS, &filled));
            for place in places() {
                let expected = filled.iter().find(|(filled, _)| *filled == place).map_or(0, |(_, entry)| *entry);
                assert_eq!([*dense.at(place), *paged.at(place)], [expected; 2], "{place:?}, one of {share}");
            }
        }
    }

    #[test]
    fn lanes_find_what_is_found_one_by_one() {
        let filled = one_of(3);
        let places: Vec<[u32; 3]> = places().collect();
        for table in [Table::dense(DIMS, &filled), Table::in_pages(DIMS, &filled)] {
            for places in places.chunks_exact(8) {
                let along = |axis: usize| u32x8::new(per_lane(|lane| places[lane][axis]));
                let found = table.at_lanes([along(0), along(1), along(2)]);
                assert_eq!(found, per_lane(|lane| table.at(places[lane])));
            }
        }
    }

    #[test]
    fn scattered_bricks_take_next_to_no_memory_and_full_boxes_no_pages() {
        assert_eq!(Table::new(DIMS, &one_of(1)).pages, None);
        let filled = [[0; 3], [400; 3]].map(|place| (place, [1_u32; 4]));
        let bytes = Table::new([401; 3], &filled).bytes();
        assert!(bytes < 5_000_000, "{bytes} bytes, where a dense table takes 1 GB");
    }
}
