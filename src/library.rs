//! The quickest way from a scene to its pixels, for programs.

use core::ops::Range;
use std::path::{Path, PathBuf};

use toml::Value;

use crate::cpu;
use crate::error::{Error, Result};
use crate::film::Pixel;
use crate::image::Format;
use crate::scene::document::Override;
use crate::scene::{self, LoadedScene};
use crate::session::{Limits, Outcome, Session, Settings, Target};

/// A scene that has been read and is valid.
///
/// See the [front page](crate) for an example.
#[derive(Debug)]
pub struct Scene {
    path: PathBuf,
    changes: Vec<Override>,
    /// When it is, if its animations are played `[s]`.
    time: Option<f64>,
    loaded: LoadedScene,
}

impl Scene {
    /// Reads the scene at `path`: a TOML file, a folder with a `scene.toml`, or a glTF file.
    ///
    /// # Errors
    /// If it cannot be read, or something in it is wrong.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref().to_path_buf();
        Ok(Self { loaded: scene::load(&path, Vec::new())?, changes: Vec::new(), time: None, path })
    }

    /// Sets a key of the scene file: `medium.phase.g`, `light[0].radius`, `film.size`. The scene is read again.
    ///
    /// # Errors
    /// If there is no such key, or the value has the wrong type or is out of range; the scene then stays as it was.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) -> Result<()> {
        let value = value.into();
        let flag = format!("{key} = {value}");
        let mut changes = self.changes.clone();
        changes.push(Override { key: key.into(), value, flag, is_dedicated: false });
        self.loaded = scene::load_at(&self.path, changes.clone(), self.time, &|_| {})?;
        self.changes = changes;
        Ok(())
    }

    /// Moves the nodes of its geometry to where the animations of the glTF file have them at `time` `[s]`, all of them
    /// together. The scene is read again.
    ///
    /// # Errors
    /// If an animation is malformed, or the scene is not valid at that time; it then stays as it was.
    pub fn set_time(&mut self, time: f64) -> Result<()> {
        self.loaded = scene::load_at(&self.path, self.changes.clone(), Some(time), &|_| {})?;
        self.time = Some(time);
        Ok(())
    }

    /// The scene in the form that the stages read, with all its keys and warnings.
    pub fn loaded(&self) -> &LoadedScene {
        &self.loaded
    }

    /// What a person should know before the first render: what in the scene is not rendered as written, and whether
    /// this build is slow.
    pub fn warnings(&self) -> Vec<String> {
        let scene = self.loaded.warnings.iter().map(ToString::to_string);
        scene.chain(cpu::advice().map(String::from)).collect()
    }

    /// Renders until a [`Target`] is met, or the first of several ([`Limits`], or a list of targets), on all processors.
    ///
    /// As in the program, a [pilot](crate::pilot) chooses what the scene leaves open; of [`Target::Time`] a quarter may go
    /// by before the first sample.
    ///
    /// # Errors
    /// If there is not enough memory for the image.
    pub fn render(&self, until: impl Into<Limits>) -> Result<Rendered> {
        self.render_with(Settings::default(), until.into())
    }

    /// The same with more samples for noisy parts of the image than for others; see [`crate::adaptive`].
    /// [`Target::Samples`] is then the number of samples of the mean pixel.
    ///
    /// # Errors
    /// If there is not enough memory for the image.
    pub fn render_adaptively(&self, until: impl Into<Limits>) -> Result<Rendered> {
        self.render_with(Settings { adaptive: true, ..Settings::default() }, until.into())
    }

    /// Renders these samples of every pixel, on all processors: a part of an image. [`crate::merge`] puts the EXR
    /// images of parts together.
    ///
    /// # Errors
    /// If there is not enough memory for the image.
    pub fn render_part(&self, samples: Range<u32>) -> Result<Rendered> {
        let settings = Settings { first_sample: samples.start, ..Settings::default() };
        self.render_with(settings, Target::Samples(samples.len() as u32).into())
    }

    fn render_with(&self, settings: Settings, limits: Limits) -> Result<Rendered> {
        let mut session = Session::new(self.loaded.clone(), settings)?;
        session.prepare(true, limits, |_| {});
        let outcome = session.run(limits, || false, |_| {});
        Ok(Rendered { session, outcome })
    }
}

/// An image, and how it was rendered.
pub struct Rendered {
    session: Session,
    outcome: Outcome,
}

impl Rendered {
    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.session.scene.scene.film.size
    }

    /// Mean radiance of the pixel in column `x` and row `y`, [red, green, blue] in W/(m^2 sr), its standard error, and
    /// its number of samples. Row 0 is the top.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        self.session.film.pixel(x, y)
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.session.film.pixels()
    }

    /// Mean radiance of the image per channel, and its standard error [W/(m^2 sr)].
    pub fn mean(&self) -> ([f64; 3], [f64; 3]) {
        self.session.film.mean()
    }

    /// What a person should know about this image: what in the scene was not rendered as written, how much light the
    /// limit on path length left out, what there was no time to prepare, and whether this build is slow.
    pub fn warnings(&self) -> Vec<String> {
        let scene = self.session.scene.warnings.iter().map(ToString::to_string);
        let preparation = self.session.preparation();
        let left_out = preparation.warning_of_left_out().map(|left_out| left_out.to_string());
        scene.chain(left_out).chain(preparation.warning()).chain(cpu::advice().map(String::from)).collect()
    }

    /// Writes the image; the ending of `path`, `.exr` or `.png`, chooses the format.
    ///
    /// # Errors
    /// If it is neither, or the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let Some(format) = Format::of(path) else {
            let finding = "does not name an image format";
            return Err(Error::failure(path.display(), finding, "end the name in .exr or .png"));
        };
        self.session.write(&self.outcome, path, format, || false)
    }

    /// The finished render, with its film, statistics and everything else.
    pub fn session(&self) -> (&Session, &Outcome) {
        (&self.session, &self.outcome)
    }
}
