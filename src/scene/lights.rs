//! Lights of a scene: where their values are, and what connections make of them.

use fogbow_kernels::tables::lights::{Emitter, Source};
use glam::DVec3;

use super::document::Document;
use super::ranges::{LARGEST_RADIANCE, Owner};
use super::schema::{Light, LightKind, Scene, Spectrum};
use crate::error::Result;

/// Largest exponent of a spot: a cone of one degree.
pub const LARGEST_EXPONENT: f64 = 10_000.0;
/// Angle from the centre of our own sun to its rim, in degrees.
pub const ANGULAR_RADIUS: f64 = 0.265;
/// Least angle: single precision knows directions to a hundredth of it.
const LEAST_ANGULAR_RADIUS: f64 = 0.001;

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

/// All that shines in a scene, but its surfaces.
pub struct Shining<'a> {
    /// Its lights.
    pub placed: &'a [Placed<'a>],
    /// Its sky.
    pub sky: Option<Source>,
}

/// The lights of the file of `scene`.
pub fn of_file<'a>(scene: &Scene, document: &'a Document) -> impl Iterator<Item = Placed<'a>> {
    scene.light.iter().enumerate().map(|(index, light)| {
        let owner = Owner::Table(document, format!("light[{index}]"));
        Placed { owner, name: None, light: light.clone() }
    })
}

/// What connections connect with, of a light that has a place, with valid values, counted from `origin`.
pub fn emitter(owner: &Owner<'_>, light: &Light, origin: DVec3) -> Result<Emitter> {
    let remedy = "leave it out, or write type = \"sun\"";
    let Light { kind, direction, irradiance, angular_radius_deg, .. } = light;
    foreign(owner, *kind, "direction", direction.is_some(), remedy)?;
    foreign(owner, *kind, "irradiance", irradiance.is_some(), remedy)?;
    foreign(owner, *kind, "angular_radius_deg", angular_radius_deg.is_some(), remedy)?;
    let center = required(owner, *kind, "center", light.center, "give the position of its centre, [x, y, z]")?;
    let center = owner.position("center", center)? - origin;
    let radius = required(owner, *kind, "radius", light.radius, "give a radius from 1e-9 to 1e9 m")?;
    let radius = owner.radius("radius", radius)?;
    let remedy = "give a finite radiance from 0 to 1e30 W/(m^2 sr)";
    let Spectrum(radiance) = required(owner, *kind, "radiance", light.radiance, remedy)?;
    let ok = radiance.iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
    owner.require(ok, "radiance", Spectrum(radiance), remedy)?;
    let (normal, exponent) = (normal(owner, light)?, exponent(owner, light)?);
    let Some(normal) = normal else { return Ok(Emitter::sphere(center, radius, radiance)) };
    let disk = Emitter::disk(center, normal, radius, radiance);
    Ok(match (exponent, light.cone) {
        (None, _) => disk,
        (Some(exponent), None) => disk.focused(exponent),
        (Some(exponent), Some(cone)) => disk.with_cone(cone, exponent),
    })
}

/// What shines, of a sun with valid values.
pub fn sun(owner: &Owner<'_>, light: &Light) -> Result<Source> {
    let Light { kind, center, normal, radius, radiance, exponent, .. } = light;
    let given = [
        ("center", center.is_some()),
        ("normal", normal.is_some()),
        ("radius", radius.is_some()),
        ("radiance", radiance.is_some()),
        ("exponent", exponent.is_some()),
    ];
    for (key, given) in given {
        foreign(owner, *kind, key, given, "leave it out: a sun has direction, irradiance and angular_radius_deg")?;
    }
    let remedy = "give the direction in which it shines, [x, y, z]";
    let direction = required(owner, *kind, "direction", light.direction, remedy)?;
    let direction = owner.direction("direction", direction)?;
    let degrees = light.angular_radius_deg.unwrap_or(ANGULAR_RADIUS);
    let ok = (LEAST_ANGULAR_RADIUS..90.0).contains(&degrees);
    let remedy = "give an angle from 0.001 to below 90 degrees";
    owner.require(ok, "angular_radius_deg", format!("{degrees:?}"), remedy)?;
    let remedy = "give a finite irradiance of 0 W/m^2 or more, whose radiance is at most 1e30 W/(m^2 sr)";
    let irradiance = required(owner, *kind, "irradiance", light.irradiance, remedy)?;
    let source = Source::Sun { direction, irradiance: irradiance.0, angular_radius: degrees.to_radians() };
    let ok = source.radiance().iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
    owner.require(ok, "irradiance", irradiance, remedy)?;
    Ok(source)
}

/// The value of a key that lights of this kind have.
fn required<T>(owner: &Owner<'_>, kind: LightKind, key: &str, value: Option<T>, remedy: &str) -> Result<T> {
    value.ok_or_else(|| owner.wrong(key, format!("missing, but the light is a {}", kind.name()), remedy))
}

/// An error if a key is given that lights of this kind do not have.
fn foreign(owner: &Owner<'_>, kind: LightKind, key: &str, given: bool, remedy: &str) -> Result<()> {
    owner.require(!given, key, format!("given, but the light is a {}", kind.name()), remedy)
}

/// The normal of a disk or spot; none of others.
fn normal(owner: &Owner<'_>, light: &Light) -> Result<Option<DVec3>> {
    match (light.kind, light.normal) {
        (LightKind::Sphere | LightKind::Sun, None) => Ok(None),
        (kind @ (LightKind::Sphere | LightKind::Sun), Some(normal)) => {
            let remedy = "leave the normal out: a sphere emits in all directions";
            Err(owner.wrong("normal", format!("{normal:?}, but the light is a {}", kind.name()), remedy))
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
        (LightKind::Disk | LightKind::Sphere | LightKind::Sun, None) => Ok(None),
        (kind @ (LightKind::Disk | LightKind::Sphere | LightKind::Sun), Some(exponent)) => {
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
