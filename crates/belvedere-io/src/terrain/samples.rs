//! Samples of a raster as heights in metres.

use super::{TerrainRequest, sentinels};
use crate::{IoError, Photometric, Raster, RasterInfo, Samples};
use belvedere_core::Warning;
use rayon::prelude::*;

/// Largest valid height, metres, above that of any planet.
pub(super) const MAX_HEIGHT_M: f32 = 1.0e5;

/// Heights of a file, as read.
pub(super) struct Heights {
    /// The raster that was read: the file's, or one of its overviews.
    pub(super) info: RasterInfo,
    /// Every how many samples of it along either side there is a height.
    pub(super) every: usize,
    pub(super) cols: usize,
    pub(super) rows: usize,
    /// Metres, NaN = void.
    pub(super) heights: Vec<f32>,
    /// Ratio of their spacing to that of the file.
    pub(super) factor: f64,
    /// Samples of the raster, those without data, those beyond [`MAX_HEIGHT_M`].
    pub(super) samples: usize,
    pub(super) voids: usize,
    pub(super) absurd: usize,
    /// What is said of customary values that are taken as voids.
    pub(super) customary: Option<Warning>,
}

impl Heights {
    /// The heights of a raster that was read whole.
    pub(super) fn whole(info: RasterInfo, mut heights: Vec<f32>, factor: f64, request: &TerrainRequest) -> Self {
        let absurd = void_absurd(&mut heights);
        let unit = info.vertical_unit_m as f32;
        let may_be = may_be_customary(&info, request);
        let customary = may_be.then(|| sentinels::void(&mut heights, unit)).flatten();
        let frame = may_be.then(|| sentinels::void_frame(&mut heights, info.width)).flatten();
        let customary = customary.or(frame);
        let voids = heights.iter().filter(|h| h.is_nan()).count();
        let (cols, rows, samples) = (info.width, info.height, heights.len());
        Self { info, every: 1, cols, rows, heights, factor, samples, voids, absurd, customary }
    }
}

/// As the request says it in place of the file.
pub(super) fn as_requested(mut info: RasterInfo, request: &TerrainRequest) -> RasterInfo {
    info.nodata = request.nodata.or(info.nodata);
    info.vertical_unit_m = request.vertical_unit_m.unwrap_or(info.vertical_unit_m);
    info
}

/// Whether values that a file does not declare may mean that there are no data.
pub(super) fn may_be_customary(info: &RasterInfo, request: &TerrainRequest) -> bool {
    request.nodata.is_none() && info.scaling.is_empty()
}

/// An error unless a raster holds heights: a picture does not, and terrain needs 2 x 2 samples.
pub(super) fn check_shape(info: &RasterInfo) -> Result<(), IoError> {
    let picture = match info.photometric {
        Photometric::Rgb(_) => Some("an RGB picture"),
        Photometric::Palette(_) => Some("a picture with a colour table"),
        _ => None,
    };
    if let Some(picture) = picture {
        return Err(IoError::format(&info.path, format!("it is {picture}, not heights; use it as a drape")));
    }
    if info.width < 2 || info.height < 2 {
        let reason = format!("it has {} x {} samples, terrain needs at least 2 x 2", info.width, info.height);
        return Err(IoError::format(&info.path, reason));
    }
    Ok(())
}

/// Heights of the first band in metres, NaN = void.
pub(super) fn heights(raster: &Raster) -> Vec<f32> {
    let info = &raster.info;
    let unit = info.vertical_unit_m as f32;
    let plain = info.bands == 1 && raster.mask.is_none() && info.scaling.is_empty() && info.alpha.band().is_none();
    let nodata = info.nodata;
    match &raster.samples {
        Samples::I16(v) if plain => {
            let nodata = nodata.filter(|n| n.fract() == 0.0 && (-32768.0..=32767.0).contains(n)).map(|n| n as i16);
            v.par_iter().map(|&h| if Some(h) == nodata { f32::NAN } else { f32::from(h) * unit }).collect()
        }
        Samples::F32(v) if plain => {
            let nodata = nodata.map(|n| n as f32);
            v.par_iter().map(|&h| height_of(h, nodata, unit)).collect()
        }
        _ => {
            let width = info.width;
            let height = |i: usize| raster.sample_f64(0, i % width, i / width).map_or(f32::NAN, |h| h as f32 * unit);
            (0..width * info.height).into_par_iter().with_min_len(4096).map(height).collect()
        }
    }
}

/// Metres of a stored height; NaN = void.
pub(super) fn height_of(stored: f32, nodata: Option<f32>, unit: f32) -> f32 {
    if Some(stored) == nodata || !stored.is_finite() { f32::NAN } else { stored * unit }
}

/// Makes samples beyond the largest height void; returns their number.
pub(super) fn void_absurd(heights: &mut [f32]) -> usize {
    heights
        .par_iter_mut()
        .with_min_len(1 << 16)
        .map(|h| {
            let absurd = h.abs() > MAX_HEIGHT_M;
            if absurd {
                *h = f32::NAN;
            }
            usize::from(absurd)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SampleType;

    #[test]
    fn heights_in_feet_become_metres() {
        let mut info = RasterInfo::new("x", 2, 1, SampleType::I16);
        (info.vertical_unit_m, info.nodata) = (0.3048, Some(-1.0));
        let raster = Raster { info: info.clone(), samples: Samples::I16(vec![1000, -1]), mask: None };
        let h = heights(&raster);
        assert!((h[0] - 304.8).abs() < 1e-3 && h[1].is_nan());
        info.sample_type = SampleType::F64;
        let raster = Raster { info, samples: Samples::F64(vec![1000.0, -1.0]), mask: None };
        assert_eq!(heights(&raster)[0], h[0]);
        assert!(heights(&raster)[1].is_nan());
    }
}
