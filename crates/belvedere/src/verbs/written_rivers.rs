//! Rivers on written grids: they run downhill also where the grid is not the solver's.

use super::level_lakes::LevelLakes;
use crate::BelvedereError;
use belvedere_disocclusion::DisocclusionError;
use belvedere_disocclusion::report::RiverReport;
use belvedere_disocclusion::rivers::{RiverLine, Rivers};
use belvedere_io::raster::{Raster, Samples};
use belvedere_io::terrain::OriginalTerrain;
use belvedere_scene::Scene;

/// Lowers written heights and displacement where a river would run uphill on them; lakes on its course sink as a whole. Returns the
/// reports of the rivers.
///
/// * `rasters`: heights, and the displacement contained in them, on the grid of `original`;
/// * `ids`: layers of rivers.
pub(super) fn run_downhill(
    [heights, displacement]: &mut [Raster; 2],
    original: &OriginalTerrain,
    (scene, ids): (&Scene, &[String]),
    lakes: &LevelLakes<'_>,
) -> Result<Vec<RiverReport>, BelvedereError> {
    let lines = RiverLine::of(scene, ids).map_err(DisocclusionError::from)?;
    let (Some(index), false) = (original.index_from_scene(scene.crs), lines.is_empty()) else { return Ok(Vec::new()) };
    let nodes = [heights.info.width, heights.info.height];
    let known = |i: usize| heights.sample_f64(0, i % nodes[0], i / nodes[0]);
    let moves = |i: usize| displacement.sample_f64(0, i % nodes[0], i / nodes[0]);
    let count = nodes[0] * nodes[1];
    let mut u: Vec<f64> = (0..count).map(|i| moves(i).unwrap_or(0.0)).collect();
    let rivers = Rivers::new(lines.iter().map(|line| line.mapped(&index)), nodes, |i| Some(known(i)? - moves(i)?));
    let on_lakes = nodes_of_lakes(original, scene, lakes)?;
    let before = u.clone();
    rivers.settle(&mut u, |u| sink(&on_lakes, u));
    let (Samples::F32(z), Samples::F32(d)) = (&mut heights.samples, &mut displacement.samples) else {
        return Ok(rivers.report(&u));
    };
    for i in (0..count).filter(|i| u[*i] < before[*i]) {
        z[i] = (f64::from(z[i]) + u[i] - before[i]) as f32;
        d[i] = u[i] as f32;
    }
    Ok(rivers.report(&u))
}

/// Indices of the file's samples on each lake.
fn nodes_of_lakes(
    original: &OriginalTerrain,
    scene: &Scene,
    lakes: &LevelLakes<'_>,
) -> Result<Vec<Vec<usize>>, BelvedereError> {
    let mut out = Vec::new();
    if lakes.is_empty() {
        return Ok(out);
    }
    // The raster holds the number of the lake in place of a displacement.
    let [_, numbers] = original.moved(scene.crs, |p| lakes.lake_at(p).map_or(-1.0, |lake| lake as f64))?;
    for i in 0..numbers.samples.len() {
        let lake = numbers.sample_f64(0, i % numbers.info.width, i / numbers.info.width);
        if let Some(lake) = lake.filter(|lake| *lake >= 0.0).map(|lake| lake as usize) {
            out.resize(out.len().max(lake + 1), Vec::new());
            out[lake].push(i);
        }
    }
    Ok(out)
}

/// Lowers all nodes of a set to its lowest displacement; returns whether any node was lowered.
fn sink(sets: &[Vec<usize>], u: &mut [f64]) -> bool {
    let mut sank = false;
    for set in sets {
        let [low, high] = set.iter().fold([f64::MAX, f64::MIN], |[a, b], n| [a.min(u[*n]), b.max(u[*n])]);
        if low < high {
            sank = true;
            set.iter().for_each(|n| u[*n] = low);
        }
    }
    sank
}
