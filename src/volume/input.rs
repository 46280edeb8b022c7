//! A file as a sequence of numbers, whose end is known before anything is read.

use std::io::{Read, Seek, SeekFrom};

use crate::gltf::fault::{Checked, Fault};

/// What to do about a file that contradicts itself.
pub const DAMAGED: &str = "the file is damaged: copy or save it again";
/// Bytes of the longest text: names and the like.
const LONGEST_TEXT: u32 = 1 << 16;

/// Something that can be read anywhere.
pub trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// A file and the position up to which it has been read. Numbers are little-endian.
pub struct Input<'a> {
    source: &'a mut dyn Source,
    position: u64,
    /// Bytes of the file; not known before the first seek.
    len: Option<u64>,
}

impl<'a> Input<'a> {
    /// The beginning of `source`.
    pub fn new(source: &'a mut dyn Source) -> Self {
        Self { source, position: 0, len: None }
    }

    /// How many bytes are before the next one.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// The number of bytes of the file.
    pub fn len(&mut self) -> Checked<u64> {
        if let Some(len) = self.len {
            return Ok(len);
        }
        let len = self.source.seek(SeekFrom::End(0)).map_err(unreadable)?;
        self.source.seek(SeekFrom::Start(self.position)).map_err(unreadable)?;
        self.len = Some(len);
        Ok(len)
    }

    /// Goes on at byte `position`.
    pub fn seek(&mut self, position: u64) -> Checked<()> {
        self.must_reach(position)?;
        if position != self.position {
            self.source.seek(SeekFrom::Start(position)).map_err(unreadable)?;
            self.position = position;
        }
        Ok(())
    }

    /// Passes over `bytes` bytes.
    pub fn skip(&mut self, bytes: u64) -> Checked<()> {
        self.seek(self.position.saturating_add(bytes))
    }

    /// A fault unless the file goes on up to byte `end`.
    fn must_reach(&mut self, end: u64) -> Checked<()> {
        let len = self.len()?;
        if end <= len {
            return Ok(());
        }
        Err(Fault::new(format!("ends too early: it has {len} bytes, and goes on up to byte {end}"), DAMAGED))
    }

    /// Fills `bytes`.
    pub fn fill(&mut self, bytes: &mut [u8]) -> Checked<()> {
        let end = self.position.saturating_add(bytes.len() as u64);
        self.must_reach(end)?;
        self.source.read_exact(bytes).map_err(unreadable)?;
        self.position = end;
        Ok(())
    }

    /// Replaces the content of `buffer` by `count` bytes; memory is taken only if there are that many.
    pub fn take(&mut self, count: u64, buffer: &mut Vec<u8>) -> Checked<()> {
        self.must_reach(self.position.saturating_add(count))?;
        buffer.resize(count as usize, 0);
        self.fill(buffer)
    }

    fn array<const N: usize>(&mut self) -> Checked<[u8; N]> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    /// One byte.
    pub fn u8(&mut self) -> Checked<u8> {
        Ok(self.array::<1>()?[0])
    }

    /// Four bytes.
    pub fn u32(&mut self) -> Checked<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// Four bytes.
    pub fn i32(&mut self) -> Checked<i32> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    /// Four bytes.
    pub fn f32(&mut self) -> Checked<f32> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    /// Eight bytes.
    pub fn u64(&mut self) -> Checked<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    /// Eight bytes.
    pub fn i64(&mut self) -> Checked<i64> {
        Ok(i64::from_le_bytes(self.array()?))
    }

    /// Eight bytes.
    pub fn f64(&mut self) -> Checked<f64> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// Index coordinates.
    pub fn coordinates(&mut self) -> Checked<[i32; 3]> {
        Ok([self.i32()?, self.i32()?, self.i32()?])
    }

    /// Fills the words of a mask, of which the first bit is the lowest of the first word.
    pub fn mask(&mut self, words: &mut [u64]) -> Checked<()> {
        words.iter_mut().try_for_each(|word| {
            *word = self.u64()?;
            Ok(())
        })
    }

    /// Text after its length.
    pub fn text(&mut self) -> Checked<String> {
        let len = self.u32()?;
        self.text_of(len)
    }

    /// Text of `len` bytes; what is not UTF-8 is replaced.
    pub fn text_of(&mut self, len: u32) -> Checked<String> {
        if len > LONGEST_TEXT {
            return Err(Fault::new(format!("has a name of {len} bytes, more than {LONGEST_TEXT}"), DAMAGED));
        }
        let mut bytes = Vec::new();
        self.take(len.into(), &mut bytes)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

fn unreadable(error: std::io::Error) -> Fault {
    Fault::new(format!("cannot be read: {error}"), DAMAGED)
}
