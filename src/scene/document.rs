//! Scene files and overrides as one tree of values that remembers where each of them stands.

mod overrides;
mod parser_messages;
mod places;

use core::fmt;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use toml::de::DeTable;
use toml::{Table, Value};

use crate::error::{Error, Kind, Result};
use crate::volume;
pub use overrides::Override;
use overrides::{LONGEST_KEY, Step, display, enter, steps};
pub(super) use parser_messages::words;
pub(super) use places::EXTRAS;
use places::{Place, note_extras, note_table, place_at};

/// Bytes of the largest scene file: some hundred thousand lights.
const LARGEST_FILE: u64 = 64 << 20;

/// Values with their places.
#[derive(Debug)]
pub struct Document {
    /// The file's values with the overrides in place: a table.
    pub values: Value,
    file: String,
    text: String,
    places: BTreeMap<String, Place>,
    is_model: bool,
}

impl Document {
    /// The folder that paths in the file are relative to.
    pub fn folder(&self) -> &Path {
        Path::new(&self.file).parent().unwrap_or(Path::new(""))
    }

    /// What errors call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Whether the file is a glTF file.
    pub fn is_model(&self) -> bool {
        self.is_model
    }

    /// Whether the file or a flag gives the value of `key`.
    pub fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Whether a flag gives the value at `path`.
    pub fn is_set_by_flag(&self, path: &str) -> bool {
        matches!(self.places.get(path), Some(Place::Flag(_)))
    }

    /// The document of a glTF file that is called `name` in its folder, with the `keys` of its extras.
    pub fn of_model(file: &str, name: &str, keys: Table) -> Self {
        let mut places = BTreeMap::new();
        let mut values = Value::Table(keys);
        note_extras(&mut places, "", &values);
        if let Value::Table(table) = &mut values {
            table.insert("geometry".into(), name.into());
        }
        Self { values, file: file.into(), text: String::new(), places, is_model: true }
    }

    /// Reads `path`.
    ///
    /// # Errors
    /// If the file cannot be read or is not TOML.
    pub fn read(path: &Path) -> Result<Self> {
        let file = path.display().to_string();
        if volume::is_volume(path) && path.is_file() {
            let remedy = "name it in a scene, as the grid of a volume: [[volume]] grid = { file = \"cloud.vdb\" }";
            return Err(Error::failure(file, "is an OpenVDB file, not a scene", remedy));
        }
        let bytes = read_small(path)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]);
            let remedy = "give a scene: a TOML file in UTF-8, a glTF file, or a folder with a scene.toml";
            Error::failure(place_at(&file, &valid, valid.len()), "is not a UTF-8 text file", remedy)
        })?;
        Self::parse(&file, &text)
    }

    /// Parses `text`, the content of `file`.
    ///
    /// # Errors
    /// If it is not TOML.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let malformed = |error: toml::de::Error| {
            let place = error.span().map_or_else(|| file.to_string(), |span| place_at(file, text, span.start));
            let words = parser_messages::words(error.message());
            let remedy = "write valid TOML; fogbow render --help-scene lists the keys of a scene";
            Error::failure(place, words.finding, words.remedy.unwrap_or_else(|| remedy.into()))
        };
        let mut places = BTreeMap::new();
        note_table(&mut places, "", DeTable::parse(text).map_err(malformed)?.get_ref());
        let values = Value::Table(text.parse().map_err(malformed)?);
        Ok(Self { values, file: file.into(), text: text.into(), places, is_model: false })
    }

    /// Puts all `changes` in the places of the file's values, one after the other.
    ///
    /// # Errors
    /// If one cannot be applied, or the value of a dedicated flag does not last: `--set` says something else.
    pub fn apply_all(&mut self, changes: Vec<Override>) -> Result<()> {
        let dedicated: Vec<_> = changes.iter().filter(|change| change.is_dedicated).cloned().collect();
        changes.into_iter().try_for_each(|change| self.apply(change))?;
        for Override { key, value, flag, .. } in dedicated {
            let now = self.value(&key);
            if now.is_none_or(|now| meaning(now) != meaning(&value)) {
                let finding = format!("contradicts {}", self.place_below(&key));
                return Err(Error::usage(flag, finding, "give only one of the two"));
            }
        }
        Ok(())
    }

    /// The value at `key`.
    fn value(&self, key: &str) -> Option<&Value> {
        steps(key).iter().try_fold(&self.values, |at, step| match step {
            Step::Key(key) => at.get(key),
            Step::Index(index) => at.get(index),
        })
    }

    /// The flag of the `--set` that last changed the value of `key`, or a part of it.
    fn place_below(&self, key: &str) -> String {
        let mut below = self.places.iter().filter(|(path, _)| is_at_or_below(path, key));
        let set = below.find_map(|(_, place)| match place {
            Place::Flag(flag) if flag.starts_with("--set") => Some(flag.clone()),
            _ => None,
        });
        set.unwrap_or_else(|| self.place(key))
    }

    /// Puts `change` in the place of the file's value.
    ///
    /// # Errors
    /// If its key leads through something that is not a table, or to a list entry that does not exist.
    pub fn apply(&mut self, change: Override) -> Result<()> {
        let steps = steps(&change.key);
        let refuse = |finding: String| {
            Error::usage(&change.flag, finding, "name a key of the scene; fogbow render --help-scene lists them")
        };
        let Some((last, parents)) = steps.split_last() else {
            return Err(refuse("the key is empty".into()));
        };
        if steps.len() > LONGEST_KEY {
            return Err(refuse(format!("the key has {} parts, more than any key of a scene", steps.len())));
        }
        let mut at = &mut self.values;
        for step in parents {
            at = enter(at, step).map_err(refuse)?;
        }
        let key = display(&steps);
        self.places.retain(|path, _| !is_at_or_below(path, &key));
        match (at, last) {
            (Value::Table(table), Step::Key(key)) => drop(table.insert(key.clone(), change.value)),
            (Value::Array(array), Step::Index(index)) if *index < array.len() => array[*index] = change.value,
            _ => return Err(refuse(format!("there is no {} to set", change.key))),
        }
        for end in 1..=steps.len() {
            let flag = Place::Flag(change.flag.clone());
            self.places.entry(display(&steps[..end])).or_insert(flag);
        }
        Ok(())
    }

    /// Where the value at `path` stands, or else the nearest table around it, or else the file.
    pub fn place(&self, path: &str) -> String {
        let mut path = path;
        loop {
            match self.places.get(path) {
                Some(Place::Byte(offset)) => return place_at(&self.file, &self.text, *offset),
                Some(Place::Flag(flag)) => return flag.clone(),
                Some(Place::Extras) => return format!("{}: {EXTRAS}", self.file),
                None => {}
            }
            match path.rfind(['.', '[']) {
                Some(end) => path = &path[..end],
                None => return self.file.clone(),
            }
        }
    }

    /// The error that the value at `path` is wrong. A value from a flag is a usage error.
    pub fn error(&self, path: &str, finding: impl fmt::Display, remedy: impl fmt::Display) -> Error {
        let place = self.place(path);
        let kind = if place.starts_with("--") { Kind::Usage } else { Kind::Failure };
        Error { kind, ..Error::failure(place, finding, remedy) }
    }

    /// The same of an error in the file that the value at `path` names.
    pub fn error_of_file(&self, path: &str, Error { place, finding, remedy, kind }: Error) -> Error {
        Error { kind, ..self.error(path, format!("{path}: {place}: {finding}"), remedy) }
    }
}

