//! Which samples of which pixels an image has.

use core::cmp::Ordering;
use core::fmt;
use core::ops::Range;
use core::str::FromStr;

use super::Region;
use crate::scene::schema::MOST_SAMPLES;

/// Parts of the longest list that is read: adaptive renders have one for every tile.
const MOST_PARTS: usize = 1 << 17;
/// Parts around which rectangles without samples are looked for.
const MOST_AROUND: usize = 1 << 12;

/// Samples of all pixels of a rectangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The pixels.
    pub region: Region,
    /// The numbers of their samples.
    pub samples: Range<u32>,
}

/// A list of parts, none of which has a sample of another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage(Vec<Part>);

/// Samples that an image lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Their numbers.
    pub samples: Range<u32>,
    /// How many pixels lack them.
    pub pixels: u64,
    /// Which pixels, in few rectangles; empty if there are too many parts around them to tell.
    pub regions: Vec<Region>,
}

impl Part {
    /// What both have; none if that is nothing.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let region = self.region.intersection(other.region)?;
        let samples = self.samples.start.max(other.samples.start)..self.samples.end.min(other.samples.end);
        (!samples.is_empty()).then_some(Self { region, samples })
    }

    fn columns_key(&self) -> [u32; 6] {
        let Self { region: Region { x0, y0, x1, y1 }, samples } = self;
        [*y0, *y1, samples.start, samples.end, *x0, *x1]
    }

    fn rows_key(&self) -> [u32; 6] {
        let Self { region: Region { x0, y0, x1, y1 }, samples } = self;
        [*x0, *x1, samples.start, samples.end, *y0, *y1]
    }

    fn samples_key(&self) -> [u32; 6] {
        let Self { region: Region { x0, y0, x1, y1 }, samples } = self;
        [*y0, *y1, *x0, *x1, samples.start, samples.end]
    }

    fn hull(&self, other: &Self) -> Self {
        let samples = self.samples.start.min(other.samples.start)..self.samples.end.max(other.samples.end);
        Self { region: self.region.hull(other.region), samples }
    }
}

impl Coverage {
    /// The samples of `parts`, which do not overlap: in few parts, the same however they were cut before.
    pub fn of(mut parts: Vec<Part>) -> Self {
        parts.retain(|part| !part.samples.is_empty());
        parts = split(parts);
        join(&mut parts, Part::samples_key);
        let mut before = usize::MAX;
        while parts.len() < before {
            before = parts.len();
            for key in [Part::columns_key, Part::rows_key, Part::samples_key] {
                join(&mut parts, key);
            }
        }
        Self(parts)
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.0
    }

    /// All samples of both, which do not overlap.
    pub fn with(&self, other: &Self) -> Self {
        Self::of(self.0.iter().chain(&other.0).cloned().collect())
    }

    /// Samples that both have, if there are any.
    pub fn overlap(&self, other: &Self) -> Option<Part> {
        self.0.iter().find_map(|part| other.0.iter().find_map(|other| part.intersection(other)))
    }

    /// The smallest part that has all samples; none if there are none.
    pub fn hull(&self) -> Option<Part> {
        self.0.iter().cloned().reduce(|hull, part| hull.hull(&part))
    }

    /// Samples of all pixels together.
    pub fn samples(&self) -> u64 {
        self.0.iter().map(|part| part.samples.len() as u64 * part.region.pixels()).sum()
    }

    /// What is missing to samples from 0 to the last one in all pixels of an image of `size`.
    pub fn gaps(&self, [width, height]: [u32; 2]) -> Vec<Gap> {
        let end = self.0.iter().map(|part| part.samples.end).max().unwrap_or(0);
        self.missing(&Part { region: Region::whole(width, height), samples: 0..end })
    }

