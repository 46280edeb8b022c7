//! What an element of an accessor is made of: the type of its components, and how many there are.

use core::fmt;

use super::fault::{Checked, Fault};

/// Type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// The type that glTF writes as `code`.
    pub fn from_code(code: u64) -> Checked<Self> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                let remedy = "give 5120 (BYTE), 5121, 5122 (SHORT), 5123, 5125 (UNSIGNED_INT) or 5126 (FLOAT)";
                return Err(Fault::new(format!("its componentType is {code}"), remedy));
            }
        })
    }

    /// Its size in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Whether indices may be of this type.
    pub fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// What glTF calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::I8 => "BYTE",
            Self::U8 => "UNSIGNED_BYTE",
            Self::I16 => "SHORT",
            Self::U16 => "UNSIGNED_SHORT",
            Self::U32 => "UNSIGNED_INT",
            Self::F32 => "FLOAT",
        }
    }
}

/// How the components of an element are arranged. Matrices are in no attribute that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
}

impl Shape {
    /// The number of components.
    pub fn components(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 => 4,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Scalar => "SCALAR",
            Self::Vec2 => "VEC2",
            Self::Vec3 => "VEC3",
            Self::Vec4 => "VEC4",
        }
    }

    /// The arrangement that glTF calls `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Scalar, Self::Vec2, Self::Vec3, Self::Vec4].into_iter().find(|shape| shape.name() == name)
    }
}

/// What an element is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    pub shape: Shape,
    pub component: Component,
    /// Whether integers stand for fractions: the largest for 1, and the smallest signed one for -1.
    pub normalized: bool,
}

impl Format {
    /// Bytes of an element.
    pub fn size(self) -> usize {
        self.shape.components() * self.component.size()
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let normalized = if self.normalized { "normalized " } else { "" };
        write!(f, "{} of {normalized}{}", self.shape.name(), self.component.name())
    }
}
