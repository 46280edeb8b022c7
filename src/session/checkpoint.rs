//! Checkpoints: files from which a render goes on to the same bits, whatever ended it.
//!
//! | bytes | |
//! |---|---|
//! | 18 | `fogbow checkpoint\n` |
//! | 4 | version of the layout |
//! | 4 | length of the header |
//! | that | the header: JSON |
//! | as the header says | tile by tile, number of samples of every pixel and all sums of the film |
//! | the rest but 32 | how far it is: JSON |
//! | 32 | BLAKE3 of all before |
//!
//! Numbers are little-endian. A render goes on while its tiles are copied; how far it is, is noted after that, so that
//! no tile is ahead of it.

mod slot;
mod summary;

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::survival::Survival;
use serde::{Deserialize, Serialize};

use super::identity::{self, Difference, Entry, PILOTED};
use super::{Earlier, Estimates, Limits, Session};
use crate::adaptive::Probing;
use crate::error::{Error, Result};
use crate::film::{Film, LayerForm, Tile};
use crate::output::{self, Replace, Sink};
use crate::pilot::Setting;
pub use slot::Slot;
pub use summary::{Summary, is_checkpoint};

/// What every checkpoint begins with.
const MAGIC: [u8; 18] = *b"fogbow checkpoint\n";
/// Version of the layout.
const LAYOUT: u32 = 3;
/// Bytes before the header.
const PREFIX: u64 = MAGIC.len() as u64 + 8;
/// Bytes of the longest header that is read, and of what says how far a render is.
const LONGEST_HEADER: u32 = 1 << 24;
/// Bytes of the checksum.
const CHECKSUM: u64 = blake3::OUT_LEN as u64;
/// Entries that have to be the same besides those that samples depend on.
const MORE: [&str; 4] = ["first_sample", "adaptive", "region", "cpu_features"];

/// What a checkpoint says of its render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct About {
    identity: Vec<Entry>,
    layers: Vec<LayerForm>,
    /// Bytes of every tile.
    tiles: Vec<u64>,
}

/// How far it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Progress {
    limits: Limits,
    /// Samples of every pixel after which the noise is to be looked at next.
    until: u32,
    /// What looks at the noise so far say of how many samples it takes.
    estimates: Estimates,
    /// Time that it has taken so far.
    seconds: f64,
    /// Contributions that were not finite: how many, and pixel and sample of the first.
    dropped: u64,
    first_dropped: Option<(u32, u32)>,
    /// What probes found.
    probings: Vec<Probing>,
    /// When it was written, in seconds since 1970.
    written: u64,
}

/// A checkpoint that was found whole.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    file: File,
    about: About,
    progress: Progress,
    /// Where the tiles begin.
    tiles: u64,
    /// What it ends with.
    checksum: Mark,
}

/// By which checkpoints are told from each other: what they end with.
type Mark = [u8; CHECKSUM as usize];

/// The error that the file at `path` cannot be used.
fn refuse(path: &Path, finding: impl core::fmt::Display) -> Error {
    let remedy = "start from the beginning with --overwrite-checkpoint, or remove the file";
    Error::failure(path.display(), finding, remedy)
}