    /// What it lacks of `whole`.
    pub fn missing(&self, whole: &Part) -> Vec<Gap> {
        let parts: Vec<_> = self.0.iter().filter_map(|part| part.intersection(whole)).collect();
        let samples = parts.iter().map(|part| &part.samples).chain([&whole.samples]);
        let mut ends: Vec<_> = samples.flat_map(|samples| [samples.start, samples.end]).collect();
        ends.sort_unstable();
        ends.dedup();
        let mut gaps: Vec<Gap> = Vec::new();
        for pair in ends.windows(2) {
            let has = |part: &&Part| part.samples.contains(&pair[0]);
            let there: Vec<_> = parts.iter().filter(has).map(|part| part.region).collect();
            let pixels = whole.region.pixels().saturating_sub(there.iter().map(|region| region.pixels()).sum());
            if pixels == 0 {
                continue;
            }
            let regions = if there.len() > MOST_AROUND { Vec::new() } else { without(whole.region, &there) };
            match gaps.last_mut() {
                Some(gap) if gap.samples.end == pair[0] && (gap.pixels, &gap.regions) == (pixels, &regions) => {
                    gap.samples.end = pair[1];
                }
                _ => gaps.push(Gap { samples: pair[0]..pair[1], pixels, regions }),
            }
        }
        gaps
    }
}

/// What is left of `whole` without these `parts` of it, in few rectangles.
fn without(whole: Region, parts: &[Region]) -> Vec<Region> {
    let rest = |left: Vec<Region>, part: &Region| left.into_iter().flat_map(|left| around(left, *part)).collect();
    let rectangles: Vec<Region> = parts.iter().fold(vec![whole], rest);
    let rectangles = rectangles.into_iter().map(|region| Part { region, samples: 0..1 }).collect();
    Coverage::of(rectangles).0.into_iter().map(|part| part.region).collect()
}

/// What is left of `region` without `part`: above, below, to its left and to its right.
fn around(region: Region, part: Region) -> impl Iterator<Item = Region> {
    let pieces = match region.intersection(part) {
        None => vec![region],
        Some(hole) => vec![
            Region { y1: hole.y0, ..region },
            Region { y0: hole.y1, ..region },
            Region { x0: region.x0, x1: hole.x0, ..hole },
            Region { x0: hole.x1, x1: region.x1, ..hole },
        ],
    };
    pieces.into_iter().filter(|piece| piece.x0 < piece.x1 && piece.y0 < piece.y1)
}

/// Cuts parts along all edges of others, so that any two have the same pixels or none in common; not if that makes too
/// many.
fn split(parts: Vec<Part>) -> Vec<Part> {
    let edges = |of: fn(&Region) -> [u32; 2]| {
        let mut edges: Vec<_> = parts.iter().flat_map(|part| of(&part.region)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    };
    let (xs, ys) = (edges(|region| [region.x0, region.x1]), edges(|region| [region.y0, region.y1]));
    let within = |edges: &[u32], from: u32, to: u32| {
        let [from, to] = [from, to].map(|edge| edges.partition_point(|other| *other < edge));
        edges[from..=to].windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
    };
    let pieces = |part: &Part| {
        let Region { x0, y0, x1, y1 } = part.region;
        let (columns, samples) = (within(&xs, x0, x1), part.samples.clone());
        let row = move |[y0, y1]: [u32; 2]| {
            let samples = samples.clone();
            let piece = move |[x0, x1]: [u32; 2]| Part { region: Region { x0, y0, x1, y1 }, samples: samples.clone() };
            columns.clone().into_iter().map(piece)
        };
        within(&ys, y0, y1).into_iter().flat_map(row)
    };
    let split: Vec<_> = parts.iter().flat_map(pieces).take(MOST_PARTS + 1).collect();
    if split.len() > MOST_PARTS { parts } else { split }
}

/// Sorts by `key` and joins parts that differ in its last two numbers alone, an interval, where these meet.
fn join(parts: &mut Vec<Part>, key: fn(&Part) -> [u32; 6]) {
    parts.sort_unstable_by_key(key);
    parts.dedup_by(|next, last| {
        let (a, b) = (key(last), key(next));
        let meet = a[..4].cmp(&b[..4]) == Ordering::Equal && a[5] == b[4];
        if meet {
            *last = last.hull(next);
        }
        meet
    });
}

/// `x0,y0,x1,y1:first..end`, separated by spaces.
impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, Part { region: Region { x0, y0, x1, y1 }, samples }) in self.0.iter().enumerate() {
            let space = if index > 0 { " " } else { "" };
            write!(f, "{space}{x0},{y0},{x1},{y1}:{}..{}", samples.start, samples.end)?;
        }
        Ok(())
    }
}

