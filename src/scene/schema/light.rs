//! `[[light]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Spectrum, values};

/// `[[light]]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// What it is.
    #[serde(rename = "type")]
    pub kind: LightKind,
    /// Centre `[m]`; not of a sun.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub center: Option<[f64; 3]>,
    /// For a disk or spot: the direction that the front faces, of any length but 0.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub normal: Option<[f64; 3]>,
    /// Radius `[m]`, > 0; not of a sun.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub radius: Option<f64>,
    /// Radiance of the surface or front [W/(m^2 sr)], >= 0; not of a sun. For a spot this is what gets focused: its
    /// front emits radiance * (exponent + 1) / (2 pi) * cos^exponent of the angle to the normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radiance: Option<Spectrum>,
    /// For a spot only: how narrow it is, 0 to 10000; larger is narrower.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub exponent: Option<f64>,
    /// For a sun: the direction in which it shines, of any length but 0.
    #[serde(default, deserialize_with = "values::some_entries", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "[x, y, z]"))]
    pub direction: Option<[f64; 3]>,
    /// For a sun: irradiance of a plane that faces it, with nothing in between [W/m^2], >= 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irradiance: Option<Spectrum>,
    /// For a sun: angle from its centre to its rim, from 0.001 to below 90 degrees. Absent: 0.265, that of our own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub angular_radius_deg: Option<f64>,
    /// Inner and outer angle of a spot of a model `[rad]`, which has the intensity of its cone instead of a power of
    /// the cosine.
    #[serde(skip)]
    pub cone: Option<[f64; 2]>,
}

/// Kinds of lights.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A flat disk whose front emits the same radiance in all directions; its back is black and opaque.
    Disk,
    /// The same, focused around its normal.
    Spot,
    /// A sphere whose whole surface emits the same radiance in all directions.
    Sphere,
    /// A disk in the sky, infinitely far away; the sky behind it adds to it. It goes with the same media as environment.
    Sun,
}

impl LightKind {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Disk => "disk",
            Self::Spot => "spot",
            Self::Sphere => "sphere",
            Self::Sun => "sun",
        }
    }
}

impl Light {
    /// A light of this kind without values.
    pub fn of(kind: LightKind) -> Self {
        Self {
            kind,
            center: None,
            normal: None,
            radius: None,
            radiance: None,
            exponent: None,
            direction: None,
            irradiance: None,
            angular_radius_deg: None,
            cone: None,
        }
    }
}
