//! Displacement of the nodes of the ground, and how uneven it is.

use super::super::{Cells, Field, NO_CELL};
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_core::quantile::{Rank, quantile};
use rayon::prelude::*;

pub(super) struct Size {
    pub(super) rms: f64,
    pub(super) max: f64,
    pub(super) raised: f64,
}

pub(super) struct Normals {
    /// Radians.
    pub(super) mean: f64,
    pub(super) p95: f64,
}

pub(super) struct Steps {
    pub(super) border: Option<f64>,
    pub(super) p999: f64,
}

/// Nodes that are summed up together: sums do not depend on the number of threads.
const PART: usize = 1 << 14;

/// Displacement of every node; 0 outside the displacement's grid.
pub(super) fn at_nodes(field: &Field, delta: &Grid) -> Vec<f64> {
    let (cols, rows, n) = (field.cols(), field.rows(), delta.cols());
    // The cell of a column or row, and the place within it.
    let cell = |at: f64, nodes: usize| {
        let inside = at >= 0.0 && at <= (nodes - 1) as f64;
        let first = (at as usize).min(nodes - 2);
        inside.then_some((first, at - first as f64))
    };
    let place = |c: usize, r: usize| delta.grid_from_scene(field.scene_from_grid(DVec2::new(c as f64, r as f64)));
    let across: Vec<_> = (0..cols).map(|c| cell(place(c, 0).x, n)).collect();
    let mut out = vec![0.0; cols * rows];
    out.par_chunks_mut(cols).enumerate().for_each(|(r, out)| {
        let Some((row, v)) = cell(place(0, r).y, delta.rows()) else { return };
        let lines = &delta.values()[row * n..(row + 2) * n];
        for (out, across) in out.iter_mut().zip(&across) {
            let Some((c, u)) = *across else { continue };
            let [nw, ne, sw, se] = [c, c + 1, c + n, c + n + 1].map(|k| lines[k]);
            *out = nw + (ne - nw) * u + (sw - nw) * v + (se - sw - ne + nw) * u * v;
        }
    });
    out
}

/// Size of the displacement over the nodes with data.
pub(super) fn size(field: &Field, u: &[f64]) -> Size {
    let part = |(u, void): (&[f64], &[bool])| {
        let solid = u.iter().zip(void).filter(|(_, void)| !**void);
        solid.fold((0.0, 0.0, 0.0f64, 0.0f64), |(sum, count, max, raised), (u, _)| {
            (sum + u * u, count + 1.0, max.max(u.abs()), raised.max(*u))
        })
    };
    let parts: Vec<_> = u.par_chunks(PART).zip(field.void().par_chunks(PART)).map(part).collect();
    let (sum, count, max, raised) =
        parts.into_iter().fold((0.0, 0.0, 0.0f64, 0.0f64), |a, b| (a.0 + b.0, a.1 + b.1, a.2.max(b.2), a.3.max(b.3)));
    Size { rms: (sum / f64::max(count, 1.0)).sqrt(), max, raised }
}

/// Depth of the lowest displaced node below the lowest undisplaced one, scene units; 0 if it is not lower.
pub(super) fn sunk_below(field: &Field, u: &[f64]) -> f64 {
    let nodes = field.heights().par_iter().zip(u).zip(field.void()).with_min_len(4096);
    let after = nodes.filter(|(_, void)| !**void).map(|((h, u), _)| h + u);
    (field.datum() - after.reduce(|| f64::INFINITY, f64::min)).max(0.0)
}

/// Steepest slope between two neighbours with data along the lines of the grid, degrees: before and after.
pub(super) fn steepest(field: &Field, u: &[f64]) -> [f64; 2] {
    let (cols, h, d) = (field.cols(), field.heights(), field.spacing());
    let at = |i: usize| {
        let east = (i % cols + 1 < cols).then_some((i + 1, d.x));
        let south = (i + cols < u.len()).then_some((i + cols, d.y));
        let beside = east.into_iter().chain(south).filter(|(j, _)| !field.void()[i] && !field.void()[*j]);
        beside.fold([0.0f64; 2], |[was, is], (j, step)| {
            let (before, moved) = (h[j] - h[i], u[j] - u[i]);
            [was.max(before.abs() / step), is.max((before + moved).abs() / step)]
        })
    };
    let slopes = (0..u.len()).into_par_iter().with_min_len(4096).map(at);
    slopes.reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]).map(|slope| slope.atan().to_degrees())
}

