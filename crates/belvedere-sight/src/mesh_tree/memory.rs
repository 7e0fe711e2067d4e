//! Trees over meshes that are kept for the next frame of a film.

use super::MeshTree;
use belvedere_scene::Mesh;
use obvhs::bvh2::Bvh2;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Trees that are remembered, at most; the one that was used longest ago is forgotten first.
const TREES: usize = 8;

/// Trees of meshes without some of their parts. What is asked for again is not built again; results are those without it.
#[derive(Clone, Default)]
pub struct TreeMemory(Arc<Mutex<Vec<Kept>>>);

struct Kept {
    /// Shares its triangles with the mesh that was asked for, so that they stay where they are.
    mesh: Mesh,
    left_out: Vec<u32>,
    tree: Arc<Bvh2>,
}

impl TreeMemory {
    /// [`MeshTree::without_parts`], or the whole tree where `left_out` is empty.
    pub fn without_parts<'a>(&self, mesh: &'a Mesh, left_out: &[u32]) -> MeshTree<'a> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is = |k: &Kept| k.mesh.shares_triangles(mesh) && k.left_out == left_out;
        if let Some(at) = kept.iter().position(is) {
            let found = kept.remove(at);
            let tree = MeshTree::with_tree(mesh, found.tree.clone());
            kept.push(found);
            return tree;
        }
        let made = if left_out.is_empty() { MeshTree::new(mesh) } else { MeshTree::without_parts(mesh, left_out) };
        if kept.len() == TREES {
            kept.remove(0);
        }
        kept.push(Kept { mesh: mesh.clone(), left_out: left_out.to_vec(), tree: made.tree.clone() });
        made
    }
}

impl fmt::Debug for TreeMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("TreeMemory")
    }
}

/// What is remembered changes no result.
impl PartialEq for TreeMemory {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec3;
    use belvedere_scene::MeshColors;

    #[test]
    fn a_tree_is_built_once_for_the_same_triangles_and_parts() {
        let quad = |z: f64| {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE].map(|p| p.with_z(z));
            Mesh::in_parts(&corners, vec![[0, 1, 2], [1, 3, 2]], MeshColors::Layer, vec![0, 1]).expect("well formed")
        };
        let (memory, mesh, other) = (TreeMemory::default(), quad(0.0), quad(0.5));
        let first = memory.without_parts(&mesh, &[1]);
        let again = mesh.clone();
        assert!(Arc::ptr_eq(&memory.without_parts(&again, &[1]).tree, &first.tree));
        let [below, above] = [DVec3::new(0.2, 0.2, -1.0), DVec3::new(0.2, 0.2, 1.0)];
        for (mesh, left_out, crossed) in [(&mesh, &[1][..], true), (&mesh, &[0][..], false), (&mesh, &[][..], true)] {
            assert_eq!(memory.without_parts(mesh, left_out).is_crossed(below, above), crossed, "{left_out:?}");
        }
        let moved = memory.without_parts(&other, &[1]);
        assert!(!Arc::ptr_eq(&moved.tree, &first.tree));
        assert_eq!(moved.first_crossing(below, above), Some((0.75, 0)));
        for k in 0..2 * TREES {
            memory.without_parts(&quad(k as f64), &[]);
        }
        assert_eq!(memory.0.lock().expect("free").len(), TREES);
    }
}
