//! Correctness: NEE and MVNEE converge to the same image.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use toml::Value;

use super::{MVNEE_4, NEE, Technique, claim, turn_takers};
use crate::compare;
use crate::error::Result;
use crate::figures::{number, percent};
use crate::film::{Film, Pixel};
use crate::image::{self, exr};
use crate::output;
use crate::paper::bench::{Bench, size, write_planes};
use crate::paper::section::{Cell, Column, Picture, Plot, Section, Show, Table, Verdict};
use crate::paper::turns::equal_time;
use crate::plot::{self, Axis, Chart, Corner, Curve, Look, Range};

const NAME: &str = "fig7";
const SCENE: &str = "cornell-fog";
/// Side of the blocks of pixels of which means are compared: the mean of so many has nearly a normal law even where
/// single pixels have a few bright samples.
const BLOCK: u32 = 4;
/// Pixels for every second: some hundred samples for each of them.
const PIXELS_PER_SECOND: f64 = 450.0;
/// Least probability of so large differences that is taken for noise.
const LEAST: f64 = 1e-4;

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let seconds = 0.5 * bench.budget.as_secs_f64();
    let contender = |technique: &Technique, seed: i64| {
        let side = Value::from(side(seconds));
        let own = [("film.size", Value::from(vec![side.clone(), side])), ("render.seed", seed.into())];
        technique.contender(bench, SCENE, seconds, &own)
    };
    let mut runs = bench.begin(vec![contender(&NEE, 1)?, contender(&MVNEE_4, 2)?])?;
    equal_time(&mut turn_takers(&mut runs), seconds, bench.tell).expect("our own renders do not fail");
    if bench.tell.stops() {
        return Ok(Section::default()); // perhaps before there was an image
    }
    let [a, b] = [0, 1].map(|run: usize| runs[run].film().pixels().collect::<Vec<_>>());
    let differences = Differences::of(size(runs[0].film()), &a, &b);
    let halves = halves(bench, runs[0].film(), runs[1].film())?;
    let runs: Vec<_> =
        [NEE, MVNEE_4].iter().zip(runs).map(|(technique, run)| bench.measure(technique.file, run, None)).collect();
    let mut gallery = bench.gallery(NAME, "cornell-fog by NEE and MVNEE-4.", &runs, None)?;
    gallery.pictures.push(halves);
    let (found, verdict) = differences.verdict();
    Ok(Section {
        text: vec![format!(
            "Two images of cornell-fog with different random numbers, one by NEE, one by MVNEE-4. Their difference, in \
             its standard error, has to follow the normal law; blocks of {BLOCK} x {BLOCK} pixels are compared."
        )],
        claims: vec![claim(
            "MVNEE converges to the image of NEE.",
            super::PAPER,
            verdict,
            found,
            "Standard errors of so few samples are not known well; give it more time.",
        )],
        tables: vec![table(&differences.blocks)],
        plots: vec![histogram(bench, &differences.blocks)?, map(bench)?],
        galleries: vec![gallery],
        ..Section::default()
    })
}

/// Side of an image that gets enough samples in `seconds`: differences of a few are far from a normal law.
fn side(seconds: f64) -> i64 {
    let blocks = (PIXELS_PER_SECOND * seconds).sqrt() / f64::from(BLOCK);
    i64::from(BLOCK) * blocks.round().clamp(8.0, 64.0) as i64
}

/// How two images differ, in green.
struct Differences {
    /// Differences of the means of blocks over their standard errors.
    blocks: Vec<f64>,
    /// Difference of the means of the images over its standard error.
    image: f64,
    /// The same over the mean of both.
    relative: f64,
}

