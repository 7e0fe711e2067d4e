//! Rasters as every loader returns them: samples, georeference and no-data value.

use crate::budget;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use std::path::PathBuf;

/// Affine map of the plane: `x' = a[0] x + a[1] y + a[2]`, `y' = a[3] x + a[4] y + a[5]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine(pub [f64; 6]);

impl Affine {
    /// Image of a point.
    pub fn apply(&self, x: f64, y: f64) -> [f64; 2] {
        let a = &self.0;
        [a[0] * x + a[1] * y + a[2], a[3] * x + a[4] * y + a[5]]
    }

    /// Determinant of the linear part.
    pub fn determinant(&self) -> f64 {
        self.0[0] * self.0[4] - self.0[1] * self.0[3]
    }

    /// The inverse map; `None` if it is singular or not finite.
    pub fn inverse(&self) -> Option<Self> {
        let [a, b, c, d, e, f] = self.0;
        let det = self.determinant();
        let inv = [e / det, -b / det, (b * f - c * e) / det, -d / det, a / det, (c * d - a * f) / det];
        inv.iter().all(|v| v.is_finite()).then_some(Self(inv))
    }

    /// `self` after scaling its argument by (`sx`, `sy`) and then moving it by (`dx`, `dy`).
    pub fn after_scale_and_shift(&self, sx: f64, sy: f64, dx: f64, dy: f64) -> Self {
        let [a, b, c, d, e, f] = self.0;
        Self([a * sx, b * sy, a * dx + b * dy + c, d * sx, e * sy, d * dx + e * dy + f])
    }

    /// Whether columns run along +x and rows along -y exactly.
    pub fn is_north_up(&self) -> bool {
        let a = &self.0;
        a[1] == 0.0 && a[3] == 0.0 && a[0] > 0.0 && a[4] < 0.0
    }
}

/// Coordinate reference system as a file states it.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum SourceCrs {
    /// By EPSG code, projected or geographic.
    Epsg(u32),
    /// By WKT (of any dialect) only.
    Wkt(String),
    /// By parameters or a name without an EPSG code; the text says what the file gives and what is missing.
    UserDefined(String),
    /// The name of a system of another body than the Earth.
    OtherBody(String),
    /// The file states none.
    #[default]
    Unknown,
}

impl std::fmt::Display for SourceCrs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Epsg(code) => write!(f, "EPSG:{code}"),
            Self::Wkt(text) => write!(f, "{}", text.chars().take(80).collect::<String>()),
            Self::UserDefined(text) => write!(f, "{text}"),
            Self::OtherBody(name) => write!(f, "{name}, of another body than the Earth"),
            Self::Unknown => write!(f, "unknown"),
        }
    }
}

/// Kind of the coordinates of a CRS.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CrsKind {
    /// Not stated.
    #[default]
    Unknown,
    /// Easting and northing, lengths.
    Projected,
    /// Longitude and latitude, angles.
    Geographic,
    /// Earth-centred x, y, z.
    Geocentric,
}

/// Type of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum SampleType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl SampleType {
    /// Bytes of one sample.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Name as in reports: `int16`, `float32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::I8 => "int8",
            Self::U8 => "uint8",
            Self::I16 => "int16",
            Self::U16 => "uint16",
            Self::I32 => "int32",
            Self::U32 => "uint32",
            Self::I64 => "int64",
            Self::U64 => "uint64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }
}

