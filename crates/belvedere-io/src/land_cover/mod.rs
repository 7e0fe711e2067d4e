//! Land cover over a terrain: rasters of ESA WorldCover, CORINE and NLCD, and areas of OpenStreetMap or CORINE.

mod classes;

use crate::crs::CoordinateSystem;
use crate::drape::{no_overlap, window};
use crate::terrain::{Geometry, GridMap, Link, stated_system};
use crate::vector::{Geometry as Shape, VectorFeature, Vectors, areas_on_terrain};
use crate::{GeoTiff, IoError, Limits, Loaded, Raster, budget};
use belvedere_core::{DVec2, Warning, WarningKind};
use belvedere_scene::{Cover, CoverMap, Crs, Heightfield, Progress};
use classes::{Legend, of_area};
use rayon::prelude::*;
use std::path::Path;

/// Most cells over a terrain; finer rasters are thinned.
const MOST_CELLS: f64 = 24e6;
/// Accuracy of the interpolated map between grids, pixels.
const MAP_TOLERANCE: f64 = 0.05;
/// Cells of areas per node of the ground, along an axis, and the finest of them, scene units.
const FINER: f64 = 3.0;
const FINEST: f64 = 5.0;
/// Largest number of a class.
const LARGEST: f64 = 1000.0;

/// Loads a raster of classes over a terrain; each cell has the class of the pixel that it lies in.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, has no georeference, does not touch the terrain, or has classes of
/// another legend; [`IoError::Cancelled`].
pub fn load_land_cover(
    path: &Path,
    scene_crs: Crs,
    ground: &Heightfield,
    limits: Limits,
    progress: &Progress,
) -> Result<Loaded<CoverMap>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let opened = GeoTiff::open(path, limits)?;
    let (tiff, mut warnings) = (opened.value, opened.warnings);
    let info = tiff.info();
    let target = match scene_crs {
        Crs::Local => None,
        crs => Some(CoordinateSystem::from_scene(crs).map_err(|e| fail(e.to_string()))?),
    };
    let model = info.pixel_to_model.ok_or_else(|| fail("the raster has no georeference; give it one".into()))?;
    let mut system = stated_system(info, None, target.is_none(), &mut warnings)?;
    if system.is_none() && target.is_some() {
        let text = "no coordinate system is stated, so that of the scene is assumed";
        warnings.push(Warning::new(WarningKind::Assumed, text).in_file(path));
        system.clone_from(&target);
    }
    let size = [info.width, info.height];
    let link = Link::of(model, system.as_ref(), size, target.as_ref(), path)?;
    let Some([cols, rows]) = window(&link, ground, size) else {
        return Err(no_overlap(path, &link, size, target.as_ref(), ground));
    };
    let spacing = link.spacing_near(size).ok_or_else(|| fail("the raster cannot be placed in the scene".into()))?;
    let mut land = lattice(ground, spacing, path)?;
    let raster = tiff.read_window(0, cols.clone(), rows.clone(), progress)?;
    let origin = DVec2::new(cols.start as f64, rows.start as f64);
    let numbers = numbers(&raster, &land, ground, &link, origin);
    let mut found: Vec<u16> = Vec::new();
    let mut seen = vec![false; LARGEST as usize + 1];
    for number in &numbers {
        if !std::mem::replace(&mut seen[*number as usize], true) {
            found.push(*number);
        }
    }
    found.sort_unstable();
    let legend = Legend::of(&found).map_err(fail)?;
    land.cells = numbers.into_iter().map(|number| legend.cover(number).unwrap_or_default()).collect();
    land.legend = legend.name;
    Ok(Loaded::new(land, warnings).with_file(tiff.input()?))
}

/// The number of the pixel in which each cell lies; 0 where there is none.
fn numbers(raster: &Raster, land: &CoverMap, ground: &Heightfield, link: &Link, origin: DVec2) -> Vec<u16> {
    let spacing = DVec2::from(land.spacing.map(f64::from));
    let first = DVec2::new(f64::from(land.from[0]), -f64::from(land.from[1]));
    let grid = Geometry { north_west: corner(ground) + first, spacing };
    let exact = |index: DVec2| link.index_from_scene(grid.scene_from_index(index));
    let map = GridMap::new(land.cols, land.cells.len() / land.cols, MAP_TOLERANCE, &exact);
    let mut numbers = vec![0u16; land.cells.len()];
    numbers.par_chunks_exact_mut(land.cols).enumerate().for_each_init(
        || vec![DVec2::ZERO; land.cols],
        |positions, (r, row)| {
            map.row(r, positions);
            for (number, at) in row.iter_mut().zip(positions.iter().map(|at| *at - origin)) {
                let inside = at.x >= 0.0 && at.y >= 0.0;
                let value = inside.then(|| raster.sample_f64(0, at.x as usize, at.y as usize)).flatten();
                *number = value.filter(|v| (0.0..=LARGEST).contains(v)).unwrap_or(0.0) as u16;
            }
        },
    );
    numbers
}

