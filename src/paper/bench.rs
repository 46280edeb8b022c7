//! What items are made with: scenes, time, threads, and a folder to write to.

use std::path::Path;
use std::time::Duration;

use toml::Value;

use super::folder::Folder;
use super::measure::{Contender, Measured, Run};
use super::rmse::Rmse;
use super::scenes::Scenes;
use super::section::{Gallery, Picture, Plot};
use super::{Item, MAKING, Tell};
use crate::error::{Error, Result};
use crate::figures::number;
use crate::film::{Film, Pixel, Region};
use crate::image::tone::Exposure;
use crate::image::{self, Format};
use crate::plot::{self, Chart};
use crate::scene::LoadedScene;

/// Rendering time per picture below which pictures get smaller [s].
const FULL_SIZE_FROM: f64 = 6.0;
/// Least side of a picture in pixels.
const LEAST_SIDE: f64 = 32.0;

/// What items are made with.
pub struct Bench<'a> {
    /// Where everything goes.
    pub folder: &'a Folder,
    /// Where scenes come from.
    pub scenes: &'a Scenes,
    /// Rendering time of the item at hand.
    pub budget: Duration,
    /// Worker threads that are asked for; 0 for one per processor.
    pub workers: usize,
    /// Who is told.
    pub tell: &'a dyn Tell,
}

/// An image that others are measured against.
pub struct Reference {
    /// Its file, in the folder of the report.
    pub file: String,
    /// Its pixels.
    pub pixels: Vec<Pixel>,
    /// Samples per pixel.
    pub samples: f64,
}

impl Bench<'_> {
    /// Worker threads.
    pub fn threads(&self) -> usize {
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        if self.workers == 0 { processors() } else { self.workers }
    }

    /// A hash of all that an item depends on.
    ///
    /// # Errors
    /// If one of its scenes cannot be read.
    pub fn key(&self, item: &Item) -> Result<String> {
        let scenes: Result<Vec<_>> = item.scenes.iter().map(|scene| Ok(self.scenes.load(scene, &[])?.hash())).collect();
        let all = (env!("CARGO_PKG_VERSION"), MAKING, item.name, self.budget.as_millis() as u64, self.workers, scenes?);
        let text = serde_json::to_vec(&all).expect("names and numbers");
        Ok(blake3::hash(&text).to_hex()[..32].to_string())
    }

    /// A scene with some keys changed, of about as many pixels as `seconds` for each picture are enough for.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn scene(&self, name: &str, seconds: f64, changes: &[(&str, Value)]) -> Result<LoadedScene> {
        let [width, height] = self.scenes.load(name, &[])?.scene.film.size.map(f64::from);
        let shrunk = (seconds / FULL_SIZE_FROM).min(1.0).sqrt();
        let scale = shrunk.max(LEAST_SIDE / width.max(height)).min(1.0);
        let side = |length: f64| Value::from((scale * length).round().max(1.0) as i64);
        let size = ("film.size", Value::from(vec![side(width), side(height)]));
        self.scenes.load(name, &[&[size], changes].concat())
    }

    /// Contenders that begin.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn begin(&self, contenders: Vec<Contender>) -> Result<Vec<Run>> {
        contenders.into_iter().map(|contender| Run::begin(contender, self.workers, self.tell)).collect()
    }

    /// The converged image of `scene`, of `seconds` of rendering; the one that is there if that had as many.
    ///
    /// # Errors
    /// If it cannot be rendered or written.
    pub fn reference(&self, scene: LoadedScene, seconds: f64) -> Result<Reference> {
        let name = format!("{}-{}", scene.name, &scene.hash()[..16]);
        let file = self.folder.reference(&name);
        let path = self.folder.path(&file);
        if let Some(reference) = self.cached(&path, &file, seconds) {
            return Ok(reference);
        }
        self.tell.line(&format!("  reference of {}", scene.name));
        let mut run = Run::begin(Contender { name: "reference".into(), scene }, self.workers, self.tell)?;
        run.until(seconds, self.tell);
        if !self.tell.stops() {
            run.write(&path)?;
        }
        let pixels = run.film().pixels().collect();
        Ok(Reference { file, pixels, samples: run.samples() })
    }

    /// The reference at `path`, if this version of the program made it in at least `seconds`.
    fn cached(&self, path: &Path, file: &str, seconds: f64) -> Option<Reference> {
        let image = image::exr::read_image(path).ok()?;
        let entry = |name: &str| {
            let name = format!("{}{name}", image::exr::PREFIX);
            image.header.iter().find(|(entry, _)| *entry == name).map(|(_, text)| text.as_str())
        };
        // All of it counts, preparation included, so that a little less is not refused for rounding.
        let took: f64 = entry("seconds")?.parse().ok()?;
        if entry("version")? != env!("CARGO_PKG_VERSION") || took < seconds {
            return None;
        }
        let pixels = pixels(&image)?;
        let samples = pixels.iter().map(|pixel| pixel.samples as f64).sum::<f64>() / pixels.len() as f64;
        Some(Reference { file: file.into(), pixels, samples })
    }

    /// Writes the images of `measured` for `item`, and their gallery, the reference last.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn gallery(
        &self,
        item: &str,
        caption: impl Into<String>,
        measured: &[Measured],
        reference: Option<&Reference>,
    ) -> Result<Gallery> {
        let mut pictures = Vec::new();
        for one in measured {
            let name = format!("{}.exr", one.file);
            one.run.write(&self.folder.file(item, &name)?)?;
            pictures.push(Picture { file: format!("{item}/{name}"), name: one.run.name.clone(), note: one.note() });
        }
        let last = reference.map(|reference| Picture {
            file: reference.file.clone(),
            name: "reference".into(),
            note: format!("{} samples", number(reference.samples, 3)),
        });
        let exposure = match (reference, measured.first()) {
            (Some(reference), _) => Exposure::metered(reference.pixels.iter().map(|pixel| pixel.mean)).0,
            (None, Some(first)) => {
                let pixels: Vec<_> = first.run.film().pixels().map(|pixel| pixel.mean).collect();
                Exposure::metered(pixels.iter().copied()).0
            }
            (None, None) => 0.0,
        };
        let has_reference = last.is_some();
        pictures.extend(last);
        Ok(Gallery { caption: caption.into(), exposure, pictures, has_reference })
    }

    /// What `run` came to, against `reference`.
    pub fn measure(&self, file: impl Into<String>, run: Run, reference: Option<&Reference>) -> Measured {
        let rmse = reference.map(|reference| Rmse::of(run.film().pixels(), reference.pixels.iter().copied()));
        Measured { file: file.into(), run, rmse }
    }

    /// Writes a chart of `item`.
    ///
    /// # Errors
    /// If it cannot be drawn or written.
    pub fn plot(&self, item: &str, name: &str, caption: impl Into<String>, chart: &Chart) -> Result<Plot> {
        let text = plot::chart(chart);
        self.drawing(item, name, caption, text)
    }

    /// Writes an SVG drawing of `item`.
    ///
    /// # Errors
    /// If it could not be drawn, or cannot be written.
    pub fn drawing(
        &self,
        item: &str,
        name: &str,
        caption: impl Into<String>,
        text: core::result::Result<String, String>,
    ) -> Result<Plot> {
        let path = self.folder.file(item, &format!("{name}.svg"))?;
        let text = text.map_err(|error| {
            Error::failure(path.display(), format!("cannot be drawn: {error}"), "this is a fault of fogbow; report it")
        })?;
        self.folder.write(&path, &text)?;
        Ok(Plot { file: format!("{name}.svg"), caption: caption.into() })
    }
}