impl FromStr for Coverage {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<_> = text.split_whitespace().take(MOST_PARTS + 1).collect();
        if words.len() > MOST_PARTS {
            return Err(format!("lists more than {MOST_PARTS} parts"));
        }
        let parts: Option<Vec<_>> = words.into_iter().map(part).collect();
        let mut parts = parts.ok_or_else(|| "lists its samples in a way that makes no sense".to_string())?;
        parts.sort_unstable_by_key(Part::samples_key);
        for (index, part) in parts.iter().enumerate() {
            // Those that begin above the end of this part.
            let mut below = parts[index + 1..].iter().take_while(|other| other.region.y0 < part.region.y1);
            if below.any(|other| part.intersection(other).is_some()) {
                return Err("lists samples twice".into());
            }
        }
        Ok(Self::of(parts))
    }
}

fn part(word: &str) -> Option<Part> {
    let (region, samples) = word.split_once(':')?;
    let numbers: Option<Vec<u32>> = region.split(',').map(|number| number.parse().ok()).collect();
    let [x0, y0, x1, y1] = <[u32; 4]>::try_from(numbers?).ok()?;
    let (start, end) = samples.split_once("..")?;
    let samples = start.parse().ok()?..end.parse().ok()?;
    let fits = x0 < x1 && y0 < y1 && !samples.is_empty() && samples.end <= MOST_SAMPLES;
    fits.then_some(Part { region: Region { x0, y0, x1, y1 }, samples })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coverage(text: &str) -> Coverage {
        text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn parts_that_meet_are_one() {
        for (text, expected) in [
            ("0,0,8,8:4..6 0,0,8,8:0..4", "0,0,8,8:0..6"),
            ("0,0,4,4:0..1 4,4,8,8:0..1 0,4,4,8:0..1 4,0,8,4:0..1", "0,0,8,8:0..1"),
            ("0,0,8,8:0..4 0,0,8,4:4..8", "0,0,8,4:0..8 0,4,8,8:0..4"),
            ("", ""),
        ] {
            let found = coverage(text);
            assert_eq!(coverage(&found.to_string()), found, "{text}");
            assert_eq!(found.samples(), coverage(expected).samples(), "{text}");
            assert!(found.parts().len() <= coverage(expected).parts().len(), "{text}: {found}");
        }
    }

    #[test]
    fn the_same_samples_are_the_same_list() {
        let a = coverage("0,0,8,8:0..9 8,0,16,8:0..4 0,8,8,16:0..4 8,8,16,16:0..7");
        let cut = coverage("0,0,16,16:0..4 0,0,8,8:4..9 8,8,16,16:4..7");
        assert_eq!(a, cut);
        let cut = coverage("0,0,16,8:0..2 0,8,16,16:0..2 0,0,8,16:2..4 8,0,16,16:2..4 0,0,8,8:4..9 8,8,16,16:4..7");
        assert_eq!(a, cut);
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for text in ["0,0,8,8", "0,0,8:0..1", "0,0,8,8:1..1", "0,0,0,8:0..1", "0,0,8,8:0..3000000000", "x", "1:2:3"] {
            assert!(text.parse::<Coverage>().is_err(), "{text}");
        }
        assert!("0,0,8,8:0..4 7,7,9,9:3..5".parse::<Coverage>().is_err(), "an overlap");
        assert!("0,0,1,1:0..1 ".repeat(MOST_PARTS + 1).parse::<Coverage>().is_err(), "endless");
    }

    #[test]
    fn every_tile_may_have_samples_of_its_own() {
        let tile = |i: u32| {
            format!("{},{},{},{}:0..{}", i % 100 * 8, i / 100 * 8, i % 100 * 8 + 8, i / 100 * 8 + 8, 2 + i % 7)
        };
        let text = (0..10_000).map(tile).collect::<Vec<_>>().join(" ");
        assert_eq!(coverage(&text).samples(), (0..10_000).map(|i| 64 * (2 + i % 7)).sum::<u64>());
        assert!(format!("{text} 799,799,800,800:1..2").parse::<Coverage>().is_err(), "an overlap");
    }

    #[test]
    fn overlaps_and_gaps_are_found() {
        let a = coverage("0,0,8,8:0..4");
        assert_eq!(a.overlap(&coverage("0,0,8,8:4..8 8,0,9,8:0..4")), None);
        let both = Part { region: Region { x0: 7, y0: 2, x1: 8, y1: 3 }, samples: 3..4 };
        assert_eq!(a.overlap(&coverage("0,0,8,8:4..8 7,2,9,3:3..4")), Some(both));
        assert_eq!(a.gaps([8, 8]), []);
        let gaps = a.with(&coverage("0,0,8,4:6..8")).gaps([8, 8]);
        assert_eq!(gaps, [gap(4..6, &[[0, 0, 8, 8]]), gap(6..8, &[[0, 4, 8, 8]])]);
        let gaps = coverage("0,0,8,8:2..4").gaps([8, 9]);
        assert_eq!(gaps, [gap(0..2, &[[0, 0, 8, 9]]), gap(2..4, &[[0, 8, 8, 9]])]);
    }

    #[test]
    fn the_pixels_around_parts_are_few_rectangles() {
        for (parts, expected) in [
            ("2,2,6,6:0..1", &[[0, 0, 8, 2], [0, 2, 2, 6], [6, 2, 8, 6], [0, 6, 8, 8]][..]),
            ("0,0,4,8:0..1", &[[4, 0, 8, 8]]),
            ("0,0,4,4:0..1 4,4,8,8:0..1", &[[4, 0, 8, 4], [0, 4, 4, 8]]),
            ("0,0,2,8:0..1 6,0,8,8:0..1", &[[2, 0, 6, 8]]),
        ] {
            let [found] = &coverage(parts).gaps([8, 8])[..] else { panic!("one range of samples: {parts}") };
            let expected = gap(0..1, expected);
            assert_eq!(found.pixels, expected.pixels, "{parts}");
            assert_eq!(found.regions.len(), expected.regions.len(), "{parts}: {found:?}");
            let covered = found.regions.iter().map(|region| region.pixels()).sum::<u64>();
            assert_eq!(covered, found.pixels, "{parts}: {found:?}");
        }
    }

    /// What these rectangles lack.
    fn gap(samples: Range<u32>, regions: &[[u32; 4]]) -> Gap {
        let regions: Vec<_> = regions.iter().map(|&[x0, y0, x1, y1]| Region { x0, y0, x1, y1 }).collect();
        Gap { samples, pixels: regions.iter().map(|region| region.pixels()).sum(), regions }
    }

    #[test]
    fn what_is_missing_to_a_part_is_found() {
        let a = coverage("0,0,8,8:2..4 0,0,8,4:6..8");
        let missing = |text: &str| a.missing(&coverage(text).parts()[0]);
        assert_eq!(missing("0,0,8,8:2..4"), []);
        assert_eq!(missing("0,0,8,4:3..7"), [gap(4..6, &[[0, 0, 8, 4]])]);
        assert_eq!(missing("0,0,8,8:6..9"), [gap(6..8, &[[0, 4, 8, 8]]), gap(8..9, &[[0, 0, 8, 8]])]);
        assert_eq!(Coverage::default().missing(&coverage("0,0,2,2:0..3").parts()[0]).len(), 1);
    }
}
