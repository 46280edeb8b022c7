//! Media with grids: from a file of voxels to the densities that stages read.

use fogbow_kernels::media::Medium;
use fogbow_kernels::media::grid::{Grid, Interpolation, ToIndex};
use glam::{DAffine3, DQuat, DVec3, EulerRot};

use super::document::Document;
use super::ranges::LARGEST;
use super::schema;
use crate::error::{Error, Result};
use crate::volume::{self, VoxelGrid};

/// Largest factor of densities or sizes.
const LARGEST_SCALE: f64 = 1e9;

/// A volume of the scene file, and where errors find its keys.
pub struct Volume<'a> {
    /// The file.
    pub document: &'a Document,
    /// Where the volume stands in it.
    pub table: String,
    /// Its keys.
    pub keys: &'a schema::Volume,
}

impl Volume<'_> {
    /// The medium, with coefficients for a density of 1 as in `coefficients`, of positions counted from `origin`.
    ///
    /// # Errors
    /// If a key is out of range, extinction is coloured, or the file cannot be read.
    pub fn medium(&self, coefficients: Medium, origin: DVec3) -> Result<Medium> {
        let finding =
            "an extinction (scattering + absorption) that differs between channels, which grids cannot have yet";
        let remedy = "make scattering + absorption the same in all channels; their shares may differ";
        self.require(!coefficients.is_coloured(), "scattering", finding, remedy)?;
        let grid = &self.keys.grid;
        for (key, scale) in [("grid.scale", grid.scale), ("grid.scale_by", grid.scale_by)] {
            let ok = scale > 0.0 && scale <= LARGEST_SCALE;
            self.require(ok, key, format!("{scale:?}"), "give a number above 0, up to 1e9")?;
        }
        let ok = grid.translate.iter().all(|x| x.abs() <= LARGEST);
        let finding = format!("{:?}", grid.translate);
        self.require(ok, "grid.translate", finding, "give three finite coordinates from -1e9 to 1e9 m")?;
        let ok = grid.rotate_deg.iter().all(|x| x.abs() <= 360.0);
        let finding = format!("{:?}", grid.rotate_deg);
        self.require(ok, "grid.rotate_deg", finding, "give three angles from -360 to 360 degrees")?;
        let unit = f64::from(coefficients.largest_extinction()) * grid.scale;
        let voxels = self.voxels()?;
        let Some(unit) = Some(unit as f32).filter(|unit| *unit > 0.0 && !voxels.leaves.is_empty()) else {
            return Ok(Medium::vacuum());
        };
        let interpolation = match grid.interpolation {
            schema::Interpolation::Trilinear => Interpolation::Trilinear,
            schema::Interpolation::Nearest => Interpolation::Nearest,
        };
        let grid = Grid::new(&voxels.leaves, &self.to_index(&voxels, origin)?, unit, interpolation);
        Ok(Medium::grid_of(grid, coefficients.albedo, coefficients.phase))
    }

    fn voxels(&self) -> Result<VoxelGrid> {
        let path = self.document.folder().join(&self.keys.grid.file);
        volume::read(&path, self.keys.grid.name.as_deref(), &|_, _| {})
    }

    /// From positions counted from `origin` to index coordinates.
    fn to_index(&self, voxels: &VoxelGrid, origin: DVec3) -> Result<ToIndex> {
        let grid = &self.keys.grid;
        let [x, y, z] = grid.rotate_deg.map(f64::to_radians);
        let turned = DQuat::from_euler(EulerRot::XYZEx, x, y, z);
        let placed = DAffine3::from_scale_rotation_translation(
            DVec3::splat(grid.scale_by),
            turned,
            DVec3::from(grid.translate) - origin,
        );
        let to_index = (placed * voxels.index_to_world).inverse();
        let finding = format!("{:?} of the file and of its transform, too much or too little for f32", grid.scale_by);
        let sound = to_index.is_finite() && to_index.matrix3.to_cols_array().iter().all(|entry| entry.abs() < 1e12);
        self.require(sound, "grid.scale_by", finding, "enlarge it by another factor")?;
        let columns = to_index.matrix3.to_cols_array_2d();
        let moved = to_index.translation.to_array();
        Ok([0, 1, 2].map(|row| [columns[0][row], columns[1][row], columns[2][row], moved[row]]))
    }

    fn require(&self, ok: bool, key: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        let path = format!("{}.{key}", self.table);
        if ok { Ok(()) } else { Err(self.document.error(&path, format!("{path} is {finding}"), remedy)) }
    }
}

/// The error that a scene has what volumes do not go with yet, if it does.
pub fn refused(scene: &schema::Scene, document: &Document) -> Option<Error> {
    let around = scene.medium.as_ref().filter(|_| !scene.volume.is_empty());
    if around.is_some_and(|medium| medium.scattering.0 != [0.0; 3] || medium.absorption.0 != [0.0; 3]) {
        let finding = "medium is given beside a volume, but so far volumes are in vacuum";
        return Some(document.error("medium", finding, "leave out one of the two"));
    }
    (scene.volume.len() > 1).then(|| {
        let finding = format!("there are {} volumes, but so far a scene has one at most", scene.volume.len());
        document.error("volume[1]", finding, "leave out all but one")
    })
}
