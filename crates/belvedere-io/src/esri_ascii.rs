//! ESRI ASCII grids (`.asc`), with an optional `.prj` beside.
//!
//! Header: `ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize` (or `dx`, `dy`),
//! `NODATA_value` (-9999 if missing); then the rows, the northernmost first. Source: ESRI, ASCII raster format.

mod numbers;

pub(crate) use numbers::plain;

use crate::fs::{read_sidecar, sidecar};
use crate::text::text_of;
use crate::{
    Affine, InputFile, IoError, Limits, Loaded, Raster, RasterInfo, SampleType, Samples, SourceCrs, budget, fs,
};
use belvedere_core::{Warning, WarningKind};
use std::path::Path;

/// Value of "no data" unless the header says otherwise.
const DEFAULT_NODATA: f64 = -9999.0;
/// Most samples along one side.
const MAX_SIDE: f64 = 1e6;

#[derive(Debug, Default)]
struct Header {
    cols: Option<usize>,
    rows: Option<usize>,
    /// Coordinate of the lower left and whether it is the corner of the cell (else its centre).
    x: Option<(f64, bool)>,
    y: Option<(f64, bool)>,
    dx: Option<f64>,
    dy: Option<f64>,
    nodata: Option<f64>,
    /// What stands for no data where that is no number.
    nodata_word: Option<Vec<u8>>,
}

/// Reads a grid. The coordinate system is that of the `.prj` file of the same name, else unknown.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a header that lacks something, a value that is no number, too few values, or
/// more samples than the limit allows.
pub fn read(path: &Path, limits: &Limits) -> Result<Loaded<Raster>, IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    // The text, and of at least two bytes each the values.
    limits.check(length.saturating_mul(3)).map_err(|e| IoError::format(path, e))?;
    let (bytes, file) = InputFile::read(path)?;
    let (text, odd_numbers) = plain(&bytes);
    let mut words = text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).peekable();
    let header = header(&mut words).map_err(bad)?;
    let missing = |what: &str| bad(format!("the header lacks {what}; it is no ESRI ASCII grid or is damaged"));
    let cols = header.cols.ok_or_else(|| missing("ncols"))?;
    let rows = header.rows.ok_or_else(|| missing("nrows"))?;
    let (x, x_corner) = header.x.ok_or_else(|| missing("xllcorner"))?;
    let (y, y_corner) = header.y.ok_or_else(|| missing("yllcorner"))?;
    let dx = header.dx.ok_or_else(|| missing("cellsize"))?;
    let dy = header.dy.unwrap_or(dx);
    let expected = cols * rows;
    // every value takes two bytes at least, so the file itself bounds the memory
    if expected > bytes.len() {
        return Err(bad(too_few(cols, rows, bytes.len() / 2)));
    }
    let mut values = budget::room("the raster", expected).map_err(|e| IoError::format(path, e))?;
    for word in words.by_ref().take(expected) {
        let is_void = header.nodata_word.as_deref() == Some(word) || numbers::is_no_number(word);
        let parsed = if is_void { Some(f32::NAN) } else { numbers::parse(word) };
        values.push(parsed.ok_or_else(|| bad(not_a_number(word, values.len(), cols)))?);
    }
    if values.len() < expected {
        return Err(bad(too_few(cols, rows, values.len())));
    }
    let mut warnings = Vec::new();
    warnings.extend(odd_numbers.map(|said| Warning::new(WarningKind::Repaired, said).in_file(path)));
    let extra = words.count();
    let after = format!("values after the {expected} of the grid are ignored");
    warnings.extend(Warning::counted(WarningKind::Ignored, extra, &after).map(|w| w.in_file(path)));
    let mut info = RasterInfo::new(path, cols, rows, SampleType::F32);
    let left = if x_corner { x } else { x - dx / 2.0 };
    let bottom = if y_corner { y } else { y - dy / 2.0 };
    info.pixel_to_model = Some(Affine([dx, 0.0, left, 0.0, -dy, bottom + rows as f64 * dy]));
    info.nodata = Some(header.nodata.unwrap_or(DEFAULT_NODATA));
    info.crs = prj_beside(path)?;
    Ok(Loaded::new(Raster { info, samples: Samples::F32(values), mask: None }, warnings).with_file(file))
}

