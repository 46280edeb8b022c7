//! Images on disk.

pub mod exr;
pub mod hdr;
pub mod png;
pub mod tone;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

/// Pixels of the largest image that is read.
const LARGEST_IMAGE: usize = 1 << 27;

/// An image in memory: named planes of equal size.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Planes, row-major from the top, by name.
    pub channels: Vec<(String, Vec<f32>)>,
    /// What the file says about itself, as text.
    pub header: Vec<(String, String)>,
}

impl Image {
    /// The plane called `name`.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|(channel, _)| channel == name).map(|(_, values)| values.as_slice())
    }
}

/// Reads the image at `path`, OpenEXR or Radiance, whichever it begins like.
///
/// # Errors
/// If the file cannot be read, is neither, or is damaged or too large.
pub fn read_radiances(path: &Path) -> Result<Image> {
    let fault = |finding: &str, remedy: &str| Err(Error::failure(path.display(), finding, remedy));
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(8).read_to_end(&mut start));
    if let Err(error) = read {
        return fault(&format!("cannot be read: {error}"), "check the path and its permissions");
    }
    let give = "give an OpenEXR or a Radiance (.hdr) image";
    match start.as_slice() {
        [] => fault("is empty", give),
        start if start.starts_with(&exr::MAGIC) => exr::read_image(path),
        start if start.starts_with(hdr::MAGIC) => hdr::read_image(path),
        [0x89, b'P', b'N', b'G', ..] => fault("is a PNG image, which holds no radiance", give),
        [0xff, 0xd8, 0xff, ..] => fault("is a JPEG image, which holds no radiance", give),
        _ => fault("is neither an OpenEXR nor a Radiance image", give),
    }
}

/// Formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: for numbers.
    Exr,
    /// PNG: for the eye.
    Png,
}

impl Format {
    /// The format that the name of `path` says.
    pub fn of(path: &Path) -> Option<Self> {
        Self::named(path.extension()?.to_str()?)
    }

    /// The format called `name`, in letters of any case.
    pub fn named(name: &str) -> Option<Self> {
        [("exr", Self::Exr), ("png", Self::Png)]
            .into_iter()
            .find_map(|(known, format)| name.eq_ignore_ascii_case(known).then_some(format))
    }
}
