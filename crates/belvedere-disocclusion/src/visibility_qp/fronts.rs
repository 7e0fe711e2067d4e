//! Sparse Cholesky factor by fronts (Duff and Reid 1983): each part of a dissection is eliminated in a small dense matrix.

use super::dissection::Dissection;
use super::front::Front;
use super::row::MOST_NODES;

/// Sums of squares `scale (sum weights v[nodes])^2`.
#[derive(Debug, Clone, Default)]
pub(super) struct Squares {
    starts: Vec<u32>,
    entries: Vec<(u32, f64)>,
    scales: Vec<f64>,
}

impl Squares {
    /// Adds one; entries of weight 0 are left out.
    pub(super) fn push(&mut self, entries: impl Iterator<Item = (u32, f64)>, scale: f64) {
        self.starts.push(self.entries.len() as u32);
        self.entries.extend(entries.filter(|e| e.1 != 0.0));
        self.scales.push(scale);
    }

    fn len(&self) -> usize {
        self.scales.len()
    }

    /// Product of their matrix with values at the nodes.
    pub(super) fn times(&self, values: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; values.len()];
        for (k, scale) in self.scales.iter().enumerate() {
            let entries = self.entries(k);
            let sum: f64 = entries.iter().map(|(node, w)| w * values[*node as usize]).sum();
            entries.iter().for_each(|(node, w)| out[*node as usize] += scale * sum * w);
        }
        out
    }

    fn entries(&self, k: usize) -> &[(u32, f64)] {
        let end = self.starts.get(k + 1).map_or(self.entries.len(), |end| *end as usize);
        &self.entries[self.starts[k] as usize..end]
    }
}

/// Cholesky factor of a sum of squares.
#[derive(Debug, Clone)]
pub(super) struct Factor {
    parts: Vec<Eliminated>,
    /// Position of each node in the order of elimination.
    position: Vec<u32>,
    unknowns: usize,
}

/// A part with its columns of the factor.
#[derive(Debug, Clone)]
struct Eliminated {
    first: usize,
    /// Positions of the unknowns above that it joins, ascending.
    border: Vec<u32>,
    front: Front,
}

/// What is known of the parts before numbers come in.
struct Symbolic<'a> {
    dissection: &'a Dissection,
    squares: &'a Squares,
    position: &'a [u32],
    first: Vec<usize>,
    borders: Vec<Vec<u32>>,
    /// Squares of each part.
    of_part: Vec<Vec<u32>>,
}

impl Factor {
    /// Factor of the matrix of `squares`. Each square joins nodes of parts that lie one above the other.
    pub(super) fn new(dissection: &Dissection, squares: &Squares) -> Self {
        let mut position = vec![u32::MAX; dissection.part_of.len()];
        let (mut first, mut unknowns) = (Vec::with_capacity(dissection.parts.len()), 0);
        for part in &dissection.parts {
            first.push(unknowns);
            for node in &part.nodes {
                position[*node as usize] = unknowns as u32;
                unknowns += 1;
            }
        }
        let mut of_part = vec![Vec::new(); dissection.parts.len()];
        for k in 0..squares.len() {
            let parts = squares.entries(k).iter().map(|e| dissection.part_of[e.0 as usize]);
            if let Some(part) = parts.min() {
                of_part[part as usize].push(k as u32);
            }
        }
        let mut symbolic = Symbolic { dissection, squares, position: &position, first, borders: Vec::new(), of_part };
        symbolic.find_borders();
        let root = dissection.parts.len() - 1;
        let (mut parts, _) = symbolic.eliminate(root);
        parts.shrink_to_fit();
        Self { parts, position, unknowns }
    }

    /// Solves for the unknowns; other nodes keep their values.
    pub(super) fn solve(&self, values: &mut [f64]) {
        let mut x = vec![0.0; self.unknowns];
        let known = |p: &u32| *p != u32::MAX;
        for (value, p) in values.iter().zip(&self.position).filter(|(_, p)| known(p)) {
            x[*p as usize] = *value;
        }
        for part in &self.parts {
            part.front.forward(&mut x, part.first, &part.border);
        }
        for part in self.parts.iter().rev() {
            part.front.backward(&mut x, part.first, &part.border);
        }
        for (value, p) in values.iter_mut().zip(&self.position).filter(|(_, p)| known(p)) {
            *value = x[*p as usize];
        }
    }
}

impl Symbolic<'_> {
    fn find_borders(&mut self) {
        for (index, part) in self.dissection.parts.iter().enumerate() {
            let end = (self.first[index] + part.nodes.len()) as u32;
            let mut border: Vec<u32> = Vec::new();
            for k in &self.of_part[index] {
                let entries = self.squares.entries(*k as usize);
                border.extend(entries.iter().map(|e| self.position[e.0 as usize]).filter(|p| *p >= end));
            }
            border.sort_unstable();
            border.dedup();
            for below in &part.below {
                border.extend(self.borders[*below].iter().filter(|p| **p >= end));
            }
            border.sort_unstable();
            border.dedup();
            self.borders.push(border);
        }
    }

    /// Eliminates a part and all below it; returns them in their order, and what is left for the parts above.
    fn eliminate(&self, index: usize) -> (Vec<Eliminated>, Vec<f64>) {
        let part = &self.dissection.parts[index];
        let (mut done, lefts) = match part.below[..] {
            [a, b] => {
                let ((mut done, left), (more, right)) = rayon::join(|| self.eliminate(a), || self.eliminate(b));
                done.extend(more);
                (done, vec![(a, left), (b, right)])
            }
            _ => (Vec::new(), Vec::new()),
        };
        let (first, border) = (self.first[index], &self.borders[index]);
        let own = part.nodes.len();
        let mut front = Front::new(own, border.len());
        let local = |p: u32| -> usize {
            let p = p as usize;
            if p < first + own { p - first } else { own + border.binary_search(&(p as u32)).unwrap_or(0) }
        };
        for k in &self.of_part[index] {
            let (entries, scale) = (self.squares.entries(*k as usize), self.squares.scales[*k as usize]);
            let mut at = [(0usize, 0.0f64); MOST_NODES];
            for (at, (node, weight)) in at.iter_mut().zip(entries) {
                *at = (local(self.position[*node as usize]), *weight);
            }
            let at = &at[..entries.len()];
            for (i, a) in at {
                for (j, b) in at {
                    if j <= i {
                        front.add(*i, *j, scale * a * b);
                    }
                }
            }
        }
        for (below, left) in lefts {
            let places: Vec<usize> = self.borders[below].iter().map(|p| local(*p)).collect();
            front.take_over(&left, &places);
        }
        let left = front.eliminate();
        done.push(Eliminated { first, border: border.clone(), front });
        (done, left)
    }
}

#[cfg(test)]
mod tests;
