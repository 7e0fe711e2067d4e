//! Wavefront OBJ, with the diffuse colours and pictures of its MTL file, its objects and groups as parts.

use super::{MeshFile, color, neighbour, obj_text, picture};
use crate::{Fault, InputFile, IoError, Limits, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, MeshColors, Texture, Texturing};
use glam::{DVec3, Vec2};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Grey of faces without a material among faces that have one.
const PLAIN: Color = Color::rgb(200, 196, 190);

pub(super) fn read(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let options = tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, single_index: false };
    let files = std::cell::RefCell::new(Vec::new());
    let odd = std::cell::RefCell::new(Vec::new());
    let materials = |name: &Path| {
        let name = name.to_str().ok_or(tobj::LoadError::OpenFileFailed)?;
        // One name, which may hold blanks, else several.
        let found: Vec<_> = match neighbour(path, name, limits) {
            Ok(found) => vec![found],
            Err(_) => name.split_whitespace().filter_map(|word| neighbour(path, word, limits).ok()).collect(),
        };
        if found.is_empty() {
            return Err(tobj::LoadError::OpenFileFailed);
        }
        let mut text = String::new();
        for (bytes, file) in found {
            text.push_str(&obj_text::materials(&bytes, &mut odd.borrow_mut()));
            text.push('\n');
            files.borrow_mut().push(file);
        }
        tobj::load_mtl_buf(&mut text.as_bytes())
    };
    let text = obj_text::statements(bytes);
    let read = |text: &str| tobj::load_obj_buf(&mut text.as_bytes(), &options, materials);
    let mut cut = None;
    let (models, materials) = match read(&text) {
        // Colours of some vertices only are none.
        Err(tobj::LoadError::FaceColorOutOfBounds) => {
            files.borrow_mut().clear();
            odd.borrow_mut().clear();
            read(&obj_text::without_colors(&text))
        }
        // The end of the file may have cut its last line.
        Err(e) if !bytes.ends_with(b"\n") && text.lines().count() > 1 => {
            files.borrow_mut().clear();
            odd.borrow_mut().clear();
            let before = text.trim_end().rfind('\n').map_or(0, |at| at + 1);
            let last: String = text[before..].trim().chars().take(40).collect();
            let said = format!("its last line ({last}) is not whole; what stands before is read");
            cut = Some(Warning::new(WarningKind::Repaired, said).in_file(path));
            read(&text[..before]).map_err(|_| e)
        }
        found => found,
    }
    .map_err(|e| IoError::format(path, format!("{}; it is damaged or no OBJ file", obj_text::fault(&e, &text))))?;
    let missing = materials.is_err().then(|| obj_text::material_files(&text));
    let mut warnings: Vec<Warning> =
        cut.into_iter().chain(said_of_materials(path, missing, &odd.into_inner())).collect();
    let mut materials = Materials::new(path, materials.unwrap_or_default(), limits);
    let mut builder = Builder::default();
    for model in models {
        builder.add(path, &model, &mut materials)?;
    }
    if let Some(reason) = materials.refused.take() {
        return Err(IoError::format(path, reason));
    }
    warnings.append(&mut materials.warnings);
    let mut files = files.into_inner();
    files.append(&mut materials.files);
    Ok(Loaded { value: builder.finish(materials.textures), warnings, files })
}

/// What is said of the files of materials.
///
/// * `missing`: their names, if none can be read. `odd`: lines that are not read.
fn said_of_materials(path: &Path, missing: Option<String>, odd: &[String]) -> Vec<Warning> {
    let missing = missing.map(|names| {
        let text = format!(
            "its file of materials {names} cannot be read, so the colour of the layer is used; put it beside the OBJ file"
        );
        Warning::new(WarningKind::Fallback, text)
    });
    let odd = odd.first().map(|first| {
        let text = format!("{} lines of its materials are not read, the first is {first:?}", odd.len());
        Warning::new(WarningKind::Ignored, text).with("count", odd.len() as f64)
    });
    missing.into_iter().chain(odd).map(|w| w.in_file(path)).collect()
}

/// Materials, and the pictures of those that are used.
struct Materials<'p> {
    path: &'p Path,
    limits: &'p Limits,
    list: Vec<tobj::Material>,
    /// Number of the picture by its name; `None` = it cannot be read.
    known: HashMap<String, Option<u32>>,
    textures: Vec<Arc<Texture>>,
    files: Vec<InputFile>,
    warnings: Vec<Warning>,
    /// Why a picture was refused for want of memory.
    refused: Option<Fault>,
}

impl<'p> Materials<'p> {
    fn new(path: &'p Path, list: Vec<tobj::Material>, limits: &'p Limits) -> Self {
        let (known, textures, files, warnings) = (HashMap::new(), Vec::new(), Vec::new(), Vec::new());
        Self { path, limits, list, known, textures, files, warnings, refused: None }
    }

