//! `[[volume]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Medium, Phase, Spectrum, phase, values};

/// `[[volume]]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Volume {
    /// What messages call it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// A medium by name, as for medium.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "name"))]
    pub preset: Option<String>,
    /// Scattering coefficient where the density is 1 [1/m], >= 0. Scattering + absorption is the same in all channels.
    #[serde(default)]
    pub scattering: Spectrum,
    /// Absorption coefficient where the density is 1 [1/m], >= 0.
    #[serde(default)]
    pub absorption: Spectrum,
    /// How a scattering event redirects light.
    #[serde(default, deserialize_with = "phase::table_or_name")]
    pub phase: Phase,
    /// What bounds a medium that is the same everywhere inside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Densities, which multiply scattering and absorption; 0 outside. A volume has either a shape or a grid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
}

/// `[[volume]] shape`
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// The shape.
    #[serde(rename = "type")]
    pub kind: ShapeKind,
    /// Corner with the smallest coordinates `[m]`.
    #[serde(deserialize_with = "values::entries")]
    pub min: [f64; 3],
    /// Corner with the largest coordinates `[m]`.
    #[serde(deserialize_with = "values::entries")]
    pub max: [f64; 3],
}

/// Shapes of volumes.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeKind {
    /// A box with its edges along the axes.
    Box,
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
        let Self { preset, scattering, absorption, phase, .. } = self.clone();
        Medium { preset, scattering, absorption, phase }
    }

    /// Replaces them.
    pub fn set_medium(&mut self, medium: Medium) {
        let Medium { preset, scattering, absorption, phase } = medium;
        *self = Self { preset, scattering, absorption, phase, ..self.clone() };
    }
}
