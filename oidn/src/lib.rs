//! Intel Open Image Denoise 2, loaded when it is asked for: nothing of it is needed to build or to run without.
//!
//! [`Library::load`] finds the shared library where the system looks for such, [`Library::denoise`] filters an image on
//! the processor. The functions are those of its C interface (`oidn.h`), of which [`symbols`](self) has the few that
//! are called.

mod session;
mod symbols;

use core::fmt;

use session::Device;
use symbols::Symbols;

/// An image and what guides its filter: red, green and blue, or x, y and z, of every pixel, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Images<'a> {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Radiance, finite and >= 0, of any size.
    pub colour: &'a [[f32; 3]],
    /// Albedo of what is seen first, [0, 1]; may be noisy.
    pub albedo: &'a [[f32; 3]],
    /// Normal of what is seen first, [-1, 1]; may be noisy.
    pub normal: &'a [[f32; 3]],
}

/// What went wrong, in the words of the system or of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(pub String);

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for Error {}

/// The library, loaded.
pub struct Library {
    symbols: Symbols,
}

impl Library {
    /// Loads the library from where the system looks for shared libraries, `LD_LIBRARY_PATH` on Linux included.
    ///
    /// # Errors
    /// If there is none, or none of version 2.
    pub fn load() -> Result<Self, Error> {
        Ok(Self { symbols: Symbols::load()? })
    }

    /// Its version: `2.3.1`.
    ///
    /// # Errors
    /// If it finds no device to run on.
    pub fn version(&self) -> Result<String, Error> {
        let device = Device::new(&self.symbols, 1)?;
        let [major, minor, patch] = [c"versionMajor", c"versionMinor", c"versionPatch"].map(|name| device.number(name));
        Ok(format!("{major}.{minor}.{patch}"))
    }

    /// The image without its noise, on so many threads; 0 for one per processor.
    ///
    /// Albedo and normal are filtered first, for themselves, and guide the filter of the image as if they had no noise:
    /// what the library recommends for images that are not for interaction.
    ///
    /// # Errors
    /// If the library refuses or fails: it says why.
    ///
    /// # Panics
    /// Unless all images have as many pixels as width and height say, at least one.
    pub fn denoise(&self, images: &Images<'_>, threads: usize) -> Result<Vec<[f32; 3]>, Error> {
        let Images { width, height, colour, albedo, normal } = *images;
        let is_whole = |image: &[[f32; 3]]| !image.is_empty() && Some(image.len()) == width.checked_mul(height);
        assert!([colour, albedo, normal].into_iter().all(is_whole), "images of {width}x{height} pixels");
        let device = Device::new(&self.symbols, threads)?;
        let size = [width, height];
        let albedo = device.filter(size, &[(c"albedo", albedo)], &[])?;
        let normal = device.filter(size, &[(c"normal", normal)], &[])?;
        let inputs = [(c"color", colour), (c"albedo", albedo.as_slice()), (c"normal", normal.as_slice())];
        device.filter(size, &inputs, &[c"hdr", c"cleanAux"])
    }
}
