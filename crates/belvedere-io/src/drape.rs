//! Georeferenced pictures draped over terrain: GeoTIFF, and PNG with a world file.

use crate::crs::{CoordinateSystem, Transform};
use crate::formats::ends;
use crate::fs::read_sidecar;
use crate::packed::content;
use crate::terrain::{Geometry, GridMap, Link, stated_system};
use crate::{Affine, GeoTiff, InputFile, IoError, Limits, Loaded, Raster, SourceCrs, budget, esri_ascii, fs, png};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Crs, Drape, Heightfield, Progress};
use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// How to load a drape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrapeRequest {
    /// Memory for decoded samples.
    pub limits: Limits,
    /// Most pixels of the drape; larger pictures are reduced.
    pub max_pixels: usize,
    /// EPSG code of the picture, in place of the file's own.
    pub source_crs: Option<u32>,
}

impl Default for DrapeRequest {
    fn default() -> Self {
        Self { limits: Limits::default(), max_pixels: 16_000_000, source_crs: None }
    }
}

/// Accuracy of the interpolated map between grids, pixels.
const MAP_TOLERANCE: f64 = 1e-3;
/// Pixels kept around the terrain, for interpolation at its border.
const RIM: f64 = 2.0;

/// A picture in memory with the affine map of its pixel corners.
struct Picture {
    pixels: Vec<[u8; 4]>,
    width: usize,
    height: usize,
    model_from_pixel: Affine,
}

/// Loads the part of a picture that lies over the terrain, as a drape in scene coordinates.
///
/// In the CRS of the scene the pixels are kept and only the affine map is taken over; else they are resampled bilinearly
/// to a grid along the scene's axes of about the same resolution. RGB, RGBA, palettes and grey of 8 or 16 bits; no data
/// becomes transparent. In a local scene the file's coordinates are the scene's.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] without georeference, without overlap (telling both extents), or for a file that
/// is damaged or no picture; [`IoError::Cancelled`].
pub fn load_drape(
    path: &Path,
    scene_crs: Crs,
    heightfield: &Heightfield,
    request: &DrapeRequest,
    progress: &Progress,
) -> Result<Loaded<Drape>, IoError> {
    let mut warnings = Vec::new();
    let target = match scene_crs {
        Crs::Local => None,
        crs => Some(CoordinateSystem::from_scene(crs).map_err(|e| IoError::format(path, e.to_string()))?),
    };
    let source = Source::open(path, request, &mut warnings)?;
    let info = source.info();
    let Some(model_from_pixel) = info.pixel_to_model else {
        let reason =
            "the picture has no georeference, so its place is not known; give it one (GeoTIFF tags or a world file)";
        return Err(IoError::format(path, reason));
    };
    let mut system = stated_system(info, request.source_crs, target.is_none(), &mut warnings)?;
    if system.is_none()
        && let Some(target) = &target
    {
        let text = format!(
            "no coordinate system is stated, so that of the scene ({target}) is assumed; set source_crs if that is wrong"
        );
        warnings.push(Warning::new(WarningKind::Assumed, text).in_file(path));
        system = Some(target.clone());
    }
    if let (Some(system), Some(target)) = (&system, &target)
        && system != target
    {
        warnings.extend(system.datum_note());
    }
    let size = [info.width, info.height];
    let link = Link::of(model_from_pixel, system.as_ref(), size, target.as_ref(), path)?;
    let Some([cols, rows]) = window(&link, heightfield, size) else {
        return Err(no_overlap(path, &link, size, target.as_ref(), heightfield));
    };
    let mut picture = source.read(cols, rows, request.max_pixels, progress)?;
    let reduced = reduction(picture.width, picture.height, request.max_pixels);
    if reduced > 1 {
        picture = picture.reduced(reduced);
    }
    warn_about_reduction(path, &picture, model_from_pixel, &mut warnings);
    let same = system == target || target.is_none();
    let drape = if same {
        direct(path, picture, &system, target.is_none())?
    } else {
        progress.tick("draping", 0.0)?;
        reproject(path, &picture, system.as_ref(), target.as_ref(), heightfield, request.max_pixels)?
    };
    if drape.pixels.iter().all(|p| p[3] == 0) {
        let text = "nothing but transparent pixels lies over the terrain";
        warnings.push(Warning::new(WarningKind::Suspect, text).in_file(path));
    }
    Ok(Loaded::new(drape, warnings).with_file(source.input()?))
}

