//! Types of samples and their decoding.

use crate::half::half_to_f32;
use belvedere_scene::VoxelValues;
use serde::Serialize;
use std::borrow::Cow;

/// Order of the bytes of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ByteOrder {
    /// Least significant first.
    #[default]
    Little,
    /// Most significant first.
    Big,
}

/// Type of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names say all")]
pub enum Number {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float16,
    Float32,
    Float64,
}

/// Every name of a type, as files write it, in lower case.
const NAMES: &[(&str, Number)] = &[
    ("int8", Number::Int8),
    ("int8_t", Number::Int8),
    ("signed char", Number::Int8),
    ("uint8", Number::UInt8),
    ("uint8_t", Number::UInt8),
    ("uchar", Number::UInt8),
    ("unsigned char", Number::UInt8),
    ("int16", Number::Int16),
    ("int16_t", Number::Int16),
    ("short", Number::Int16),
    ("short int", Number::Int16),
    ("signed short", Number::Int16),
    ("signed short int", Number::Int16),
    ("uint16", Number::UInt16),
    ("uint16_t", Number::UInt16),
    ("ushort", Number::UInt16),
    ("unsigned short", Number::UInt16),
    ("unsigned short int", Number::UInt16),
    ("int32", Number::Int32),
    ("int32_t", Number::Int32),
    ("int", Number::Int32),
    ("signed int", Number::Int32),
    ("uint32", Number::UInt32),
    ("uint32_t", Number::UInt32),
    ("uint", Number::UInt32),
    ("unsigned int", Number::UInt32),
    ("int64", Number::Int64),
    ("int64_t", Number::Int64),
    ("longlong", Number::Int64),
    ("long long", Number::Int64),
    ("long long int", Number::Int64),
    ("signed long long", Number::Int64),
    ("uint64", Number::UInt64),
    ("uint64_t", Number::UInt64),
    ("ulonglong", Number::UInt64),
    ("unsigned long long", Number::UInt64),
    ("float16", Number::Float16),
    ("half", Number::Float16),
    ("float32", Number::Float32),
    ("float", Number::Float32),
    ("float64", Number::Float64),
    ("double", Number::Float64),
];

/// Numbers of values that were changed by the conversion, and the least value.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Changed {
    pub(super) not_finite: usize,
    pub(super) rounded: usize,
    pub(super) least: f32,
}

impl Number {
    /// The type of a name as NRRD, VTK or numpy write it.
    pub fn named(name: &str) -> Option<Self> {
        let name = name.trim().to_ascii_lowercase();
        NAMES.iter().find(|(n, _)| *n == name).map(|(_, number)| *number)
    }

    /// Bytes of a sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::Int8 | Self::UInt8 => 1,
            Self::Int16 | Self::UInt16 | Self::Float16 => 2,
            Self::Int32 | Self::UInt32 | Self::Float32 => 4,
            Self::Int64 | Self::UInt64 | Self::Float64 => 8,
        }
    }

    /// Bytes that a sample takes at the peak of decoding: as stored, and the values made of it.
    pub(super) fn peak_bytes(self) -> u64 {
        match self {
            Self::UInt8 => 1,
            Self::Int8 => 3,
            Self::Int16 | Self::UInt16 => 4,
            Self::Float16 => 6,
            Self::Float32 => 8,
            Self::Float64 => 12,
            Self::Int32 | Self::UInt32 => 16,
            Self::Int64 | Self::UInt64 => 20,
        }
    }

    /// Decodes samples from bytes, a whole number of samples.
    pub(super) fn decode<'b>(self, bytes: impl Into<Cow<'b, [u8]>>, order: ByteOrder) -> (VoxelValues, Changed) {
        let bytes = bytes.into();
        macro_rules! each {
            ($t:ty, $to:expr) => {{
                const N: usize = size_of::<$t>();
                let of = |b: &[u8]| -> $t {
                    let b = std::array::from_fn::<u8, N, _>(|i| b[i]);
                    if order == ByteOrder::Big { <$t>::from_be_bytes(b) } else { <$t>::from_le_bytes(b) }
                };
                bytes.chunks_exact(N).map(of).map($to).collect()
            }};
        }
        let whole = Changed::default();
        match self {
            Self::UInt8 => (VoxelValues::U8(bytes.into_owned()), whole),
            Self::Int8 => (VoxelValues::I16(each!(i8, i16::from)), whole),
            Self::Int16 => (VoxelValues::I16(each!(i16, |v| v)), whole),
            Self::UInt16 => (VoxelValues::U16(each!(u16, |v| v)), whole),
            Self::Int32 => floats(each!(i32, f64::from)),
            Self::UInt32 => floats(each!(u32, f64::from)),
            Self::Int64 => floats(each!(i64, |v| v as f64)),
            Self::UInt64 => floats(each!(u64, |v| v as f64)),
            Self::Float16 => finite(each!(u16, half_to_f32), 0),
            Self::Float32 => finite(each!(f32, |v| v), 0),
            Self::Float64 => finite(each!(f64, |v| v as f32), 0),
        }
    }

    /// Decodes samples from text: numbers separated by white space or commas.
    pub(super) fn parse(self, text: &str, count: usize) -> Result<(VoxelValues, Changed), String> {
        let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty());
        let mut bytes = Vec::new();
        let mut found = 0;
        for word in words {
            if found == count {
                return Err(format!("it has more than the {count} values declared; check the dimensions"));
            }
            let bad = || {
                let shown: String = word.chars().take(30).collect();
                format!("value {} is {shown:?}, a number of type {self} was expected; it is damaged", found + 1)
            };
            macro_rules! put {
                ($t:ty) => {
                    bytes.extend_from_slice(&word.parse::<$t>().map_err(|_| bad())?.to_le_bytes())
                };
            }
            match self {
                Self::Int8 => put!(i8),
                Self::UInt8 => put!(u8),
                Self::Int16 => put!(i16),
                Self::UInt16 => put!(u16),
                Self::Int32 => put!(i32),
                Self::UInt32 => put!(u32),
                Self::Int64 => put!(i64),
                Self::UInt64 => put!(u64),
                Self::Float16 | Self::Float32 => put!(f32),
                Self::Float64 => put!(f64),
            }
            found += 1;
        }
        if found < count {
            return Err(format!("it has {found} values of {count}; it is cut off, or the dimensions are wrong"));
        }
        // A text has no halves.
        let stored = if self == Self::Float16 { Self::Float32 } else { self };
        Ok(stored.decode(bytes, ByteOrder::Little))
    }
}

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(NAMES.iter().find(|(_, n)| n == self).map_or("", |(name, _)| name))
    }
}

fn floats(values: Vec<f64>) -> (VoxelValues, Changed) {
    let rounded = values.iter().filter(|v| f64::from(**v as f32) != **v).count();
    finite(values.into_iter().map(|v| v as f32).collect(), rounded)
}

fn finite(mut values: Vec<f32>, rounded: usize) -> (VoxelValues, Changed) {
    let least = values.iter().copied().filter(|v| v.is_finite()).fold(f32::INFINITY, f32::min);
    let least = if least.is_finite() { least } else { 0.0 };
    let mut not_finite = 0;
    for v in &mut values {
        if !v.is_finite() {
            *v = least;
            not_finite += 1;
        }
    }
    (VoxelValues::F32(values), Changed { not_finite, rounded, least })
}
