//! Lights of a scene: where their values are, and what connections make of them.

use fogbow_kernels::tables::lights::Emitter;
use glam::DVec3;

use super::document::Document;
use super::ranges::{LARGEST_RADIANCE, Owner};
use super::schema::{Light, LightKind, Scene, Spectrum};
use crate::error::Result;

/// Largest exponent of a spot: a cone of one degree.
pub const LARGEST_EXPONENT: f64 = 10_000.0;

/// A light and where it comes from.
#[derive(Debug)]
pub struct Placed<'a> {
    /// What has its values.
    pub owner: Owner<'a>,
    /// Its name in the model.
    pub name: Option<String>,
    /// Its values.
    pub light: Light,
}

/// The lights of the file of `scene`.
pub fn of_file<'a>(scene: &Scene, document: &'a Document) -> impl Iterator<Item = Placed<'a>> {
    scene.light.iter().enumerate().map(|(index, light)| {
        let owner = Owner::Table(document, format!("light[{index}]"));
        Placed { owner, name: None, light: light.clone() }
    })
}

/// What connections connect with, of a light with valid values, counted from `origin`.
pub fn emitter(owner: &Owner<'_>, light: &Light, origin: DVec3) -> Result<Emitter> {
    let center = owner.position("center", light.center)? - origin;
    let radius = owner.radius("radius", light.radius)?;
    let Spectrum(radiance) = light.radiance;
    let ok = radiance.iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
    let remedy = "give a finite radiance from 0 to 1e30 W/(m^2 sr)";
    owner.require(ok, "radiance", light.radiance, remedy)?;
    let (normal, exponent) = (normal(owner, light)?, exponent(owner, light)?);
    let Some(normal) = normal else { return Ok(Emitter::sphere(center, radius, radiance)) };
    let disk = Emitter::disk(center, normal, radius, radiance);
    Ok(match (exponent, light.cone) {
        (None, _) => disk,
        (Some(exponent), None) => disk.focused(exponent),
        (Some(exponent), Some(cone)) => disk.with_cone(cone, exponent),
    })
}

/// The normal of a disk or spot; none of a sphere.
fn normal(owner: &Owner<'_>, light: &Light) -> Result<Option<DVec3>> {
    match (light.kind, light.normal) {
        (LightKind::Sphere, None) => Ok(None),
        (LightKind::Sphere, Some(normal)) => {
            let remedy = "leave the normal out: a sphere emits in all directions";
            Err(owner.wrong("normal", format!("{normal:?}, but the light is a sphere"), remedy))
        }
        (LightKind::Disk | LightKind::Spot, Some(normal)) => owner.direction("normal", normal).map(Some),
        (kind @ (LightKind::Disk | LightKind::Spot), None) => {
            let finding = format!("missing, but the light is a {}", kind.name());
            Err(owner.wrong("normal", finding, "give the direction that the front faces, [x, y, z]"))
        }
    }
}

/// The exponent of a spot; none of the other kinds.
fn exponent(owner: &Owner<'_>, light: &Light) -> Result<Option<f64>> {
    match (light.kind, light.exponent) {
        (LightKind::Disk | LightKind::Sphere, None) => Ok(None),
        (kind @ (LightKind::Disk | LightKind::Sphere), Some(exponent)) => {
            let kind = kind.name();
            let remedy = format!("write type = \"spot\", or leave the exponent out: a {kind} is not focused");
            Err(owner.wrong("exponent", format!("{exponent:?}, but the light is a {kind}"), &remedy))
        }
        (LightKind::Spot, None) => {
            Err(owner.wrong("exponent", "missing, but the light is a spot", "give an exponent from 0 to 10000"))
        }
        (LightKind::Spot, Some(exponent)) => {
            let ok = (0.0..=LARGEST_EXPONENT).contains(&exponent);
            owner.require(ok, "exponent", format!("{exponent:?}"), "give an exponent from 0 to 10000")?;
            Ok(Some(exponent))
        }
    }
}