fn warn_about_reduction(path: &Path, picture: &Picture, full: Affine, warnings: &mut Vec<Warning>) {
    let factor = (picture.model_from_pixel.determinant() / full.determinant()).abs().sqrt();
    if factor > 1.01 {
        let text = format!(
            "the picture is used {factor:.1} times coarser than it is, to keep its pixels within the limit; a part of it over the terrain keeps its detail"
        );
        warnings.push(Warning::new(WarningKind::Reduced, text).with("coarser", factor).in_file(path));
    }
}

/// A file, opened but not decoded, or (PNG) decoded at once.
enum Source {
    Tiff(Box<GeoTiff>),
    Whole(Box<Raster>),
}

impl Source {
    fn open(path: &Path, request: &DrapeRequest, warnings: &mut Vec<Warning>) -> Result<Self, IoError> {
        let path = &content(path, request.limits.max_bytes, &|p| ends(p, &[".tif", ".tiff", ".png"]))?;
        let _work = budget::work_on(path);
        let mut magic = [0u8; 8];
        let mut file = fs::File::open(path).map_err(|e| IoError::os(path, e))?;
        let got = std::io::Read::read(&mut file, &mut magic).map_err(|e| IoError::os(path, e))?;
        if magic.get(..got).is_some_and(|m| m == b"\x89PNG\r\n\x1a\n") {
            let mut raster = png::read(path, &request.limits)?;
            raster.info.pixel_to_model = world_file(path)?;
            raster.info.crs = match esri_ascii::prj_beside(path)? {
                SourceCrs::Unknown => raster.info.crs,
                crs => crs,
            };
            return Ok(Self::Whole(Box::new(raster)));
        }
        let other = crate::recognise::readable(path)?.filter(|format| format.name != "GeoTIFF");
        let loaded = GeoTiff::open(path, request.limits).map_err(|e| match other {
            Some(_) => {
                crate::recognise::not_a(path, "a picture with a georeference: GeoTIFF, or PNG with a world file")
            }
            None => e,
        })?;
        warnings.extend(loaded.warnings);
        Ok(Self::Tiff(Box::new(loaded.value)))
    }

    /// Path, size and hash of the file.
    fn input(&self) -> Result<InputFile, IoError> {
        match self {
            Self::Tiff(tiff) => tiff.input(),
            Self::Whole(raster) => Ok(InputFile::read(&raster.info.path)?.1),
        }
    }

    fn info(&self) -> &crate::RasterInfo {
        match self {
            Self::Tiff(tiff) => tiff.info(),
            Self::Whole(raster) => &raster.info,
        }
    }

    /// Decodes a window of the full image, from an overview if it has too many pixels.
    fn read(
        &self,
        cols: Range<usize>,
        rows: Range<usize>,
        max_pixels: usize,
        progress: &Progress,
    ) -> Result<Picture, IoError> {
        let raster = match self {
            Self::Whole(raster) => return Picture::of(raster).map(|p| p.cut(cols, rows)),
            Self::Tiff(tiff) => {
                let full = tiff.info();
                let scaled = |r: &Range<usize>, n: usize, full: usize| {
                    let k = n as f64 / full as f64;
                    let end = ((r.end as f64 * k).ceil() as usize).min(n);
                    ((r.start as f64 * k).floor() as usize).min(end.saturating_sub(1))..end
                };
                let windows = (0..tiff.levels()).filter_map(|level| {
                    let info = tiff.level_info(level)?;
                    Some((level, scaled(&cols, info.width, full.width), scaled(&rows, info.height, full.height)))
                });
                let windows: Vec<_> = windows.collect();
                // the largest level within the limit, else the smallest there is
                let fits = |w: &&(usize, Range<usize>, Range<usize>)| w.1.len() * w.2.len() <= max_pixels;
                let Some((level, cols, rows)) = windows.iter().find(fits).or(windows.last()).cloned() else {
                    return Err(IoError::format(&full.path, "the file holds no image"));
                };
                tiff.read_window(level, cols, rows, progress)?
            }
        };
        Picture::of(&raster)
    }
}

