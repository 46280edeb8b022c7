//! Correctness: NEE and MVNEE converge to the same image.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use toml::Value;

use super::{MVNEE_4, NEE, NO_FAILURE, Technique, claim, turn_takers};
use crate::compare;
use crate::error::Result;
use crate::figures::{number, percent};
use crate::film::{Film, Pixel};
use crate::image::{self, exr};
use crate::output;
use crate::paper::bench::{Bench, size, write_planes};
use crate::paper::measure::Measured;
use crate::paper::run::LeftOut;
use crate::paper::section::{Cell, Column, Picture, Plot, Section, Show, Table, Verdict};
use crate::paper::size::Size;
use crate::paper::turns::equal_time;
use crate::plot::{self, Axis, Chart, Curve, Look, Range};

const NAME: &str = "fig7";
const SCENE: &str = "cornell-fog";
/// Side of the blocks of pixels of which means are compared: the mean of so many has nearly a normal law even where
/// single pixels have a few bright samples.
const BLOCK: u32 = 8;
/// Pixels for every second: some hundred samples for each of them.
const PIXELS_PER_SECOND: f64 = 800.0;
/// The channels, and the colours of their curves.
const CHANNELS: [(&str, [u8; 3]); 3] = [("red", [200, 40, 40]), ("green", [0, 140, 80]), ("blue", [40, 70, 200])];
/// Least width of the picture of the difference; its pixels are enlarged.
const LEAST_SIDE: usize = 320;
/// Least probability of so large differences that is taken for noise.
const LEAST: f64 = 1e-4;

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    // They are what references are to others: they get better with the same time.
    let seconds = 0.5 * (bench.budget + bench.references).as_secs_f64();
    let contender = |technique: &Technique, seed: i64| {
        let side = Value::from(side(seconds));
        let own = [("film.size", Value::from(vec![side.clone(), side])), ("render.seed", seed.into())];
        technique.contender(bench, SCENE, Size::default(), &own)
    };
    let mut runs = bench.begin(vec![contender(&NEE, 1)?, contender(&MVNEE_4, 2)?], &LeftOut::new())?;
    equal_time(&mut turn_takers(&mut runs), seconds, bench.tell).expect(NO_FAILURE);
    if bench.tell.stops() {
        return Ok(Section::default()); // perhaps before there was an image
    }
    let [a, b] = [0, 1].map(|run: usize| runs[run].film().pixels().collect::<Vec<_>>());
    let differences = [0, 1, 2].map(|channel| Differences::of(channel, size(runs[0].film()), &a, &b));
    let halves = halves(bench, runs[0].film(), runs[1].film())?;
    let runs: Vec<_> =
        [NEE, MVNEE_4].iter().zip(runs).map(|(technique, run)| bench.measure(technique.file, run, None)).collect();
    let mut gallery = bench.gallery(NAME, "cornell-fog by NEE and MVNEE-4.", &runs, None)?;
    gallery.pictures.push(halves);
    let (found, verdict) = verdict(&differences);
    Ok(Section {
        text: vec![format!(
            "Two images of cornell-fog with different random numbers, one by NEE, one by MVNEE-4. Their difference, in \
             its standard error, has to follow the normal law; blocks of {BLOCK} x {BLOCK} pixels are compared, in \
             red, green and blue. Channels of a picture are not independent: they have the same paths."
        )],
        claims: vec![claim(
            "MVNEE converges to the image of NEE.",
            super::PAPER,
            verdict,
            found,
            "Standard errors of so few samples are not known well; give it more time.",
        )],
        tables: vec![table(&differences)],
        plots: vec![histogram(bench, &differences)?, map(bench)?],
        galleries: vec![gallery],
        turns: Measured::all_turns(&runs),
        ..Section::default()
    })
}

/// Side of an image that gets enough samples in `seconds`: differences of a few are far from a normal law.
fn side(seconds: f64) -> i64 {
    let blocks = (PIXELS_PER_SECOND * seconds).sqrt() / f64::from(BLOCK);
    i64::from(BLOCK) * blocks.round().clamp(8.0, 32.0) as i64
}

/// How two images differ in a channel.
struct Differences {
    /// Differences of the means of blocks over their standard errors.
    blocks: Vec<f64>,
    /// Difference of the means of the images over its standard error.
    image: f64,
    /// The same over the mean of both.
    relative: f64,
}

