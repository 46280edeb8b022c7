//! Radiance images, which other programs call .hdr: pixels of three mantissas and an exponent they share, in rows of
//! which equal bytes or pixels may be counted.
//!
//! What is malformed is an error, and never a panic, and memory is taken for what is in the file, not for what it claims.
//!
//! This is our own reader, because no library would do: image 0.25 leaves the exposure out, takes memory for whatever
//! size a file states, counts runs beyond all numbers, and brings a whole colour management; zune-hdr 0.5 takes what a
//! truncated file lacks for black, and misreads radiances beyond 2^31.

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use super::{Image, LARGEST_IMAGE};
use crate::error::Result;
use crate::gltf::fault::{Checked, Fault, InFile, quoted, require};

/// What every file begins with, before the name of a program.
pub const MAGIC: &[u8] = b"#?";
/// The only kind of pixels that is read.
const FORMAT: &str = "32-bit_rle_rgbe";
/// Bytes of the longest header.
const LONGEST_HEADER: u64 = 1 << 16;
/// Widths of rows that may be stored one component after the other.
const BY_COMPONENT: core::ops::RangeInclusive<usize> = 8..=0x7fff;
/// What is added to exponents, with the bits of a mantissa.
const BIAS: i32 = 128 + 8;
const AGAIN: &str = "copy or save it again";

/// A pixel: red, green and blue mantissas, and their exponent.
type Rgbe = [u8; 4];

/// What a header says.
struct Header {
    width: usize,
    height: usize,
    /// What pixels have been multiplied by, per channel.
    factors: [f64; 3],
}

/// Reads the planes R, G and B of the file at `path`, free of any exposure.
///
/// # Errors
/// If the file cannot be read, is not a whole Radiance image, or has more than 2^27 pixels.
pub fn read_image(path: &Path) -> Result<Image> {
    let open = || File::open(path).map_err(unreadable);
    open().and_then(|file| image(&mut BufReader::new(file))).in_file(&path.display().to_string())
}

/// The same of a file that is in memory; `file` is what errors call it.
///
/// # Errors
/// As [`read_image`].
pub fn read_bytes(file: &str, mut bytes: &[u8]) -> Result<Image> {
    image(&mut bytes).in_file(file)
}

fn image(input: &mut impl BufRead) -> Checked<Image> {
    let Header { width, height, factors } = header(&mut input.by_ref().take(LONGEST_HEADER))?;
    let (mut row, mut planes) = (Vec::new(), [const { Vec::new() }; 3]);
    for number in 0..height {
        read_row(input, width, &mut row).map_err(|fault| fault.at(format!("row {number}")))?;
        for (channel, (plane, factor)) in planes.iter_mut().zip(factors).enumerate() {
            let value = |pixel: &Rgbe| {
                let unit = if pixel[3] == 0 { 0.0 } else { f64::from(i32::from(pixel[3]) - BIAS).exp2() };
                (f64::from(pixel[channel]) * unit / factor) as f32
            };
            plane.extend(row.iter().map(value));
        }
    }
    let channels = ["R", "G", "B"].map(String::from).into_iter().zip(planes).collect();
    Ok(Image { width, height, channels, header: Vec::new() })
}

fn header(input: &mut impl BufRead) -> Checked<Header> {
    let is_radiance = line(input)?.as_bytes().starts_with(MAGIC);
    require(is_radiance, || "is not a Radiance image", "give a Radiance image")?;
    let mut factors = [1.0; 3];
    loop {
        let line = line(input)?;
        if line.is_empty() {
            break;
        }
        match line.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
            Some(("FORMAT", format)) => {
                let finding = || format!("has pixels of the format {}, not {FORMAT}", quoted(format));
                require(format == FORMAT, finding, "save it with red, green and blue pixels")?;
            }
            Some(("EXPOSURE", value)) => multiply(&mut factors, &[value; 3], &line)?,
            Some(("COLORCORR", values)) => {
                multiply(&mut factors, &values.split_whitespace().collect::<Vec<_>>(), &line)?
            }
            _ => {}
        }
    }
    let [width, height] = size(&line(input)?)?;
    let is_small = width.checked_mul(height).is_some_and(|pixels| pixels <= LARGEST_IMAGE);
    let finding = || format!("has {width}x{height} pixels, more than the limit of {LARGEST_IMAGE}");
    require(is_small, finding, "give a smaller image")?;
    Ok(Header { width, height, factors })
}

