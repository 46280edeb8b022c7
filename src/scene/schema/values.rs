//! Values that are written in more than one way.

use core::fmt;
use core::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Camera, LARGEST_FILM, MOST_SEGMENTS};

/// A table `[camera]`, or the name of a camera of the geometry.
#[derive(Clone, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
#[schemars(with = "Camera")]
pub enum CameraOrName {
    /// A camera of the scene file.
    Table(Camera),
    /// The name of one in the glTF file.
    Name(String),
}

impl<'de> Deserialize<'de> for CameraOrName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableOrName;
        impl<'de> Visitor<'de> for TableOrName {
            type Value = CameraOrName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table, or the name of a camera in geometry")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<CameraOrName, E> {
                Ok(CameraOrName::Name(name.into()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<CameraOrName, A::Error> {
                Camera::deserialize(MapAccessDeserializer::new(map)).map(CameraOrName::Table)
            }
        }
        deserializer.deserialize_any(TableOrName)
    }
}

/// Reads a whole number from `MIN` to `MAX`.
pub fn whole<'de, const MIN: u32, const MAX: u32, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    struct Whole<const MIN: u32, const MAX: u32>;
    impl<const MIN: u32, const MAX: u32> Visitor<'_> for Whole<MIN, MAX> {
        type Value = u32;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a whole number from {MIN} to {MAX}")
        }

        fn visit_i64<E: de::Error>(self, number: i64) -> Result<u32, E> {
            let in_range = u32::try_from(number).ok().filter(|number| (MIN..=MAX).contains(number));
            in_range.ok_or_else(|| E::invalid_value(Unexpected::Signed(number), &self))
        }
    }
    deserializer.deserialize_any(Whole::<MIN, MAX>)
}

/// Reads a list of `N` values.
pub fn entries<'de, T: Deserialize<'de>, const N: usize, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<[T; N], D::Error> {
    struct Entries<T, const N: usize>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Entries<T, N> {
        type Value = [T; N];

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of {N} numbers")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[T; N], A::Error> {
            let mut list = Vec::new();
            while list.len() < N {
                match seq.next_element()? {
                    Some(entry) => list.push(entry),
                    None => return Err(wrong_count(list.len(), N)),
                }
            }
            refuse_more(seq, N)?;
            list.try_into().map_err(|_| de::Error::custom("is not a list"))
        }
    }
    deserializer.deserialize_any(Entries(PhantomData))
}

/// The same for a key that may be absent.
pub fn some_entries<'de, T: Deserialize<'de>, const N: usize, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<[T; N]>, D::Error> {
    entries(deserializer).map(Some)
}

/// Reads the width and height of an image.
pub fn sides<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u32; 2], D::Error> {
    struct Side(u32);
    impl<'de> Deserialize<'de> for Side {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            whole::<1, LARGEST_FILM, _>(deserializer).map(Self)
        }
    }
    entries(deserializer).map(|sides: [Side; 2]| sides.map(|side| side.0))
}

fn wrong_count<E: de::Error>(count: usize, right: usize) -> E {
    let entries = if count == 1 { "entry" } else { "entries" };
    E::custom(format_args!("has {count} {entries}, not {right}"))
}

/// An error if there is more in `seq`, of which `count` entries, all that it should have, were read.
fn refuse_more<'de, A: SeqAccess<'de>>(mut seq: A, count: usize) -> Result<(), A::Error> {
    let mut all = count;
    while seq.next_element::<de::IgnoredAny>()?.is_some() {
        all += 1;
    }
    if all == count { Ok(()) } else { Err(wrong_count(all, count)) }
}

/// How many vertices connect.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Eq)]
#[schemars(with = "u32", extend("x-format" = "number, \"all\" or \"auto\""))]
pub enum Starts {
    /// What a pilot finds.
    Auto,
    /// Every vertex.
    All,
    /// So many.
    First(u32),
}

impl<'de> Deserialize<'de> for Starts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Count;
        impl Visitor<'_> for Count {
            type Value = Starts;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 1 to 1024, \"all\" or \"auto\"")
            }

            fn visit_i64<E: de::Error>(self, count: i64) -> Result<Starts, E> {
                u32::try_from(count).map(Starts::First).map_err(|_| E::invalid_value(Unexpected::Signed(count), &self))
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<Starts, E> {
                match word {
                    "auto" => Ok(Starts::Auto),
                    "all" => Ok(Starts::All),
                    _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
                }
            }
        }
        deserializer.deserialize_any(Count)
    }
}

impl Serialize for Starts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::All => serializer.serialize_str("all"),
            Self::First(count) => serializer.serialize_u32(*count),
        }
    }
}

