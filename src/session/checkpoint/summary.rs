//! What a checkpoint is of, for people.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::super::identity::{self, Entry};
use super::super::{Limits, REFERENCE_TILE_SIZE};
use super::{Checkpoint, MAGIC, refuse};
use crate::error::Result;
use crate::film::{Film, LayerForm, Region, tile_size};

/// What a checkpoint says of its render.
#[derive(Debug)]
pub struct Summary {
    /// What its samples depend on, as in headers of images.
    pub identity: Vec<Entry>,
    /// Width and height of the whole image.
    pub size: [u32; 2],
    /// The samples so far.
    pub film: Film,
    /// What it was to be rendered until.
    pub limits: Limits,
    /// Time that it had taken.
    pub elapsed: Duration,
    /// When it was written.
    pub written: SystemTime,
}

/// Whether the file at `path` begins as checkpoints do, or is called like one. Pipes are not looked into: that would wait
/// for their writer, and take what is read next.
pub fn is_checkpoint(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    let begins =
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC;
    begins || path.extension().is_some_and(|extension| extension == "checkpoint")
}

impl Checkpoint {
    /// What it is of.
    ///
    /// # Errors
    /// If it makes no sense, cannot be read, or does not fit into memory.
    pub fn summary(mut self) -> Result<Summary> {
        let foreign = || refuse(&self.path, "is a checkpoint of an unknown kind");
        let identity = self.about.identity.clone();
        let text = |name: &str| identity::text(&identity, name);
        let settings: Option<toml::Table> = text("settings").and_then(|text| text.parse().ok());
        let size = settings.as_ref().and_then(size).ok_or_else(foreign)?;
        let region = text("region").and_then(region).ok_or_else(foreign)?;
        let layers = LayerForm::layers(&self.about.layers).ok_or_else(foreign)?;
        if region.pixels() > self.about.tiles.iter().sum() {
            return Err(foreign());
        }
        let side = if text("reference") == Some("none") { tile_size(region) } else { REFERENCE_TILE_SIZE };
        let film = Film::try_new(&layers, region, side)
            .map_err(|error| refuse(&self.path, format!("does not fit into memory: {error}")))?;
        self.read(&film)?;
        let progress = &self.progress;
        Ok(Summary {
            size,
            film,
            limits: progress.limits,
            elapsed: Duration::try_from_secs_f64(progress.seconds).unwrap_or_default(),
            written: UNIX_EPOCH.checked_add(Duration::from_secs(progress.written)).unwrap_or(UNIX_EPOCH),
            identity,
        })
    }
}

/// The size of the image, by the keys of its scene.
fn size(settings: &toml::Table) -> Option<[u32; 2]> {
    let size = settings.get("film")?.get("size")?.as_array()?;
    let [width, height] = size.as_slice() else { return None };
    Some([width, height].map(|length| length.as_integer().and_then(|length| length.try_into().ok()).unwrap_or(0)))
}

/// `x0,y0,x1,y1`
fn region(text: &str) -> Option<Region> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.parse().ok()).collect();
    let [x0, y0, x1, y1] = <[u32; 4]>::try_from(numbers?).ok()?;
    (x0 < x1 && y0 < y1).then_some(Region { x0, y0, x1, y1 })
}
