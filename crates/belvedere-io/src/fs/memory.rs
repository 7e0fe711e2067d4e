//! Files in memory. A name is a path from one root, whether it begins with `/` or not; a folder exists if a file is in it.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

type Files = BTreeMap<PathBuf, Arc<[u8]>>;

static FILES: RwLock<Files> = RwLock::new(BTreeMap::new());

fn files() -> RwLockReadGuard<'static, Files> {
    FILES.read().unwrap_or_else(PoisonError::into_inner)
}

fn files_to_change() -> RwLockWriteGuard<'static, Files> {
    FILES.write().unwrap_or_else(PoisonError::into_inner)
}

/// A file that is read.
#[derive(Debug)]
pub struct File(Cursor<Arc<[u8]>>);

/// Metadata of a file or folder.
#[derive(Debug, Clone, Copy)]
pub struct Metadata {
    /// Size of a file, bytes; `None` = a folder.
    size: Option<u64>,
}

impl Metadata {
    /// Size, bytes; 0 for a folder.
    #[allow(clippy::len_without_is_empty)] // the name that std gives it
    pub fn len(&self) -> u64 {
        self.size.unwrap_or(0)
    }

    /// Whether it is a file.
    pub fn is_file(&self) -> bool {
        self.size.is_some()
    }

    /// Whether it is a folder.
    pub fn is_dir(&self) -> bool {
        self.size.is_none()
    }

    /// Always `false`: there are no links.
    pub fn is_symlink(&self) -> bool {
        false
    }
}

impl File {
    /// Opens a file to be read.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`].
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        content(path.as_ref()).map(|bytes| Self(Cursor::new(bytes)))
    }

    /// Metadata of the file.
    ///
    /// # Errors
    /// None; that of a file system may have some.
    pub fn metadata(&self) -> io::Result<Metadata> {
        Ok(Metadata { size: Some(self.0.get_ref().len() as u64) })
    }
}

impl Read for File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

/// Canonical name of a path.
fn name_of(path: &Path) -> PathBuf {
    let mut name = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(part) => name.push(part),
            Component::ParentDir => drop(name.pop()),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    name
}

fn missing(path: &Path) -> io::Error {
    io::Error::new(io::ErrorKind::NotFound, format!("{} is not among the files that were given", path.display()))
}

fn content(path: &Path) -> io::Result<Arc<[u8]>> {
    files().get(&name_of(path)).cloned().ok_or_else(|| missing(path))
}

/// Metadata of a file or folder.
///
/// # Errors
/// [`io::ErrorKind::NotFound`].
pub(super) fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let name = name_of(path.as_ref());
    let files = files();
    if let Some(bytes) = files.get(&name) {
        return Ok(Metadata { size: Some(bytes.len() as u64) });
    }
    let within = files.range(name.clone()..).next().is_some_and(|(file, _)| file.starts_with(&name));
    if within || name.as_os_str().is_empty() { Ok(Metadata { size: None }) } else { Err(missing(path.as_ref())) }
}

/// As [`metadata`]: there are no links.
///
/// # Errors
/// [`io::ErrorKind::NotFound`].
pub(super) fn symlink_metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    metadata(path)
}

/// Canonical path of an existing file or folder.
///
/// # Errors
/// [`io::ErrorKind::NotFound`].
pub(super) fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    metadata(path.as_ref()).map(|_| name_of(path.as_ref()))
}

/// All the bytes of a file.
///
/// # Errors
/// [`io::ErrorKind::NotFound`].
#[allow(dead_code)] // readers open files
pub(super) fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    content(path.as_ref()).map(|bytes| bytes.to_vec())
}

/// Writes a file, replacing one of that name.
///
/// # Errors
/// Never; the result is that of `std::fs::write`.
pub fn write(path: impl AsRef<Path>, content: impl Into<Arc<[u8]>>) -> io::Result<()> {
    files_to_change().insert(name_of(path.as_ref()), content.into());
    Ok(())
}

/// Removes a file.
///
/// # Errors
/// [`io::ErrorKind::NotFound`].
pub fn remove_file(path: impl AsRef<Path>) -> io::Result<()> {
    let gone = files_to_change().remove(&name_of(path.as_ref()));
    gone.map(drop).ok_or_else(|| missing(path.as_ref()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_one_name_and_its_folder_is_there() {
        write("site/data/a.tif", *b"abcdef").expect("written");
        assert_eq!(read("/site/./x/../data/a.tif").expect("read"), b"abcdef");
        assert_eq!(canonicalize("site/data/../data/a.tif").expect("there"), Path::new("site/data/a.tif"));
        assert!(metadata("site/data").is_ok_and(|m| m.is_dir() && !m.is_file()));
        assert!(metadata("site/data/a.tif").is_ok_and(|m| m.is_file() && m.len() == 6));
        assert!(metadata("site/dat").is_err() && read("site/data").is_err(), "a part of a name is no folder");
        let mut file = File::open("site/data/a.tif").expect("opened");
        let mut last = [0; 2];
        file.seek(SeekFrom::End(-2)).and_then(|_| file.read_exact(&mut last)).expect("read");
        assert_eq!(&last, b"ef");
        remove_file("site/data/a.tif").expect("there");
        assert_eq!(read("site/data/a.tif").expect_err("gone").kind(), io::ErrorKind::NotFound);
    }
}
