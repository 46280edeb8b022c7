//! Ranges of the values that cameras, lights and materials have, in the scene file and in its model alike, and errors
//! that say where a value beyond them stands.

use core::fmt::Display;

use glam::DVec3;
use serde_json::Value;

use super::document::Document;
use crate::error::{Error, Result};
use crate::gltf::{LARGEST_COORDINATE, quoted};

/// Largest length, coordinate and coefficient: squares of the longest flights between them, 16.6 mean free paths of the
/// thinnest medium, are still f32.
pub const LARGEST: f64 = LARGEST_COORDINATE;
/// Smallest radius: one over its area is still f32, and so is that times the square of the largest distance.
const SMALLEST_RADIUS: f64 = 1e-9;

/// Largest radiance: sums over paths stay far inside f32.
pub const LARGEST_RADIANCE: f64 = 1e30;

/// Largest emission of a medium [W/(m^3 sr)]: along the longest way it is still less than the largest radiance.
pub const LARGEST_EMISSION: f64 = 1e20;

/// What has a value: a camera, a light or a material.
#[derive(Debug)]
pub enum Owner<'a> {
    /// The table at this path of the scene file; the empty path is the file itself.
    Table(&'a Document, String),
    /// An object of the model: its file and name.
    Object(String),
}

impl Owner<'_> {
    /// The object `name` of the model `file`; `kind` is what such objects are called.
    pub fn object(file: &str, kind: &str, name: &str) -> Self {
        Self::Object(format!("{file}: {kind} {}", quoted(name)))
    }

    /// The error that the value of `key` is wrong.
    pub fn wrong(&self, key: &str, finding: impl Display, remedy: &str) -> Error {
        match self {
            Self::Table(document, path) => {
                let path =
                    [path.as_str(), key].into_iter().filter(|step| !step.is_empty()).collect::<Vec<_>>().join(".");
                document.error(&path, format!("{path} is {finding}"), remedy)
            }
            Self::Object(place) => Error::failure(place, format!("{key} is {finding}"), remedy),
        }
    }

    /// An error unless `ok`.
    pub fn require(&self, ok: bool, key: &str, finding: impl Display, remedy: &str) -> Result<()> {
        if ok { Ok(()) } else { Err(self.wrong(key, finding, remedy)) }
    }

    /// The point at `key`.
    pub fn position(&self, key: &str, value: [f64; 3]) -> Result<DVec3> {
        let ok = value.iter().all(|x| x.abs() <= LARGEST);
        self.require(ok, key, format!("{value:?}"), "give three finite coordinates from -1e9 to 1e9 m")?;
        Ok(DVec3::from(value))
    }

    /// The vector at `key`, which has a direction.
    pub fn direction(&self, key: &str, value: [f64; 3]) -> Result<DVec3> {
        let direction = DVec3::from(value);
        let ok = value.iter().all(|x| x.abs() <= LARGEST) && direction.length() > 1e-30;
        let remedy = "give a direction: three numbers from -1e9 to 1e9 that are not all 0";
        self.require(ok, key, format!("{value:?}"), remedy)?;
        Ok(direction)
    }

    /// The radius at `key`.
    pub fn radius(&self, key: &str, value: f64) -> Result<f64> {
        let ok = (SMALLEST_RADIUS..=LARGEST).contains(&value);
        self.require(ok, key, format!("{value:?}"), "give a radius from 1e-9 to 1e9 m")?;
        Ok(value)
    }

    /// The number under `key` of `extras`, its extras, if there is one.
    pub fn extra(&self, extras: Option<&Value>, key: &str) -> Result<Option<f64>> {
        let Some(value) = extras.and_then(|extras| extras.get(key)) else { return Ok(None) };
        let unit = if key.ends_with("_deg") { "degrees" } else { "metres" };
        let remedy = &format!("give a number in {unit}, or leave it out");
        value.as_f64().map(Some).ok_or_else(|| self.wrong(&format!("extras.{key}"), value, remedy))
    }
}
