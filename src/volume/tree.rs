//! The nodes of a grid above its leaves, and which of their voxels are active.

use std::collections::BTreeSet;

use super::input::{DAMAGED, Input};
use super::limits;
use super::nodes::{Cube, LEAF, LOWER, UPPER};
use super::values::{Values, bit};
use crate::gltf::fault::{Checked, Fault, require};

/// Largest density: sums and products of larger ones may overflow single precision.
const LARGEST: f32 = 1e36;

/// A mask of the voxels of a leaf.
pub type Mask = [u64; 8];

/// What is known before the values of leaves are read.
#[derive(Default)]
pub struct Tree {
    /// Leaves in the order of the file, and their active voxels.
    pub leaves: Vec<(Cube, Mask)>,
    /// Constant regions that are active and not 0.
    pub tiles: Vec<(Cube, f32)>,
    /// In leaves and in constant regions, those of value 0 included.
    pub active_voxels: u64,
    /// Voxels of all leaves and tiles.
    voxels: u64,
}

impl Tree {
    /// Reads all nodes.
    pub fn read(input: &mut Input, values: &mut Values) -> Checked<Self> {
        let buffers = input.u32()?;
        require(buffers == 1, || format!("has {buffers} values per voxel instead of 1"), DAMAGED)?;
        let background = input.f32()?;
        let remedy = "subtract the background from all values; a density is 0 outside its cloud";
        require(background == 0.0, || format!("has the background {background:?} instead of 0"), remedy)?;
        let [tiles, nodes] = [input.u32()?, input.u32()?];
        let mut tree = Self::default();
        let mut origins = BTreeSet::new();
        for _ in 0..tiles {
            let cube = root_entry(input, &mut origins)?;
            let (value, is_active) = (input.f32()?, input.u8()? != 0);
            tree.add_constant(cube, value, is_active)?;
        }
        for _ in 0..nodes {
            let cube = root_entry(input, &mut origins)?;
            tree.add_node(input, values, cube)?;
        }
        Ok(tree)
    }

    /// Reads a node and all that is in it.
    fn add_node(&mut self, input: &mut Input, values: &mut Values, node: Cube) -> Checked<()> {
        let below = if node.log_edge == UPPER { LOWER } else { LEAF };
        let count = 1_usize << (3 * (node.log_edge - below));
        let [mut children, mut active] = [vec![0; count / 64], vec![0; count / 64]];
        input.mask(&mut children)?;
        input.mask(&mut active)?;
        let is_both = children.iter().zip(&active).any(|(child, active)| child & active != 0);
        require(!is_both, || "has a node whose masks contradict each other", DAMAGED)?;
        let mut constants = vec![0.0; count];
        values.read(input, &active, &mut constants)?;
        for (index, value) in constants.into_iter().enumerate().filter(|(index, _)| !bit(&children, *index)) {
            self.add_constant(node.part(index, below), value, bit(&active, index))?;
        }
        for index in (0..count).filter(|index| bit(&children, *index)) {
            let part = node.part(index, below);
            if below == LEAF { self.add_leaf(input, part)? } else { self.add_node(input, values, part)? }
        }
        Ok(())
    }

    /// Reads which voxels of a leaf are active.
    fn add_leaf(&mut self, input: &mut Input, leaf: Cube) -> Checked<()> {
        let mut mask = Mask::default();
        input.mask(&mut mask)?;
        self.active_voxels += mask.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        self.grow(leaf)?;
        self.leaves.push((leaf, mask));
        Ok(())
    }

    fn add_constant(&mut self, cube: Cube, value: f32, is_active: bool) -> Checked<()> {
        check(value, is_active, || cube)?;
        if is_active {
            self.active_voxels = self.active_voxels.saturating_add(cube.voxels());
            if value != 0.0 {
                self.grow(cube)?;
                self.tiles.push((cube, value));
            }
        }
        Ok(())
    }

    /// Counts the voxels of a leaf or tile.
    fn grow(&mut self, cube: Cube) -> Checked<()> {
        self.voxels = self.voxels.saturating_add(cube.voxels());
        limits::voxels(self.voxels)
    }
}

/// The place of a node or tile of the root, which no other may have.
fn root_entry(input: &mut Input, origins: &mut BTreeSet<[i32; 3]>) -> Checked<Cube> {
    let origin = input.coordinates()?;
    let is_aligned = origin.iter().all(|coordinate| coordinate.trailing_zeros() >= UPPER);
    require(is_aligned, || format!("has a node at {origin:?}, where nodes are at multiples of 4096"), DAMAGED)?;
    require(origins.insert(origin), || format!("has two nodes at {origin:?}"), DAMAGED)?;
    Ok(Cube { origin, log_edge: UPPER })
}

/// Whether `value` is a density, or 0 if it is not active.
pub fn check(value: f32, is_active: bool, place: impl FnOnce() -> Cube) -> Checked<()> {
    if value == 0.0 || (is_active && value > 0.0 && value <= LARGEST) {
        return Ok(());
    }
    let (finding, remedy) = if !value.is_finite() {
        (format!("has the value {value}"), "save the grid with finite values")
    } else if value < 0.0 {
        (format!("has the value {value:?}, which is negative"), "save the grid with densities of 0 or more")
    } else if value > LARGEST {
        (format!("has the value {value:?}, more than {LARGEST:e}"), "save the grid with densities of at most 1e36")
    } else {
        (format!("is not active, but has the value {value:?}"), "activate it, or set inactive voxels to 0")
    };
    Err(Fault::new(finding, remedy).at(place()))
}
