//! Cast shadows: the share of the sun's disc that every node of the ground sees.
//!
//! Rays of the sun over the ground are parallel lines on the map. Each line is swept once, away from the sun, with the height of the
//! shadow that the ground so far casts: every node is visited a constant number of times.

use crate::shade::ground::surface::{MipPyramid, Surface};
use belvedere_composite::color::smoothstep;
use belvedere_core::DVec2;
use belvedere_scene::{Light, NodeState};
use rayon::prelude::*;

/// Angular radius of the sun, radians.
const SUN_RADIUS: f64 = 0.004_65;

/// How shadows look.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Softness {
    /// Angular radius of the light, radians: shadows are as soft as it is wide.
    radius: f64,
    /// Length on the ground at which shadows have faded, scene units.
    reach: f64,
}

impl Softness {
    /// Those of the sun.
    pub(crate) const SUN: Self = Self { radius: SUN_RADIUS, reach: f64::INFINITY };
    /// Those of painters of panoramas: soft and short, so that they model forms and hide none (Novat; the figures are ours).
    pub(crate) const PAINTED: Self = Self { radius: 0.13, reach: 2600.0 };
}

/// Light on the nodes of one level and its averages on coarser ones, 0 = shadow, 255 = the whole sun.
#[derive(Debug)]
pub(crate) struct Shadows {
    /// Level of the finest grid.
    first: usize,
    levels: Vec<(usize, usize, Vec<u8>)>,
    reach: f64,
}

impl Shadows {
    /// Shadows of the full ground, or of the finest stored averages where the ground is very large.
    pub(crate) fn new(surface: &Surface<'_>, means: &MipPyramid, light: &Light, soft: Softness) -> Self {
        let hf = surface.hf;
        let first = if means.first == 1 { 0 } else { means.first };
        let spacing = hf.spacing() * f64::from(1u32 << first);
        let (cols, rows, lit) = if first == 0 {
            let solid = |i: usize| hf.states()[i] != NodeState::Void;
            let heights = surface.heights();
            let at = |i: usize| if solid(i) { heights[i] } else { f32::NEG_INFINITY };
            (hf.cols(), hf.rows(), sweep([hf.cols(), hf.rows()], spacing, (light, soft), &at))
        } else {
            let [cols, rows] = means.size(first);
            (cols, rows, sweep([cols, rows], spacing, (light, soft), &|i| means.node(first, i % cols, i / cols).z))
        };
        let mut levels = vec![(cols, rows, lit)];
        while let Some((cols, rows, lit)) = levels.last()
            && cols.max(rows) > &1
        {
            levels.push(halved(*cols, *rows, lit));
        }
        Self { first, levels, reach: soft.reach }
    }

    /// Length on the ground at which shadows have faded, scene units.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// The share of the sun that the nodes of a row of level `k` see, from column `first`.
    pub(crate) fn share_row(&self, k: usize, row: usize, first: usize, out: &mut [f32]) {
        let (cols, rows, lit) = &self.levels[k.saturating_sub(self.first).min(self.levels.len() - 1)];
        if k >= self.first {
            for (i, out) in out.iter_mut().enumerate() {
                *out = f32::from(lit[row.min(rows - 1) * cols + (first + i).min(cols - 1)]) / 255.0;
            }
            return;
        }
        // Finer than the stored level: interpolated between its nodes.
        let step = 1.0 / (1u32 << (self.first - k)) as f32;
        let tap = |x: usize, n: usize| {
            let x = ((x as f32 + 0.5) * step - 0.5).clamp(0.0, (n - 1) as f32);
            (x as usize, (x as usize + 1).min(n - 1), x.fract())
        };
        let (r0, r1, v) = tap(row, *rows);
        for (i, out) in out.iter_mut().enumerate() {
            let (c0, c1, u) = tap(first + i, *cols);
            let at = |c: usize, r: usize| f32::from(lit[r * cols + c]);
            let (a, b) = (at(c0, r0) + u * (at(c1, r0) - at(c0, r0)), at(c0, r1) + u * (at(c1, r1) - at(c0, r1)));
            *out = (a + v * (b - a)) / 255.0;
        }
    }
}

fn halved(cols: usize, rows: usize, fine: &[u8]) -> (usize, usize, Vec<u8>) {
    let (w, h) = (cols.div_ceil(2), rows.div_ceil(2));
    let at = |c: usize, r: usize| u32::from(fine[r.min(rows - 1) * cols + c.min(cols - 1)]);
    let mean = |c: usize, r: usize| (at(c, r) + at(c + 1, r) + at(c, r + 1) + at(c + 1, r + 1) + 2) / 4;
    (w, h, (0..w * h).map(|i| mean(i % w * 2, i / w * 2) as u8).collect())
}

/// Ground that casts a shadow: height of the sun's ray over it at the current step, and the distance to it, scene units.
#[derive(Debug, Clone, Copy)]
struct Edge {
    height: f64,
    far: f64,
}

/// Directions of the sweep: grid steps along the axis that the sun's rays cross fastest, and across.
struct Lines {
    /// Whether the sweep runs along columns (else along rows).
    along_columns: bool,
    /// Whether it starts at the last column or row.
    from_end: bool,
    /// Nodes along and across.
    size: [usize; 2],
    /// Shift across per step along.
    lean: f64,
    /// Fall of the sun's ray per step, height units, and the length of the step on the ground.
    drop: f64,
    step: f64,
    /// Number across of the first line at step 0.
    first: i64,
    count: usize,
}

