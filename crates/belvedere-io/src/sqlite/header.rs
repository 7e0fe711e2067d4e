//! The header of a database: the size of its pages and the encoding of its texts.

use super::damaged;
use super::record::Encoding;

/// First bytes of SQLite files.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";
/// Bytes of the header, at the start of the first page.
pub(super) const SIZE: usize = 100;
/// Fewest bytes of a page that cells may use.
const LEAST_USABLE: usize = 480;

/// What the header says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    /// Bytes of a page.
    pub(super) page: usize,
    /// Bytes of a page without those that are reserved at its end.
    pub(super) usable: usize,
    pub(super) encoding: Encoding,
}

impl Header {
    /// # Errors
    /// A predicate for files that are shorter than the header says, damaged or of another version.
    pub(super) fn of(bytes: &[u8]) -> Result<Self, String> {
        let Some(head) = bytes.first_chunk::<SIZE>() else {
            return Err(format!(
                "is {} bytes long, an SQLite file has a header of {SIZE}; the file is cut off, get it again",
                bytes.len()
            ));
        };
        let number = |at: usize| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let page = match u16::from_be_bytes([head[16], head[17]]) {
            1 => 65_536,
            size if size >= 512 && size.is_power_of_two() => usize::from(size),
            size => {
                return Err(damaged(format_args!("its pages have {size} bytes, a power of two from 512 on is needed")));
            }
        };
        if head[19] > 2 {
            return Err(format!(
                "is an SQLite file of version {}, the last that is known is 2; save it with an older program",
                head[19]
            ));
        }
        let usable = page - usize::from(head[20]);
        if usable < LEAST_USABLE || head[21..24] != [64, 32, 32] {
            return Err(damaged("the layout of its pages is not one that SQLite has"));
        }
        let encoding = match number(56) {
            0 | 1 => Encoding::Utf8,
            2 => Encoding::Utf16Little,
            3 => Encoding::Utf16Big,
            other => return Err(damaged(format_args!("its texts have the encoding {other}, the last is 3"))),
        };
        // Old programs leave the count of pages as it was.
        let wanted = u64::from(number(28)) * page as u64;
        if number(24) == number(92) && wanted > bytes.len() as u64 {
            return Err(format!(
                "is {} bytes long, its header says {wanted}; the file is cut off, get it again",
                bytes.len()
            ));
        }
        Ok(Self { page, usable, encoding })
    }
}
