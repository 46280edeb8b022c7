//! What parts of a render lack, in words.

use core::ops::Range;

use crate::error::{Error, Result};
use crate::film::{Coverage, Gap, Part, Region};

/// Ranges of samples that are named where none may be missing: each of them is to be rendered.
const MOST_NAMED: usize = 32;
/// Rectangles of pixels that are named.
const MOST_REGIONS: usize = 4;

/// What is counted of the pixels of an image.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Samples of every pixel.
    Samples,
    /// Samples of the mean pixel, of which adaptive renders give every tile its share.
    Levels,
}

impl Unit {
    /// What follows the numbers.
    fn of(self) -> &'static str {
        match self {
            Self::Samples => "",
            Self::Levels => " of the mean pixel",
        }
    }
}

/// Fails unless there are all samples of `whole`, and no others.
pub fn check(coverage: &Coverage, whole: &Part, unit: Unit) -> Result<()> {
    let Range { start, end } = whole.samples;
    let fault =
        |finding: String, remedy: &str| Err(Error::failure(format!("--expect {start}..{end}"), finding, remedy));
    let gaps = coverage.missing(whole);
    if let Some(finding) = text(&gaps, whole.region, MOST_NAMED, unit) {
        return fault(finding, &remedy(&gaps, coverage, whole));
    }
    let Some(has) = coverage.hull() else { return Ok(()) };
    if has.samples.start < start || has.samples.end > end {
        let finding = format!("the parts have samples {}..{}{}", has.samples.start, has.samples.end, unit.of());
        return fault(finding, "merge none but the parts of these samples");
    }
    if has.region.hull(whole.region) != whole.region {
        let finding = format!("the parts have more pixels than that ({})", lines(has.region));
        return fault(finding, "merge none but the parts of these pixels, or name those that there are with --crop");
    }
    Ok(())
}

/// Which samples are missing from which pixels of `whole`, of at most so many ranges; none if there are no gaps.
pub fn text(gaps: &[Gap], whole: Region, most: usize, unit: Unit) -> Option<String> {
    let named = &gaps[..gaps.len().min(most)];
    let mut texts: Vec<String> = Vec::new();
    for (index, gap) in named.iter().enumerate() {
        let is_alike = |other: &&Gap| (other.pixels, &other.regions) == (gap.pixels, &gap.regions);
        if named[..index].iter().any(|other| is_alike(&other)) {
            continue;
        }
        let alike = named[index..].iter().filter(is_alike);
        let ranges: Vec<_> = alike.map(|gap| format!("{}..{}", gap.samples.start, gap.samples.end)).collect();
        texts.push(format!("samples {}{} are missing from {}", ranges.join(", "), unit.of(), pixels(gap, whole)));
    }
    if gaps.len() > named.len() {
        texts.push(format!("and so are {} more ranges of samples", gaps.len() - named.len()));
    }
    (!texts.is_empty()).then(|| texts.join("; "))
}

/// `every pixel`, or `32 of the 64 pixels (columns 4..8, rows 0..8)`.
fn pixels(gap: &Gap, whole: Region) -> String {
    let all = whole.pixels();
    if gap.pixels == all {
        return "every pixel".into();
    }
    let count = format!("{} of the {all} pixels", gap.pixels);
    let mut named: Vec<_> = gap.regions.iter().take(MOST_REGIONS).map(|region| lines(*region)).collect();
    if let Some(more @ 1..) = gap.regions.len().checked_sub(MOST_REGIONS) {
        named.push(format!("and {more} more areas"));
    }
    if named.is_empty() { count } else { format!("{count} ({})", named.join("; ")) }
}

/// `columns 4..8, rows 0..8`
fn lines(Region { x0, y0, x1, y1 }: Region) -> String {
    format!("columns {x0}..{x1}, rows {y0}..{y1}")
}

/// How to get what is missing to `whole`.
fn remedy(gaps: &[Gap], coverage: &Coverage, whole: &Part) -> String {
    let gap = &gaps[0];
    let mut flags = Vec::new();
    let crop = |Region { x0, y0, x1, y1 }| format!("--crop {x0},{y0},{x1},{y1}");
    flags.extend(gap.regions.first().filter(|region| **region != whole.region).map(|region| crop(*region)));
    if flags.is_empty() || gap.samples != whole.samples {
        flags.push(format!("--sample-range {}..{}", gap.samples.start, gap.samples.end));
    }
    let more = if gaps.len() > 1 || gap.regions.len() > 1 { " and so on" } else { "" };
    let rendered = format!("render them with {}{more}, and merge again", flags.join(" "));
    // Parts of a crop may be all that is wanted.
    let cropped = coverage.hull().map(|hull| Part { region: hull.region, samples: whole.samples.clone() });
    match cropped.filter(|part| part.region != whole.region && coverage.missing(part).is_empty()) {
        Some(part) => format!("{rendered}; if no other pixels are wanted, merge with {}", crop(part.region)),
        None => rendered,
    }
}
