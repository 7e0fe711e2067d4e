//! Slopes and heights of nodes of the ground, plane by plane: plain loops, which compilers turn into vector instructions.

use crate::simd::Kernel;
use belvedere_scene::Heightfield;
use glam::Vec4;
use std::ops::Range;

/// A row of nodes, plane by plane.
#[derive(Debug, Clone)]
pub(crate) struct Planes {
    /// dz/dx, dz/dy, height.
    pub(crate) xyz: [Vec<f32>; 3],
    /// Fourth plane: see [`Surface::row`] and [`Level`].
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

    /// The same range of all planes.
    #[inline(always)]
    pub(crate) fn part(&mut self, places: Range<usize>) -> [&mut [f32]; 4] {
        let [x, y, z] = &mut self.xyz;
        [&mut x[places.clone()], &mut y[places.clone()], &mut z[places.clone()], &mut self.w[places]]
    }
}

/// Nodes away from voids and borders.
pub(crate) struct Inside<'a> {
    pub(crate) hf: &'a Heightfield,
    pub(crate) heights: &'a [f32],
    pub(crate) row: usize,
    pub(crate) columns: Range<usize>,
    /// The column at the first place.
    pub(crate) first: usize,
    pub(crate) out: &'a mut Planes,
}

impl Kernel for Inside<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { hf, heights, row, columns, first, out } = self;
        let (cols, n) = (hf.cols(), columns.len());
        let per = (0.5 / hf.spacing()).as_vec2();
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

/// Averages of nodes away from voids and borders. The sum of central differences along a row or a column of a square reduces to the
/// two nodes on either side of each end.
pub(crate) struct Inner<'a> {
    pub(crate) hf: &'a Heightfield,
    pub(crate) heights: &'a [f32],
    pub(crate) side: usize,
    pub(crate) row: usize,
    pub(crate) columns: Range<usize>,
    /// The column at the first place.
    pub(crate) first: usize,
    pub(crate) out: &'a mut Planes,
}

/// Columns of the ground that are summed at a time.
pub(crate) const CHUNK: usize = 256;

impl Kernel for Inner<'_> {
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

impl Inner<'_> {
    /// * `SIDE`: `side` again, if it is one of the sizes with a version of its own, else 0.
    #[inline(always)]
    fn squares<const SIDE: usize>(self, side: usize) {
        let Self { hf, heights, row, columns, first, out, .. } = self;
        let side = if SIDE > 0 { SIDE } else { side };
        let per = (0.5 / hf.spacing()).as_vec2() / (side * side) as f32;
        let share = 1.0 / (side * side) as f32;
        let cols = hf.cols();
        for from in columns.clone().step_by(CHUNK / side) {
            let to = (from + CHUNK / side).min(columns.end);
            let (c0, n) = (from * side - 1, (to - from) * side + 2);
            // Sums down the columns, and the remainders of the rows at either end of the square.
            let (mut sum, mut ends) = ([0.0f32; CHUNK + 2], [0.0f32; CHUNK + 2]);
            let line = |r: usize| &heights[r * cols + c0..][..n];
            let top = row * side;
            let (north0, south1) = (line(top - 1), line(top + side));
            if SIDE > 0 {
                // All rows are read at once: they lie far apart in memory, and the reads overlap.
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
