//! Files in archives, named by paths through the archive: `town.zip/roads/a.shp` is the entry `roads/a.shp` of `town.zip`, and `walk.gpx.gz/walk.gpx`
//! the content of `walk.gpx.gz`. Archives may lie in archives.
//!
//! The unpacked size is bounded: no more than [`MOST_BYTES`], and of entries of ZIP archives no more than they state.

use super::bounded::{read_up_to, too_large};
use super::{plain, regular};
use crate::budget;
use flate2::read::MultiGzDecoder;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Most bytes that one packed file may have.
const MOST_BYTES: u64 = 2 << 30;
/// Packed files up to this size are kept until another one is read, bytes.
const KEPT_BYTES: usize = 256 << 20;
/// Deepest nesting of archives.
const MOST_DEPTH: usize = 3;
/// Names of entries that file managers add to archives.
const BY_FILE_MANAGERS: [&str; 4] = [".ds_store", "thumbs.db", "desktop.ini", "__macosx"];

/// A file that is read.
#[derive(Debug)]
pub enum File {
    /// A file of the file system.
    Plain(plain::File),
    /// A file out of an archive.
    Packed(Cursor<Arc<[u8]>>),
}

/// Metadata of a file or folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Metadata {
    size: u64,
    is_file: bool,
    is_dir: bool,
    is_symlink: bool,
}

impl Metadata {
    fn plain(found: &plain::Metadata) -> Self {
        let (is_file, is_dir, is_symlink) = (found.is_file(), found.is_dir(), found.is_symlink());
        Self { size: found.len(), is_file, is_dir, is_symlink }
    }

    /// Size, bytes.
    #[allow(clippy::len_without_is_empty)] // the name that std gives it
    pub fn len(&self) -> u64 {
        self.size
    }

    /// Whether it is a file.
    pub fn is_file(&self) -> bool {
        self.is_file
    }

    /// Whether it is a folder.
    pub fn is_dir(&self) -> bool {
        self.is_dir
    }

    /// Whether it is a link.
    pub fn is_symlink(&self) -> bool {
        self.is_symlink
    }
}

impl File {
    /// Opens a regular file to be read.
    ///
    /// # Errors
    /// As those of [`std::fs::File::open`]; [`io::ErrorKind::InvalidData`] if an archive cannot be unpacked; [`io::ErrorKind::InvalidInput`] for a
    /// pipe, a device or a socket.
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        match within(path.as_ref()) {
            Some((archive, entry)) => unpacked(&archive, &entry).map(|bytes| Self::Packed(Cursor::new(bytes))),
            None => regular::open(path.as_ref()).map(Self::Plain),
        }
    }

    /// Metadata of the file.
    ///
    /// # Errors
    /// As those of [`std::fs::File::metadata`].
    pub fn metadata(&self) -> io::Result<Metadata> {
        match self {
            Self::Plain(file) => file.metadata().map(|m| Metadata::plain(&m)),
            Self::Packed(bytes) => Ok(of_size(bytes.get_ref().len())),
        }
    }
}

impl Read for File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(file) => file.read(buffer),
            Self::Packed(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::Plain(file) => file.seek(to),
            Self::Packed(bytes) => bytes.seek(to),
        }
    }
}

fn of_size(size: usize) -> Metadata {
    Metadata { size: size as u64, is_file: true, is_dir: false, is_symlink: false }
}

/// Metadata of a file or folder, links followed.
///
/// # Errors
/// As those of [`std::fs::metadata`].
pub fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    match within(path.as_ref()) {
        Some((archive, entry)) => unpacked(&archive, &entry).map(|bytes| of_size(bytes.len())),
        None => plain::metadata(path).map(|m| Metadata::plain(&m)),
    }
}

/// Metadata of a file, folder or link.
///
/// # Errors
/// As those of [`std::fs::symlink_metadata`].
pub fn symlink_metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    match within(path.as_ref()) {
        Some(_) => metadata(path),
        None => plain::symlink_metadata(path).map(|m| Metadata::plain(&m)),
    }
}

/// Canonical path of an existing file or folder.
///
/// # Errors
/// As those of [`std::fs::canonicalize`].
pub fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    match within(path.as_ref()) {
        Some((archive, entry)) => {
            unpacked(&archive, &entry)?;
            canonicalize(archive).map(|archive| archive.join(entry))
        }
        None => plain::canonicalize(path),
    }
}

/// All the bytes of a regular file.
///
/// # Errors
/// As those of [`std::fs::read`]; [`io::ErrorKind::InvalidData`] if an archive cannot be unpacked; [`io::ErrorKind::InvalidInput`] for a pipe, a
/// device or a socket.
pub fn read(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    match within(path.as_ref()) {
        Some((archive, entry)) => unpacked(&archive, &entry).map(|bytes| bytes.to_vec()),
        None => regular::read(path.as_ref()),
    }
}