/// Angles between the normals before and after, from central differences (one-sided at rims and voids), on rows `every` apart.
pub(super) fn normals(field: &Field, u: &[f64], every: usize) -> Normals {
    let (cols, rows, d) = (field.cols(), field.rows(), field.spacing());
    let h = field.heights();
    let angle = |i: usize| {
        let (col, row) = (i % cols, i / cols);
        if field.void()[i] {
            return None;
        }
        let pair = |before: Option<usize>, after: Option<usize>, step: f64| {
            let [a, b] = [before, after].map(|j| j.filter(|&j| !field.void()[j]).unwrap_or(i));
            let span = if a == i || b == i { step } else { 2.0 * step };
            let slope = (h[b] - h[a]) / span;
            (slope, slope + (u[b] - u[a]) / span)
        };
        let x = pair((col > 0).then(|| i - 1), (col + 1 < cols).then(|| i + 1), d.x);
        let y = pair((row > 0).then(|| i - cols), (row + 1 < rows).then(|| i + cols), d.y);
        let (old, new) = (DVec2::new(x.0, y.0).extend(1.0), DVec2::new(x.1, y.1).extend(1.0));
        Some(angle_of(old.cross(new).length(), old.dot(new)))
    };
    let row = |row: usize| (row * cols..(row + 1) * cols).filter_map(angle);
    let mut angles: Vec<f64> = (0..rows).into_par_iter().step_by(every).flat_map_iter(row).collect();
    let mean = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    Normals { mean, p95: quantile(&mut angles, 0.95, Rank::Lower) }
}

/// Arc tangent of `y / x`, `y >= 0`; by a series where it is small, as of most nodes, to 1e-9.
fn angle_of(y: f64, x: f64) -> f64 {
    if x > 0.0 && y < 0.05 * x {
        let t = y / x;
        let s = t * t;
        return t * (1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0))));
    }
    y.atan2(x)
}

/// Differences of displacement between neighbours along the lines of the grid, both with data, from rows `every` apart.
pub(super) fn steps(field: &Field, cells: Option<&Cells>, u: &[f64], every: usize) -> Steps {
    let (cols, void) = (field.cols(), field.void());
    let beside = |i: usize| {
        let east = (i % cols + 1 < cols).then_some(i + 1);
        let south = (i + cols < u.len()).then_some(i + cols);
        east.into_iter().chain(south).filter(move |j| !void[i] && !void[*j])
    };
    let pairs = |row: usize| (row * cols..(row + 1) * cols).flat_map(|i| beside(i).map(move |j| (i, j)));
    let rows = (0..field.rows()).into_par_iter().step_by(every);
    let mut all: Vec<f64> = rows.flat_map_iter(|row| pairs(row).map(|(i, j)| (u[i] - u[j]).abs())).collect();
    let (mut border, mut edges) = (0.0, 0usize);
    if let Some(labels) = cells.map(Cells::labels) {
        for (i, j) in (0..field.rows()).step_by(every).flat_map(pairs) {
            let (a, b) = (labels[i], labels[j]);
            if a != b && a != NO_CELL && b != NO_CELL {
                border += (u[i] - u[j]).abs();
                edges += 1;
            }
        }
    }
    Steps { border: (edges > 0).then(|| border / edges as f64), p999: quantile(&mut all, 0.999, Rank::Lower) }
}

#[cfg(test)]
mod tests {
    use super::angle_of;

    #[test]
    fn small_angles_are_those_of_the_arc_tangent() {
        for k in 0..4000 {
            let (y, x) = (0.0001 * f64::from(k), 1.3);
            assert!((angle_of(y, x) - y.atan2(x)).abs() < 1e-9, "{y}");
        }
        assert!(angle_of(1.0, -1.0) > 2.0 && angle_of(0.0, -1.0) > 3.0);
    }
}