impl Differences {
    fn of(channel: usize, [width, height]: [u32; 2], a: &[Pixel], b: &[Pixel]) -> Self {
        // Difference and variance of the sums over some pixels.
        let over = |places: &mut dyn Iterator<Item = usize>| {
            places.fold((0.0, 0.0), |(difference, variance), place| {
                let squares = a[place].standard_error[channel].powi(2) + b[place].standard_error[channel].powi(2);
                (difference + a[place].mean[channel] - b[place].mean[channel], variance + squares)
            })
        };
        let corners = (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (BLOCK * x, BLOCK * y)));
        let block = |(x0, y0): (u32, u32)| {
            let place = |i: u32| ((y0 + i / BLOCK) * width + x0 + i % BLOCK) as usize;
            let (difference, variance) = over(&mut (0..BLOCK * BLOCK).map(place));
            difference / variance.sqrt()
        };
        let blocks = corners.map(block).filter(|difference| difference.is_finite()).collect();
        let (difference, variance) = over(&mut (0..a.len()));
        let sum: f64 = a.iter().zip(b).map(|(a, b)| 0.5 * (a.mean[channel] + b.mean[channel])).sum();
        Self { blocks, image: difference / variance.sqrt(), relative: difference / sum }
    }

    fn chi_square(&self) -> f64 {
        self.blocks.iter().map(|z| z * z).sum()
    }

    /// Probability of so large a chi-square, or a larger one.
    fn probability(&self) -> f64 {
        ChiSquared::new(self.blocks.len().max(1) as f64).map_or(1.0, |law| law.sf(self.chi_square()))
    }
}

/// What is found of all channels, and whether noise explains it.
fn verdict(differences: &[Differences; 3]) -> (String, Verdict) {
    let list = |text: &dyn Fn(&Differences) -> String| differences.each_ref().map(text).join(", ");
    let text = format!(
        "In red, green and blue the means of both images differ by {}, which are {} standard errors. Chi-square over \
         {} blocks is {}; so large ones, or larger ones, have the probabilities {}.",
        list(&|one| percent(one.relative)),
        list(&|one| number(one.image, 2)),
        differences[0].blocks.len(),
        list(&|one| number(one.chi_square(), 5)),
        list(&|one| number(one.probability(), 2))
    );
    // Any of three may be unlikely.
    let is_noise = |one: &Differences| 3.0 * one.probability() >= LEAST && one.image.abs() < 4.3;
    (text, Verdict::of(differences.iter().all(is_noise)))
}

fn table(differences: &[Differences; 3]) -> Table {
    let share = |limit: f64, Differences { blocks, .. }: &Differences| {
        blocks.iter().filter(|z| z.abs() > limit).count() as f64 / blocks.len() as f64
    };
    // Of the normal law.
    let rows = [(1.0, 0.317_311), (2.0, 0.045_500), (3.0, 0.002_700), (4.0, 0.000_063)];
    let row = |(limit, law): (f64, f64)| {
        let found = differences.iter().map(|one| 100.0 * share(limit, one));
        [limit, 100.0 * law].into_iter().chain(found).map(Cell::from).collect()
    };
    let columns = [("standard errors".into(), Show::Digits(1)), ("normal law [%]".into(), Show::Digits(3))];
    let found = CHANNELS.map(|(channel, _)| (format!("found in {channel} [%]"), Show::Digits(3)));
    Table {
        caption: "Blocks whose difference exceeds so many standard errors.".into(),
        columns: Column::all(columns.into_iter().chain(found)),
        rows: rows.into_iter().map(row).collect(),
    }
}

fn histogram(bench: &Bench<'_>, differences: &[Differences; 3]) -> Result<Plot> {
    let range = Range { low: -5.0, high: 5.0 };
    let law = |z: f64| (-0.5 * z * z).exp() / (2.0 * core::f64::consts::PI).sqrt();
    let line = (0..=200).map(|k| -5.0 + f64::from(k) / 20.0).map(|z| (z, law(z))).collect();
    let bins = (2.0 * (differences[0].blocks.len() as f64).sqrt()).clamp(10.0, 50.0) as usize;
    let found = CHANNELS.iter().zip(differences).map(|((name, colour), Differences { blocks, .. })| {
        Curve::new(format!("found in {name}"), plot::bars(blocks, range, bins), Look::Steps, *colour)
    });
    let law = Curve::new("normal law", line, Look::Line, [0; 3]);
    let chart = Chart {
        title: "differences of blocks".into(),
        x: Axis::linear("difference in standard errors"),
        y: Axis::linear("density"),
        curves: found.chain([law]).collect(),
        from_zero: true,
    };
    bench.plot(NAME, "histogram", "Differences in standard errors, and the normal law.", &chart)
}

