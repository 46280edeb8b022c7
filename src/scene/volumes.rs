//! Media with bounds: from a box, or a file of voxels, to the densities that stages read.

use fogbow_kernels::media::Medium;
use fogbow_kernels::media::grid::{Grid, Interpolation, ToIndex};
use glam::{DAffine3, DQuat, DVec3, EulerRot};

use super::document::Document;
use super::ranges::LARGEST;
use super::schema;
use crate::error::{Error, Result};
use crate::volume::{self, Leaf, VoxelGrid};

/// Largest factor of densities or sizes.
const LARGEST_SCALE: f64 = 1e9;
/// Most bricks of 8^3 voxels, empty ones included, between voxels that are far apart: their table takes 1.5 GiB.
const MOST_BRICKS: u64 = 1 << 27;
/// Shortest edge of a box `[m]`.
const SMALLEST_EDGE: f64 = 1e-6;

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
    /// If a key is out of range or missing, extinction is coloured, or the file cannot be read.
    pub fn medium(&self, coefficients: Medium, origin: DVec3) -> Result<Medium> {
        let finding =
            "an extinction (scattering + absorption) that differs between channels, which volumes cannot have yet";
        let remedy = "make scattering + absorption the same in all channels; their shares may differ";
        self.require(!coefficients.is_coloured(), "scattering", finding, remedy)?;
        let extinction = coefficients.largest_extinction();
        let grid = match (&self.keys.shape, &self.keys.grid) {
            (Some(shape), None) => self.block(shape, extinction, origin)?,
            (None, Some(grid)) => self.voxels(grid, extinction, origin)?,
            (shape, _) => {
                let found = if shape.is_some() { "both a shape and a grid" } else { "neither a shape nor a grid" };
                let remedy = "give it a shape, or a grid, which is bounded by its own box";
                return Err(self.document.error(&self.table, format!("{} has {found}", self.table), remedy));
            }
        };
        Ok(grid.map_or(Medium::vacuum(), |grid| Medium::grid_of(grid, coefficients.albedo, coefficients.phase)))
    }

    /// A medium that is the same everywhere in a box; none in vacuum.
    fn block(&self, shape: &schema::Shape, extinction: f32, origin: DVec3) -> Result<Option<Grid>> {
        for (key, corner) in [("shape.min", shape.min), ("shape.max", shape.max)] {
            let ok = corner.iter().all(|x| x.abs() <= LARGEST);
            self.require(ok, key, format!("{corner:?}"), "give three finite coordinates from -1e9 to 1e9 m")?;
        }
        let ok = (0..3).all(|axis| shape.max[axis] - shape.min[axis] >= SMALLEST_EDGE);
        let finding = format!("{:?}, where min is {:?}", shape.max, shape.min);
        self.require(
            ok,
            "shape.max",
            finding,
            "make each of its coordinates larger than that of min by 1e-6 m or more",
        )?;
        let corners = [shape.min, shape.max].map(|corner| (DVec3::from(corner) - origin).to_array());
        Ok((extinction > 0.0).then(|| Grid::block(corners, extinction)))
    }

    /// The grid of a file, in its place; none in vacuum.
    fn voxels(&self, grid: &schema::Grid, extinction: f32, origin: DVec3) -> Result<Option<Grid>> {
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
        let path = self.document.folder().join(&grid.file);
        let voxels = volume::read(&path, grid.name.as_deref(), &|_, _| {})?;
        let unit = (f64::from(extinction) * grid.scale) as f32;
        if unit == 0.0 || voxels.leaves.is_empty() {
            return Ok(None);
        }
        let bricks = bricks_spanned(&voxels.leaves);
        let finding = format!("a grid whose voxels are so far apart that {bricks} bricks of 8x8x8 lie between them");
        let remedy = format!("crop or resample the grid to at most {MOST_BRICKS} bricks");
        self.require(bricks <= MOST_BRICKS, "grid.file", finding, &remedy)?;
        let interpolation = match grid.interpolation {
            schema::Interpolation::Trilinear => Interpolation::Trilinear,
            schema::Interpolation::Nearest => Interpolation::Nearest,
        };
        let to_index = self.to_index(grid, &voxels, origin)?;
        let densest =
            voxels.leaves.iter().flat_map(|leaf| leaf.values.iter()).fold(0.0, |most: f32, value| most.max(*value));
        let finding =
            format!("{:?}, which makes an extinction of {:e}/m", grid.scale, f64::from(densest) * f64::from(unit));
        let remedy = "give a smaller number: extinction goes up to 1e9/m";
        self.require(f64::from(densest) * f64::from(unit) <= LARGEST, "grid.scale", finding, remedy)?;
        Ok(Some(Grid::new(&voxels.leaves, &to_index, unit, interpolation)))
    }

    /// From positions counted from `origin` to index coordinates.
    fn to_index(&self, grid: &schema::Grid, voxels: &VoxelGrid, origin: DVec3) -> Result<ToIndex> {
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

/// Bricks, empty ones included, from the first leaf to the last along every axis, with one more below.
fn bricks_spanned(leaves: &[Leaf]) -> u64 {
    let along = |axis: usize| {
        let brick = |leaf: &Leaf| i64::from(leaf.origin[axis].div_euclid(8));
        let (first, last) = (leaves.iter().map(brick).min(), leaves.iter().map(brick).max());
        first.zip(last).map_or(0, |(first, last)| (last - first + 2) as u64)
    };
    (0..3).map(along).fold(1, u64::saturating_mul)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voxels_far_apart_span_more_bricks_than_there_are() {
        let leaf = |origin: [i32; 3]| Leaf { origin, values: Box::new([1.0; 512]) };
        assert_eq!(bricks_spanned(&[leaf([0; 3])]), 8);
        assert_eq!(bricks_spanned(&[leaf([-8, 0, 0]), leaf([8, 0, 16])]), 4 * 2 * 4);
        let [least, most] = [i32::MIN, i32::MAX - 7];
        assert!(bricks_spanned(&[leaf([least; 3]), leaf([most; 3])]) > MOST_BRICKS);
    }
}