/// Samples of a raster, row-major, bands interleaved by pixel: index `(row * width + col) * bands + band`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub enum Samples {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    I64(Vec<i64>),
    U64(Vec<u64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Runs `$body` with `$v` bound to the vector of whichever variant `$samples` is.
macro_rules! with_samples {
    ($samples:expr, $v:ident => $body:expr) => {
        match $samples {
            $crate::raster::Samples::I8($v) => $body,
            $crate::raster::Samples::U8($v) => $body,
            $crate::raster::Samples::I16($v) => $body,
            $crate::raster::Samples::U16($v) => $body,
            $crate::raster::Samples::I32($v) => $body,
            $crate::raster::Samples::U32($v) => $body,
            $crate::raster::Samples::I64($v) => $body,
            $crate::raster::Samples::U64($v) => $body,
            $crate::raster::Samples::F32($v) => $body,
            $crate::raster::Samples::F64($v) => $body,
        }
    };
}
pub(crate) use with_samples;

impl Samples {
    /// Number of samples of all bands together.
    pub fn len(&self) -> usize {
        with_samples!(self, v => v.len())
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Type of the samples.
    pub fn sample_type(&self) -> SampleType {
        match self {
            Self::I8(_) => SampleType::I8,
            Self::U8(_) => SampleType::U8,
            Self::I16(_) => SampleType::I16,
            Self::U16(_) => SampleType::U16,
            Self::I32(_) => SampleType::I32,
            Self::U32(_) => SampleType::U32,
            Self::I64(_) => SampleType::I64,
            Self::U64(_) => SampleType::U64,
            Self::F32(_) => SampleType::F32,
            Self::F64(_) => SampleType::F64,
        }
    }

    /// Sample `index` as stored, possibly NaN; `None` past the end. 64-bit integers round to the nearest f64.
    #[allow(clippy::unnecessary_cast)]
    pub fn get_f64(&self, index: usize) -> Option<f64> {
        with_samples!(self, v => v.get(index).map(|&x| x as f64))
    }
}

/// Meaning of the bands of a raster as a picture.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Photometric {
    /// One band of brightness or of measured values; 0 is black.
    #[default]
    Gray,
    /// As [`Self::Gray`], but 0 is white.
    GrayInverted,
    /// The bands of these indices are red, green, blue (sRGB).
    Rgb([usize; 3]),
    /// Band 0 is an index into these colours.
    Palette(Vec<[u8; 3]>),
}

/// Meaning of the alpha band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Alpha {
    /// There is no alpha band.
    #[default]
    None,
    /// The band of this index; colours are independent of it.
    Straight(usize),
    /// The band of this index; colours are already multiplied by it.
    Premultiplied(usize),
}

impl Alpha {
    /// Index of the band.
    pub fn band(self) -> Option<usize> {
        match self {
            Self::None => None,
            Self::Straight(band) | Self::Premultiplied(band) => Some(band),
        }
    }
}

/// Everything about a raster but its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterInfo {
    /// The file.
    pub path: PathBuf,
    /// Columns.
    pub width: usize,
    /// Rows; row 0 first in the file, usually the northernmost.
    pub height: usize,
    /// Samples per pixel.
    pub bands: usize,
    /// Type of the samples.
    pub sample_type: SampleType,
    /// Meaning as a picture.
    pub photometric: Photometric,
    /// Alpha band.
    pub alpha: Alpha,
    /// Model coordinates of pixel CORNERS: (0, 0) is the outer corner of the first pixel, sample (c, r) stands at
    /// (c + 0.5, r + 0.5) whether the file says PixelIsArea or PixelIsPoint. `None` = not georeferenced.
    pub pixel_to_model: Option<Affine>,
    /// Whether the file declared its samples as points (grid nodes); [`Self::pixel_to_model`] already allows for it.
    pub pixel_is_point: bool,
    /// Coordinate system of the model coordinates.
    pub crs: SourceCrs,
    /// Kind of its coordinates.
    pub crs_kind: CrsKind,
    /// Metres per model unit of a projected CRS if the file states it (else that of the CRS).
    pub linear_unit_m: Option<f64>,
    /// EPSG code of the vertical CRS.
    pub vertical_epsg: Option<u32>,
    /// Metres per unit of the heights; 1 unless the file says otherwise.
    pub vertical_unit_m: f64,
    /// Whether the file or its format states the unit of heights.
    pub vertical_unit_said: bool,
    /// Stored value that means "no data", as stored (before [`Self::scaling`]).
    pub nodata: Option<f64>,
    /// Per band `[scale, offset]`: value = stored * scale + offset. Empty = values as stored.
    pub scaling: Vec<[f64; 2]>,
    /// Width and height of the reduced copies in the file, largest first.
    pub overviews: Vec<[usize; 2]>,
}