impl Differences {
    fn of([width, height]: [u32; 2], a: &[Pixel], b: &[Pixel]) -> Self {
        // Difference and variance of the sums over some pixels.
        let over = |places: &mut dyn Iterator<Item = usize>| {
            places.fold((0.0, 0.0), |(difference, variance), place| {
                let squares = a[place].standard_error[1].powi(2) + b[place].standard_error[1].powi(2);
                (difference + a[place].mean[1] - b[place].mean[1], variance + squares)
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
        let sum: f64 = a.iter().zip(b).map(|(a, b)| 0.5 * (a.mean[1] + b.mean[1])).sum();
        Self { blocks, image: difference / variance.sqrt(), relative: difference / sum }
    }

    /// What is found, and whether noise explains it.
    fn verdict(&self) -> (String, Verdict) {
        let chi_square: f64 = self.blocks.iter().map(|z| z * z).sum();
        let freedom = self.blocks.len().max(1) as f64;
        let p = ChiSquared::new(freedom).map_or(1.0, |law| law.sf(chi_square));
        let text = format!(
            "The means of both images differ by {}, which is {} standard errors. Chi-square over {freedom} blocks is \
             {}; so large a one, or a larger one, has the probability {}.",
            percent(self.relative),
            number(self.image, 2),
            number(chi_square, 5),
            number(p, 2)
        );
        (text, Verdict::of(p >= LEAST && self.image.abs() < 4.0))
    }
}

fn table(differences: &[f64]) -> Table {
    let share = |limit: f64| differences.iter().filter(|z| z.abs() > limit).count() as f64 / differences.len() as f64;
    // Of the normal law.
    let rows = [(1.0, 0.317_311), (2.0, 0.045_500), (3.0, 0.002_700), (4.0, 0.000_063)];
    let row = |(limit, law): (f64, f64)| [limit, 100.0 * law, 100.0 * share(limit)].map(Cell::from).to_vec();
    Table {
        caption: "Blocks whose difference exceeds so many standard errors.".into(),
        columns: Column::all([
            ("standard errors", Show::Digits(1)),
            ("normal law [%]", Show::Digits(3)),
            ("found [%]", Show::Digits(3)),
        ]),
        rows: rows.into_iter().map(row).collect(),
    }
}

fn histogram(bench: &Bench<'_>, differences: &[f64]) -> Result<Plot> {
    let range = Range { low: -5.0, high: 5.0 };
    let law = |z: f64| (-0.5 * z * z).exp() / (2.0 * core::f64::consts::PI).sqrt();
    let line = (0..=200).map(|k| -5.0 + f64::from(k) / 20.0).map(|z| (z, law(z))).collect();
    let chart = Chart {
        title: "differences of blocks".into(),
        x: Axis::linear("difference in standard errors"),
        y: Axis::linear("density"),
        curves: vec![
            Curve::new("found", plot::bars(differences, range, 50), Look::Steps, plot::COLOURS[0]),
            Curve::new("normal law", line, Look::Line, plot::COLOURS[1]),
        ],
        from_zero: true,
        legend: Corner::UpperRight,
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
    let rows = pixels.chunks(3 * a.width).map(|row| row.iter().copied());
    let size = [a.width as u32, a.height as u32];
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
        let verdict = |image: f64, blocks: Vec<f64>| Differences { blocks, image, relative: 0.0 }.verdict();
        assert_eq!(verdict(1.0, noise.clone()).1, Verdict::Agrees, "{}", verdict(1.0, noise.clone()).0);
        assert_eq!(verdict(-4.5, noise.clone()).1, Verdict::Differs);
        let wilder: Vec<_> = noise.iter().map(|z| 1.2 * z).collect();
        assert_eq!(verdict(1.0, wilder.clone()).1, Verdict::Differs, "{}", verdict(1.0, wilder).0);
        assert_eq!(table(&noise).rows[1][2], Cell::from(4.6));
    }

    /// Blocks of pixels whose errors differ: the mean of blocks' differences in standard errors is not that of images.
    #[test]
    fn means_of_images_are_means_of_pixels() {
        let image = |offset: f64| {
            let pixel = |place: u32| {
                // Pixels on the right are noisy, and there the images are the same.
                let (error, offset) = if place % 8 < 4 { (0.1, offset) } else { (2.0, 0.0) };
                Pixel { mean: [5.0 + offset; 3], standard_error: [error; 3], samples: 9 }
            };
            (0..32).map(pixel).collect::<Vec<_>>()
        };
        let found = Differences::of([8, 4], &image(0.5), &image(0.0));
        let variance = 2.0 * 16.0 * (0.1_f64.powi(2) + 2.0_f64.powi(2));
        assert!((found.image - 16.0 * 0.5 / variance.sqrt()).abs() < 1e-3, "{}", found.image);
        assert!((found.blocks[0] - 16.0 * 0.5 / (2.0 * 16.0 * 0.01_f64).sqrt()).abs() < 1e-3 && found.blocks[1] == 0.0);
        assert!((found.relative - 8.0 / (32.0 * 5.0 + 4.0)).abs() < 1e-6, "{}", found.relative);
    }
}
