//! Cores: the box in a block in which all is that is much denser than the rest of it.
//!
//! A candle in a foggy hall is smaller than the blocks, whose size is that of the hall. Were its extinction the majorant
//! of all of the block, rays would meet thousands of candidates in fog. So there are two bounds: of what is in the box
//! around the candle, and of what is outside of it.
//!
//! ```text
//! rows:      one for each block; behind them two for each core: inside, outside
//! t < t_in:             bounds of the row outside, until t_in or the block's border
//! t_in <= t < t_out:    bounds of the row inside, until t_out or the block's border
//! else:                 bounds of the row outside, until the block's border
//! ```

use glam::DVec3;
use wide::{f32x8, i32x8, u32x8};

use super::axis::within_boxes;
use super::bricks::Extent;
use super::volume::{Placed, Range};
use crate::lanes::{self, LANES, per_lane};
use crate::vec3::Vec3x8;

/// Mean free paths through a block, at its largest extinction, from which on a core is looked for.
const THICK: f64 = 8.0;
/// By how much it has to spare candidates.
const WORTH_IT: f64 = 2.0;
/// By how much cores are wider than what is in them, in cells: the places of candidates are rounded.
const WIDER: f64 = 1e-4;

/// A core, and what extinctions range over in it and around it.
pub struct Found {
    /// Corners `[m]`.
    pub corners: [DVec3; 2],
    /// What is in it [1/m]; the mean is anything in between.
    pub inside: Extent,
    /// What is in the rest of the block [1/m]; the same.
    pub outside: Extent,
}

/// The box of a core.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Core {
    /// Corners, in cells.
    corners: [[f32; 3]; 2],
    /// The row of what is inside; that of what is outside is the next one.
    row: u32,
}

/// The cores of all blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Cores {
    /// That of each block: 0 for none, or one more than its place in the list.
    of: Vec<u32>,
    all: Vec<Core>,
}

impl Found {
    /// That of a block between `corners` `[m]` where the `volumes` of the bits `present` are, in what is `around` [1/m].
    pub fn new(volumes: &[Placed], around: f32, present: u32, [low, high]: [DVec3; 2]) -> Option<Self> {
        let edge = (high - low).max_element();
        let mut there: Vec<(Range, [DVec3; 2])> = Vec::new();
        for (_, placed) in (0..).zip(volumes).filter(|(number, _)| present >> number & 1 == 1) {
            let Some(range) = placed.volume.range(low, high) else { continue };
            let bounds = placed.volume.bounds();
            there.push((range, [bounds[0].max(low), bounds[1].min(high)]));
            if range.covers {
                break;
            }
        }
        if !there.last().is_some_and(|(range, _)| range.covers) {
            there.push((Range { least: around, most: around, covers: true }, [low, high]));
        }
        there.sort_by(|(a, _), (b, _)| size(b).total_cmp(&size(a)));
        let most = size(&there[0].0);
        if f64::from(most) * edge < THICK {
            return None;
        }
        let found = (1..there.len()).map(|count| {
            let (dense, rest) = there.split_at(count);
            let corners = dense.iter().map(|(_, bounds)| *bounds);
            let corners = corners.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).expect("one at least");
            let (inside, outside) = (extent(&there), extent(rest));
            let work = f64::from(size(&rest[0].0)) * edge + f64::from(most) * (corners[1] - corners[0]).max_element();
            (work, Self { corners, inside, outside })
        });
        let (work, best) = found.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        (WORTH_IT * work <= f64::from(most) * edge).then_some(best)
    }
}

/// The largest of extinctions, which may be negative between channels.
fn size(range: &Range) -> f32 {
    range.most.abs().max(range.least.abs())
}

/// What extinctions of several volumes range over.
fn extent(there: &[(Range, [DVec3; 2])]) -> Extent {
    let least = there.iter().map(|(range, _)| range.least).fold(f32::INFINITY, f32::min);
    let most = there.iter().map(|(range, _)| range.most).fold(f32::NEG_INFINITY, f32::max);
    Extent { least, most, mean: 0.5 * (least + most) }
}

impl Cores {
    /// For so many blocks, none of which has a core yet.
    pub fn none(blocks: usize) -> Self {
        Self { of: vec![0; blocks], all: Vec::new() }
    }

    /// Gives a block a core between `corners`, in cells. The bounds inside are in `row`, those outside in the next one.
    pub fn add(&mut self, block: usize, [low, high]: [DVec3; 2], row: usize) {
        let corners = [low - WIDER, high + WIDER].map(|corner| corner.as_vec3().to_array());
        self.all.push(Core { corners, row: row as u32 });
        self.of[block] = self.all.len() as u32;
    }

    /// Whether there are none at all.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.of.as_slice()) + size_of_val(self.all.as_slice())
    }

    /// Corners of the core of `block`, in cells, and its row; for twins.
    pub fn at(&self, block: usize) -> Option<([DVec3; 2], usize)> {
        let core = self.all[self.of[block].checked_sub(1)? as usize];
        Some((core.corners.map(|corner| DVec3::from(corner.map(f64::from))), core.row as usize))
    }

    /// The rows of bounds that hold for rays `origin + t direction`, in cells, in these blocks from `t` on, and where
    /// they end if the blocks do at `border`.
    #[inline(never)]
    pub fn ahead(&self, blocks: i32x8, [origin, direction]: [Vec3x8; 2], t: f32x8, border: f32x8) -> (i32x8, f32x8) {
        let blocks_of = blocks.to_array();
        let cores: [u32; LANES] = per_lane(|lane| self.of[blocks_of[lane] as usize]);
        if cores == [0; LANES] {
            return (blocks, border);
        }
        let of: [&Core; LANES] = per_lane(|lane| &self.all[cores[lane].saturating_sub(1) as usize]);
        let corner = |end: usize| {
            let along = |axis: usize| f32x8::new(per_lane(|lane| of[lane].corners[end][axis]));
            Vec3x8::new(along(0), along(1), along(2))
        };
        let [enters, leaves] = within_boxes(origin, direction, [corner(0), corner(1)], f32x8::splat(f32::INFINITY));
        let has_one = !lanes::as_mask(u32x8::new(cores).simd_eq(u32x8::splat(0)));
        let ahead = has_one & t.simd_lt(enters) & enters.simd_lt(leaves);
        let inside = has_one & t.simd_ge(enters) & t.simd_lt(leaves);
        let row = u32x8::new(per_lane(|lane| of[lane].row)) + (lanes::as_integer_mask(!inside) & u32x8::splat(1));
        let border = ahead.select(border.fast_min(enters), inside.select(border.fast_min(leaves), border));
        (has_one.select(bytemuck::cast::<u32x8, i32x8>(row), blocks), border)
    }
}
