//! The lights of a scene: its own, and those that stand for the punctual lights of its model.

use fogbow_kernels::tables::lights::Emitter;
use glam::DVec3;

use super::document::Document;
use super::model::Loaded;
use super::punctual;
use super::schema::{Light, LightKind, Scene, Spectrum};
use super::source::Source;
use crate::error::Result;

/// Largest radiance: sums over paths stay far inside f32.
pub const LARGEST_RADIANCE: f64 = 1e30;
/// Largest exponent of a spot: a cone of one degree.
pub const LARGEST_EXPONENT: f64 = 10_000.0;

/// A light and where it comes from.
#[derive(Debug)]
pub struct Placed<'a> {
    /// Where its values stand.
    pub source: Source<'a>,
    /// Its name in the model.
    pub name: Option<String>,
    /// Its values.
    pub light: Light,
}

/// All lights of `scene`, those of its file first.
pub fn all<'a>(scene: &Scene, document: &'a Document, loaded: Option<&Loaded>) -> Result<Vec<Placed<'a>>> {
    let radius = Source::Table(document, String::new()).radius("punctual_radius", scene.punctual_radius)?;
    let own = scene.light.iter().enumerate().map(|(index, light)| {
        let source = Source::Table(document, format!("light[{index}]"));
        Placed { source, name: None, light: light.clone() }
    });
    let of_model = loaded.map_or(Ok(Vec::new()), |loaded| punctual::lights(loaded, radius))?;
    Ok(own.chain(of_model).collect())
}

/// What connections connect with, of a light with valid values, counted from `origin`.
pub fn emitter(source: &Source<'_>, light: &Light, origin: DVec3) -> Result<Emitter> {
    let center = source.position("center", light.center)? - origin;
    let radius = source.radius("radius", light.radius)?;
    let Spectrum(radiance) = light.radiance;
    let ok = radiance.iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
    let remedy = "give a finite radiance from 0 to 1e30 W/(m^2 sr)";
    source.require(ok, "radiance", light.radiance, remedy)?;
    let (normal, exponent) = (normal(source, light)?, exponent(source, light)?);
    let Some(normal) = normal else { return Ok(Emitter::sphere(center, radius, radiance)) };
    let disk = Emitter::disk(center, normal, radius, radiance);
    Ok(match (exponent, light.cone) {
        (None, _) => disk,
        (Some(exponent), None) => disk.focused(exponent),
        (Some(exponent), Some(cone)) => disk.with_cone(cone, exponent),
    })
}

/// The normal of a disk or spot; none of a sphere.
fn normal(source: &Source<'_>, light: &Light) -> Result<Option<DVec3>> {
    match (light.kind, light.normal) {
        (LightKind::Sphere, None) => Ok(None),
        (LightKind::Sphere, Some(normal)) => {
            let remedy = "leave the normal out: a sphere emits in all directions";
            Err(source.wrong("normal", format!("{normal:?}, but the light is a sphere"), remedy))
        }
        (LightKind::Disk | LightKind::Spot, Some(normal)) => source.direction("normal", normal).map(Some),
        (kind @ (LightKind::Disk | LightKind::Spot), None) => {
            let finding = format!("missing, but the light is a {}", kind.name());
            Err(source.wrong("normal", finding, "give the direction that the front faces, [x, y, z]"))
        }
    }
}

/// The exponent of a spot; none of the other kinds.
fn exponent(source: &Source<'_>, light: &Light) -> Result<Option<f64>> {
    match (light.kind, light.exponent) {
        (LightKind::Disk | LightKind::Sphere, None) => Ok(None),
        (kind @ (LightKind::Disk | LightKind::Sphere), Some(exponent)) => {
            let kind = kind.name();
            let remedy = format!("write type = \"spot\", or leave the exponent out: a {kind} is not focused");
            Err(source.wrong("exponent", format!("{exponent:?}, but the light is a {kind}"), &remedy))
        }
        (LightKind::Spot, None) => {
            Err(source.wrong("exponent", "missing, but the light is a spot", "give an exponent from 0 to 10000"))
        }
        (LightKind::Spot, Some(exponent)) => {
            let ok = (0.0..=LARGEST_EXPONENT).contains(&exponent);
            source.require(ok, "exponent", format!("{exponent:?}"), "give an exponent from 0 to 10000")?;
            Ok(Some(exponent))
        }
    }
}