impl RasterInfo {
    /// A single-band raster without georeference.
    pub fn new(path: impl Into<PathBuf>, width: usize, height: usize, sample_type: SampleType) -> Self {
        Self {
            path: path.into(),
            width,
            height,
            bands: 1,
            sample_type,
            photometric: Photometric::Gray,
            alpha: Alpha::None,
            pixel_to_model: None,
            pixel_is_point: false,
            crs: SourceCrs::Unknown,
            crs_kind: CrsKind::Unknown,
            linear_unit_m: None,
            vertical_epsg: None,
            vertical_unit_m: 1.0,
            vertical_unit_said: false,
            nodata: None,
            scaling: Vec::new(),
            overviews: Vec::new(),
        }
    }

    /// The same for a part of its columns and rows.
    pub(crate) fn window(mut self, cols: &Range<usize>, rows: &Range<usize>) -> Self {
        let (left, top) = (cols.start as f64, rows.start as f64);
        self.pixel_to_model = self.pixel_to_model.map(|t| t.after_scale_and_shift(1.0, 1.0, left, top));
        (self.width, self.height) = (cols.len(), rows.len());
        self
    }

    /// Model coordinates of the four outer corners: top left, top right, bottom right, bottom left.
    pub fn corners(&self) -> Option<[[f64; 2]; 4]> {
        let (w, h) = (self.width as f64, self.height as f64);
        let m = self.pixel_to_model?;
        Some([m.apply(0.0, 0.0), m.apply(w, 0.0), m.apply(w, h), m.apply(0.0, h)])
    }
}

/// A raster in memory: a whole level of a file or a window of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Everything but the samples; width, height and transform are those of this level or window.
    pub info: RasterInfo,
    /// `width * height * bands` samples.
    pub samples: Samples,
    /// One flag per pixel from a mask inside the file, `true` = valid; `None` = no mask.
    pub mask: Option<Vec<bool>>,
}

impl Raster {
    /// Value of `band` at pixel (`col`, `row`): scaled, finite; `None` outside the raster, where the stored value is
    /// the no-data value, NaN or infinite, where the mask says so, and (for other bands) where alpha is 0.
    pub fn sample_f64(&self, band: usize, col: usize, row: usize) -> Option<f64> {
        let info = &self.info;
        if band >= info.bands || col >= info.width || row >= info.height {
            return None;
        }
        let pixel = row * info.width + col;
        if let Some(mask) = &self.mask
            && !mask.get(pixel).copied().unwrap_or(false)
        {
            return None;
        }
        if let Some(alpha) = info.alpha.band()
            && alpha != band
            && self.samples.get_f64(pixel * info.bands + alpha) == Some(0.0)
        {
            return None;
        }
        let stored = self.samples.get_f64(pixel * info.bands + band)?;
        if !stored.is_finite() || self.is_nodata(stored) {
            return None;
        }
        let [scale, offset] = info.scaling.get(band).copied().unwrap_or([1.0, 0.0]);
        Some(stored * scale + offset).filter(|v| v.is_finite())
    }

    /// Whether a stored value is the no-data value, compared in the precision of the samples.
    pub fn is_nodata(&self, stored: f64) -> bool {
        self.info.nodata.is_some_and(|nodata| match self.info.sample_type {
            SampleType::F32 => stored as f32 == nodata as f32,
            _ => stored == nodata,
        })
    }

    /// The raster as sRGB pixels with straight alpha; alpha is 0 where there is no data.
    ///
    /// # Errors
    /// One sentence if it is not a picture of 8 or 16 bits per sample.
    pub fn to_rgba(&self) -> Result<Vec<[u8; 4]>, String> {
        let info = &self.info;
        if let Photometric::Rgb(bands) = info.photometric
            && let Some(band) = bands.into_iter().find(|&b| b >= info.bands)
        {
            return Err(format!("colour is said to be in band {}, there are {}", band + 1, info.bands));
        }
        const PART: usize = 1 << 14;
        let bytes = self.picture_bytes()?;
        let bands = info.bands.max(1);
        let mut out = vec![[0; 4]; bytes.len() / bands];
        let parts = out.par_chunks_mut(PART).zip(bytes.par_chunks(PART * bands)).enumerate();
        parts.for_each(|(k, (out, bytes))| self.rgba_part(k * PART, bytes, out));
        Ok(out)
    }

