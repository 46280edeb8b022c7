//! Rows that are read in no order, in large pages of memory.
//!
//! Rays of a scattering medium jump about in a table of a hundred megabytes, and with pages of 4 KiB nearly every jump
//! also misses the processor's table of pages. Linux gives pages of 2 MiB to whoever asks; elsewhere, and for tables that
//! would not fill one, the rows stay where they are.

use std::sync::Arc;

use bytemuck::Pod;
use memmap2::Mmap;

/// Size of a large page in bytes.
const LARGE: usize = 2 << 20;

/// Read-only rows.
#[derive(Clone, Debug)]
pub struct Pages<T>(Memory<T>);

#[derive(Clone, Debug)]
enum Memory<T> {
    Heap(Arc<Vec<T>>),
    Mapped(Arc<Mmap>),
}

impl<T: Pod> Pages<T> {
    /// Holds `rows`, in large pages where there are any.
    pub fn new(rows: Vec<T>) -> Self {
        Self(mapped(&rows).map_or_else(|| Memory::Heap(Arc::new(rows)), |memory| Memory::Mapped(Arc::new(memory))))
    }

    /// The rows.
    #[inline(always)]
    pub fn rows(&self) -> &[T] {
        match &self.0 {
            Memory::Heap(rows) => rows,
            Memory::Mapped(memory) => bytemuck::cast_slice(memory),
        }
    }
}

/// A copy of the rows in large pages; `None` where the system has none to give.
#[cfg(target_os = "linux")]
fn mapped<T: Pod>(rows: &[T]) -> Option<Mmap> {
    let bytes: &[u8] = bytemuck::cast_slice(rows);
    if bytes.len() < LARGE {
        return None;
    }
    let mut memory = memmap2::MmapMut::map_anon(bytes.len()).ok()?;
    memory.advise(memmap2::Advice::HugePage).ok()?;
    memory.copy_from_slice(bytes);
    memory.make_read_only().ok()
}

#[cfg(not(target_os = "linux"))]
fn mapped<T: Pod>(_rows: &[T]) -> Option<Mmap> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_what_was_put_in() {
        for count in [0, 1, LARGE / 4, LARGE / 2 + 3] {
            let rows: Vec<u32> = (0..count as u32).collect();
            assert_eq!(Pages::new(rows.clone()).rows(), rows, "{count} rows");
        }
    }
}
