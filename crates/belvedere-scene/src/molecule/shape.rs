//! Triangles of a molecule under way: with normals, light, colours, and the atom that each belongs to.

use super::ModelTransform;
use crate::{Color, Mesh, MeshColors, MeshError};
use belvedere_core::DVec3;

/// Vertices and triangles, angstrom.
#[derive(Debug, Clone, Default)]
pub(super) struct Shape {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    /// Share of the light from all around, 255 = all.
    pub(super) open: Vec<u8>,
    pub(super) colors: Vec<Color>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Index of the atom of each triangle.
    pub(super) parts: Vec<u32>,
}

/// A share of light in a byte, at least 1.
pub(super) fn byte(open: f64) -> u8 {
    (255.0 * open).round().clamp(1.0, 255.0) as u8
}

impl Shape {
    /// Adds a vertex, and gives its number.
    pub(super) fn vertex(&mut self, position: DVec3, normal: DVec3, open: f64, color: Color) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.open.push(byte(open));
        self.colors.push(color);
        self.positions.len() as u32 - 1
    }

    pub(super) fn triangle(&mut self, corners: [u32; 3], atom: u32) {
        self.triangles.push(corners);
        self.parts.push(atom);
    }

    pub(super) fn append(&mut self, mut other: Self) {
        let first = self.positions.len() as u32;
        self.positions.append(&mut other.positions);
        self.normals.append(&mut other.normals);
        self.open.append(&mut other.open);
        self.colors.append(&mut other.colors);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        self.parts.append(&mut other.parts);
    }

    /// One of many.
    pub(super) fn joined(pieces: Vec<Self>) -> Result<Self, MeshError> {
        let vertices: usize = pieces.iter().map(|p| p.positions.len()).sum();
        let triangles: usize = pieces.iter().map(|p| p.triangles.len()).sum();
        for (what, count) in [("vertices", vertices), ("triangles", triangles)] {
            if count > Mesh::MAX {
                return Err(MeshError::TooMany { what, count });
            }
        }
        let mut out = Self {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            open: Vec::with_capacity(vertices),
            colors: Vec::with_capacity(vertices),
            triangles: Vec::with_capacity(triangles),
            parts: Vec::with_capacity(triangles),
        };
        pieces.into_iter().for_each(|piece| out.append(piece));
        Ok(out)
    }

    /// The mesh in the scene.
    pub(super) fn mesh(mut self, placement: &ModelTransform) -> Result<Mesh, MeshError> {
        self.positions.iter_mut().for_each(|p| *p = placement.apply(*p));
        self.normals.iter_mut().for_each(|n| *n = placement.turn * *n);
        Mesh::in_parts(&self.positions, self.triangles, MeshColors::PerVertex(self.colors), self.parts)?
            .with_normals(&self.normals)?
            .with_openness(self.open)
    }
}

#[cfg(test)]
pub(super) mod closed {
    use super::Shape;
    use std::collections::HashMap;

    /// Corners minus edges plus faces of a shape whose vertices at one place count once; a panic if it is not closed. 2 for each ball.
    pub(in crate::molecule) fn euler(shape: &Shape) -> i64 {
        let mut number: HashMap<[i64; 3], u32> = HashMap::new();
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        let mut faces = 0;
        for t in &shape.triangles {
            let corners = t.map(|v| {
                let key = (shape.positions[v as usize] * 1e7).round().to_array().map(|x| x as i64);
                let next = number.len() as u32;
                *number.entry(key).or_insert(next)
            });
            let [a, b, c] = corners;
            if a == b || b == c || c == a {
                continue;
            }
            faces += 1;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|n| *n == 0), "every edge is passed once in either direction");
        let used: std::collections::HashSet<u32> = edges.keys().flatten().copied().collect();
        used.len() as i64 - edges.len() as i64 + faces
    }
}
