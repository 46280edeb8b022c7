//! OpenVDB files as large as a test likes: one grid without compression, in one node of 4096^3 voxels.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

use fogbow::volume::Leaf;

/// Edges of the node below the root, of those below it, and of leaves, in voxels, as powers of two.
const EDGES: [u32; 3] = [12, 7, 3];
/// What stands in front of values of which none is left out.
const ALL_VALUES: u8 = 6;
/// Bytes of a leaf's mask and values.
const LEAF: usize = 64 + 1 + 4 * 512;

/// Leaves by their number in their node, and nodes by theirs.
type Nodes<'a> = BTreeMap<usize, BTreeMap<usize, &'a Leaf>>;

/// Writes a grid called `density` to `path`: cubic voxels of this edge `[m]`, those of `leaves`, which lie within
/// 0 to 4095, active if they are not 0.
///
/// # Panics
/// If the file cannot be written.
pub fn write(path: &Path, edge: f64, leaves: &[Leaf]) {
    let mut nodes = Nodes::new();
    for leaf in leaves {
        assert!(leaf.origin.iter().all(|x| (0..1 << EDGES[0]).contains(x)), "{:?}", leaf.origin);
        let node = nodes.entry(number(leaf.origin, EDGES[0], EDGES[1])).or_default();
        assert!(node.insert(number(leaf.origin, EDGES[1], EDGES[2]), leaf).is_none(), "{:?}", leaf.origin);
    }
    let file = File::create(path).and_then(|file| write_to(&mut BufWriter::new(file), edge, &nodes));
    file.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

fn write_to(file: &mut impl Write, edge: f64, nodes: &Nodes) -> Result<()> {
    let (head, description, tree) = (head(), description(edge), tree(nodes));
    let start = head.len() + 3 * size_of::<u64>();
    let values = start + description.len() + tree.len();
    let end = values + LEAF * nodes.values().map(BTreeMap::len).sum::<usize>();
    file.write_all(&head)?;
    [start, values, end].iter().try_for_each(|place| file.write_all(&(*place as u64).to_le_bytes()))?;
    file.write_all(&description)?;
    file.write_all(&tree)?;
    for leaf in nodes.values().flat_map(BTreeMap::values) {
        file.write_all(&active(leaf))?;
        file.write_all(&[ALL_VALUES])?;
        file.write_all(ordered(leaf).map(f32::to_le_bytes).as_flattened())?;
    }
    file.flush()
}

/// The part of edge 2^`below` in a cube of edge 2^`edge` that a voxel is in; z runs fastest.
fn number(voxel: [i32; 3], edge: u32, below: u32) -> usize {
    voxel.iter().fold(0, |number, x| (number << (edge - below)) | (*x as usize & ((1 << edge) - 1)) >> below)
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// What is in front of the places of the only grid.
fn head() -> Vec<u8> {
    let (magic, version, library) = (0x5644_4220_u64, 224_u32, [11_u32, 0]);
    let mut head = [&magic.to_le_bytes()[..], &version.to_le_bytes()].concat();
    head.extend(library.map(u32::to_le_bytes).as_flattened());
    head.push(1); // places are known
    head.extend([b'0'; 36]);
    head.extend(0_u32.to_le_bytes()); // no metadata
    head.extend(1_u32.to_le_bytes());
    head.extend([text("density"), text("Tree_float_5_4_3"), text("")].concat());
    head
}

/// No compression, no metadata, and a scale.
fn description(edge: f64) -> Vec<u8> {
    let inverse = 1.0 / edge;
    let numbers = [edge, edge, inverse, inverse * inverse, inverse / 2.0].map(|number| [number; 3]);
    let numbers = numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes());
    [&[0; 8][..], &text("UniformScaleMap"), &numbers.collect::<Vec<_>>()].concat()
}

/// All nodes, and the masks of leaves.
fn tree(nodes: &Nodes) -> Vec<u8> {
    let [buffers, background, tiles, children] = [1_u32, 0, 0, 1].map(u32::to_le_bytes);
    let mut tree = [&buffers[..], &background, &tiles, &children, &[0; 12]].concat();
    tree.extend(node(nodes.keys(), EDGES[0] - EDGES[1]));
    for leaves in nodes.values() {
        tree.extend(node(leaves.keys(), EDGES[1] - EDGES[2]));
        leaves.values().for_each(|leaf| tree.extend(active(leaf)));
    }
    tree
}

/// A node with 2^`log` parts along each edge, which has these children and is 0 elsewhere.
fn node<'a>(children: impl Iterator<Item = &'a usize>, log: u32) -> Vec<u8> {
    let count = 1_usize << (3 * log);
    let mut node = vec![0; 2 * count / 8];
    children.for_each(|child| node[child / 8] |= 1 << (child % 8));
    node.push(ALL_VALUES);
    node.resize(node.len() + 4 * count, 0);
    node
}

/// The values of a leaf, z fastest.
fn ordered(leaf: &Leaf) -> [f32; 512] {
    core::array::from_fn(|index| {
        let [x, y, z] = [index >> 6, index >> 3 & 7, index & 7];
        leaf.values[(z * 8 + y) * 8 + x]
    })
}

/// The mask of its voxels that are not 0.
fn active(leaf: &Leaf) -> [u8; 64] {
    let values = ordered(leaf);
    core::array::from_fn(|byte| (0..8).fold(0, |mask, bit| mask | u8::from(values[8 * byte + bit] != 0.0) << bit))
}