impl Checkpoint {
    /// Opens the checkpoint at `path` and makes sure that it is whole.
    ///
    /// # Errors
    /// If it cannot be read, is torn or damaged, or is no checkpoint of this version.
    pub fn open(path: &Path) -> Result<Self> {
        let unreadable = |error: io::Error| {
            let remedy = "check the path and its permissions";
            Error::failure(path.display(), format!("cannot be read: {error}"), remedy)
        };
        let metadata = path.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(refuse(path, "is no file"));
        }
        let file = File::open(path).map_err(unreadable)?;
        let (length, refuse) = (metadata.len(), |finding: &str| refuse(path, finding));
        let torn = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => refuse("is a truncated checkpoint"),
            _ => unreadable(error),
        };
        let (mut reader, mut hasher) = (BufReader::with_capacity(1 << 16, &file), blake3::Hasher::new());
        let mut start = [0; PREFIX as usize];
        reader.read_exact(&mut start).map_err(|error| if length == 0 { refuse("is empty") } else { torn(error) })?;
        hasher.update(&start);
        let (magic, numbers) = start.split_at(MAGIC.len());
        if magic != MAGIC {
            return Err(refuse("is not a checkpoint"));
        }
        let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
        if number(&numbers[..4]) != LAYOUT {
            return Err(refuse("is a checkpoint in the layout of another version of fogbow"));
        }
        let header = number(&numbers[4..]);
        if header > LONGEST_HEADER || PREFIX + u64::from(header) + CHECKSUM > length {
            return Err(refuse("is a truncated or damaged checkpoint"));
        }
        let mut text = vec![0; header as usize];
        reader.read_exact(&mut text).map_err(torn)?;
        hasher.update(&text);
        let tiles = PREFIX + u64::from(header);
        let mut left = length - tiles - CHECKSUM;
        let mut bytes = vec![0; 1 << 16];
        while left > 0 {
            let count = left.min(bytes.len() as u64) as usize;
            reader.read_exact(&mut bytes[..count]).map_err(torn)?;
            hasher.update(&bytes[..count]);
            left -= count as u64;
        }
        let mut checksum = [0; CHECKSUM as usize];
        reader.read_exact(&mut checksum).map_err(torn)?;
        if *hasher.finalize().as_bytes() != checksum {
            return Err(refuse("is a truncated or damaged checkpoint: its checksum is not that of its content"));
        }
        let unknown = |_| refuse("is a checkpoint of an unknown kind");
        let about: About = serde_json::from_slice(&text).map_err(unknown)?;
        let after = about.tiles.iter().try_fold(tiles, |sum, bytes| sum.checked_add(*bytes));
        let text = after.and_then(|after| (length - CHECKSUM).checked_sub(after).zip(Some(after)));
        let Some((count, after)) = text.filter(|(count, _)| *count <= LONGEST_HEADER.into()) else {
            return Err(refuse("is a checkpoint that contradicts itself"));
        };
        let mut text = vec![0; count as usize];
        (&file).seek(SeekFrom::Start(after)).and_then(|_| (&file).read_exact(&mut text)).map_err(unreadable)?;
        let progress = serde_json::from_slice(&text).map_err(unknown)?;
        Ok(Self { path: path.into(), file, about, progress, tiles, checksum })
    }

    /// Fills `film` with its sums.
    fn read(&mut self, film: &Film) -> Result<()> {
        let Self { path, file, about, tiles, .. } = self;
        let layers = film.layers();
        let forms: Vec<_> = layers.iter().map(LayerForm::of).collect();
        if about.tiles != lengths(film) || about.layers != forms {
            return Err(refuse(path, "is a checkpoint with a film of another shape"));
        }
        let unreadable = |error: io::Error| refuse(path, format!("cannot be read: {error}"));
        file.seek(SeekFrom::Start(*tiles)).map_err(unreadable)?;
        let (mut reader, mut bytes) = (BufReader::with_capacity(1 << 16, &*file), Vec::new());
        for (index, length) in about.tiles.iter().enumerate() {
            bytes.resize(*length as usize, 0);
            reader.read_exact(&mut bytes).map_err(unreadable)?;
            film.tile(index).read(&bytes).ok_or_else(|| refuse(path, "is a damaged checkpoint"))?;
        }
        Ok(())
    }

    /// Samples of all pixels together, given a film of the same shape.
    fn samples(&self, film: &Film) -> Result<u64> {
        if self.about.tiles != lengths(film) {
            return Err(refuse(&self.path, "is a checkpoint with a film of another shape"));
        }
        let (mut file, mut at, mut samples) = (&self.file, self.tiles, 0);
        for (index, length) in self.about.tiles.iter().enumerate() {
            let mut number = [0; size_of::<u32>()];
            let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(&mut number));
            read.map_err(|error| refuse(&self.path, format!("cannot be read: {error}")))?;
            samples += u64::from(u32::from_le_bytes(number)) * film.tile(index).region().pixels();
            at += length;
        }
        Ok(samples)
    }

    /// What its render was to go on until.
    pub fn limits(&self) -> Limits {
        self.progress.limits
    }

    /// What its pilot chose; none if it does not say.
    pub fn setting(&self) -> Option<Setting> {
        let text = |name: &str| identity::text(&self.about.identity, name);
        let starts = match text("starts")? {
            "all" => u32::MAX,
            number => number.parse().ok()?,
        };
        let survival: Vec<f32> = text("survival")?.split(' ').map(|q| q.parse().ok()).collect::<Option<_>>()?;
        let survival = match survival.as_slice() {
            [constant] => Survival::Constant(*constant),
            octaves => Survival::by_octave(octaves.try_into().ok()?),
        };
        Some(Setting { starts, survival, roulette: text("roulette")?.parse().ok()? })
    }

    /// What differs between its render and that of `session`, as far as that is known before it is prepared.
    pub fn difference(&self, session: &Session) -> Option<Difference> {
        let mut identity = session.own_identity();
        identity.retain(|(name, _)| !PILOTED.contains(&name.as_str()));
        identity::difference(&self.about.identity, &identity, &MORE)
    }

    /// Fails if it is not of the render of `session`, as far as that is known before it is prepared.
    ///
    /// # Errors
    /// What differs.
    pub fn check(&self, session: &Session) -> Result<()> {
        self.difference(session).map_or(Ok(()), |difference| Err(self.foreign(&difference)))
    }

    fn foreign(&self, difference: &Difference) -> Error {
        let finding = format!("is the checkpoint of another render: {difference}");
        let remedy = if difference.is_in_files {
            "put the files back that it was made with, or start anew with --overwrite-checkpoint"
        } else {
            "give the flags that it was made with, or start anew with --overwrite-checkpoint"
        };
        Error::failure(self.path.display(), finding, remedy)
    }
}