fn too_few(cols: usize, rows: usize, found: usize) -> String {
    let expected = cols * rows;
    format!(
        "it holds at most {found} of the {expected} values of {cols} x {rows}; it is probably truncated, get it again"
    )
}

fn not_a_number(word: &[u8], index: usize, cols: usize) -> String {
    let shown: String = String::from_utf8_lossy(word).chars().take(20).collect();
    let (col, row) = (index % cols, index / cols);
    format!(
        "{shown:?} at column {col}, row {row} is not a number; numbers with a decimal point or comma and blanks between them are needed"
    )
}

fn header<'a>(words: &mut std::iter::Peekable<impl Iterator<Item = &'a [u8]>>) -> Result<Header, String> {
    let mut out = Header::default();
    while let Some(word) = words.peek() {
        if !word[0].is_ascii_alphabetic() || word.eq_ignore_ascii_case(b"nan") {
            break;
        }
        let key = String::from_utf8_lossy(word).to_ascii_lowercase();
        words.next();
        let word = words.next();
        let value = word.and_then(|w| std::str::from_utf8(w).ok()).and_then(|w| w.parse::<f64>().ok());
        if value.is_none() && matches!(key.as_str(), "nodata_value" | "nodata") {
            out.nodata_word = word.map(<[u8]>::to_vec);
            continue;
        }
        let value = value
            .ok_or_else(|| format!("the header's {key:.20} has no number; it is damaged or no ESRI ASCII grid"))?;
        let finite =
            || Some(value).filter(|v| v.is_finite()).ok_or(format!("the header's {key} is {value}, not finite"));
        let size = || {
            Some(value)
                .filter(|v| *v > 0.0 && v.is_finite())
                .ok_or(format!("{key} is {value}, it must be greater than 0"))
        };
        let count = || {
            let valid = value.fract() == 0.0 && (2.0..=MAX_SIDE).contains(&value);
            valid.then_some(value as usize).ok_or(format!(
                "{key} is {}, it must be a whole number in 2..=1000000",
                belvedere_core::plain::number(value)
            ))
        };
        match key.as_str() {
            "ncols" => out.cols = Some(count()?),
            "nrows" => out.rows = Some(count()?),
            "xllcorner" => out.x = Some((finite()?, true)),
            "xllcenter" | "xllcentre" => out.x = Some((finite()?, false)),
            "yllcorner" => out.y = Some((finite()?, true)),
            "yllcenter" | "yllcentre" => out.y = Some((finite()?, false)),
            "cellsize" | "dx" => out.dx = Some(size()?),
            "dy" => out.dy = Some(size()?),
            "nodata_value" | "nodata" => out.nodata = Some(value),
            _ => {
                return Err(format!(
                    "the header has an unknown entry {key:.20}; it is no ESRI ASCII grid or is damaged"
                ));
            }
        }
    }
    Ok(out)
}

/// Coordinate system of the `.prj` file beside `path`, if there is one.
pub(crate) fn prj_beside(path: &Path) -> Result<SourceCrs, IoError> {
    let Some(prj) = sidecar(path, "prj").filter(|p| fs::metadata(p).is_ok_and(|m| m.len() < 1 << 20)) else {
        return Ok(SourceCrs::Unknown);
    };
    let text = text_of(&read_sidecar(path, &prj, 1 << 20)?, &mut Vec::new());
    let text = text.trim();
    Ok(if text.is_empty() { SourceCrs::Unknown } else { SourceCrs::Wkt(text.to_owned()) })
}
