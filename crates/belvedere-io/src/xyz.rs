//! Lines of x, y and a height on a grid (.xyz), as GDAL and survey offices write them.

use crate::esri_ascii::{plain, prj_beside};
use crate::formats::words;
use crate::{Affine, Fault, InputFile, IoError, Limits, Loaded, Raster, RasterInfo, SampleType, Samples, budget, fs};
use belvedere_core::{Warning, WarningKind};
use std::path::Path;

/// Share of a step by which a coordinate may be off.
const OFF: f64 = 0.05;
/// Cells for each point from which on points are not a grid.
const MOST_CELLS: usize = 16;
/// Bytes at the peak for each byte of text: points of three numbers, and sorted coordinates.
const PEAK: u64 = 10;

/// The lattice of coordinates along one axis.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    first: f64,
    step: f64,
    count: usize,
}

/// Reads a grid; cells without a line are void.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a line that has no three numbers, points that lie on no grid, or too many.
pub(crate) fn read(path: &Path, limits: &Limits) -> Result<Loaded<Raster>, IoError> {
    let bad = |e: Fault| IoError::format(path, e);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    limits.check(length.saturating_mul(PEAK)).map_err(|e| bad(e.into()))?;
    let (bytes, file) = InputFile::read(path)?;
    let mut warnings = Vec::new();
    let points = points(&bytes, &mut warnings).map_err(|e| bad(e.into()))?;
    let [x, y] = [0, 1].map(|axis| Lattice::of(points.iter().map(|p| p[axis]).collect()));
    let on_grid = x.zip(y).filter(|(x, y)| {
        let cells = x.count.saturating_mul(y.count);
        cells / MOST_CELLS <= points.len().max(64) && points.iter().all(|p| x.holds(p[0]) && y.holds(p[1]))
    });
    let (x, y) = on_grid.ok_or_else(|| {
        let count = points.len();
        bad(format!("its {count} points do not lie on a grid of 2 x 2 or more; grid them into a GeoTIFF, as with gdal_grid or pdal").into())
    })?;
    let cells = x.count * y.count;
    limits.check(4 * cells as u64).map_err(|e| bad(e.into()))?;
    let mut heights = budget::room("the raster", cells).map_err(|e| bad(e.into()))?;
    heights.resize(cells, f32::NAN);
    let mut twice = 0;
    for [px, py, height] in points {
        let cell = &mut heights[(y.count - 1 - y.index(py)) * x.count + x.index(px)];
        twice += usize::from(!cell.is_nan());
        *cell = height as f32;
    }
    warnings.extend(Warning::counted(WarningKind::Ignored, twice, "points stand twice; the last one counts"));
    let mut info = RasterInfo::new(path, x.count, y.count, SampleType::F32);
    let top = y.first + (y.count as f64 - 0.5) * y.step;
    info.pixel_to_model = Some(Affine([x.step, 0.0, x.first - 0.5 * x.step, 0.0, -y.step, top]));
    info.crs = prj_beside(path)?;
    let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
    Ok(Loaded::new(Raster { info, samples: Samples::F32(heights), mask: None }, warnings).with_file(file))
}

/// Three numbers of each line.
fn points(bytes: &[u8], warnings: &mut Vec<Warning>) -> Result<Vec<[f64; 3]>, String> {
    let (text, odd_numbers) = plain(bytes);
    warnings.extend(odd_numbers.map(|said| Warning::new(WarningKind::Repaired, said)));
    let mut out = Vec::new();
    let mut lines = text.split(|b| *b == b'\n').enumerate().peekable();
    while let Some((i, line)) = lines.next() {
        let line = String::from_utf8_lossy(line);
        let mut found = words(&line).map(str::parse::<f64>);
        let point = (found.next(), found.next(), found.next(), found.next());
        match point {
            (None, ..) => {}
            (Some(Ok(x)), Some(Ok(y)), Some(Ok(z)), None) if x.is_finite() && y.is_finite() => out.push([x, y, z]),
            _ if i == 0 && line.trim_start().starts_with(|c: char| c.is_ascii_alphabetic() || c == '#') => {}
            _ if lines.peek().is_none() && !out.is_empty() => {
                let text = format!("its last line, {}, is not whole; the {} points before are read", i + 1, out.len());
                warnings.push(Warning::new(WarningKind::Repaired, text));
            }
            _ => {
                let shown: String = line.trim().chars().take(40).collect();
                return Err(format!(
                    "line {} is {shown:?}, three numbers x y z are needed; it is damaged, or no grid",
                    i + 1
                ));
            }
        }
    }
    Ok(out)
}

impl Lattice {
    /// Of all coordinates along an axis; `None` if there are less than two.
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let (first, last) = (*values.first()?, *values.last()?);
        let least = 1e-9 * (last - first);
        let steps = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > least);
        let step = steps.fold(f64::INFINITY, f64::min);
        let count = ((last - first) / step).round();
        let is_usable = step.is_finite() && (1.0..1e9).contains(&count);
        is_usable.then(|| Self { first, step: (last - first) / count, count: count as usize + 1 })
    }

    fn index(self, value: f64) -> usize {
        (((value - self.first) / self.step).round().max(0.0) as usize).min(self.count - 1)
    }

    fn holds(self, value: f64) -> bool {
        (value - self.first - self.index(value) as f64 * self.step).abs() <= OFF * self.step
    }
}
