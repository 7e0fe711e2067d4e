//! Tables of a flat buffer: fields by their numbers, all of them behind checks of their place.

/// A table in a buffer.
#[derive(Clone, Copy)]
pub(super) struct Table<'b> {
    buffer: &'b [u8],
    at: usize,
}

fn number<const N: usize>(buffer: &[u8], at: usize) -> Option<[u8; N]> {
    buffer.get(at..)?.first_chunk().copied()
}

fn offset(buffer: &[u8], at: usize) -> Option<usize> {
    at.checked_add(u32::from_le_bytes(number(buffer, at)?) as usize)
}

impl<'b> Table<'b> {
    /// The table that a buffer holds.
    pub(super) fn root(buffer: &'b [u8]) -> Option<Self> {
        Some(Self { buffer, at: offset(buffer, 0)? })
    }

    /// Place of a field; `None` if it is left out or lies outside of the buffer.
    fn field(&self, field: usize) -> Option<usize> {
        let back = i64::from(i32::from_le_bytes(number(self.buffer, self.at)?));
        let layout = usize::try_from(self.at as i64 - back).ok()?;
        let size = usize::from(u16::from_le_bytes(number(self.buffer, layout)?));
        let entry = 4 + 2 * field;
        if entry + 2 > size {
            return None;
        }
        match u16::from_le_bytes(number(self.buffer, layout.checked_add(entry)?)?) {
            0 => None,
            at => self.at.checked_add(usize::from(at)),
        }
    }

    /// A number of a field.
    pub(super) fn bytes<const N: usize>(&self, field: usize) -> Option<[u8; N]> {
        number(self.buffer, self.field(field)?)
    }

    /// First byte and length of a list, whose items have `size` bytes each.
    fn place(&self, field: usize, size: usize) -> Option<(usize, usize)> {
        let at = offset(self.buffer, self.field(field)?)?;
        let count = u32::from_le_bytes(number(self.buffer, at)?) as usize;
        Some((at.checked_add(4)?, count.checked_mul(size)?))
    }

    /// The bytes of a list, whose items have `size` bytes each.
    pub(super) fn list(&self, field: usize, size: usize) -> Option<&'b [u8]> {
        let (start, length) = self.place(field, size)?;
        self.buffer.get(start..start.checked_add(length)?)
    }

    /// A text.
    pub(super) fn text(&self, field: usize) -> Option<String> {
        self.list(field, 1).map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// A table in a field.
    pub(super) fn table(&self, field: usize) -> Option<Self> {
        Some(Self { buffer: self.buffer, at: offset(self.buffer, self.field(field)?)? })
    }

    /// The tables of a list.
    pub(super) fn tables(&self, field: usize) -> impl Iterator<Item = Self> + use<'b> {
        let buffer = self.buffer;
        let (start, length) = self.list(field, 4).and(self.place(field, 4)).unwrap_or_default();
        (0..length / 4).filter_map(move |k| Some(Self { buffer, at: offset(buffer, start + 4 * k)? }))
    }
}
