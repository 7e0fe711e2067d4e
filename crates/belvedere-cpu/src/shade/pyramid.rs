//! Terrain prepared for shading: slope, height and openness per node, and their averages over ever larger cells.

use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};
use glam::Vec4;
use rayon::prelude::*;

/// dz/dx, dz/dy, height, openness (0..=1.2, 1 = level ground).
pub(crate) type NodeShade = Vec4;

#[derive(Debug)]
struct Level {
    cols: usize,
    rows: usize,
    nodes: Vec<NodeShade>,
}

/// Levels of [`NodeShade`]; level k averages 2^k x 2^k nodes.
#[derive(Debug)]
pub(crate) struct Pyramid {
    levels: Vec<Level>,
}

impl Pyramid {
    /// * `displaced`: moves the surface before its slopes are taken (`shading = deformed`); `None` = the map.
    pub(crate) fn new(hf: &Heightfield, displaced: Option<&(dyn Fn(DVec3) -> Option<DVec3> + Sync)>) -> Self {
        let (cols, rows) = (hf.cols(), hf.rows());
        let mut nodes = vec![NodeShade::ZERO; cols * rows];
        nodes.par_chunks_mut(cols).enumerate().for_each(|(r, row)| {
            for (c, n) in row.iter_mut().enumerate() {
                let i = r * cols + c;
                if hf.states()[i] != NodeState::Void {
                    let slope = match displaced {
                        Some(map) => deformed_slope(hf, c, r, map),
                        None => map_slope(hf, c, r),
                    };
                    *n = Vec4::new(slope.x as f32, slope.y as f32, hf.heights()[i], 1.0);
                }
            }
        });
        // Holes count for nothing in the averages; w carries the weight until openness is known.
        for (n, s) in nodes.iter_mut().zip(hf.states().iter()) {
            if *s == NodeState::Void {
                *n = NodeShade::ZERO;
            }
        }
        let mut levels = vec![Level { cols, rows, nodes }];
        while let Some(last) = levels.last()
            && last.cols.max(last.rows) > 2
            && levels.len() < 12
        {
            levels.push(last.halved());
        }
        let mut out = Self { levels };
        out.fill_holes();
        out.set_openness(hf.spacing().min_element() as f32);
        out
    }

    /// Gives holes the average around them, so that interpolation beside them sees no height of 0.
    fn fill_holes(&mut self) {
        for k in (0..self.levels.len() - 1).rev() {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            let (to, from) = (&mut fine[k], &coarse[0]);
            let cols = to.cols;
            to.nodes.par_iter_mut().enumerate().filter(|(_, n)| n.w == 0.0).for_each(|(i, n)| {
                *n = from.nodes[i / cols / 2 * from.cols + i % cols / 2];
            });
        }
    }

    /// Openness: how far the ground stands above its wider surroundings, at three scales. Our stand-in for sky visibility.
    fn set_openness(&mut self, spacing: f32) {
        let top = self.levels.len() - 1;
        let scales = [(1usize, 0.3f32), (3, 0.5), (5, 0.5)].map(|(k, share)| (k.min(top), share));
        let mean: Vec<Vec<f32>> = scales.iter().map(|&(k, _)| self.smooth_heights(k)).collect();
        for level in 0..=top {
            let (cols, coarse) = (self.levels[level].cols, level > 0);
            let (fine, rest) = self.levels.split_at_mut(level);
            let this = &mut rest[0];
            this.nodes.par_iter_mut().enumerate().for_each(|(i, n)| {
                n.w = if coarse {
                    fine[level - 1].mean_of(i % cols, i / cols, |n| n.w)
                } else {
                    let above: f32 = scales
                        .iter()
                        .zip(&mean)
                        .map(|(&(k, share), m)| share * (n.z - m[i]) / (spacing * (1u32 << k) as f32))
                        .sum();
                    let x = above / 0.16;
                    1.0 + 0.42 * (x / (1.0 + x * x).sqrt()).min(0.45)
                };
            });
        }
    }

    /// Heights of level `k` brought back to level 0 step by step, which makes them smooth.
    fn smooth_heights(&self, k: usize) -> Vec<f32> {
        let mut values: Vec<f32> = self.levels[k].nodes.iter().map(|n| n.z).collect();
        for level in (0..k).rev() {
            let (from, to) = (&self.levels[level + 1], &self.levels[level]);
            let mut next = vec![0.0; to.cols * to.rows];
            next.par_chunks_mut(to.cols).enumerate().for_each(|(r, row)| {
                let (r0, r1, v) = from.tap_row(0.5 * (r as f32 - 0.5));
                for (c, out) in row.iter_mut().enumerate() {
                    let (c0, c1, u) = from.tap_col(0.5 * (c as f32 - 0.5));
                    let at = |c: usize, r: usize| values[r * from.cols + c];
                    let (n, s) =
                        (at(c0, r0) + u * (at(c1, r0) - at(c0, r0)), at(c0, r1) + u * (at(c1, r1) - at(c0, r1)));
                    *out = n + v * (s - n);
                }
            });
            values = next;
        }
        values
    }

