//! `[[volume]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Medium, Phase, Spectrum, phase, values};

/// `[[volume]]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Volume {
    /// What fogbow info calls it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A medium by name, as for medium.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "name"))]
    pub preset: Option<String>,
    /// Scattering coefficient where the density is 1 [1/m], >= 0. Extinction (scattering + absorption) may differ between
    /// channels, in every medium in another way; rendering is fastest where the media of a scene have their factors in
    /// common. A channel that is clearer than a millionth of the densest is given that much.
    #[serde(default)]
    pub scattering: Spectrum,
    /// Absorption coefficient where the density is 1 [1/m], >= 0.
    #[serde(default)]
    pub absorption: Spectrum,
    /// What it emits by itself where the density of emission_grid is 1, or everywhere in the volume without one
    /// [W/(m^3 sr)], >= 0: radiance per metre. It needs no extinction.
    #[serde(default, skip_serializing_if = "Spectrum::is_black")]
    #[schemars(extend("default" = 0.0))]
    pub emission: Spectrum,
    /// How a scattering event redirects light in it. Other media of the scene may have other phase functions.
    #[serde(default, deserialize_with = "phase::table_or_name")]
    pub phase: Phase,
    /// What bounds it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Densities, which multiply scattering and absorption. Without a shape, the volume is where they are not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
    /// Densities, which multiply emission, with the keys of grid; where it is does not depend on grid. Nothing is emitted
    /// outside of the volume, which, if it has neither shape nor grid, is where these densities are not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission_grid: Option<Grid>,
    /// Of volumes that overlap, a point is in the one of the highest priority, and of equal ones in the last of the file.
    #[serde(default)]
    pub priority: i32,
}

/// `[[volume]] shape`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// The shape.
    #[serde(rename = "type")]
    pub kind: ShapeKind,
    /// For a box only: corner with the smallest coordinates `[m]`.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub min: Option<[f64; 3]>,
    /// For a box only: corner with the largest coordinates `[m]`.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub max: Option<[f64; 3]>,
    /// For a sphere only: centre `[m]`.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub center: Option<[f64; 3]>,
    /// For a sphere only: radius `[m]`, > 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub radius: Option<f64>,
    /// For a mesh only: name of a closed mesh of the geometry, which is then no surface any more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "name"))]
    pub name: Option<String>,
}

/// Shapes of volumes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeKind {
    /// A box with its edges along the axes.
    Box,
    /// A ball.
    Sphere,
    /// The inside of a closed mesh.
    Mesh,
}

impl ShapeKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Sphere => "sphere",
            Self::Mesh => "mesh",
        }
    }
}

/// `[[volume]] grid`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// An OpenVDB file, relative to the scene file. Its own transform counts.
    pub file: String,
    /// The grid's name. Absent: the file's only grid, or the one called "density".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "name"))]
    pub name: Option<String>,
    /// Multiplies densities, > 0.
    #[serde(default = "Grid::one")]
    pub scale: f64,
    /// How densities between voxels are found.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// By how much the grid is enlarged, about the origin of the file, > 0.
    #[serde(default = "Grid::one")]
    pub scale_by: f64,
    /// By how many degrees it is then turned about the x axis, the y axis and the z axis, one after the other.
    #[serde(default, deserialize_with = "values::entries")]
    pub rotate_deg: [f64; 3],
    /// By how much it is then moved `[m]`.
    #[serde(default, deserialize_with = "values::entries")]
    pub translate: [f64; 3],
}

/// How densities between voxels are found.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Linearly between the centres of the eight nearest voxels.
    #[default]
    Trilinear,
    /// That of the voxel a point is in.
    Nearest,
}

impl Grid {
    fn one() -> f64 {
        1.0
    }
}

impl Volume {
    /// Its keys as those of a medium.
    pub fn medium(&self) -> Medium {
        let Self { preset, scattering, absorption, emission, phase, .. } = self.clone();
        Medium { preset, scattering, absorption, emission, phase }
    }

    /// Replaces them.
    pub fn set_medium(&mut self, medium: Medium) {
        let Medium { preset, scattering, absorption, emission, phase } = medium;
        *self = Self { preset, scattering, absorption, emission, phase, ..self.clone() };
    }
}