impl Picture {
    fn of(raster: &Raster) -> Result<Self, IoError> {
        let info = &raster.info;
        let most = 4 * info.width as u64 * info.height as u64;
        budget::ask("the picture", most).map_err(|e| IoError::format(&info.path, e))?;
        let pixels = raster.to_rgba().map_err(|reason| IoError::format(&info.path, reason))?;
        let model_from_pixel = info.pixel_to_model.unwrap_or(Affine([1.0, 0.0, 0.0, 0.0, -1.0, 0.0]));
        Ok(Self { pixels, width: info.width, height: info.height, model_from_pixel })
    }

    fn cut(self, cols: Range<usize>, rows: Range<usize>) -> Self {
        let kept =
            rows.clone().flat_map(|r| self.pixels[r * self.width + cols.start..r * self.width + cols.end].iter());
        Self {
            pixels: kept.copied().collect(),
            width: cols.len(),
            height: rows.len(),
            model_from_pixel: self.model_from_pixel.after_scale_and_shift(
                1.0,
                1.0,
                cols.start as f64,
                rows.start as f64,
            ),
        }
    }

    /// Means of `k` x `k` pixels, weighted by alpha; remaining pixels at the right and bottom edge are dropped.
    fn reduced(&self, k: usize) -> Self {
        let (width, height) = (self.width / k, self.height / k);
        let mean = |i: usize| {
            let (c0, r0) = (i % width * k, i / width * k);
            let mut sum = [0u64; 4];
            for r in r0..r0 + k {
                for p in &self.pixels[r * self.width + c0..r * self.width + c0 + k] {
                    let a = u64::from(p[3]);
                    for (sum, channel) in sum.iter_mut().zip([p[0], p[1], p[2]]) {
                        *sum += a * u64::from(channel);
                    }
                    sum[3] += a;
                }
            }
            let color = |n: usize| (sum[n] + sum[3] / 2).checked_div(sum[3]).unwrap_or(0) as u8;
            [color(0), color(1), color(2), (sum[3] / (k * k) as u64) as u8]
        };
        let pixels = (0..width * height).into_par_iter().with_min_len(4096).map(mean).collect();
        let model_from_pixel = self.model_from_pixel.after_scale_and_shift(k as f64, k as f64, 0.0, 0.0);
        Self { pixels, width, height, model_from_pixel }
    }

    /// Bilinear colour at pixel coordinates (centres at .5); colours are weighted by alpha. Transparent outside.
    fn sample(&self, p: DVec2) -> [u8; 4] {
        let (w, h) = (self.width as f64, self.height as f64);
        if !(p.x >= 0.0 && p.y >= 0.0 && p.x <= w && p.y <= h) {
            return [0; 4];
        }
        let (x, y) = ((p.x - 0.5).clamp(0.0, w - 1.0), (p.y - 0.5).clamp(0.0, h - 1.0));
        let (c, r) = (x as usize, y as usize);
        let (c1, r1) = ((c + 1).min(self.width - 1), (r + 1).min(self.height - 1));
        let (u, v) = ((x - c as f64) as f32, (y - r as f64) as f32);
        let corners = [
            (self.pixels[r * self.width + c], (1.0 - u) * (1.0 - v)),
            (self.pixels[r * self.width + c1], u * (1.0 - v)),
            (self.pixels[r1 * self.width + c], (1.0 - u) * v),
            (self.pixels[r1 * self.width + c1], u * v),
        ];
        let mut sum = [0.0f32; 4];
        for (p, weight) in corners {
            let a = weight * f32::from(p[3]);
            for (sum, channel) in sum.iter_mut().zip([p[0], p[1], p[2]]) {
                *sum += a * f32::from(channel);
            }
            sum[3] += a;
        }
        if sum[3] < 0.5 {
            return [0; 4];
        }
        let byte = |v: f32| (v + 0.5) as u8;
        [byte(sum[0] / sum[3]), byte(sum[1] / sum[3]), byte(sum[2] / sum[3]), byte(sum[3])]
    }
}

