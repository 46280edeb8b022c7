//! Grids of files, each of which is read once, however many volumes have it for their densities or their emission.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use fogbow_kernels::media::field::{Bricks, Leaf};
use glam::DAffine3;

use crate::error::Result;
use crate::scene::filling::Densities;
use crate::volume::{self, VoxelGrid};

/// Most bricks of 8^3 voxels, empty ones included, between voxels that are far apart: their pages take 8 MiB.
pub(super) const MOST_BRICKS: u64 = 1 << 27;

/// A grid of a file, before it is placed.
pub struct GridOfFile {
    /// World metres of index coordinates, as the file has it.
    pub index_to_world: DAffine3,
    /// What it holds, in index coordinates.
    pub densities: Densities,
    /// Bricks, empty ones included, from the first voxel to the last along every axis.
    pub bricks_spanned: u64,
    /// Its voxels; none where no density [counts](Densities::nothing), or they are too far apart.
    pub bricks: Option<Arc<Bricks>>,
}

/// A file, and the name of the grid that was asked for.
type Source = (PathBuf, Option<String>);

/// The grids that have been read.
#[derive(Default)]
pub struct GridFiles {
    read: RefCell<BTreeMap<Source, Rc<GridOfFile>>>,
}

impl GridFiles {
    /// The grid called `name` of the file at `path`, or the only one there; `look` is told how far it has been read.
    ///
    /// # Errors
    /// As [`volume::read`].
    pub fn read(&self, path: &Path, name: Option<&str>, look: &dyn Fn(u64, u64)) -> Result<Rc<GridOfFile>> {
        let key = (path.to_path_buf(), name.map(str::to_string));
        if let Some(grid) = self.read.borrow().get(&key) {
            return Ok(Rc::clone(grid));
        }
        let voxels = volume::read(path, name, look)?;
        let (densities, bricks_spanned) = (Densities::of(&voxels), bricks_spanned(&voxels.leaves));
        let holds = densities.nothing().is_none() && bricks_spanned <= MOST_BRICKS;
        let bricks = holds.then(|| Arc::new(Bricks::new(&voxels.leaves)));
        let grid = Rc::new(GridOfFile { index_to_world: voxels.index_to_world, densities, bricks_spanned, bricks });
        self.read.borrow_mut().insert(key, Rc::clone(&grid));
        Ok(grid)
    }
}

/// What is said of `grid`, as it follows "its", if its voxels are too far apart to be rendered.
pub fn too_far_apart(grid: &VoxelGrid) -> Option<String> {
    let spanned = bricks_spanned(&grid.leaves);
    (spanned > MOST_BRICKS).then(|| far_apart(spanned))
}

/// What is said of a grid that spans too many bricks, as it follows "its".
pub(super) fn far_apart(spanned: u64) -> String {
    format!("voxels are so far apart that {spanned} bricks of 8x8x8 lie between them")
}

/// Bricks, empty ones included, from the first leaf to the last along every axis, with one more below.
fn bricks_spanned(leaves: &[Leaf]) -> u64 {
    let along = |axis: usize| {
        let brick = |leaf: &Leaf| i64::from(leaf.origin[axis].div_euclid(8));
        let (first, last) = (leaves.iter().map(brick).min(), leaves.iter().map(brick).max());
        first.zip(last).map_or(0, |(first, last)| (last - first + 2) as u64)
    };
    (0..3).map(along).fold(1, u64::saturating_mul)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_far_apart_span_more_bricks_than_there_are() {
        let leaf = |origin: [i32; 3]| Leaf { origin, values: [1.0; 512].into() };
        assert_eq!(bricks_spanned(&[leaf([0; 3])]), 8);
        assert_eq!(bricks_spanned(&[leaf([-8, 0, 0]), leaf([8, 0, 16])]), 4 * 2 * 4);
        let [least, most] = [i32::MIN, i32::MAX - 7];
        assert!(bricks_spanned(&[leaf([least; 3]), leaf([most; 3])]) > MOST_BRICKS);
    }
}
