//! Rows that keep rivers from running uphill: `bed + u` at a place is no higher than at one upstream of it.

use super::row::{Constraint, Row};
use super::surface::Lattice;
use crate::rivers::{GROUNDS, Place, Rivers};
use belvedere_core::DVec2;

/// What rises by no more brings no row, metres; the displacement of nodes is mended by that after solving.
pub(super) const ALLOWED: f64 = 0.01;

/// Two places of a river, over one ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stretch {
    river: u32,
    faceted: bool,
    upstream: u32,
    downstream: u32,
}

/// Rivers on the solver's grid.
#[derive(Debug, Clone, Default)]
pub(super) struct Uphill {
    courses: Vec<Course>,
}

#[derive(Debug, Clone)]
struct Course {
    places: Vec<Station>,
    /// Indices of places about a step of the solver's grid apart.
    steps: Vec<usize>,
}

#[derive(Debug, Clone, Copy)]
struct Station {
    grid: DVec2,
    bed: f64,
    /// Nodes and weights over [`GROUNDS`].
    over: [([u32; 4], [f64; 4]); 2],
}

impl Uphill {
    pub(super) fn new(rivers: &Rivers, lattice: &Lattice) -> Self {
        let station = |p: &Place| {
            let over = GROUNDS.map(|faceted| lattice.weights_over(p.grid, faceted));
            Station { grid: p.grid, bed: p.bed, over }
        };
        let course = |places: Vec<Station>| {
            let (mut steps, mut way) = (vec![0], 0.0);
            for k in 1..places.len() {
                way += ((places[k].grid - places[k - 1].grid) / lattice.step).length();
                if way >= 1.0 || k + 1 == places.len() {
                    steps.push(k);
                    way = 0.0;
                }
            }
            Course { places, steps }
        };
        let of = |river: &crate::rivers::River| course(river.places.iter().map(station).collect());
        Self { courses: rivers.all().iter().map(of).collect() }
    }

    /// Stretches that `u` lets rise: of each rise the whole, and the steps in it.
    pub(super) fn rising(&self, u: &[f64]) -> Vec<Stretch> {
        let mut out = Vec::new();
        for (river, course) in self.courses.iter().enumerate() {
            for (ground, faceted) in GROUNDS.into_iter().enumerate() {
                let stretch = |upstream: usize, downstream: usize| Stretch {
                    river: river as u32,
                    faceted,
                    upstream: upstream as u32,
                    downstream: downstream as u32,
                };
                out.extend(course.rises(u, ground).into_iter().map(|[a, b]| stretch(a, b)));
            }
        }
        out
    }

    pub(super) fn row(&self, stretch: Stretch, lattice: &Lattice) -> Row {
        let Stretch { river, faceted, upstream, downstream } = stretch;
        let places = &self.courses[river as usize].places;
        let [from, to] = [upstream, downstream].map(|k| places[k as usize]);
        let ground = GROUNDS.iter().position(|g| *g == faceted).unwrap_or(0);
        let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
        for k in 0..4 {
            (nodes[k], weights[k]) = (to.over[ground].0[k], to.over[ground].1[k]);
            (nodes[k + 4], weights[k + 4]) = (from.over[ground].0[k], -from.over[ground].1[k]);
        }
        let [a, b] = [to, from].map(|place| lattice.betweens(place.grid, faceted));
        let points = [a[0], a[1], (-b[0].0, b[0].1), (-b[1].0, b[1].1)];
        Row { nodes, weights, len: 8, bound: from.bed - to.bed, constraint: Constraint::River(stretch), points }
    }
}

impl Course {
    fn rises(&self, u: &[f64], ground: usize) -> Vec<[usize; 2]> {
        let value = |k: usize| {
            let Station { bed, over, .. } = &self.places[k];
            bed + (0..4).map(|j| over[ground].1[j] * u[over[ground].0[j] as usize]).sum::<f64>()
        };
        let values: Vec<f64> = (0..self.places.len()).map(value).collect();
        let steps = self.steps.windows(2).map(|w| [w[0], w[1]]);
        let mut out: Vec<[usize; 2]> = steps.filter(|[a, b]| values[*b] - values[*a] > ALLOWED).collect();
        let (mut lowest, mut highest) = (0, 0);
        for k in 1..=values.len() {
            if k == values.len() || values[k] <= values[lowest] {
                if values[highest] - values[lowest] > ALLOWED {
                    out.push([lowest, highest]);
                }
                (lowest, highest) = (k, k);
            } else if values[k] > values[highest] {
                highest = k;
            }
        }
        out.sort_unstable();
        out.dedup();
        out
    }
}
