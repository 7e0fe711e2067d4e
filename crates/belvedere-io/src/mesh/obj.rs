//! Wavefront OBJ, with the diffuse colours of its MTL file.

use super::{MeshFile, beside, color};
use crate::{IoError, Limits, Loaded};
use belvedere_scene::{Color, MeshColors};
use glam::DVec3;
use std::path::Path;

/// Grey of faces without a material among faces that have one.
const PLAIN: Color = Color::rgb(200, 196, 190);

pub(super) fn read(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let options = tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, single_index: false };
    let materials = |name: &Path| {
        let file = name.to_str().ok_or(tobj::LoadError::OpenFileFailed)?;
        let file = beside(path, file).map_err(|_| tobj::LoadError::OpenFileFailed)?;
        let bytes = super::read_bytes(&file, limits).map_err(|_| tobj::LoadError::OpenFileFailed)?;
        tobj::load_mtl_buf(&mut bytes.as_slice())
    };
    let (models, materials) = tobj::load_obj_buf(&mut &*bytes, &options, materials)
        .map_err(|e| IoError::format(path, format!("{e}; it is damaged or no OBJ file")))?;
    let mut warnings = Vec::new();
    if let Err(e) = &materials {
        warnings.push(format!("{}: its materials cannot be read ({e}), the layer's colour is used", path.display()));
    }
    let materials = materials.unwrap_or_default();
    let mut out = MeshFile { format: "OBJ", ..MeshFile::default() };
    let (mut normals, mut per_vertex, mut per_triangle) = (Vec::new(), Vec::new(), Vec::new());
    let (mut smooth, mut painted, mut has_material) = (false, false, false);
    for model in models {
        let mesh = model.mesh;
        let first = out.positions.len() as u32;
        let count = mesh.positions.len() / 3;
        out.positions.extend(mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let known = mesh.indices.iter().all(|&v| (v as usize) < count) && mesh.indices.len() % 3 == 0;
        if !known || out.positions.len() > u32::MAX as usize {
            return Err(IoError::format(path, "a face names a vertex that there is not; it is damaged"));
        }
        out.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        // One normal per corner in the file; where the corners of a vertex differ, the file means a sharp edge and none is kept.
        normals.resize(out.positions.len(), DVec3::ZERO);
        smooth |= corner_normals(&mesh, &mut normals[first as usize..]);
        let painted_here = mesh.vertex_color.len() == 3 * count;
        painted |= painted_here && count > 0;
        per_vertex.extend(
            (0..count).map(
                |i| {
                    if painted_here { color([0, 1, 2].map(|k| mesh.vertex_color[3 * i + k])) } else { PLAIN }
                },
            ),
        );
        let material = mesh.material_id.and_then(|id| materials.get(id)).and_then(|m| m.diffuse);
        has_material |= material.is_some();
        per_triangle.extend(std::iter::repeat_n(material.map_or(PLAIN, color), mesh.indices.len() / 3));
    }
    out.normals = smooth.then_some(normals);
    out.colors = match (painted, has_material) {
        (true, _) => MeshColors::PerVertex(per_vertex),
        (false, true) => MeshColors::PerTriangle(per_triangle),
        _ => MeshColors::Layer,
    };
    Ok(Loaded::new(out, warnings))
}

/// Fills in the normals of vertices whose corners agree; whether there are any.
fn corner_normals(mesh: &tobj::Mesh, out: &mut [DVec3]) -> bool {
    let mut any = false;
    let mut torn = vec![false; out.len()];
    for (&v, &n) in mesh.indices.iter().zip(&mesh.normal_indices) {
        let Some(n) = mesh.normals.get(3 * n as usize..3 * n as usize + 3) else { continue };
        let (n, v) = (DVec3::from_slice(n).normalize_or_zero(), v as usize);
        torn[v] |= out[v] != DVec3::ZERO && out[v].dot(n) < 0.999;
        out[v] = n;
        any = true;
    }
    for (n, torn) in out.iter_mut().zip(torn) {
        if torn {
            *n = DVec3::ZERO;
        }
    }
    any
}
