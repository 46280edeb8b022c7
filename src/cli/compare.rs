//! `fogbow compare`

use std::path::PathBuf;

use super::destinations::{self, Destination};
use super::{CompareArgs, say, tell};
use crate::compare::{BLOCK, ChannelComparison, compare, difference_picture};
use crate::error::{Error, Result};
use crate::figures::number;
use crate::image;
use crate::output;

pub fn run(args: &CompareArgs) -> Result<()> {
    let pictures: Vec<_> = args.png.iter().map(|path| Destination { flag: "--png", path }).collect();
    destinations::check(&pictures, &[args.a.clone(), args.b.clone()])?;
    let (a, b) = (image::exr::read_image(&args.a)?, image::exr::read_image(&args.b)?);
    let channels = compare(&a, &b)
        .map_err(|error| Error { place: format!("{}, {}", args.a.display(), args.b.display()), ..error })?;
    let same_sums = image::exr::exact::are_same([&args.a, &args.b]);
    if args.json {
        let (width, height) = (a.width, a.height);
        let report =
            serde_json::json!({ "width": width, "height": height, "same_sums": same_sums, "channels": channels });
        report_to(&args.png, report)?;
    } else {
        let heading = format!("{} and {}: {}x{} pixels", args.a.display(), args.b.display(), a.width, a.height);
        report_to(&args.png, heading)?;
        channels.iter().try_for_each(|channel| report_to(&args.png, describe(channel)))?;
        if same_sums == Some(true) {
            report_to(&args.png, "the same exact sums of the same samples")?;
        }
    }
    if let Some(path) = &args.png {
        let (bytes, meaning) = difference_picture(&a, &b)?;
        let rows = bytes.chunks(3 * a.width).map(|row| row.iter().copied());
        let size = [a.width as u32, a.height as u32];
        let notes = [("scale", meaning.clone())];
        output::write(path, || false, |file| image::png::write_rows(file, size, rows, &notes))?;
        tell(format!("{}: full colour stands for {meaning}", path.display()));
    }
    Ok(())
}

/// A line of the comparison: on standard output, unless the picture goes there.
fn report_to(picture: &Option<PathBuf>, line: impl core::fmt::Display) -> Result<()> {
    if picture.as_deref().is_some_and(output::is_standard_output) {
        tell(line);
        return Ok(());
    }
    say(line)
}

fn describe(c: &ChannelComparison) -> String {
    let [mean_a, mean_b] = [c.mean_a, c.mean_b].map(|mean| number(mean, 6));
    let (rmse, relative) = (number(c.rmse, 4), number(c.relative_mse, 4));
    let mut text = format!("{}  means {mean_a} and {mean_b}  RMSE {rmse}  relative MSE {relative}", c.channel);
    if let Some(noise) = &c.noise {
        let z = noise.mean_difference_in_standard_errors;
        text += &format!(
            "\n   means differ by {z:+.2} standard errors\n   chi-square {} over {} noisy pixels, p = {:.3}",
            number(noise.chi_square, 4),
            noise.noisy_pixels,
            noise.p_value
        );
        text += &format!(
            "; {} over {} blocks of {BLOCK}x{BLOCK}, p = {:.3}",
            number(noise.chi_square_of_blocks, 4),
            noise.noisy_blocks,
            noise.p_value_of_blocks
        );
    }
    text
}