impl Lines {
    fn new([cols, rows]: [usize; 2], spacing: DVec2, light: &Light) -> Self {
        // Away from the sun, in columns and rows.
        let away = DVec2::new(-light.azimuth.sin() / spacing.x, light.azimuth.cos() / spacing.y);
        let along_columns = away.x.abs() >= away.y.abs();
        let (main, side) = if along_columns { (away.x, away.y) } else { (away.y, away.x) };
        let (n, across) = if along_columns { (cols, rows) } else { (rows, cols) };
        let lean = side / main.abs();
        let cells = if along_columns { DVec2::new(1.0, lean) } else { DVec2::new(lean, 1.0) };
        let step = (cells * spacing).length();
        let shift = lean * (n - 1) as f64;
        let first = (-shift).min(0.0).floor() as i64;
        let last = (across - 1) as i64 + (-shift).max(0.0).ceil() as i64 + 1;
        let drop = step * light.altitude.tan();
        Self {
            along_columns,
            from_end: main < 0.0,
            size: [n, across],
            lean,
            drop,
            step,
            first,
            count: (last - first + 1) as usize,
        }
    }

    /// Index of the node at `t` steps from the sunny side and `j` across.
    fn index(&self, t: usize, j: usize) -> usize {
        let t = if self.from_end { self.size[0] - 1 - t } else { t };
        if self.along_columns { j * self.size[0] + t } else { t * self.size[1] + j }
    }

    /// Light along line `l`, one value per step, 255 outside the grid.
    fn light(
        &self,
        l: usize,
        (altitude, soft): (f64, Softness),
        height: &(dyn Fn(usize) -> f32 + Sync),
        out: &mut [u8],
    ) {
        let lowest = (altitude - soft.radius).max(0.0);
        let wide = (altitude + soft.radius).min(1.56).tan() - lowest.tan();
        // The ground whose ray runs highest, and the one before it, whose penumbra may not have ended.
        let mut edges = [Edge { height: f64::NEG_INFINITY, far: 0.0 }; 2];
        for (t, out) in out.iter_mut().enumerate() {
            let y = (self.first + l as i64) as f64 + self.lean * t as f64;
            let last = (self.size[1] - 1) as f64;
            // Lines just outside count as the border: nodes at the border lie between them and the first line inside.
            if y > -1.0 && y < last + 1.0 {
                let y = y.clamp(0.0, last);
                let j = (y as usize).min(self.size[1].saturating_sub(2));
                let share = y - j as f64;
                let [a, b] = [j, (j + 1).min(self.size[1] - 1)].map(|j| f64::from(height(self.index(t, j))));
                // A void beside the line counts only if the line meets it exactly.
                let z = if share == 0.0 {
                    a
                } else if share == 1.0 {
                    b
                } else {
                    a + share * (b - a)
                };
                if z > f64::NEG_INFINITY {
                    let light = |e: Edge| {
                        // The penumbra is as wide as the sun's disc makes it, and at least about a cell.
                        let width = (e.far * wide).max(self.drop * (0.5 * e.far / self.step).min(1.0));
                        let gone = smoothstep(0.4, 1.0, (e.far / soft.reach) as f32);
                        let left = if e.far > 0.0 { (0.5 + (z - e.height) / width).clamp(0.0, 1.0) } else { 1.0 };
                        left + (1.0 - left) * f64::from(gone)
                    };
                    let lights = edges.map(light);
                    *out = (255.0 * lights[0].min(lights[1]) + 0.5) as u8;
                    if z > edges[0].height {
                        if lights[0] < 1.0 {
                            edges[1] = edges[0];
                        }
                        edges[0] = Edge { height: z, far: 0.0 };
                    }
                }
            }
            for e in &mut edges {
                e.height -= self.drop;
                e.far += self.step;
                if e.far > soft.reach {
                    e.height = f64::NEG_INFINITY;
                }
            }
        }
    }
}

/// Share of the sun's disc that each node of a grid sees, 0..=255; minus infinity = void.
fn sweep(
    size: [usize; 2],
    spacing: DVec2,
    (light, soft): (&Light, Softness),
    height: &(dyn Fn(usize) -> f32 + Sync),
) -> Vec<u8> {
    let mut out = vec![0u8; size[0] * size[1]];
    if light.altitude <= 0.0 {
        return out;
    }
    let altitude = light.altitude.clamp(2.0 * SUN_RADIUS, 1.55);
    let lines = Lines::new(size, spacing, &Light { altitude, ..*light });
    let n = lines.size[0];
    let mut lit = vec![255u8; lines.count * n];
    lit.par_chunks_mut(n).enumerate().for_each(|(l, row)| lines.light(l, (altitude, soft), height, row));
    let at = |t: usize, j: usize| {
        // Interpolates between the two lines beside the node.
        let y = j as f64 - lines.lean * t as f64 - lines.first as f64;
        let (l, share) = (y as usize, (y.fract() * 256.0) as u32);
        let [a, b] = [l, (l + 1).min(lines.count - 1)].map(|l| u32::from(lit[l * n + t]));
        ((a * (256 - share) + b * share + 128) >> 8) as u8
    };
    let cols = size[0];
    out.par_chunks_mut(cols).enumerate().for_each(|(r, row)| {
        for (c, out) in row.iter_mut().enumerate() {
            let (t, j) = if lines.along_columns { (c, r) } else { (r, c) };
            *out = at(if lines.from_end { n - 1 - t } else { t }, j);
        }
    });
    out
}

#[cfg(test)]
mod tests;
