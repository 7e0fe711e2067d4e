//! The pole of inaccessibility of a polygon: the point inside that is farthest from its border, where a name has most room.

use belvedere_core::DVec2;
use belvedere_core::polygon::to_segment;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Corners that are looked at; of larger polygons evenly chosen ones.
const CORNERS: usize = 800;
/// Error of the distance, as a share of the smaller side of the box around the polygon.
const ERROR: f64 = 0.01;
/// Cells that are looked at, at most.
const CELLS: usize = 1500;

/// A point inside a polygon, and its distance from the border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pole {
    pub(super) at: DVec2,
    pub(super) distance: f64,
}

/// A square that is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    middle: DVec2,
    half: f64,
    /// Distance of its middle from the border, negative outside.
    distance: f64,
}

impl Cell {
    fn new(middle: DVec2, half: f64, rings: &[Vec<DVec2>]) -> Self {
        Self { middle, half, distance: distance(middle, rings) }
    }

    /// No point of the cell is farther from the border.
    fn most(&self) -> f64 {
        self.distance + self.half * std::f64::consts::SQRT_2
    }
}

impl Eq for Cell {}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most().total_cmp(&other.most())
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The pole, to 1 % of the smaller side of the polygon's box: cells that may hold a better point are parted in four, the best first.
///
/// * `rings`: outer first, then holes, closed implicitly. `None` if nothing is inside.
pub(super) fn pole(rings: &[Vec<DVec2>]) -> Option<Pole> {
    let rings: Vec<Vec<DVec2>> = rings.iter().map(|ring| thinned(ring)).collect();
    let outer = rings.first()?;
    let first = *outer.first()?;
    let (lo, hi) = outer.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let (size, small) = (hi - lo, (hi - lo).min_element());
    if !(small > 0.0) || !size.is_finite() {
        return None;
    }
    // A long polygon begins with one row of cells, of which there are no more than may be looked at.
    let side = small.max(size.max_element() / (0.5 * CELLS as f64));
    let mut best = Cell::new(0.5 * (lo + hi), 0.0, &rings);
    let mut open = BinaryHeap::new();
    let [columns, rows] = (size / side).ceil().to_array().map(|n| n.max(1.0) as usize);
    for (i, k) in (0..columns).flat_map(|i| (0..rows).map(move |k| (i, k))) {
        open.push(Cell::new(lo + side * (DVec2::new(i as f64, k as f64) + 0.5), 0.5 * side, &rings));
    }
    let mut looked = open.len();
    while let Some(cell) = open.pop() {
        if cell.distance > best.distance {
            best = cell;
        }
        if cell.most() <= best.distance + ERROR * small || looked >= CELLS {
            break;
        }
        let half = 0.5 * cell.half;
        for corner in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            open.push(Cell::new(cell.middle + half * DVec2::from_array(corner), half, &rings));
        }
        looked += 4;
    }
    (best.distance > 0.0).then_some(Pole { at: best.middle, distance: best.distance })
}

fn thinned(ring: &[DVec2]) -> Vec<DVec2> {
    let every = ring.len().div_ceil(CORNERS).max(1);
    ring.iter().copied().step_by(every).filter(|p| p.is_finite()).collect()
}

/// Distance from the border, negative outside.
fn distance(p: DVec2, rings: &[Vec<DVec2>]) -> f64 {
    let (mut inside, mut least) = (false, f64::INFINITY);
    for ring in rings {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
            least = least.min(to_segment(p, *a, *b).length());
        }
    }
    if inside { least } else { -least }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().map(|p| DVec2::from_array(*p)).collect()
    }

    #[test]
    fn the_pole_lies_where_most_room_is() {
        let square = ring(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
        let found = pole(std::slice::from_ref(&square)).expect("inside");
        assert!((found.distance - 5.0).abs() < 0.11 && found.at.distance(DVec2::splat(5.0)) < 0.2, "{found:?}");
        // A hole in the middle: the farthest points lie in the corners of the rest, inside the ring.
        let hole = ring(&[[3.0, 3.0], [7.0, 3.0], [7.0, 7.0], [3.0, 7.0]]);
        let found = pole(&[square, hole]).expect("inside");
        assert!(found.distance > 1.7 && (found.at - 5.0).abs().max_element() > 2.0, "{found:?}");
        // Of a letter L, the foot is wider than the stem; the middle of its box lies outside.
        let letter = ring(&[[0.0, 0.0], [30.0, 0.0], [30.0, 10.0], [6.0, 10.0], [6.0, 60.0], [0.0, 60.0]]);
        let found = pole(&[letter]).expect("inside");
        assert!(found.at.y < 10.0 && found.distance > 4.9, "{found:?}");
    }

    #[test]
    fn what_has_no_inside_has_no_pole_and_long_or_large_ones_end() {
        assert_eq!(pole(&[]), None);
        assert_eq!(pole(&[ring(&[[0.0, 0.0], [5.0, 0.0]])]), None);
        assert_eq!(pole(&[ring(&[[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0]])]), None);
        let long = ring(&[[0.0, 0.0], [1e7, 0.0], [1e7, 1.0], [0.0, 1.0]]);
        assert!(pole(&[long]).is_none_or(|pole| pole.distance <= 0.5));
        let many: Vec<DVec2> = (0..100_000).map(|i| 1000.0 * DVec2::from_angle(f64::from(i) * 6.283e-5)).collect();
        let found = pole(&[many]).expect("inside");
        assert!((found.distance - 1000.0).abs() < 25.0, "{found:?}");
    }
}
