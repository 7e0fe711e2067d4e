//! The displacement of the ground at a position as a combination of displacements of the solver's nodes.

use super::surface::{Lattice, Surface};
use crate::smooth::Between;
use belvedere_core::DVec2;
use belvedere_scene::CellTriangle;

/// A combination of displacements of nodes, and a constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Combination {
    nodes: [u32; 8],
    weights: [f64; 8],
    len: usize,
    /// Displacement where no node moves, scene units.
    pub(super) constant: f64,
    /// The same, without the constant, as bilinear values at two points with their factors.
    pub(super) terms: [(f64, Between); 2],
}

impl Combination {
    /// Where the ground moves as the solver's grid does.
    pub(super) fn of_grid(lattice: &Lattice, g: DVec2) -> Self {
        let (four, of_four) = lattice.weights_over(g);
        let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
        nodes[..4].copy_from_slice(&four);
        weights[..4].copy_from_slice(&of_four);
        Self { nodes, weights, len: 4, constant: 0.0, terms: lattice.betweens(g) }
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (u32, f64)> {
        self.nodes[..self.len].iter().copied().zip(self.weights[..self.len].iter().copied())
    }

    /// Its value without the constant.
    pub(super) fn of_nodes(&self, u: &[f64]) -> f64 {
        self.entries().map(|(node, w)| w * u[node as usize]).sum()
    }

    /// Its value.
    pub(super) fn at(&self, u: &[f64]) -> f64 {
        self.constant + self.of_nodes(u)
    }
}

impl Surface {
    /// The displacement at grid position `g` for displacements near `u`. Next to lakes the displacements of nodes that move as the
    /// solver's grid does are taken as that at the middle of them.
    pub(super) fn combination(&self, g: DVec2, u: &[f64]) -> Combination {
        self.combined(g, u, false)
    }

    /// How ground at `at` and a point move for a row that keeps the former under the line of sight of the latter. Banks that sink with
    /// their lake may sink farther to clear the line; the point moves as it does under `u`.
    pub(super) fn moves(&self, at: DVec2, point: DVec2, u: &[f64]) -> [Combination; 2] {
        [self.combined(at, u, true), self.combined(point, u, false)]
    }

    fn combined(&self, g: DVec2, u: &[f64], banks_sink: bool) -> Combination {
        let plain = || Combination::of_grid(&self.lattice, g);
        if self.levels.nodes.is_empty() {
            return plain();
        }
        let (mut free, mut middle, mut constant) = (0.0, DVec2::ZERO, 0.0);
        let mut with: Option<(u32, f64)> = None;
        for (node, w) in CellTriangle::nodes_around([self.cols, self.rows], g) {
            let at = DVec2::new((node % self.cols) as f64, (node / self.cols) as f64);
            let own = self.levels.nodes.get(&(node as u32)).and_then(|&(lake, rise)| {
                let level = self.lattice.value(self.levels.lakes[lake as usize], u);
                let moved = self.lattice.value(at, u);
                let over =
                    if moved > level && !banks_sink { Some(0.0) } else { (moved < level - rise).then_some(-rise) };
                over.or((rise == 0.0).then_some(0.0)).map(|over| (lake, over))
            });
            match own {
                // Where two lakes share a cell, the second counts as free.
                Some((lake, over)) if with.is_none_or(|(other, _)| other == lake) => {
                    let share = with.map_or(0.0, |(_, share)| share) + w;
                    with = Some((lake, share));
                    constant += w * over;
                }
                _ => (free, middle) = (free + w, middle + w * at),
            }
        }
        let Some((lake, share)) = with else { return plain() };
        let places = [(share, self.levels.lakes[lake as usize]), (free, if free > 0.0 { middle / free } else { g })];
        let (mut nodes, mut weights, mut len) = ([0; 8], [0.0; 8], 0);
        for (factor, at) in places {
            let (four, of_four) = self.lattice.weights(at);
            for (node, w) in four.into_iter().zip(of_four) {
                (nodes[len], weights[len]) = (node, factor * w);
                len += 1;
            }
        }
        let terms = places.map(|(factor, at)| (factor, self.lattice.between(at)));
        Combination { nodes, weights, len, constant, terms }
    }
}

#[cfg(test)]
mod tests {
    use super::super::levels::Levels;
    use super::*;
    use crate::cells::tests::noise;
    use crate::smooth::{Green, Smoother};

    #[test]
    fn next_to_a_lake_ground_moves_with_it_and_elsewhere_with_the_grid() {
        let (cols, rows) = (25, 19);
        let lattice = Lattice { cols: 9, rows: 7, step: DVec2::splat(3.0) };
        let mut surface = Surface::new(&vec![0.0; cols * rows], cols, rows, lattice);
        surface.displace(&(0..63).map(|i| -40.0 * noise(i, 5)).collect::<Vec<_>>());
        let lake = DVec2::new(10.0, 8.0);
        let node = |x: usize, y: usize| (y * cols + x) as u32;
        // Water, a bank 2 m high, and shore.
        let mut levels = Levels { lakes: vec![lake], ..Levels::default() };
        for y in 5..12 {
            for x in 7..14 {
                let is_shore = x == 7 || x == 13 || y == 5 || y == 11;
                let rise = if is_shore { f64::INFINITY } else { 2.0 * f64::from(u8::from(x == 8)) };
                levels.nodes.insert(node(x, y), (0, rise));
            }
        }
        surface.levels = levels.clone();
        let u = surface.u.clone();
        let level = lattice.value(lake, &u);
        let moved = |x: usize, y: usize| {
            let grid = lattice.value(DVec2::new(x as f64, y as f64), &u);
            levels.nodes.get(&node(x, y)).map_or(grid, |(_, rise)| grid.max(level - rise).min(level))
        };
        let green = Green::new(&Smoother::new(9, 7, 0.7, 0.0).unwrap());
        for k in 0..600 {
            let at_node = k % 2 == 0;
            let g = DVec2::new(24.0 * noise(k, 1), 18.0 * noise(k, 2));
            let g = if at_node { g.round() } else { g };
            let combination = surface.combination(g, &u);
            if at_node {
                let expected = moved(g.x as usize, g.y as usize);
                assert!((combination.at(&u) - expected).abs() < 1e-9, "{g}: {} and {expected}", combination.at(&u));
            }
            let far = lattice.between(DVec2::new(22.3, 2.2));
            let entry = |j: u32| green.between(Between::node(j, 9, 7), far);
            let expected: f64 = combination.entries().map(|(node, w)| w * entry(node)).sum();
            let found: f64 = combination.terms.iter().map(|(f, b)| f * green.between(*b, far)).sum();
            assert!((found - expected).abs() < 1e-12 * green.entry(0, 0), "{g}: {found} and {expected}");
        }
    }
}
