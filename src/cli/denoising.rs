//! `--denoise`: images without noise beside those with it.

use super::destinations::Destination;
use super::outputs::ImageOutput;
use super::progress::Reporter;
use crate::denoise::{Denoiser, beside};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::image::tone::Exposure;
use crate::output;
use crate::session::identity::Entry;

/// The flag.
pub const DENOISE: &str = "--denoise";

/// An image with its noise.
#[derive(Clone, Copy)]
pub struct Noisy<'a> {
    pub film: &'a Film,
    /// Width and height of the whole image.
    pub size: [u32; 2],
    /// Entries of its header.
    pub header: &'a [Entry],
    /// Exposure of PNG images.
    pub exposure: Exposure,
    /// Threads that may work on it; 0 for one per processor.
    pub threads: usize,
}

/// What is to be denoised, and by what.
pub struct Denoising {
    /// Where images go.
    outputs: Vec<ImageOutput>,
    /// The error is why they cannot be denoised: that is told at once, and again in the end.
    denoiser: Result<Denoiser>,
}

impl Denoising {
    /// Looks for what it takes to denoise `images`.
    ///
    /// # Errors
    /// If one of them is no file with a name, so that there is nothing beside it.
    pub fn of(images: &[ImageOutput]) -> Result<Self> {
        let place = |image: &ImageOutput| {
            let path = Some(&image.path).filter(|path| !output::is_stream(path)).and_then(|path| beside(path));
            let finding = "is no file with a name, so there is no place beside it for an image without noise";
            let remedy = "write a file, or leave --denoise out";
            path.ok_or_else(|| Error::usage(format!("--output {}", image.path.display()), finding, remedy))
        };
        let output = |image| Ok(ImageOutput { path: place(image)?, format: image.format });
        let outputs = images.iter().map(output).collect::<Result<_>>()?;
        Ok(Self { outputs, denoiser: Denoiser::find() })
    }

    /// The same as results.
    pub fn destinations(&self) -> impl Iterator<Item = Destination<'_>> {
        self.outputs.iter().map(|image| Destination { flag: DENOISE, path: &image.path })
    }

    /// What is said at once if images cannot be denoised: somebody may want to do something about it before they are
    /// rendered.
    pub fn warning(&self) -> Option<String> {
        let Error { finding, .. } = self.obstacle()?;
        Some(format!("--denoise: {finding}; the image will be written with its noise"))
    }

    /// Why images cannot be denoised.
    pub fn obstacle(&self) -> Option<&Error> {
        self.denoiser.as_ref().err()
    }

    /// Denoises an image that has been written.
    ///
    /// # Errors
    /// If it cannot be denoised or written. The image with its noise is there.
    pub fn finish(&self, noisy: &Noisy<'_>, interrupted: impl Fn() -> bool, reporter: &Reporter) -> Result<()> {
        let Noisy { film, size, header, exposure, threads } = *noisy;
        let kept =
            |error: Error| Error { remedy: format!("{}; the image with its noise is written", error.remedy), ..error };
        let denoiser = self.denoiser.as_ref().map_err(|error| kept(error.clone()))?;
        let image = denoiser.image(film, threads).map_err(kept)?;
        for ImageOutput { path, format } in &self.outputs {
            image.write((path, *format), size, header, exposure, &interrupted)?;
        }
        let names: Vec<_> = self.outputs.iter().map(|image| image.path.display().to_string()).collect();
        reporter.line(format!("{}: denoised by {}", names.join(", "), image.by));
        Ok(())
    }
}