/// Least integer factor by which both sides must shrink to fit `max_pixels`.
fn reduction(width: usize, height: usize, max_pixels: usize) -> usize {
    let longest = width.min(height).max(1);
    (1..=longest).find(|k| (width / k) * (height / k) <= max_pixels.max(1)).unwrap_or(longest)
}

/// Columns and rows of the picture over the terrain; `None` if it does not touch the picture.
pub(crate) fn window(link: &Link, heightfield: &Heightfield, size: [usize; 2]) -> Option<[Range<usize>; 2]> {
    const N: usize = 48;
    let bounds = heightfield.bounds();
    let span = bounds.max - bounds.min;
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for i in 0..(N + 1) * (N + 1) {
        let t = DVec2::new((i % (N + 1)) as f64, (i / (N + 1)) as f64) / N as f64;
        if let Some(p) = link.index_from_scene(bounds.min.truncate() + t * span.truncate()) {
            min = min.min(p);
            max = max.max(p);
        }
    }
    let range = |low: f64, high: f64, n: usize| {
        let touches = high > 0.0 && low < n as f64;
        touches.then(|| (low - RIM).floor().max(0.0) as usize..((high + RIM).ceil() as usize).min(n))
    };
    Some([range(min.x, max.x, size[0])?, range(min.y, max.y, size[1])?])
}

pub(crate) fn no_overlap(
    path: &Path,
    link: &Link,
    size: [usize; 2],
    target: Option<&CoordinateSystem>,
    heightfield: &Heightfield,
) -> IoError {
    let b = heightfield.bounds();
    let (w, h) = (size[0] as f64, size[1] as f64);
    let picture = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h), (0.5 * w, 0.5 * h)];
    let picture: Vec<DVec2> = picture.iter().filter_map(|&p| link.scene_from_index(p.into())).collect();
    let terrain = [
        DVec2::new(b.min.x, b.min.y),
        DVec2::new(b.max.x, b.max.y),
        DVec2::new(b.min.x, b.max.y),
        DVec2::new(b.max.x, b.min.y),
    ];
    let reason = format!(
        "it does not touch the terrain: it covers {}, the terrain {}; choose one of the same place",
        covers(&picture, target),
        covers(&terrain, target)
    );
    IoError::format(path, reason)
}

/// Box around scene points for messages, in degrees if the scene lies on the earth.
fn covers(points: &[DVec2], target: Option<&CoordinateSystem>) -> String {
    let geographic = target.and_then(|t| Transform::new(t, &CoordinateSystem::wgs84().ok()?).ok());
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in points.iter().filter_map(|&p| geographic.as_ref().map_or(Some(p), |t| t.forward_one(p))) {
        min = min.min(p);
        max = max.max(p);
    }
    if !min.is_finite() {
        return "no place on the earth".to_owned();
    }
    match geographic {
        Some(_) => format!("lon {:.4}..{:.4} lat {:.4}..{:.4}", min.x, max.x, min.y, max.y),
        None => format!("x {:.1}..{:.1} y {:.1}..{:.1}", min.x, max.x, min.y, max.y),
    }
}

/// The picture as it is.
fn direct(path: &Path, picture: Picture, system: &Option<CoordinateSystem>, local: bool) -> Result<Drape, IoError> {
    let scale = if local { system.as_ref().and_then(CoordinateSystem::metres_per_unit).unwrap_or(1.0) } else { 1.0 };
    let scene_from_pixel = Affine(picture.model_from_pixel.0.map(|v| v * scale));
    let Some(Affine(pixel_from_scene)) = scene_from_pixel.inverse() else {
        return Err(IoError::format(path, "its georeference is singular (no area); correct it"));
    };
    Ok(Drape { pixels: picture.pixels, width: picture.width, height: picture.height, pixel_from_scene })
}

