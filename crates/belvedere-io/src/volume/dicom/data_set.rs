//! Elements of a DICOM file. Source: DICOM PS3.5 2024e, section 7 and annex A, and PS3.10, section 7.

use std::collections::BTreeMap;
use std::ops::Range;

/// Deepest nesting of sequences.
const MAX_DEPTH: usize = 16;
/// Most elements of a file.
const MAX_ELEMENTS: usize = 4 << 20;
/// Length that is told by a mark at the end.
const OPEN: u32 = u32::MAX;
const ITEM: u32 = 0xfffe_e000;
const END_OF_ITEM: u32 = 0xfffe_e00d;
const END_OF_SEQUENCE: u32 = 0xfffe_e0dd;

/// The pixels.
pub(super) const PIXELS: u32 = 0x7fe0_0010;

/// Sequences that are read where a file does not state types.
const SEQUENCES: [u32; 6] = [0x5200_9229, 0x5200_9230, 0x0028_9110, 0x0020_9113, 0x0020_9116, 0x0028_9145];
/// Types with four bytes of length.
const LONG: [&[u8; 2]; 13] =
    [b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV"];

/// How elements are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Encoding {
    pub(super) explicit: bool,
    pub(super) big_endian: bool,
}

/// Value of an element, by its place in the file.
#[derive(Debug, Clone)]
pub(super) enum Value {
    Bytes(Range<usize>),
    Items(Vec<DataSet>),
    /// Pieces of compressed pixels; the first is the table of offsets.
    Fragments(Vec<Range<usize>>),
}

/// Elements by their tags.
#[derive(Debug, Clone, Default)]
pub(super) struct DataSet(pub(super) BTreeMap<u32, Value>);

/// Bytes that are read from a position on.
pub(super) struct Parser<'b> {
    bytes: &'b [u8],
    at: usize,
    encoding: Encoding,
    elements: usize,
}

impl<'b> Parser<'b> {
    pub(super) fn new(bytes: &'b [u8], at: usize, encoding: Encoding) -> Self {
        Self { bytes, at, encoding, elements: 0 }
    }

    /// Elements up to the end of the file, or while `wanted` holds for their tags; returns where they end.
    pub(super) fn read(mut self, wanted: impl Fn(u32) -> bool) -> Result<(DataSet, usize), String> {
        let mut out = DataSet::default();
        while self.at < self.bytes.len() {
            let start = self.at;
            let tag = self.tag()?;
            if !wanted(tag) {
                self.at = start;
                break;
            }
            let value = self.value(tag, 0)?;
            out.0.insert(tag, value);
        }
        Ok((out, self.at))
    }

    fn cut(&self) -> String {
        format!("its element at byte {} ends after the file, which has {}; it is cut off", self.at, self.bytes.len())
    }