/// The longest path, in segments.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Eq)]
#[schemars(with = "u32", extend("x-format" = "number or \"auto\""))]
pub enum Segments {
    /// As long as there is.
    Auto,
    /// So many.
    Most(u32),
}

impl Segments {
    /// The number of segments after which a path ends in any case.
    pub fn most(self) -> u32 {
        match self {
            Self::Auto => MOST_SEGMENTS,
            Self::Most(number) => number,
        }
    }
}

impl fmt::Display for Segments {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("any number of"),
            Self::Most(number) => number.fmt(f),
        }
    }
}

impl<'de> Deserialize<'de> for Segments {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Most;
        impl Visitor<'_> for Most {
            type Value = Segments;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a whole number from 1 to {MOST_SEGMENTS} or \"auto\"")
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Segments, E> {
                let in_range = u32::try_from(number).ok().filter(|number| (1..=MOST_SEGMENTS).contains(number));
                in_range.map(Segments::Most).ok_or_else(|| E::invalid_value(Unexpected::Signed(number), &self))
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<Segments, E> {
                if word == "auto" { Ok(Segments::Auto) } else { Err(E::invalid_value(Unexpected::Str(word), &self)) }
            }
        }
        deserializer.deserialize_any(Most)
    }
}

impl Serialize for Segments {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Most(number) => serializer.serialize_u32(*number),
        }
    }
}

/// A number; `None` where the program chooses.
#[derive(Clone, Copy, Debug, Default, JsonSchema, PartialEq)]
#[schemars(with = "f64", extend("x-format" = "number or \"auto\""))]
pub struct NumberOrAuto(pub Option<f64>);

impl<'de> Deserialize<'de> for NumberOrAuto {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Number;
        impl Visitor<'_> for Number {
            type Value = NumberOrAuto;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or \"auto\"")
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<NumberOrAuto, E> {
                Ok(NumberOrAuto(Some(number)))
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<NumberOrAuto, E> {
                self.visit_f64(number as f64)
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<NumberOrAuto, E> {
                if word == "auto" {
                    Ok(NumberOrAuto(None))
                } else {
                    Err(E::invalid_value(Unexpected::Str(word), &self))
                }
            }
        }
        deserializer.deserialize_any(Number)
    }
}

impl Serialize for NumberOrAuto {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Some(number) => serializer.serialize_f64(number),
            None => serializer.serialize_str("auto"),
        }
    }
}

/// A number for all channels, or [red, green, blue].
#[derive(Clone, Copy, Debug, Default, JsonSchema, PartialEq, Serialize)]
#[schemars(with = "f64", extend("x-format" = "number, or [red, green, blue]"))]
pub struct Spectrum(pub [f64; 3]);

impl Spectrum {
    /// Whether it is 0 in every channel.
    pub fn is_black(&self) -> bool {
        self.0 == [0.0; 3]
    }
}

impl fmt::Display for Spectrum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let grey = self.0.iter().all(|channel| channel.to_bits() == self.0[0].to_bits());
        if grey { write!(f, "{:?}", self.0[0]) } else { write!(f, "{:?}", self.0) }
    }
}

impl<'de> Deserialize<'de> for Spectrum {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Channels;
        impl<'de> Visitor<'de> for Channels {
            type Value = Spectrum;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of three, [red, green, blue]")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Spectrum, E> {
                Ok(Spectrum([value; 3]))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Spectrum, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Spectrum, A::Error> {
                let mut channels = [0.0; 3];
                for (index, channel) in channels.iter_mut().enumerate() {
                    *channel = seq.next_element()?.ok_or_else(|| wrong_count(index, 3))?;
                }
                refuse_more(seq, 3)?;
                Ok(Spectrum(channels))
            }
        }
        deserializer.deserialize_any(Channels)
    }
}

/// A number, or a list of two.
#[derive(Clone, Copy, Debug, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
#[schemars(with = "f64", extend("x-format" = "number, or [first, second]"))]
pub enum OneOrTwo {
    /// One.
    One(f64),
    /// Two.
    Two([f64; 2]),
}

impl<'de> Deserialize<'de> for OneOrTwo {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = OneOrTwo;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of two")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<OneOrTwo, E> {
                Ok(OneOrTwo::One(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<OneOrTwo, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<OneOrTwo, A::Error> {
                let mut two = [0.0; 2];
                for (index, value) in two.iter_mut().enumerate() {
                    *value = seq.next_element()?.ok_or_else(|| de::Error::invalid_length(index, &self))?;
                }
                match seq.next_element::<f64>()? {
                    None => Ok(OneOrTwo::Two(two)),
                    Some(_) => Err(de::Error::invalid_length(3, &self)),
                }
            }
        }
        deserializer.deserialize_any(Numbers)
    }
}
