//! The sky of a scene: its radiance, or an image of it.

use std::path::PathBuf;
use std::sync::Arc;

use fogbow_kernels::tables::lights::{Panorama, Source};

use super::document::Document;
use super::ranges::LARGEST_RADIANCE;
use super::schema::{self, Scene, Spectrum};
use crate::error::{Error, Result};
use crate::image::{self, Image};
use crate::warning::Warning;

/// The error that something at infinity is named at `path`, where a medium without end is around everything.
pub fn refused(document: &Document, path: &str, what: &str) -> Error {
    let finding = format!(
        "{path} is {what}, of which nothing would arrive: the medium around everything has no end, and so lets nothing \
         through from infinity"
    );
    let remedy = "leave out medium, or make it a [[volume]], which ends somewhere; or take a light that has a place";
    document.error(path, finding, remedy)
}

/// The file of the image of the sky, if it has one.
pub fn file(scene: &Scene, document: &Document) -> Option<PathBuf> {
    Some(document.folder().join(scene.environment.as_ref()?.image.as_ref()?))
}

/// What shines from the sky of `scene`.
///
/// # Errors
/// If a key is out of range or missing, a medium is around everything, or the image cannot be read.
pub fn source(scene: &Scene, document: &Document) -> Result<Option<Source>> {
    let Some(environment) = &scene.environment else { return Ok(None) };
    if scene.has_endless_medium() {
        return Err(refused(document, "environment", "a sky"));
    }
    let sky = Sky { document, environment };
    match (environment.radiance, &environment.image) {
        (Some(radiance), None) => sky.even(radiance).map(Some),
        (None, Some(image)) => sky.panorama(image).map(Some),
        (Some(radiance), Some(image)) => Err(contradiction(document, radiance, image)),
        (None, None) => {
            let finding = "environment has neither a radiance nor an image";
            Err(document.error("environment", finding, "give one of the two"))
        }
    }
}

/// The error that there are both a `radiance` and an `image`. What a flag gives is meant to replace what is in the file.
fn contradiction(document: &Document, radiance: Spectrum, image: &str) -> Error {
    let keys = [
        ("environment.image", format!("image = {image:?}")),
        ("environment.radiance", format!("radiance = {radiance}")),
    ];
    let finding = "environment has both a radiance and an image";
    match keys.iter().filter(|(key, _)| document.is_set_by_flag(key)).collect::<Vec<_>>()[..] {
        [(key, given)] => {
            document.error(key, finding, format!("replace the whole environment: --set 'environment={{ {given} }}'"))
        }
        _ => document.error("environment.image", finding, "leave out one of the two"),
    }
}

/// A warning about an image whose sides are not those of a whole sky.
pub fn warning(scene: &Scene, source: Option<&Source>) -> Option<Warning> {
    let Some(Source::Panorama(panorama)) = source else { return None };
    let [width, height] = panorama.size();
    let file = scene.environment.as_ref()?.image.as_ref()?;
    let finding = format!(
        "has {width}x{height} pixels, where an image of the whole sky by longitude and latitude is twice as wide as high"
    );
    (width != 2 * height).then(|| Warning::new(file, finding))
}

/// The keys of `[environment]`, and where they stand.
struct Sky<'a> {
    document: &'a Document,
    environment: &'a schema::Environment,
}

impl Sky<'_> {
    fn require(&self, ok: bool, key: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<()> {
        let path = format!("environment.{key}");
        if ok { Ok(()) } else { Err(self.document.error(&path, format!("{path} is {finding}"), remedy)) }
    }

    fn even(&self, radiance: Spectrum) -> Result<Source> {
        for (key, given) in [("rotation_deg", self.environment.rotation_deg), ("scale", self.environment.scale)] {
            let remedy = "leave it out, or give an image instead of the radiance";
            self.require(given.is_none(), key, "given, but there is no image", remedy)?;
        }
        let ok = radiance.0.iter().all(|x| (0.0..=LARGEST_RADIANCE).contains(x));
        self.require(ok, "radiance", radiance, "give a finite radiance from 0 to 1e30 W/(m^2 sr)")?;
        Ok(Source::Sky(radiance.0))
    }

    fn panorama(&self, name: &str) -> Result<Source> {
        let rotation = self.environment.rotation_deg.unwrap_or(0.0);
        let remedy = "give an angle from -360 to 360 degrees";
        self.require(rotation.abs() <= 360.0, "rotation_deg", format!("{rotation:?}"), remedy)?;
        let scale = self.environment.scale.unwrap_or(1.0);
        let ok = scale > 0.0 && scale <= LARGEST_RADIANCE;
        self.require(ok, "scale", format!("{scale:?}"), "give a number above 0, up to 1e30")?;
        let path = self.document.folder().join(name);
        let finding = || format!("{name:?}, but there is no file {}", path.display());
        let remedy = "give the path of an OpenEXR or Radiance image, relative to the folder of the scene";
        self.require(path.is_file(), "image", finding(), remedy)?;
        let of_file = |error: Error| self.document.error_of_file("environment.image", error);
        let image = image::read_radiances(&path).map_err(of_file)?;
        let fault = |finding: String, remedy: &str| of_file(Error::failure(path.display(), finding, remedy));
        let [width, height] = sides(&image).ok_or_else(|| {
            let finding =
                format!("has {}x{} pixels, more than {} along a side", image.width, image.height, LARGEST_SIDE);
            fault(finding, "give a smaller image")
        })?;
        let pixels = pixels(&image, scale).map_err(|(finding, remedy)| fault(finding, remedy))?;
        Ok(Source::Panorama(Arc::new(Panorama::new([width, height], pixels, rotation.to_radians()))))
    }
}

const LARGEST_SIDE: u32 = Panorama::LARGEST_SIDE;

/// Width and height of an image that is not too large.
fn sides(image: &Image) -> Option<[u32; 2]> {
    let side = |side: usize| u32::try_from(side).ok().filter(|side| *side <= LARGEST_SIDE);
    Some([side(image.width)?, side(image.height)?])
}

/// The pixels of an image as radiances; or what is wrong with them, and what would be right.
fn pixels(image: &Image, scale: f64) -> core::result::Result<Vec<[f32; 3]>, (String, &'static str)> {
    let names = ["R", "G", "B"];
    let found = || image.channels.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    let plane = |name: &str| {
        image.channel(name).ok_or_else(|| {
            (format!("has no channel {name}, only {}", found()), "give an image with the channels R, G and B")
        })
    };
    let [red, green, blue] = [plane(names[0])?, plane(names[1])?, plane(names[2])?];
    let mut pixels = Vec::with_capacity(red.len());
    for at in 0..red.len() {
        let pixel = [red[at], green[at], blue[at]];
        for (name, value) in names.into_iter().zip(pixel) {
            if !(value >= 0.0 && f64::from(value) * scale <= LARGEST_RADIANCE) {
                let (x, y) = (at % image.width, at / image.width);
                let finding = format!("has a pixel that is {value:?}: column {x}, row {y}, channel {name}");
                return Err((finding, "make all pixels finite and 0 or more, and times scale 1e30 W/(m^2 sr) or less"));
            }
        }
        pixels.push(pixel.map(|value| (f64::from(value) * scale) as f32));
    }
    Ok(pixels)
}
