//! Whether two renders take the same samples: what samples depend on, as entries of headers.

use core::fmt;

use toml::Value;

use crate::scene::contents;

/// An entry of a header: name and text.
pub type Entry = (String, String);

/// Entries of which the pilot decides.
pub const PILOTED: [&str; 4] = ["starts", "survival", "aimed", "roulette"];

/// Entries that have to be the same, those that say most first: what the pilot decides follows from the scene.
const DECISIVE: [&str; 10] =
    ["version", FRAME, "reference", "technique", "aov", "scene_hash", "starts", "survival", "aimed", "roulette"];

/// The entry with hashes of the scene's files: they may differ where no sample does, and say why samples do.
pub const FILES: &str = "files";

/// The number of a frame, which only frames of animations have.
const FRAME: &str = "frame";

/// Keys of a scene on which no sample depends.
const IRRELEVANT: [&str; 2] = ["render.samples", "film.exposure"];

/// Entries that are called by the flags that they come from.
const FLAGS: [(&str, &str); 4] = [
    ("first_sample", "the first sample of --sample-range"),
    ("region", "the region of --crop"),
    ("adaptive", "--adaptive"),
    ("reference", "--reference"),
];

/// Something that is not the same in two renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What it is: a key of the scene, a flag, or an entry of the header.
    pub what: String,
    /// What it is in the one and in the other, if that can be told in a few words.
    pub values: Option<[String; 2]>,
    /// Whether it is what files of the scene contain, so that no flag makes up for it.
    pub is_in_files: bool,
}

/// `medium.phase.g is 0.5 there, 0.6 here`, of the other and of this one.
impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.values {
            Some([there, here]) => write!(f, "{} is {there} there, {here} here", self.what),
            None => write!(f, "{}", self.what),
        }
    }
}

/// The text of the entry called `name`.
pub fn text<'a>(entries: &'a [Entry], name: &str) -> Option<&'a str> {
    entries.iter().find(|(entry, _)| entry == name).map(|(_, text)| text.as_str())
}

/// What differs between the samples of two renders, given the headers of the one that is `there` and of the one that is
/// `here`; none if they take the same samples. Entries called `more` are compared, too, and those that `here` lacks are
/// not.
pub fn difference(there: &[Entry], here: &[Entry], more: &[&str]) -> Option<Difference> {
    if text(there, "scene_hash") != text(here, "scene_hash")
        && let Some(difference) = key(there, here)
    {
        return Some(difference);
    }
    let is_known = |name: &str| text(here, name).is_some() || name == FRAME;
    let differs = |name: &&str| is_known(name) && text(there, name) != text(here, name);
    let what = DECISIVE.iter().chain(more).copied().find(differs)?;
    if what == "scene_hash" {
        return Some(in_files(there, here));
    }
    let value = |entries| quoted(text(entries, what).unwrap_or(if what == FRAME { "none" } else { "unknown" }));
    let name = FLAGS.iter().find(|(entry, _)| *entry == what).map_or(what, |(_, name)| name);
    Some(Difference { what: name.into(), values: Some([value(there), value(here)]), is_in_files: false })
}

/// The difference that files of the scene have other contents: which, if both headers say.
fn in_files(there: &[Entry], here: &[Entry]) -> Difference {
    let hashes = text(there, FILES).zip(text(here, FILES));
    let names = hashes.map_or_else(Vec::new, |(there, here)| contents::changed(there, here));
    let what = match names.as_slice() {
        [] => "the content of a file of the scene is another one".into(),
        [name] => format!("the content of {name} is another one"),
        names => format!("the contents of {} are others", quoted(&names.join(", "))),
    };
    Difference { what, values: None, is_in_files: true }
}