/// The text of a file.
///
/// # Errors
/// As those of [`read`]; [`io::ErrorKind::InvalidData`] if it is not UTF-8.
pub fn read_to_string(path: impl AsRef<Path>) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))
}

/// The file on disk that holds the file `path`: the outermost archive, or `path` itself.
pub(crate) fn archive_of(path: &Path) -> PathBuf {
    match within(path) {
        Some((archive, _)) => archive_of(&archive),
        None => path.to_owned(),
    }
}

/// Archive and entry that a path names; `None` unless the part of the path before the entry is a file.
fn within(path: &Path) -> Option<(PathBuf, String)> {
    let mut deeper = 0;
    for above in path.ancestors().skip(1).filter(|a| !a.as_os_str().is_empty()) {
        match plain::metadata(above) {
            Ok(m) if m.is_dir() => return None,
            Ok(m) if m.is_file() => return innermost(above, path, deeper),
            _ => deeper += 1,
        }
    }
    None
}

/// The archive nearest to the end of a path that leads into the file `outer`, and the entry in it.
fn innermost(outer: &Path, path: &Path, deeper: usize) -> Option<(PathBuf, String)> {
    let parts: Vec<&Path> = path.ancestors().skip(1).take(deeper).collect();
    let packs = |part: &&&Path| {
        let name = part.to_string_lossy().to_lowercase();
        name.ends_with(".gz") || name.ends_with(".zip")
    };
    let nested = parts.iter().filter(packs).count();
    let archive = if nested < MOST_DEPTH { parts.iter().find(packs).copied().unwrap_or(outer) } else { outer };
    let entry = path.strip_prefix(archive).ok()?;
    let names: Vec<_> = entry.components().map(|c| c.as_os_str().to_string_lossy()).collect();
    Some((archive.to_owned(), names.join("/")))
}

/// The error of a ZIP: whether it is damaged, or packed by a method or with a password that is not known here.
fn of_zip(archive: &Path, e: zip::result::ZipError) -> io::Error {
    use zip::result::ZipError::{CompressionMethodNotSupported, InvalidPassword, UnsupportedArchive};
    let reason = match e {
        UnsupportedArchive(reason) => reason.trim_end_matches('.').to_lowercase(),
        CompressionMethodNotSupported(method) => format!("packed by method {method}"),
        InvalidPassword => "a password is needed".into(),
        e => return damaged(archive, e),
    };
    let name = archive.file_name().unwrap_or_default().to_string_lossy();
    let text = format!("the archive {name} cannot be unpacked here ({reason}); unpack it, or pack it as a usual ZIP");
    io::Error::new(io::ErrorKind::InvalidData, text)
}

fn damaged(archive: &Path, e: impl std::fmt::Display) -> io::Error {
    let name = archive.file_name().unwrap_or_default().to_string_lossy();
    io::Error::new(io::ErrorKind::InvalidData, format!("the archive {name} cannot be unpacked ({e}); get it again"))
}

fn missing(archive: &Path, entry: &str) -> io::Error {
    let name = archive.file_name().unwrap_or_default().to_string_lossy();
    io::Error::new(io::ErrorKind::NotFound, format!("the archive {name} holds no {entry}"))
}

type Kept = Option<(PathBuf, u64, Arc<[u8]>)>;
static LAST: Mutex<Kept> = Mutex::new(None);

/// Content of an entry; the last one is cached, for readers open a file more than once.
fn unpacked(archive: &Path, entry: &str) -> io::Result<Arc<[u8]>> {
    let stamp = plain::metadata(archive_of(archive)).map(|m| m.len())?;
    let key = std::path::absolute(archive).unwrap_or_else(|_| archive.to_owned()).join(entry);
    let kept = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((name, size, bytes)) = kept().as_ref()
        && *name == key
        && *size == stamp
    {
        return Ok(bytes.clone());
    }
    // The last one makes room for the next.
    *kept() = None;
    let bytes: Arc<[u8]> = unpack(archive, entry)?.into();
    if bytes.len() <= KEPT_BYTES {
        *kept() = Some((key, stamp, bytes.clone()));
    }
    Ok(bytes)
}

/// The bytes of an archive, for which the budget is asked before they are read.
fn packed_bytes(archive: &Path) -> io::Result<Vec<u8>> {
    if within(archive).is_none() {
        budget::ask("the packed file", plain::metadata(archive)?.len())?;
    }
    read(archive)
}