    fn take(&mut self, count: usize) -> Result<Range<usize>, String> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len()).ok_or_else(|| self.cut())?;
        let range = self.at..end;
        self.at = end;
        Ok(range)
    }

    fn number(&mut self, count: usize) -> Result<u32, String> {
        let range = self.take(count)?;
        let step = |all: u32, byte: &u8| all << 8 | u32::from(*byte);
        let bytes = &self.bytes[range];
        Ok(if self.encoding.big_endian { bytes.iter().fold(0, step) } else { bytes.iter().rev().fold(0, step) })
    }

    fn tag(&mut self) -> Result<u32, String> {
        Ok(self.number(2)? << 16 | self.number(2)?)
    }

    /// Type and length of the element whose tag was read.
    fn header(&mut self, tag: u32) -> Result<([u8; 2], u32), String> {
        if !self.encoding.explicit || tag >> 16 == 0xfffe {
            let kind = if SEQUENCES.contains(&tag) { *b"SQ" } else { *b"UN" };
            return Ok((kind, self.number(4)?));
        }
        let range = self.take(2)?;
        let kind = [self.bytes[range.start], self.bytes[range.start + 1]];
        if !kind.iter().all(u8::is_ascii_uppercase) {
            let (at, group, element) = (self.at, tag >> 16, tag & 0xffff);
            return Err(format!("its element ({group:04x},{element:04x}) before byte {at} has no type; it is damaged"));
        }
        if !LONG.contains(&&kind) {
            return Ok((kind, self.number(2)?));
        }
        self.take(2)?;
        Ok((kind, self.number(4)?))
    }

    fn value(&mut self, tag: u32, depth: usize) -> Result<Value, String> {
        self.elements += 1;
        if self.elements > MAX_ELEMENTS || depth > MAX_DEPTH {
            return Err(format!(
                "it has more than {MAX_ELEMENTS} elements or {MAX_DEPTH} sequences in each other; it is damaged"
            ));
        }
        let (kind, length) = self.header(tag)?;
        if tag == PIXELS && length == OPEN {
            return self.fragments();
        }
        if kind == *b"SQ" || length == OPEN {
            // What has an unknown type and an open length is stored without types.
            let outer = self.encoding;
            if kind == *b"UN" && length == OPEN {
                self.encoding = Encoding { explicit: false, big_endian: false };
            }
            let items = self.items(length, depth);
            self.encoding = outer;
            return items.map(Value::Items);
        }
        self.take(length as usize).map(Value::Bytes)
    }

    fn end_of(&self, length: u32) -> Result<usize, String> {
        if length == OPEN {
            return Ok(usize::MAX);
        }
        let end = self.at.checked_add(length as usize).filter(|end| *end <= self.bytes.len());
        end.ok_or_else(|| self.cut())
    }

    fn items(&mut self, length: u32, depth: usize) -> Result<Vec<DataSet>, String> {
        let (end, mut items) = (self.end_of(length)?, Vec::new());
        while self.at < end {
            let tag = self.tag()?;
            let length = self.number(4)?;
            match tag {
                ITEM => items.push(self.item(length, depth)?),
                END_OF_SEQUENCE => break,
                _ => return Err(format!("its sequence before byte {} has no item; it is damaged", self.at)),
            }
        }
        Ok(items)
    }

    fn item(&mut self, length: u32, depth: usize) -> Result<DataSet, String> {
        let (end, mut out) = (self.end_of(length)?, DataSet::default());
        self.elements += 1;
        while self.at < end {
            let tag = self.tag()?;
            if tag == END_OF_ITEM {
                self.number(4)?;
                break;
            }
            let value = self.value(tag, depth + 1)?;
            out.0.insert(tag, value);
        }
        Ok(out)
    }

    fn fragments(&mut self) -> Result<Value, String> {
        let mut found = Vec::new();
        loop {
            let tag = self.tag()?;
            let length = self.number(4)?;
            match tag {
                ITEM => found.push(self.take(length as usize)?),
                END_OF_SEQUENCE => return Ok(Value::Fragments(found)),
                _ => return Err(format!("its pixels before byte {} have no piece; they are damaged", self.at)),
            }
            self.elements += 1;
            if self.elements > MAX_ELEMENTS {
                return Err(format!("its pixels have more than {MAX_ELEMENTS} pieces; they are damaged"));
            }
        }
    }
}

/// A data set with the bytes that its values lie in.
#[derive(Clone, Copy)]
pub(super) struct View<'b> {
    pub(super) set: &'b DataSet,
    pub(super) bytes: &'b [u8],
    pub(super) big_endian: bool,
}

impl<'b> View<'b> {
    fn raw(self, tag: u32) -> Option<&'b [u8]> {
        match self.set.0.get(&tag)? {
            Value::Bytes(range) => self.bytes.get(range.clone()),
            _ => None,
        }
    }

    /// Text of an element without blanks and zeros around it.
    pub(super) fn text(self, tag: u32) -> Option<String> {
        let text = String::from_utf8_lossy(self.raw(tag)?).into_owned();
        Some(text.trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()).filter(|text| !text.is_empty())
    }

    /// Numbers that are written as text, separated by backslashes; `None` unless all of them are finite.
    pub(super) fn decimals(self, tag: u32) -> Option<Vec<f64>> {
        let number = |word: &str| word.trim().parse().ok().filter(|v: &f64| v.is_finite());
        self.text(tag)?.split('\\').map(number).collect()
    }

    /// As many decimals.
    pub(super) fn some<const N: usize>(self, tag: u32) -> Option<[f64; N]> {
        self.decimals(tag)?.get(..N)?.try_into().ok()
    }

    pub(super) fn decimal(self, tag: u32) -> Option<f64> {
        self.some::<1>(tag).map(|[value]| value)
    }

    /// A whole number of two bytes.
    pub(super) fn short(self, tag: u32) -> Option<u16> {
        let bytes = *self.raw(tag)?.first_chunk::<2>()?;
        Some(if self.big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    }

    pub(super) fn items(self, tag: u32) -> impl Iterator<Item = Self> {
        let items: &[DataSet] = match self.set.0.get(&tag) {
            Some(Value::Items(items)) => items,
            _ => &[],
        };
        items.iter().map(move |set| Self { set, ..self })
    }
}
