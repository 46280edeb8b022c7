//! What volumes hold, for whoever wants to know: nothing of it is rendered.

use glam::{DAffine3, DVec3};

use crate::volume::VoxelGrid;

/// Densities up to this one are next to nothing, and the finest shares of voxels are lost to rounding in f32.
const NEXT_TO_NOTHING: f32 = 1e-40;

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
#[derive(Clone, Debug, PartialEq)]
pub struct Densities {
    /// What the file calls the grid.
    pub grid: String,
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
    /// Those of `grid`, in its index coordinates.
    pub fn of(grid: &VoxelGrid) -> Self {
        let (mut sum, mut most, mut active) = (0.0, 0.0_f32, 0_u64);
        for value in grid.leaves.iter().flat_map(|leaf| leaf.values.iter()).filter(|value| **value != 0.0) {
            (sum, most, active) = (sum + f64::from(*value), most.max(*value), active + 1);
        }
        let active_voxels = grid.active_voxels.max(active);
        let mean = sum / active_voxels.max(1) as f64;
        let [low, high] = grid.index_bounds().unwrap_or_default().map(|corner| DVec3::from(corner.map(f64::from)));
        Self { grid: grid.name.clone(), active_voxels, mean, most, bounds: [low - 0.5, high + 0.5] }
    }

    /// Why a grid of these is as good as empty, as it follows the name of the grid; none if it is not.
    pub fn nothing(&self) -> Option<&'static str> {
        match self.most {
            0.0 => Some("has no density above 0"),
            ..=NEXT_TO_NOTHING => Some("has no density above 1e-40, and smaller ones do not count"),
            _ => None,
        }
    }

    /// The same where index coordinates lead `to_world`.
    pub fn placed(&self, to_world: &DAffine3) -> Self {
        Self { bounds: around(to_world, self.bounds), ..self.clone() }
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
