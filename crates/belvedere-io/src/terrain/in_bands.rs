//! Reading an elevation raster with more samples than are wanted, in bands of rows that are thinned as they come.

use super::TerrainRequest;
use super::samples::{Heights, as_requested, check_shape, heights, may_be_customary, void_absurd};
use super::sentinels::{self, MILD, Outermost};
use super::thin::{Rows, thinned_size, thinning};
use crate::{GeoTiff, IoError, Raster, RasterInfo};
use belvedere_scene::Progress;
use std::ops::Range;

/// Samples of a band, unless a strip or a row of tiles has more.
const BAND: usize = 4 << 20;

/// A raster that gives some of its rows at a time.
pub(super) trait Banded {
    /// Everything but the samples.
    fn info(&self) -> RasterInfo;
    /// Ratio of its spacing to that of the source, of which the raster may be a reduced copy.
    fn factor(&self) -> f64;
    /// Rows that are stored together.
    fn rows_together(&self) -> usize;
    /// Rows of all columns.
    fn rows(&self, rows: Range<usize>, progress: &Progress) -> Result<Raster, IoError>;
}

/// A part of a level of a file.
pub(super) struct Level<'a> {
    pub(super) tiff: &'a GeoTiff,
    pub(super) level: usize,
    /// Columns and rows of the part.
    pub(super) part: [Range<usize>; 2],
}

impl<'a> Level<'a> {
    /// All that is stored of a level.
    pub(super) fn stored(tiff: &'a GeoTiff, level: usize) -> Self {
        Self { tiff, level, part: tiff.stored(level) }
    }

    /// Number of samples.
    pub(super) fn samples(&self) -> usize {
        let [cols, rows] = &self.part;
        cols.len().saturating_mul(rows.len())
    }

    fn whole(&self) -> RasterInfo {
        self.tiff.level_info(self.level).unwrap_or_else(|| self.tiff.info().clone())
    }

    /// Reads it whole.
    pub(super) fn read(&self, progress: &Progress) -> Result<Raster, IoError> {
        let [cols, rows] = self.part.clone();
        self.tiff.read_window(self.level, cols, rows, progress)
    }

    /// Ratio of its spacing to that of the file.
    pub(super) fn factor(&self) -> f64 {
        self.tiff.info().width as f64 / self.whole().width as f64
    }
}

impl Banded for Level<'_> {
    fn info(&self) -> RasterInfo {
        let [cols, rows] = &self.part;
        self.whole().window(cols, rows)
    }

    fn factor(&self) -> f64 {
        Level::factor(self)
    }

    fn rows_together(&self) -> usize {
        self.tiff.rows_together(self.level)
    }

    fn rows(&self, rows: Range<usize>, progress: &Progress) -> Result<Raster, IoError> {
        let [cols, all] = self.part.clone();
        self.tiff.read_window(self.level, cols, all.start + rows.start..all.start + rows.end, progress)
    }
}

/// The heights of a raster, thinned to at most `most_nodes`; at any time a band of it is in memory. What is thinned is the same
/// as of the raster read whole.
pub(super) fn read(
    source: &dyn Banded,
    request: &TerrainRequest,
    most_nodes: usize,
    progress: &Progress,
) -> Result<Heights, IoError> {
    read_by(BAND, source, request, most_nodes, progress)
}

fn read_by(
    samples: usize,
    source: &dyn Banded,
    request: &TerrainRequest,
    most_nodes: usize,
    progress: &Progress,
) -> Result<Heights, IoError> {
    let info = as_requested(source.info(), request);
    check_shape(&info)?;
    let every = thinning(info.width, info.height, most_nodes).unwrap_or(1);
    let bands = Bands { source, info: &info, every, samples, request, progress };
    let (mut values, mut stored) = (Vec::new(), Vec::new());
    let pass = loop {
        let pass = bands.pass(&values)?;
        let unit = info.vertical_unit_m as f32;
        let count_of = |value: f32| MILD.iter().position(|m| m * unit == value).map_or(0, |k| pass.mild[k]);
        // One value at a time, as for a raster read whole; files that need a second pass are few.
        let customary = may_be_customary(&info, request)
            .then(|| sentinels::apart(&pass.ends, info.width * info.height, count_of, unit))
            .flatten();
        let Some((value, as_stored)) = customary else { break pass };
        values.push(value);
        stored.push(as_stored);
    };
    let (cols, rows) = thinned_size([info.width, info.height], every);
    let factor = source.factor() * every as f64;
    Ok(Heights {
        every,
        cols,
        rows,
        heights: pass.thinned,
        factor,
        samples: info.width * info.height,
        voids: pass.voids,
        absurd: pass.absurd,
        customary: sentinels::said_of(&stored, pass.customary),
        info,
    })
}

struct Bands<'a> {
    source: &'a dyn Banded,
    info: &'a RasterInfo,
    every: usize,
    /// Samples of a band.
    samples: usize,
    request: &'a TerrainRequest,
    progress: &'a Progress,
}

/// What one reading of all bands gives.
struct Pass {
    thinned: Vec<f32>,
    ends: Outermost,
    /// Samples of each of [`MILD`].
    mild: [usize; MILD.len()],
    voids: usize,
    absurd: usize,
    /// Samples of the values that were made void.
    customary: usize,
}

