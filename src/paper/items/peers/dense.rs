//! Grids of volumes as other programs take them: all voxels of a box with its edges along the axes.

use glam::{DMat3, DVec3};

use crate::scene::schema::Grid;
use crate::volume::VoxelGrid;

/// Most voxels, empty ones included.
const MOST: u64 = 1 << 28;

/// A box of voxels, those that are not 0 and one more on every side.
#[derive(Debug, PartialEq)]
pub struct Dense {
    /// Voxels along x, y and z.
    pub counts: [usize; 3],
    /// First and last corner of the box: outer faces of the outermost voxels `[m]`.
    pub corners: [[f64; 3]; 2],
    /// Densities; x runs fastest, then y.
    pub densities: Vec<f32>,
}

impl Dense {
    /// `voxels` in the place that `grid` gives them. Or why that does not work.
    pub fn of(voxels: &VoxelGrid, grid: &Grid) -> Result<Self, String> {
        let to_world = voxels.index_to_world;
        if grid.rotate_deg != [0.0; 3] || to_world.matrix3 != DMat3::from_diagonal(to_world.matrix3.diagonal()) {
            return Err(format!("{} is turned", grid.file));
        }
        let Some([first, last]) = voxels.index_bounds() else { return Err(format!("{} is empty", grid.file)) };
        let (low, high) = (first.map(|i| i64::from(i) - 1), last.map(|i| i64::from(i) + 2));
        let counts = [0, 1, 2].map(|axis| (high[axis] - low[axis]) as u64);
        if counts.into_iter().fold(1, u64::saturating_mul) > MOST {
            return Err(format!("{} has more than {MOST} voxels, empty ones included", grid.file));
        }
        let corner = |index: [i64; 3]| {
            let at = to_world.transform_point3(DVec3::from(index.map(|i| i as f64)) - 0.5);
            (grid.scale_by * at + DVec3::from(grid.translate)).to_array()
        };
        let counts = counts.map(|count| count as usize);
        Ok(Self { counts, corners: [low, high].map(corner), densities: densities(voxels, low, counts) })
    }
}

/// All voxels from `low` on.
fn densities(voxels: &VoxelGrid, low: [i64; 3], counts: [usize; 3]) -> Vec<f32> {
    let mut dense = vec![0.0; counts.iter().product()];
    for leaf in &voxels.leaves {
        for (index, value) in leaf.values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let offset = [index & 7, index >> 3 & 7, index >> 6];
            let [x, y, z] = [0, 1, 2].map(|axis| (i64::from(leaf.origin[axis]) - low[axis]) as usize + offset[axis]);
            dense[(z * counts[1] + y) * counts[0] + x] = *value;
        }
    }
    dense
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::scene::schema::Interpolation;
    use crate::volume::Leaf;

    /// Two voxels, (-1, 0, 2) and (1, 3, 2), whose edges are 0.5 m, twice as large and elsewhere.
    #[test]
    fn voxels_and_one_more_on_every_side_are_in_their_place() {
        let leaf = |origin, at: usize, density: f32| {
            let mut values = [0.0; 512];
            values[at] = density;
            Leaf { origin, values: values.into() }
        };
        let voxels = VoxelGrid {
            name: "density".into(),
            index_to_world: DAffine3::from_scale(DVec3::splat(0.5)),
            leaves: vec![leaf([-8, 0, 0], 2 * 64 + 7, 3.0), leaf([0; 3], 2 * 64 + 3 * 8 + 1, 4.0)],
            active_voxels: 2,
        };
        let mut grid = Grid {
            file: "a.vdb".into(),
            name: None,
            scale: 1.0,
            interpolation: Interpolation::Trilinear,
            scale_by: 2.0,
            rotate_deg: [0.0; 3],
            translate: [10.0, 20.0, 30.0],
        };
        let dense = Dense::of(&voxels, &grid).expect("voxels");
        assert_eq!(dense.counts, [5, 6, 3]);
        assert_eq!(dense.corners, [[7.5, 18.5, 30.5], [12.5, 24.5, 33.5]]);
        let at = |x: usize, y: usize, z: usize| (z * 6 + y) * 5 + x;
        let filled = dense.densities.iter().enumerate().filter(|(_, density)| **density != 0.0);
        assert_eq!(filled.collect::<Vec<_>>(), [(at(1, 1, 1), &3.0), (at(3, 4, 1), &4.0)]);
        grid.rotate_deg[1] = 90.0;
        assert_eq!(Dense::of(&voxels, &grid), Err("a.vdb is turned".into()));
    }
}
