//! Lists of names: one name, several of them separated by commas, or a list.

use core::fmt;
use core::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::Technique;
use crate::film::aov::Aov;

/// One technique or a list of them.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[schemars(with = "Vec<Technique>", extend("x-format" = "name, or a list of names"))]
pub struct Techniques(pub Vec<Technique>);

impl<'de> Deserialize<'de> for Techniques {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Names::of("a technique")).map(Self)
    }
}

/// What a film keeps beside radiance.
#[derive(Clone, Debug, Default, JsonSchema, PartialEq, Serialize)]
#[schemars(with = "Vec<Aov>", extend("x-format" = "name, or a list of names"))]
pub struct AovList(pub Vec<Aov>);

impl AovList {
    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<'de> Deserialize<'de> for AovList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Names::of("a layer")).map(Self)
    }
}

/// Reads them.
struct Names<T> {
    /// What they are names of.
    of: &'static str,
    names: PhantomData<T>,
}

impl<T> Names<T> {
    fn of(of: &'static str) -> Self {
        Self { of, names: PhantomData }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Names<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the name of {} or a list of names", self.of)
    }

    fn visit_str<E: de::Error>(self, names: &str) -> Result<Vec<T>, E> {
        names.split(',').map(|name| T::deserialize(de::value::StrDeserializer::new(name.trim()))).collect()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
        let mut list = Vec::new();
        while let Some(name) = seq.next_element()? {
            list.push(name);
        }
        Ok(list)
    }
}
