//! One grid: its nodes, the values of its leaves, and leaves for its constant regions.

use std::sync::Arc;

use super::archive::{Archive, Entry};
use super::chunks::Packing;
use super::input::{DAMAGED, Input};
use super::nodes::{Cube, LEAF};
use super::tree::{Mask, Tree, check};
use super::values::{Values, bit};
use super::{Leaf, VoxelGrid};
use crate::gltf::fault::{Checked, Fault, require};

/// The only kind of tree that is read.
const TREE: &str = "Tree_float_5_4_3";
/// Leaves between two reports of progress.
const STEP: u64 = 4096;

/// Reads the grid `entry` of `archive`.
pub fn read(input: &mut Input, archive: &Archive, entry: &Entry, progress: &dyn Fn(u64, u64)) -> Checked<VoxelGrid> {
    check_kind(entry)?;
    let index_to_world = entry.map.affine()?;
    let owner = archive.owner(entry)?;
    check_kind(owner)?;
    let nodes = owner.places.nodes.ok_or_else(|| Fault::new("shares the voxels of a grid in a frustum", DAMAGED))?;
    let mut values = Values::new(Packing::of(owner.compression)?, owner.is_half);
    input.seek(nodes)?;
    let tree = Tree::read(input, &mut values)?;
    must_be_at(input, owner.places.leaves)?;
    let leaves = leaves(input, &mut values, &tree, progress)?;
    must_be_at(input, owner.places.end)?;
    Ok(VoxelGrid { name: entry.name.clone(), index_to_world, leaves, active_voxels: tree.active_voxels })
}

/// Why `entry` cannot be read, as far as that is known before its voxels are.
pub fn obstacle(entry: &Entry) -> Option<Fault> {
    check_kind(entry).and_then(|()| entry.map.affine()).err()
}

/// Whether a grid holds single-precision densities.
fn check_kind(entry: &Entry) -> Checked<()> {
    let finding = || format!("has values of type {}, not float", entry.value_type());
    require(
        entry.value_type() == "float",
        finding,
        "name another grid, or save it as a grid of single-precision floats",
    )?;
    let finding = || format!("is a tree of the kind {}", entry.tree);
    require(entry.tree == TREE, finding, "save it with OpenVDB's usual tree of nodes of 32, 16 and 8")?;
    let is_level_set = entry.metadata.class.as_deref() == Some("level set");
    let remedy = "name another grid, or convert it to a fog volume";
    require(!is_level_set, || "is a level set: its values are distances, not densities", remedy)
}

/// Whether the parts of a grid fit the places that the file gives for them.
fn must_be_at(input: &Input, place: u64) -> Checked<()> {
    let finding = || format!("has a part that ends at byte {} instead of {place}", input.position());
    require(input.position() == place, finding, DAMAGED)
}

/// All leaves, those of constant regions last.
fn leaves(input: &mut Input, values: &mut Values, tree: &Tree, progress: &dyn Fn(u64, u64)) -> Checked<Vec<Leaf>> {
    let expanded: u64 = tree.tiles.iter().map(|(tile, _)| tile.voxels() >> (3 * LEAF)).sum();
    let total = tree.leaves.len() as u64 + expanded;
    let mut leaves = Vec::new();
    for (cube, mask) in &tree.leaves {
        leaves.push(leaf(input, values, *cube, mask)?);
        let done = leaves.len() as u64;
        if done.is_multiple_of(STEP) {
            progress(done, total);
        }
    }
    for (tile, value) in &tree.tiles {
        leaves.extend(constant(*tile, *value));
    }
    progress(total, total);
    Ok(leaves)
}

/// Reads the values of a leaf.
fn leaf(input: &mut Input, values: &mut Values, cube: Cube, active: &Mask) -> Checked<Leaf> {
    let mut mask = Mask::default();
    input.mask(&mut mask)?;
    require(mask == *active, || format!("has a leaf at {:?} with two different masks", cube.origin), DAMAGED)?;
    let mut saved = [0.0; 512];
    values.read(input, &mask, &mut saved)?;
    let mut ordered = [0.0; 512];
    for (index, value) in saved.into_iter().enumerate() {
        check(value, bit(&mask, index), || cube.part(index, 0))?;
        let [x, y, z] = [index >> 6, index >> 3 & 7, index & 7];
        ordered[(z * 8 + y) * 8 + x] = value;
    }
    Ok(Leaf { origin: cube.origin, values: ordered.into() })
}

/// The leaves of a constant region.
fn constant(tile: Cube, value: f32) -> impl Iterator<Item = Leaf> {
    let (count, values) = (1_usize << (3 * (tile.log_edge - LEAF)), Arc::new([value; 512]));
    (0..count).map(move |index| Leaf { origin: tile.part(index, LEAF).origin, values: Arc::clone(&values) })
}
