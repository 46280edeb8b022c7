//! Accessors: what the bytes of buffer views mean, and whether these bytes are there.

use core::fmt;

use super::buffers::{Buffers, View};
use super::elements::{Elements, Sparse};
use super::fault::{At, Checked, Fault, entry, label, quoted, require};
use super::schema;

const EXPORT_AGAIN: &str = "correct the accessor, or export the file again";

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
    fn from_code(code: u64) -> Option<Self> {
        let component = match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        };
        Some(component)
    }

    /// Its size in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn name(self) -> &'static str {
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

    fn from_name(name: &str) -> Option<Self> {
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

/// The accessors of a file.
#[derive(Clone, Copy, Debug)]
pub struct Accessors<'a> {
    pub buffers: &'a Buffers<'a>,
    pub accessors: &'a [schema::Accessor],
}

impl<'a> Accessors<'a> {
    /// The elements of accessor `index`, which `accepts` must like; `expected` says what it likes.
    pub fn elements(&self, index: usize, accepts: impl Fn(Format) -> bool, expected: &str) -> Checked<Elements<'a>> {
        let accessor = entry(self.accessors, "accessor", index)?;
        self.read(accessor, accepts, expected).at(|| label("accessor", index, None))
    }

    fn read(
        &self,
        accessor: &'a schema::Accessor,
        accepts: impl Fn(Format) -> bool,
        expected: &str,
    ) -> Checked<Elements<'a>> {
        let component = component(accessor.component_type)?;
        let shape = Shape::from_name(&accessor.shape);
        let format = shape.map(|shape| Format { shape, component, normalized: accessor.normalized });
        let Some(format) = format.filter(|format| accepts(*format)) else {
            let found = format.map_or_else(|| quoted(&accessor.shape), |format| format.to_string());
            return Err(Fault::new(format!("is {found}"), format!("give {expected}")));
        };
        require(accessor.count > 0, || "has no elements", "give a count of 1 or more")?;
        let base = accessor.buffer_view.map(|view| self.base(accessor, view, format)).transpose()?;
        let sparse = accessor.sparse.as_ref().map(|sparse| self.sparse(accessor, sparse, format).at(|| "sparse"));
        Ok(Elements { format, count: accessor.count, base, sparse: sparse.transpose()? })
    }

    /// The bytes of the dense elements, with the stride between them.
    fn base(&self, accessor: &schema::Accessor, view: usize, format: Format) -> Checked<(&'a [u8], usize)> {
        let view = self.buffers.view(view)?;
        let stride = view.stride.unwrap_or(format.size());
        let finding = || format!("its elements of {} bytes are {stride} bytes apart in its bufferView", format.size());
        require(stride >= format.size(), finding, "give a byteStride that is at least the size of an element")?;
        Ok((part(view, accessor.byte_offset, accessor.count, stride, format)?, stride))
    }

    fn sparse(&self, accessor: &schema::Accessor, sparse: &schema::Sparse, format: Format) -> Checked<Sparse<'a>> {
        let count = sparse.count;
        let finding = || format!("replaces {count} of {} elements", accessor.count);
        require((1..=accessor.count).contains(&count), finding, "give a count from 1 to the count of the accessor")?;
        Ok(Sparse {
            indices: Box::new(self.sparse_indices(count, &sparse.indices).at(|| "indices")?),
            values: self
                .sparse_part(count, sparse.values.buffer_view, sparse.values.byte_offset, format)
                .at(|| "values")?,
        })
    }

    fn sparse_indices(&self, count: usize, indices: &schema::SparseIndices) -> Checked<Elements<'a>> {
        let format = Format { shape: Shape::Scalar, component: component(indices.component_type)?, normalized: false };
        let remedy = "give UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT";
        require(is_index(format.component), || format!("are {}", format.component.name()), remedy)?;
        let bytes = self.sparse_part(count, indices.buffer_view, indices.byte_offset, format)?;
        Ok(Elements { format, count, base: Some((bytes, format.size())), sparse: None })
    }

    /// The bytes of `count` elements without gaps.
    fn sparse_part(&self, count: usize, view: usize, offset: usize, format: Format) -> Checked<&'a [u8]> {
        let view = self.buffers.view(view)?;
        require(view.stride.is_none(), || "are in a bufferView with a byteStride", "leave the byteStride out")?;
        part(view, offset, count, format.size(), format)
    }
}

/// Whether indices may be of this type.
pub fn is_index(component: Component) -> bool {
    matches!(component, Component::U8 | Component::U16 | Component::U32)
}

fn component(code: u64) -> Checked<Component> {
    Component::from_code(code).ok_or_else(|| {
        let finding = format!("its componentType is {code}");
        Fault::new(finding, "give 5120 (BYTE), 5121, 5122 (SHORT), 5123, 5125 (UNSIGNED_INT) or 5126 (FLOAT)")
    })
}

/// From the first byte of the first of `count` elements to the last byte of the last.
fn part<'a>(view: View<'a>, offset: usize, count: usize, stride: usize, format: Format) -> Checked<&'a [u8]> {
    let start = view.offset.saturating_add(offset);
    let finding = || {
        format!("its elements begin at byte {start} of the buffer, which is not aligned to {}", format.component.name())
    };
    let aligned = offset.is_multiple_of(format.component.size()) && start.is_multiple_of(format.component.size());
    require(aligned, finding, "give offsets that are multiples of the size of a component")?;
    let length = (count - 1).checked_mul(stride).and_then(|length| length.checked_add(format.size()));
    let bytes = length.and_then(|length| view.bytes.get(offset..offset.checked_add(length)?));
    bytes.ok_or_else(|| {
        let finding = format!(
            "its {count} elements ({format}) from byte {offset}, {stride} bytes apart, do not fit in its bufferView of {} bytes",
            view.bytes.len()
        );
        Fault::new(finding, EXPORT_AGAIN)
    })
}
