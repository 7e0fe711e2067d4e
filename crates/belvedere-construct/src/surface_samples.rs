//! Points spread evenly over surfaces: meshes, molecules, boxes.

use crate::sample::Sample;
use belvedere_core::DVec3;
use belvedere_core::random::Random;
use belvedere_scene::{BoxLayer, BoxShape, LayerKind, MeshLayer, MoleculeLayer, OwnLayer};

/// Samples of a surface, at least and at most.
const SAMPLES: [f64; 2] = [1000.0, 6000.0];

/// How far in front of its surface a sample lies, as a share of the extent of the layer: more than the single precision of its vertices,
/// less than what is seen.
const IN_FRONT: f64 = 2e-5;

/// Seed of the random numbers: every sampling of a surface gives the same points.
const SEED: u64 = 0x5eed;

/// Samples of a surface, with its name.
pub(crate) struct SampledSurface {
    pub(crate) name: String,
    pub(crate) samples: Vec<Sample>,
}

/// Points on the surface of a layer, each for the same share of its area (stratified random sampling).
///
/// * Meshes: all of them, or their wanted parts. Molecules: the drawn surface of the wanted atoms, or of all. Boxes: their walls and tops.
/// * `spacing`: distance between points, scene units; between 1000 and 6000 points are made whatever it says.
///
/// `None` for layers that have no surface of their own.
pub(crate) fn surface(kind: &LayerKind, spacing: f64) -> Option<SampledSurface> {
    let (name, numbers, triangles) = match kind {
        LayerKind::Boxes(layer) => of_boxes(layer),
        LayerKind::Molecule(layer) => of_molecule(layer),
        LayerKind::Mesh(layer) | LayerKind::Own(OwnLayer { surface: layer, .. }) => of_mesh(layer),
        LayerKind::Terrain(_)
        | LayerKind::Volume(_)
        | LayerKind::Line(_)
        | LayerKind::Area(_)
        | LayerKind::Point(_) => return None,
    };
    let bounds = belvedere_core::Aabb::of(triangles.iter().flatten().copied());
    let area: f64 = triangles.iter().map(|t| 0.5 * cross(t).length()).sum();
    let count = (area / (spacing * spacing)).clamp(SAMPLES[0], SAMPLES[1]).ceil() as usize;
    let mut samples = spread(&triangles, count, IN_FRONT * (bounds.max - bounds.min).length());
    for sample in &mut samples {
        sample.triangle = sample.triangle.and_then(|t| numbers.get(t as usize).copied());
    }
    Some(SampledSurface { name, samples })
}

/// The name of a surface, and its triangles with their numbers in the layer.
type Surface = (String, Vec<u32>, Vec<[DVec3; 3]>);

fn of_boxes(layer: &BoxLayer) -> Surface {
    let mut numbers = Vec::new();
    let mut triangles = Vec::new();
    for (k, shape) in layer.boxes.iter().enumerate() {
        triangles.extend(box_triangles(shape));
        numbers.resize(triangles.len(), (BoxShape::TRIANGLES.len() * k) as u32);
    }
    (String::new(), numbers, triangles)
}

/// Walls and top of a box.
pub(crate) fn box_triangles(shape: &BoxShape) -> impl Iterator<Item = [DVec3; 3]> {
    /// Corners (see [`belvedere_scene::BoxShape::corners`]) around each wall and the top, counter-clockwise from outside.
    const FACES: [[usize; 4]; 5] = [[4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    let b = shape.corners();
    FACES.into_iter().flat_map(move |[p, q, r, s]| [[b[p], b[q], b[r]], [b[p], b[r], b[s]]])
}

fn cross([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

fn of_mesh(layer: &MeshLayer) -> Surface {
    let (mesh, wanted) = (&layer.mesh, layer.wanted.as_ref());
    let is_wanted = |t: &usize| wanted.is_none_or(|w| mesh.part(*t).is_some_and(|part| w.contains(&part)));
    let numbers: Vec<u32> = (0..mesh.triangles().len()).filter(is_wanted).map(|t| t as u32).collect();
    let triangles = numbers.iter().map(|t| mesh.corners(*t as usize)).collect();
    let names: Vec<&str> =
        wanted.into_iter().flatten().filter_map(|&part| layer.names.get(part as usize)).map(String::as_str).collect();
    (names.join(", "), numbers, triangles)
}

fn of_molecule(layer: &MoleculeLayer) -> Surface {
    let mesh = &layer.surface.mesh;
    let wanted = layer.wanted.as_ref().map(|w| layer.mask_of(w));
    let is_wanted = |t: &usize| wanted.as_ref().is_none_or(|w| mesh.part(*t).is_some_and(|atom| w[atom as usize]));
    let numbers: Vec<u32> = (0..mesh.triangles().len()).filter(is_wanted).map(|t| t as u32).collect();
    let triangles = numbers.iter().map(|t| mesh.corners(*t as usize)).collect();
    (layer.wanted.as_ref().map(ToString::to_string).unwrap_or_default(), numbers, triangles)
}

/// `count` points spread over triangles, each standing for an equal share of the area, `off` before the surface; with the places of the
/// triangles in the list.
pub(crate) fn spread(triangles: &[[DVec3; 3]], count: usize, off: f64) -> Vec<Sample> {
    let total: f64 = triangles.iter().map(|t| 0.5 * cross(t).length()).sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let each = total / count as f64;
    let mut random = Random::new(SEED);
    let mut out = Vec::with_capacity(count);
    let (mut before, mut next) = (0.0, random.unit() * each);
    for (number, t) in triangles.iter().enumerate() {
        let normal = cross(t);
        let after = before + 0.5 * normal.length();
        while next < after && out.len() < count {
            let [u, v] = inside_triangle(&mut random);
            let p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
            let normal = normal.normalize_or(DVec3::Z);
            let triangle = Some(number as u32);
            out.push(Sample { p_world: p + off * normal, lift: 0.0, amount: each, surface: Some(normal), triangle });
            next = (out.len() as f64 + random.unit()) * each;
        }
        before = after;
    }
    out
}

/// Weights of two corners of a triangle, evenly distributed over it.
fn inside_triangle(random: &mut Random) -> [f64; 2] {
    let [u, v] = [random.unit(), random.unit()];
    if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] }
}

#[cfg(test)]
mod tests;
