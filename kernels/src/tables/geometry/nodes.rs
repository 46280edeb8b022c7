//! The tree: inner nodes of eight boxes, leaves of eight triangles, both as rows of eight numbers.

use bytemuck::{Pod, Zeroable};
use wide::{f32x8, u32x8};

use super::facets::Facet;
use super::pages::Pages;
use crate::lanes::LANES;

/// Most inner nodes on a way from the root to a leaf.
pub const DEPTH: usize = 32;

/// A tree over triangles.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Inner nodes, parents before their children; where there is any leaf, the first one holds them all.
    pub nodes: Pages<Node>,
    /// Leaves, neighbours in space near each other.
    pub leaves: Pages<Leaf>,
    /// Lower and upper corner of the box around everything `[m]`.
    pub bounds: [[f32; 3]; 2],
    /// Size of the largest coordinate `[m]`.
    pub extent: f32,
    /// The planes in which all triangles lie; none where they would be many.
    pub facets: Vec<Facet>,
}

/// Where a box leads: to an inner node or to a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Most leaves and most inner nodes.
    pub const MOST: usize = Self::LEAF as usize;

    /// The inner node of this index, below 2^31.
    pub fn node(index: usize) -> Self {
        debug_assert!(index < Self::MOST, "{index} nodes");
        Self(index as u32)
    }

    /// The leaf of this index, below 2^31.
    pub fn leaf(index: usize) -> Self {
        debug_assert!(index < Self::MOST, "{index} leaves");
        Self(index as u32 | Self::LEAF)
    }

    /// From its [bits](Self::bits).
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// As one number: the index, and in the highest bit whether it is a leaf's.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// Whether it is a leaf.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Its place in the nodes or in the leaves.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}

/// Eight boxes and where they lead: 256 bytes, four cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[repr(C, align(64))]
pub struct Node {
    /// By axis, the lower and the upper planes of the boxes `[m]`. Vacant lanes are last; they have lower +inf and
    /// upper -inf: no ray is in them.
    pub planes: [[f32x8; 2]; 3],
    /// [Bits](Child::bits) of the children.
    pub children: [u32; LANES],
    /// Makes the size a multiple of the alignment.
    pub spare: [u32; LANES],
}

impl Node {
    /// Eight vacant lanes.
    pub const VACANT: Self = {
        let (lower, upper) = (f32x8::new([f32::INFINITY; 8]), f32x8::new([f32::NEG_INFINITY; 8]));
        Self { planes: [[lower, upper]; 3], children: [0; LANES], spare: [0; LANES] }
    };

    /// Lower x, y, z, then upper x, y, z of the box in a lane `[m]`.
    #[inline(always)]
    pub fn planes_of(&self, lane: usize) -> [f32; 6] {
        core::array::from_fn(|plane| self.planes[plane % 3][plane / 3].as_array()[lane])
    }

    /// Fills a lane.
    pub fn set(&mut self, lane: usize, [lower, upper]: [[f32; 3]; 2], child: Child) {
        for axis in 0..3 {
            self.planes[axis][0].as_mut_array()[lane] = lower[axis];
            self.planes[axis][1].as_mut_array()[lane] = upper[axis];
        }
        self.children[lane] = child.bits();
    }
}

/// Eight triangles: 320 bytes, five cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Leaf {
    /// By corner and axis `[m]`. A vacant lane has NaN: every comparison with it fails.
    pub corners: [[f32x8; 3]; 3],
    /// Index of the triangle in the table.
    pub triangles: u32x8,
}

impl Leaf {
    /// Eight vacant lanes.
    pub const VACANT: Self =
        Self { corners: [[f32x8::new([f32::NAN; 8]); 3]; 3], triangles: u32x8::new([u32::MAX; LANES]) };

    /// Number of lanes that are taken, which are the first ones.
    pub fn count(&self) -> usize {
        self.triangles.to_array().iter().filter(|index| **index != u32::MAX).count()
    }

    /// Fills a lane.
    pub fn set(&mut self, lane: usize, corners: [[f32; 3]; 3], triangle: u32) {
        for (rows, corner) in self.corners.iter_mut().zip(corners) {
            for (row, component) in rows.iter_mut().zip(corner) {
                row.as_mut_array()[lane] = component;
            }
        }
        self.triangles.as_mut_array()[lane] = triangle;
    }

    /// The corners in a lane `[m]`.
    pub fn at(&self, lane: usize) -> [[f32; 3]; 3] {
        self.corners.map(|rows| rows.map(|row| row.to_array()[lane]))
    }
}