/// Multiplies `factors` by the numbers of a `line`, all above 0.
fn multiply(factors: &mut [f64; 3], numbers: &[&str], line: &str) -> Checked<()> {
    let numbers: Vec<f64> = numbers.iter().filter_map(|number| number.parse().ok()).collect();
    let ok = numbers.len() == 3 && numbers.iter().all(|number: &f64| number.is_normal() && *number > 0.0);
    require(ok, || format!("has the header {}, which is no factor of radiance", quoted(line)), AGAIN)?;
    factors.iter_mut().zip(numbers).for_each(|(factor, number)| *factor *= number);
    Ok(())
}

/// Width and height of a `line` like `-Y 512 +X 1024`.
fn size(line: &str) -> Checked<[usize; 2]> {
    let words: Vec<_> = line.split_whitespace().collect();
    let number = |word: &str| word.parse().ok().filter(|number| *number > 0);
    let found = match words[..] {
        ["-Y", height, "+X", width] => number(width).zip(number(height)),
        [rows, _, columns, _] if [rows, columns].iter().all(|word| ["+X", "-X", "+Y", "-Y"].contains(word)) => {
            let finding = format!("has its pixels in the order {}", quoted(line));
            return Err(Fault::new(finding, "save it row by row from the top left: -Y height +X width"));
        }
        _ => None,
    };
    let damaged = || Fault::new(format!("has no size, but {}", quoted(line)), AGAIN);
    found.map(|(width, height)| [width, height]).ok_or_else(damaged)
}

/// The next line, without its end.
fn line(input: &mut impl BufRead) -> Checked<String> {
    let mut bytes = Vec::new();
    input.read_until(b'\n', &mut bytes).map_err(unreadable)?;
    require(bytes.pop() == Some(b'\n'), || "has a header without an end", AGAIN)?;
    Ok(String::from_utf8_lossy(&bytes).trim_end().into())
}

/// Replaces the content of `row` by the next row, of `width` pixels.
fn read_row(input: &mut impl BufRead, width: usize, row: &mut Vec<Rgbe>) -> Checked<()> {
    row.clear();
    let first: Rgbe = array(input)?;
    match first {
        [2, 2, high @ ..128, low] if BY_COMPONENT.contains(&width) => {
            let said = usize::from(high) << 8 | usize::from(low);
            require(said == width, || format!("has {said} pixels instead of {width}"), AGAIN)?;
            row.resize(width, Rgbe::default());
            (0..4).try_for_each(|component| read_component(input, component, row))
        }
        first => read_pixels(input, first, width, row),
    }
}

/// Fills a component of a row, stored as runs of equal bytes and stretches of others.
fn read_component(input: &mut impl BufRead, component: usize, row: &mut [Rgbe]) -> Checked<()> {
    let mut rest = row;
    while !rest.is_empty() {
        let [count] = array(input)?;
        let (is_run, count) = if count > 128 { (true, usize::from(count) - 128) } else { (false, usize::from(count)) };
        require((1..=rest.len()).contains(&count), || "has more pixels than it should", AGAIN)?;
        let (stretch, behind) = rest.split_at_mut(count);
        if is_run {
            let [value] = array(input)?;
            stretch.iter_mut().for_each(|pixel| pixel[component] = value);
        } else {
            for pixel in stretch {
                [pixel[component]] = array(input)?;
            }
        }
        rest = behind;
    }
    Ok(())
}

/// Fills a row of pixels that begins with `first`; red, green and blue of 1 say how often the last one is repeated, the
/// lowest byte of that number first.
fn read_pixels(input: &mut impl BufRead, first: Rgbe, width: usize, row: &mut Vec<Rgbe>) -> Checked<()> {
    let (mut pixel, mut digit) = (first, 0);
    loop {
        match (pixel, row.last().copied()) {
            ([1, 1, 1, count], Some(last)) => {
                let left = width - row.len();
                let count = usize::from(count).checked_shl(8 * digit).filter(|count| digit < 4 && *count <= left);
                let count = count.ok_or_else(|| Fault::new("has more pixels than it should", AGAIN))?;
                row.resize(row.len() + count, last);
                digit += 1;
            }
            _ => {
                row.push(pixel);
                digit = 0;
            }
        }
        if row.len() == width {
            return Ok(());
        }
        pixel = array(input)?;
    }
}

fn array<const N: usize>(input: &mut impl BufRead) -> Checked<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

fn unreadable(error: std::io::Error) -> Fault {
    match error.kind() {
        ErrorKind::UnexpectedEof => Fault::new("is truncated: the file ends before the image does", AGAIN),
        _ => Fault::new(format!("cannot be read: {error}"), "check the path and its permissions"),
    }
}
