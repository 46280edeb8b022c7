//! Values of flags: what they are read as, and what is said if they cannot be.

use core::ops::RangeInclusive;
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use fogbow_kernels::pipeline::Stage;

use crate::error::{Error, Result};
use crate::scene::schema::{MOST_SAMPLES, MOST_SEGMENTS};
use crate::session::Reference;

/// The last frame there can be.
const LAST_FRAME: u32 = 999_999_999;

/// `--from`: a point.
pub fn point(text: &str) -> Result<[f64; 3]> {
    triple(text).map_or_else(|| refuse("--from", text, "is no point", "give x,y,z in metres, for example 0,1.5,-3"), Ok)
}

/// `--dir`: a direction, made a unit vector.
pub fn direction(text: &str) -> Result<[f64; 3]> {
    let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = triple(text).filter(|v| length(v) > 0.0 && length(v).is_finite()).map(|v| v.map(|x| x / length(&v)));
    unit.map_or_else(|| refuse("--dir", text, "is no direction", "give x,y,z, not all 0, for example 0,0,1"), Ok)
}

/// Three finite numbers.
fn triple(text: &str) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    numbers?.try_into().ok().filter(|v: &[f64; 3]| v.iter().all(|x| x.is_finite()))
}

/// `--to`: any light, or the one of this number.
pub fn target(text: &str) -> Result<LightChoice> {
    let number = text.strip_prefix("light[").and_then(|rest| rest.strip_suffix(']'));
    match (text, number.map(str::parse)) {
        ("light", _) => Ok(LightChoice(None)),
        (_, Some(Ok(number))) => Ok(LightChoice(Some(number))),
        _ => refuse("--to", text, "is no light", "give light for any, or light[0] for the first light of the scene"),
    }
}

/// The light that paths lead to, by its place in the scene; none for any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightChoice(pub Option<u32>);

/// `--budget`
pub fn budget(text: &str) -> Result<Duration> {
    match span("--budget", text)? {
        Duration::ZERO => refuse("--budget", text, "is no time to render anything", "give some, for example 60s"),
        budget => Ok(budget),
    }
}

/// `--references`
pub fn more_for_references(text: &str) -> Result<Duration> {
    span("--references", text)
}

fn span(flag: &str, text: &str) -> Result<Duration> {
    duration(text)
        .or_else(|finding| refuse(flag, text, finding, "give numbers with units, for example 60s, 5min or 1h"))
}

/// The error that `flag` cannot be followed by `value`.
pub(super) fn refuse<T>(flag: &str, value: &str, finding: impl core::fmt::Display, remedy: &str) -> Result<T> {
    Err(Error::usage(format!("{flag} {value}"), finding, remedy))
}

/// `--reference`
pub fn stage(name: &str) -> Result<Reference> {
    if name == "all" {
        return Ok(Reference::All);
    }
    let names: Vec<_> = Stage::ALL.iter().map(|stage| stage.name()).collect();
    let remedy = format!("name one of all, {}; if this is the scene, put it before --reference", names.join(", "));
    name.parse().map(Reference::One).or_else(|_| refuse("--reference", name, "is not a stage", &remedy))
}

/// `--noise`
pub fn noise(text: &str) -> Result<f64> {
    match text.parse() {
        Ok(noise) if noise > 0.0 && noise < f64::INFINITY => Ok(noise),
        _ => refuse("--noise", text, "is not a fraction above 0", "give a fraction, for example 0.01 for 1 %"),
    }
}

/// `--time`
pub fn time(text: &str) -> Result<Duration> {
    duration(text)
        .or_else(|finding| refuse("--time", text, finding, "give numbers with units, for example 90s, 5min or 1h30m"))
}

/// A duration, or what is wrong with it.
fn duration(text: &str) -> core::result::Result<Duration, &'static str> {
    humantime::parse_duration(text).map_err(|error| match error {
        humantime::DurationError::NumberOverflow => "is too long or too short",
        _ => "is not a duration",
    })
}

/// When checkpoints are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checkpoints {
    /// Never.
    Off,
    /// So often.
    Every(Duration),
}

/// `--checkpoint`
pub fn checkpoints(text: &str) -> Result<Checkpoints> {
    if text == "off" {
        return Ok(Checkpoints::Off);
    }
    let interval = duration(text)
        .and_then(|interval| if interval.is_zero() { Err("must be longer than 0") } else { Ok(interval) });
    interval.map(Checkpoints::Every).or_else(|finding| {
        refuse("--checkpoint", text, finding, "give the time between checkpoints, for example 60s or 5min, or off")
    })
}

/// `--mesc`
pub fn mesc(text: &str) -> Result<f64> {
    text.parse().or_else(|_| refuse("--mesc", text, "is not a number", "give a number of segments above 0"))
}

/// `--max-segments`
pub fn segments(text: &str) -> Result<toml::Value> {
    if text == "auto" {
        Ok(text.into())
    } else {
        whole_number_or("--max-segments", 1..=MOST_SEGMENTS, " or \"auto\"")(text).map(Into::into)
    }
}

/// `--exposure`
pub fn exposure(text: &str) -> Result<toml::Value> {
    if text == "auto" {
        return Ok(text.into());
    }
    let stops = text.parse::<f64>().map(toml::Value::from);
    stops.or_else(|_| {
        refuse("--exposure", text, "is not a number of stops", "give a number, for example -1.5 or 2, or auto")
    })
}

