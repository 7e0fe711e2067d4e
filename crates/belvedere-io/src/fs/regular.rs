//! Files that are read are regular ones: a pipe would wait for its writer, and a device may never end.

use super::plain;
use std::io::{self, Read};
use std::path::Path;

/// Opens a regular file.
///
/// # Errors
/// As those of [`std::fs::File::open`]; [`io::ErrorKind::IsADirectory`] for a folder, [`io::ErrorKind::InvalidInput`] for a pipe, a device or
/// a socket.
pub(super) fn open(path: &Path) -> io::Result<plain::File> {
    // Asked before the file is opened, because opening a pipe waits, and again of the opened file, which may be another by then.
    check(&plain::metadata(path)?)?;
    let file = plain::File::open(path)?;
    check(&file.metadata()?)?;
    Ok(file)
}

/// All the bytes of a regular file, no more than its size says.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let size = file.metadata()?.len();
    let mut bytes = Vec::new();
    usize::try_from(size)
        .ok()
        .and_then(|size| bytes.try_reserve_exact(size).ok())
        .ok_or_else(|| io::Error::other(format!("its {} MiB do not fit into the memory", size >> 20)))?;
    file.take(size.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > size {
        return Err(io::Error::other("it grows while it is read; wait until it is written"));
    }
    Ok(bytes)
}

fn check(meta: &plain::Metadata) -> io::Result<()> {
    if meta.is_file() {
        return Ok(());
    }
    if meta.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    let reason = "is a pipe, a device or a socket; give a regular file";
    Err(io::Error::new(io::ErrorKind::InvalidInput, reason))
}
