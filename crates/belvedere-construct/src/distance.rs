//! Distances to the nearest cell outside, exact, in time proportional to the number of cells.
//!
//! Source: Felzenszwalb, Huttenlocher 2012, "Distance transforms of sampled functions": the lower envelope of parabolas, axis by axis.

use rayon::prelude::*;

/// What lies around a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Around {
    /// Cells that are outside.
    Outside,
    /// Nothing.
    Nothing,
}

/// Squared distance from every cell to the nearest one that is not inside, middle to middle; infinite where there is none.
///
/// * `dims`: cells along x, y, z, x fastest; `spacing`: their distances, scene units, > 0.
pub(crate) fn squared(inside: &[bool], dims: [usize; 3], spacing: [f64; 3], around: Around) -> Vec<f32> {
    let far = f32::INFINITY;
    let mut out: Vec<f32> = inside.iter().map(|i| if *i { far } else { 0.0 }).collect();
    let [nx, ny, nz] = dims;
    // Along x and y within planes, which are independent.
    out.par_chunks_mut(nx * ny).for_each(|plane| {
        let mut line = Line::new(nx.max(ny), around);
        (0..ny).for_each(|y| line.pass(plane, y * nx, 1, nx, spacing[0]));
        (0..nx).for_each(|x| line.pass(plane, x, nx, ny, spacing[1]));
    });
    // Along z by columns, gathered row by row.
    let mut columns: Vec<f32> = vec![0.0; out.len()];
    columns.par_chunks_mut(nx * nz).enumerate().for_each(|(y, slab)| {
        let mut line = Line::new(nz, around);
        for z in 0..nz {
            let row = (z * ny + y) * nx;
            slab[z * nx..(z + 1) * nx].copy_from_slice(&out[row..row + nx]);
        }
        (0..nx).for_each(|x| line.pass(slab, x, nx, nz, spacing[2]));
    });
    for y in 0..ny {
        for z in 0..nz {
            let (row, slab) = ((z * ny + y) * nx, (y * nz + z) * nx);
            out[row..row + nx].copy_from_slice(&columns[slab..slab + nx]);
        }
    }
    out
}

/// Buffers for one line of cells.
struct Line {
    around: Around,
    values: Vec<f64>,
    /// Parabolas of the envelope: the cell at which each stands, and the coordinate from which on it is the lowest.
    stands: Vec<usize>,
    from: Vec<f64>,
}

impl Line {
    fn new(n: usize, around: Around) -> Self {
        Self { around, values: vec![0.0; n + 2], stands: vec![0; n + 2], from: vec![0.0; n + 3] }
    }

    /// Replaces a line of squared distances by the lower envelope of their parabolas along the line.
    fn pass(&mut self, data: &mut [f32], first: usize, stride: usize, n: usize, spacing: f64) {
        // One cell at each end of the line belongs to what is around.
        let end = if self.around == Around::Outside { 0.0 } else { f64::INFINITY };
        (self.values[0], self.values[n + 1]) = (end, end);
        for k in 0..n {
            self.values[k + 1] = f64::from(data[first + k * stride]);
        }
        let squared = spacing * spacing;
        // Parabolas of the envelope so far.
        let mut count = 0;
        for k in 0..n + 2 {
            let value = self.values[k];
            if value == f64::INFINITY {
                continue;
            }
            let mut from = f64::NEG_INFINITY;
            while count > 0 {
                let (a, b) = (k as f64, self.stands[count - 1] as f64);
                from = ((value - self.values[self.stands[count - 1]]) / squared + a * a - b * b) / (2.0 * (a - b));
                if from > self.from[count - 1] {
                    break;
                }
                count -= 1;
                from = f64::NEG_INFINITY;
            }
            (self.stands[count], self.from[count]) = (k, from);
            count += 1;
        }
        if count == 0 {
            return;
        }
        self.from[count] = f64::INFINITY;
        let mut at = 0;
        for k in 1..=n {
            while self.from[at + 1] < k as f64 {
                at += 1;
            }
            let off = (k as f64 - self.stands[at] as f64) * spacing;
            data[first + (k - 1) * stride] = (off * off + self.values[self.stands[at]]) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_all_voxels_compared() {
        let (dims, spacing) = ([13, 9, 11], [1.0, 1.7, 0.6]);
        let at = |i: usize| [i % 13, i / 13 % 9, i / 117];
        let inside: Vec<bool> = (0..13 * 9 * 11).map(|i| i * 7919 % 23 > 1).collect();
        for around in [Around::Outside, Around::Nothing] {
            let found = squared(&inside, dims, spacing, around);
            for i in 0..inside.len() {
                let p = at(i);
                let border =
                    (0..3).map(|a| (p[a] + 1).min(dims[a] - p[a]) as f64 * spacing[a]).fold(f64::MAX, f64::min);
                let others = (0..inside.len())
                    .filter(|j| !inside[*j])
                    .map(|j| (0..3).map(|a| ((p[a] as f64 - at(j)[a] as f64) * spacing[a]).powi(2)).sum::<f64>());
                let border = if around == Around::Outside { border * border } else { f64::INFINITY };
                let want = others.fold(border, f64::min);
                let want = if inside[i] { want } else { 0.0 };
                assert!((f64::from(found[i]) - want).abs() < 1e-4, "{p:?}: {} for {want}", found[i]);
            }
        }
        assert!(squared(&[true; 8], [2; 3], [1.0; 3], Around::Nothing).iter().all(|d| *d == f32::INFINITY));
    }
}
