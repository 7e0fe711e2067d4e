//! Rows that keep rivers from running uphill: `bed + u` at a point is no higher than at one upstream of it.
//!
//! Small rises that they leave are corrected at the nodes after solving.

use super::row::{Constraint, MOST_NODES, Row, Stretch};
use super::surface::Lattice;
use crate::rivers::{Place, River, Rivers};
use belvedere_core::DVec2;

/// Rises up to this height bring no row, metres; they are corrected at the nodes after solving.
pub(super) const ALLOWED: f64 = 0.05;
/// Rises of less than this share of the largest one bring no row: many of them vanish with it.
const WORTH: f64 = 0.1;

/// Rivers on the solver's grid.
#[derive(Debug, Clone, Default)]
pub(super) struct Uphill {
    courses: Vec<Course>,
}

#[derive(Debug, Clone)]
struct Course {
    places: Vec<Station>,
    /// Indices of points about a step of the solver's grid apart.
    steps: Vec<usize>,
}

#[derive(Debug, Clone, Copy)]
struct Station {
    grid: DVec2,
    bed: f64,
    nodes: [u32; 4],
    weights: [f64; 4],
}

impl Uphill {
    pub(super) fn new(rivers: &Rivers, lattice: &Lattice) -> Self {
        let station = |p: &Place| {
            let (nodes, weights) = lattice.weights_over(p.grid);
            Station { grid: p.grid, bed: p.bed, nodes, weights }
        };
        let course = |river: &River| Course::new(river.places().map(station).collect(), lattice);
        Self { courses: rivers.all().iter().map(course).collect() }
    }

    /// Stretches along which `u` lets a river rise: of each rise the whole, and the steps in it.
    pub(super) fn rising(&self, u: &[f64]) -> Vec<Stretch> {
        let mut out = Vec::new();
        for (river, course) in self.courses.iter().enumerate() {
            let stretch = |[upstream, downstream]: [usize; 2]| Stretch {
                river: river as u32,
                upstream: upstream as u32,
                downstream: downstream as u32,
            };
            out.extend(course.rises(u).into_iter().map(|(ends, rise)| (stretch(ends), rise)));
        }
        let most = out.iter().map(|(_, rise)| *rise).fold(0.0, f64::max);
        out.into_iter().filter(|(_, rise)| *rise >= WORTH * most).map(|(stretch, _)| stretch).collect()
    }

    pub(super) fn row(&self, Stretch { river, upstream, downstream }: Stretch, lattice: &Lattice) -> Row {
        let places = &self.courses[river as usize].places;
        let [from, to] = [upstream, downstream].map(|k| places[k as usize]);
        let (mut nodes, mut weights) = ([0; MOST_NODES], [0.0; MOST_NODES]);
        for k in 0..4 {
            (nodes[k], weights[k]) = (to.nodes[k], to.weights[k]);
            (nodes[k + 4], weights[k + 4]) = (from.nodes[k], -from.weights[k]);
        }
        let [a, b] = [to, from].map(|place| lattice.betweens(place.grid));
        let points = [a[0], a[1], (-b[0].0, b[0].1), (-b[1].0, b[1].1)];
        let constraint = Constraint::River(Stretch { river, upstream, downstream });
        Row { nodes, weights, len: 8, bound: from.bed - to.bed, constraint, points }
    }
}

impl Course {
    fn new(places: Vec<Station>, lattice: &Lattice) -> Self {
        let (mut steps, mut way) = (vec![0], 0.0);
        for k in 1..places.len() {
            way += ((places[k].grid - places[k - 1].grid) / lattice.step).length();
            if way >= 1.0 || k + 1 == places.len() {
                steps.push(k);
                way = 0.0;
            }
        }
        Self { places, steps }
    }

    /// Ends of stretches, and by how much they rise.
    fn rises(&self, u: &[f64]) -> Vec<([usize; 2], f64)> {
        let value = |s: &Station| s.bed + (0..4).map(|k| s.weights[k] * u[s.nodes[k] as usize]).sum::<f64>();
        let values: Vec<f64> = self.places.iter().map(value).collect();
        let mut ends: Vec<[usize; 2]> = self.steps.windows(2).map(|w| [w[0], w[1]]).collect();
        let (mut lowest, mut highest) = (0, 0);
        for k in 1..=values.len() {
            if k == values.len() || values[k] <= values[lowest] {
                ends.push([lowest, highest]);
                (lowest, highest) = (k, k);
            } else if values[k] > values[highest] {
                highest = k;
            }
        }
        let rising = ends.into_iter().map(|[a, b]| ([a, b], values[b] - values[a]));
        rising.filter(|(_, rise)| *rise > ALLOWED).collect()
    }
}
