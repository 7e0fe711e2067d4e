//! Triangle meshes: OBJ, PLY, STL, glTF and GLB.

mod gltf;
mod gltf_check;
mod gltf_pictures;
mod obj;
mod obj_text;
pub(crate) mod picture;
mod ply;
mod stl;

use crate::formats::Reader;
use crate::fs::{beside, spellings};
use crate::packed::content;
use crate::recognise::{explain, not_a};
use crate::{Fault, InputFile, IoError, Limits, Loaded, budget, fs};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, MeshColors, Texturing};
use glam::DVec3;
use std::path::Path;

/// Content of a mesh file, in the file's own coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshFile {
    /// Name of the format.
    pub format: &'static str,
    /// Vertices.
    pub positions: Vec<DVec3>,
    /// Vertex numbers of the triangles; each below the number of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Directions for smooth shading, one per vertex; zero = none. `None` if no vertex has one.
    pub normals: Option<Vec<DVec3>>,
    /// Colours.
    pub colors: MeshColors,
    /// Number of the part that each triangle belongs to; empty = the file names no parts.
    pub parts: Vec<u32>,
    /// Names of the parts, as paths through the file.
    pub names: Vec<String>,
    /// Pictures, which multiply the colours.
    pub texturing: Option<Texturing>,
}

type Read = fn(&Path, &[u8], &Limits) -> Result<Loaded<MeshFile>, IoError>;

/// Reads a mesh. Faces of more corners become fans, lines and points are left out; the file's own axes are kept, but for glTF, whose y axis
/// points up and becomes z.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, too large for `limits`, or has no triangle.
pub fn load_mesh(path: &Path, limits: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let path = &content(path, limits.max_bytes, &|p| Reader::Mesh.reads(p))?;
    let ending = crate::recognise::ending(path);
    let read: Read = match ending.as_str() {
        "obj" => obj::read,
        "ply" => ply::read,
        "stl" => stl::read,
        "gltf" | "glb" => gltf::read,
        _ => return Err(not_a(path, "a mesh that this version reads: OBJ, PLY, STL, glTF or GLB")),
    };
    let _work = budget::work_on(path);
    let bytes = read_bytes(path, limits)?;
    let mut loaded = read(path, &bytes, limits).map_err(explain)?.with_file(InputFile::of(path, &bytes));
    let mesh = &mut loaded.value;
    if mesh.triangles.is_empty() {
        let reason = "the mesh has no triangles; a surface is needed, points and lines are not drawn";
        return Err(explain(IoError::format(path, reason)));
    }
    let odd = drop_not_finite(mesh);
    if mesh.triangles.is_empty() {
        return Err(IoError::format(path, "no triangle of the mesh has finite vertices only; repair it"));
    }
    let odd = Warning::counted(WarningKind::Ignored, odd, "triangles with a vertex that is not finite are left out");
    loaded.warnings.extend(odd.map(|w| w.in_file(path)));
    Ok(loaded)
}

/// The whole file, if the decoded mesh fits the limits.
fn read_bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>, IoError> {
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    // Vertices and triangles take at most a few times the bytes that a file spends on them.
    limits.ask("the mesh", length.saturating_mul(6)).map_err(|reason| IoError::format(path, reason))?;
    fs::read(path).map_err(|e| IoError::os(path, e))
}

/// A picture or a file of materials beside `path`, if it can be read, under its name or in another spelling of it.
pub(crate) fn neighbour(path: &Path, name: &str, limits: &Limits) -> Result<(Vec<u8>, InputFile), Fault> {
    let read = |name: &str| {
        let file = beside(path, name)?;
        let bytes = read_bytes(&file, limits)?;
        let record = InputFile::of(&file, &bytes);
        Ok((bytes, record))
    };
    read(name).or_else(|error| spellings(name).iter().find_map(|name| read(name).ok()).ok_or(error))
}

/// Removes triangles with a vertex that is not finite, and sets such vertices to zero. Returns their number.
fn drop_not_finite(mesh: &mut MeshFile) -> usize {
    let fine: Vec<bool> = mesh.positions.iter().map(|p| p.as_vec3().is_finite()).collect();
    let before = mesh.triangles.len();
    let keep: Vec<bool> = mesh.triangles.iter().map(|t| t.iter().all(|&v| fine[v as usize])).collect();
    let mut kept = keep.iter();
    mesh.triangles.retain(|_| kept.next() == Some(&true));
    if let MeshColors::PerTriangle(colors) = &mut mesh.colors {
        let mut kept = keep.iter();
        colors.retain(|_| kept.next() == Some(&true));
    }
    let mut kept = keep.iter();
    mesh.parts.retain(|_| kept.next() == Some(&true));
    if let Some(t) = &mut mesh.texturing {
        let mut kept = keep.iter();
        t.of_triangle.retain(|_| kept.next() == Some(&true));
        let mut kept = keep.iter();
        t.corners.retain(|_| kept.next() == Some(&true));
    }
    mesh.positions.iter_mut().zip(fine).filter(|(_, fine)| !fine).for_each(|(p, _)| *p = DVec3::ZERO);
    before - mesh.triangles.len()
}

/// An sRGB colour of shares 0..=1; NaN counts as 0.
fn color(shares: [f64; 3]) -> Color {
    let [r, g, b] = shares.map(|s| (255.0 * s.clamp(0.0, 1.0)).round() as u8);
    Color::rgb(r, g, b)
}
