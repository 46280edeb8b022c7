//! What items are made with: scenes, time, threads, and a folder to write to.

use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use toml::Value;

use super::folder::Folder;
use super::measure::Measured;
use super::reference::Reference;
use super::run::{Contender, LeftOut, Run};
use super::scenes::Scenes;
use super::section::{Gallery, Picture, Plot};
use super::size::Size;
use super::{Item, Tell};
use crate::error::{Error, Result};
use crate::figures::number;
use crate::film::{Film, Region};
use crate::image::tone::Exposure;
use crate::image::{self, Format};
use crate::plot::{self, Chart, Panel};
use crate::scene::LoadedScene;

/// What items are made with.
pub struct Bench<'a> {
    /// Where everything goes.
    pub folder: &'a Folder,
    /// Where scenes come from.
    pub scenes: &'a Scenes,
    /// Rendering time of the item at hand.
    pub budget: Duration,
    /// What references may take on top of their part of that.
    pub references: Duration,
    /// Worker threads that are asked for; 0 for one per processor.
    pub workers: usize,
    /// Who is told.
    pub tell: &'a dyn Tell,
}

/// Samples of a reference, as a multiple of those of the render that it judges: its error is then less than a third.
/// A little more than ten, as errors are not known exactly.
pub const TIMES: f64 = 11.0;
/// How much longer than it is expected to a reference may take, on a machine that is at times slower.
const PATIENCE: f64 = 1.5;

/// How the time of an item is shared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// What every render gets `[s]`.
    pub each: f64,
    /// What their reference gets at most `[s]`.
    pub reference: f64,
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
        let times = [self.budget, self.references].map(|time| time.as_millis() as u64);
        let all = (program(), item.name, times, self.workers, scenes?);
        let text = serde_json::to_vec(&all).expect("names and numbers");
        Ok(blake3::hash(&text).to_hex()[..32].to_string())
    }

    /// How `share` of the item's time goes to so many renders and their reference.
    pub fn times(&self, share: f64, renders: usize) -> Times {
        let (own, more) = (share * self.budget.as_secs_f64(), share * self.references.as_secs_f64());
        let each = own / (renders as f64 + TIMES);
        Times { each, reference: PATIENCE * TIMES * each + more }
    }

    /// Width and height of a scene's own film.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn full_size(&self, name: &str) -> Result<[u32; 2]> {
        Ok(self.scenes.load(name, &[])?.scene.film.size)
    }

    /// A scene of some size with some keys changed.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn scene(&self, name: &str, size: Size, changes: &[(&str, Value)]) -> Result<LoadedScene> {
        let sides = size.of(self.full_size(name)?).map(|side| Value::from(i64::from(side)));
        let size = ("film.size", Value::from(sides.to_vec()));
        self.scenes.load(name, &[&[size], changes].concat())
    }

    /// Contenders that begin, all for the same light, of which `left_out` is what a limit on paths leaves out.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn begin(&self, contenders: Vec<Contender>, left_out: &LeftOut) -> Result<Vec<Run>> {
        let begin = |contender| Run::begin(contender, left_out, self.workers, self.tell);
        contenders.into_iter().map(begin).collect()
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
            let path = self.folder.file(item, &name)?;
            if let Some(run) = &one.run {
                run.write(&path)?;
            }
            let (name, note, rmse) = (one.name.clone(), one.note(), one.rmse.map(|rmse| rmse.root()));
            pictures.push(Picture { file: format!("{item}/{}.exr", one.file), name, note, rmse });
        }
        let last = reference.map(|reference| Picture {
            file: reference.file.clone(),
            name: "reference".into(),
            note: format!("RMSE {}, {} samples", number(reference.error(), 2), number(reference.samples, 3)),
            rmse: Some(reference.error()),
        });
        let exposure = match (reference, measured.first()) {
            (Some(reference), _) => Exposure::metered(reference.pixels.iter().map(|pixel| pixel.mean)).0,
            (None, Some(Measured { run: Some(run), .. })) => {
                let pixels: Vec<_> = run.film().pixels().map(|pixel| pixel.mean).collect();
                Exposure::metered(pixels.iter().copied()).0
            }
            _ => 0.0,
        };
        let has_reference = last.is_some();
        pictures.extend(last);
        Ok(Gallery { caption: caption.into(), exposure, pictures, has_reference })
    }

    /// What `run` came to, against `reference`.
    pub fn measure(&self, file: impl Into<String>, run: Run, reference: Option<&Reference>) -> Measured {
        Measured::of_run(file, run, reference.map(|reference| reference.pixels.as_slice()))
    }

    /// Writes a chart of `item`.
    ///
    /// # Errors
    /// If it cannot be drawn or written.
    pub fn plot(&self, item: &str, name: &str, caption: impl Into<String>, chart: &Chart) -> Result<Plot> {
        self.drawing(item, name, caption, plot::chart(chart), &chart.csv())
    }

    /// Writes a drawing of paths of `item`.
    ///
    /// # Errors
    /// If it cannot be drawn or written.
    pub fn paths(&self, item: &str, name: &str, caption: impl Into<String>, panels: &[Panel]) -> Result<Plot> {
        self.drawing(item, name, caption, plot::paths_svg(panels), &plot::paths_csv(panels))
    }

    /// Writes an SVG drawing of `item`, and as CSV what is drawn.
    ///
    /// # Errors
    /// If it could not be drawn, or cannot be written.
    fn drawing(
        &self,
        item: &str,
        name: &str,
        caption: impl Into<String>,
        text: core::result::Result<String, String>,
        data: &str,
    ) -> Result<Plot> {
        let path = self.folder.file(item, &format!("{name}.svg"))?;
        self.folder.write(&path.with_extension("csv"), data)?;
        let text = text.map_err(|error| {
            Error::failure(path.display(), format!("cannot be drawn: {error}"), "this is a fault of fogbow; report it")
        })?;
        self.folder.write(&path, &text)?;
        Ok(Plot { file: format!("{name}.svg"), caption: caption.into() })
    }
}

/// A hash of this program: what another one made is made again.
fn program() -> &'static str {
    static HASH: OnceLock<String> = OnceLock::new();
    HASH.get_or_init(|| {
        let bytes = std::env::current_exe().and_then(std::fs::read);
        let hash = |bytes: Vec<u8>| blake3::hash(&bytes).to_hex().to_string();
        bytes.map_or_else(|_| env!("CARGO_PKG_VERSION").into(), hash)
    })
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
