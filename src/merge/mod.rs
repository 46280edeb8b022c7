//! Images that are parts of one render, put together: exactly, by the sums in them, or by weighted means.

mod missing;
mod weighted;

use core::ops::Range;
use std::path::{Path, PathBuf};

use crate::denoise;
use crate::error::{Error, Result};
use crate::film::{Coverage, Film, Part, Pixel, Region, tile_size};
use crate::image::exr::{self, exact::About};
use crate::image::tone::Exposure;
use crate::output;
use crate::session::identity::{self, Entry, FILES};
use crate::session::report::LEVELS;
use missing::Unit;
pub use weighted::{Weighted, weighted};

/// Entries of headers that may be long.
const LONG: [&str; 3] = ["settings", "coverage", FILES];
/// Ranges of samples that are missing and named.
const MOST_NAMED: usize = 4;

/// An image that was merged from parts.
#[derive(Debug)]
pub struct Merged {
    /// Its sums: the same bits as those of one render.
    pub film: Film,
    /// Width and height of the whole image.
    pub size: [u32; 2],
    /// Entries of its header.
    pub header: Vec<Entry>,
    /// What a person should know: samples that are missing.
    pub warnings: Vec<String>,
}

impl Merged {
    /// The exposure that the scene of the parts asks for; none if that is for a light meter to say.
    pub fn exposure(&self) -> Option<Exposure> {
        let settings: toml::Table = identity::text(&self.header, "settings")?.parse().ok()?;
        let stops = settings.get("film")?.get("exposure")?;
        stops.as_float().or_else(|| stops.as_integer().map(|stops| stops as f64)).map(Exposure)
    }
}

/// What is asked of a merge beyond its parts.
#[derive(Default)]
pub struct Request<'a> {
    /// The samples that all pixels are to have, neither fewer nor others; of the mean pixel, if the parts are adaptive.
    pub expected: Option<Range<u32>>,
    /// The pixels that are to have them, and no others, as `--crop` has them; those of the whole image if absent.
    pub crop: Option<[u32; 4]>,
    /// Told how many parts have been added up.
    pub look: Option<&'a mut dyn FnMut(usize)>,
}

/// Adds up the exact sums of the EXR images at `paths`, parts of one render, in any order. The pixels of one part at a
/// time are in memory.
///
/// # Errors
/// If one cannot be read or has no exact sums, if they are not of one render, or have samples in common.
///
/// # Panics
/// If there are no paths.
pub fn exact(paths: &[PathBuf]) -> Result<Merged> {
    exact_as(paths, Request::default())
}

/// The same as [`exact()`], with more to ask.
///
/// # Errors
/// As [`exact()`], and if the samples are not those that are expected.
///
/// # Panics
/// If there are no paths.
pub fn exact_as(paths: &[PathBuf], request: Request<'_>) -> Result<Merged> {
    let (parts, mut look) = (survey(paths)?, request.look);
    let region = parts.iter().map(|part| part.region).reduce(Region::hull).expect("at least one part");
    let all = parts.iter().flat_map(|part| part.coverage.parts()).cloned().collect();
    let (coverage, About { size, layers, .. }) = (Coverage::of(all), &parts[0]);
    let is_checked = request.expected.is_some();
    if let Some(samples) = request.expected {
        let whole = Region::whole(size[0], size[1]);
        let region = request.crop.map_or(Ok(whole), |crop| Region::cropped(crop, *size))?;
        let whole = Part { region, samples };
        if is_adaptive(&parts) {
            let levels = levels(&parts).ok_or_else(|| without_levels(paths, &parts))?;
            missing::check(&levels, &whole, Unit::Levels)?;
        } else {
            missing::check(&coverage, &whole, Unit::Samples)?;
        }
    }
    let film = Film::try_new(layers, region, tile_size(region)).map_err(|error| {
        let finding = format!("an image of {} pixels does not fit into memory: {error}", region.pixels());
        Error::failure(paths[0].display(), finding, "merge crops of smaller parts of the image")
    })?;
    for (index, (path, part)) in paths.iter().zip(&parts).enumerate() {
        add(&film, &exr::exact::read_film(path, &again(&paths[0], &parts[0], path, part)?)?);
        look.iter_mut().for_each(|look| look(index + 1));
    }
    coverage.parts().iter().for_each(|part| film.count(part.region, part.samples.len() as u32));
    let warnings = warnings(&parts, &coverage, &film, is_checked);
    Ok(Merged { film, size: *size, header: header(&parts, region, &coverage), warnings })
}

