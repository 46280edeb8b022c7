//! Buffers and the views of them.

use super::fault::{At, Checked, Fault, entry, label, require};
use super::files::{FileId, Files};
use super::schema::{Buffer, BufferView, Root};

/// Strides that glTF allows, in bytes; multiples of 4.
const STRIDES: core::ops::RangeInclusive<usize> = 4..=252;

/// Where the bytes of a buffer are.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// The binary part of the container.
    Binary,
    File(FileId),
}

/// The sources of all buffers of a file.
#[derive(Debug)]
pub struct Sources(Vec<Source>);

/// Finds all buffers, and reads the files that they refer to.
pub fn open(root: &Root, has_binary: bool, files: &mut Files) -> Checked<Sources> {
    let mut sources = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let source = match &buffer.uri {
            Some(uri) => files.open(uri).map(Source::File),
            None if index == 0 && has_binary => Ok(Source::Binary),
            None => Err(Fault::new(
                "has neither a URI nor the binary part of a .glb file",
                "give the buffer a URI; buffers that are filled only by an extension cannot be read",
            )),
        };
        sources.push(source.at(|| label("buffer", index, None))?);
    }
    Ok(Sources(sources))
}

/// All buffers of a file, each of the length that the file states.
#[derive(Debug)]
pub struct Buffers<'a> {
    buffers: Vec<&'a [u8]>,
    views: &'a [BufferView],
}

/// A part of a buffer.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Its bytes.
    pub bytes: &'a [u8],
    /// Where it begins in the buffer.
    pub offset: usize,
    /// Bytes from one element to the next, if the view says so.
    pub stride: Option<usize>,
}

impl<'a> Buffers<'a> {
    /// The buffers of `root` from where `sources` says, `binary` being the binary part of the container.
    pub fn new(root: &'a Root, sources: &Sources, binary: Option<&'a [u8]>, files: &'a Files) -> Checked<Self> {
        let bytes = |source: &Source| match source {
            Source::Binary => binary.unwrap_or_default(),
            Source::File(file) => files.content(*file),
        };
        let pairs = root.buffers.iter().zip(&sources.0).enumerate();
        let buffers = pairs
            .map(|(index, (buffer, source))| stated_part(buffer, bytes(source)).at(|| label("buffer", index, None)));
        Ok(Self { buffers: buffers.collect::<Checked<_>>()?, views: &root.buffer_views })
    }

    /// The view `index`.
    pub fn view(&self, index: usize) -> Checked<View<'a>> {
        let view = entry(self.views, "bufferView", index)?;
        self.part(view).at(|| label("bufferView", index, None))
    }

    fn part(&self, view: &BufferView) -> Checked<View<'a>> {
        let buffer = entry(&self.buffers, "buffer", view.buffer)?;
        let (offset, length) = (view.byte_offset, view.byte_length);
        let bytes = offset.checked_add(length).and_then(|end| buffer.get(offset..end));
        let Some(bytes) = bytes else {
            let finding = format!(
                "its {length} bytes from byte {offset} do not fit in buffer {}, which has {}",
                view.buffer,
                buffer.len()
            );
            return Err(Fault::new(finding, "correct byteOffset and byteLength, or export the file again"));
        };
        if let Some(stride) = view.byte_stride {
            let finding = || format!("its byteStride is {stride}");
            let ok = STRIDES.contains(&stride) && stride.is_multiple_of(4);
            require(ok, finding, "give a multiple of 4 from 4 to 252, or leave it out")?;
        }
        Ok(View { bytes, offset, stride: view.byte_stride })
    }
}

/// As many of `bytes` as the buffer has; files and binary parts may be padded.
fn stated_part<'a>(buffer: &Buffer, bytes: &'a [u8]) -> Checked<&'a [u8]> {
    bytes.get(..buffer.byte_length).ok_or_else(|| {
        let finding = format!("its byteLength is {}, but there are {} bytes of data", buffer.byte_length, bytes.len());
        Fault::new(finding, "correct byteLength, or copy or export the file again")
    })
}