/// The first key of the scene that differs.
fn key(there: &[Entry], here: &[Entry]) -> Option<Difference> {
    let keys = |entries| {
        let mut keys = Vec::new();
        flatten("", &Value::Table(text(entries, "settings")?.parse().ok()?), &mut keys);
        Some(keys)
    };
    let (there, here) = (keys(there)?, keys(here)?);
    let names = there.iter().chain(&here).map(|(name, _)| name);
    let value = |keys: &[Entry], name: &str| quoted(text(keys, name).unwrap_or("not set"));
    let differs = |name: &&String| !IRRELEVANT.contains(&name.as_str()) && text(&there, name) != text(&here, name);
    let name = names.filter(|name| differs(name)).min()?;
    let values = Some([value(&there, name), value(&here, name)]);
    Some(Difference { what: name.clone(), values, is_in_files: false })
}

/// All values of a tree by their keys, as `--set` has them.
fn flatten(path: &str, value: &Value, keys: &mut Vec<Entry>) {
    match value {
        Value::Table(table) => table.iter().for_each(|(name, value)| {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            flatten(&path, value, keys);
        }),
        Value::Array(list) if list.iter().any(Value::is_table) => {
            list.iter().enumerate().for_each(|(index, value)| flatten(&format!("{path}[{index}]"), value, keys));
        }
        value => keys.push((path.into(), value.to_string())),
    }
}

/// A text in a line: not longer than people read.
fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(hash: &str, settings: &str, starts: &str) -> Vec<Entry> {
        [("scene_hash", hash), ("settings", settings), ("starts", starts)].map(|(a, b)| (a.into(), b.into())).into()
    }

    fn found(there: &[Entry], here: &[Entry]) -> Option<String> {
        difference(there, here, &[]).map(|difference| difference.to_string())
    }

    #[test]
    fn what_differs_is_named() {
        let a = entries("1", "[render]\nsamples = 4\n[[light]]\nradius = 1.5", "1");
        assert_eq!(found(&a, &entries("1", "[render]\nsamples = 8\n[[light]]\nradius = 1.5", "1")), None);
        let other = entries("2", "[render]\nsamples = 8\n[[light]]\nradius = 2", "1");
        assert_eq!(found(&a, &other).as_deref(), Some("light[0].radius is 1.5 there, 2 here"));
        let other = entries("2", "[render]\nsamples = 8\nseed = 2\n[[light]]\nradius = 1.5", "1");
        assert_eq!(found(&a, &other).as_deref(), Some("render.seed is not set there, 2 here"));
        let other = entries("2", &a[1].1, "1");
        assert_eq!(found(&a, &other).as_deref(), Some("the content of a file of the scene is another one"));
        let piloted = entries("2", &a[1].1, "4");
        assert_eq!(found(&a, &piloted), found(&a, &other), "what the pilot chose for the file is no cause");
        let with = |entries: &[Entry], files: &str| [entries, &[(FILES.to_string(), files.to_string())]].concat();
        let found_files = found(&with(&a, "1 a.glb\n1 b.bin"), &with(&other, "1 b.bin\n2 a.glb"));
        assert_eq!(found_files.as_deref(), Some("the content of a.glb is another one"));
        assert_eq!(found(&with(&a, "1 a.glb"), &with(&a, "2 a.glb")), None, "nothing that samples depend on");
        assert_eq!(found(&a, &entries("1", &a[1].1, "2")).as_deref(), Some("starts is 1 there, 2 here"));
        let frame = |number: &str| [&a[..], &[("frame".to_string(), number.to_string())]].concat();
        assert_eq!(found(&frame("1"), &frame("2")).as_deref(), Some("frame is 1 there, 2 here"));
        assert_eq!(found(&frame("1"), &a).as_deref(), Some("frame is 1 there, none here"));
        let region = |region: &str| [&a[..], &[("region".to_string(), region.to_string())]].concat();
        let found_more = difference(&region("0,0,8,8"), &region("0,0,4,8"), &["region"]).map(|found| found.to_string());
        assert_eq!(found_more.as_deref(), Some("the region of --crop is 0,0,8,8 there, 0,0,4,8 here"));
        assert_eq!(found(&a, &a[..2]), None, "what is not known yet is not compared");
    }
}
