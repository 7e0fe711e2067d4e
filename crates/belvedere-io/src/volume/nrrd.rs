//! NRRD, header attached or apart. Source: Kindlmann, "Definition of NRRD File Format" (teem).

use super::{ByteOrder, Number, Source, VolumeFile, gunzip, odd_values};
use crate::fs::beside;
use crate::{Fault, InputFile, IoError, Loaded, fs};
use belvedere_core::{Warning, WarningKind};
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Longest header.
const MAX_HEADER: usize = 1 << 20;

/// Fields of a header, by name in lower case without spaces, and where the header ends.
struct Header {
    fields: BTreeMap<String, String>,
    end: usize,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, IoError> {
    let bad = |fault: Fault| IoError::format(source.path, fault);
    let header = Header::parse(source.bytes).map_err(|e| bad(e.into()))?;
    let mut files = Vec::new();
    let data: Cow<'_, [u8]> = match header.get("datafile") {
        None => Cow::Borrowed(&source.bytes[header.end..]),
        Some(name) => {
            let path = detached(source, name).map_err(|e| bad(e.into()))?;
            let length = fs::metadata(&path).map_err(|e| IoError::os(&path, e))?.len();
            source.request.limits.ask("the volume", length).map_err(|e| bad(e.into()))?;
            let (bytes, file) = InputFile::read(&path)?;
            files.push(file);
            Cow::Owned(bytes)
        }
    };
    let mut loaded = header.volume(source, &data).map_err(bad)?;
    loaded.files = files;
    Ok(loaded)
}

