//! Lines laid on terrain.

use crate::Heightfield;
use belvedere_core::{DVec2, DVec3};

/// A polyline laid on terrain.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Draped {
    /// The pieces that lie on the terrain, in order, at least 2 vertices each; z = ground.
    pub parts: Vec<Vec<DVec3>>,
    /// Horizontal length of the whole polyline, metres.
    pub length_m: f64,
    /// Horizontal length that lies outside the grid or over voids, metres.
    pub outside_m: f64,
}

/// Lays a polyline on the drawn surface of the terrain ([`Heightfield::surface_at`]): a vertex wherever it crosses an edge of a
/// triangle, so that it neither floats nor sinks anywhere; split where the ground is missing.
///
/// Repeated points and points that are not finite are dropped. Pieces of no length are dropped.
pub fn drape_polyline(terrain: &Heightfield, line: &[DVec2]) -> Draped {
    let mut out = Draped::default();
    let mut part: Vec<DVec3> = Vec::new();
    let points: Vec<DVec2> = line.iter().copied().filter(|p| p.is_finite()).collect();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = a.distance(b);
        if length == 0.0 {
            continue;
        }
        out.length_m += length;
        let mut start = 0.0;
        for end in edge_crossings(terrain, a, b) {
            let middle = a.lerp(b, 0.5 * (start + end));
            // rounding may put an end a hair outside the triangle its middle lies in
            let ground = |t: f64| {
                let on = |xy: DVec2| Some(xy.extend(terrain.surface_at(xy)?));
                let xy = a.lerp(b, t);
                on(xy).or_else(|| on(xy.lerp(middle, 1e-6)))
            };
            match (terrain.surface_at(middle), ground(start), ground(end)) {
                (Some(_), Some(p), Some(q)) => {
                    for p in [p, q] {
                        if part.last().is_none_or(|last| last.truncate().distance(p.truncate()) > 1e-6) {
                            part.push(p);
                        }
                    }
                }
                _ => {
                    out.outside_m += (end - start) * length;
                    close(&mut part, &mut out.parts);
                }
            }
            start = end;
        }
    }
    close(&mut part, &mut out.parts);
    out
}

fn close(part: &mut Vec<DVec3>, parts: &mut Vec<Vec<DVec3>>) {
    let done = std::mem::take(part);
    if done.len() >= 2 {
        parts.push(done);
    }
}

/// Parameters in (0, 1] at which a -> b crosses columns, rows and diagonals of the grid, ascending, ending with 1.
fn edge_crossings(terrain: &Heightfield, a: DVec2, b: DVec2) -> Vec<f64> {
    let (ga, gb) = (terrain.grid_from_scene(a), terrain.grid_from_scene(b));
    let (cols, rows) = ((terrain.cols() - 1) as f64, (terrain.rows() - 1) as f64);
    let mut ts = vec![1.0];
    // diagonals are where column - row is whole
    for (from, to, first, last) in
        [(ga.x, gb.x, 0.0, cols), (ga.y, gb.y, 0.0, rows), (ga.x - ga.y, gb.x - gb.y, -rows, cols)]
    {
        let (lo, hi) = (from.min(to).max(first).ceil(), from.max(to).min(last).floor());
        if from == to || lo > hi {
            continue;
        }
        ts.extend(
            (0..=(hi - lo) as usize).map(|k| (lo + k as f64 - from) / (to - from)).filter(|t| *t > 0.0 && *t < 1.0),
        );
    }
    ts.sort_by(f64::total_cmp);
    ts.dedup_by(|x, y| (*x - *y).abs() < 1e-12);
    ts
}

#[cfg(test)]
mod tests;
