//! Bounds of parts of a mesh.

use super::Mesh;
use belvedere_core::Aabb;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Bounds that are computed when they are first asked for; copies of the mesh share them. They follow from the rest of the mesh, so any
/// two are equal.
#[derive(Debug, Clone, Default)]
pub(super) struct Boxes(Arc<OnceLock<Vec<Aabb>>>);

impl PartialEq for Boxes {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Mesh {
    /// Number of triangles of a box, see [`Mesh::boxes`].
    pub const BOX: usize = 512;

    /// Bounds of triangles 0..512, 512..1024 and so on, scene coordinates.
    pub fn boxes(&self) -> &[Aabb] {
        self.boxes.0.get_or_init(|| {
            let parts = self.triangles.par_chunks(Self::BOX);
            parts.map(|part| Aabb::of(part.as_flattened().iter().map(|&v| self.vertex(v)))).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshColors;
    use belvedere_core::DVec3;

    /// `count` triangles in a row, one unit apart.
    fn row(count: u32) -> Mesh {
        let at = |t: u32| [[0.0, 0.0], [0.5, 0.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(f64::from(t) + x, y, 2.0));
        let positions: Vec<DVec3> = (0..count).flat_map(at).collect();
        Mesh::new(&positions, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(), MeshColors::Layer).unwrap()
    }

    #[test]
    fn boxes_follow_the_triangles_of_a_changed_mesh() {
        let mesh = row(1000);
        let ends = |mesh: &Mesh| mesh.boxes().iter().map(|b| [b.min.x, b.max.x]).collect::<Vec<_>>();
        assert_eq!(ends(&mesh), [[0.0, 511.5], [512.0, 999.5]]);
        assert_eq!(ends(&mesh.only(&|t| t >= 500)), [[500.0, 999.5]]);
        let moved = mesh.moved(&|t| if t == 0 { DVec3::new(-40.0, 0.0, 0.0) } else { DVec3::ZERO });
        assert_eq!(ends(&moved)[0], [-40.0, 511.5]);
        assert_eq!(mesh.clone().boxes().as_ptr(), mesh.boxes().as_ptr(), "computed once");
    }
}
