//! The pages of a database: the tree of a table, walked in the order of its rows, and the chains of pages of long rows.

use super::damaged;
use super::header::{Header, SIZE};
use super::record::varint;
use std::borrow::Cow;

/// Deepest tree that is walked. Five levels of the smallest pages hold more than the largest file that is read.
const MAX_DEPTH: usize = 40;
/// Kinds of pages of tables.
const INTERIOR: u8 = 5;
const LEAF: u8 = 13;

/// A call with the number of a row and its record.
pub(super) type Visit<'v> = dyn FnMut(i64, &[u8]) -> Result<(), String> + 'v;

/// The pages of a file.
pub(super) struct Pages<'b> {
    bytes: &'b [u8],
    header: &'b Header,
}

/// A walk over a tree. No page belongs to it twice, so a walk takes no more steps than the file has bytes.
struct Walk<'w, 'b> {
    pages: &'w Pages<'b>,
    seen: Vec<bool>,
}

impl<'b> Pages<'b> {
    pub(super) fn new(bytes: &'b [u8], header: &'b Header) -> Self {
        Self { bytes, header }
    }

    /// Calls `visit` for every row of the table whose tree begins at a page.
    ///
    /// # Errors
    /// A predicate where the file is damaged; those of `visit`.
    pub(super) fn each(&self, root: u32, visit: &mut Visit<'_>) -> Result<(), String> {
        let mut walk = Walk { pages: self, seen: vec![false; self.bytes.len() / self.header.page + 1] };
        walk.tree(root, MAX_DEPTH, visit)
    }

    /// A page, by its number from 1 on, without what is reserved.
    fn page(&self, number: u32) -> Option<&'b [u8]> {
        let start = (number as usize).checked_sub(1)?.checked_mul(self.header.page)?;
        self.bytes.get(start..start.checked_add(self.header.usable)?)
    }

    /// How many bytes of a record of this size lie on its leaf; the rest lies on a chain of pages.
    fn local(&self, size: usize) -> usize {
        let usable = self.header.usable;
        let most = usable - 35;
        if size <= most {
            return size;
        }
        let least = (usable - 12) * 32 / 255 - 23;
        let fit = least + (size - least) % (usable - 4);
        if fit <= most { fit } else { least }
    }
}

impl<'b> Walk<'_, 'b> {
    /// Takes a page for this walk.
    fn take(&mut self, number: u32) -> Result<&'b [u8], String> {
        let count = self.pages.bytes.len() / self.pages.header.page;
        let page = self.pages.page(number);
        let page = page.ok_or_else(|| damaged(format_args!("it refers to page {number} and has {count}")))?;
        match self.seen.get_mut(number as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(damaged(format_args!("page {number} belongs to two places"))),
        }
        Ok(page)
    }

    fn tree(&mut self, number: u32, left: usize, visit: &mut Visit<'_>) -> Result<(), String> {
        let page = self.take(number)?;
        let start = if number == 1 { SIZE } else { 0 };
        let bad = |what: &str| damaged(format_args!("page {number} {what}"));
        let left = left.checked_sub(1).ok_or_else(|| bad("lies too deep in its tree"))?;
        let kind = page[start];
        let count = usize::from(u16::from_be_bytes([page[start + 3], page[start + 4]]));
        let pointers = match kind {
            INTERIOR => start + 12,
            LEAF => start + 8,
            _ => return Err(bad("is not one of a table")),
        };
        let pointers = page.get(pointers..pointers + 2 * count).ok_or_else(|| bad("has more cells than room"))?;
        let cell = |pointer: &[u8; 2]| page.get(usize::from(u16::from_be_bytes(*pointer))..);
        let outside = || bad("has a cell outside of itself");
        // Cells share no bytes, so that together they are no larger than the page.
        let mut room = page.len();
        for pointer in pointers.as_chunks::<2>().0 {
            let cell = cell(pointer).ok_or_else(outside)?;
            if kind == INTERIOR {
                let child = cell.first_chunk::<4>().ok_or_else(outside)?;
                self.tree(u32::from_be_bytes(*child), left, visit)?;
                continue;
            }
            let (size, rest) = varint(cell).ok_or_else(outside)?;
            let (row, rest) = varint(rest).ok_or_else(outside)?;
            let record = self.record(size, rest, &mut room).map_err(|e| e.unwrap_or_else(outside))?;
            visit(row as i64, &record)?;
        }
        if kind == INTERIOR {
            let last = page.get(start + 8..start + 12).and_then(|b| b.first_chunk::<4>()).ok_or_else(outside)?;
            self.tree(u32::from_be_bytes(*last), left, visit)?;
        }
        Ok(())
    }

    /// The record that begins with these bytes of a leaf; no text in the error if it does not lie on the page.
    fn record(&mut self, size: u64, bytes: &'b [u8], room: &mut usize) -> Result<Cow<'b, [u8]>, Option<String>> {
        let most = self.pages.bytes.len();
        let size = usize::try_from(size).ok().filter(|size| *size <= most);
        let size = size.ok_or_else(|| Some(damaged("a row is larger than the file")))?;
        let local = self.pages.local(size);
        *room = room.checked_sub(local).ok_or(None)?;
        let (here, rest) = bytes.split_at_checked(local).ok_or(None)?;
        if local == size {
            return Ok(here.into());
        }
        let mut record = Vec::with_capacity(size);
        record.extend(here);
        let mut next = u32::from_be_bytes(*rest.first_chunk().ok_or(None)?);
        while record.len() < size {
            let page = self.take(next).map_err(Some)?;
            let (link, content) = page.split_first_chunk::<4>().ok_or(None)?;
            record.extend(content.iter().take(size - record.len()));
            next = u32::from_be_bytes(*link);
        }
        Ok(record.into())
    }
}
