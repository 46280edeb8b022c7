//! `fogbow merge`

use std::path::PathBuf;
use std::time::Instant;

use super::MergeArgs;
use super::denoising::{Denoising, Noisy};
use super::destinations::{self, Destination};
use super::parts;
use super::progress::Reporter;
use crate::error::{Error, Result};
use crate::figures::number;
use crate::image::tone::Exposure;
use crate::image::{self, Format, Image};
use crate::merge::{self, Merged, Request, Weighted};
use crate::output;

pub fn run(args: &MergeArgs) -> Result<()> {
    let denoising = args.denoise.then(|| Denoising::of(&args.output)).transpose()?;
    let outputs = args.output.iter().map(|image| Destination { flag: "--output", path: &image.path });
    let denoised = denoising.iter().flat_map(|denoising| denoising.destinations());
    let outputs: Vec<_> = outputs.chain(denoised).collect();
    let results: Vec<_> = outputs.iter().map(|output| output.path).collect();
    let parts = parts::all(&args.parts, &results)?;
    destinations::check(&outputs, &parts)?;
    destinations::check_lines(&outputs, args.progress)?;
    let reporter = Reporter::new(args.progress);
    let has_png = args.output.iter().any(|image| image.format == Format::Png);
    if let Some(stops) = args.exposure.as_ref().filter(|_| !has_png) {
        reporter.warn(format!("--exposure {stops} has no effect: only PNG images are exposed, and none is written"));
    }
    denoising.iter().filter_map(Denoising::warning).for_each(|warning| reporter.warn(warning));
    if args.weighted { weighted(args, &parts, &reporter) } else { exact(args, &parts, denoising.as_ref(), reporter) }
}

/// What `--exposure` says, or else `otherwise`, or else what a light meter says of the pixels.
fn exposure(args: &MergeArgs, otherwise: Option<Exposure>, pixels: impl Iterator<Item = [f64; 3]> + Clone) -> Exposure {
    let asked = args
        .exposure
        .as_ref()
        .map(|value| value.as_float().or_else(|| value.as_integer().map(|stops| stops as f64)).map(Exposure));
    asked.unwrap_or(otherwise).unwrap_or_else(|| Exposure::metered(pixels))
}

fn exact(args: &MergeArgs, parts: &[PathBuf], denoising: Option<&Denoising>, mut reporter: Reporter) -> Result<()> {
    let (start, count) = (Instant::now(), parts.len());
    reporter.begin("merge");
    let mut look = |done| reporter.merging(done, count, start.elapsed());
    let outcome =
        merge::exact_as(parts, Request { expected: args.expect.clone(), crop: args.crop, look: Some(&mut look) });
    reporter.loaded();
    let merged = outcome?;
    merged.warnings.iter().for_each(|warning| reporter.warn(warning));
    let Merged { film, size, header, .. } = &merged;
    let exposure = if args.output.iter().any(|image| image.format == Format::Png) {
        let pixels: Vec<_> = film.pixels().map(|pixel| pixel.mean).collect();
        exposure(args, merged.exposure(), pixels.into_iter())
    } else {
        Exposure(0.0)
    };
    for image in &args.output {
        output::write(
            &image.path,
            || false,
            |file| match image.format {
                Format::Exr => image::exr::write_film(file, film, *size, header),
                Format::Png => image::png::write_film(file, film, exposure),
            },
        )?;
    }
    let per_pixel = film.samples() as f64 / film.region().pixels() as f64;
    let noise = Some(film.relative_noise()).filter(|noise| noise.is_finite());
    let noise = noise.map_or_else(String::new, |noise| format!(", noise {} %", number(100.0 * noise, 3)));
    let samples = if per_pixel == 1.0 { "1 sample".into() } else { format!("{} samples", number(per_pixel, 4)) };
    reporter.line(format!("{}: {}, {samples} per pixel{noise}", names(args), images(parts)));
    let noisy = Noisy { film, size: *size, header, exposure, threads: 0 };
    denoising.map_or(Ok(()), |denoising| denoising.finish(&noisy, || false, &reporter))?;
    reporter.written();
    Ok(())
}

fn weighted(args: &MergeArgs, parts: &[PathBuf], reporter: &Reporter) -> Result<()> {
    let Weighted { image: merged, warnings } = merge::weighted(parts)?;
    warnings.iter().for_each(|warning| reporter.warn(warning));
    for image in &args.output {
        match image.format {
            Format::Exr => output::write(&image.path, || false, |file| image::exr::write_image(file, &merged))?,
            Format::Png => {
                let pixels = colours(parts, &merged)?;
                let exposure = exposure(args, None, pixels.iter().copied());
                let rows = pixels.chunks(merged.width).map(|row| row.iter().flat_map(|rgb| exposure.encode(*rgb)));
                let (size, notes) = ([merged.width as u32, merged.height as u32], [("exposure", exposure.to_string())]);
                output::write(&image.path, || false, |file| image::png::write_rows(file, size, rows, &notes))?;
            }
        }
    }
    reporter.line(format!("{}: weighted mean of {}, without exact sums", names(args), images(parts)));
    reporter.written();
    Ok(())
}

/// The pixels of an image, red, green and blue.
fn colours(parts: &[PathBuf], image: &Image) -> Result<Vec<[f64; 3]>> {
    let planes = ["R", "G", "B"].map(|name| image.channel(name));
    let [Some(red), Some(green), Some(blue)] = planes else {
        let finding = "has no channels R, G and B to show, or another image has none";
        return Err(Error::failure(parts[0].display(), finding, "merge to an EXR image"));
    };
    Ok((0..red.len()).map(|place| [red[place], green[place], blue[place]].map(f64::from)).collect())
}

fn names(args: &MergeArgs) -> String {
    args.output.iter().map(|image| image.path.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn images(parts: &[PathBuf]) -> String {
    if parts.len() == 1 { "1 image".into() } else { format!("{} images", parts.len()) }
}
