//! What was passed over, for the person at the terminal: each kind of thing once, with all its places.

use core::fmt::Display;

use crate::warning::Warning;

/// Warnings so far.
#[derive(Debug, Default)]
pub struct Warnings {
    entries: Vec<(&'static str, Vec<String>)>,
}

impl Warnings {
    /// Notes `finding` at `place`.
    pub fn note<P: Display>(&mut self, finding: &'static str, place: impl FnOnce() -> P) {
        let place = place().to_string();
        match self.entries.iter_mut().find(|entry| entry.0 == finding) {
            Some((_, places)) => places.push(place),
            None => self.entries.push((finding, vec![place])),
        }
    }

    /// All of them, of `file`.
    pub fn of_file(self, file: &str) -> Vec<Warning> {
        let warning = |(finding, places)| Warning { places, ..Warning::new(file, finding) };
        self.entries.into_iter().map(warning).collect()
    }
}
