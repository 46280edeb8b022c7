//! What volumes hold, for whoever wants to know: nothing of it is rendered.

use glam::{DAffine3, DVec3};

use crate::volume::VoxelGrid;

/// What a volume of a scene holds, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Filling {
    /// Smallest and largest coordinates of its shape, or of the voxels that are not 0 `[m]`.
    pub bounds: [[f64; 3]; 2],
    /// Mean cosine of its scattering events.
    pub mean_cosine: f64,
    /// What is in its grid, if it has one.
    pub densities: Option<Densities>,
    /// What is in the grid of its emission, if it has one.
    pub glowing: Option<Densities>,
    /// Bytes that it takes.
    pub bytes: usize,
}

/// What a grid holds, as its file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Densities {
    /// Voxels that the file calls active.
    pub active_voxels: u64,
    /// Mean density of these.
    pub mean: f64,
    /// Largest density.
    pub most: f32,
    /// Smallest and largest coordinates of the voxels that are not 0, each of which reaches half an edge beyond its
    /// centre `[m]`.
    pub bounds: [DVec3; 2],
}

impl Densities {
    /// Those of `grid`, whose index coordinates lead `to_world`.
    pub fn of(grid: &VoxelGrid, to_world: &DAffine3) -> Self {
        let (mut sum, mut most, mut active) = (0.0, 0.0_f32, 0_u64);
        let (mut first, mut last) = ([i32::MAX; 3], [i32::MIN; 3]);
        for leaf in &grid.leaves {
            for (index, value) in leaf.values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                (sum, most, active) = (sum + f64::from(*value), most.max(*value), active + 1);
                for (axis, offset) in [index & 7, index >> 3 & 7, index >> 6].into_iter().enumerate() {
                    let at = leaf.origin[axis] + offset as i32;
                    (first[axis], last[axis]) = (first[axis].min(at), last[axis].max(at));
                }
            }
        }
        let active_voxels = grid.active_voxels.max(active);
        let mean = sum / active_voxels.max(1) as f64;
        let corners = if active > 0 { [first, last] } else { [[0; 3]; 2] };
        let [low, high] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        Self { active_voxels, mean, most, bounds: around(to_world, [low - 0.5, high + 0.5]) }
    }
}

/// The box around a box that was moved and turned by `map`.
fn around(map: &DAffine3, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let corners = (0..8).map(|corner| {
        let [x, y, z] = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
        map.transform_point3(DVec3::new(x, y, z))
    });
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    corners.fold(none, |[min, max], corner| [min.min(corner), max.max(corner)])
}
