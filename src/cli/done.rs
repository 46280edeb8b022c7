//! Whether results are there already.

use super::destinations::Destination;
use super::outputs::ImageOutput;
use crate::image::Format;
use crate::output;
use crate::session::{Limits, Session};

/// Whether `images` and `others` of this render are all there, so that it need not be done again: images that are no
/// regular files have to be sent again, and only EXR images say what they are of.
pub fn are_there<'a>(
    session: &Session,
    limits: Limits,
    images: &[ImageOutput],
    others: impl Iterator<Item = Destination<'a>>,
) -> bool {
    let mut paths = images.iter().map(|image| image.path.as_path()).chain(others.map(|other| other.path));
    let mut exr = images.iter().filter(|image| image.format == Format::Exr);
    paths.all(|path| path.is_file() && !output::is_stream(path))
        && exr.clone().count() > 0
        && exr.all(|image| session.is_rendered(&image.path, limits))
}

/// Whether all of these images are there, and none is of a kind that says what it is of.
pub fn are_silent(images: &[ImageOutput]) -> bool {
    let is_silent = |image: &ImageOutput| image.format != Format::Exr && image.path.is_file();
    images.iter().all(|image| is_silent(image) && !output::is_stream(&image.path))
}