/// `--threads`
pub fn threads(text: &str) -> Result<u32> {
    match text.parse() {
        Ok(threads @ 1..=1024) => Ok(threads),
        _ => refuse("--threads", text, "is not a valid number of threads", "give a whole number from 1 to 1024"),
    }
}

/// A parser of the whole numbers in `range` after `flag`.
pub fn whole_number(flag: &'static str, range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<i64> + Clone {
    whole_number_or(flag, range, "")
}

/// The same, where the remedy says what `else_` may be given.
fn whole_number_or(
    flag: &'static str,
    range: RangeInclusive<u32>,
    else_: &'static str,
) -> impl Fn(&str) -> Result<i64> + Clone {
    use core::num::IntErrorKind::{NegOverflow, PosOverflow};
    move |text| {
        let finding = match text.parse() {
            Ok(number) if u32::try_from(number).is_ok_and(|number| range.contains(&number)) => return Ok(number),
            Ok(_) => "is out of range",
            Err(error) if matches!(error.kind(), PosOverflow | NegOverflow) => "is out of range",
            Err(_) => "is not a whole number",
        };
        refuse(flag, text, finding, &format!("give a whole number from {} to {}{else_}", range.start(), range.end()))
    }
}

/// `--serve`
pub fn serve(text: &str) -> Result<SocketAddr> {
    let local = |port| SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let of_name = || text.strip_prefix("localhost:").and_then(|port| port.parse().ok()).map(local);
    let address = text.parse().map(local).ok().or_else(|| text.parse().ok()).or_else(of_name);
    let remedy = "give a port from 0 to 65535, or an address of this machine and a port, for example 0.0.0.0:8080";
    address.map_or_else(|| refuse("--serve", text, "is not a port", remedy), Ok)
}

/// `--preview`
pub fn preview(text: &str) -> Result<String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty()).and_then(|(_, port)| port.parse().ok());
    match port {
        Some(1..=u16::MAX) => Ok(text.into()),
        _ => refuse("--preview", text, "is not a host and a port", "give those of tev, for example 127.0.0.1:14158"),
    }
}

/// Numbers of samples, from the first to before the last.
pub type SampleRange = core::ops::Range<u32>;

/// Numbers of frames, from the first to the last.
pub type FrameRange = RangeInclusive<u32>;

/// `--frames`
pub fn frames(text: &str) -> Result<FrameRange> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|frame| *frame <= LAST_FRAME);
    let finding = match (number(first), number(last)) {
        (Some(first), Some(last)) if first <= last => return Ok(first..=last),
        (Some(_), Some(_)) => "ends before it begins",
        _ => "is not a range of frames",
    };
    refuse("--frames", text, finding, "give A-B, from 0 to 999999999, for example 1-100, or one frame, for example 7")
}

/// `--fps`
pub fn fps(text: &str) -> Result<f64> {
    match text.parse() {
        Ok(fps) if fps > 0.0 && fps < f64::INFINITY => Ok(fps),
        _ => refuse("--fps", text, "is not a number above 0", "give frames per second, for example 24 or 29.97"),
    }
}

/// `--sample-range`
pub fn sample_range(text: &str) -> Result<SampleRange> {
    samples("--sample-range", text)
}

/// `--expect`
pub fn expected(text: &str) -> Result<SampleRange> {
    samples("--expect", text)
}

/// The range of samples after `flag`.
fn samples(flag: &str, text: &str) -> Result<SampleRange> {
    let number = |text: &str| match text.trim() {
        "" => None,
        digits if digits.bytes().all(|byte| byte.is_ascii_digit()) => Some(digits.parse().unwrap_or(u32::MAX)),
        _ => None,
    };
    let finding = match text.split_once("..").and_then(|(a, b)| Some(number(a)?..number(b)?)) {
        None => "is not a range of samples".into(),
        Some(range) if range.end > MOST_SAMPLES => {
            format!("reaches beyond {MOST_SAMPLES}, the most that a pixel can have")
        }
        Some(range) if range.is_empty() => "is empty".into(),
        Some(range) => return Ok(range),
    };
    refuse(flag, text, finding, "give A..B, not including B, for example 0..64")
}

/// `--size`
pub fn size(text: &str) -> Result<[u32; 2]> {
    let numbers = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let remedy = "give width and height in pixels, for example 1920x1080";
    numbers.map_or_else(|| refuse("--size", text, "is not a size", remedy), Ok)
}

/// `--crop`
pub fn crop(text: &str) -> Result<[u32; 4]> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| <[u32; 4]>::try_from(numbers).ok());
    let remedy = "give X0,Y0,X1,Y1, not including X1 and Y1, for example 0,0,64,64";
    numbers.map_or_else(|| refuse("--crop", text, "is not a crop window", remedy), Ok)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_crops_are_read_as_written() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        assert_eq!(crop("1, 2,3,4"), Ok([1, 2, 3, 4]));
        for wrong in ["1920", "x", "-1x3", "1x2x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert!(crop("1,2,3").is_err() && crop("1,2,3,x").is_err());
    }
}