/// What the files at `paths` say, which are parts of one render. Of thousands there is no room for what may be long, the
/// settings, the text of the coverage and hashes of files, but for those of the first and of the part whose header the
/// image gets.
fn survey(paths: &[PathBuf]) -> Result<Vec<About>> {
    let mut parts: Vec<About> = Vec::with_capacity(paths.len());
    let mut last = 0;
    for (index, path) in paths.iter().enumerate() {
        let part = exr::exact::about(path).map_err(|error| superfluous(path, paths).unwrap_or(error))?;
        if index > 0 {
            check_same(&paths[0], &parts[0], path, &part)?;
        }
        for (other, other_path) in parts.iter().zip(paths) {
            check_disjoint(other_path, other, path, &part)?;
        }
        parts.push(part);
        let is_last = rank(&parts[index]) >= rank(&parts[last]);
        let earlier = if is_last { core::mem::replace(&mut last, index) } else { index };
        if earlier != 0 {
            parts[earlier].header.retain(|(name, _)| !LONG.contains(&name.as_str()));
        }
    }
    Ok(parts)
}

/// The error that the image at `path` is left out better, if it is called like the denoised one of another part, as it is
/// in the folder of them.
fn superfluous(path: &Path, paths: &[PathBuf]) -> Option<Error> {
    let noisy = denoise::noisy(path).filter(|noisy| paths.iter().any(|other| output::are_same(other, noisy)))?;
    let finding = format!("is the denoised image of {}, which is merged, too", noisy.display());
    let remedy = "leave it out: move it elsewhere, or name the parts one by one or in a list, @LIST";
    Some(Error::failure(path.display(), finding, remedy))
}

/// What the file at `path` says, which said `part` when it was looked at first. What a repeated render has written
/// meanwhile is as good, but nothing else.
fn again(first_path: &Path, first: &About, path: &Path, part: &About) -> Result<About> {
    let about = exr::exact::about(path)?;
    check_same(first_path, first, path, &about)?;
    if (about.region, &about.coverage) == (part.region, &part.coverage) {
        return Ok(about);
    }
    let finding = "was replaced by another part while it was merged";
    Err(Error::failure(path.display(), finding, "merge once nobody writes parts any more"))
}

/// Fails unless the samples of `part` belong to the render of `first`.
fn check_same(first_path: &Path, first: &About, path: &Path, part: &About) -> Result<()> {
    let difference = identity::difference(&first.header, &part.header, &[]);
    let is_in_files = difference.as_ref().is_some_and(|difference| difference.is_in_files);
    let difference = difference.map(|difference| difference.to_string());
    let same_film = first.size == part.size && first.layers == part.layers;
    let other_film = || (!same_film).then(|| "size or layers differ".to_string());
    let Some(difference) = difference.or_else(other_film) else { return Ok(()) };
    let finding = format!("does not belong to the same render as {}: {difference}", first_path.display());
    let remedy = if is_in_files {
        "render all parts with the same files, and merge these"
    } else {
        "merge parts of one render, which differ in --sample-range or --crop alone"
    };
    Err(Error::failure(path.display(), finding, remedy))
}

/// Fails if both have a sample of the same pixel.
fn check_disjoint(other_path: &Path, other: &About, path: &Path, part: &About) -> Result<()> {
    let Some(both) = other.coverage.overlap(&part.coverage) else { return Ok(()) };
    let remedy = "give every part once, with samples or pixels of its own";
    if output::are_same(other_path, path) {
        return Err(Error::failure(path.display(), "is given twice", remedy));
    }
    let Region { x0, y0, x1, y1 } = both.region;
    let (start, end) = (both.samples.start, both.samples.end);
    let where_ = if both.region == Region::whole(part.size[0], part.size[1]) {
        String::new()
    } else {
        format!(" of the pixels {x0},{y0},{x1},{y1}")
    };
    let finding = format!("has samples {start}..{end}{where_}, which {} has, too", other_path.display());
    Err(Error::failure(path.display(), finding, remedy))
}

/// Adds the sums of `part`, whose samples are still to be counted.
fn add(film: &Film, part: &Film) {
    let region = part.region();
    for (y, x) in region.rows().flat_map(|y| region.columns().map(move |x| (y, x))) {
        for (layer, settings) in film.layers().iter().enumerate() {
            for channel in 0..settings.channels {
                film.add_exact(layer, channel, x, y, &part.exact(layer, channel, x, y));
            }
        }
    }
}

/// By which the part with the last samples is the greatest.
fn rank(part: &About) -> (Option<u32>, String) {
    (part.coverage.hull().map(|hull| hull.samples.end), part.coverage.to_string())
}

