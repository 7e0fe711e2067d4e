//! Rows of nodes of the ground, plane by plane: plain loops, which compilers turn into vector instructions.

use crate::shade::ground::surface::{MipPyramid, Surface, tap};
use crate::simd::{self, Kernel};
use glam::Vec4;
use std::ops::Range;

/// A row of nodes, plane by plane.
#[derive(Debug, Clone)]
pub(crate) struct Planes {
    /// dz/dx, dz/dy, height.
    pub(crate) xyz: [Vec<f32>; 3],
    /// What comes fourth: see [`Surface::row`] and [`Level`].
    pub(crate) w: Vec<f32>,
}

impl Planes {
    pub(crate) fn new(n: usize) -> Self {
        Self { xyz: [vec![0.0; n], vec![0.0; n], vec![0.0; n]], w: vec![0.0; n] }
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vec4 {
        let [x, y, z] = &self.xyz;
        Vec4::new(x[i], y[i], z[i], self.w[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vec4) {
        let [x, y, z] = &mut self.xyz;
        (x[i], y[i], z[i], self.w[i]) = (v.x, v.y, v.z, v.w);
    }

    /// The same places of all planes.
    #[inline(always)]
    pub(crate) fn part(&mut self, places: Range<usize>) -> [&mut [f32]; 4] {
        let [x, y, z] = &mut self.xyz;
        [&mut x[places.clone()], &mut y[places.clone()], &mut z[places.clone()], &mut self.w[places]]
    }
}

/// Nodes away from voids and borders.
pub(crate) struct Inside<'a, 's> {
    pub(crate) surface: &'a Surface<'s>,
    pub(crate) row: usize,
    pub(crate) columns: Range<usize>,
    /// The column at the first place.
    pub(crate) first: usize,
    pub(crate) out: &'a mut Planes,
}

impl Kernel for Inside<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { surface, row, columns, first, out } = self;
        let (cols, n, heights) = (surface.hf.cols(), columns.len(), surface.heights());
        let per = (0.5 / surface.hf.spacing()).as_vec2();
        let here = row * cols + columns.start;
        let (north, south) = (&heights[here - cols..][..n], &heights[here + cols..][..n]);
        let (west, middle, east) = (&heights[here - 1..][..n], &heights[here..][..n], &heights[here + 1..][..n]);
        let [x, y, z, w] = out.part(columns.start - first..columns.end - first);
        let (x, y, z, w) = (&mut x[..n], &mut y[..n], &mut z[..n], &mut w[..n]);
        for i in 0..n {
            x[i] = (east[i] - west[i]) * per.x;
            y[i] = (north[i] - south[i]) * per.y;
            z[i] = middle[i];
            w[i] = 1.0;
        }
    }
}

/// Averages of nodes away from voids and borders. The central differences along a row or a column of a square cancel but for
/// the two nodes on either side of each end.
pub(crate) struct Inner<'a, 's> {
    pub(crate) surface: &'a Surface<'s>,
    pub(crate) side: usize,
    pub(crate) row: usize,
    pub(crate) columns: Range<usize>,
    /// The column at the first place.
    pub(crate) first: usize,
    pub(crate) out: &'a mut Planes,
}

/// Columns of the ground that are summed up at a time.
pub(crate) const CHUNK: usize = 256;

impl Kernel for Inner<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        match self.side {
            2 => self.squares::<2>(2),
            4 => self.squares::<4>(4),
            8 => self.squares::<8>(8),
            side => self.squares::<0>(side),
        }
    }
}

