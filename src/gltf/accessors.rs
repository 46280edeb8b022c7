//! Accessors: which bytes of buffer views they mean, and whether these bytes are there.

use super::buffers::{Buffers, View};
use super::element_format::{Component, Format, Shape};
use super::elements::{Elements, Sparse};
use super::fault::{At, Checked, Fault, entry, label, quoted, require};
use super::schema;

const EXPORT_AGAIN: &str = "correct the accessor, or export the file again";

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
        let component = Component::from_code(accessor.component_type)?;
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
        let format = Format {
            shape: Shape::Scalar,
            component: Component::from_code(indices.component_type)?,
            normalized: false,
        };
        let remedy = "give UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT";
        require(format.component.is_index(), || format!("are {}", format.component.name()), remedy)?;
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
            "its {count} elements ({format}) from byte {offset}, {stride} bytes apart, do not fit in its \
             bufferView of {} bytes",
            view.bytes.len()
        );
        Fault::new(finding, EXPORT_AGAIN)
    })
}
