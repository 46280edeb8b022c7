//! Where the bricks of a grid are, and what their values mean: a head for each, empty ones included.
//!
//! Heads of bricks that are close together are a dense table. Where they are scattered, most of that would be for nothing:
//! then it is cut into pages of 4^3 heads, of which all that are empty share the first one.
//!
//! ```text
//! dense:     heads[(z height + y) width + x]
//! in pages:  X, Y, Z = x / 4, y / 4, z / 4
//!            heads[pages[(Z HEIGHT + Y) WIDTH + X] + (z % 4 * 4 + y % 4) * 4 + x % 4]
//! ```

use wide::{f32x8, u32x8};

use super::kept::Kept;
use crate::lanes::per_lane;

/// Heads along the edge of a page.
const EDGE: u32 = 4;
/// Heads of a page.
const PAGE: usize = (EDGE * EDGE * EDGE) as usize;
/// So much smaller pages have to be than a dense table, which is faster.
const WORTH_IT: usize = 2;

/// Where the values of a brick are, and what they mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// First of those that are kept in the pool.
    pub first: u32,
    /// Which these are.
    pub kept: Kept,
    /// Density of share 0.
    pub least: f32,
    /// Difference between neighbouring shares.
    pub step: f32,
}

/// The heads of eight bricks.
pub struct HeadX8 {
    /// First of the values that are kept in the pool.
    pub first: u32x8,
    /// The bits of which these are.
    pub kept: u32x8,
    /// Density of share 0.
    pub least: f32x8,
    /// Difference between neighbouring shares.
    pub step: f32x8,
}

/// The heads of all bricks of a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Heads {
    /// Bricks along each axis.
    dims: [u32; 3],
    /// Where each page begins; none for a dense table.
    pages: Option<Vec<u32>>,
    heads: Vec<Head>,
}

impl Head {
    /// Of an empty brick.
    pub const EMPTY: Self = Self::constant(0.0);

    /// Of a brick of one density.
    pub const fn constant(density: f32) -> Self {
        Self { first: 0, kept: Kept::ALL, least: density, step: 0.0 }
    }

    /// Whether it is one.
    pub const fn is_constant(&self) -> bool {
        self.step == 0.0
    }

    /// Density of this `share`.
    #[inline(always)]
    pub fn density(&self, share: f32) -> f32 {
        self.step.mul_add(share, self.least)
    }
}

impl Heads {
    /// Those of the `filled` bricks at their places, each of which is below `dims`; all others are empty.
    ///
    /// # Panics
    /// If there are more than 2^31 bricks, empty ones included, or more than 2^32 heads in pages.
    pub fn new(dims: [u32; 3], filled: &[([u32; 3], Head)]) -> Self {
        let paged = Self::in_pages(dims, filled);
        let dense = count(dims).saturating_mul(size_of::<Head>());
        if WORTH_IT * paged.bytes() <= dense { paged } else { Self::dense(dims, filled) }
    }

    fn dense(dims: [u32; 3], filled: &[([u32; 3], Head)]) -> Self {
        let mut heads = vec![Head::EMPTY; count(dims)];
        for (place, head) in filled {
            heads[index(dims, *place)] = *head;
        }
        Self { dims, pages: None, heads }
    }

    fn in_pages(dims: [u32; 3], filled: &[([u32; 3], Head)]) -> Self {
        let across = pages_across(dims);
        let mut pages = vec![0; count(across)];
        let mut heads = vec![Head::EMPTY; PAGE];
        for (place, head) in filled {
            let page = &mut pages[index(across, place.map(|along| along / EDGE))];
            if *page == 0 {
                *page = u32::try_from(heads.len()).expect("fewer than 2^32 heads");
                heads.resize(heads.len() + PAGE, Head::EMPTY);
            }
            heads[*page as usize + index([EDGE; 3], place.map(|along| along % EDGE))] = *head;
        }
        heads.shrink_to_fit();
        Self { dims, pages: Some(pages), heads }
    }

    /// That of the brick at `place`, which is below `dims`.
    pub fn at(&self, place: [u32; 3]) -> &Head {
        let index = match &self.pages {
            None => index(self.dims, place),
            Some(pages) => {
                let page = pages[index(pages_across(self.dims), place.map(|along| along / EDGE))];
                page as usize + index([EDGE; 3], place.map(|along| along % EDGE))
            }
        };
        &self.heads[index]
    }