    /// Shade at fractional column and row, averaged over about `footprint` cells.
    #[inline]
    pub(crate) fn sample(&self, col: f32, row: f32, footprint: f32) -> NodeShade {
        let top = (self.levels.len() - 1) as f32;
        let lod = if footprint > 1.0 { footprint.log2().min(top) } else { 0.0 };
        let k = lod as usize;
        let fine = self.bilinear(k, col, row);
        let share = lod - k as f32;
        if share < 1e-3 { fine } else { fine + share * (self.bilinear(k + 1, col, row) - fine) }
    }

    #[inline]
    fn bilinear(&self, k: usize, col: f32, row: f32) -> NodeShade {
        let level = &self.levels[k];
        // Node i of level k lies at (i + 0.5) 2^k - 0.5 of level 0.
        let step = 1.0 / (1u32 << k) as f32;
        let (c0, c1, u) = level.tap_col((col + 0.5) * step - 0.5);
        let (r0, r1, v) = level.tap_row((row + 0.5) * step - 0.5);
        let (n, s) = (&level.nodes[r0 * level.cols..], &level.nodes[r1 * level.cols..]);
        let (a, b) = (n[c0] + u * (n[c1] - n[c0]), s[c0] + u * (s[c1] - s[c0]));
        a + v * (b - a)
    }
}

impl Level {
    fn halved(&self) -> Self {
        let (cols, rows) = (self.cols.div_ceil(2), self.rows.div_ceil(2));
        let mut nodes = vec![NodeShade::ZERO; cols * rows];
        nodes.par_chunks_mut(cols).enumerate().for_each(|(r, row)| {
            for (c, n) in row.iter_mut().enumerate() {
                let mut sum = NodeShade::ZERO;
                for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let (x, y) = ((2 * c + i).min(self.cols - 1), (2 * r + j).min(self.rows - 1));
                    let v = self.nodes[y * self.cols + x];
                    sum += Vec4::new(v.x * v.w, v.y * v.w, v.z * v.w, v.w);
                }
                *n = if sum.w > 0.0 { (sum / sum.w).with_w(1.0) } else { NodeShade::ZERO };
            }
        });
        Self { cols, rows, nodes }
    }

    fn mean_of(&self, col: usize, row: usize, value: impl Fn(&NodeShade) -> f32) -> f32 {
        let at = |i: usize, j: usize| {
            let (x, y) = ((2 * col + i).min(self.cols - 1), (2 * row + j).min(self.rows - 1));
            value(&self.nodes[y * self.cols + x])
        };
        0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
    }

    fn tap_col(&self, x: f32) -> (usize, usize, f32) {
        tap(x, self.cols)
    }

    fn tap_row(&self, y: f32) -> (usize, usize, f32) {
        tap(y, self.rows)
    }
}

#[inline]
fn tap(x: f32, n: usize) -> (usize, usize, f32) {
    let x = x.clamp(0.0, (n - 1) as f32);
    let i = x as usize;
    (i, (i + 1).min(n - 1), x - i as f32)
}

/// Slope by central differences; one-sided beside holes and the border.
fn map_slope(hf: &Heightfield, c: usize, r: usize) -> DVec2 {
    let here = hf.heights()[r * hf.cols() + c];
    let at = |c: usize, r: usize| {
        let i = r * hf.cols() + c;
        (hf.states()[i] != NodeState::Void).then(|| hf.heights()[i])
    };
    let along = |before: Option<f32>, after: Option<f32>, step: f64| {
        let span = f64::from(u8::from(before.is_some()) + u8::from(after.is_some())) * step;
        if span == 0.0 { 0.0 } else { f64::from(after.unwrap_or(here) - before.unwrap_or(here)) / span }
    };
    let west = c.checked_sub(1).and_then(|c| at(c, r));
    let east = (c + 1 < hf.cols()).then(|| at(c + 1, r)).flatten();
    let north = r.checked_sub(1).and_then(|r| at(c, r));
    let south = (r + 1 < hf.rows()).then(|| at(c, r + 1)).flatten();
    DVec2::new(along(west, east, hf.spacing().x), along(south, north, hf.spacing().y))
}

/// Slope of the displaced surface.
fn deformed_slope(hf: &Heightfield, c: usize, r: usize, map: &(dyn Fn(DVec3) -> Option<DVec3> + Sync)) -> DVec2 {
    let at = |c: usize, r: usize| hf.node(c, r).and_then(map);
    let Some(here) = at(c, r) else { return map_slope(hf, c, r) };
    let difference = |before: Option<DVec3>, after: Option<DVec3>| after.unwrap_or(here) - before.unwrap_or(here);
    let east = difference(c.checked_sub(1).and_then(|c| at(c, r)), (c + 1 < hf.cols()).then(|| at(c + 1, r)).flatten());
    let north =
        difference((r + 1 < hf.rows()).then(|| at(c, r + 1)).flatten(), r.checked_sub(1).and_then(|r| at(c, r)));
    let n = east.cross(north);
    let n = if n.z < 0.0 { -n } else { n };
    // Walls steeper than about 87 degrees shade like that.
    let z = n.z.max(0.05 * n.length());
    if z > 0.0 { DVec2::new(-n.x / z, -n.y / z) } else { DVec2::ZERO }
}