/// The bytes of a file of at most [`LARGEST_FILE`] bytes; of a larger one, or of one without end, no more is read.
fn read_small(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
    read.map_err(|error| {
        Error::failure(path.display(), format!("cannot be read: {error}"), "check the path and its permissions")
    })?;
    if bytes.len() as u64 <= LARGEST_FILE {
        return Ok(bytes);
    }
    let finding = format!("is larger than {} MiB, too large for a scene", LARGEST_FILE >> 20);
    Err(Error::failure(
        path.display(),
        finding,
        "give a scene: a TOML file, a folder with a scene.toml, or a glTF file",
    ))
}

/// A value as it compares: numbers by what they are worth, one name and a list of it alike.
fn meaning(value: &Value) -> String {
    match value {
        Value::Integer(number) => (*number as f64).to_string(),
        Value::Float(number) => number.to_string(),
        Value::String(names) => names.split(',').map(str::trim).collect::<Vec<_>>().join(","),
        Value::Array(list) => list.iter().map(meaning).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}

fn is_at_or_below(path: &str, key: &str) -> bool {
    path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[medium]\nscattering = 1\nphase = { g = 0.9 }\n\n[[light]]\nradius = 0.5\n";

    fn document() -> Document {
        Document::parse("a.toml", TEXT).expect("valid TOML")
    }

    #[test]
    fn values_know_their_line_and_column() {
        let document = document();
        assert_eq!(document.place("medium.phase.g"), "a.toml:3:11");
        assert_eq!(document.place("light[0].radius"), "a.toml:6:1");
        assert_eq!(document.place("light[0].normal"), "a.toml:5:1");
        assert_eq!(document.place("render.seed"), "a.toml");
    }

    #[test]
    fn overrides_replace_add_and_name_their_flag() {
        let mut document = document();
        for text in ["medium.phase.g=0.6", "light.0.radius=2", "render.technique=nee"] {
            document.apply(Override::parse(text).expect("has a =")).expect("applies");
        }
        assert_eq!(document.values["medium"]["phase"]["g"], Value::Float(0.6));
        assert_eq!(document.values["light"][0]["radius"], Value::Integer(2));
        assert_eq!(document.values["render"]["technique"], Value::String("nee".into()));
        assert_eq!(document.place("light[0].radius"), "--set light.0.radius=2");
        assert_eq!(document.place("medium.phase.g"), "--set medium.phase.g=0.6");
        assert_eq!(document.place("render"), "--set render.technique=nee");
        assert_eq!(document.place("medium.scattering"), "a.toml:2:1");
    }

    #[test]
    fn overrides_that_lead_nowhere_are_usage_errors() {
        for text in ["light[3].radius=1", "medium.scattering.x=1", "=1", "light.radius=1", "0=1"] {
            let error = document().apply(Override::parse(text).expect("has a =")).expect_err(text);
            assert_eq!(error.kind, Kind::Usage, "{error}");
            assert_eq!(error.place, format!("--set {text}"));
        }
        assert!(Override::parse("medium").is_err());
    }

    #[test]
    fn broken_files_are_reported_with_their_place() {
        let error = Document::parse("a.toml", "[medium]\nscattering = = 1\n").expect_err("not TOML");
        assert!(error.place.starts_with("a.toml:2:"), "{error}");
    }
}
