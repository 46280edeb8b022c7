//! The phase function of a scene: which keys belong to which, their ranges, and files of tables.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use fogbow_kernels::phase::droplets::DIAMETERS;
use fogbow_kernels::phase::{Draine, PhaseFunction};

use super::document::Document;
use super::schema::{OneOrTwo, Phase, PhaseKind};
use crate::error::{Error, Result};

/// Largest |g|: of a sharper lobe single precision loses the shape, and the weights of some techniques their last
/// digits.
const SHARPEST: f64 = 0.9999;

/// Bytes of the largest table: some hundred thousand rows.
const LARGEST_TABLE: u64 = 16 << 20;

/// The keys of a phase function, and where errors find them.
struct Keys<'a> {
    document: &'a Document,
    /// Where they stand.
    at: &'a str,
    phase: &'a Phase,
}

/// The phase function that the keys at `at` describe.
///
/// # Errors
/// If a key is missing, out of range, or of another phase function, or the file of a table cannot be read.
pub fn function(document: &Document, at: &str, phase: &Phase) -> Result<PhaseFunction> {
    let keys = Keys { document, at, phase };
    keys.refuse_others()?;
    Ok(match phase.kind {
        PhaseKind::Isotropic => PhaseFunction::isotropic(),
        PhaseKind::Rayleigh => PhaseFunction::rayleigh(),
        PhaseKind::HenyeyGreenstein => PhaseFunction::henyey_greenstein(keys.lobe()?),
        PhaseKind::TwoLobe => PhaseFunction::two_lobe(keys.lobes()?, keys.number("weight", phase.weight, 0.0..=1.0)?),
        PhaseKind::Draine => {
            PhaseFunction::draine(keys.lobe()?, keys.number("alpha", phase.alpha, 0.0..=Draine::LARGEST_ALPHA)?)
        }
        PhaseKind::Droplets => PhaseFunction::droplets(keys.number("diameter_um", phase.diameter_um, DIAMETERS)?),
        PhaseKind::Tabulated => keys.table()?,
    })
}

impl Keys<'_> {
    /// An error about the key `name`.
    fn wrong(&self, name: &str, finding: impl core::fmt::Display, remedy: &str) -> Error {
        let path = format!("{}.{name}", self.at);
        self.document.error(&path, format!("{path} is {finding}"), remedy)
    }

    /// An error about a key that the phase function needs.
    fn missing(&self, name: &str, remedy: &str) -> Error {
        let finding = format!("{}.{name} is missing, but the phase function is {}", self.at, self.phase.kind.name());
        self.document.error(self.at, finding, remedy)
    }

    /// Keys that belong to other phase functions are mistakes.
    fn refuse_others(&self) -> Result<()> {
        use PhaseKind::{Draine, Droplets, HenyeyGreenstein, Tabulated, TwoLobe};
        let Phase { kind, g, weight, alpha, diameter_um, file } = self.phase;
        let keys: [(&str, bool, &[PhaseKind]); 5] = [
            ("g", g.is_some(), &[HenyeyGreenstein, TwoLobe, Draine]),
            ("weight", weight.is_some(), &[TwoLobe]),
            ("alpha", alpha.is_some(), &[Draine]),
            ("diameter_um", diameter_um.is_some(), &[Droplets]),
            ("file", file.is_some(), &[Tabulated]),
        ];
        match keys.into_iter().find(|(_, is_given, kinds)| *is_given && !kinds.contains(kind)) {
            None => Ok(()),
            Some((name, _, kinds)) => {
                let finding = format!("given, but the phase function is {}", kind.name());
                let others: Vec<_> = kinds.iter().map(|kind| format!("{:?}", kind.name())).collect();
                let remedy = format!("leave it out, or write type = {}", others.join(" or "));
                Err(self.wrong(name, finding, &remedy))
            }
        }
    }

    /// A number that must be given, in `range`.
    fn number(&self, name: &str, value: Option<f64>, range: core::ops::RangeInclusive<f32>) -> Result<f32> {
        let remedy = format!("give a number from {:?} to {:?}", range.start(), range.end());
        let value = value.ok_or_else(|| self.missing(name, &remedy))?;
        let ok = (f64::from(*range.start())..=f64::from(*range.end())).contains(&value);
        if ok { Ok(value as f32) } else { Err(self.wrong(name, format!("{value:?}"), &remedy)) }
    }

    /// One mean cosine.
    fn lobe(&self) -> Result<f32> {
        let remedy = "give a mean cosine from -0.9999 to 0.9999";
        match self.phase.g {
            None if self.phase.kind == PhaseKind::HenyeyGreenstein => Ok(0.0),
            None => Err(self.missing("g", remedy)),
            Some(OneOrTwo::One(g)) if g.abs() <= SHARPEST => Ok(g as f32),
            Some(OneOrTwo::One(g)) => Err(self.wrong("g", format!("{g:?}"), remedy)),
            Some(OneOrTwo::Two(two)) => Err(self.wrong("g", format!("{two:?}, two lobes"), remedy)),
        }
    }

    /// Two mean cosines.
    fn lobes(&self) -> Result<[f32; 2]> {
        let remedy = "give two mean cosines from -0.9999 to 0.9999, for example g = [0.9, -0.3]";
        match self.phase.g {
            None => Err(self.missing("g", remedy)),
            Some(OneOrTwo::Two(two)) if two.iter().all(|g| g.abs() <= SHARPEST) => Ok(two.map(|g| g as f32)),
            Some(OneOrTwo::Two(two)) => Err(self.wrong("g", format!("{two:?}"), remedy)),
            Some(OneOrTwo::One(g)) => Err(self.wrong("g", format!("{g:?}, one lobe"), remedy)),
        }
    }

    /// The table in the file.
    fn table(&self) -> Result<PhaseFunction> {
        let remedy = "give the path of a CSV file with rows of cosine and value";
        let file = self.phase.file.as_ref().ok_or_else(|| self.missing("file", remedy))?;
        let path = self.document.folder().join(file);
        table(&path, remedy).map_err(|error| self.document.error_of_file(&format!("{}.file", self.at), error))
    }
}

