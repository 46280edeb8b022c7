//! Volumes from OpenVDB files: voxels of clouds and smoke, as leaves of 8^3 voxels.
//!
//! [`list`] says what is in a file, [`read`] reads one grid of single-precision numbers, saved as such or as half
//! floats, uncompressed or compressed with zlib or Blosc (LZ4). A grid holds densities: from 0 to 1e36, and 0 wherever
//! it says nothing. What is malformed or holds something else is an error, and never a panic, whatever the bytes are:
//! memory is taken only for what is in the file, and for constant regions within a limit.
//!
//! This is our own reader, because no library would do. vdb-rs 0.6 takes as much memory as a damaged file asks for and
//! ends the program where there is not enough, which nothing can catch. It misreads grids of half floats, knows
//! neither backgrounds nor rotations, passes over constant regions of 4096^3 voxels, and needs another glam than ours.

mod archive;
mod blosc;
mod chunks;
mod grid;
mod input;
mod limits;
mod metadata;
mod nodes;
mod summary;
mod transform;
mod tree;
mod values;

use std::fs::File;
use std::io::{BufReader, Cursor};
use std::path::Path;

use glam::DAffine3;

pub use fogbow_kernels::media::field::Leaf;

use crate::error::{Error, Result};
use crate::gltf::fault::{Fault, InFile};
use archive::{Archive, Entry};
use input::{DAMAGED, Input};
pub use summary::GridSummary;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 20;

/// What may be wrong with a path that cannot be read.
const GIVE_A_FILE: &str = "give an OpenVDB file that exists and may be read";

/// One scalar grid of a file.
#[derive(Clone, Debug)]
pub struct VoxelGrid {
    /// What the file calls it. Of grids that share a name, OpenVDB's number follows: `density[1]`.
    pub name: String,
    /// World metres of index coordinates; voxel i has its centre at index coordinate i. Can be inverted.
    pub index_to_world: DAffine3,
    /// In the order of the file, no two at the same place. All other voxels are 0.
    pub leaves: Vec<Leaf>,
    /// Voxels that the file calls active, even if they are 0, in leaves and in constant regions.
    pub active_voxels: u64,
}

impl VoxelGrid {
    /// Index coordinates of the first and the last voxel along every axis that is not 0; none if all are.
    pub fn index_bounds(&self) -> Option<[[i32; 3]; 2]> {
        let (mut first, mut last) = ([i32::MAX; 3], [i32::MIN; 3]);
        for leaf in &self.leaves {
            for (index, _) in leaf.values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                for (axis, offset) in [index & 7, index >> 3 & 7, index >> 6].into_iter().enumerate() {
                    let at = leaf.origin[axis] + offset as i32;
                    (first[axis], last[axis]) = (first[axis].min(at), last[axis].max(at));
                }
            }
        }
        (first[0] <= last[0]).then_some([first, last])
    }
}

/// What is in the file at `path`: all its grids, whether they can be read or not.
///
/// # Errors
/// If the file cannot be read, or is not a complete OpenVDB file.
pub fn list(path: &Path) -> Result<Vec<GridSummary>> {
    let mut file = open(path)?;
    summaries(&path.display().to_string(), &mut Input::new(&mut file))
}

/// Reads the grid called `name` from the file at `path`; if there is no name, the file's only grid, or else the one
/// called `density`. `progress` gets the numbers of leaves that are done and that there are.
///
/// # Errors
/// If the file cannot be read, or is not a complete OpenVDB file; if there is no such grid; if it holds something else
/// than densities, or too much.
pub fn read(path: &Path, name: Option<&str>, progress: &dyn Fn(u64, u64)) -> Result<VoxelGrid> {
    let mut file = open(path)?;
    one(&path.display().to_string(), &mut Input::new(&mut file), name, progress)
}

/// The same of the grid with this number in the [`list`] of the file's grids, whatever it is called.
///
/// # Errors
/// As [`read`].
pub fn read_listed(path: &Path, number: usize, progress: &dyn Fn(u64, u64)) -> Result<VoxelGrid> {
    let (mut file, name) = (open(path)?, path.display().to_string());
    let input = &mut Input::new(&mut file);
    let archive = Archive::read(input).in_file(&name)?;
    let finding = || Fault::new(format!("has {} grids, and none of number {number}", archive.grids.len()), DAMAGED);
    let entry = archive.grids.get(number).ok_or_else(finding).in_file(&name)?;
    of_entry(&name, input, &archive, entry, progress)
}

/// Whether the file at `path` can be read and has no grid called `name`.
pub fn lacks(path: &Path, name: &str) -> bool {
    list(path).is_ok_and(|grids| !grids.is_empty() && grids.iter().all(|grid| grid.name != name))
}

/// What is in a file that is in memory; `file` is what errors call it.
///
/// # Errors
/// As [`list`].
pub fn list_bytes(file: &str, bytes: &[u8]) -> Result<Vec<GridSummary>> {
    summaries(file, &mut Input::new(&mut Cursor::new(bytes)))
}

/// Reads a grid of a file that is in memory; `file` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(file: &str, bytes: &[u8], name: Option<&str>) -> Result<VoxelGrid> {
    one(file, &mut Input::new(&mut Cursor::new(bytes)), name, &|_, _| {})
}

/// Whether the name of the file at `path` is that of an OpenVDB file.
pub fn is_volume(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("vdb"))
}

/// Opens the file at `path`. Pipes and devices would keep the reader waiting, and cannot be read twice.
fn open(path: &Path) -> Result<BufReader<File>> {
    if path.exists() && !path.is_file() {
        return Err(Error::failure(path.display(), "is not a regular file", GIVE_A_FILE));
    }
    let unreadable = |error| Error::failure(path.display(), format!("cannot be read: {error}"), GIVE_A_FILE);
    Ok(BufReader::with_capacity(BUFFER, File::open(path).map_err(unreadable)?))
}

fn summaries(file: &str, input: &mut Input) -> Result<Vec<GridSummary>> {
    let archive = Archive::read(input).in_file(file)?;
    Ok(archive.grids.iter().map(GridSummary::of).collect())
}

fn one(file: &str, input: &mut Input, name: Option<&str>, progress: &dyn Fn(u64, u64)) -> Result<VoxelGrid> {
    let archive = Archive::read(input).in_file(file)?;
    let entry = archive.choose(name).in_file(file)?;
    of_entry(file, input, &archive, entry, progress)
}

fn of_entry(
    file: &str,
    input: &mut Input,
    archive: &Archive,
    entry: &Entry,
    progress: &dyn Fn(u64, u64),
) -> Result<VoxelGrid> {
    grid::read(input, archive, entry, progress).map_err(|fault| fault.at(entry.label())).in_file(file)
}
