//! Atomic writing: a file exists complete or not at all, and files that belong together appear together.

#[cfg(not(target_family = "wasm"))]
mod batch;
#[cfg(not(target_family = "wasm"))]
mod ledger;
#[cfg(not(target_family = "wasm"))]
mod temporary;

use crate::{IoError, fs};
use std::io::{self, Write};
use std::path::Path;

#[cfg(not(target_family = "wasm"))]
pub use batch::{contents_of, publish, together};
#[cfg(not(target_family = "wasm"))]
pub use ledger::{abandon, written};
#[cfg(not(target_family = "wasm"))]
pub use temporary::Temporary;

/// Fails at once if [`write_atomic`] could not write `path`: it exists and `overwrite` is false, it is a folder, or its
/// folder does not exist. Ask before long work.
///
/// # Errors
/// [`IoError::Exists`], [`IoError::Format`], [`IoError::Os`].
pub fn check_output(path: &Path, overwrite: bool) -> Result<(), IoError> {
    if path.file_name().is_none() {
        return Err(IoError::format(path, "is no file name; give the name of a file to write"));
    }
    let folder = folder_of(path);
    match fs::metadata(folder) {
        Ok(m) if m.is_dir() => {}
        Ok(_) => return Err(IoError::format(folder, "is not a folder; give an output inside one")),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return Err(IoError::format(path, format!("folder {} does not exist; create it first", folder.display())));
        }
        Err(e) => return Err(IoError::os(folder, e)),
    }
    match fs::symlink_metadata(path) {
        Ok(m) if m.is_dir() => Err(IoError::format(path, "is a folder; give the name of a file to write")),
        Ok(m) if m.is_file() || m.is_symlink() => {
            // the target device of a link is written directly, like a device
            let regular = m.is_file() || fs::metadata(path).map_or(true, |target| target.is_file());
            if regular && !overwrite { Err(IoError::Exists { path: path.to_owned() }) } else { Ok(()) }
        }
        Ok(_) => Ok(()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(e) => Err(IoError::os(path, e)),
    }
}

/// Writes `path` through a temporary file beside it: complete, flushed to the disk (file and folder) and then renamed, so
/// that nobody ever sees half a file. Without `overwrite` an existing file stays, even one that appears during the work.
/// The temporary file is removed if `write` fails; one that a killed program left is removed by the next that writes into the folder.
/// A device or pipe (such as `/dev/stdout`) is written directly. Inside [`together`] the file appears at its end.
///
/// # Errors
/// [`IoError::Exists`] if the file is there and may not be replaced; [`IoError::Format`] for a folder;
/// [`IoError::Os`] with what the system or `write` said.
#[cfg(not(target_family = "wasm"))]
pub fn write_atomic(
    path: &Path,
    overwrite: bool,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), IoError> {
    check_output(path, overwrite)?;
    let os = |e| IoError::os(path, e);
    // follow a link, so that it is not replaced by a file
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&target).is_ok_and(|m| !m.is_file()) {
        let mut device = std::fs::OpenOptions::new().write(true).open(&target).map_err(os)?;
        return write(&mut device).and_then(|()| device.flush()).map_err(os);
    }
    let temporary = Temporary::beside(&target).map_err(os)?;
    let mut out = io::BufWriter::with_capacity(1 << 16, temporary.file());
    let written = write(&mut out).and_then(|()| out.flush());
    // What is left in the buffer after an error is not written.
    drop(out.into_parts());
    written.map_err(os)?;
    publish(temporary, overwrite)
}

/// Writes a file in memory: complete, or not at all.
///
/// # Errors
/// As on a file system.
#[cfg(target_family = "wasm")]
pub fn write_atomic(
    path: &Path,
    overwrite: bool,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), IoError> {
    check_output(path, overwrite)?;
    let mut bytes = Vec::new();
    write(&mut bytes).and_then(|()| fs::write(path, bytes)).map_err(|e| IoError::os(path, e))
}

/// As on a file system, where files that belong together appear together.
///
/// # Errors
/// Those of `work`.
#[cfg(target_family = "wasm")]
pub fn together<T, E: From<IoError>>(work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    work()
}

/// Where the bytes of an output are.
#[cfg(target_family = "wasm")]
pub fn contents_of(path: &Path) -> std::path::PathBuf {
    path.to_owned()
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(unix)]
fn sync_folder(folder: &Path) {
    // some file systems cannot do this; the data are safe already
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = folder.sync_all();
    }
}

#[cfg(not(any(unix, target_family = "wasm")))]
fn sync_folder(_: &Path) {}

/// There are no temporary files in memory: programs that would write them cannot be started.
#[cfg(target_family = "wasm")]
#[derive(Debug)]
pub struct Temporary(std::path::PathBuf);

#[cfg(target_family = "wasm")]
impl Temporary {
    /// Always an error.
    ///
    /// # Errors
    /// [`io::ErrorKind::Unsupported`].
    pub fn beside(_: &Path) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

/// Publishes nothing: there are no temporary files.
///
/// # Errors
/// None.
#[cfg(target_family = "wasm")]
pub fn publish(_: Temporary, _: bool) -> Result<(), IoError> {
    Ok(())
}
