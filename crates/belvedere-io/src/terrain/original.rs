//! The heights of one file on its own grid, to be changed and written back.

use super::source::{self, SourceGrid};
use super::{LoadedTerrain, TerrainRequest};
use crate::crs::{CoordinateSystem, Transform};
use crate::raster::{Affine, CrsKind, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use crate::{IoError, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Crs, Heightfield, NodeState, Progress};
use glam::DVec2;
use rayon::prelude::*;
use std::path::Path;

/// Value written where there is no data.
const NODATA: f32 = -9999.0;

/// A file's own samples: grid, coordinate system and heights as they are, never resampled, thinned or filled.
#[derive(Debug, Clone)]
pub struct OriginalTerrain {
    source: SourceGrid,
}

/// Reads the samples of one raster (GeoTIFF, `.hgt`, zipped `.hgt`, ESRI ASCII); of `request` the limits, the CRS of the source
/// and the no-data value are used.
///
/// # Errors
/// As [`super::load_terrain`].
pub fn load_original(
    path: &Path,
    request: &TerrainRequest,
    progress: &Progress,
) -> Result<Loaded<OriginalTerrain>, IoError> {
    let whole = TerrainRequest { max_nodes: usize::MAX, ..request.clone() };
    let Loaded { value: mut sources, warnings, files } =
        source::read_all(&[path.to_owned()], &whole, progress).map_err(crate::recognise::explain)?;
    let source = sources.pop().ok_or_else(|| IoError::format(path, "holds no raster; give an elevation model"))?;
    Ok(Loaded { value: OriginalTerrain { source }, warnings, files })
}

impl OriginalTerrain {
    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.source.cols, self.source.rows]
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// Heights in metres, row-major; `None` where there is no data.
    pub fn heights(&self) -> impl Iterator<Item = Option<f32>> + '_ {
        self.source.heights.iter().map(|h| h.is_finite().then_some(*h))
    }

    /// The terrain of a scene, as [`super::load_terrain`] makes it of the same file.
    ///
    /// # Errors
    /// As [`super::load_terrain`].
    pub fn in_scene(&self, request: &TerrainRequest, progress: &Progress) -> Result<Loaded<LoadedTerrain>, IoError> {
        let mut warnings = Vec::new();
        let source = source::copied_within(&self.source, request.max_nodes, &mut warnings);
        super::in_scene(Loaded::new(vec![source], warnings), request, progress)
    }

    /// The heights moved by `delta` (metres, at scene x, y), and the moves themselves, as rasters on the file's own grid: 32-bit
    /// floats in metres, no-data where the file has none or a sample lies outside the domain of the scene's system.
    ///
    /// # Errors
    /// [`IoError`] if the file's coordinate system cannot be joined with that of the scene.
    pub fn moved(&self, scene: Crs, delta: impl Fn(DVec2) -> f64 + Sync) -> Result<[Raster; 2], IoError> {
        self.moved_and_filled(scene, |p, _| delta(p), |_| None)
    }

    /// As [`Self::moved`], where the move may also depend on the height before it, and where the file has no data the height before the move is `fill` (metres, at scene x, y), if that has one.
    ///
    /// # Errors
    /// As [`Self::moved`].
    pub fn moved_and_filled(
        &self,
        scene: Crs,
        delta: impl Fn(DVec2, f64) -> f64 + Sync,
        fill: impl Fn(DVec2) -> Option<f64> + Sync,
    ) -> Result<[Raster; 2], IoError> {
        let source = &self.source;
        let failed = |e: crate::crs::CrsError| IoError::format(&source.path, e.to_string());
        let transform = match (&source.system, scene) {
            (Some(system), Crs::Epsg(_)) => {
                let to = CoordinateSystem::from_scene(scene).map_err(failed)?;
                Some(Transform::new(system, &to).map_err(failed)?)
            }
            _ => None,
        };
        let pairs: Vec<[f32; 2]> = (0..source.heights.len())
            .into_par_iter()
            .with_min_len(4096)
            .map(|i| {
                let at = source.model_from_index.apply((i % source.cols) as f64, (i / source.cols) as f64);
                let scene_xy = match &transform {
                    Some(t) => t.forward_one(DVec2::from(at)),
                    None => Some(DVec2::from(at)),
                };
                let own = f64::from(source.heights[i]);
                let height = |p: DVec2| if own.is_finite() { Some(own) } else { fill(p) };
                let moved =
                    scene_xy.and_then(|p| height(p).map(|h| (h, delta(p, h)))).filter(|(h, d)| (h + d).is_finite());
                moved.map_or([NODATA; 2], |(h, d)| [(h + d) as f32, d as f32])
            })
            .collect();
        Ok([0, 1].map(|k| self.raster(pairs.iter().map(|p| p[k]).collect())))
    }

    /// This file with the heights of a raster of [`Self::moved`].
    pub fn with_heights(&self, heights: &Raster) -> Self {
        let mut out = self.clone();
        if let Samples::F32(values) = &heights.samples {
            out.source.heights = values.iter().map(|h| if *h == NODATA { f32::NAN } else { *h }).collect();
        }
        out
    }

    /// Whether the nodes of `terrain` are the file's own samples.
    pub fn is_grid_of(&self, terrain: &Heightfield) -> bool {
        let first = DVec2::from(self.source.model_from_index.apply(0.0, 0.0));
        let geographic = self.source.system.as_ref().is_some_and(CoordinateSystem::is_geographic);
        !geographic && self.size() == [terrain.cols(), terrain.rows()] && first == terrain.north_west()
    }

    fn raster(&self, values: Vec<f32>) -> Raster {
        let source = &self.source;
        let mut info = RasterInfo::new(&source.path, source.cols, source.rows, SampleType::F32);
        info.pixel_to_model = Some(source.model_from_index.after_scale_and_shift(1.0, 1.0, -0.5, -0.5));
        info.nodata = Some(f64::from(NODATA));
        if let Some(system) = &source.system
            && let Some(code) = system.epsg()
        {
            info.crs = SourceCrs::Epsg(code);
            info.crs_kind = if system.is_geographic() { CrsKind::Geographic } else { CrsKind::Projected };
        }
        Raster { info, samples: Samples::F32(values), mask: None }
    }

    /// Scene x, y of a position in the file's own system (degrees if that is geographic); `None` outside the domain of either system.
    pub fn scene_from_model(&self, scene: Crs, model: DVec2) -> Option<DVec2> {
        match (&self.source.system, scene) {
            (Some(system), Crs::Epsg(_)) => {
                Transform::new(system, &CoordinateSystem::from_scene(scene).ok()?).ok()?.forward_one(model)
            }
            _ => model.is_finite().then_some(model),
        }
    }

    /// From columns and rows of the file's samples, the first at 0, to scene x, y; `None` where a system has no such transform.
    pub fn scene_from_index(&self, scene: Crs) -> Option<impl Fn(DVec2) -> Option<DVec2> + '_> {
        let transform = match (&self.source.system, scene) {
            (Some(system), Crs::Epsg(_)) => {
                Some(Transform::new(system, &CoordinateSystem::from_scene(scene).ok()?).ok()?)
            }
            _ => None,
        };
        Some(move |index: DVec2| {
            let model = DVec2::from(self.source.model_from_index.apply(index.x, index.y));
            transform.as_ref().map_or(Some(model), |t| t.forward_one(model)).filter(|p| p.is_finite())
        })
    }

    /// From scene x, y to columns and rows of the file's samples, the first at 0; `None` where a system has no such transform.
    pub fn index_from_scene(&self, scene: Crs) -> Option<impl Fn(DVec2) -> Option<DVec2> + '_> {
        let index_from_model = self.source.model_from_index.inverse()?;
        let transform = match (&self.source.system, scene) {
            (Some(system), Crs::Epsg(_)) => {
                Some(Transform::new(&CoordinateSystem::from_scene(scene).ok()?, system).ok()?)
            }
            _ => None,
        };
        Some(move |p: DVec2| {
            let model = transform.as_ref().map_or(Some(p), |t| t.forward_one(p))?;
            Some(DVec2::from(index_from_model.apply(model.x, model.y))).filter(|i| i.is_finite())
        })
    }

    /// Name of the file's own system for messages.
    pub fn system_name(&self) -> &str {
        self.source.system.as_ref().map_or("no coordinate system", CoordinateSystem::name)
    }

    /// One sentence about parts of the georeference that cannot be written, if there are any.
    pub fn georeference_note(&self) -> Option<Warning> {
        let system = self.source.system.as_ref()?;
        system.epsg().is_none().then(|| {
            let text = format!("its coordinate system {system} has no EPSG code, so written rasters carry none");
            Warning::new(WarningKind::Ignored, text).in_file(&self.source.path)
        })
    }
}

