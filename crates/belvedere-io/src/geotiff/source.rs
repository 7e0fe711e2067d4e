//! Bytes of a file at a position, from disk or memory.

use crate::fs::File;
use crate::{InputFile, IoError, budget, input};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Files up to this size are read once, whole; larger ones where their parts are wanted, bytes.
const WHOLE: u64 = 512 << 20;

/// Files up to this size are hashed whole, bytes.
const HASHED: u64 = 2 << 30;

/// Where the bytes come from. Reads may come from many threads.
#[derive(Debug)]
pub(crate) struct Source {
    len: u64,
    inner: Inner,
}

#[derive(Debug)]
enum Inner {
    File(Mutex<File>),
    Bytes(Vec<u8>),
}

impl Source {
    pub(crate) fn open(path: &Path) -> std::io::Result<Self> {
        let file = File::open(path)?;
        let meta = file.metadata()?;
        if meta.is_dir() {
            return Err(std::io::Error::other("is a folder, not a file"));
        }
        if meta.len() > WHOLE {
            return Ok(Self { len: meta.len(), inner: Inner::File(Mutex::new(file)) });
        }
        let mut bytes = budget::room("the file", meta.len() as usize)?;
        file.take(meta.len()).read_to_end(&mut bytes)?;
        Ok(Self::bytes(bytes))
    }

    /// A file whose parts are read where they are wanted.
    pub(crate) fn in_parts(path: &Path) -> std::io::Result<Self> {
        let file = File::open(path)?;
        Ok(Self { len: file.metadata()?.len(), inner: Inner::File(Mutex::new(file)) })
    }

    pub(crate) fn bytes(bytes: Vec<u8>) -> Self {
        Self { len: bytes.len() as u64, inner: Inner::Bytes(bytes) }
    }

    pub(crate) fn len(&self) -> u64 {
        self.len
    }

    /// The record of the file `path`, whose bytes these are.
    pub(crate) fn input(&self, path: &Path) -> Result<InputFile, IoError> {
        if crate::fs::archive_of(path) != *path {
            return Ok(InputFile::of(path, &[]));
        }
        let (sha256, sampled) = self.sha256().map_err(|reason| IoError::format(path, reason))?;
        Ok(InputFile { path: path.to_owned(), bytes: self.len, sha256, sampled })
    }

    /// sha256 of all the bytes, or of parts of a file of more than [`HASHED`] bytes, and whether it is of parts.
    pub(crate) fn sha256(&self) -> Result<(String, bool), String> {
        let sampled = self.len > HASHED;
        Ok((if sampled { self.sha256_of_parts()? } else { self.sha256_of_all()? }, sampled))
    }

    /// See [`crate::InputFile::sampled`].
    fn sha256_of_parts(&self) -> Result<String, String> {
        let mut hashed = self.len.to_string().into_bytes();
        let last = self.len.saturating_sub(input::SAMPLE);
        let mut part = Vec::new();
        for k in 0..input::SAMPLES {
            let at = (u128::from(last) * u128::from(k) / u128::from(input::SAMPLES - 1)) as u64;
            self.read_into(at, input::SAMPLE.min(self.len), "a part of the file", &mut part)?;
            hashed.extend_from_slice(&part);
        }
        Ok(input::sha256(&hashed))
    }

    fn sha256_of_all(&self) -> Result<String, String> {
        match &self.inner {
            Inner::Bytes(bytes) => Ok(input::sha256(bytes)),
            Inner::File(_) => {
                let (mut at, mut part) = (0, Vec::new());
                input::sha256_of_chunks(|buffer| {
                    let count = (self.len - at).min(buffer.len() as u64);
                    self.read_into(at, count, "a part of the file", &mut part)?;
                    buffer[..part.len()].copy_from_slice(&part);
                    at += count;
                    Ok(part.len())
                })
            }
        }
    }

    /// Replaces the content of `out` by `count` bytes from `at` on. `what` names them in the message.
    pub(crate) fn read_into(&self, at: u64, count: u64, what: &str, out: &mut Vec<u8>) -> Result<(), String> {
        let end = at.checked_add(count).filter(|&end| end <= self.len);
        let (Some(end), Ok(size)) = (end, usize::try_from(count)) else {
            return Err(format!(
                "{what} should be {count} bytes at byte {at}, but the file ends at byte {}; it is truncated or damaged, fetch it again",
                self.len
            ));
        };
        out.clear();
        match &self.inner {
            Inner::Bytes(bytes) => {
                let part = bytes.get(at as usize..end as usize);
                out.extend_from_slice(part.ok_or_else(|| format!("{what} cannot be read"))?);
                Ok(())
            }
            Inner::File(file) => {
                out.resize(size, 0);
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                let result = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(out));
                result.map_err(|e| format!("{what} cannot be read: {e}"))
            }
        }
    }

    /// As [`Self::read_into`], into a new vector.
    pub(crate) fn read(&self, at: u64, count: u64, what: &str) -> Result<Vec<u8>, String> {
        let mut out = Vec::new();
        self.read_into(at, count, what, &mut out)?;
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_in_parts_is_hashed_whole() {
        let path = std::env::temp_dir().join(format!("belvedere_source_{}", std::process::id()));
        std::fs::write(&path, "a".repeat(1_000_000)).expect("written");
        let file = File::open(&path).expect("opened");
        let parts = Source { len: 1_000_000, inner: Inner::File(Mutex::new(file)) };
        let (parts, whole) = (parts.sha256(), Source::open(&path).expect("opened").sha256());
        std::fs::remove_file(&path).expect("removed");
        let want = ("cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0".to_owned(), false);
        assert_eq!(parts.expect("read"), want);
        assert_eq!(whole.expect("read"), want);
    }

    #[test]
    fn a_huge_file_is_known_by_its_size_and_by_parts_from_end_to_end() {
        let path = std::env::temp_dir().join(format!("belvedere_huge_{}", std::process::id()));
        let size = 30u64 << 30;
        // Holes take no room on the disk.
        let hash = |changed: Option<u64>, size: u64| {
            let mut file = std::fs::File::create(&path).expect("created");
            file.set_len(size).expect("holes");
            if let Some(at) = changed {
                file.seek(SeekFrom::Start(at))
                    .and_then(|_| std::io::Write::write_all(&mut file, &[1]))
                    .expect("written");
            }
            let found = Source::open(&path).expect("opened").sha256().expect("read");
            std::fs::remove_file(&path).expect("removed");
            assert!(found.1, "sampled");
            found.0
        };
        let empty = hash(None, size);
        assert_eq!(hash(None, size), empty);
        for other in [hash(Some(0), size), hash(Some(size - 1), size), hash(None, size + 1)] {
            assert_ne!(other, empty);
        }
    }
}
