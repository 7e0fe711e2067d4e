//! Georeferenced pictures laid over terrain.

use belvedere_core::{Aabb, DVec2};
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::{Affine, GeoTiff, Limits, Loaded, RasterInfo, SourceCrs};
use belvedere_scene::{Crs, Drape, Progress};
use std::path::Path;

/// Longest side of a picture that is kept, pixels; larger ones are read from a reduced copy if they have one.
const MAX_SIDE: usize = 8192;
/// Points per side at which the picture's position is fitted.
const FIT: usize = 9;

/// Reads a picture and places it by an affine map fitted to its own coordinate system.
pub(super) fn load(
    path: &Path,
    crs: Crs,
    terrain: Option<Aabb>,
    limits: Limits,
    progress: &Progress,
) -> Result<Loaded<Drape>, String> {
    let opened = GeoTiff::open(path, limits).map_err(|e| e.to_string())?;
    let (file, mut warnings) = (opened.value, opened.warnings);
    let level = file.level_for(MAX_SIDE);
    let info = file.level_info(level).unwrap_or_else(|| file.info().clone());
    let shown = path.display();
    let map = info
        .pixel_to_model
        .ok_or_else(|| format!("{shown}: the picture has no georeference; give a GeoTIFF that has one"))?;
    let transform = transform(&info, crs).map_err(|e| format!("{shown}: {e}"))?;
    let (pixel_from_scene, error_px) = fit(&info, &map, transform.as_ref()).ok_or_else(|| {
        format!("{shown}: the picture lies outside the domain of {crs}; choose another picture or crs")
    })?;
    if error_px > 1.0 {
        warnings.push(format!("{shown}: placed by an affine map that is up to {error_px:.1} of its pixels off; reproject it to {crs} for more"));
    }
    if let Some(bounds) = terrain {
        let inside = |p: DVec2| (0.0..=info.width as f64).contains(&p.x) && (0.0..=info.height as f64).contains(&p.y);
        let steps = (0..=32).flat_map(|i| (0..=32).map(move |j| DVec2::new(f64::from(i), f64::from(j)) / 32.0));
        let (min, max) = (bounds.min.truncate(), bounds.max.truncate());
        let hits = steps.filter(|t| inside(apply(&pixel_from_scene, min + *t * (max - min)))).count();
        let corners = [[0.0, 0.0], [info.width as f64, info.height as f64]].map(|[x, y]| map.apply(x, y));
        if hits == 0 && !overlaps(&corners, transform.as_ref(), min, max) {
            return Err(format!("{shown}: the picture does not overlap the terrain; choose one that covers it"));
        }
    }
    let (raster, input) = rayon::join(|| file.read(level, progress), || file.input());
    let (raster, input) = (raster.map_err(|e| e.to_string())?, input.map_err(|e| e.to_string())?);
    let pixels = raster.to_rgba().map_err(|e| format!("{shown}: {e}"))?;
    Ok(Loaded::new(Drape { pixels, width: info.width, height: info.height, pixel_from_scene }, warnings)
        .with_file(input))
}

fn overlaps(corners: &[[f64; 2]; 2], transform: Option<&Transform>, min: DVec2, max: DVec2) -> bool {
    let scene = corners.map(|c| {
        let p = DVec2::from_array(c);
        transform.map_or(Some(p), |t| t.forward_one(p)).unwrap_or(DVec2::NAN)
    });
    let (lo, hi) = (scene[0].min(scene[1]), scene[0].max(scene[1]));
    lo.x <= max.x && hi.x >= min.x && lo.y <= max.y && hi.y >= min.y
}

/// From the picture's system to the scene's; `None` if the picture names none or the scene is local.
fn transform(info: &RasterInfo, crs: Crs) -> Result<Option<Transform>, String> {
    if crs == Crs::Local {
        return Ok(None);
    }
    let from = match &info.crs {
        SourceCrs::Epsg(code) => CoordinateSystem::from_epsg(*code),
        SourceCrs::Wkt(text) => CoordinateSystem::from_wkt(text),
        SourceCrs::UserDefined(text) => {
            return Err(format!("its coordinate system is not known ({text}); reproject it to {crs}"));
        }
        SourceCrs::Unknown => return Ok(None),
    };
    let to = CoordinateSystem::from_scene(crs).map_err(|e| e.to_string())?;
    let from = from.map_err(|e| e.to_string())?;
    Transform::new(&from, &to).map(Some).map_err(|e| e.to_string())
}

/// Affine map from scene to pixel by least squares over a grid of pixels, and its largest error in pixels.
fn fit(info: &RasterInfo, map: &Affine, transform: Option<&Transform>) -> Option<([f64; 6], f64)> {
    let size = DVec2::new(info.width as f64, info.height as f64);
    let mut pairs = Vec::new();
    for i in 0..FIT {
        for j in 0..FIT {
            let pixel = size * DVec2::new(i as f64, j as f64) / (FIT - 1) as f64;
            let model = DVec2::from_array(map.apply(pixel.x, pixel.y));
            pairs.push((transform.map_or(Some(model), |t| t.forward_one(model))?, pixel));
        }
    }
    let count = pairs.len() as f64;
    let mean = pairs.iter().fold(DVec2::ZERO, |m, (s, _)| m + *s) / count;
    let mean_px = pairs.iter().fold(DVec2::ZERO, |m, (_, p)| m + *p) / count;
    let (mut xx, mut xy, mut yy, mut xp, mut yp) = (0.0, 0.0, 0.0, DVec2::ZERO, DVec2::ZERO);
    for (scene, pixel) in &pairs {
        let (s, p) = (*scene - mean, *pixel - mean_px);
        (xx, xy, yy) = (xx + s.x * s.x, xy + s.x * s.y, yy + s.y * s.y);
        (xp, yp) = (xp + s.x * p, yp + s.y * p);
    }
    let det = xx * yy - xy * xy;
    let a = (yy * xp - xy * yp) / det;
    let b = (xx * yp - xy * xp) / det;
    let c = mean_px - a * mean.x - b * mean.y;
    let affine = [a.x, b.x, c.x, a.y, b.y, c.y];
    let worst = pairs.iter().map(|(s, p)| apply(&affine, *s).distance(*p)).fold(0.0, f64::max);
    affine.iter().all(|v| v.is_finite()).then_some((affine, worst))
}

fn apply(a: &[f64; 6], p: DVec2) -> DVec2 {
    DVec2::new(a[0] * p.x + a[1] * p.y + a[2], a[3] * p.x + a[4] * p.y + a[5])
}
