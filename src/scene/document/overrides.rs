//! Values that flags or programs put in the place of those in a scene file, and the keys that lead to them.

use toml::{Table, Value};

use super::parser_messages::{DIGITS_MISSING, Words, words};
use crate::error::{Error, Result};

/// Steps of the longest key that an override may have: some more than any key of a scene has.
pub const LONGEST_KEY: usize = 16;

/// A value that replaces or adds to one of the file's.
#[derive(Clone, Debug)]
pub struct Override {
    /// The key: `medium.phase.g`, `light[0].radius`.
    pub key: String,
    /// The value.
    pub value: Value,
    /// The flag that says so, as the user wrote it.
    pub flag: String,
    /// Whether it is a flag of its own, as `--samples`, and not `--set`.
    pub is_dedicated: bool,
}

impl Override {
    /// From `key=value`, where the value is TOML; what is not a TOML value is a string.
    ///
    /// # Errors
    /// If there is no `=`, or the value is a number that TOML cannot hold or writes otherwise.
    pub fn parse(text: &str) -> Result<Self> {
        let flag = format!("--set {text}");
        let Some((key, value)) = text.split_once('=') else {
            return Err(Error::usage(flag, "has no '='", "write key=value, for example medium.phase.g=0.6"));
        };
        let parsed = format!("value = {value}").parse::<Table>();
        let words = parsed.as_ref().err().map(|error| words(error.message()));
        // A number that TOML cannot hold is meant as one all the same; what begins like one, as ../sky.exr, may be text.
        let may_be_text = |words: &Words| words.finding == DIGITS_MISSING && !looks_like_numbers(value);
        if let Some(Words { finding, remedy: Some(remedy) }) = words.filter(|words| !may_be_text(words)) {
            return Err(Error::usage(flag, finding, remedy));
        }
        let parsed = parsed.ok().filter(|table| table.len() == 1);
        let value = parsed.and_then(|mut table| table.remove("value")).unwrap_or_else(|| Value::String(value.into()));
        Ok(Self { key: key.trim().into(), value, flag, is_dedicated: false })
    }
}

/// Whether there is nothing in it but numbers and lists of them.
fn looks_like_numbers(value: &str) -> bool {
    value.chars().all(|c| c.is_ascii_digit() || "+-.eE_[], ".contains(c))
}

/// One step down the tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// To the value under this key of a table.
    Key(String),
    /// To this entry of a list.
    Index(usize),
}

/// The steps that a key leads: `light[0].radius` and `light.0.radius` alike.
pub fn steps(key: &str) -> Vec<Step> {
    let names = key.split(['.', '[', ']']).filter(|name| !name.is_empty());
    names.map(|name| name.parse().map_or_else(|_| Step::Key(name.into()), Step::Index)).collect()
}

/// The key that leads there, as `light[0].radius`.
pub fn display(steps: &[Step]) -> String {
    let mut path = String::new();
    for step in steps {
        match step {
            Step::Key(key) if path.is_empty() => path.clone_from(key),
            Step::Key(key) => path = format!("{path}.{key}"),
            Step::Index(index) => path = format!("{path}[{index}]"),
        }
    }
    path
}

/// The value one step below `at`; tables that do not exist are made.
pub fn enter<'a>(at: &'a mut Value, step: &Step) -> core::result::Result<&'a mut Value, String> {
    match (at, step) {
        (Value::Table(table), Step::Key(key)) => {
            Ok(table.entry(key.clone()).or_insert_with(|| Value::Table(Table::new())))
        }
        (Value::Array(array), Step::Index(index)) => {
            let len = array.len();
            array.get_mut(*index).ok_or_else(|| format!("there is no entry {index} in a list of {len}"))
        }
        (Value::Array(_), Step::Key(key)) => Err(format!("a list has entries [0], [1] and so on, not {key}")),
        (_, Step::Key(key)) => Err(format!("a plain value has no {key}")),
        (_, Step::Index(index)) => Err(format!("only a list has an entry {index}")),
    }
}
