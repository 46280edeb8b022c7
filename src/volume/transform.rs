//! From index coordinates to metres.

use glam::{DAffine3, DMat3, DVec3};

use super::input::Input;
use crate::gltf::LARGEST_COORDINATE;
use crate::gltf::fault::{Checked, Fault, quoted, require};

/// Shortest and longest edge of a voxel `[m]`.
const EDGES: core::ops::RangeInclusive<f64> = 1e-9..=LARGEST_COORDINATE;
/// Longest edge of a voxel, in units of its shortest.
const LONGEST: f64 = 1e6;
/// Smallest volume of a voxel, relative to a box of the same edges; edges of less are nearly in a plane.
const FLATTEST: f64 = 1e-6;
/// Largest difference from 0 or 1 of numbers that make a matrix affine.
const ROUNDING: f64 = 1e-12;
/// What to do about transforms that are not affine.
const RESAMPLE: &str = "resample the grid to one with a scale, a rotation and a translation";

/// The transform of a grid, as the file has it.
#[derive(Clone, Debug)]
pub struct Map {
    /// For example `UniformScaleMap`.
    pub name: String,
    /// None if maps of this name are not affine, or not known.
    matrix: Option<Matrix>,
}

/// Images of the axes and of the origin, each with the number that an affine matrix has as 0, or 1 for the origin.
type Matrix = [[f64; 4]; 4];

impl Map {
    /// Reads the name of a map, and its matrix if it has one; else the end of the map is not known.
    pub fn read(input: &mut Input) -> Checked<Self> {
        let name = input.text()?;
        let matrix = match name.as_str() {
            "AffineMap" | "UnitaryMap" => Some(matrix(input)?),
            "TranslationMap" => Some(diagonal([1.0; 3], vector(input)?)),
            // Numbers that follow from the scale stand behind it: voxel size, inverses.
            "ScaleMap" | "UniformScaleMap" => {
                let scale = vector(input)?;
                input.skip(4 * 24)?;
                Some(diagonal(scale, [0.0; 3]))
            }
            "ScaleTranslateMap" | "UniformScaleTranslateMap" => {
                let [translation, scale] = [vector(input)?, vector(input)?];
                input.skip(4 * 24)?;
                Some(diagonal(scale, translation))
            }
            _ => None,
        };
        Ok(Self { name, matrix })
    }

    /// Whether all of it was read.
    pub fn is_known(&self) -> bool {
        self.matrix.is_some()
    }

    /// World metres of index coordinates.
    pub fn affine(&self) -> Checked<DAffine3> {
        let Some(matrix) = self.matrix else {
            let what = if self.name == "NonlinearFrustumMap" { "a frustum" } else { "not an affine transform" };
            return Err(Fault::new(format!("its transform {} is {what}", quoted(&self.name)), RESAMPLE));
        };
        let last = matrix.map(|row| row[3]);
        let is_affine = (0..4).all(|row| (last[row] - f64::from(u8::from(row == 3))).abs() <= ROUNDING);
        require(is_affine, || format!("its transform is not affine: its last column is {last:?}"), RESAMPLE)?;
        let [x, y, z, origin] = matrix.map(|row| DVec3::new(row[0], row[1], row[2]));
        check(&[x, y, z], origin)?;
        Ok(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: origin })
    }
}

/// Whether a voxel of these edges has a sensible size and place.
fn check(edges: &[DVec3; 3], origin: DVec3) -> Checked<()> {
    let lengths = edges.map(DVec3::length);
    let (shortest, longest) = (EDGES.start(), EDGES.end());
    let finding = || format!("its voxels have edges of {lengths:?} m; {shortest:e} to {longest:e} m can be read");
    require(lengths.iter().all(|length| EDGES.contains(length)), finding, "give the grid another voxel size")?;
    let [least, most] = [f64::min, f64::max].map(|pick| lengths.into_iter().fold(lengths[0], pick));
    let finding = || format!("its voxels have edges of {lengths:?} m; one may be {LONGEST:e} times another at most");
    require(most <= LONGEST * least, finding, "resample the grid to voxels of more equal edges")?;
    let finding = || format!("its transform puts voxel [0, 0, 0] at {:?} m, which is too far away", origin.to_array());
    let is_near = origin.to_array().iter().all(|coordinate| coordinate.abs() <= LARGEST_COORDINATE);
    require(is_near, finding, "move the grid towards the origin")?;
    let [x, y, z] = *edges;
    let volume = x.cross(y).dot(z).abs() / lengths.iter().product::<f64>();
    let finding = || "its transform is singular: voxels have no volume";
    require(volume >= FLATTEST, finding, "give the grid a transform that can be inverted")
}

fn vector(input: &mut Input) -> Checked<[f64; 3]> {
    Ok([input.f64()?, input.f64()?, input.f64()?])
}

/// A matrix row by row. Vectors stand at its left.
fn matrix(input: &mut Input) -> Checked<Matrix> {
    let mut matrix = Matrix::default();
    for number in matrix.as_flattened_mut() {
        *number = input.f64()?;
    }
    Ok(matrix)
}

fn diagonal([x, y, z]: [f64; 3], [tx, ty, tz]: [f64; 3]) -> Matrix {
    [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [tx, ty, tz, 1.0]]
}
