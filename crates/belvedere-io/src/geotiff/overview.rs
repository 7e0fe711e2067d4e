//! Overviews of a raster: each has half of the columns and rows of the one before.

use crate::raster::{Raster, SampleType, Samples};
use rayon::prelude::*;

/// The raster with half of its columns and rows, rounded up, in the same place: each pixel is the mean of what it covers, weighted by
/// area, of the samples that are known. Where none is, it has the no-data value.
pub(super) fn halved(raster: &Raster) -> Raster {
    let [width, height] = [raster.info.width, raster.info.height].map(|n| n.div_ceil(2));
    let mut info = raster.info.clone();
    let scale = [info.width as f64 / width as f64, info.height as f64 / height as f64];
    info.pixel_to_model = info.pixel_to_model.map(|t| t.after_scale_and_shift(scale[0], scale[1], 0.0, 0.0));
    (info.width, info.height) = (width, height);
    let unknown = info.nodata.unwrap_or(f64::NAN);
    let (columns, rows) = (shares(raster.info.width, width), shares(raster.info.height, height));
    let bands = info.bands;
    let row_of = |row: usize| {
        let mut out = Vec::with_capacity(width * bands);
        for column in &columns {
            for band in 0..bands {
                out.push(mean(raster, band, column, &rows[row]).unwrap_or(unknown));
            }
        }
        out
    };
    let values: Vec<f64> = (0..height).into_par_iter().flat_map_iter(row_of).collect();
    let samples = of_type(info.sample_type, &values);
    Raster { info, samples, mask: None }
}

/// Indices and weights of up to three pixels that a coarser one covers, of `from` pixels that become `to`.
fn shares(from: usize, to: usize) -> Vec<Vec<(usize, f64)>> {
    let step = from as f64 / to as f64;
    let covered = |i: usize| {
        let (low, high) = (i as f64 * step, (i + 1) as f64 * step);
        let last = (high.ceil() as usize).min(from);
        let part = |k: usize| (k, (high.min((k + 1) as f64) - low.max(k as f64)).max(0.0));
        (low as usize..last).map(part).filter(|(_, w)| *w > 1e-9).collect()
    };
    (0..to).map(covered).collect()
}

fn mean(raster: &Raster, band: usize, columns: &[(usize, f64)], rows: &[(usize, f64)]) -> Option<f64> {
    let (mut sum, mut weight, mut known) = (0.0, 0.0, None);
    for (row, of_row) in rows {
        for (column, of_column) in columns {
            if let Some(value) = raster.sample_f64(band, *column, *row) {
                known = Some(value);
                sum += of_row * of_column * value;
                weight += of_row * of_column;
            }
        }
    }
    let whole = !matches!(raster.info.sample_type, SampleType::F32 | SampleType::F64);
    let mean = if whole { (sum / weight).round() } else { sum / weight };
    // A mean may happen to be the no-data value.
    if weight > 0.0 && raster.is_nodata(mean) { known } else { (weight > 0.0).then_some(mean) }
}

/// Samples of a type.
fn of_type(kind: SampleType, values: &[f64]) -> Samples {
    macro_rules! whole {
        ($t:ty) => {
            values.iter().map(|v| *v as $t).collect()
        };
    }
    match kind {
        SampleType::I8 => Samples::I8(whole!(i8)),
        SampleType::U8 => Samples::U8(whole!(u8)),
        SampleType::I16 => Samples::I16(whole!(i16)),
        SampleType::U16 => Samples::U16(whole!(u16)),
        SampleType::I32 => Samples::I32(whole!(i32)),
        SampleType::U32 => Samples::U32(whole!(u32)),
        SampleType::I64 => Samples::I64(whole!(i64)),
        SampleType::U64 => Samples::U64(whole!(u64)),
        SampleType::F32 => Samples::F32(values.iter().map(|v| *v as f32).collect()),
        SampleType::F64 => Samples::F64(values.to_vec()),
    }
}