/// The header of the merged image: that of the part with the last samples, and what is of all of them.
fn header(parts: &[About], region: Region, coverage: &Coverage) -> Vec<Entry> {
    let mut header = parts.iter().max_by_key(|part| rank(part)).expect("at least one part").header.clone();
    let numbers = |name: &str| {
        let numbers = parts.iter().map(|part| part.entry(name).and_then(|text| text.parse::<f64>().ok()));
        numbers.map(|number| number.unwrap_or(1.0)).collect::<Vec<_>>()
    };
    let mut seconds = numbers("seconds");
    seconds.sort_by(f64::total_cmp);
    let distinct = |name: &str| {
        let mut texts: Vec<_> = parts.iter().filter_map(|part| part.entry(name)).collect();
        texts.sort_unstable();
        texts.dedup();
        texts.join("; ")
    };
    let samples = coverage.hull().map_or(0..0, |hull| hull.samples);
    let entries = [
        ("sample_range", format!("{}..{}", samples.start, samples.end)),
        ("coverage", coverage.to_string()),
        ("region", format!("{},{},{},{}", region.x0, region.y0, region.x1, region.y1)),
        ("samples", coverage.samples().to_string()),
        ("seconds", format!("{:.3}", seconds.iter().sum::<f64>())),
        ("parts", numbers("parts").iter().sum::<f64>().to_string()),
        ("adaptive", distinct("adaptive")),
        ("ended_by", distinct("ended_by")),
        ("threads", distinct("threads")),
        ("cpu_features", distinct("cpu_features")),
    ];
    let levels = levels(parts).map(|levels| (LEVELS, levels.to_string()));
    header.retain(|(name, _)| entries.iter().all(|(entry, _)| entry != name) && name != LEVELS);
    header.extend(entries.into_iter().chain(levels).map(|(name, text)| (name.to_string(), text)));
    header
}

/// How many pixels lack samples before their last one, or have none, in words. Where tiles have samples of their own,
/// that some have more than others is no gap.
fn holes(coverage: &Coverage, film: &Film, whole: Region) -> Vec<String> {
    let region = film.region();
    let mut ends = vec![0; region.pixels() as usize];
    for Part { region: part, samples } in coverage.parts() {
        for (y, x) in part.rows().flat_map(|y| part.columns().map(move |x| (y, x))) {
            let end = &mut ends[region.place(x, y)];
            *end = samples.end.max(*end);
        }
    }
    let is_hole = |(end, pixel): &(u32, Pixel)| *end == 0 || pixel.samples < u64::from(*end);
    let within = ends.into_iter().zip(film.pixels()).filter(is_hole).count() as u64;
    let (all, holes) = (whole.pixels(), within + whole.pixels() - region.pixels());
    let text = || format!("{holes} of the {all} pixels lack samples before their last one, or have none");
    (holes > 0).then(text).into_iter().collect()
}

/// Whether tiles of these parts have numbers of samples of their own.
fn is_adaptive(parts: &[About]) -> bool {
    parts.iter().any(|part| part.entry("adaptive") == Some("true"))
}

/// The levels that adaptive parts have together; none if some of them do not say which they have, or they have the same
/// ones, as crops that overlap may, whose tiles are not those of each other.
fn levels(parts: &[About]) -> Option<Coverage> {
    let texts: Option<Vec<_>> = parts.iter().map(|part| part.entry(LEVELS)).collect();
    texts?.join(" ").parse().ok()
}

/// The error that it cannot be told which levels these parts have.
fn without_levels(paths: &[PathBuf], parts: &[About]) -> Error {
    let silent = paths.iter().zip(parts).find(|(_, part)| part.entry(LEVELS).is_none());
    let (place, finding, remedy) = match silent {
        Some((path, part)) if part.entry("adaptive") == Some("true") => (
            path,
            "has some samples of single tiles, as an adaptive render has that time or a signal ended",
            "have it rendered to its last sample, or leave --expect out",
        ),
        Some((path, _)) => {
            (path, "is not adaptive, but other parts are", "render all parts with --adaptive, or leave --expect out")
        }
        None => (
            &paths[0],
            "is adaptive, and overlaps another part whose tiles are not the same",
            "render parts of the same crop, or leave --expect out",
        ),
    };
    Error::failure(place.display(), finding, remedy)
}

/// What a person should know of an image of these parts; gaps in it only unless it `is_checked` that there are none.
fn warnings(parts: &[About], coverage: &Coverage, film: &Film, is_checked: bool) -> Vec<String> {
    let mut warnings = if is_checked { Vec::new() } else { gaps(parts, coverage, film) };
    if coverage.parts().is_empty() {
        warnings.push("no part has any samples".into());
    }
    if parts.iter().any(|part| part.entry("cpu_features") != parts[0].entry("cpu_features")) {
        warnings.push(
            "parts were rendered by builds for different processors, whose samples may differ in their last bits"
                .into(),
        );
    }
    warnings
}

/// What is missing to an image of these parts, in words.
fn gaps(parts: &[About], coverage: &Coverage, film: &Film) -> Vec<String> {
    let [width, height] = parts[0].size;
    let whole = Region::whole(width, height);
    let (gaps, unit) = match levels(parts) {
        _ if !is_adaptive(parts) => (coverage.gaps([width, height]), Unit::Samples),
        Some(levels) => (levels.gaps([width, height]), Unit::Levels),
        None => return holes(coverage, film, whole),
    };
    missing::text(&gaps, whole, MOST_NAMED, unit).into_iter().collect()
}
