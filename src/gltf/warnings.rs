//! What was passed over, for the person at the terminal: each kind of thing once, with its first place and how often.

use core::fmt::Display;

/// Warnings so far.
#[derive(Debug, Default)]
pub struct Warnings {
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    place: String,
    finding: &'static str,
    count: usize,
}

impl Warnings {
    /// Notes `finding` at `place`, which is only spelled out the first time.
    pub fn note<P: Display>(&mut self, finding: &'static str, place: impl FnOnce() -> P) {
        match self.entries.iter_mut().find(|entry| entry.finding == finding) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { place: place().to_string(), finding, count: 1 }),
        }
    }

    /// As text: `node 3 "Lamp": finding (and 2 more)`.
    pub fn into_lines(self) -> Vec<String> {
        let line = |Entry { place, finding, count }: Entry| match count {
            1 => format!("{place}: {finding}"),
            _ => format!("{place}: {finding} (and {} more)", count - 1),
        };
        self.entries.into_iter().map(line).collect()
    }
}
