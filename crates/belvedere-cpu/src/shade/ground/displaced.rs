//! Heights and light of ground that a stage moves vertically; the light is kept between frames where the ground did not change.

use crate::cache::GroundCache;
use crate::shade::ground::lit::{LitGround, LitKey};
use crate::shade::ground::shadow::Shadows;
use crate::shade::ground::surface::{MipPyramid, Surface};
use belvedere_core::{DVec3, Stage, TerrainDisocclusion};
use belvedere_scene::{Heightfield, NodeState};
use belvedere_sight::Fast;
use rayon::prelude::*;
use std::sync::Arc;

/// Displacements are rounded to multiples of this share of the node spacing before lighting. The error of a slope is at most half of
/// that, far below an 8-bit step, and ground that hardly moves has exactly the same light in the next frame.
const STEP: f64 = 1.0 / 4096.0;

/// Side of the squares that are compared between frames, nodes.
const SQUARE: usize = 64;

/// Distance, in nodes, up to which the surroundings of a point affect its light: averages over 32 nodes, smoothed from level
/// to level.
const SURROUNDINGS: usize = 256;

/// Heights of the ground after `stages`, which move points along z alone.
pub(crate) fn heights(hf: &Heightfield, stages: &[Stage]) -> Vec<f32> {
    let step = hf.spacing().min_element() * STEP;
    let rounded = |h: f32, by: f64| (f64::from(h) + (by / step).round() * step) as f32;
    if let [Fast::Ground(ground)] = *stages.iter().map(Fast::of).collect::<Vec<_>>() {
        return lifted(hf, ground, &rounded);
    }
    let moved = |p: DVec3| stages.iter().try_fold(p, |p, s| s.apply(p)).ok().filter(|p| p.is_finite());
    let mut heights = hf.heights().to_vec();
    heights.par_chunks_mut(hf.cols()).enumerate().for_each(|(r, row)| {
        for (c, h) in row.iter_mut().enumerate() {
            if let Some((p, q)) = hf.node(c, r).and_then(|p| Some((p, moved(p)?))) {
                *h = rounded(*h, q.z - p.z);
            }
        }
    });
    heights
}

/// The same for one stage whose displacement is bilinear on a grid: interpolated row by row.
fn lifted(hf: &Heightfield, ground: &TerrainDisocclusion, rounded: &(impl Fn(f32, f64) -> f32 + Sync)) -> Vec<f32> {
    let grid = ground.grid();
    // Cell and fraction of a node on the grid along an axis; `None` off the grid.
    let place = |g: f64, n: usize| {
        (g >= 0.0 && g <= (n - 1) as f64).then(|| {
            let i = (g as usize).min(n - 2);
            (i, g - i as f64)
        })
    };
    let at = |c: usize, r: usize| grid.grid_from_scene(hf.node_xy(c, r));
    let columns: Vec<_> = (0..hf.cols()).map(|c| place(at(c, 0).x, grid.cols())).collect();
    let mut heights = hf.heights().to_vec();
    let rows = heights.par_chunks_mut(hf.cols()).enumerate();
    rows.for_each_init(Vec::new, |line: &mut Vec<f64>, (r, row)| {
        let Some((north, v)) = place(at(0, r).y, grid.rows()) else { return };
        let values = &grid.values()[north * grid.cols()..][..2 * grid.cols()];
        let (north, south) = values.split_at(grid.cols());
        line.clear();
        line.extend(north.iter().zip(south).map(|(n, s)| n + v * (s - n)));
        for (h, column) in row.iter_mut().zip(&columns) {
            if let Some((i, u)) = *column {
                *h = rounded(*h, line[i] + u * (line[i + 1] - line[i]));
            }
        }
    });
    heights
}

/// Averages and light of ground with these heights.
#[derive(Debug, Clone)]
pub(crate) struct DisplacedLight {
    pub(crate) heights: Arc<Vec<f32>>,
    pub(crate) means: Arc<MipPyramid>,
    pub(crate) shadows: Option<Arc<Shadows>>,
    pub(crate) lit: Arc<LitGround>,
}

/// Averages and light of displaced ground. Tiles of the last frame are reused unless their ground, or the ground that affects them,
/// has changed; the result does not depend on what was cached.
/// * `finer`: see [`LitGround::new`]; `cast`: the shadows of this ground.
pub(crate) fn light(
    cache: &GroundCache<LitKey, DisplacedLight>,
    hf: &Arc<Heightfield>,
    surface: &Surface<'_>,
    heights: &Arc<Vec<f32>>,
    (key, finer): (LitKey, u32),
    cast: &dyn Fn(&MipPyramid) -> Option<Arc<Shadows>>,
) -> DisplacedLight {
    let old = cache.take(hf, &key).filter(|old| !old.lit.is_full());
    let old = old.map(|old| (Squares::new(hf, &old.heights, heights), old));
    let light = match old {
        Some((changed, old)) if changed.is_empty() => old,
        old => {
            let means = Arc::new(MipPyramid::new(surface));
            let shadows = cast(&means);
            // Voids take averages from any distance, and shadows may reach far: then no tile is reused.
            let reach = shadows.as_ref().map_or(0.0, |shadows| shadows.reach());
            let near = reach <= SURROUNDINGS as f64 * hf.spacing().min_element()
                && hf.states().each().is_none_or(|s| !s.contains(&NodeState::Void));
            let lit = old.filter(|_| near).and_then(|(changed, old)| {
                let mut lit = Arc::try_unwrap(old.lit).ok()?;
                lit.retain(|reach| !changed.touch(reach));
                Some(lit)
            });
            let lit = lit.unwrap_or_else(|| LitGround::new(hf.cols(), hf.rows(), means.top(), finer));
            DisplacedLight { heights: heights.clone(), means, shadows, lit: Arc::new(lit) }
        }
    };
    cache.put(hf, key, light.clone());
    light
}

/// Squares of nodes, and whether two grounds differ there.
struct Squares {
    across: usize,
    differ: Vec<bool>,
}

impl Squares {
    fn new(hf: &Heightfield, a: &[f32], b: &[f32]) -> Self {
        let (cols, across) = (hf.cols(), hf.cols().div_ceil(SQUARE));
        let rows = a.par_chunks(cols * SQUARE).zip(b.par_chunks(cols * SQUARE));
        let differ = rows.flat_map_iter(|(a, b)| {
            let mut differ = vec![false; across];
            for (a, b) in a.chunks(cols).zip(b.chunks(cols)) {
                for ((differ, a), b) in differ.iter_mut().zip(a.chunks(SQUARE)).zip(b.chunks(SQUARE)) {
                    *differ |= a != b;
                }
            }
            differ
        });
        Self { across, differ: differ.collect() }
    }

    fn is_empty(&self) -> bool {
        !self.differ.contains(&true)
    }

    /// Whether the light of points in these columns and rows (first and last) depends on a square that differs.
    fn touch(&self, reach: [[usize; 2]; 2]) -> bool {
        let [columns, rows] =
            reach.map(|[from, to]| from.saturating_sub(SURROUNDINGS) / SQUARE..(to + SURROUNDINGS) / SQUARE + 1);
        let down = self.differ.len() / self.across;
        (rows.start..rows.end.min(down)).any(|r| {
            let row = &self.differ[r * self.across..][..self.across];
            row[columns.start.min(self.across)..columns.end.min(self.across)].contains(&true)
        })
    }
}

#[cfg(test)]
mod tests;
