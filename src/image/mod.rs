//! Images on disk.

pub mod exr;
pub mod png;
pub mod tone;

use std::path::Path;

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