impl Inner<'_, '_> {
    /// * `SIDE`: the side again, if it is one of those that are compiled apart, else 0.
    #[inline(always)]
    fn squares<const SIDE: usize>(self, side: usize) {
        let Self { surface, row, columns, first, out, .. } = self;
        let side = if SIDE > 0 { SIDE } else { side };
        let per = (0.5 / surface.hf.spacing()).as_vec2() / (side * side) as f32;
        let share = 1.0 / (side * side) as f32;
        let (cols, heights) = (surface.hf.cols(), surface.heights());
        for from in columns.clone().step_by(CHUNK / side) {
            let to = (from + CHUNK / side).min(columns.end);
            let (c0, n) = (from * side - 1, (to - from) * side + 2);
            // Sums down the columns, and what the rows at either end of the square leave.
            let (mut sum, mut ends) = ([0.0f32; CHUNK + 2], [0.0f32; CHUNK + 2]);
            let line = |r: usize| &heights[r * cols + c0..][..n];
            let top = row * side;
            let (north0, south1) = (line(top - 1), line(top + side));
            if SIDE > 0 {
                // All rows at once: they lie far apart in memory, and none has to wait for another.
                let rows: [&[f32]; SIDE] = std::array::from_fn(|k| line(top + k));
                for i in 0..n {
                    let mut down = 0.0;
                    for row in &rows {
                        down += row[i];
                    }
                    sum[i] = down;
                    ends[i] = (north0[i] - rows[SIDE - 1][i]) + (rows[0][i] - south1[i]);
                }
            } else {
                for r in top..top + side {
                    for (sum, h) in sum.iter_mut().zip(line(r)) {
                        *sum += h;
                    }
                }
                let (south0, north1) = (line(top + side - 1), line(top));
                for i in 0..n {
                    ends[i] = (north0[i] - south0[i]) + (north1[i] - south1[i]);
                }
            }
            let [x, y, z, w] = out.part(from - first..to - first);
            for (i, (((x, y), z), w)) in x.iter_mut().zip(y).zip(z).zip(w).enumerate() {
                let (sum, ends) = (&sum[i * side..][..side + 2], &ends[i * side..][..side + 2]);
                let east = (sum[side] - sum[0]) + (sum[side + 1] - sum[1]);
                let (mut north, mut height) = (0.0, 0.0);
                for k in 1..side + 1 {
                    north += ends[k];
                    height += sum[k];
                }
                (*x, *y, *z, *w) = (east * per.x, north * per.y, height * share, 1.0);
            }
        }
    }
}

/// Averages of the finest stored level at nodes of a finer one, row after row.
pub(crate) struct Between {
    /// Nodes of the finer level to one of the stored.
    step: f32,
    /// Nodes west and east of each column, and the share of the way.
    taps: Vec<(usize, usize, f32)>,
    /// Rows of the stored level brought to the columns, those last asked for.
    lines: [(usize, Planes); 2],
}

impl Between {
    /// * `k`: the finer level, of whose columns there are `n` from `first` on.
    pub(crate) fn new(means: &MipPyramid, k: usize, first: usize, n: usize) -> Self {
        let step = 1.0 / (1u32 << (means.first - k)) as f32;
        let taps = (first..first + n).map(|c| tap(Self::place(step, c), means.levels[0].cols)).collect();
        Self { step, taps, lines: [(usize::MAX, Planes::new(n)), (usize::MAX, Planes::new(n))] }
    }

    fn place(step: f32, i: usize) -> f32 {
        (i as f32 + 0.5) * step - 0.5
    }

    /// A row of the finer level.
    pub(crate) fn row(&mut self, means: &MipPyramid, row: usize, out: &mut Planes) {
        let (north, south, v) = tap(Self::place(self.step, row), means.levels[0].rows);
        if self.lines[1].0 == north {
            self.lines.swap(0, 1);
        }
        for (line, row) in self.lines.iter_mut().zip([north, south]) {
            if line.0 != row {
                line.0 = row;
                means.levels[0].between_columns(row, &self.taps, &mut line.1);
            }
        }
        simd::run(Mix { lines: [&self.lines[0].1, &self.lines[1].1], v, out });
    }
}

/// Mixes two rows.
struct Mix<'a> {
    lines: [&'a Planes; 2],
    v: f32,
    out: &'a mut Planes,
}

impl Kernel for Mix<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { lines: [north, south], v, out } = self;
        let planes = out.xyz.iter_mut().zip(&north.xyz).zip(&south.xyz);
        for ((out, north), south) in planes.chain([((&mut out.w, &north.w), &south.w)]) {
            for ((out, a), b) in out.iter_mut().zip(north).zip(south) {
                *out = a + v * (b - a);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec2;
    use belvedere_scene::{Heightfield, NodeState};

    #[test]
    fn rows_between_stored_nodes_are_those_of_their_places_in_any_order() {
        let (cols, rows) = (83, 61);
        let heights = (0..cols * rows).map(|i| 500.0 + 90.0 * (i as f32 * 0.37).sin() + (i / cols) as f32).collect();
        let states = vec![NodeState::Measured; cols * rows];
        let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(10.0), cols, rows, heights, states).unwrap();
        let means = MipPyramid::new(&Surface::of_map(&hf));
        assert_eq!(means.first, 1);
        let (first, n) = (5, 70);
        let (mut between, mut out) = (Between::new(&means, 0, first, n), Planes::new(n));
        for row in (0..rows).chain((0..rows).rev()).chain([40, 3, 3, 4, 60, 0]) {
            between.row(&means, row, &mut out);
            for i in 0..n {
                let want = means.at(1, (first + i) as f32, row as f32);
                assert!((out.get(i) - want).abs().max_element() < 1e-3, "{row}, {i}: {} {want}", out.get(i));
            }
        }
    }
}