/// The pixels of an EXR image with standard errors.
pub fn pixels(image: &image::Image) -> Option<Vec<Pixel>> {
    let planes = |prefix: &str| {
        let [red, green, blue] = ["R", "G", "B"].map(|name| image.channel(&format!("{prefix}{name}")));
        Some([red?, green?, blue?])
    };
    let (means, errors, samples) = (planes("")?, planes("SE.")?, image.channel("N")?);
    let at = |planes: [&[f32]; 3], i: usize| planes.map(|plane| f64::from(plane[i]));
    let pixel = |i| Pixel { mean: at(means, i), standard_error: at(errors, i), samples: samples[i] as u64 };
    Some((0..image.width * image.height).map(pixel).collect())
}

/// A picture of any kind as an EXR image: planes R, G and B.
///
/// # Errors
/// If it cannot be written.
pub fn write_planes(path: &Path, size: [u32; 2], rgb: &[[f32; 3]]) -> Result<()> {
    let plane = |channel: usize| rgb.iter().map(|pixel| pixel[channel]).collect();
    let channels = ["R", "G", "B"].into_iter().enumerate().map(|(i, name)| (name.to_string(), plane(i))).collect();
    let [width, height] = size.map(|length| length as usize);
    let image = image::Image { width, height, channels, header: Vec::new() };
    crate::output::write(path, || false, |file| image::exr::write_image(file, &image))
}

/// Width and height of a film.
pub fn size(film: &Film) -> [u32; 2] {
    let region: Region = film.region();
    [region.width(), region.height()]
}

/// What EXR files are called, by their ending.
pub const FORMAT: Format = Format::Exr;