/// The picture on a grid along the axes of the scene.
fn reproject(
    path: &Path,
    picture: &Picture,
    system: Option<&CoordinateSystem>,
    target: Option<&CoordinateSystem>,
    heightfield: &Heightfield,
    max_pixels: usize,
) -> Result<Drape, IoError> {
    let size = [picture.width, picture.height];
    let link = Link::of(picture.model_from_pixel, system, size, target, path)?;
    let unfit =
        || IoError::format(path, "the picture cannot be placed in the CRS of the scene; check its georeference");
    let spacing = link.spacing_near(size).ok_or_else(unfit)?;
    const N: usize = 32;
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for i in 0..(N + 1) * (N + 1) {
        let t = DVec2::new((i % (N + 1)) as f64, (i / (N + 1)) as f64) / N as f64;
        if let Some(p) = link.scene_from_index(t * DVec2::new(size[0] as f64, size[1] as f64)) {
            min = min.min(p);
            max = max.max(p);
        }
    }
    let bounds = heightfield.bounds();
    let (min, max) = (min.max(bounds.min.truncate() - spacing), max.min(bounds.max.truncate() + spacing));
    let span = max - min;
    if !(span.min_element() > 0.0 && span.is_finite()) {
        return Err(unfit());
    }
    let area = (span / spacing).element_product();
    let spacing = spacing * (area / max_pixels as f64).sqrt().max(1.0);
    let count = |v: f64| (v.ceil() as usize).max(2);
    let (width, height) = (count(span.x / spacing.x), count(span.y / spacing.y));
    // node (0, 0) of this grid is the centre of the first pixel
    let grid = Geometry { north_west: DVec2::new(min.x + 0.5 * spacing.x, max.y - 0.5 * spacing.y), spacing };
    let exact = |index: DVec2| link.index_from_scene(grid.scene_from_index(index));
    let map = GridMap::new(width, height, MAP_TOLERANCE, &exact);
    let mut pixels = vec![[0u8; 4]; width * height];
    pixels.par_chunks_exact_mut(width).enumerate().for_each_init(
        || vec![DVec2::ZERO; width],
        |positions, (r, row)| {
            map.row(r, positions);
            for (pixel, &position) in row.iter_mut().zip(positions.iter()) {
                *pixel = picture.sample(position);
            }
        },
    );
    let (sx, sy) = (1.0 / spacing.x, 1.0 / spacing.y);
    let pixel_from_scene = [sx, 0.0, -min.x * sx, 0.0, -sy, max.y * sy];
    Ok(Drape { pixels, width, height, pixel_from_scene })
}

/// Six numbers of a world file beside a picture (`.pgw`, `.pngw`, `.wld`); `None` if there is no such file.
fn world_file(path: &Path) -> Result<Option<Affine>, IoError> {
    for extension in ["pgw", "pngw", "wld", "PGW", "WLD"] {
        let world = path.with_extension(extension);
        if !fs::metadata(&world).is_ok_and(|m| m.is_file() && m.len() < 1 << 16) {
            continue;
        }
        let text = read_sidecar(path, &world, 1 << 16)?;
        let text = String::from_utf8_lossy(&text);
        let numbers: Vec<f64> = text.split_whitespace().map_while(|w| w.parse().ok()).collect();
        let &[a, d, b, e, c, f] = numbers.as_slice() else {
            let reason = format!("a world file has six numbers, this one starts with {}; correct it", numbers.len());
            return Err(IoError::format(&world, reason));
        };
        // the offsets are those of the centre of the first pixel
        return Ok(Some(Affine([a, b, c, d, e, f]).after_scale_and_shift(1.0, 1.0, -0.5, -0.5)));
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_between_pixels_are_rounded_to_the_nearest() {
        let pixels = vec![[10, 20, 30, 255], [11, 10, 30, 255]];
        let model_from_pixel = Affine([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let picture = Picture { pixels, width: 2, height: 1, model_from_pixel };
        assert_eq!(picture.sample(DVec2::new(0.9375, 0.5)), [10, 16, 30, 255], "10.44 and 15.63");
        assert_eq!(picture.sample(DVec2::new(1.0625, 0.5)), [11, 14, 30, 255], "10.56 and 14.37");
        assert_eq!(picture.sample(DVec2::new(2.0625, 0.5)), [0; 4], "outside");
    }
}
