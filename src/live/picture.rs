//! The image so far in single precision: what onlookers are shown.

use std::sync::{Arc, OnceLock};

use crate::film::{Film, Region, Tile, dark, length};
use crate::image::tone::Exposure;
use crate::session::Session;

/// Means and standard errors of a film, copied tile by tile while it is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    region: Region,
    /// Number of the frame, if it is one of an animation.
    frame: Option<u32>,
    /// How it is exposed.
    exposure: Exposure,
    /// Samples of all pixels of every tile.
    samples: Vec<u64>,
    /// Row by row from the top: mean radiance, red, green, blue, and the length of the vector of their standard errors,
    /// all of them NaN where there is none yet [W/(m^2 sr)].
    pixels: Vec<[f32; 4]>,
    /// All of it as bytes, once somebody has asked.
    bytes: OnceLock<Arc<[u8]>>,
}

impl Picture {
    /// The film of `session` as it is now; what has not changed since `before` is taken from there.
    pub fn after(before: Option<&Self>, session: &Session) -> Self {
        let film = &session.film;
        let fresh = || Self {
            region: film.region(),
            frame: session.frame_number(),
            exposure: Exposure(0.0),
            samples: vec![0; film.tile_count()],
            pixels: vec![[f32::NAN; 4]; film.region().pixels() as usize],
            bytes: OnceLock::new(),
        };
        let mut picture = before.cloned().unwrap_or_else(fresh);
        picture.bytes = OnceLock::new();
        picture.update(film);
        picture.exposure = session.exposure().unwrap_or_else(|| Exposure::metered(picture.means()));
        picture
    }

    /// Copies what is new.
    fn update(&mut self, film: &Film) {
        (0..film.tile_count()).for_each(|index| self.update_tile(film, index));
    }

    /// Copies what is new in a tile.
    fn update_tile(&mut self, film: &Film, index: usize) {
        let tile = film.tile(index);
        if tile.all_samples() == self.samples[index] {
            return;
        }
        // Workers wait for this tile while it is copied, not while its means are taken.
        let copy = Tile::clone(&tile);
        drop(tile);
        self.samples[index] = copy.all_samples();
        let (region, part) = (self.region, copy.region());
        for (y, x) in part.rows().flat_map(|y| part.columns().map(move |x| (y, x))) {
            let pixel = copy.pixel(x, y);
            let [r, g, b] = pixel.mean.map(|channel| channel as f32);
            let error = if pixel.samples > 1 { length(pixel.standard_error) as f32 } else { f32::NAN };
            self.pixels[region.place(x, y)] = [r, g, b, error];
        }
    }

    /// The pixels of the whole image that it shows.
    pub fn region(&self) -> Region {
        self.region
    }

    /// Number of the frame, if it is one of an animation.
    pub fn frame(&self) -> Option<u32> {
        self.frame
    }

    /// Samples of all pixels together.
    pub fn samples(&self) -> u64 {
        self.samples.iter().sum()
    }

    /// Mean radiance, red, green, blue, of all pixels, row by row from the top, 0 where there is none yet [W/(m^2 sr)].
    pub fn radiance(&self) -> impl Iterator<Item = [f32; 3]> + Clone + '_ {
        self.pixels.iter().map(|[r, g, b, _]| [*r, *g, *b].map(|value| if value.is_nan() { 0.0 } else { value }))
    }

    fn means(&self) -> impl Iterator<Item = [f64; 3]> + Clone + '_ {
        self.radiance().map(|rgb| rgb.map(f64::from))
    }

    /// Standard error over mean of every pixel, both as lengths of RGB vectors; as in the noise of the image, what is
    /// much darker than it counts as a tenth of the median pixel. NaN where nothing is known, or all is black.
    pub fn noise(&self) -> impl Iterator<Item = f32> + '_ {
        let floor = dark(self.means().map(length).filter(|mean| *mean > 0.0).collect());
        self.pixels.iter().zip(self.means()).map(move |([.., error], mean)| match length(mean) {
            0.0 => f32::NAN,
            mean => (f64::from(*error) / mean.max(floor)) as f32,
        })
    }

    /// As bytes, little-endian; see [`super::Page`]. Whoever else asks gets the same.
    pub fn bytes(&self) -> Arc<[u8]> {
        Arc::clone(self.bytes.get_or_init(|| self.encoded().into()))
    }

    fn encoded(&self) -> Vec<u8> {
        let Region { x0, y0, .. } = self.region;
        let mut bytes = Vec::with_capacity(32 + 16 * self.pixels.len());
        bytes.extend([x0, y0, self.region.width(), self.region.height()].map(u32::to_le_bytes).as_flattened());
        bytes.extend([self.samples() as f64, self.exposure.0].map(f64::to_le_bytes).as_flattened());
        for ([r, g, b, _], noise) in self.pixels.iter().zip(self.noise()) {
            bytes.extend([*r, *g, *b, noise].map(f32::to_le_bytes).as_flattened());
        }
        bytes
    }
}
