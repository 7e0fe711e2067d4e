//! What is said of an elevation raster.

use super::source::{self, SourceGrid, node_map};
use super::{LoadedTerrain, TerrainRequest, in_scene};
use crate::crs::CoordinateSystem;
use crate::fs::File;
use crate::geotiff::is_tiff;
use crate::pyramid::{self, Pyramid};
use crate::raster::Affine;
use crate::{GeoTiff, IoError, Loaded};
use belvedere_scene::Progress;
use std::io::Read;
use std::path::Path;

/// An elevation raster: its samples as they are in the file, and the ground of a scene that they make.
#[derive(Debug, Clone)]
pub struct TerrainSurvey {
    /// Columns and rows of samples.
    pub size: [usize; 2],
    /// Name of the file's coordinate system for messages.
    pub system: String,
    /// Unit of the file's plane: "degrees", "m", "ft", "us-ft", or metres per unit.
    pub unit: String,
    /// Distances of samples along columns and rows, in units of the file's system.
    pub spacing: [f64; 2],
    /// Least x and y and greatest x and y of the samples, in the file's system.
    pub extent: [f64; 4],
    /// Lowest and highest height, metres; `None` if all samples are void.
    pub heights_m: Option<[f32; 2]>,
    /// The ground.
    pub ground: LoadedTerrain,
}

/// Surveys one raster. Of a GeoTIFF or a pyramid of tiles with more samples than `max_nodes` of the request, heights and voids are those of the thinned ground,
/// and a warning says so.
///
/// # Errors
/// As [`super::load_terrain`].
pub fn survey(path: &Path, request: &TerrainRequest, progress: &Progress) -> Result<Loaded<TerrainSurvey>, IoError> {
    let larger = larger(path, request)?;
    let most_nodes = if larger.is_some() { request.max_nodes } else { usize::MAX };
    let reading = TerrainRequest { max_nodes: most_nodes, ..request.clone() };
    let Loaded { value: mut sources, mut warnings, files } =
        source::read_all(&[path.to_owned()], &reading, progress).map_err(crate::recognise::explain)?;
    let source = sources.pop().ok_or_else(|| IoError::format(path, "holds no raster; give an elevation model"))?;
    let (size, map) = larger.unwrap_or(([source.cols, source.rows], source.model_from_index));
    let known = source.heights.iter().copied().filter(|h| h.is_finite());
    let heights_m =
        known.fold(None, |range: Option<[f32; 2]>, h| Some(range.map_or([h; 2], |[lo, hi]| [lo.min(h), hi.max(h)])));
    let (system, unit) = (system_name(&source), unit(source.system.as_ref()));
    let source = source::within(source, request.max_nodes, 1.0, &mut warnings);
    let Loaded { value: ground, warnings, files } =
        in_scene(Loaded { value: vec![source], warnings, files }, request, progress)?;
    let spacing = [map.0[0].hypot(map.0[3]), map.0[1].hypot(map.0[4])];
    let value = TerrainSurvey { size, system, unit, spacing, extent: extent(size, &map), heights_m, ground };
    Ok(Loaded { value, warnings, files })
}

/// Size and map from samples to the model of a GeoTIFF or a pyramid that has more samples than the request takes.
fn larger(path: &Path, request: &TerrainRequest) -> Result<Option<([usize; 2], Affine)>, IoError> {
    let path = &source::meant(path, &request.limits).map_err(crate::recognise::explain)?;
    if path.is_dir() || pyramid::is_pyramid(path) {
        let pyramid = Pyramid::open(path, request.limits)?.value;
        let info = pyramid.info(0);
        return Ok((pyramid.samples(0) > request.max_nodes).then(|| ([info.width, info.height], node_map(&info))));
    }
    let mut magic = [0u8; 4];
    let got = File::open(path).and_then(|mut file| file.read(&mut magic)).map_err(|e| IoError::os(path, e))?;
    if !is_tiff(&magic[..got]) {
        return Ok(None);
    }
    let tiff = GeoTiff::open(path, request.limits)?.value;
    let info = tiff.info();
    let larger = info.width.saturating_mul(info.height) > request.max_nodes;
    Ok(larger.then(|| ([info.width, info.height], node_map(info))))
}

