//! What a person should know of a scene that is rendered all the same.

use core::fmt;

use serde::Serialize;

/// Places that are named where not all are asked for.
const MOST_NAMED: usize = 4;

/// Something that is not rendered, or not as it is written: a finding, and all places of one file where it is so.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// The file.
    pub file: String,
    /// Where in it; none where it is the file as a whole.
    pub places: Vec<String>,
    /// What is so.
    pub finding: String,
}

impl Warning {
    /// `finding` of `file` as a whole.
    pub fn new(file: impl Into<String>, finding: impl Into<String>) -> Self {
        Self { file: file.into(), places: Vec::new(), finding: finding.into() }
    }
}

/// `file: place, place: finding`; where there are many places only the first, but all of them with `{:#}`.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, places, finding } = self;
        let named = if f.alternate() { places.len() } else { places.len().min(MOST_NAMED) };
        let list = places[..named].join(", ");
        match places.len() - named {
            _ if places.is_empty() => write!(f, "{file}: {finding}"),
            0 => write!(f, "{file}: {list}: {finding}"),
            more => write!(f, "{file}: {list} and {more} more (--verbose lists all): {finding}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_places_are_counted_unless_all_are_asked_for() {
        let at = |count: usize| Warning {
            places: (0..count).map(|i| format!("node {i}")).collect(),
            ..Warning::new("a.glb", "is odd")
        };
        assert_eq!(at(0).to_string(), "a.glb: is odd");
        assert_eq!(at(2).to_string(), "a.glb: node 0, node 1: is odd");
        let many = at(6);
        let first = "a.glb: node 0, node 1, node 2, node 3";
        assert_eq!(many.to_string(), format!("{first} and 2 more (--verbose lists all): is odd"));
        assert_eq!(format!("{many:#}"), format!("{first}, node 4, node 5: is odd"));
    }
}
