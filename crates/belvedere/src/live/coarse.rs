//! Meshes of few triangles for moving pictures: vertices within a cube of a lattice become one (vertex clustering after Rossignac and
//! Borrel 1993).

use belvedere_core::DVec3;
use belvedere_scene::{Color, Mesh, MeshColors, MeshLayer, RigidParts};
use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// Lattices that are tried, and the share of the triangles that the next one is made for.
const TRIES: usize = 6;
const SPARE: f64 = 0.9;
/// Corners by which is judged whether a mesh has normals of its own, and least cosine to the normal of the face without them.
const JUDGED: usize = 64;
const SAME: f64 = 0.9999;

/// The layer with a mesh of at most about `most` triangles; `None` if it has no more, or cannot be made coarser.
pub(super) fn layer(layer: &MeshLayer, most: usize) -> Option<MeshLayer> {
    let mesh = clustered(&layer.mesh, most, layer.rigid != RigidParts::None, layer.color)?;
    let (names, wanted, rigid) = (layer.names.clone(), layer.wanted.clone(), layer.rigid.clone());
    let (opacity, has_plate) = (layer.opacity, layer.has_plate);
    Some(MeshLayer { mesh, color: layer.color, names, wanted, rigid, opacity, has_plate })
}

/// * `apart`: whether parts share no vertices. `plain`: colour where the mesh has none.
fn clustered(mesh: &Mesh, most: usize, apart: bool, plain: Color) -> Option<Mesh> {
    let count = mesh.triangles().len();
    if count <= most {
        return None;
    }
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        0.5 * (b - a).cross(c - a).length()
    };
    let total: f64 = (0..count).map(area).sum();
    let mut side = (2.0 * total / most.max(1) as f64).sqrt();
    if !(side > 0.0 && side.is_finite()) {
        return None;
    }
    for _ in 0..TRIES {
        let made = on_lattice(mesh, side, apart);
        if made.triangles.len() <= most {
            return finished(mesh, made, side, plain);
        }
        side *= (made.triangles.len() as f64 / (SPARE * most as f64)).sqrt();
    }
    None
}

/// A quick hash of a few numbers: multiplied by an odd constant and folded, one after the other.
#[derive(Default)]
struct Fold(u64);

impl Hasher for Fold {
    fn write(&mut self, bytes: &[u8]) {
        for four in bytes.chunks(4) {
            self.write_u32(four.iter().fold(0, |n, byte| n << 8 | u32::from(*byte)));
        }
    }

    fn write_u32(&mut self, n: u32) {
        let product = (u128::from(self.0 ^ u64::from(n)) + 1) * 0x9e37_79b9_7f4a_7c15;
        self.0 = (product as u64) ^ (product >> 64) as u64;
    }

    fn write_i32(&mut self, n: i32) {
        self.write_u32(n as u32);
    }

    fn write_usize(&mut self, n: usize) {
        self.write_u32(n as u32);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

type Quick = BuildHasherDefault<Fold>;

/// Clusters of vertices.
struct Clusters {
    /// By triangle and corner.
    of: Vec<[u32; 3]>,
    /// Sum of the positions of the corners in a cluster, relative to the mesh's origin, and their number.
    sums: Vec<(DVec3, f64)>,
    /// Triangles between three clusters, and the triangles of the mesh that they were.
    triangles: Vec<([u32; 3], usize)>,
}

fn on_lattice(mesh: &Mesh, side: f64, apart: bool) -> Clusters {
    let mut known: HashMap<([i32; 3], u32), u32, Quick> = HashMap::default();
    let (mut sums, mut seen) = (Vec::new(), HashSet::<[u32; 3], Quick>::default());
    let (mut of, mut triangles) = (Vec::with_capacity(mesh.triangles().len()), Vec::new());
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let part = if apart { mesh.part(t).unwrap_or(u32::MAX) } else { 0 };
        let clusters = corners.map(|v| {
            let p = mesh.positions()[v as usize].as_dvec3();
            let cube = (p / side).floor().to_array().map(|x| x as i32);
            let next = sums.len() as u32;
            let cluster = *known.entry((cube, part)).or_insert(next);
            if cluster == next {
                sums.push((DVec3::ZERO, 0.0));
            }
            let (sum, n) = &mut sums[cluster as usize];
            (*sum, *n) = (*sum + p, *n + 1.0);
            cluster
        });
        of.push(clusters);
        let mut key = clusters;
        key.sort_unstable();
        if key[0] != key[1] && key[1] != key[2] && seen.insert(key) {
            triangles.push((clusters, t));
        }
    }
    Clusters { of, sums, triangles }
}

fn finished(mesh: &Mesh, made: Clusters, side: f64, plain: Color) -> Option<Mesh> {
    let positions: Vec<DVec3> = made.sums.iter().map(|(sum, n)| mesh.origin() + *sum / *n).collect();
    let color = |t: usize| mesh.surface_color_at(t, [1.0 / 3.0; 3], side);
    let colors = match made.triangles.iter().any(|(_, t)| color(*t).is_some()) {
        true => MeshColors::PerTriangle(made.triangles.iter().map(|(_, t)| color(*t).unwrap_or(plain)).collect()),
        false => MeshColors::Layer,
    };
    let parts = made.triangles.iter().filter_map(|(_, t)| mesh.part(*t)).collect();
    let smooth = is_smooth(mesh).then(|| normals(mesh, &made));
    let triangles = made.triangles.into_iter().map(|(corners, _)| corners).collect();
    let mesh = Mesh::in_parts(&positions, triangles, colors, parts).ok()?;
    match smooth {
        Some(normals) => mesh.with_normals(&normals).ok(),
        None => Some(mesh),
    }
}

/// Whether a mesh has normals of its own: some corner's is not that of its face.
fn is_smooth(mesh: &Mesh) -> bool {
    let count = mesh.triangles().len();
    let every = count.div_ceil(JUDGED).max(1);
    (0..count).step_by(every).any(|t| mesh.normal_at(t, [1.0, 0.0, 0.0]).dot(mesh.face_normal(t)) < SAME)
}

fn normals(mesh: &Mesh, made: &Clusters) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; made.sums.len()];
    for (t, clusters) in made.of.iter().enumerate() {
        for (corner, cluster) in clusters.iter().enumerate() {
            let weights = std::array::from_fn(|k| if k == corner { 1.0 } else { 0.0 });
            sums[*cluster as usize] += mesh.normal_at(t, weights);
        }
    }
    sums
}

#[cfg(test)]
mod tests;