fn system_name(source: &SourceGrid) -> String {
    source.system.as_ref().map_or("no coordinate system", CoordinateSystem::name).to_owned()
}

fn unit(system: Option<&CoordinateSystem>) -> String {
    match system.map(CoordinateSystem::metres_per_unit) {
        None => "not stated".into(),
        Some(None) => "degrees".into(),
        Some(Some(1.0)) => "m".into(),
        Some(Some(u)) if (u - 0.3048).abs() < 1e-9 => "ft".into(),
        Some(Some(u)) if (u - 1200.0 / 3937.0).abs() < 1e-9 => "us-ft".into(),
        Some(Some(u)) => format!("{u} m"),
    }
}

fn extent([cols, rows]: [usize; 2], map: &Affine) -> [f64; 4] {
    let (w, h) = (cols as f64 - 1.0, rows as f64 - 1.0);
    let corners = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)].map(|(c, r)| map.apply(c, r));
    corners.iter().fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |e, [x, y]| {
        [e[0].min(*x), e[1].min(*y), e[2].max(*x), e[3].max(*y)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geotiff::write_geotiff;
    use crate::{CrsKind, Raster, RasterInfo, SampleType, Samples, SourceCrs};
    use belvedere_core::WarningKind;

    #[test]
    fn a_larger_raster_has_its_own_size_and_extent_and_the_heights_of_its_thinned_ground() {
        let [cols, rows] = [301, 203];
        let height = |i: usize| 1000.0 + 300.0 * ((i % cols) as f32 / 40.0).sin() + (i / cols) as f32;
        let mut info = RasterInfo::new("survey.tif", cols, rows, SampleType::F32);
        info.pixel_to_model = Some(Affine([20.0, 0.0, 4e5, 0.0, -20.0, 5e6]));
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(32631), CrsKind::Projected);
        let path = std::env::temp_dir().join(format!("belvedere_survey_{}.tif", std::process::id()));
        let samples = Samples::F32((0..cols * rows).map(height).collect());
        write_geotiff(&path, &Raster { info, samples, mask: None }, true).expect("written");
        let by = |max_nodes: usize| {
            let request = TerrainRequest { max_nodes, ..TerrainRequest::default() };
            survey(&path, &request, &Progress::silent()).expect("surveyed")
        };
        let (whole, thinned) = (by(1 << 20), by(5000));
        std::fs::remove_file(&path).expect("removed");
        let told = |s: &Loaded<TerrainSurvey>| s.warnings.iter().any(|w| w.kind() == WarningKind::Reduced);
        assert!(!told(&whole) && told(&thinned), "{:?} {:?}", whole.warnings, thinned.warnings);
        let (a, b) = (whole.value, thinned.value);
        assert_eq!((a.size, a.spacing), ([cols, rows], [20.0, 20.0]));
        assert_eq!(a.extent, [400_010.0, 4_995_950.0, 406_010.0, 4_999_990.0], "of the centres of the samples");
        assert_eq!(
            (a.size, a.spacing, a.extent, &a.system, &a.unit),
            (b.size, b.spacing, b.extent, &b.system, &b.unit)
        );
        assert_eq!([a.ground.heightfield.cols(), a.ground.heightfield.rows()], [cols, rows]);
        assert!(b.ground.heightfield.heights().len() <= 5000);
        let ([low, high], [lowest, highest]) = (b.heights_m.expect("heights"), a.heights_m.expect("heights"));
        assert!(lowest <= low && low < lowest + 30.0 && highest - 30.0 < high && high <= highest, "{low} {high}");
    }
}