/// The one file that a detached header names.
fn detached(source: &Source<'_>, name: &str) -> Result<PathBuf, String> {
    if name.starts_with("LIST") || name.contains('%') {
        return Err(
            "its samples are spread over several files, which this version does not read; join them with unu".into()
        );
    }
    beside(source.path, name)
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        if !bytes.starts_with(b"NRRD000") {
            return Err("it does not begin with NRRD000; it is no NRRD file".into());
        }
        let mut fields = BTreeMap::new();
        let mut at = 0;
        for line in bytes[..bytes.len().min(MAX_HEADER)].split_inclusive(|b| *b == b'\n') {
            let first = at == 0;
            at += line.len();
            let text = String::from_utf8_lossy(line);
            let text = text.trim_end_matches(['\n', '\r']);
            if text.is_empty() {
                return Ok(Self { fields, end: at });
            }
            if first || text.starts_with('#') || text.contains(":=") {
                continue;
            }
            let Some((key, value)) = text.split_once(": ").or_else(|| text.split_once(':')) else {
                let shown: String = text.chars().take(40).collect();
                return Err(format!("header line {shown:?} is no field; it is damaged"));
            };
            let key = key.to_lowercase().replace(' ', "");
            // Names of files follow, up to the end.
            let lists = key == "datafile" && value.trim().starts_with("LIST");
            fields.insert(key, value.trim().to_owned());
            if lists {
                return Ok(Self { fields, end: bytes.len() });
            }
        }
        // A detached header may end with its file, without an empty line.
        if fields.contains_key("datafile") && at == bytes.len() {
            return Ok(Self { fields, end: at });
        }
        Err("its header has no end (an empty line); it is cut off".into())
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.fields.get(key).map(String::as_str)
    }

    fn need(&self, key: &str) -> Result<&str, String> {
        self.get(key).ok_or_else(|| format!("its header has no field {key:?}; it is damaged"))
    }

    fn volume(&self, source: &Source<'_>, data: &[u8]) -> Result<Loaded<VolumeFile>, Fault> {
        let number = self.need("type")?;
        let number = Number::named(number).ok_or_else(|| {
            format!("samples of type {number:?} are not read; convert them to a number type with unu")
        })?;
        let dims = self.dims()?;
        let (axes, origin) = self.place()?;
        let mut warnings = Vec::new();
        let turn = match self.get("space") {
            Some(space) => to_lps(space, &mut warnings),
            None => DVec3::ONE,
        };
        let (axes, origin) = (DMat3::from_diagonal(turn) * axes, turn * origin);
        let data = self.skipped(data)?;
        let encoding = self.need("encoding")?.to_lowercase();
        let (values, changed) = match encoding.as_str() {
            "raw" => {
                let expected = source.expected(dims, number, data.len(), false)?;
                let from = if self.get("byteskip") == Some("-1") { data.len() - expected } else { 0 };
                number.decode(data[from..from + expected].to_vec(), self.order(number)?)
            }
            "gzip" | "gz" => {
                let expected = source.expected(dims, number, data.len(), true)?;
                number.decode(gunzip(data, expected)?, self.order(number)?)
            }
            "ascii" | "text" | "txt" => {
                let count = source.expected(dims, number, data.len(), true)? / number.bytes();
                if count > data.len() {
                    return Err(format!(
                        "it declares {count} values and has {} bytes of text; it is cut off",
                        data.len()
                    )
                    .into());
                }
                let text = std::str::from_utf8(data)
                    .map_err(|e| format!("byte {} of its text is no text; it is damaged", e.valid_up_to()))?;
                number.parse(text, count)?
            }
            other => {
                let other: String = other.chars().take(30).collect();
                return Err(format!(
                    "its encoding {other:?} is not read; raw, gzip and ascii are: convert it with unu save -e gzip"
                )
                .into());
            }
        };
        let file = VolumeFile { format: "NRRD", array: None, stored: number, dims, axes, origin, values };
        let said = warnings.into_iter().map(|w| w.in_file(source.path));
        Ok(Loaded::new(file, said.chain(odd_values(source.path, &changed)).collect()))
    }

    /// Indices of the axes of the volume: all but those of one value where there are more than three, first those without a direction, then
    /// the last.
    fn axes(&self, sizes: &[usize]) -> Vec<usize> {
        let directions = self.get("spacedirections").map(directions).unwrap_or_default();
        let mut kept: Vec<usize> = (0..sizes.len()).collect();
        while kept.len() > 3 {
            let alone = |k: &&usize| sizes[**k] == 1;
            let without = kept.iter().filter(alone).find(|k| matches!(directions.get(**k), Some(None)));
            let Some(gone) = without.or_else(|| kept.iter().rfind(alone)).copied() else { break };
            kept.retain(|k| *k != gone);
        }
        kept
    }

    fn dims(&self) -> Result<[usize; 3], String> {
        self.sizes().and_then(|sizes| {
            let list: Vec<usize> = self.axes(&sizes).into_iter().map(|k| sizes[k]).collect();
            <[usize; 3]>::try_from(list).map_err(|list| {
                format!(
                    "it has {} dimensions, a volume of single values has 3; take one with unu slice or unu crop",
                    list.len()
                )
            })
        })
    }

    /// Values along all axes.
    fn sizes(&self) -> Result<Vec<usize>, String> {
        let dimension = self.need("dimension")?;
        let sizes = self.need("sizes")?;
        let list: Result<Vec<usize>, _> = sizes.split_whitespace().map(str::parse).collect();
        let list = list.map_err(|_| format!("its sizes {sizes:?} are no whole numbers; it is damaged"))?;
        if dimension.parse() != Ok(list.len()) {
            return Err(format!("its dimension is {dimension} and it has {} sizes; it is damaged", list.len()));
        }
        Ok(list)
    }

    /// The samples after skipped lines and bytes.
    fn skipped<'d>(&self, data: &'d [u8]) -> Result<&'d [u8], String> {
        let number = |key: &str| match self.get(key) {
            None => Ok(0),
            Some(text) => text.parse::<i64>().map_err(|_| format!("its {key} {text:?} is no whole number")),
        };
        let (lines, bytes) = (number("lineskip")?, number("byteskip")?);
        let mut rest = data;
        for _ in 0..lines {
            let end = rest.iter().position(|b| *b == b'\n').ok_or("it has fewer lines than it says to skip")?;
            rest = &rest[end + 1..];
        }
        if bytes < 0 {
            return if bytes == -1 {
                Ok(rest)
            } else {
                Err(format!("its byte skip is {bytes}, it must be -1 or more"))
            };
        }
        let from = usize::try_from(bytes).ok().filter(|b| *b <= rest.len());
        from.map(|b| &rest[b..])
            .ok_or_else(|| format!("it says to skip {bytes} of {} bytes; it is damaged", rest.len()))
    }

    fn order(&self, number: Number) -> Result<ByteOrder, String> {
        match self.get("endian").map(str::to_lowercase).as_deref() {
            Some("little") => Ok(ByteOrder::Little),
            Some("big") => Ok(ByteOrder::Big),
            None if number.bytes() == 1 => Ok(ByteOrder::Little),
            other => Err(format!("its endian is {other:?}; samples of {number} need little or big")),
        }
    }

    /// Axes and origin in the space of the file.
    fn place(&self) -> Result<(DMat3, DVec3), String> {
        let bad = |key: &str, text: &str| {
            let shown: String = text.chars().take(60).collect();
            format!("its {key} {shown:?} cannot be read; it is damaged")
        };
        let kept = self.axes(&self.sizes()?);
        if let Some(text) = self.get("spacedirections") {
            let all = directions(text);
            let vectors: Vec<DVec3> = kept.iter().filter_map(|k| all.get(*k).copied().flatten()).collect();
            let [x, y, z] = <[DVec3; 3]>::try_from(vectors).map_err(|_| bad("space directions", text))?;
            let origin = match self.get("spaceorigin") {
                Some(text) => vector(text).ok_or_else(|| bad("space origin", text))?,
                None => DVec3::ZERO,
            };
            return Ok((DMat3::from_cols(x, y, z), origin));
        }
        let Some(text) = self.get("spacings") else { return Ok((DMat3::IDENTITY, DVec3::ZERO)) };
        let list: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let list = list.ok().and_then(|l| kept.iter().map(|k| l.get(*k).copied()).collect::<Option<Vec<f64>>>());
        let list = list.and_then(|l| <[f64; 3]>::try_from(l).ok()).ok_or_else(|| bad("spacings", text))?;
        // Unknown spacings are written as nan.
        let list = list.map(|s| if s.is_nan() { 1.0 } else { s });
        Ok((DMat3::from_diagonal(DVec3::from_array(list)), DVec3::ZERO))
    }
}