    /// Pixels from `first` on.
    fn rgba_part(&self, first: usize, bytes: &[u8], out: &mut [[u8; 4]]) {
        let bands = self.info.bands.max(1);
        let all_there = self.info.nodata.is_none() && self.mask.is_none();
        if let (Photometric::Palette(colors), true, 1) = (&self.info.photometric, all_there, bands) {
            let table: [[u8; 4]; 256] =
                std::array::from_fn(|i| colors.get(i).map_or([0; 4], |&[r, g, b]| [r, g, b, 255]));
            out.iter_mut().zip(bytes).for_each(|(out, &index)| *out = table[usize::from(index)]);
            return;
        }
        for (i, (out, pixel)) in out.iter_mut().zip(bytes.chunks_exact(bands)).enumerate() {
            *out = if !all_there && self.is_absent(first + i) { [0; 4] } else { self.rgba(pixel) };
        }
    }

    /// Samples scaled to 8 bits, but for palette indices.
    fn picture_bytes(&self) -> Result<Cow<'_, [u8]>, String> {
        let info = &self.info;
        match &self.samples {
            Samples::U8(v) => Ok(Cow::Borrowed(v)),
            Samples::U16(v) if !matches!(info.photometric, Photometric::Palette(_)) => {
                let bands = info.bands.max(1);
                let alpha = info.alpha.band().unwrap_or(usize::MAX);
                // Some writers put 0..=255 into an alpha band of 16 bits.
                let short_alpha = v.iter().skip(alpha).step_by(bands).all(|&a| a <= 255);
                let byte = |(i, &v): (usize, &u16)| match i % bands == alpha && short_alpha {
                    true => v as u8,
                    false => ((u32::from(v) * 255 + 32767) / 65535) as u8,
                };
                Ok(Cow::Owned(v.iter().enumerate().map(byte).collect()))
            }
            other => Err(format!(
                "samples are {}, a picture needs uint8 or uint16 without palette, or uint8 with one; convert it or use it as terrain",
                other.sample_type().name()
            )),
        }
    }

    fn is_absent(&self, pixel: usize) -> bool {
        let info = &self.info;
        let nodata = |band: usize| {
            info.nodata.is_some()
                && self.samples.get_f64(pixel * info.bands + band).is_some_and(|stored| self.is_nodata(stored))
        };
        let absent = match info.photometric {
            Photometric::Rgb(bands) => bands.into_iter().all(nodata),
            _ => nodata(0),
        };
        absent || self.mask.as_ref().is_some_and(|m| !m.get(pixel).copied().unwrap_or(false))
    }

    fn rgba(&self, pixel: &[u8]) -> [u8; 4] {
        let info = &self.info;
        let at = |band: usize| pixel.get(band).copied().unwrap_or(0);
        let mut rgb = match &info.photometric {
            Photometric::Gray => [at(0); 3],
            Photometric::GrayInverted => [255 - at(0); 3],
            Photometric::Rgb(bands) => bands.map(at),
            Photometric::Palette(colors) => match colors.get(usize::from(at(0))) {
                Some(color) => *color,
                None => return [0; 4],
            },
        };
        let alpha = info.alpha.band().map_or(255, at);
        if let Alpha::Premultiplied(_) = info.alpha
            && alpha > 0
        {
            rgb = rgb.map(|c| ((u32::from(c) * 255 + u32::from(alpha) / 2) / u32::from(alpha)).min(255) as u8);
        }
        [rgb[0], rgb[1], rgb[2], alpha]
    }
}

/// Bounds on the memory of a loader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes at the peak of the work; what the process holds counts where it is counted, see [`budget::count_by`].
    pub max_bytes: u64,
}

impl Default for Limits {
    /// [`budget::bytes`].
    fn default() -> Self {
        Self { max_bytes: budget::bytes() }
    }
}

impl Limits {
    /// A refusal if a raster whose reading takes `bytes` is more than allowed.
    pub fn check(&self, bytes: u64) -> Result<(), budget::Refusal> {
        self.ask("the raster", bytes)
    }

    /// A refusal if work on `what` that takes `bytes` is more than allowed.
    pub fn ask(&self, what: &str, bytes: u64) -> Result<(), budget::Refusal> {
        budget::ask_of(self.max_bytes, what, bytes)
    }
}

#[cfg(test)]
mod tests;
