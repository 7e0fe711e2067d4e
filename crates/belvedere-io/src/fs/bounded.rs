//! Reading of what may be longer than memory allows: streams are decoded as far as the bound, never beyond.

use crate::budget;
use std::io::{self, Read};
use std::path::Path;

/// Bytes read at a time.
const PART: usize = 1 << 20;

/// All that `reader` gives, unless it is more than `most` bytes: then [`too_large`] about `entry` of `archive`.
///
/// Room grows by a quarter, so that the peak is little above the size.
pub(super) fn read_up_to(reader: impl Read, most: u64, archive: &Path, entry: &str) -> io::Result<Vec<u8>> {
    let mut reader = reader.take(most.saturating_add(1));
    let mut out = Vec::new();
    loop {
        let more = PART.max(out.len() / 4);
        if out.len() as u64 > most || budget::ask(entry, more as u64).is_err() {
            return Err(too_large(archive, entry, most));
        }
        out.try_reserve_exact(more).map_err(|_| too_large(archive, entry, most))?;
        let read = reader.by_ref().take(more as u64).read_to_end(&mut out)?;
        if read < more {
            return if out.len() as u64 > most { Err(too_large(archive, entry, most)) } else { Ok(out) };
        }
    }
}

/// The refusal of an entry that has more than `most` bytes.
pub(super) fn too_large(archive: &Path, entry: &str, most: u64) -> io::Error {
    let name = archive.file_name().unwrap_or_default().to_string_lossy();
    budget::too_large(entry, &format!(" {name}"), most, " unpacked").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_ends_at_the_bound() {
        let read = |n: u64, most: u64| read_up_to(io::repeat(7).take(n), most, Path::new("a.gz"), "a");
        for n in [0, 1, PART as u64 - 1, PART as u64, PART as u64 + 1, 5 * PART as u64] {
            assert_eq!(read(n, 5 * PART as u64).expect("fits").len() as u64, n);
        }
        let endless = read_up_to(io::repeat(7), 3 << 20, Path::new("a.gz"), "a.pdb").unwrap_err();
        assert!(endless.to_string().contains("a.pdb in the archive a.gz has more than 3 MiB"), "{endless}");
        assert!(read(1001, 1000).is_err() && read(1000, 1000).is_ok());
    }
}
