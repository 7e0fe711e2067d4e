//! Maps of cities: land cover, water, roads by class, blocks; as a picture to drape over terrain, and as plan drawings.

pub mod overview;
mod plan;

use crate::BelvedereError;
use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_io::raster::{Affine, Alpha, CrsKind, Photometric, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use belvedere_io::{atomic, geotiff, png};
use belvedere_scene::Color;
use belvedere_scene::city::{Building, City};
use plan::Plan;
use std::path::{Path, PathBuf};

/// Fill colours of blocks and of landmarks.
const FILLS: [Color; 2] = [Color::rgb(226, 218, 207), Color::rgb(203, 176, 160)];
/// Their outlines.
const OUTLINES: [Color; 2] = [Color::rgb(201, 190, 176), Color::rgb(160, 122, 104)];

/// Bounds of the buildings of a city, least and largest corner; `None` without any.
pub fn bounds(city: &City) -> Option<[DVec2; 2]> {
    let points = city.buildings.iter().flat_map(|b| &b.footprint).flat_map(|p| &p.outer).filter(|p| p.is_finite());
    points.fold(None, |box2: Option<[DVec2; 2]>, p| Some(box2.map_or([*p; 2], |[a, b]| [a.min(*p), b.max(*p)])))
}

/// A georeferenced picture of a map.
#[derive(Debug, Clone)]
pub struct MapPicture {
    /// sRGB and opacity, row 0 in the north.
    pub pixels: Vec<[u8; 4]>,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Coordinates of pixel corners.
    pub pixel_to_model: Affine,
}

/// The map of a city within `bounds`, with at most `most_px` pixels along its longer side, each of at least `least_m` metres. Roads have a
/// casing of one pixel; `blocks` are filled, landmarks among them darker.
pub fn map_picture(ground: &City, blocks: &[Building], bounds: [DVec2; 2], most_px: usize, least_m: f64) -> MapPicture {
    let plan = Plan::within(bounds, most_px.max(1), least_m);
    let mut rgb = vec![[0u8; 3]; plan.width * plan.height];
    let mut canvas = Canvas::new(&mut rgb, plan.width);
    plan.ground(&mut canvas, ground);
    for block in blocks {
        let kind = usize::from(block.landmark);
        for polygon in &block.footprint {
            plan.fill(&mut canvas, polygon, FILLS[kind], DVec2::ZERO);
            plan.outline(&mut canvas, polygon, 1.0, OUTLINES[kind]);
        }
    }
    plan.ways(&mut canvas, &ground.ways);
    let m = plan.m_per_px;
    MapPicture {
        pixels: rgb.into_iter().map(|[r, g, b]| [r, g, b, 255]).collect(),
        width: plan.width,
        height: plan.height,
        pixel_to_model: Affine([m, 0.0, plan.low.x, 0.0, -m, plan.low.y + m * plan.height as f64]),
    }
}

impl MapPicture {
    /// Name of the file in `folder`: GeoTIFF where the coordinate system has an EPSG code, else PNG with a world file.
    pub fn files(folder: &Path, epsg: Option<u32>) -> Vec<PathBuf> {
        if epsg.is_some() { vec![folder.join("map.tif")] } else { vec![folder.join("map.png"), folder.join("map.pgw")] }
    }

    /// Writes [`MapPicture::files`].
    ///
    /// # Errors
    /// [`BelvedereError::Io`].
    pub fn write(&self, folder: &Path, epsg: Option<u32>, overwrite: bool) -> Result<(), BelvedereError> {
        let bytes: Vec<u8> = self.pixels.as_flattened().to_vec();
        let files = Self::files(folder, epsg);
        if let Some(code) = epsg {
            let mut info = RasterInfo::new(&files[0], self.width, self.height, SampleType::U8);
            info.bands = 4;
            info.photometric = Photometric::Rgb([0, 1, 2]);
            info.alpha = Alpha::Straight(3);
            info.pixel_to_model = Some(self.pixel_to_model);
            info.crs = SourceCrs::Epsg(code);
            info.crs_kind = CrsKind::Projected;
            let raster = Raster { info, samples: Samples::U8(bytes), mask: None };
            return Ok(geotiff::write_geotiff(&files[0], &raster, overwrite)?);
        }
        let [a, b, c, d, e, f] = self.pixel_to_model.0;
        // World files give the centre of the first pixel.
        let centre = [c + 0.5 * (a + b), f + 0.5 * (d + e)];
        let world: String = [a, d, b, e, centre[0], centre[1]].iter().map(|v| format!("{v}\n")).collect();
        png::write(&files[0], overwrite, self.width, self.height, png::Channels::Rgba, &bytes, &[])?;
        Ok(atomic::write_atomic(&files[1], overwrite, |out| out.write_all(world.as_bytes()))?)
    }
}

#[cfg(test)]
mod tests;
