//! Where the bytes of tiles lie.

use super::key::Key;
use crate::fs::{self, beside};
use crate::geotiff::Source;
use crate::{Fault, InputFile, Limits, budget};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Most bytes of one tile.
const MOST_BYTES: u64 = 64 << 20;

/// A tile that is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Tile {
    pub(super) key: Key,
    /// Its first byte; in a folder the index of its ending.
    pub(super) at: u64,
    /// Number of its bytes; 0 in a folder.
    pub(super) length: u32,
}

/// What a reader lists: tiles in any order, and what is said of them.
pub(super) struct Listed {
    pub(super) tiles: Vec<Tile>,
    pub(super) store: Store,
    /// Name of the encoding in the metadata.
    pub(super) encoding: Option<String>,
    /// Tiles that no zoom has.
    pub(super) odd: usize,
    /// The file; none for a folder.
    pub(super) file: Option<InputFile>,
}

/// The bytes of tiles.
pub(super) enum Store {
    /// A folder of files z/x/y.
    Folder(PathBuf),
    /// All of them, one after the other.
    Bytes(Vec<u8>),
    /// A file, from the first byte of its tiles on, perhaps packed by gzip.
    File { source: Source, start: u64, is_packed: bool },
}

/// Endings of tiles in folders.
pub(super) const ENDINGS: [&str; 4] = ["png", "webp", "pngraw", "terrarium.png"];

impl Store {
    /// The bytes of a tile, and the record of its own file.
    ///
    /// # Errors
    /// A predicate.
    pub(super) fn read(&self, tile: &Tile, limits: &Limits) -> Result<(Vec<u8>, Option<InputFile>), Fault> {
        match self {
            Self::Folder(folder) => {
                let path = file_of(folder, tile)?;
                let size = fs::metadata(&path).map_err(|e| e.to_string())?.len();
                limits.ask("a tile", size)?;
                let (bytes, file) = InputFile::read(&path)?;
                Ok((bytes, Some(file)))
            }
            Self::Bytes(bytes) => {
                let at = tile.at as usize;
                let part = bytes.get(at..at.saturating_add(tile.length as usize));
                Ok((part.ok_or("lies outside of the file")?.to_vec(), None))
            }
            Self::File { source, start, is_packed } => {
                let at = start.checked_add(tile.at).ok_or("lies outside of the file")?;
                let mut bytes = Vec::new();
                limits.ask("a tile", u64::from(tile.length))?;
                source.read_into(at, u64::from(tile.length), "a tile", &mut bytes)?;
                Ok((if *is_packed { unpacked(&bytes, MOST_BYTES)? } else { bytes }, None))
            }
        }
    }
}

/// The file of a tile, which is looked for only where links do not lead out of its folder.
fn file_of(folder: &Path, tile: &Tile) -> Result<PathBuf, String> {
    let [column, row] = tile.key.place();
    let ending = ENDINGS.get(tile.at as usize).ok_or("has no known ending")?;
    beside(&folder.join("a"), &format!("{}/{column}/{row}.{ending}", tile.key.zoom())).map_err(|e| e.to_string())
}

/// The content of a gzip stream of at most so many bytes.
///
/// # Errors
/// A predicate.
pub(super) fn unpacked(packed: &[u8], most: u64) -> Result<Vec<u8>, String> {
    let most = most.min(budget::left() / 2);
    let mut out = Vec::new();
    let read = MultiGzDecoder::new(packed).take(most + 1).read_to_end(&mut out);
    read.map_err(|e| format!("is damaged gzip ({e})"))?;
    if out.len() as u64 > most {
        return Err(format!("has more than {} MiB unpacked; allow more memory", most >> 20));
    }
    Ok(out)
}