/// The table in the file at `path`.
fn table(path: &Path, remedy: &str) -> Result<PhaseFunction> {
    let text = read(path).map_err(|finding| Error::failure(path.display(), finding, remedy))?;
    let rows = rows(&text).map_err(|(line, finding)| {
        let remedy = "write a cosine and a value, for example 0.5, 1.2";
        Error::failure(format!("{}:{line}", path.display()), finding, remedy)
    })?;
    let remedy = "write rows of cosine and value, by ascending cosine from -1 to 1";
    PhaseFunction::tabulated(&rows).map_err(|finding| Error::failure(path.display(), finding, remedy))
}

/// The text of a file of at most [`LARGEST_TABLE`] bytes; of a larger one, or of one without end, no more is read.
fn read(path: &Path) -> core::result::Result<String, String> {
    let mut text = String::new();
    let read = File::open(path).and_then(|file| file.take(LARGEST_TABLE + 1).read_to_string(&mut text));
    read.map_err(|error| format!("cannot be read: {error}"))?;
    if text.len() as u64 <= LARGEST_TABLE {
        return Ok(text);
    }
    Err(format!("is larger than {} MiB, too large for a table", LARGEST_TABLE >> 20))
}

/// Rows of two numbers; lines that are empty, begin with `#`, or stand first and are no numbers are passed by. Else the
/// number of a faulty line, and what is wrong with it.
fn rows(text: &str) -> core::result::Result<Vec<(f64, f64)>, (usize, String)> {
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<Option<f64>> = line.split([',', ';', '\t']).map(|field| field.trim().parse().ok()).collect();
        match fields[..] {
            [Some(cosine), Some(value)] => rows.push((cosine, value)),
            _ if rows.is_empty() && fields.iter().all(Option::is_none) => {}
            _ => return Err((index + 1, format!("{line:?} is not a pair of numbers"))),
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_may_have_a_heading_and_comments() {
        let text = "cosine, value\n# measured\n-1, 0.5\n\n 0.5,1e-1\n1;2\n";
        assert_eq!(rows(text), Ok(vec![(-1.0, 0.5), (0.5, 0.1), (1.0, 2.0)]));
        assert_eq!(rows("-1, 1\n0.5\n"), Err((2, "\"0.5\" is not a pair of numbers".into())));
        assert_eq!(rows("-1, 1\na, b\n").map_err(|(line, _)| line), Err(2));
    }
}