    /// Colour and picture of a material; where it has a picture and no colour, white.
    fn look(&mut self, id: Option<usize>) -> (Option<Color>, u32) {
        let Some(material) = id.and_then(|id| self.list.get(id)) else { return (None, Texturing::NONE) };
        let diffuse = material.diffuse.map(color);
        let Some(name) = material.diffuse_texture.clone() else { return (diffuse, Texturing::NONE) };
        // Options such as -s stand before the name.
        let name = name.split_whitespace().last().unwrap_or("").to_owned();
        let texture = match self.known.get(&name) {
            Some(known) => *known,
            None => {
                let read = self.read(&name);
                self.known.insert(name, read);
                read
            }
        };
        match texture {
            Some(number) => (Some(diffuse.unwrap_or(Color::rgb(255, 255, 255))), number),
            None => (diffuse, Texturing::NONE),
        }
    }

    fn read(&mut self, name: &str) -> Option<u32> {
        let limits = picture::beside(self.limits, &self.textures);
        let read = neighbour(self.path, name, &limits)
            .and_then(|(bytes, file)| Ok((picture::read(&bytes, Default::default(), &limits)?, file)));
        match read {
            Ok((texture, file)) => {
                self.textures.push(Arc::new(texture));
                self.files.push(file);
                Some(self.textures.len() as u32 - 1)
            }
            Err(e) => {
                let e = e.placed(format_args!("picture {name:?}"));
                self.warnings
                    .push(Warning::new(WarningKind::Ignored, format!("{e}; it is left out")).in_file(self.path));
                self.refused = self.refused.take().or(Some(e).filter(Fault::is_of_memory));
                None
            }
        }
    }
}

#[derive(Default)]
struct Builder {
    out: MeshFile,
    normals: Vec<DVec3>,
    per_vertex: Vec<Color>,
    per_triangle: Vec<Color>,
    texturing: Texturing,
    part_of: HashMap<String, u32>,
    smooth: bool,
    painted: bool,
    has_material: bool,
}

impl Builder {
    fn add(&mut self, path: &Path, model: &tobj::Model, materials: &mut Materials<'_>) -> Result<(), IoError> {
        let mesh = &model.mesh;
        let first = self.out.positions.len() as u32;
        let count = mesh.positions.len() / 3;
        self.out.positions.extend(mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let known = mesh.indices.iter().all(|&v| (v as usize) < count) && mesh.indices.len().is_multiple_of(3);
        if !known || self.out.positions.len() > u32::MAX as usize {
            return Err(IoError::format(path, "a face names a vertex that there is not; it is damaged"));
        }
        self.out.triangles.extend(mesh.indices.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        // One normal per corner in the file; where the corners of a vertex differ, the file means a sharp edge and none is kept.
        self.normals.resize(self.out.positions.len(), DVec3::ZERO);
        self.smooth |= corner_normals(mesh, &mut self.normals[first as usize..]);
        let painted_here = mesh.vertex_color.len() == 3 * count;
        self.painted |= painted_here && count > 0;
        let vertex =
            |i: usize| if painted_here { color([0, 1, 2].map(|k| mesh.vertex_color[3 * i + k])) } else { PLAIN };
        self.per_vertex.extend((0..count).map(vertex));
        let triangles = mesh.indices.len() / 3;
        let (material, texture) = materials.look(mesh.material_id);
        self.has_material |= material.is_some();
        self.per_triangle.extend(std::iter::repeat_n(material.unwrap_or(PLAIN), triangles));
        let corners = places(mesh);
        let texture = if corners.is_some() { texture } else { Texturing::NONE };
        self.texturing.of_triangle.extend(std::iter::repeat_n(texture, triangles));
        self.texturing.corners.extend(corners.unwrap_or_else(|| vec![[Vec2::ZERO; 3]; triangles]));
        let next = self.out.names.len() as u32;
        // The reader's word for triangles before the first object or group.
        let name = if model.name == "unnamed_object" { "" } else { model.name.as_str() };
        let part = *self.part_of.entry(name.to_owned()).or_insert(next);
        if part == next {
            self.out.names.push(name.to_owned());
        }
        self.out.parts.extend(std::iter::repeat_n(part, triangles));
        Ok(())
    }

    fn finish(self, textures: Vec<Arc<Texture>>) -> MeshFile {
        let Self { mut out, normals, per_vertex, per_triangle, texturing, smooth, painted, has_material, .. } = self;
        out.format = "OBJ";
        if out.names.iter().all(String::is_empty) {
            out.names.clear();
            out.parts.clear();
        }
        out.normals = smooth.then_some(normals);
        out.colors = match (painted, has_material) {
            (true, _) => MeshColors::PerVertex(per_vertex),
            (false, true) => MeshColors::PerTriangle(per_triangle),
            _ => MeshColors::Layer,
        };
        out.texturing = (!textures.is_empty()).then_some(Texturing { textures, ..texturing });
        out
    }
}

/// Places of the corners of all triangles in their picture; `None` where the file has none. Its v axis points up.
fn places(mesh: &tobj::Mesh) -> Option<Vec<[Vec2; 3]>> {
    let place = |i: &u32| {
        let at = mesh.texcoords.get(2 * *i as usize..2 * *i as usize + 2)?;
        Some(Vec2::new(at[0] as f32, 1.0 - at[1] as f32)).filter(|p| p.is_finite())
    };
    if mesh.texcoord_indices.len() != mesh.indices.len() {
        return None;
    }
    let corners = mesh.texcoord_indices.chunks_exact(3);
    corners.map(|t| Some([place(&t[0])?, place(&t[1])?, place(&t[2])?])).collect()
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
