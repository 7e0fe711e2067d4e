//! Bytes of a file at a position, from disk or memory.

use crate::fs::File;
use crate::{budget, input};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Files up to this size are read once, whole; larger ones where their parts are wanted, bytes.
const WHOLE: u64 = 512 << 20;

/// Where the bytes come from. Reads may come from many threads.
#[derive(Debug)]
pub(super) struct Source {
    len: u64,
    inner: Inner,
}

#[derive(Debug)]
enum Inner {
    File(Mutex<File>),
    Bytes(Vec<u8>),
}

impl Source {
    pub(super) fn open(path: &Path) -> std::io::Result<Self> {
        let file = File::open(path)?;
        let meta = file.metadata()?;
        if meta.is_dir() {
            return Err(std::io::Error::other("is a folder, not a file"));
        }
        if meta.len() > WHOLE {
            return Ok(Self { len: meta.len(), inner: Inner::File(Mutex::new(file)) });
        }
        let mut bytes = budget::room("the file", meta.len() as usize).map_err(std::io::Error::other)?;
        file.take(meta.len()).read_to_end(&mut bytes)?;
        Ok(Self::bytes(bytes))
    }

    pub(super) fn bytes(bytes: Vec<u8>) -> Self {
        Self { len: bytes.len() as u64, inner: Inner::Bytes(bytes) }
    }

    pub(super) fn len(&self) -> u64 {
        self.len
    }

    /// sha256 of all the bytes.
    pub(super) fn sha256(&self) -> Result<String, String> {
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
    pub(super) fn read_into(&self, at: u64, count: u64, what: &str, out: &mut Vec<u8>) -> Result<(), String> {
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
    pub(super) fn read(&self, at: u64, count: u64, what: &str) -> Result<Vec<u8>, String> {
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
        assert_eq!(parts.expect("read"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
        assert_eq!(whole.expect("read"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
}
