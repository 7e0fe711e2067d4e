//! The program solved slowly: every row at once, dense matrices, coordinate ascent on the dual (Hildreth).

use belvedere_core::DVec2;

/// Displacement on a small grid over small ground, both square.
pub(crate) struct Small {
    /// Nodes of the ground per side.
    pub(crate) n: usize,
    /// Ground, row-major.
    pub(crate) ground: Vec<f64>,
    /// Nodes of the solver per side.
    pub(crate) nodes: usize,
    /// Ground cells per solver cell.
    pub(crate) step: f64,
    /// w^2 + g^2.
    pub(crate) weight: f64,
}

/// `sum row[j] u[j] <= bound`.
pub(crate) struct DenseRow {
    pub(crate) row: Vec<f64>,
    pub(crate) bound: f64,
}

impl Small {
    /// Height of the triangles.
    pub(crate) fn height(&self, g: DVec2) -> f64 {
        let cell = |v: f64| (v.floor() as usize).min(self.n - 2);
        let (c, r) = (cell(g.x), cell(g.y));
        let (a, b) = (g.x - c as f64, g.y - r as f64);
        let h = |x: usize, y: usize| self.ground[(r + y) * self.n + c + x];
        let (nw, ne, sw, se) = (h(0, 0), h(1, 0), h(0, 1), h(1, 1));
        if a > b { (1.0 - a) * nw + (a - b) * ne + b * se } else { (1.0 - b) * nw + (b - a) * sw + a * se }
    }

    /// Row of B: bilinear at the nodes of the ground.
    fn bilinear(&self, g: DVec2) -> Vec<f64> {
        let hat = |v: f64, k: usize| (1.0 - (v / self.step - k as f64).abs()).max(0.0);
        (0..self.nodes * self.nodes).map(|j| hat(g.x, j % self.nodes) * hat(g.y, j / self.nodes)).collect()
    }

    /// Row of B, flat on the triangles of the ground.
    fn displacement(&self, g: DVec2) -> Vec<f64> {
        let corner = g.floor().min(DVec2::splat((self.n - 2) as f64));
        let DVec2 { x: a, y: b } = g - corner;
        let [nw, ne, sw, se] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|step| self.bilinear(corner + step));
        let weights = if a > b { [1.0 - a, a - b, 0.0, b] } else { [1.0 - b, 0.0, b - a, a] };
        let value = |j: usize| [&nw, &ne, &sw, &se].iter().zip(weights).map(|(row, w)| w * row[j]).sum();
        (0..self.nodes * self.nodes).map(value).collect()
    }

    /// `H = L^T L + weight I` by the stencil.
    pub(crate) fn metric(&self) -> Vec<Vec<f64>> {
        let n = self.nodes;
        let mut l = vec![vec![0.0; n * n]; n * n];
        for (i, row) in l.iter_mut().enumerate() {
            let (x, y) = (i % n, i / n);
            for j in 0..n * n {
                if (j % n).abs_diff(x) + (j / n).abs_diff(y) == 1 {
                    row[j] += 1.0;
                    row[i] -= 1.0;
                }
            }
        }
        let product = |i: usize, j: usize| (0..n * n).map(|k| l[k][i] * l[k][j]).sum::<f64>();
        let unit = |i: usize, j: usize| if i == j { self.weight } else { 0.0 };
        (0..n * n).map(|i| (0..n * n).map(|j| product(i, j) + unit(i, j)).collect()).collect()
    }

    /// Rows of every crossing of every line of sight with a line of the mesh, and of `parts - 1` places between neighbours.
    pub(crate) fn sight_rows(
        &self,
        points: &[(DVec2, f64)],
        (eye, z): (DVec2, f64),
        guard: f64,
        margin: f64,
        parts: usize,
    ) -> Vec<DenseRow> {
        let mut out = Vec::new();
        for &(p, lift) in points {
            let d = eye - p;
            let mut cuts = vec![0.0, 1.0];
            let lines = |from: f64, to: f64| {
                let limit = 2 * self.n as i64;
                (-limit..=limit).map(move |k| (k as f64 - from) / (to - from)).filter(|t| *t > 0.0 && *t < 1.0)
            };
            cuts.extend(lines(p.x, eye.x));
            cuts.extend(lines(p.y, eye.y));
            cuts.extend(lines(p.x - p.y, eye.x - eye.y));
            cuts.push(guard / d.length());
            cuts.sort_by(f64::total_cmp);
            for pair in cuts.windows(2) {
                for k in 0..parts {
                    let tau = pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64;
                    let x = p + tau * d;
                    let last = (self.n - 1) as f64;
                    if x.min_element() < 0.0 || x.max_element() > last || (x - p).length() < guard - 1e-9 {
                        continue;
                    }
                    let (here, there) = (self.displacement(x), self.displacement(p));
                    let row = here.iter().zip(&there).map(|(a, b)| a - (1.0 - tau) * b).collect();
                    let line = (1.0 - tau) * (self.height(p) + lift) + tau * z;
                    out.push(DenseRow { row, bound: line - self.height(x) - margin * (5.0 * tau).min(1.0) });
                }
            }
        }
        out
    }

    /// Minimiser of `1/2 |u - target|_H^2` under `rows`, to 1e-10 of the multipliers' movement.
    pub(crate) fn solve(&self, rows: &[DenseRow], target: &[f64]) -> (Vec<f64>, f64) {
        let inverse = inverted(self.metric());
        let apply = |m: &[Vec<f64>], v: &[f64]| -> Vec<f64> {
            m.iter().map(|r| r.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
        };
        let columns: Vec<Vec<f64>> = rows.iter().map(|r| apply(&inverse, &r.row)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let squares: Vec<f64> = rows.iter().zip(&columns).map(|(r, c)| dot(&r.row, c)).collect();
        let (mut m, mut u) = (vec![0.0; rows.len()], target.to_vec());
        for _ in 0..200_000 {
            let mut moved = 0.0f64;
            for (i, row) in rows.iter().enumerate() {
                let next = (m[i] + 1.3 * (dot(&row.row, &u) - row.bound) / squares[i]).max(0.0);
                let change = next - m[i];
                if change != 0.0 {
                    m[i] = next;
                    moved = moved.max(change.abs() * squares[i].sqrt());
                    for (u, c) in u.iter_mut().zip(&columns[i]) {
                        *u -= change * c;
                    }
                }
            }
            if moved < 1e-10 {
                break;
            }
        }
        let off: Vec<f64> = u.iter().zip(target).map(|(u, t)| u - t).collect();
        let energy = 0.5 * dot(&off, &apply(&self.metric(), &off));
        (u, energy)
    }
}

/// Gauss-Jordan with pivots on the diagonal, for positive definite matrices.
fn inverted(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut out: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for k in 0..n {
        let pivot = 1.0 / a[k][k];
        for j in 0..n {
            a[k][j] *= pivot;
            out[k][j] *= pivot;
        }
        for i in (0..n).filter(|i| *i != k) {
            let f = a[i][k];
            for j in 0..n {
                a[i][j] -= f * a[k][j];
                out[i][j] -= f * out[k][j];
            }
        }
    }
    out
}
