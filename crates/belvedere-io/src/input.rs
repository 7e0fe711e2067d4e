//! Records of files that were read: path, size and sha256 of the content, taken in the same reading.

use crate::{IoError, fs};
use serde::{Deserialize, Serialize, Serializer};
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::{Path, PathBuf};

/// One file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InputFile {
    /// Its path, as found.
    #[serde(serialize_with = "displayed")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub path: PathBuf,
    /// Its size, bytes.
    pub bytes: u64,
    /// Its sha256, hexadecimal; of an elevation raster of more than 2 GiB that of parts spread evenly over it, see `sampled`.
    pub sha256: String,
    /// Whether `sha256` is of parts only: the size of the file as text and 256 parts of 64 KiB, the first at its start, the last at
    /// its end. Reading a file of many gigabytes takes longer than drawing it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sampled: bool,
}

/// Parts of a file of which a sampled sha256 is computed.
pub(crate) const SAMPLES: u64 = 256;
/// Size of such a part, bytes.
pub(crate) const SAMPLE: u64 = 64 << 10;

fn displayed<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

impl InputFile {
    /// The record of a file with this content; for a file in an archive, that of the archive.
    pub fn of(path: &Path, content: &[u8]) -> Self {
        let archive = fs::archive_of(path);
        if archive != path
            && let Ok(packed) = fs::read(&archive)
        {
            return Self { path: archive, bytes: packed.len() as u64, sha256: sha256(&packed), sampled: false };
        }
        Self { path: path.to_owned(), bytes: content.len() as u64, sha256: sha256(content), sampled: false }
    }

    /// The content of a whole file, and its record.
    ///
    /// # Errors
    /// [`IoError::Os`].
    pub fn read(path: &Path) -> Result<(Vec<u8>, Self), IoError> {
        let content = fs::read(path).map_err(|e| IoError::os(path, e))?;
        let record = Self::of(path, &content);
        Ok((content, record))
    }
}

/// sha256 of bytes, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

/// sha256 of a file, such as one that was written, lower-case hexadecimal.
///
/// # Errors
/// [`IoError::Os`].
pub fn sha256_of_file(path: &Path) -> Result<String, IoError> {
    let os = |e| IoError::os(path, e);
    let mut file = fs::File::open(path).map_err(os)?;
    sha256_of_chunks(|buffer| file.read(buffer)).map_err(os)
}

/// sha256 of the bytes that `next` writes into its buffer, until it writes none.
pub(crate) fn sha256_of_chunks<E>(mut next: impl FnMut(&mut [u8]) -> Result<usize, E>) -> Result<String, E> {
    let (mut hasher, mut buffer) = (Sha256::new(), vec![0u8; 1 << 16]);
    loop {
        match next(&mut buffer)? {
            0 => return Ok(hexadecimal(hasher)),
            read => hasher.update(&buffer[..read]),
        }
    }
}

pub(crate) fn hexadecimal(hasher: Sha256) -> String {
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// NIST's long test vector, a million times the letter a: sixteen fillings of the buffer.
    #[test]
    fn the_whole_file_is_hashed() {
        let path = std::env::temp_dir().join(format!("belvedere_sha256_{}", std::process::id()));
        std::fs::write(&path, "a".repeat(1_000_000)).expect("written");
        let (streamed, read) = (sha256_of_file(&path), InputFile::read(&path));
        std::fs::remove_file(&path).expect("removed");
        let expected = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
        assert_eq!(streamed.expect("read"), expected);
        let record = read.expect("read").1;
        assert_eq!((record.bytes, record.sha256.as_str()), (1_000_000, expected));
    }
}