fn unpack(archive: &Path, entry: &str) -> io::Result<Vec<u8>> {
    let packed = packed_bytes(archive)?;
    // It is held twice for a moment, and read by a loader.
    let most = MOST_BYTES.min(budget::left() / 2);
    let failed = |e: io::Error| if e.kind() == io::ErrorKind::OutOfMemory { e } else { damaged(archive, e) };
    if packed.starts_with(GZIP) {
        if entry != name_in_gzip(archive, &packed) {
            return Err(missing(archive, entry));
        }
        read_up_to(MultiGzDecoder::new(packed.as_slice()), most, archive, entry).map_err(failed)
    } else if packed.starts_with(ZIP) || packed.starts_with(EMPTY_ZIP) {
        let mut zip = zip::ZipArchive::new(Cursor::new(packed)).map_err(|e| damaged(archive, e))?;
        let found = zip.by_name(entry).map_err(|e| match e {
            zip::result::ZipError::FileNotFound => missing(archive, entry),
            e => of_zip(archive, e),
        })?;
        let stated = found.size();
        if stated > most {
            return Err(too_large(archive, entry, most));
        }
        let out = read_up_to(found.take(stated + 1), most, archive, entry).map_err(failed)?;
        if out.len() as u64 != stated {
            return Err(damaged(archive, format!("{entry} is not of the {stated} bytes that it states")));
        }
        Ok(out)
    } else {
        Err(io::Error::from(io::ErrorKind::NotADirectory))
    }
}

const GZIP: &[u8] = b"\x1f\x8b";
const ZIP: &[u8] = b"PK\x03\x04";
const EMPTY_ZIP: &[u8] = b"PK\x05\x06";

/// Unpacked size of an entry, bytes; for gzip counted up to `most` + 1 and not kept, for ZIP the stated size, which bounds later
/// unpacking.
pub(crate) fn unpacked_size(archive: &Path, entry: &str, most: u64) -> io::Result<u64> {
    let packed = packed_bytes(archive)?;
    if packed.starts_with(GZIP) {
        let reader = MultiGzDecoder::new(packed.as_slice()).take(most.saturating_add(1));
        return io::copy(&mut { reader }, &mut io::sink()).map_err(|e| damaged(archive, e));
    }
    let mut zip = zip::ZipArchive::new(Cursor::new(packed)).map_err(|e| damaged(archive, e))?;
    zip.by_name(entry).map(|found| found.size()).map_err(|e| of_zip(archive, e))
}

/// Names of the files in an archive, without those of file managers; `None` if the file is not a ZIP or gzip.
pub(crate) fn names_in(path: &Path) -> io::Result<Option<Vec<String>>> {
    let mut head = Vec::new();
    File::open(path)?.take(4).read_to_end(&mut head)?;
    if head.starts_with(GZIP) {
        return Ok(Some(vec![name_in_gzip(path, &packed_bytes(path)?)]));
    }
    if !head.starts_with(ZIP) && !head.starts_with(EMPTY_ZIP) {
        return Ok(None);
    }
    let zip = zip::ZipArchive::new(Cursor::new(packed_bytes(path)?)).map_err(|e| damaged(path, e))?;
    let names = zip.file_names().flatten().map(|n| n.into_owned()).filter(|n| is_content(n));
    Ok(Some(names.collect()))
}

/// Whether an entry is a packed file: not a folder, and not an entry of a file manager.
fn is_content(name: &str) -> bool {
    let parts = || name.split(['/', '\\']);
    let of_manager = |part: &str| BY_FILE_MANAGERS.contains(&part.to_lowercase().as_str()) || part.starts_with("._");
    !name.ends_with(['/', '\\']) && parts().all(|part| !of_manager(part) && part != "..")
}

/// Name of the content of a gzip file: its own name without `.gz`, or, if that has no ending, the name stated in the file.
fn name_in_gzip(path: &Path, packed: &[u8]) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let cut = name.len().saturating_sub(3);
    let plain = match name.get(cut..) {
        Some(end) if end.eq_ignore_ascii_case(".gz") && cut > 0 => name[..cut].to_owned(),
        _ => name,
    };
    if plain.contains('.') && !plain.to_lowercase().ends_with(".gz") {
        return plain;
    }
    let decoder = flate2::read::GzDecoder::new(packed);
    let stated = decoder.header().and_then(|h| h.filename()).map(|n| String::from_utf8_lossy(n).into_owned());
    let stated = stated.and_then(|n| Some(Path::new(&n).file_name()?.to_string_lossy().into_owned()));
    stated.filter(|n| n.contains('.')).unwrap_or(plain)
}
