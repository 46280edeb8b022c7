//! Pipes and devices, opened for writing.

use std::fs::File;
use std::io;
use std::path::Path;

/// Opens what is at `path` to add to it: what is open already may be a file with something in it, as behind a shell's
/// `>>`. A named pipe is open once somebody reads it; none if `interrupted` says so before.
#[cfg(unix)]
pub fn open(path: &Path, interrupted: impl Fn() -> bool) -> io::Result<Option<File>> {
    use std::os::unix::fs::FileTypeExt;
    if !path.metadata()?.file_type().is_fifo() {
        return File::options().append(true).open(path).map(Some);
    }
    loop {
        match open_if_read(path)? {
            None if interrupted() => return Ok(None),
            None => std::thread::sleep(PAUSE),
            file => return Ok(file),
        }
    }
}

/// Time between two looks for a reader.
#[cfg(unix)]
const PAUSE: std::time::Duration = std::time::Duration::from_millis(20);

/// The pipe at `path`, if somebody has it open for reading. To wait for that in the system would be to sleep through
/// signals, whose handlers have system calls go on where they were.
#[cfg(unix)]
fn open_if_read(path: &Path) -> io::Result<Option<File>> {
    use rustix::fs::{OFlags, fcntl_setfl};
    use rustix::io::Errno;
    use std::os::unix::fs::OpenOptionsExt;
    let opened = File::options().append(true).custom_flags(OFlags::NONBLOCK.bits() as i32).open(path);
    match opened {
        Err(error) if error.raw_os_error() == Some(Errno::NXIO.raw_os_error()) => Ok(None),
        opened => {
            let file = opened?;
            // A slow reader is waited for.
            fcntl_setfl(&file, OFlags::APPEND)?;
            Ok(Some(file))
        }
    }
}

#[cfg(not(unix))]
pub fn open(path: &Path, _: impl Fn() -> bool) -> io::Result<Option<File>> {
    File::options().append(true).open(path).map(Some)
}
