//! Textures and samplers; those that no material uses are not read.

use std::collections::BTreeMap;

use super::fault::{At, Checked, Fault, entry, label, quoted};
use super::schema::{Root, Sampler};
use fogbow_kernels::tables::textures::{Filter, Texture, Wrap};

/// The textures in use, and their images.
#[derive(Debug)]
pub struct Textures<'a> {
    root: &'a Root,
    /// In the order of first use.
    pub textures: Vec<Texture>,
    /// Indices in the file of the images in use; textures count them in this order.
    pub images: Vec<usize>,
    by_texture: BTreeMap<usize, u32>,
    by_image: BTreeMap<usize, u32>,
}

impl<'a> Textures<'a> {
    /// None in use yet.
    pub fn new(root: &'a Root) -> Self {
        let (textures, images) = (Vec::new(), Vec::new());
        Self { root, textures, images, by_texture: BTreeMap::new(), by_image: BTreeMap::new() }
    }

    /// The index among the textures in use of texture `index` of the file.
    pub fn note(&mut self, index: usize) -> Checked<u32> {
        if let Some(known) = self.by_texture.get(&index) {
            return Ok(*known);
        }
        entry(&self.root.textures, "texture", index)?;
        let texture = self.read(index).at(|| label("texture", index, None))?;
        let number = self.textures.len() as u32;
        self.textures.push(texture);
        self.by_texture.insert(index, number);
        Ok(number)
    }

    fn read(&mut self, index: usize) -> Checked<Texture> {
        let texture = &self.root.textures[index];
        let Some(source) = texture.source else {
            let remedy = "give the texture a PNG or JPEG image as source";
            let fault = match texture.extensions.keys().next() {
                Some(name) => {
                    Fault::new(format!("its only image is in {}, which is not supported", quoted(name)), remedy)
                }
                None => Fault::new("has no source", remedy),
            };
            return Err(fault);
        };
        let default = Sampler::default();
        let sampler = match texture.sampler {
            Some(sampler) => entry(&self.root.samplers, "sampler", sampler)?,
            None => &default,
        };
        let (wrap, filter) = look_up(sampler).at(|| label("sampler", texture.sampler.unwrap_or_default(), None))?;
        Ok(Texture { image: self.note_image(source)?, wrap, filter })
    }

    fn note_image(&mut self, index: usize) -> Checked<u32> {
        entry(&self.root.images, "image", index)?;
        let images = &mut self.images;
        Ok(*self.by_image.entry(index).or_insert_with(|| {
            images.push(index);
            images.len() as u32 - 1
        }))
    }
}

/// Wrap modes and filter. Minification needs no filter of its own: pixels are means of many samples.
fn look_up(sampler: &Sampler) -> Checked<([Wrap; 2], Filter)> {
    let filter = match sampler.mag_filter {
        None | Some(9729) => Filter::Linear,
        Some(9728) => Filter::Nearest,
        Some(code) => {
            return Err(Fault::new(format!("its magFilter is {code}"), "give 9728 (nearest) or 9729 (linear)"));
        }
    };
    Ok(([wrap(sampler.wrap_s).at(|| "wrapS")?, wrap(sampler.wrap_t).at(|| "wrapT")?], filter))
}

fn wrap(code: Option<u64>) -> Checked<Wrap> {
    match code {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33648) => Ok(Wrap::Mirror),
        Some(33071) => Ok(Wrap::Clamp),
        Some(code) => {
            let remedy = "give 10497 (repeat), 33071 (clamp to edge) or 33648 (mirrored repeat)";
            Err(Fault::new(format!("is {code}"), remedy))
        }
    }
}
