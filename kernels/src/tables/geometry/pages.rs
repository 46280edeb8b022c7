//! Rows that are read in no order, in large pages of memory.
//!
//! Rays of a scattering medium jump about in a table of a hundred megabytes, and with pages of 4 KiB nearly every jump
//! also misses the processor's table of pages. Linux gives pages of 2 MiB to whoever asks; elsewhere, and for tables
//! that would not fill one, the rows stay where they are.

use std::sync::Arc;

use bytemuck::Pod;
use memmap2::Mmap;
use rayon::prelude::*;

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

impl<T: Pod + Send> Pages<T> {
    /// Holds rows `0 .. count`, in large pages where there are any; all threads make rows.
    pub fn new(count: usize, row: impl Fn(usize) -> T + Sync) -> Self {
        let memory = match mapped(count, &row) {
            Some(memory) => Memory::Mapped(Arc::new(memory)),
            None => Memory::Heap(Arc::new((0..count).into_par_iter().map(&row).collect())),
        };
        Self(memory)
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

/// The rows in large pages; `None` where the system has none to give.
#[cfg(target_os = "linux")]
fn mapped<T: Pod + Send>(count: usize, row: impl Fn(usize) -> T + Sync) -> Option<Mmap> {
    let bytes = count * size_of::<T>();
    if bytes < LARGE {
        return None;
    }
    let mut memory = memmap2::MmapMut::map_anon(bytes).ok()?;
    memory.advise(memmap2::Advice::HugePage).ok()?;
    let rows: &mut [T] = bytemuck::cast_slice_mut(&mut memory);
    rows.par_iter_mut().enumerate().for_each(|(i, place)| *place = row(i));
    memory.make_read_only().ok()
}

#[cfg(not(target_os = "linux"))]
fn mapped<T: Pod + Send>(_count: usize, _row: impl Fn(usize) -> T + Sync) -> Option<Mmap> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_what_was_put_in() {
        for count in [0, 1, LARGE / 4, LARGE / 2 + 3] {
            let rows: Vec<u32> = (0..count as u32).collect();
            assert_eq!(Pages::new(count, |i| rows[i]).rows(), rows, "{count} rows");
        }
    }
}