/// The left half of one and the right half of the other.
fn halves(bench: &Bench<'_>, left: &Film, right: &Film) -> Result<Picture> {
    let [width, height] = size(left);
    let half = |x: u32| if x < width / 2 { left } else { right };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let values: Vec<_> = pixels.map(|(x, y)| half(x).pixel(x, y).mean.map(|channel| channel as f32)).collect();
    write_planes(&bench.folder.file(NAME, "halves.exr")?, [width, height], &values)?;
    let note = "the left half by NEE, the right one by MVNEE-4".into();
    Ok(Picture { file: format!("{NAME}/halves.exr"), name: "halves".into(), note, rmse: None })
}

/// The difference of both images as a picture.
fn map(bench: &Bench<'_>) -> Result<Plot> {
    let read = |technique: &Technique| exr::read_image(&bench.folder.file(NAME, &format!("{}.exr", technique.file))?);
    let (a, b) = (read(&NEE)?, read(&MVNEE_4)?);
    let (pixels, meaning) = compare::difference_picture(&a, &b)?;
    let times = LEAST_SIDE.div_ceil(a.width);
    let enlarged = |row: &[u8]| row.chunks(3).flat_map(|pixel| pixel.repeat(times)).collect::<Vec<_>>();
    let rows = pixels.chunks(3 * a.width).flat_map(|row| vec![enlarged(row); times]).map(Vec::into_iter);
    let size = [a.width, a.height].map(|length| (times * length) as u32);
    let path = bench.folder.file(NAME, "difference.png")?;
    output::write(&path, || false, |file| image::png::write_rows(file, size, rows, &[]))?;
    let caption =
        format!("NEE minus MVNEE-4: red where NEE is brighter, blue where it is darker; full colour is {meaning}.");
    Ok(Plot { file: "difference.png".into(), caption })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_passes_and_differences_do_not() {
        // Quantiles of the normal law: as even as noise can be.
        let law = statrs::distribution::Normal::new(0.0, 1.0).expect("a law");
        let noise: Vec<_> = (0..1000).map(|k| law.inverse_cdf((f64::from(k) + 0.5) / 1000.0)).collect();
        let even = || Differences { blocks: noise.clone(), image: 0.0, relative: 0.0 };
        let verdict =
            |image: f64, blocks: Vec<f64>| verdict(&[even(), even(), Differences { blocks, image, relative: 0.0 }]);
        assert_eq!(verdict(1.0, noise.clone()).1, Verdict::Agrees, "{}", verdict(1.0, noise.clone()).0);
        assert_eq!(verdict(-4.5, noise.clone()).1, Verdict::Differs);
        let wilder: Vec<_> = noise.iter().map(|z| 1.2 * z).collect();
        assert_eq!(verdict(1.0, wilder.clone()).1, Verdict::Differs, "{}", verdict(1.0, wilder).0);
        assert_eq!(table(&[even(), even(), even()]).rows[1][4], Cell::from(4.6));
    }

    /// Blocks of pixels whose errors differ: the mean of blocks' differences in standard errors is not that of images.
    #[test]
    fn means_of_images_are_means_of_pixels() {
        let (pixels, half) = (f64::from(BLOCK * BLOCK), BLOCK);
        let image = |offset: f64| {
            let pixel = |place: u32| {
                // Pixels on the right are noisy, and there the images are the same.
                let (error, offset) = if place % (2 * half) < half { (0.1, offset) } else { (2.0, 0.0) };
                Pixel { mean: [5.0, 5.0 + offset, 5.0], standard_error: [error; 3], samples: 9 }
            };
            (0..2 * half * half).map(pixel).collect::<Vec<_>>()
        };
        let of = |channel| Differences::of(channel, [2 * half, half], &image(0.5), &image(0.0));
        let found = of(1);
        let variance = 2.0 * pixels * (0.1_f64.powi(2) + 2.0_f64.powi(2));
        assert!((found.image - 0.5 * pixels / variance.sqrt()).abs() < 1e-3, "{}", found.image);
        let first = 0.5 * pixels / (2.0 * pixels * 0.01_f64).sqrt();
        assert!((found.blocks[0] - first).abs() < 1e-3 && found.blocks[1] == 0.0, "{:?}", found.blocks);
        assert!((found.relative - 0.5 / (10.0 + 0.25)).abs() < 1e-6, "{}", found.relative);
        assert_eq!((of(0).image, of(2).image), (0.0, 0.0), "the other channels are the same");
    }
}
