//! Values in a row, packed in one of the ways that OpenVDB knows.

use flate2::{Decompress, FlushDecompress, Status};

use super::blosc;
use super::input::{DAMAGED, Input};
use crate::gltf::fault::{Checked, Fault, require};

/// How the values of a grid are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packing {
    /// The compression of chunks.
    pub codec: Codec,
    /// Whether inactive values are left out where few differ.
    pub is_masked: bool,
}

/// A compression of chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Codec {
    None,
    Zip,
    Blosc,
}

impl Packing {
    /// The packing that the bits of a grid mean; the others have no known meaning.
    pub fn of(bits: u32) -> Checked<Self> {
        let codec = match bits & !2 {
            0 => Codec::None,
            1 => Codec::Zip,
            // OpenVDB prefers Blosc where both are set.
            4 | 5 => Codec::Blosc,
            _ => return Err(Fault::new(format!("has the unknown compression {bits:#x}"), DAMAGED)),
        };
        Ok(Self { codec, is_masked: bits & 2 != 0 })
    }
}

/// Reads chunks, with memory that all of them share.
pub struct Chunks {
    codec: Codec,
    packed: Vec<u8>,
    zlib: Decompress,
    blosc: blosc::Decoder,
}

impl Chunks {
    pub fn new(codec: Codec) -> Self {
        Self { codec, packed: Vec::new(), zlib: Decompress::new(true), blosc: blosc::Decoder::default() }
    }

    /// Fills `bytes` with the next chunk, which must have as many.
    pub fn read(&mut self, input: &mut Input, bytes: &mut [u8]) -> Checked<()> {
        if self.codec == Codec::None {
            return input.fill(bytes);
        }
        let count = input.i64()?;
        if count <= 0 {
            // What does not get smaller is not packed; the number says so by its sign.
            let is_whole = count.unsigned_abs() == bytes.len() as u64;
            let finding = || format!("has {} bytes instead of {}", count.unsigned_abs(), bytes.len());
            require(is_whole, finding, DAMAGED)?;
            return input.fill(bytes);
        }
        input.take(count.unsigned_abs(), &mut self.packed)?;
        match self.codec {
            Codec::Blosc => self.blosc.decode(&self.packed, bytes),
            _ => self.unzip(bytes),
        }
    }

    fn unzip(&mut self, bytes: &mut [u8]) -> Checked<()> {
        self.zlib.reset(true);
        let outcome = self.zlib.decompress(&self.packed, bytes, FlushDecompress::Finish);
        let is_whole = matches!(outcome, Ok(Status::StreamEnd)) && self.zlib.total_out() == bytes.len() as u64;
        require(is_whole, || "holds values that cannot be unzipped", DAMAGED)
    }
}
