//! Sorting of rings into polygons and holes.

use belvedere_core::polygon::{doubled_area, is_inside};
use glam::DVec2;

/// Most rings of one shape that are compared with each other; more are taken as separate areas.
const MAX_NESTED: usize = 20_000;

/// Sorts rings into polygons by nesting, for any orientation: rings at even depth are outer rings, each
/// ring at odd depth is a hole of the smallest ring around it. Returns indices, outer ring first.
pub(super) fn nest(rings: &[Vec<DVec2>]) -> Vec<Vec<usize>> {
    if rings.len() > MAX_NESTED {
        return (0..rings.len()).map(|i| vec![i]).collect();
    }
    let boxes: Vec<[DVec2; 2]> = rings
        .iter()
        .map(|r| r.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], &p| [lo.min(p), hi.max(p)]))
        .collect();
    let areas: Vec<f64> = rings.iter().map(|r| doubled_area(r).abs()).collect();
    let around = |i: usize| {
        let (boxes, areas) = (&boxes, &areas);
        // the majority of vertices decides, so that touching rings do not mislead
        (0..rings.len()).filter(move |&k| {
            let boxed = boxes[k][0].cmple(boxes[i][0]).all() && boxes[k][1].cmpge(boxes[i][1]).all();
            if k == i || !boxed || areas[k] <= areas[i] {
                return false;
            }
            let step = rings[i].len().div_ceil(9).max(1);
            let votes = rings[i].iter().step_by(step).map(|&p| if is_inside([&rings[k]], p) { 1i32 } else { -1 });
            votes.sum::<i32>() > 0
        })
    };
    let mut polygons: Vec<Vec<usize>> = Vec::new();
    let mut holes = Vec::new();
    for i in 0..rings.len() {
        let parents: Vec<usize> = around(i).collect();
        if parents.len().is_multiple_of(2) {
            polygons.push(vec![i]);
        } else if let Some(parent) = parents.into_iter().min_by(|&a, &b| areas[a].total_cmp(&areas[b])) {
            holes.push((parent, i));
        }
    }
    for (parent, hole) in holes {
        if let Some(polygon) = polygons.iter_mut().find(|p| p.first() == Some(&parent)) {
            polygon.push(hole);
        }
    }
    polygons
}

#[cfg(test)]
mod tests;
