//! Records: the values of one row.

use super::damaged;
use std::borrow::Cow;

/// Encoding of the texts of a database.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    Utf16Little,
    Utf16Big,
}

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value<'r> {
    /// No value.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A text.
    Text(Cow<'r, str>),
    /// Bytes.
    Blob(Cow<'r, [u8]>),
}

impl Value<'_> {
    /// The same value, which borrows nothing.
    pub(crate) fn to_owned(&self) -> Value<'static> {
        match self {
            Self::Null => Value::Null,
            Self::Integer(number) => Value::Integer(*number),
            Self::Real(number) => Value::Real(*number),
            Self::Text(text) => Value::Text(text.clone().into_owned().into()),
            Self::Blob(bytes) => Value::Blob(bytes.clone().into_owned().into()),
        }
    }

    /// The text, if it is one.
    pub(crate) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The whole number, if it is one.
    pub(crate) fn integer(&self) -> Option<i64> {
        match self {
            Self::Integer(number) => Some(*number),
            _ => None,
        }
    }

    /// What kind of value it is.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "Null",
            Self::Integer(_) => "Integer",
            Self::Real(_) => "Real",
            Self::Text(_) => "Text",
            Self::Blob(_) => "Blob",
        }
    }
}

/// A number of 1 to 9 bytes and the rest of the bytes; `None` if they end before.
pub(super) fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut number = 0u64;
    for (k, &byte) in bytes.iter().enumerate().take(9) {
        if k == 8 {
            return Some((number << 8 | u64::from(byte), &bytes[9..]));
        }
        number = number << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            return Some((number, &bytes[k + 1..]));
        }
    }
    None
}

/// The values of a record.
///
/// # Errors
/// A predicate if its lengths do not fit its bytes.
pub(super) fn values(record: &[u8], encoding: Encoding) -> Result<Vec<Value<'_>>, String> {
    let short = || damaged("a row is longer than what is stored of it");
    let (size, _) = varint(record).ok_or_else(short)?;
    let size = usize::try_from(size).ok().filter(|size| *size <= record.len()).ok_or_else(short)?;
    let (head, mut body) = record.split_at(size);
    let (_, mut types) = varint(head).ok_or_else(short)?;
    let mut out = Vec::new();
    while !types.is_empty() {
        let (code, rest) = varint(types).ok_or_else(short)?;
        types = rest;
        let size = match code {
            0 | 8 | 9 => 0,
            1..=4 => code as usize,
            5 => 6,
            6 | 7 => 8,
            10 | 11 => return Err(damaged(format_args!("a value is of the type {code}, which SQLite does not use"))),
            _ => usize::try_from((code - 12) / 2).map_err(|_| short())?,
        };
        let (bytes, rest) = body.split_at_checked(size).ok_or_else(short)?;
        body = rest;
        out.push(match code {
            0 => Value::Null,
            1..=6 => Value::Integer(integer(bytes)),
            7 => real(bytes),
            8 | 9 => Value::Integer(code as i64 - 8),
            _ if code % 2 == 0 => Value::Blob(bytes.into()),
            _ => Value::Text(text(bytes, encoding)),
        });
    }
    Ok(out)
}

/// A big-endian number of up to 8 bytes in two's complement.
fn integer(bytes: &[u8]) -> i64 {
    let sign = bytes.first().map_or(0, |first| i64::from(*first as i8) >> 7);
    bytes.iter().fold(sign, |number, byte| number << 8 | i64::from(*byte))
}

/// A number; SQLite has none that is not a number.
fn real(bytes: &[u8]) -> Value<'static> {
    let number = f64::from_bits(integer(bytes) as u64);
    if number.is_nan() { Value::Null } else { Value::Real(number) }
}

fn text(bytes: &[u8], encoding: Encoding) -> Cow<'_, str> {
    let units: fn(&[u8; 2]) -> u16 = match encoding {
        Encoding::Utf8 => return String::from_utf8_lossy(bytes),
        Encoding::Utf16Little => |pair| u16::from_le_bytes(*pair),
        Encoding::Utf16Big => |pair| u16::from_be_bytes(*pair),
    };
    let units = bytes.as_chunks::<2>().0.iter().map(units);
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>().into()
}