/// The corner of a ground, half a node beyond its north-western one: places in a cover are measured from there.
fn corner(ground: &Heightfield) -> DVec2 {
    ground.north_west() + DVec2::new(-0.5, 0.5) * ground.spacing()
}

/// Cells over a ground, of which nothing is known yet; the first has its centre on the first node.
fn lattice(ground: &Heightfield, spacing: DVec2, path: &Path) -> Result<CoverMap, IoError> {
    let bounds = ground.bounds();
    let span = (bounds.max - bounds.min).truncate();
    let coarser = ((span / spacing).element_product() / MOST_CELLS).sqrt().max(1.0);
    let count = (span / (spacing * coarser)).ceil().max(DVec2::ONE);
    let spacing = span / count;
    let [cols, rows] = [count.x, count.y].map(|n| n as usize + 1);
    budget::ask("the land cover", 3 * (cols * rows) as u64).map_err(|e| IoError::format(path, e))?;
    let [x, y] = [spacing.x as f32, spacing.y as f32];
    let from = (0.5 * ground.spacing()).as_vec2().to_array();
    Ok(CoverMap { from, spacing: [x, y], cols, cells: vec![Cover::Unknown; cols * rows], legend: "" })
}

/// The land cover that areas tell by their tags, over a terrain; where areas overlap water lies above ice, wetland, rock, forest, shrubs, grass,
/// fields and built-up land.
///
/// # Errors
/// [`IoError::Format`] if no area tells what covers it, or none of those lies on the terrain.
pub fn land_cover_of_areas(
    vectors: &Vectors,
    scene_crs: Crs,
    ground: &Heightfield,
) -> Result<Loaded<CoverMap>, IoError> {
    let spacing = (ground.spacing() / FINER).max(DVec2::splat(FINEST)).min(ground.spacing());
    let mut land = lattice(ground, spacing, &vectors.path)?;
    land.legend = "areas by their tags";
    let areas = vectors.features.iter().filter(|feature| matches!(feature.geometry, Shape::Polygons(_)));
    let mut kinds: Vec<((usize, Cover), Vec<VectorFeature>)> = Vec::new();
    for area in areas {
        let Some(kind) = of_area(area) else { continue };
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, of_kind)) => of_kind.push(area.clone()),
            None => kinds.push((kind, vec![area.clone()])),
        }
    }
    if kinds.is_empty() {
        let reason = "holds no area whose tags tell what covers it (natural, landuse, landcover of OpenStreetMap; code_18 of CORINE)";
        return Err(IoError::format(&vectors.path, reason));
    }
    kinds.sort_by_key(|((rank, _), _)| *rank);
    let of_kind = |features| Vectors {
        features,
        path: vectors.path.clone(),
        layer: vectors.layer.clone(),
        crs: vectors.crs.clone(),
        ..*vectors
    };
    let (mut filled, mut outside) = (false, None);
    for ((_, cover), features) in kinds {
        match areas_on_terrain(&of_kind(features), scene_crs, Some(ground)) {
            Err(error) => outside = Some(error),
            Ok(areas) => {
                filled = true;
                for area in areas.value.features {
                    land.fill(&area.rings.iter().map(|ring| relative(ring, ground)).collect::<Vec<_>>(), cover);
                }
            }
        }
    }
    match outside {
        Some(error) if !filled => Err(error),
        _ => Ok(Loaded::new(land, Vec::new())),
    }
}

/// A ring in scene units east and south of the corner of the ground.
fn relative(ring: &[DVec2], ground: &Heightfield) -> Vec<DVec2> {
    let corner = corner(ground);
    ring.iter().map(|p| DVec2::new(p.x - corner.x, corner.y - p.y)).collect()
}

#[cfg(test)]
mod tests;
