//! The channels of a film's EXR file, whose pixels are computed as they are written.

use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::{AnyChannel, AnyChannels};

use crate::film::{Estimate, Exact, ExactSquares, ExactSum, Film};

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
    /// A limb of the exact sums of a channel of a layer: those of the sum, then those of the squares.
    Limb { layer: usize, channel: usize, limb: usize },
}

/// Prefix of the names of channels with limbs of exact sums.
pub const EXACT: &str = "exact.";

/// Names of the channels with the exact sums of a channel of a layer; `name` is that of its mean.
pub fn limb_names(name: &str, squares: bool) -> Vec<String> {
    let sums = (0..ExactSum::LIMBS).map(|limb| format!("{EXACT}{name}.sum{limb}"));
    let squares = (0..ExactSquares::LIMBS).filter(|_| squares).map(|limb| format!("{EXACT}{name}.squares{limb}"));
    sums.chain(squares).collect()
}

/// All channels of `film`: means and standard errors, layer by layer, the number of samples, and the exact sums.
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
        for (channel, name) in settings.planes.iter().enumerate().take(settings.channels) {
            for (limb, name) in limb_names(name, settings.squares).iter().enumerate() {
                planes.push(plane(name, Shown::Limb { layer, channel, limb }));
            }
        }
    }
    AnyChannels::sort(planes.into())
}

impl Plane<'_> {
    /// Writes the values at pixels `x0 ..` of row `y` of the whole image.
    fn write(&self, line: LineRefMut<'_>, x0: u32, y: u32) -> exr::error::UnitResult {
        let at = |x: usize| x0 + x as u32;
        match self.shown {
            Shown::Estimate { layer, channel, part } => {
                line.write_samples(|x| part(self.film.estimate(layer, channel, at(x), y)) as f32)
            }
            Shown::Samples => line.write_samples(|x| self.film.samples_of(at(x), y) as f32),
            Shown::Limb { layer, channel, limb } => line.write_samples(|x| {
                let Exact { sum, squares } = self.film.exact(layer, channel, at(x), y);
                *sum.limbs().iter().chain(&squares.limbs()).nth(limb).expect("a limb that there is")
            }),
        }
    }
}

impl SamplesWriter for Plane<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let region = self.film.region();
        let (x0, y) = (region.x0 + line.location.position.x() as u32, region.y0 + line.location.position.y() as u32);
        self.write(line, x0, y).expect("a line in memory");
    }
}

impl WritableSamples<'_> for Plane<'_> {
    type Writer = Self;

    fn sample_type(&self) -> SampleType {
        match self.shown {
            Shown::Estimate { .. } | Shown::Samples => SampleType::F32,
            Shown::Limb { .. } => SampleType::U32,
        }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&self, _: &Header) -> Self {
        *self
    }
}
