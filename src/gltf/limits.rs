//! How much a file may grow: instances, shared vertices and compressed images let a few bytes claim any amount of
//! memory.

use super::fault::{Checked, require};

/// Vertices, and triangles, that any file may have when all instances are written out.
const ELEMENTS: u64 = 1 << 23;
/// The same per byte of the file.
const ELEMENTS_PER_BYTE: u64 = 64;
/// The same for the largest files: vertices, texture coordinates, colours and triangles then take 16 GiB.
const MOST_ELEMENTS: u64 = 1 << 28;

/// Texels that the images of any file may have: eight of 4096 x 4096.
const TEXELS: u64 = 1 << 27;
/// The same per byte of the file. Photographs have about ten texels a byte, plain colours a thousand.
const TEXELS_PER_BYTE: u64 = 256;
/// The same for the largest files: 3 GiB.
const MOST_TEXELS: u64 = 1 << 30;

/// Limits of one file.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    elements: u64,
    texels: u64,
}

impl Limits {
    /// The limits of a file that has `bytes` bytes, those of its buffers and images included.
    pub fn new(bytes: usize) -> Self {
        let bytes = bytes as u64;
        Self {
            elements: ELEMENTS.saturating_add(bytes.saturating_mul(ELEMENTS_PER_BYTE)).min(MOST_ELEMENTS),
            texels: TEXELS.saturating_add(bytes.saturating_mul(TEXELS_PER_BYTE)).min(MOST_TEXELS),
        }
    }

    /// Whether a scene of `count` vertices or triangles, which `what` says, can be read.
    pub fn elements(&self, count: u64, what: &str) -> Checked<()> {
        let Self { elements, .. } = self;
        let finding = || format!("has {count} {what} with all instances counted, more than the limit of {elements}");
        require(count <= *elements, finding, "use fewer instances, or split the model")
    }

    /// Whether images of `count` texels can be read.
    pub fn texels(&self, count: u64) -> Checked<()> {
        let finding = || format!("brings the texels of all images to {count}, more than the limit of {}", self.texels);
        require(count <= self.texels, finding, "use smaller images")
    }
}
