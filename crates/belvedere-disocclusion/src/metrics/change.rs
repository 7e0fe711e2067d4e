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

/// Displacement of every node; 0 outside the displacement's grid.
pub(super) fn at_nodes(field: &Field, delta: &Grid) -> Vec<f64> {
    let cols = field.cols();
    let at = |i: usize| {
        let g = DVec2::new((i % cols) as f64, (i / cols) as f64);
        delta.sample(field.scene_from_grid(g)).unwrap_or(0.0)
    };
    (0..field.heights().len()).into_par_iter().with_min_len(4096).map(at).collect()
}

/// Size of the displacement over the nodes with data.
pub(super) fn size(field: &Field, u: &[f64]) -> Size {
    let solid = || u.iter().zip(field.void()).filter(|(_, v)| !**v).map(|(u, _)| *u);
    let (sum, count) = solid().fold((0.0, 0usize), |(s, n), u| (s + u * u, n + 1));
    Size {
        rms: (sum / count.max(1) as f64).sqrt(),
        max: solid().fold(0.0, |m, u| m.max(u.abs())),
        raised: solid().fold(0.0, f64::max),
    }
}

/// Depth of the lowest displaced node below the lowest undisplaced one, scene units; 0 if it is not lower.
pub(super) fn sunk_below(field: &Field, u: &[f64]) -> f64 {
    let after = field.heights().iter().zip(u).zip(field.void()).filter(|(_, void)| !**void).map(|((h, u), _)| h + u);
    (field.datum() - after.fold(f64::INFINITY, f64::min)).max(0.0)
}

/// Steepest slope between two neighbours with data along the lines of the grid, degrees: before and after.
pub(super) fn steepest(field: &Field, u: &[f64]) -> [f64; 2] {
    let (cols, h, d) = (field.cols(), field.heights(), field.spacing());
    let mut steepest = [0.0f64; 2];
    for i in 0..u.len() {
        let east = (i % cols + 1 < cols).then_some((i + 1, d.x));
        let south = (i + cols < u.len()).then_some((i + cols, d.y));
        for (j, step) in east.into_iter().chain(south).filter(|(j, _)| !field.void()[i] && !field.void()[*j]) {
            let (before, moved) = (h[j] - h[i], u[j] - u[i]);
            steepest = [steepest[0].max(before.abs() / step), steepest[1].max((before + moved).abs() / step)];
        }
    }
    steepest.map(|slope| slope.atan().to_degrees())
}

/// Angles between the normals before and after, from central differences (one-sided at rims and voids).
pub(super) fn normals(field: &Field, u: &[f64]) -> Normals {
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
        Some(old.cross(new).length().atan2(old.dot(new)))
    };
    let mut angles: Vec<f64> = (0..h.len()).into_par_iter().with_min_len(4096).filter_map(angle).collect();
    let mean = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    Normals { mean, p95: quantile(&mut angles, 0.95, Rank::Lower) }
}

/// Differences of displacement between neighbours along the lines of the grid, both with data.
pub(super) fn steps(field: &Field, cells: Option<&Cells>, u: &[f64]) -> Steps {
    let cols = field.cols();
    let mut all = Vec::with_capacity(2 * u.len());
    let (mut border, mut edges) = (0.0, 0usize);
    for i in 0..u.len() {
        let east = (i % cols + 1 < cols).then_some(i + 1);
        let south = (i + cols < u.len()).then_some(i + cols);
        for j in east.into_iter().chain(south) {
            if field.void()[i] || field.void()[j] {
                continue;
            }
            let step = (u[i] - u[j]).abs();
            all.push(step);
            if let Some(cells) = cells {
                let (a, b) = (cells.labels()[i], cells.labels()[j]);
                if a != b && a != NO_CELL && b != NO_CELL {
                    border += step;
                    edges += 1;
                }
            }
        }
    }
    Steps { border: (edges > 0).then(|| border / edges as f64), p999: quantile(&mut all, 0.999, Rank::Lower) }
}
