//! Nodes between the nodes of the ground: values of these, interpolated by uniform cubic B-splines, whose slopes are smooth.

use crate::shade::ground::tiles::Line;

/// Interpolates planes along lines of columns and rows.
pub(crate) struct Finer {
    columns: Vec<Tap>,
    rows: Vec<Tap>,
    /// Nodes of a row of the coarser ones.
    across: usize,
}

/// First of four values, and their weights.
type Tap = (usize, [f32; 4]);

impl Finer {
    /// * `by`: levels between the lines and those of the values, which [`Line::around`] gives.
    pub(crate) fn new(by: u32, [columns, rows]: [Line; 2], [from_columns, from_rows]: [Line; 2]) -> Self {
        let taps = |line: Line, from: Line| {
            // Node i lies at (i + 0.5) / 2^by - 0.5 of the coarser ones.
            let place = |i: isize| (i as f32 + 0.5) / (1u32 << by) as f32 - 0.5;
            let tap = |i: usize| {
                let at = place(line.first() + i as isize) - from.first() as f32;
                let base = (at as usize).clamp(1, from.count - 3);
                (base - 1, weights(at - base as f32))
            };
            (0..line.count).map(tap).collect()
        };
        Self { columns: taps(columns, from_columns), rows: taps(rows, from_rows), across: from_columns.count }
    }

    /// Writes a plane, row by row.
    pub(crate) fn plane(&self, from: &[f32], to: &mut [f32]) {
        let n = self.columns.len();
        let lines: Vec<f32> = from
            .chunks_exact(self.across)
            .flat_map(|row| {
                self.columns.iter().map(|(first, w)| {
                    let v = &row[*first..*first + 4];
                    w[0] * v[0] + w[1] * v[1] + w[2] * v[2] + w[3] * v[3]
                })
            })
            .collect();
        for (out, (first, w)) in to.chunks_exact_mut(n).zip(&self.rows) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| &lines[(first + i) * n..][..n]);
            for i in 0..n {
                out[i] = w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i];
            }
        }
    }
}

/// Weights of the four values around a place, `t` of the way from the second to the third.
fn weights(t: f32) -> [f32; 4] {
    let u = 1.0 - t;
    let (a, d) = (u * u * u / 6.0, t * t * t / 6.0);
    let b = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
    [a, b, 1.0 - a - b - d, d]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::ground::tiles::Tiles;

    #[test]
    fn planes_that_are_linear_stay_so() {
        let tiles = Tiles::new([70, 50], 6, 3);
        for (k, tile) in [(0, [3, 2]), (1, [2, 2]), (2, [2, 1])] {
            let by = 3 - k as u32;
            let [columns, rows] = tiles.repeated(k, tile).map(|nodes| nodes.all());
            let (from_columns, from_rows) = (columns.around(by, 69), rows.around(by, 49));
            let value = |c: f32, r: f32| 3.0 + 0.7 * c - 1.3 * r;
            let line = |line: Line| (0..line.count).map(move |i| (line.first() + i as isize) as f32);
            let from: Vec<f32> = line(from_rows).flat_map(|r| line(from_columns).map(move |c| value(c, r))).collect();
            let mut to = vec![0.0; columns.count * rows.count];
            Finer::new(by, [columns, rows], [from_columns, from_rows]).plane(&from, &mut to);
            let place = |i: f32| (i + 0.5) / (1u32 << by) as f32 - 0.5;
            let want = line(rows).flat_map(|r| line(columns).map(move |c| value(place(c), place(r))));
            for (has, want) in to.iter().zip(want) {
                assert!((has - want).abs() < 1e-3, "level {k}: {has} {want}");
            }
        }
    }
}
