//! Images without noise, by Intel's Open Image Denoise, if that is installed.
//!
//! It is loaded when it is asked for: what its `oidnDenoise` program can do, but without files in between, and with its
//! own words if anything is wrong. What it makes of an image is a guess, and biased: the image with its noise, and with
//! its errors, is written in any case.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use fogbow_oidn::{Images, Library};

use crate::error::{Error, Result};
use crate::film::aov::Aov;
use crate::film::{Film, RADIANCE, Region};
use crate::image::tone::Exposure;
use crate::image::{self, Format};
use crate::output;
use crate::session::identity::Entry;

/// The layers that guide it, which a film needs to be denoised.
pub const GUIDES: [Aov; 2] = [Aov::Albedo, Aov::Normal];

/// Open Image Denoise.
pub struct Denoiser {
    library: Library,
    version: String,
}

/// An image, or part of one, without its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// The pixels that there are.
    pub region: Region,
    /// Their radiance, row by row from the top [W/(m^2 sr)].
    pub pixels: Vec<[f32; 3]>,
    /// What it was denoised with.
    pub by: String,
}

impl Denoiser {
    /// The library of this machine.
    ///
    /// # Errors
    /// If there is none that can be used.
    pub fn find() -> Result<Self> {
        let unusable = |error| {
            let finding = format!("Intel Open Image Denoise cannot be used: {error}");
            let remedy = "install version 2 of it (openimagedenoise.org), or have the system find its library, on Linux by \
                          LD_LIBRARY_PATH";
            Error::failure("--denoise", finding, remedy)
        };
        let library = Library::load().map_err(unusable)?;
        let version = library.version().map_err(unusable)?;
        Ok(Self { library, version })
    }

    /// The radiance of `film` without its noise, on so many threads.
    ///
    /// # Errors
    /// If the film lacks a layer of [`GUIDES`], or the library fails.
    pub fn image(&self, film: &Film, threads: usize) -> Result<Denoised> {
        let failed = |finding: String, remedy: &str| Error::failure("--denoise", finding, remedy);
        let layer = |aov: Aov| {
            let place = film.layers().iter().position(|layer| layer.name == aov.name());
            place.ok_or_else(|| {
                failed(format!("the image has no layer {}", aov.name()), "render it with --aov albedo,normal")
            })
        };
        let [colour, albedo, normal] =
            [RADIANCE, layer(Aov::Albedo)?, layer(Aov::Normal)?].map(|layer| pixels(film, layer));
        let region = film.region();
        let [width, height] = [region.width(), region.height()].map(|side| side as usize);
        let images = Images { width, height, colour: &colour, albedo: &albedo, normal: &normal };
        let pixels = self.library.denoise(&images, threads).map_err(|error| {
            failed(format!("Open Image Denoise {}: {error}", self.version), "denoise the image with another program")
        })?;
        // What it makes of very bright pixels may be beyond f32, and a network may undershoot 0.
        let pixels = pixels.into_iter().map(|rgb| rgb.map(finite)).collect();
        Ok(Denoised { region, pixels, by: format!("Open Image Denoise {}", self.version) })
    }
}

/// A number that is finite and >= 0, the nearest one.
fn finite(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, f32::MAX) }
}

/// The means of three channels of a layer, row by row.
fn pixels(film: &Film, layer: usize) -> Vec<[f32; 3]> {
    let region = film.region();
    let all = region.rows().flat_map(|y| region.columns().map(move |x| (x, y)));
    all.map(|(x, y)| {
        [0, 1, 2].map(|channel| {
            let mean = film.estimate(layer, channel, x, y).mean as f32;
            mean.clamp(f32::MIN, f32::MAX)
        })
    })
    .collect()
}

impl Denoised {
    /// Writes it to `path`, an EXR image with these `header` entries and what it was denoised with, or a PNG image of
    /// this exposure; the whole image has `size` pixels.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(
        &self,
        (path, format): (&Path, Format),
        size: [u32; 2],
        header: &[Entry],
        exposure: Exposure,
        interrupted: impl Fn() -> bool,
    ) -> Result<()> {
        output::write(path, interrupted, |file| match format {
            Format::Exr => {
                let mut header = header.to_vec();
                header.push(("denoised".into(), self.by.clone()));
                image::exr::write_pixels(file, &self.pixels, self.region, size, &header)
            }
            Format::Png => {
                let rows = self.pixels.chunks(self.region.width() as usize);
                let encoded = |rgb: &[f32; 3]| exposure.encode(rgb.map(f64::from));
                let rows = rows.map(|row| row.iter().flat_map(encoded));
                let notes = [("exposure", exposure.to_string()), ("denoised", self.by.clone())];
                image::png::write_rows(file, [self.region.width(), self.region.height()], rows, &notes)
            }
        })
    }
}

/// Where the image without its noise goes, beside the one at `path`: `fog.denoised.exr` beside `fog.exr`. None if that
/// has no name to go by.
pub fn beside(path: &Path) -> Option<PathBuf> {
    let mut name = OsString::from(path.file_stem()?);
    name.push(".denoised");
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    Some(path.with_file_name(name))
}

/// Where the image with its noise is, if the one at `path` is where [`beside`] puts it.
pub fn noisy(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let (stem, ending) = name.rsplit_once(".denoised")?;
    let is_ending = ending.is_empty() || ending.strip_prefix('.').is_some_and(|ending| !ending.contains('.'));
    is_ending.then(|| path.with_file_name(format!("{stem}{ending}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_without_noise_are_beside_those_with_it() {
        let beside = |path: &str| beside(Path::new(path)).map(|path| path.to_str().expect("text").to_string());
        for (path, expected) in [
            ("a.exr", "a.denoised.exr"),
            ("x/fog.1.png", "x/fog.1.denoised.png"),
            ("plain", "plain.denoised"),
            ("/x/.hidden", "/x/.hidden.denoised"),
        ] {
            assert_eq!(beside(path).as_deref(), Some(expected));
            assert_eq!(noisy(Path::new(expected)).as_deref(), Some(Path::new(path)));
        }
        assert_eq!(["fog.exr", "a.denoised.b.exr"].map(|path| noisy(Path::new(path))), [None, None]);
        assert_eq!(beside(".."), None);
    }

    #[test]
    fn what_is_no_radiance_becomes_the_nearest_that_is() {
        assert_eq!([f32::NAN, f32::INFINITY, -1.0, 0.5].map(finite), [0.0, f32::MAX, 0.0, 0.5]);
    }
}