/// The heights of a terrain moved by `delta` (metres, at scene x, y), and the moves themselves, as rasters on its own grid.
pub fn moved_terrain(terrain: &Heightfield, crs: Crs, delta: impl Fn(DVec2) -> f64) -> [Raster; 2] {
    let (cols, rows) = (terrain.cols(), terrain.rows());
    let mut info = RasterInfo::new(Path::new("terrain"), cols, rows, SampleType::F32);
    let (start, step) = (terrain.north_west(), terrain.spacing());
    let map = Affine([step.x, 0.0, start.x, 0.0, -step.y, start.y]).after_scale_and_shift(1.0, 1.0, -0.5, -0.5);
    (info.pixel_to_model, info.nodata) = (Some(map), Some(f64::from(NODATA)));
    if let Crs::Epsg(code) = crs {
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(code), CrsKind::Projected);
    }
    let pair = |(i, state): (usize, &NodeState)| match state {
        NodeState::Void => [NODATA; 2],
        _ => {
            let d = delta(terrain.node_xy(i % cols, i / cols));
            [(f64::from(terrain.heights()[i]) + d) as f32, d as f32]
        }
    };
    let pairs: Vec<[f32; 2]> = terrain.states().iter().enumerate().map(pair).collect();
    [0, 1].map(|k| {
        let samples = Samples::F32(pairs.iter().map(|p| p[k]).collect());
        Raster { info: info.clone(), samples, mask: None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geotiff::write_geotiff as write;

    #[test]
    fn moved_heights_keep_grid_system_and_voids() {
        let folder = std::env::temp_dir().join(format!("belvedere-original-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let asc = folder.join("dem.asc");
        std::fs::write(
            &asc,
            "ncols 3\nnrows 2\nxllcorner 8.0\nyllcorner 46.0\ncellsize 0.01\nNODATA_value -1\n1 2 3\n4 -1 6\n",
        )
        .unwrap();
        let request = TerrainRequest { source_crs: Some(4326), ..TerrainRequest::default() };
        let original = load_original(&asc, &request, &Progress::silent()).unwrap().value;
        assert_eq!(original.size(), [3, 2]);
        // 10 m down west of 454 km east (the middle of the grid lies near 8.015 E), 5 m up east of it.
        let middle = CoordinateSystem::from_epsg(32632).unwrap();
        let middle = Transform::new(&CoordinateSystem::wgs84().unwrap(), &middle).unwrap();
        let edge = middle.forward_one(DVec2::new(8.012, 46.01)).unwrap().x;
        let rasters = original.moved(Crs::Epsg(32632), |p| if p.x < edge { -10.0 } else { 5.0 }).unwrap();
        let [dem, delta] = rasters;
        assert_eq!(dem.samples, Samples::F32(vec![-9.0, 7.0, 8.0, -6.0, -9999.0, 11.0]));
        assert_eq!(delta.samples, Samples::F32(vec![-10.0, 5.0, 5.0, -10.0, -9999.0, 5.0]));
        let out = folder.join("out.tif");
        write(&out, &dem, true).unwrap();
        let again = load_original(&out, &TerrainRequest::default(), &Progress::silent()).unwrap().value;
        assert_eq!(again.heights().collect::<Vec<_>>()[3..5], [Some(-6.0), None]);
        assert_eq!(again.source.system, original.source.system);
        let corner = |o: &OriginalTerrain| o.source.model_from_index.apply(2.0, 1.0);
        assert!((corner(&again)[0] - 8.025).abs() < 1e-12 && (corner(&again)[1] - 46.005).abs() < 1e-12);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
