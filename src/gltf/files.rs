//! Files beside the model, each of them read once, however many objects refer to it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::fault::{Checked, Fault, quoted};
use super::schema::Root;
use super::uri::{self, Target};

/// Bytes of the largest file that is read: no binary container can be larger.
const LARGEST_FILE: u64 = 1 << 32;
/// Bytes at the start of a file that tell what it is: more white space than anybody begins with.
const START: u64 = 1 << 12;

/// The files beside one model.
#[derive(Debug)]
pub struct Files {
    folder: Option<PathBuf>,
    read: Vec<Vec<u8>>,
    by_path: BTreeMap<PathBuf, FileId>,
}

/// One of the [`Files`], or of the data that URIs contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileId(usize);

impl Files {
    /// The files in `folder`; there are none if the model has no folder.
    pub fn new(folder: Option<&Path>) -> Self {
        Self { folder: folder.map(Path::to_path_buf), read: Vec::new(), by_path: BTreeMap::new() }
    }

    /// Where they are.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The number of bytes of all files together.
    pub fn bytes(&self) -> usize {
        self.read.iter().map(Vec::len).sum()
    }

    /// The content of a file.
    pub fn content(&self, file: FileId) -> &[u8] {
        &self.read[file.0]
    }

    /// What `uri` stands for, read now if it has not been read before.
    pub fn open(&mut self, uri: &str) -> Checked<FileId> {
        let path = match uri::resolve(uri)? {
            Target::Data(bytes) => return Ok(self.keep(bytes)),
            Target::File(path) => path,
        };
        if let Some(file) = self.by_path.get(&path) {
            return Ok(*file);
        }
        let bytes = self.read(&path)?;
        let file = self.keep(bytes);
        self.by_path.insert(path, file);
        Ok(file)
    }

    fn keep(&mut self, bytes: Vec<u8>) -> FileId {
        self.read.push(bytes);
        FileId(self.read.len() - 1)
    }

    fn read(&self, path: &Path) -> Checked<Vec<u8>> {
        let name = path.to_string_lossy();
        let remedy = "put the file where the model refers to it, or save the model as one .glb file";
        let Some(folder) = &self.folder else {
            return Err(Fault::new(
                format!("its file {} cannot be found: the model has no folder", quoted(&name)),
                remedy,
            ));
        };
        content(&folder.join(path))
            .map_err(|finding| Fault::new(format!("its file {} {finding}", quoted(&name)), remedy))
    }
}

/// The files in `folder` that buffers and images of `root` refer to, whether they are read or not.
pub fn beside(root: &Root, folder: &Path) -> Vec<PathBuf> {
    let buffers = root.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let images = root.images.iter().filter_map(|image| image.uri.as_deref());
    let mut files: Vec<_> = buffers.chain(images).filter_map(uri::file).map(|file| folder.join(file)).collect();
    files.sort();
    files.dedup();
    files
}

/// The bytes of the file at `path`, or why there are none.
fn content(path: &Path) -> Read<Vec<u8>> {
    Content::open(path)?.all()
}

/// What was read, or why it cannot be.
type Read<T> = core::result::Result<T, String>;

/// The content of a file, of which only the start may have been read.
#[derive(Debug)]
pub struct Content {
    file: File,
    read: Vec<u8>,
}

impl Content {
    /// Opens the file at `path`. Pipes and devices would keep the reader waiting.
    pub fn open(path: &Path) -> Read<Self> {
        if path.exists() && !path.is_file() {
            return Err("is not a regular file".into());
        }
        let size = path.metadata().map_or(0, |metadata| metadata.len());
        if size > LARGEST_FILE {
            return Err(format!("has {size} bytes, more than the limit of 4 GiB"));
        }
        Ok(Self { file: File::open(path).map_err(unreadable)?, read: Vec::new() })
    }

    /// Its first bytes, all of it if it is short.
    pub fn start(&mut self) -> Read<&[u8]> {
        (&mut self.file).take(START).read_to_end(&mut self.read).map_err(unreadable)?;
        Ok(&self.read)
    }

    /// All of it.
    pub fn all(mut self) -> Read<Vec<u8>> {
        self.file.read_to_end(&mut self.read).map_err(unreadable)?;
        Ok(self.read)
    }
}

fn unreadable(error: std::io::Error) -> String {
    format!("cannot be read: {error}")
}