impl Bands<'_> {
    /// * `voids`: values, metres, that mean no data.
    fn pass(&self, voids: &[f32]) -> Result<Pass, IoError> {
        let (cols, rows, k) = (self.info.width, self.info.height, self.every);
        let (out_cols, out_rows) = thinned_size([cols, rows], k);
        let together = self.source.rows_together();
        let band = (self.samples / cols).max(1).next_multiple_of(together).min(rows.next_multiple_of(together));
        let stored = self.info.bands as u64 * self.info.sample_type.size() as u64;
        let peak = (cols * (band + 2 * k)) as u64 * (stored + 8) + (out_cols * out_rows * 4) as u64;
        let too_much = |reason| IoError::format(&self.info.path, reason);
        self.request.limits.check(peak).map_err(too_much)?;
        let mut out = Pass {
            thinned: Vec::with_capacity(out_cols * out_rows),
            ends: Outermost::NONE,
            mild: [0; MILD.len()],
            voids: 0,
            absurd: 0,
            customary: 0,
        };
        // Rows from `first` on, at least those that rows of the thinned grid from `next` on need.
        let (mut kept, mut first, mut next) = (Vec::new(), 0, 0);
        for top in (0..rows).step_by(band) {
            self.progress.tick("reading terrain", top as f64 / rows as f64)?;
            let end = (top + band).min(rows);
            kept.extend(self.band(top..end, voids, &mut out)?);
            let ready = if end == rows { out_rows } else { end / k };
            out.thinned.extend(Rows { heights: &kept, cols, rows, first }.thinned(k, next..ready));
            next = ready;
            let needed = (next * k).saturating_sub(k - 1).clamp(first, end);
            kept.drain(..(needed - first) * cols);
            first = needed;
        }
        Ok(out)
    }

    /// Heights of rows, and what they add to the pass.
    fn band(&self, rows: Range<usize>, voids: &[f32], out: &mut Pass) -> Result<Vec<f32>, IoError> {
        let mut raster = self.source.rows(rows, self.progress)?;
        raster.info = as_requested(raster.info, self.request);
        let mut heights = heights(&raster);
        out.absurd += void_absurd(&mut heights);
        out.customary += voids.iter().map(|value| sentinels::void_value(&mut heights, *value)).sum::<usize>();
        let unit = self.info.vertical_unit_m as f32;
        for (count, value) in out.mild.iter_mut().zip(MILD) {
            *count += sentinels::count_of(&heights, value * unit);
        }
        out.ends = out.ends.and(Outermost::of(&heights));
        out.voids += heights.iter().filter(|h| h.is_nan()).count();
        Ok(heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geotiff::write_geotiff;
    use crate::terrain::thin::thin;
    use crate::{Affine, Limits, Raster, SampleType, Samples};

    #[test]
    fn bands_of_any_height_give_what_the_raster_read_whole_gives() {
        let [cols, rows] = [203, 331];
        let mut samples: Vec<f32> = (0..cols * rows).map(|i| ((i * 7919) % 2003) as f32 * 0.75 + 300.0).collect();
        // A declared void, an absurd height, and two customary values that the file does not declare.
        (samples[4321], samples[777]) = (-5.0, 4e8);
        samples.iter_mut().skip(1000).step_by(97).take(500).for_each(|h| *h = -9999.0);
        samples.iter_mut().skip(50_000).step_by(89).take(100).for_each(|h| *h = -32768.0);
        let mut info = RasterInfo::new("bands.tif", cols, rows, SampleType::F32);
        info.nodata = Some(-5.0);
        info.pixel_to_model = Some(Affine([2.0, 0.0, 4e5, 0.0, -2.0, 5e6]));
        let path = std::env::temp_dir().join(format!("belvedere_bands_{}.tif", std::process::id()));
        write_geotiff(&path, &Raster { info, samples: Samples::F32(samples), mask: None }, true).expect("written");
        let tiff = GeoTiff::open(&path, Limits::default()).expect("opened").value;
        std::fs::remove_file(&path).expect("removed");
        let (request, progress) = (TerrainRequest::default(), Progress::silent());
        let mut whole = heights(&tiff.read(0, &progress).expect("read"));
        let absurd = void_absurd(&mut whole);
        let said = sentinels::void(&mut whole, 1.0).expect("customary values");
        let voids = whole.iter().filter(|h| h.is_nan()).count();
        assert!(absurd == 1 && voids > 500, "{absurd} {voids}");
        let bits = |heights: &[f32]| heights.iter().map(|h| h.to_bits()).collect::<Vec<_>>();
        for most_nodes in [20_000, 3000, 50] {
            let k = thinning(cols, rows, most_nodes).expect("too many");
            let (want, out_cols, out_rows) = thin(&whole, cols, rows, k);
            for samples in [1, 5 * cols, 64 * cols, 1 << 20] {
                let read = read_by(samples, &Level::stored(&tiff, 0), &request, most_nodes, &progress).expect("read");
                assert_eq!([read.cols, read.rows, read.every], [out_cols, out_rows, k]);
                assert_eq!(bits(&read.heights), bits(&want), "every {k}, {samples} samples together");
                assert_eq!([read.voids, read.absurd], [voids, absurd]);
                assert_eq!(read.customary.expect("said").text(), said.text());
            }
        }
    }
}
