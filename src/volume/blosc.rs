//! Chunks of Blosc 1 as OpenVDB writes them: blocks of bytes, shuffled by significance and packed with LZ4.
//!
//! A header of 16 bytes says what they are; then come the place of every block in the chunk, and the blocks. A block is
//! one stream, or one for every byte of a value; every stream stands behind its size, and is not packed if that is its
//! size anyway. <https://github.com/Blosc/c-blosc/blob/main/README_CHUNK_FORMAT.rst>

use super::input::DAMAGED;
use crate::gltf::fault::{Checked, Fault, require};

/// Bytes of the header.
const HEADER: usize = 16;
/// Bits of the flags: bytes are shuffled, nothing is packed, bits are shuffled, blocks are one stream.
const SHUFFLED: u8 = 0x01;
const COPIED: u8 = 0x02;
const BITS_SHUFFLED: u8 = 0x04;
const WHOLE: u8 = 0x10;
/// The number of LZ4 in the upper three bits of the flags.
const LZ4: u8 = 1;
/// Blocks are one stream anyway if their values have more bytes,
const MOST_STREAMS: usize = 16;
/// or if there are fewer values.
const FEWEST_VALUES: usize = 128;

/// Unpacks chunks, with memory that all of them share.
#[derive(Default)]
pub struct Decoder {
    /// A block as it was unpacked, before it is put in order.
    block: Vec<u8>,
}

/// The header of a chunk.
struct Header {
    flags: u8,
    /// Bytes of a value.
    value: usize,
    /// Bytes of all values.
    bytes: usize,
    /// Bytes of the values of a block.
    block: usize,
}

impl Header {
    fn of(chunk: &[u8]) -> Checked<Self> {
        require(chunk.len() >= HEADER, || "holds a Blosc chunk without a header", DAMAGED)?;
        let [flags, value] = [chunk[2], chunk[3]];
        let [bytes, block, size] = [4, 8, 12].map(|at| number(chunk, at).unwrap_or_default());
        require(size == chunk.len(), || "holds a Blosc chunk of a wrong size", DAMAGED)?;
        require(value > 0 && block > 0, || "holds a Blosc chunk of empty blocks", DAMAGED)?;
        Ok(Self { flags, value: value.into(), bytes, block })
    }

    /// Whether a flag is set.
    fn has(&self, flag: u8) -> bool {
        self.flags & flag != 0
    }

    /// How many streams a block of this many bytes has.
    fn streams(&self, block: usize) -> usize {
        let is_whole = self.has(WHOLE) || block < self.block;
        let is_split = !is_whole && self.value <= MOST_STREAMS && block / self.value >= FEWEST_VALUES;
        if is_split { self.value } else { 1 }
    }
}

impl Decoder {
    /// Fills `bytes` with the values of `chunk`, which must have as many.
    pub fn decode(&mut self, chunk: &[u8], bytes: &mut [u8]) -> Checked<()> {
        let header = Header::of(chunk)?;
        require(header.bytes == bytes.len(), || "holds a Blosc chunk of other values", DAMAGED)?;
        if header.has(COPIED) {
            let copied = chunk.get(HEADER..HEADER + bytes.len()).ok_or_else(damaged)?;
            bytes.copy_from_slice(copied);
            return Ok(());
        }
        let is_known = header.flags >> 5 == LZ4 && !header.has(BITS_SHUFFLED);
        require(is_known, || "is packed with Blosc, but not with LZ4", "save it with OpenVDB's own compression")?;
        for (index, block) in bytes.chunks_mut(header.block).enumerate() {
            let start = number(chunk, HEADER + 4 * index).ok_or_else(damaged)?;
            self.block(&header, chunk.get(start..).ok_or_else(damaged)?, block)?;
        }
        Ok(())
    }

    /// Fills `block` from the streams at the start of `packed`.
    fn block(&mut self, header: &Header, mut packed: &[u8], block: &mut [u8]) -> Checked<()> {
        let streams = header.streams(block.len());
        require(block.len().is_multiple_of(streams), || "holds a Blosc block of broken values", DAMAGED)?;
        self.block.resize(block.len(), 0);
        for stream in self.block.chunks_mut(block.len() / streams) {
            let size = number(packed, 0).ok_or_else(damaged)?;
            let end = size.saturating_add(4);
            unpack(packed.get(4..end).ok_or_else(damaged)?, stream)?;
            packed = &packed[end..];
        }
        if header.has(SHUFFLED) {
            unshuffle(&self.block, header.value, block);
        } else {
            block.copy_from_slice(&self.block);
        }
        Ok(())
    }
}

/// Fills `values` with a stream.
fn unpack(stream: &[u8], values: &mut [u8]) -> Checked<()> {
    if stream.len() == values.len() {
        values.copy_from_slice(stream);
        return Ok(());
    }
    let unpacked = lz4_flex::block::decompress_into(stream, values);
    if unpacked.is_ok_and(|count| count == values.len()) { Ok(()) } else { Err(damaged()) }
}

/// Puts the bytes of values of `size` bytes together again; `shuffled` has all first bytes, all second bytes and so on.
/// What is left of a value at the end stands there as it is.
fn unshuffle(shuffled: &[u8], size: usize, values: &mut [u8]) {
    let count = shuffled.len() / size;
    let (whole, rest) = shuffled.split_at(count * size);
    let (ordered, end) = values.split_at_mut(count * size);
    for (index, value) in ordered.chunks_exact_mut(size).enumerate() {
        for (byte, target) in value.iter_mut().enumerate() {
            *target = whole[byte * count + index];
        }
    }
    end.copy_from_slice(rest);
}

/// The number of four bytes at `at`, if there are that many.
fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let four = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*four) as usize)
}

fn damaged() -> Fault {
    Fault::new("holds a Blosc chunk that cannot be unpacked", DAMAGED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_values_come_together_again() {
        let mut values = [0; 8];
        unshuffle(&[1, 2, 11, 12, 21, 22, 7, 8], 3, &mut values);
        assert_eq!(values, [1, 11, 21, 2, 12, 22, 7, 8]);
    }
}
