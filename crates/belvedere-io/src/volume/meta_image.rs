//! MetaImage (.mha, .mhd). Source: the documentation of MetaIO (ITK).

use super::{ByteOrder, Number, Source, VolumeFile, inflate, odd_values};
use crate::fs::beside;
use crate::{Fault, InputFile, IoError, Loaded, fs};
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Longest header.
const MAX_HEADER: usize = 1 << 20;
/// Types of samples, as MetaIO names them.
const TYPES: [(&str, Number); 12] = [
    ("MET_CHAR", Number::Int8),
    ("MET_UCHAR", Number::UInt8),
    ("MET_SHORT", Number::Int16),
    ("MET_USHORT", Number::UInt16),
    ("MET_INT", Number::Int32),
    ("MET_UINT", Number::UInt32),
    // MetaIO writes these two with four bytes on every system.
    ("MET_LONG", Number::Int32),
    ("MET_ULONG", Number::UInt32),
    ("MET_LONG_LONG", Number::Int64),
    ("MET_ULONG_LONG", Number::UInt64),
    ("MET_FLOAT", Number::Float32),
    ("MET_DOUBLE", Number::Float64),
];

/// Fields of a header by name, and where it ends.
struct Header {
    fields: BTreeMap<String, String>,
    end: usize,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, IoError> {
    let bad = |fault: Fault| IoError::format(source.path, fault);
    let header = Header::parse(source.bytes).map_err(|e| bad(e.into()))?;
    let name = header.need("ElementDataFile").map_err(|e| bad(e.into()))?;
    let mut files = Vec::new();
    let data: Cow<'_, [u8]> = if name.eq_ignore_ascii_case("LOCAL") {
        Cow::Borrowed(&source.bytes[header.end..])
    } else if name.starts_with("LIST") || name.contains('%') {
        let reason = "its samples are spread over several files, which this version does not read; write it as one, as with SimpleITK";
        return Err(bad(reason.into()));
    } else {
        let path = beside(source.path, name).map_err(|e| bad(e.into()))?;
        let length = fs::metadata(&path).map_err(|e| IoError::os(&path, e))?.len();
        source.request.limits.ask("the volume", length).map_err(|e| bad(e.into()))?;
        let (bytes, file) = InputFile::read(&path)?;
        files.push(file);
        Cow::Owned(bytes)
    };
    let mut loaded = header.volume(source, &data).map_err(bad)?;
    loaded.files = files;
    Ok(loaded)
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut fields = BTreeMap::new();
        let mut at = 0;
        for line in bytes[..bytes.len().min(MAX_HEADER)].split_inclusive(|b| *b == b'\n') {
            at += line.len();
            let text = String::from_utf8_lossy(line);
            let text = text.trim();
            if text.is_empty() {
                continue;
            }
            let Some((key, value)) = text.split_once('=') else {
                let shown: String = text.chars().take(40).collect();
                return Err(format!("header line {shown:?} is no field; it is damaged, or no MetaImage"));
            };
            let key = key.trim().to_owned();
            // The samples follow this field.
            let last = key == "ElementDataFile";
            fields.insert(key, value.trim().to_owned());
            if last {
                return Ok(Self { fields, end: at });
            }
        }
        Err("its header has no field ElementDataFile; it is cut off, or no MetaImage".into())
    }

    /// The value of the first of these fields that is there.
    fn get(&self, keys: &[&str]) -> Option<&str> {
        keys.iter().find_map(|key| self.fields.get(*key)).map(String::as_str)
    }

    fn need(&self, key: &str) -> Result<&str, String> {
        self.get(&[key]).ok_or_else(|| format!("its header has no field {key}; it is damaged"))
    }

    fn is_true(&self, keys: &[&str]) -> bool {
        self.get(keys).is_some_and(|v| v.eq_ignore_ascii_case("true") || v == "1")
    }

    /// Numbers of a field, `count` of them.
    fn numbers(&self, keys: &[&str], count: usize) -> Result<Option<Vec<f64>>, String> {
        let Some(text) = self.get(keys) else { return Ok(None) };
        let list: Option<Vec<f64>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
        let list = list.filter(|list| list.len() == count && list.iter().all(|v| v.is_finite()));
        let shown: String = text.chars().take(60).collect();
        list.map(Some).ok_or_else(|| format!("its {} {shown:?} is no list of {count} finite numbers", keys[0]))
    }

    fn volume(&self, source: &Source<'_>, data: &[u8]) -> Result<Loaded<VolumeFile>, Fault> {
        let all: usize = self.need("NDims")?.parse().ok().filter(|n| (1..=10).contains(n)).ok_or_else(|| {
            format!("its NDims is {:.20?}, 1 to 10 are possible; it is damaged", self.get(&["NDims"]))
        })?;
        let dims = self.dims(all)?;
        let kind = self.need("ElementType")?;
        let number = TYPES.iter().find(|(name, _)| *name == kind).map(|(_, number)| *number);
        let number = number.ok_or_else(|| {
            format!("samples of type {kind:.40?} are not read; convert them to a number type, as with SimpleITK")
        })?;
        if let Some(channels) = self.get(&["ElementNumberOfChannels"]).filter(|c| *c != "1") {
            return Err(format!(
                "it has {channels:.20} values in each voxel, single values are needed; write one of them, as with SimpleITK"
            )
            .into());
        }
        let data = self.skipped(data, dims, number)?;
        let (values, changed) = if self.get(&["BinaryData"]).is_some_and(|v| v.eq_ignore_ascii_case("false")) {
            let count = source.expected(dims, number, data.len(), true)? / number.bytes();
            if count > data.len() {
                return Err(
                    format!("it declares {count} values and has {} bytes of text; it is cut off", data.len()).into()
                );
            }
            let text = std::str::from_utf8(data)
                .map_err(|e| format!("byte {} of its text is no text; it is damaged", e.valid_up_to()))?;
            number.parse(text, count)?
        } else {
            let packed = self.is_true(&["CompressedData"]);
            let expected = source.expected(dims, number, data.len(), packed)?;
            let bytes = if packed { inflate(data, expected)? } else { data[..expected].to_vec() };
            number.decode(bytes, self.order())
        };
        let (axes, origin) = self.place(all)?;
        let file = VolumeFile { format: "MetaImage", array: None, stored: number, dims, axes, origin, values };
        Ok(Loaded::new(file, odd_values(source.path, &changed)))
    }

    fn order(&self) -> ByteOrder {
        let keys = ["BinaryDataByteOrderMSB", "ElementByteOrderMSB"];
        if self.is_true(&keys) { ByteOrder::Big } else { ByteOrder::Little }
    }

    /// Voxels along the first three of `all` dimensions, where the others have one each.
    fn dims(&self, all: usize) -> Result<[usize; 3], String> {
        let text = self.need("DimSize")?;
        let list: Option<Vec<usize>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
        let shown: String = text.chars().take(60).collect();
        let list = list.filter(|list| list.len() == all);
        let list =
            list.ok_or_else(|| format!("its DimSize {shown:?} is no list of {all} whole numbers; it is damaged"))?;
        match list.split_at_checked(3) {
            Some((&[x, y, z], others)) if others.iter().all(|n| *n == 1) => Ok([x, y, z]),
            _ => Err(format!(
                "it has the dimensions {shown}, a volume of single values has 3; take one out of it, as with SimpleITK"
            )),
        }
    }

    /// The samples after a header of their own.
    fn skipped<'d>(&self, data: &'d [u8], dims: [usize; 3], number: Number) -> Result<&'d [u8], String> {
        let Some(text) = self.get(&["HeaderSize"]) else { return Ok(data) };
        let size: i64 = text.parse().map_err(|_| format!("its HeaderSize {text:.20?} is no whole number"))?;
        let from = match size {
            -1 => {
                let samples = dims.iter().try_fold(number.bytes(), |n, d| n.checked_mul(*d));
                samples.and_then(|n| data.len().checked_sub(n))
            }
            _ => usize::try_from(size).ok().filter(|n| *n <= data.len()),
        };
        from.map(|from| &data[from..])
            .ok_or_else(|| format!("its HeaderSize is {size}, and it has {} bytes of data; it is damaged", data.len()))
    }

    /// Axes and origin. Their directions are those of DICOM: left, posterior, superior.
    fn place(&self, all: usize) -> Result<(DMat3, DVec3), String> {
        let first = |list: &[f64]| DVec3::new(list[0], list[1], list[2]);
        let spacing = self.numbers(&["ElementSpacing", "ElementSize"], all)?.map_or(DVec3::ONE, |list| first(&list));
        let origin = self.numbers(&["Offset", "Position", "Origin"], all)?.map_or(DVec3::ZERO, |list| first(&list));
        // Row by row: each row is the direction of an axis.
        let turn = self.numbers(&["TransformMatrix", "Rotation", "Orientation"], all * all)?;
        let turn = turn.map_or(DMat3::IDENTITY, |list| {
            DMat3::from_cols(first(&list), first(&list[all..]), first(&list[2 * all..]))
        });
        Ok((turn * DMat3::from_diagonal(spacing), origin))
    }
}
