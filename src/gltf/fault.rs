//! What is wrong with a model or a volume, said from the inside out: where something is found, only the finding and the
//! remedy are known; the object, its parent and at last the file are added on the way up.

use core::fmt::Display;

use crate::error::{Error, Result};

/// Characters of a name that messages repeat.
const LONGEST_NAME: usize = 60;

/// A finding, its remedy, and the objects around it.
#[derive(Debug)]
pub struct Fault {
    /// From the innermost object outward.
    places: Vec<String>,
    finding: String,
    remedy: String,
}

/// A result whose error is a [`Fault`].
pub type Checked<T> = core::result::Result<T, Fault>;

impl Fault {
    /// A fault at a place that is still unknown.
    pub fn new(finding: impl Display, remedy: impl Display) -> Self {
        Self { places: Vec::new(), finding: finding.to_string(), remedy: remedy.to_string() }
    }

    /// What was found.
    pub fn finding(&self) -> &str {
        &self.finding
    }

    /// The same, inside `place`.
    pub fn at(mut self, place: impl Display) -> Self {
        self.places.push(place.to_string());
        self
    }

    /// The error for whoever gave the file.
    pub fn in_file(mut self, file: &str) -> Error {
        self.places.reverse();
        let place = if self.places.is_empty() { file.into() } else { format!("{file}: {}", self.places.join(", ")) };
        Error::failure(place, self.finding, self.remedy)
    }
}

/// Adds a place to the fault of a result; the place is only spelled out if there is one.
pub trait At<T> {
    /// The same result, a fault being inside `place`.
    fn at<P: Display>(self, place: impl FnOnce() -> P) -> Checked<T>;
}

impl<T> At<T> for Checked<T> {
    fn at<P: Display>(self, place: impl FnOnce() -> P) -> Self {
        self.map_err(|fault| fault.at(place()))
    }
}

/// Adds the file to the fault of a result.
pub trait InFile<T> {
    /// The same result for whoever gave `file`.
    fn in_file(self, file: &str) -> Result<T>;
}

impl<T> InFile<T> for Checked<T> {
    fn in_file(self, file: &str) -> Result<T> {
        self.map_err(|fault| fault.in_file(file))
    }
}

/// A fault unless `ok`.
pub fn require<F: Display>(ok: bool, finding: impl FnOnce() -> F, remedy: &str) -> Checked<()> {
    if ok { Ok(()) } else { Err(Fault::new(finding(), remedy)) }
}

/// The entry of a list that some key refers to; `kind` is what entries are called.
pub fn entry<'a, T>(list: &'a [T], kind: &str, index: usize) -> Checked<&'a T> {
    list.get(index).ok_or_else(|| {
        let finding = match list.len() {
            0 => format!("refers to {kind} {index}, but the file has none"),
            len => format!("refers to {kind} {index}, but the last one is {}", len - 1),
        };
        let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        Fault::new(finding, format!("refer to {article} {kind} in the file; indices begin at 0"))
    })
}

/// What an object is called in messages: `mesh 3 "Wall"`.
pub fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {index} {}", quoted(name)),
        _ => format!("{kind} {index}"),
    }
}

/// Text of the file as messages repeat it: in quotes, shortened, without control characters.
pub fn quoted(text: &str) -> String {
    match text.char_indices().nth(LONGEST_NAME) {
        Some((end, _)) => format!("{:?}...", &text[..end]),
        None => format!("{text:?}"),
    }
}
