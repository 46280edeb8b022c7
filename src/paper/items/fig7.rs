//! Correctness: NEE and MVNEE converge to the same image.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use toml::Value;

use super::{MVNEE_4, NEE, Technique, claim};
use crate::compare;
use crate::error::Result;
use crate::figures::{number, percent};
use crate::film::{Film, Pixel};
use crate::image::{self, exr};
use crate::output;
use crate::paper::bench::{Bench, size, write_planes};
use crate::paper::measure::equal_time;
use crate::paper::section::{Picture, Plot, Section, Table};
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
    equal_time(&mut runs, seconds, bench.tell);
    let differences = differences(runs[0].film(), runs[1].film());
    let halves = halves(bench, runs[0].film(), runs[1].film())?;
    let runs: Vec<_> =
        [NEE, MVNEE_4].iter().zip(runs).map(|(technique, run)| bench.measure(technique.file, run, None)).collect();
    let mut gallery = bench.gallery(NAME, "cornell-fog by NEE and MVNEE-4.", &runs, None)?;
    gallery.pictures.push(halves);
    let (found, verdict) = verdict(&differences);
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
        tables: vec![table(&differences)],
        plots: vec![histogram(bench, &differences)?, map(bench)?],
        galleries: vec![gallery],
        ..Section::default()
    })
}

/// Side of an image that gets enough samples in `seconds`: differences of a few are far from a normal law.
fn side(seconds: f64) -> i64 {
    let blocks = (PIXELS_PER_SECOND * seconds).sqrt() / f64::from(BLOCK);
    i64::from(BLOCK) * blocks.round().clamp(8.0, 64.0) as i64
}

/// Differences of the means of blocks over their standard errors, in green.
fn differences(a: &Film, b: &Film) -> Vec<f64> {
    let ([width, height], [a, b]) = (size(a), [a, b].map(|film| film.pixels().collect::<Vec<Pixel>>()));
    let blocks = (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (BLOCK * x, BLOCK * y)));
    let difference = |(x0, y0): (u32, u32)| {
        let places = (0..BLOCK * BLOCK).map(|i| ((y0 + i / BLOCK) * width + x0 + i % BLOCK) as usize);
        let (difference, variance) = places.fold((0.0, 0.0), |(difference, variance), place| {
            let squares = a[place].standard_error[1].powi(2) + b[place].standard_error[1].powi(2);
            (difference + a[place].mean[1] - b[place].mean[1], variance + squares)
        });
        difference / variance.sqrt()
    };
    blocks.map(difference).filter(|difference| difference.is_finite()).collect()
}

/// What is found, and whether noise explains it.
fn verdict(differences: &[f64]) -> (String, bool) {
    let chi_square: f64 = differences.iter().map(|z| z * z).sum();
    let freedom = differences.len().max(1) as f64;
    let p = ChiSquared::new(freedom).map_or(1.0, |law| law.sf(chi_square));
    let mean = differences.iter().sum::<f64>() / freedom.sqrt();
    let text = format!(
        "The means of both images differ by {} standard errors. Chi-square over {freedom} blocks is {}; so large a \
         one, or a larger one, has the probability {}.",
        number(mean, 2),
        number(chi_square, 5),
        number(p, 2)
    );
    (text, p >= LEAST && mean.abs() < 4.0)
}

fn table(differences: &[f64]) -> Table {
    let share = |limit: f64| differences.iter().filter(|z| z.abs() > limit).count() as f64 / differences.len() as f64;
    // Of the normal law.
    let rows = [(1.0, 0.317_311), (2.0, 0.045_500), (3.0, 0.002_700), (4.0, 0.000_063)];
    let row = |(limit, law): (f64, f64)| vec![format!("|z| > {limit}"), percent(law), percent(share(limit))];
    Table {
        caption: "Blocks whose difference exceeds so many standard errors.".into(),
        columns: ["", "normal law", "found"].map(String::from).to_vec(),
        rows: rows.into_iter().map(row).collect(),
    }
}

fn histogram(bench: &Bench<'_>, differences: &[f64]) -> Result<Plot> {
    let range = Range { low: -5.0, high: 5.0 };
    let law = |z: f64| (-0.5 * z * z).exp() / (2.0 * core::f64::consts::PI).sqrt();
    let curve = |name: &str, points, look, index: usize| Curve {
        name: name.into(),
        points,
        look,
        colour: plot::COLOURS[index],
    };
    let line = (0..=200).map(|k| -5.0 + f64::from(k) / 20.0).map(|z| (z, law(z))).collect();
    let chart = Chart {
        title: "differences of blocks".into(),
        x: Axis::linear("difference in standard errors"),
        y: Axis::linear("density"),
        curves: vec![
            curve("found", plot::bars(differences, range, 50), Look::Steps, 0),
            curve("normal law", line, Look::Line, 1),
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
    Ok(Picture { file: format!("{NAME}/halves.exr"), name: "halves".into(), note })
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
    fn noise_passes_and_an_offset_does_not() {
        // Quantiles of the normal law: as even as noise can be.
        let law = statrs::distribution::Normal::new(0.0, 1.0).expect("a law");
        let noise: Vec<_> = (0..1000).map(|k| law.inverse_cdf((f64::from(k) + 0.5) / 1000.0)).collect();
        assert!(verdict(&noise).1, "{}", verdict(&noise).0);
        let brighter: Vec<_> = noise.iter().map(|z| z + 0.2).collect();
        assert!(!verdict(&brighter).1, "{}", verdict(&brighter).0);
        let wilder: Vec<_> = noise.iter().map(|z| 1.2 * z).collect();
        assert!(!verdict(&wilder).1, "{}", verdict(&wilder).0);
        assert_eq!(table(&noise).rows[1][2], percent(0.046));
    }
}
