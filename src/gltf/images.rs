//! Images: where they are, and which of them are worth decoding.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::buffers::Buffers;
use super::decode::{self, Format};
use super::fault::{At, Checked, Fault, label};
use super::files::{FileId, Files};
use super::limits::Limits;
use super::schema;
use fogbow_kernels::tables::textures::Image;

/// Where the bytes of an image are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    File(FileId),
    /// A buffer view.
    View(usize),
}

/// An image of the file that is in use.
#[derive(Debug)]
pub struct Used<'a> {
    index: usize,
    image: &'a schema::Image,
    source: Source,
}

impl Used<'_> {
    fn label(&self) -> String {
        image_label(self.index, self.image)
    }
}

fn image_label(index: usize, image: &schema::Image) -> String {
    label("image", index, image.name.as_deref())
}

/// Finds the images with the indices `used`, and reads the files that they refer to.
pub fn open<'a>(images: &'a [schema::Image], used: &[usize], files: &mut Files) -> Checked<Vec<Used<'a>>> {
    let open = |index: &usize| {
        let image = &images[*index];
        let source = open_one(image, files).at(|| image_label(*index, image))?;
        Ok(Used { index: *index, image, source })
    };
    used.iter().map(open).collect()
}

fn open_one(image: &schema::Image, files: &mut Files) -> Checked<Source> {
    let remedy = "give the image exactly one of the two";
    match (&image.uri, image.buffer_view) {
        (Some(uri), None) => files.open(uri).map(Source::File),
        (None, Some(view)) => Ok(Source::View(view)),
        (Some(_), Some(_)) => Err(Fault::new("has both a URI and a bufferView", remedy)),
        (None, None) => Err(Fault::new("has neither a URI nor a bufferView", remedy)),
    }
}

/// An image whose size is known.
struct Sized<'a> {
    used: &'a Used<'a>,
    format: Format,
    bytes: &'a [u8],
}

/// Decodes images: each source once, sizes first, so that a few bytes that claim a huge image cost nothing. Returns the
/// images, and which of them each of `used` is.
pub fn decode(
    used: &[Used<'_>],
    buffers: &Buffers<'_>,
    files: &Files,
    limits: Limits,
) -> Checked<(Vec<Image>, Vec<u32>)> {
    let mut by_source = BTreeMap::new();
    let mut distinct = Vec::new();
    let mut which = Vec::with_capacity(used.len());
    let mut texels = 0u64;
    for used in used {
        let number = *by_source.entry(used.source).or_insert(distinct.len());
        which.push(number as u32);
        if number == distinct.len() {
            let measured = measure(used, buffers, files, &mut texels, limits).at(|| used.label())?;
            distinct.push(measured);
        }
    }
    let decode = |sized: &Sized<'_>| decode::image(sized.format, sized.bytes).at(|| sized.used.label());
    let images: Vec<Checked<Image>> = distinct.par_iter().map(decode).collect();
    Ok((images.into_iter().collect::<Checked<_>>()?, which))
}

fn measure<'a>(
    used: &'a Used<'a>,
    buffers: &Buffers<'a>,
    files: &'a Files,
    texels: &mut u64,
    limits: Limits,
) -> Checked<Sized<'a>> {
    let bytes = match used.source {
        Source::File(file) => files.content(file),
        Source::View(view) => buffers.view(view)?.bytes,
    };
    let format = decode::format(bytes)?;
    let [width, height] = decode::size(format, bytes)?;
    *texels = texels.saturating_add(u64::from(width) * u64::from(height));
    limits.texels(*texels).at(|| format!("{width} x {height}"))?;
    Ok(Sized { used, format, bytes })
}
