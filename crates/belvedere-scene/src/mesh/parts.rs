//! Meshes made of some triangles of another mesh, or with some triangles moved.

use super::{Mesh, MeshColors, MeshError};
use belvedere_core::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

impl Mesh {
    /// The triangles for whose numbers `keep` is true, over the same vertices.
    pub fn only(&self, keep: &dyn Fn(usize) -> bool) -> Self {
        let kept: Vec<bool> = (0..self.triangles.len()).map(keep).collect();
        let mut out = self.clone();
        out.retain(&kept);
        out
    }

    /// This mesh with each triangle moved by the `offset` of its number, scene units, finite. Triangles that share vertices and move by
    /// the same keep their shape together; others come apart.
    pub fn moved(&self, offset: &dyn Fn(usize) -> DVec3) -> Self {
        let mut out = Self { boxes: Default::default(), ..self.clone() };
        let mut copies: HashMap<(u32, [u64; 3]), u32> = HashMap::new();
        for t in 0..self.triangles.len() {
            let by = offset(t);
            if by == DVec3::ZERO {
                continue;
            }
            let key = by.to_array().map(f64::to_bits);
            for (corner, v) in self.triangles[t].into_iter().enumerate() {
                let copy = *copies.entry((v, key)).or_insert_with(|| out.copy_of(v as usize, by));
                Arc::make_mut(&mut out.triangles)[t][corner] = copy;
            }
        }
        out
    }

    /// The triangles that belong to a body, each corner where `carry` puts it (number of the body, scene coordinates; finite in single
    /// precision), without colours. [`Mesh::part`] of the result is the number of the triangle in this mesh.
    ///
    /// # Errors
    /// [`MeshError`], for a corner that is not finite.
    pub fn carried(
        &self,
        body: &dyn Fn(usize) -> Option<usize>,
        carry: &dyn Fn(usize, DVec3) -> DVec3,
    ) -> Result<Self, MeshError> {
        let (mut places, mut triangles, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
        let mut copies: HashMap<(u32, usize), u32> = HashMap::new();
        for (t, corners) in self.triangles.iter().enumerate() {
            let Some(body) = body(t) else { continue };
            triangles.push(corners.map(|v| {
                *copies.entry((v, body)).or_insert_with(|| {
                    places.push(carry(body, self.vertex(v)));
                    (places.len() - 1) as u32
                })
            }));
            numbers.push(t as u32);
        }
        Self::in_parts(&places, triangles, MeshColors::Layer, numbers)
    }

    /// Appends a copy of vertex `v`, moved by `by`, and returns its number.
    fn copy_of(&mut self, v: usize, by: DVec3) -> u32 {
        let moved = (self.positions[v].as_dvec3() + by).as_vec3();
        Arc::make_mut(&mut self.positions).push(moved);
        if let Some(normals) = &mut self.normals {
            normals.push(normals[v]);
        }
        if let MeshColors::PerVertex(colors) = &mut self.colors {
            colors.push(colors[v]);
        }
        self.openness.copy_of(v);
        (self.positions.len() - 1) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Color;

    fn mesh() -> Mesh {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 2.0]].map(DVec3::from_array);
        let colors = MeshColors::PerVertex((0..4).map(|i| Color::rgb(i, 0, 0)).collect());
        Mesh::in_parts(&corners, vec![[0, 1, 2], [1, 3, 2]], colors, vec![0, 1]).unwrap()
    }

    #[test]
    fn what_moves_keeps_its_shape_and_its_colours_and_the_rest_stays() {
        let (mesh, by) = (mesh(), DVec3::new(3.0, -2.0, 0.5));
        let moved = mesh.moved(&|t| if mesh.part(t) == Some(1) { by } else { DVec3::ZERO });
        assert_eq!(moved.corners(0), mesh.corners(0));
        for (a, b) in moved.corners(1).into_iter().zip(mesh.corners(1)) {
            assert!((a - b - by).length() < 1e-6, "{a} {b}");
        }
        for t in 0..2 {
            assert_eq!(moved.color_at(t, [0.2, 0.3, 0.5]), mesh.color_at(t, [0.2, 0.3, 0.5]));
        }
        assert_eq!(moved.vertex_count(), 7);
    }

    #[test]
    fn the_triangles_that_are_kept_keep_their_parts() {
        let one = mesh().only(&|t| t == 1);
        assert_eq!((one.triangles().len(), one.part(0)), (1, Some(1)));
        assert_eq!(one.corners(0), mesh().corners(1));
    }
}
