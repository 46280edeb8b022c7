//! Grids of files, each of which is held once, however many volumes have it for their densities or their emission, and
//! whatever they call it; and read once, if all call it the same.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use fogbow_kernels::media::field::{Bricks, Leaf};
use glam::DAffine3;

use crate::error::{Error, Result};
use crate::gltf::quoted;
use crate::scene::filling::Densities;
use crate::volume::{self, VoxelGrid};

/// Most bricks of 8^3 voxels, empty ones included, between voxels that are far apart: their pages take 8 MiB as a cube,
/// and 32 as a pole.
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

/// A file, and the name of a grid in it, if one was asked for.
type Source = (PathBuf, Option<String>);

/// The grids that have been read, by what they were asked for and by what they are called.
#[derive(Default)]
pub struct GridFiles {
    read: RefCell<BTreeMap<Source, Rc<GridOfFile>>>,
}

impl GridFiles {
    /// The grid called `name` of the file at `path`, or without a name the only one there or that called `density`; `look` is
    /// told how far it has been read.
    ///
    /// # Errors
    /// As [`volume::read`]; and if there are more voxels than can be rendered.
    pub fn read(&self, path: &Path, name: Option<&str>, look: &dyn Fn(u64, u64)) -> Result<Rc<GridOfFile>> {
        // Whatever its path is, the file is one.
        let file = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let asked = (file.clone(), name.map(str::to_string));
        if let Some(grid) = self.held(&asked) {
            return Ok(grid);
        }
        let voxels = volume::read(path, name, look)?;
        let called = (file, Some(voxels.name.clone()));
        let grid = match self.held(&called) {
            Some(grid) => grid,
            None => Rc::new(GridOfFile::of(&voxels).ok_or_else(|| {
                let finding = format!("grid {} has more voxels than can be rendered", quoted(&voxels.name));
                Error::failure(path.display(), finding, "resample the grid to larger voxels")
            })?),
        };
        self.read.borrow_mut().extend([(asked, Rc::clone(&grid)), (called, Rc::clone(&grid))]);
        Ok(grid)
    }

    fn held(&self, source: &Source) -> Option<Rc<GridOfFile>> {
        self.read.borrow().get(source).cloned()
    }
}

impl GridOfFile {
    /// That of these voxels; none if there are too many.
    fn of(voxels: &VoxelGrid) -> Option<Self> {
        let (densities, bricks_spanned) = (Densities::of(voxels), bricks_spanned(&voxels.leaves));
        let holds = densities.nothing().is_none() && bricks_spanned <= MOST_BRICKS;
        let bricks = if holds { Some(Arc::new(Bricks::try_new(&voxels.leaves)?)) } else { None };
        Some(Self { index_to_world: voxels.index_to_world, densities, bricks_spanned, bricks })
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