/// Bytes of every tile of a film.
fn lengths(film: &Film) -> Vec<u64> {
    let pixels = (0..film.tile_count()).map(|index| film.tile(index).region().pixels());
    pixels.map(|pixels| Tile::bytes(film.layers(), pixels)).collect()
}

impl Session {
    /// What its samples and the shape of its film depend on.
    fn own_identity(&self) -> Vec<Entry> {
        let more = [
            ("first_sample", self.settings.first_sample.to_string()),
            ("adaptive", self.settings.adaptive.to_string()),
        ];
        self.identity().into_iter().chain(more.map(|(name, text)| (name.to_string(), text))).collect()
    }

    /// How far it is now.
    fn progress(&self) -> Progress {
        let Dropped { count: dropped, first: first_dropped } = self.dropped();
        Progress {
            limits: self.limits(),
            until: self.until.load(Ordering::Relaxed),
            estimates: *self.estimates(),
            seconds: self.elapsed().as_secs_f64(),
            dropped,
            first_dropped,
            probings: self.plan().probings().to_vec(),
            written: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs()),
        }
    }

    /// Writes a checkpoint to `path`, whole or not at all, whatever is there; the render may be running. Where other
    /// renders may write to the same place, use a [`Slot`].
    ///
    /// # Errors
    /// If it cannot be written; what was at `path` is then still there.
    pub fn write_checkpoint(&self, path: &Path) -> Result<()> {
        self.put_checkpoint(path, |_| Ok(Replace::Any)).map(drop)
    }

    /// Writes a checkpoint to `path` if `permit`, told of how many samples of all pixels together it is, lets it: its
    /// mark, if so.
    fn put_checkpoint(&self, path: &Path, permit: impl FnOnce(u64) -> Result<Replace>) -> Result<Option<Mark>> {
        let layers = self.film.layers().iter().map(LayerForm::of).collect();
        let about = About { identity: self.own_identity(), layers, tiles: lengths(&self.film) };
        let header = serde_json::to_vec(&about).expect("numbers and names");
        let (mark, samples) = (Cell::new([0; CHECKSUM as usize]), Cell::new(0));
        let fill = |file: &mut dyn Sink| {
            let mut hasher = blake3::Hasher::new();
            let mut write = |bytes: &[u8]| {
                hasher.update(bytes);
                file.write_all(bytes).map_err(|error| error.to_string())
            };
            write(&MAGIC)?;
            write(&LAYOUT.to_le_bytes())?;
            write(&u32::try_from(header.len()).map_err(|error| error.to_string())?.to_le_bytes())?;
            write(&header)?;
            let mut bytes = Vec::new();
            for index in 0..self.film.tile_count() {
                bytes.clear();
                // Workers wait for this tile while it is copied, not while it is written.
                let tile = self.film.tile(index);
                tile.write(&mut bytes);
                samples.set(samples.get() + tile.all_samples());
                drop(tile);
                write(&bytes)?;
            }
            write(&serde_json::to_vec(&self.progress()).expect("numbers and names"))?;
            mark.set(*hasher.finalize().as_bytes());
            file.write_all(&mark.get()).map_err(|error| error.to_string())
        };
        let is_placed = output::rewrite(path, || permit(samples.get()), fill)?;
        Ok(is_placed.then(|| mark.get()))
    }

    /// Takes over the samples of `checkpoint`. To be called between preparing and running.
    ///
    /// # Errors
    /// If it is not of this render, or cannot be read again.
    pub fn resume(&mut self, checkpoint: &mut Checkpoint) -> Result<()> {
        let difference = identity::difference(&checkpoint.about.identity, &self.own_identity(), &MORE);
        if let Some(difference) = difference {
            return Err(checkpoint.foreign(&difference));
        }
        checkpoint.read(&self.film)?;
        let Progress { until, estimates, seconds, dropped, first_dropped, probings, .. } = checkpoint.progress.clone();
        self.plan().restore(probings).ok_or_else(|| refuse(&checkpoint.path, "has probes of another film"))?;
        let time = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        self.earlier = Earlier { time, samples: self.film.samples() };
        self.monitor.note_dropped(Dropped { count: dropped, first: first_dropped });
        *self.until.get_mut() = until;
        *self.estimates() = estimates;
        Ok(())
    }
}
