//! The two forms of a glTF file: JSON alone, or JSON and one buffer in a binary container (GLB).

use core::ops::Range;

use super::fault::{Checked, Fault, require};
use super::warnings::Warnings;

/// Bytes of the header: magic, version, length of the file.
const HEADER: usize = 12;
/// Bytes before the content of a chunk: its length and type.
const CHUNK_HEADER: usize = 8;
const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";

const EXPORT_AGAIN: &str = "copy or export the file again";
const GIVE_GLTF: &str = "give a glTF 2.0 file, .gltf or .glb";

/// The parts of a file.
#[derive(Debug)]
pub struct Container<'a> {
    /// The JSON text.
    pub json: &'a [u8],
    /// Where in the file the buffer without a URI is; only in GLB files, and not in all.
    pub binary: Option<Range<usize>>,
    /// Whether the JSON is the whole file, so that its lines are the file's.
    pub is_text: bool,
}

/// The parts of a file with the content `bytes`.
pub fn open<'a>(bytes: &'a [u8], warnings: &mut Warnings) -> Checked<Container<'a>> {
    if bytes.starts_with(MAGIC) {
        return binary(bytes, warnings);
    }
    check_start(bytes)?;
    let json = without_mark(bytes);
    require(!json.trim_ascii_start().is_empty(), || "is empty", GIVE_GLTF)?;
    Ok(Container { json, binary: None, is_text: true })
}

/// A fault if no file that begins with `start` is glTF.
pub fn check_start(start: &[u8]) -> Checked<()> {
    let first = without_mark(start).trim_ascii_start().first();
    let finding = || "is not glTF: it begins neither with \"glTF\", as .glb files do, nor with '{', as .gltf files do";
    require(start.starts_with(MAGIC) || first.is_none_or(|first| *first == b'{'), finding, GIVE_GLTF)
}

/// Text without the mark of its byte order.
fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

fn binary<'a>(bytes: &'a [u8], warnings: &mut Warnings) -> Checked<Container<'a>> {
    let [Some(version), Some(length)] = [number(bytes, 4), number(bytes, 8)] else {
        return Err(Fault::new(format!("ends after {} bytes, inside its header", bytes.len()), EXPORT_AGAIN));
    };
    let finding = || format!("is a binary container of version {version}");
    require(version == 2, finding, "export the model as glTF 2.0")?;
    let finding = || format!("has {} bytes, but its header says {length}", bytes.len());
    require((HEADER..=bytes.len()).contains(&length), finding, EXPORT_AGAIN)?;
    if length < bytes.len() {
        warnings.note("bytes beyond the length that the header gives are ignored", || "container");
    }
    let mut chunks = Chunks { file: &bytes[..length], at: HEADER, index: 0 };
    let Some(first) = chunks.next().transpose()?.filter(|chunk| chunk.kind == JSON) else {
        return Err(Fault::new("its first chunk is not of type JSON", EXPORT_AGAIN).at("chunk 0"));
    };
    let second = chunks.next().transpose()?;
    let binary = second.filter(|chunk| chunk.kind == BINARY).map(|chunk| chunk.content);
    Ok(Container { json: &bytes[first.content], binary, is_text: false })
}

/// The little-endian number at `offset`.
fn number(bytes: &[u8], offset: usize) -> Option<usize> {
    let bytes = bytes.get(offset..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*bytes)).ok()
}

struct Chunk<'a> {
    kind: &'a [u8],
    /// Where its content is in the file.
    content: Range<usize>,
}

struct Chunks<'a> {
    file: &'a [u8],
    /// Where the next one begins.
    at: usize,
    index: usize,
}

impl<'a> Iterator for Chunks<'a> {
    type Item = Checked<Chunk<'a>>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at == self.file.len() {
            return None;
        }
        let chunk = self.read().map_err(|fault| fault.at(format!("chunk {}", self.index)));
        self.index += 1;
        Some(chunk)
    }
}

impl<'a> Chunks<'a> {
    fn read(&mut self) -> Checked<Chunk<'a>> {
        let Some((header, rest)) = self.file[self.at..].split_at_checked(CHUNK_HEADER) else {
            return Err(Fault::new("the file ends inside the header of this chunk", EXPORT_AGAIN));
        };
        let length = number(header, 0).unwrap_or(usize::MAX);
        let finding = || format!("its length is {length}, not a multiple of 4");
        require(length.is_multiple_of(4), finding, EXPORT_AGAIN)?;
        let finding = || format!("its length is {length}, but only {} bytes of the file are left", rest.len());
        require(length <= rest.len(), finding, EXPORT_AGAIN)?;
        let start = self.at + CHUNK_HEADER;
        self.at = start + length;
        Ok(Chunk { kind: &header[4..], content: start..self.at })
    }
}