/// Signs that take coordinates of a space to left, posterior, superior, the directions of DICOM, so that a body has the same position in
/// every file and is never mirrored, for any directions that a file names. Other spaces stay as they are.
fn to_lps(space: &str, warnings: &mut Vec<Warning>) -> DVec3 {
    let name = space.trim().to_lowercase();
    let long: Vec<&str> = name.split('-').collect();
    let letters: Vec<char> = match long.as_slice() {
        [one] => one.chars().collect(),
        several => several.iter().filter_map(|word| word.chars().next()).collect(),
    };
    let sign = |at: usize, plus: char, minus: char| match letters.get(at) {
        Some(c) if *c == plus => Some(1.0),
        Some(c) if *c == minus => Some(-1.0),
        _ => None,
    };
    let anatomical = sign(0, 'l', 'r').zip(sign(1, 'p', 'a')).zip(sign(2, 's', 'i'));
    match (anatomical, name.as_str()) {
        (Some(((x, y), z)), _) => DVec3::new(x, y, z),
        (None, "3d-left-handed" | "3d-left-handed-time") => DVec3::new(1.0, -1.0, 1.0),
        (None, "scanner-xyz" | "scanner-xyz-time" | "3d-right-handed" | "3d-right-handed-time") => DVec3::ONE,
        _ => {
            let text = format!("its space {space:.40?} is not known; coordinates stay as they are");
            warnings.push(Warning::new(WarningKind::Assumed, text));
            DVec3::ONE
        }
    }
}

/// The direction of each axis, `(x,y,z)`, or none.
fn directions(text: &str) -> Vec<Option<DVec3>> {
    let (mut out, mut rest) = (Vec::new(), text.trim_start());
    while !rest.is_empty() {
        let end = match rest.starts_with('(') {
            true => rest.find(')').map_or(rest.len(), |at| at + 1),
            false => rest.find([' ', '\t', '(']).unwrap_or(rest.len()),
        };
        out.push(vector(&rest[..end]));
        rest = rest[end..].trim_start();
    }
    out
}

/// `(x,y,z)`.
fn vector(text: &str) -> Option<DVec3> {
    let inside = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    let numbers: Result<Vec<f64>, _> = inside.split(',').map(|n| n.trim().parse()).collect();
    numbers.ok().and_then(|n| <[f64; 3]>::try_from(n).ok()).map(DVec3::from_array)
}
