//! The channels of a film's EXR file, whose pixels are computed as they are written.

use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{AnyChannel, AnyChannels};

use crate::film::{Estimate, Film};

/// One channel of the file.
#[derive(Clone, Copy)]
pub struct Plane<'f> {
    film: &'f Film,
    shown: Shown,
}

/// What a plane shows of a pixel.
#[derive(Clone, Copy)]
enum Shown {
    /// Part of what is known of a channel of a layer.
    Estimate { layer: usize, channel: usize, part: fn(Estimate) -> f64 },
    /// Number of samples.
    Samples,
}

/// All channels of `film`: means and standard errors, layer by layer, and the number of samples.
pub fn of(film: &Film) -> AnyChannels<Plane<'_>> {
    let plane = |name: &str, shown| AnyChannel::new(name, Plane { film, shown });
    let mut planes = vec![plane("N", Shown::Samples)];
    for (layer, settings) in film.layers().iter().enumerate() {
        for (channel, name) in settings.planes.iter().enumerate() {
            planes.push(plane(name, Shown::Estimate { layer, channel, part: |estimate| estimate.mean }));
            if settings.squares {
                let part = |estimate: Estimate| estimate.standard_error;
                planes.push(plane(&format!("SE.{name}"), Shown::Estimate { layer, channel, part }));
            }
        }
    }
    AnyChannels::sort(planes.into())
}

impl Plane<'_> {
    /// The value at pixel (x, y) of the whole image.
    fn value(&self, x: u32, y: u32) -> f32 {
        match self.shown {
            Shown::Estimate { layer, channel, part } => part(self.film.estimate(layer, channel, x, y)) as f32,
            Shown::Samples => self.film.pixel(x, y).samples as f32,
        }
    }
}

impl SamplesWriter for Plane<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let region = self.film.region();
        let (x0, y) = (region.x0 + line.location.position.x() as u32, region.y0 + line.location.position.y() as u32);
        line.write_samples(|x| self.value(x0 + x as u32, y)).expect("a line in memory");
    }
}

impl WritableSamples<'_> for Plane<'_> {
    type Writer = Self;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&self, _: &Header) -> Self {
        *self
    }
}
