//! Openness: the share of the light from all around that reaches the points of a mesh.

use super::{Mesh, MeshError};

/// Shares of the light from all around, 255 = all.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Openness {
    /// Not known: all.
    #[default]
    Unknown,
    /// One per vertex.
    PerVertex(Vec<u8>),
    /// At lattice points of each triangle.
    Lattices(Lattices),
}

/// Shares at points that divide the edges of each triangle into equal steps, row by row away from its second edge; see [`triangle_lattice`].
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Lattices {
    /// Per triangle the index of its first share, and its steps along an edge.
    places: Vec<(u32, u8)>,
    shares: Vec<u8>,
}

/// Weights of the corners at the lattice points of a triangle, in the order of their shares.
///
/// * `steps`: steps along an edge, at least 1.
pub fn triangle_lattice(steps: u8) -> impl Iterator<Item = [f64; 3]> {
    let n = u32::from(steps.max(1));
    let share = move |k: u32| f64::from(k) / f64::from(n);
    (0..=n).flat_map(move |i| (0..=n - i).map(move |j| [share(n - i - j), share(i), share(j)]))
}

/// Number of lattice points.
fn points(steps: u8) -> usize {
    let n = usize::from(steps.max(1));
    (n + 1) * (n + 2) / 2
}

impl Openness {
    /// The share at a point of a triangle, 0..=1.
    pub(super) fn at(&self, triangle: usize, corners: [u32; 3], weights: [f64; 3]) -> f64 {
        let share = match self {
            Self::Unknown => return 1.0,
            Self::PerVertex(shares) => {
                corners.iter().zip(weights).map(|(&v, w)| f64::from(shares[v as usize]) * w).sum::<f64>()
            }
            Self::Lattices(lattices) => lattices.at(triangle, weights),
        };
        (share / 255.0).clamp(0.0, 1.0)
    }

    /// Removes triangles that are not kept.
    pub(super) fn retain(&mut self, kept: &[bool]) {
        if let Self::Lattices(lattices) = self {
            let mut keep = kept.iter();
            lattices.places.retain(|_| keep.next() == Some(&true));
        }
    }

    /// Appends a copy of vertex `v`.
    pub(super) fn copy_of(&mut self, v: usize) {
        if let Self::PerVertex(shares) = self {
            shares.push(shares[v]);
        }
    }
}

impl Lattices {
    fn at(&self, triangle: usize, weights: [f64; 3]) -> f64 {
        let Some(&(first, steps)) = self.places.get(triangle) else { return 255.0 };
        let n = usize::from(steps.max(1));
        let [x, y] = [weights[1], weights[2]].map(|w| w.clamp(0.0, 1.0) * n as f64);
        let (i, j) = ((x as usize).min(n - 1), (y as usize).min(n - 1));
        let j = j.min(n - 1 - i);
        let (fx, fy) = (x - i as f64, y - j as f64);
        // Row i begins after the n + 1, n, ... points of the rows before it.
        let share =
            |i: usize, j: usize| f64::from(self.shares[first as usize + i * (n + 1) - i * i.saturating_sub(1) / 2 + j]);
        if fx + fy <= 1.0 || i + j + 2 > n {
            share(i, j) * (1.0 - fx - fy) + share(i + 1, j) * fx + share(i, j + 1) * fy
        } else {
            share(i + 1, j + 1) * (fx + fy - 1.0) + share(i, j + 1) * (1.0 - fx) + share(i + 1, j) * (1.0 - fy)
        }
    }
}

impl Mesh {
    /// This mesh with the share of the light from all around that reaches each vertex, 255 = all.
    ///
    /// # Errors
    /// [`MeshError::Count`].
    pub fn with_openness(mut self, openness: Vec<u8>) -> Result<Self, MeshError> {
        if openness.len() != self.positions.len() {
            let (found, expected) = (openness.len(), self.positions.len());
            return Err(MeshError::Count { what: "shares of light", found, expected });
        }
        self.openness = Openness::PerVertex(openness);
        Ok(self)
    }

    /// This mesh with the share of the light from all around that reaches the points of a [`triangle_lattice`] on each triangle, 255 = all.
    ///
    /// * `steps`: steps along an edge of each triangle; `shares`: of one triangle after the other.
    ///
    /// # Errors
    /// [`MeshError::Count`].
    pub fn with_open_lattices(mut self, steps: &[u8], shares: Vec<u8>) -> Result<Self, MeshError> {
        let mut places = Vec::with_capacity(steps.len());
        let mut expected = 0;
        for &n in steps {
            places.push((expected as u32, n));
            expected += points(n);
        }
        let fits = steps.len() == self.triangles.len() && shares.len() == expected;
        if !fits || expected > Self::MAX {
            return Err(MeshError::Count { what: "shares of light", found: shares.len(), expected });
        }
        self.openness = Openness::Lattices(Lattices { places, shares });
        Ok(self)
    }

    /// Whether the mesh has shares of the light from all around.
    pub fn has_openness(&self) -> bool {
        self.openness != Openness::Unknown
    }

    /// Share of the light from all around at a point of a triangle given by the weights of its corners, 0..=1; 1 where it is not known.
    pub fn openness_at(&self, triangle: usize, weights: [f64; 3]) -> f64 {
        self.openness.at(triangle, self.triangles[triangle], weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshColors;
    use belvedere_core::DVec3;

    #[test]
    fn a_lattice_gives_back_what_is_linear_and_what_it_holds() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let mesh = Mesh::new(&corners, vec![[0, 1, 2], [1, 3, 2]], MeshColors::Layer).unwrap();
        let linear = |w: [f64; 3]| 20.0 * w[0] + 120.0 * w[1] + 220.0 * w[2];
        for steps in [1, 2, 3, 5, 10] {
            let own: Vec<u8> = triangle_lattice(steps).map(|w| linear(w).round() as u8).collect();
            let shares = [vec![7, 7, 7], own.clone()].concat();
            let mesh = mesh.clone().with_open_lattices(&[1, steps], shares).unwrap();
            for (w, share) in triangle_lattice(steps).zip(own) {
                assert!((255.0 * mesh.openness_at(1, w) - f64::from(share)).abs() < 1e-9, "{steps} {w:?}");
            }
            for w in triangle_lattice(37) {
                assert!((255.0 * mesh.openness_at(1, w) - linear(w)).abs() < 0.6, "{steps} {w:?}");
                assert!((255.0 * mesh.openness_at(0, w) - 7.0).abs() < 1e-9);
            }
            let one = mesh.only(&|t| t == 1);
            assert_eq!(one.openness_at(0, [0.2, 0.3, 0.5]), mesh.openness_at(1, [0.2, 0.3, 0.5]));
        }
        assert!(mesh.with_open_lattices(&[1, 2], vec![0; 8]).is_err());
    }
}
