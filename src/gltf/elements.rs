//! From the bytes of an accessor to numbers.

use super::element_format::{Component, Format};
use super::fault::{Checked, require};

/// The elements of an accessor. Their bytes are there; their values are still unknown.
#[derive(Debug)]
pub struct Elements<'a> {
    pub format: Format,
    pub count: usize,
    /// All elements from the first byte to the last, and the bytes from one to the next; zeros if there are none.
    pub base: Option<(&'a [u8], usize)>,
    /// Elements that take the place of others.
    pub sparse: Option<Sparse<'a>>,
}

/// Elements that take the place of others.
#[derive(Debug)]
pub struct Sparse<'a> {
    /// Whose place they take: as many scalars.
    pub indices: Box<Elements<'a>>,
    /// Their bytes, without gaps.
    pub values: &'a [u8],
}

impl Elements<'_> {
    /// The first `N` components of each element. Normalized integers become fractions, others stay what they are.
    pub fn vectors<const N: usize>(&self) -> Checked<Vec<[f32; N]>> {
        match (self.format.component, self.format.normalized) {
            (Component::F32, _) => self.read(f32::from_le_bytes),
            (Component::U8, true) => self.read(|[byte]| f32::from(byte) / 255.0),
            (Component::U8, false) => self.read(|[byte]| f32::from(byte)),
            (Component::I8, true) => self.read(|byte| (f32::from(i8::from_le_bytes(byte)) / 127.0).max(-1.0)),
            (Component::I8, false) => self.read(|byte| f32::from(i8::from_le_bytes(byte))),
            (Component::U16, true) => self.read(|bytes| f32::from(u16::from_le_bytes(bytes)) / 65535.0),
            (Component::U16, false) => self.read(|bytes| f32::from(u16::from_le_bytes(bytes))),
            (Component::I16, true) => self.read(|bytes| (f32::from(i16::from_le_bytes(bytes)) / 32767.0).max(-1.0)),
            (Component::I16, false) => self.read(|bytes| f32::from(i16::from_le_bytes(bytes))),
            (Component::U32, _) => self.read(|bytes| u32::from_le_bytes(bytes) as f32),
        }
    }

    /// The elements as indices; floats and signed integers are not indices.
    pub fn indices(&self) -> Checked<Vec<u32>> {
        let scalars = match self.format.component {
            Component::U8 => self.read(|[byte]| u32::from(byte)),
            Component::U16 => self.read(|bytes| u32::from(u16::from_le_bytes(bytes))),
            _ => self.read(u32::from_le_bytes),
        };
        Ok(scalars?.into_iter().map(|[index]| index).collect())
    }

    /// The largest index that the components can hold. In a mesh it is reserved.
    pub fn largest_index(&self) -> u32 {
        match self.format.component {
            Component::U8 => u8::MAX.into(),
            Component::U16 => u16::MAX.into(),
            _ => u32::MAX,
        }
    }

    /// The first `N` components of each element, `component` making each from its `B` bytes.
    fn read<T: Copy + Default, const B: usize, const N: usize>(
        &self,
        component: impl Fn([u8; B]) -> T,
    ) -> Checked<Vec<[T; N]>> {
        let element = |bytes: &[u8]| -> [T; N] {
            let (components, _) = bytes.as_chunks::<B>();
            core::array::from_fn(|i| component(components[i]))
        };
        let mut elements = match self.base {
            Some((bytes, stride)) => bytes.chunks(stride).map(element).collect(),
            None => vec![[T::default(); N]; self.count],
        };
        if let Some(sparse) = &self.sparse {
            for (index, bytes) in sparse.checked_indices(self.count)?.zip(sparse.values.chunks(self.format.size())) {
                elements[index] = element(bytes);
            }
        }
        Ok(elements)
    }
}

impl Sparse<'_> {
    /// Whose place the values take: indices below `count` that increase.
    fn checked_indices(&self, count: usize) -> Checked<impl Iterator<Item = usize> + use<>> {
        let indices = self.indices.indices()?;
        for pair in indices.windows(2) {
            let finding = || format!("its sparse index {} follows {}", pair[1], pair[0]);
            require(pair[0] < pair[1], finding, "give sparse indices in increasing order")?;
        }
        let last = indices.last().copied().unwrap_or(0) as usize;
        let finding = || format!("its sparse index {last} is not below its count, {count}");
        require(last < count, finding, "give sparse indices below the count")?;
        Ok(indices.into_iter().map(|index| index as usize))
    }
}