    /// Those of eight bricks: all of them before anything else of them is read, so that what is farthest away, their
    /// values, is waited for together.
    #[inline(always)]
    pub fn at_lanes(&self, place: [u32x8; 3]) -> HeadX8 {
        let index = match &self.pages {
            None => index_x8(self.dims, place),
            Some(pages) => {
                let page = index_x8(pages_across(self.dims), place.map(|along| along >> EDGE.ilog2())).to_array();
                let page = u32x8::new(per_lane(|lane| pages[page[lane] as usize]));
                page + index_x8([EDGE; 3], place.map(|along| along & u32x8::splat(EDGE - 1)))
            }
        };
        let index = index.to_array();
        let heads = per_lane(|lane| &self.heads[index[lane] as usize]);
        HeadX8 {
            first: u32x8::new(per_lane(|lane| heads[lane].first)),
            kept: u32x8::new(per_lane(|lane| heads[lane].kept.bits())),
            least: f32x8::new(per_lane(|lane| heads[lane].least)),
            step: f32x8::new(per_lane(|lane| heads[lane].step)),
        }
    }

    /// All of them, and empty ones.
    pub fn all(&self) -> &[Head] {
        &self.heads
    }

    /// Hands everything to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        digest(bytemuck::cast_slice(self.pages.as_deref().unwrap_or_default()));
        for Head { first, kept, least, step } in &self.heads {
            digest(&[first.to_le_bytes(), kept.bits().to_le_bytes(), least.to_le_bytes(), step.to_le_bytes()].concat());
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.heads.as_slice()) + size_of_val(self.pages.as_deref().unwrap_or_default())
    }
}

/// Pages along each axis, of heads for so many bricks.
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

    /// About one brick of `share`, each with a head of its own.
    fn one_of(share: u32) -> Vec<([u32; 3], Head)> {
        let numbered = places().zip(0..);
        let filled = numbered.filter(|(_, number)| random::words(*number, 5, 0, 0)[0].is_multiple_of(share));
        filled
            .map(|(place, number)| (place, Head { first: number, kept: Kept::ALL, least: number as f32, step: 0.5 }))
            .collect()
    }

    #[test]
    fn pages_hold_what_a_dense_table_holds() {
        for share in [1, 3, 40, 1000] {
            let filled = one_of(share);
            let (dense, paged) = (Heads::dense(DIMS, &filled), Heads::in_pages(DIMS, &filled));
            for place in places() {
                let expected =
                    filled.iter().find(|(filled, _)| *filled == place).map_or(Head::EMPTY, |(_, head)| *head);
                assert_eq!([*dense.at(place), *paged.at(place)], [expected; 2], "{place:?}, one of {share}");
            }
        }
    }

    #[test]
    fn lanes_find_what_is_found_one_by_one() {
        let filled = one_of(3);
        let places: Vec<[u32; 3]> = places().collect();
        for heads in [Heads::dense(DIMS, &filled), Heads::in_pages(DIMS, &filled)] {
            for places in places.chunks_exact(8) {
                let along = |axis: usize| u32x8::new(per_lane(|lane| places[lane][axis]));
                let found = heads.at_lanes([along(0), along(1), along(2)]);
                let expected: [Head; 8] = per_lane(|lane| *heads.at(places[lane]));
                assert_eq!(found.first.to_array(), expected.map(|head| head.first));
                assert_eq!(found.kept.to_array(), expected.map(|head| head.kept.bits()));
                assert_eq!(found.least.to_array(), expected.map(|head| head.least));
                assert_eq!(found.step.to_array(), expected.map(|head| head.step));
            }
        }
    }

    #[test]
    fn scattered_bricks_take_next_to_no_memory_and_full_boxes_no_pages() {
        assert_eq!(Heads::new(DIMS, &one_of(1)).pages, None);
        let filled = [[0; 3], [400; 3]].map(|place| (place, Head::constant(1.0)));
        let bytes = Heads::new([401; 3], &filled).bytes();
        assert!(bytes < 5_000_000, "{bytes} bytes, where a dense table takes 1 GB");
    }
}
