//! glTF 2.0 and GLB: the triangles of the default scene with their nodes' names and transforms, vertex colours, and base colours and
//! pictures of materials.
//!
//! Buffers lie in the file or below its folder; nothing is fetched. Every reading of a buffer is checked against its size.

use super::gltf_check;
use super::gltf_pictures::Pictures;
use super::{MeshFile, color};
use crate::base64;
use crate::fs::{beside, percent_decoded};
use crate::{InputFile, IoError, Limits, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Color, MeshColors, Texturing};
use glam::{DMat4, DVec3, Vec2};
use gltf::accessor::{DataType, Dimensions};
use gltf::material::AlphaMode;
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Node, Primitive, Semantic};
use std::path::Path;

pub(super) fn read(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    let said = |e: gltf::Error| {
        let said: String = e.to_string().chars().take(160).collect();
        bad(format!("{said}; it is damaged or no glTF 2.0"))
    };
    let (json, blob) = if bytes.starts_with(b"glTF") {
        let glb = gltf::Glb::from_slice(bytes).map_err(said)?;
        (glb.json, glb.bin.map(std::borrow::Cow::into_owned))
    } else {
        (bytes.into(), None)
    };
    let json = gltf_check::checked(&json).map_err(bad)?;
    let gltf = gltf::Gltf::from_slice(&json).map_err(said)?;
    let (buffers, mut files) = buffers(path, &gltf.document, blob, limits)?;
    let out = MeshFile { format: "glTF", ..MeshFile::default() };
    let mut builder = Builder { buffers, out, pictures: Pictures::new(path, limits), ..Builder::default() };
    // A tree visits every node once: more visits than nodes are a cycle.
    builder.visits_left = gltf.document.nodes().count();
    let scene = gltf.document.default_scene().or_else(|| gltf.document.scenes().next());
    let nodes: Vec<Node<'_>> = match &scene {
        Some(scene) => scene.nodes().collect(),
        None => Vec::new(),
    };
    for node in nodes {
        builder.node(&node, DMat4::IDENTITY, "", 0).map_err(bad)?;
    }
    if let Some(refused) = builder.pictures.refused.take() {
        return Err(IoError::format(path, refused));
    }
    let Builder { mut out, mut pictures, see_through, skipped, .. } = builder;
    out.normals = builder.smooth.then_some(builder.normals);
    let textured = !pictures.textures.is_empty();
    out.texturing =
        textured.then(|| Texturing { textures: std::mem::take(&mut pictures.textures), ..builder.texturing });
    files.append(&mut pictures.files);
    if out.names.iter().all(String::is_empty) {
        out.names.clear();
        out.parts.clear();
    }
    out.colors = if builder.painted {
        MeshColors::PerVertex(builder.vertex_colors)
    } else if textured || builder.base.iter().any(|c| *c != Color::rgb(255, 255, 255)) {
        MeshColors::PerTriangle(builder.base)
    } else {
        MeshColors::Layer
    };
    let mut warnings = pictures.warnings;
    let opaque = Warning::counted(WarningKind::Fallback, see_through, "parts are see-through; they are drawn opaque");
    let left_out = Warning::counted(WarningKind::Ignored, skipped, "parts that are no plain triangles are left out");
    warnings.extend(opaque.into_iter().chain(left_out).map(|w| w.in_file(path)));
    Ok(Loaded { value: out, warnings, files })
}

fn buffers(
    path: &Path,
    document: &Document,
    mut blob: Option<Vec<u8>>,
    limits: &Limits,
) -> Result<(Vec<Vec<u8>>, Vec<InputFile>), IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    let (mut out, mut files) = (Vec::new(), Vec::new());
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => {
                blob.take().ok_or_else(|| bad("its binary part is missing; it is damaged".into()))?
            }
            gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => {
                    let text = data.split_once(";base64,").map(|(_, text)| text);
                    text.and_then(base64::decode)
                        .ok_or_else(|| bad("it holds a buffer that is no base64; it is damaged".into()))?
                }
                None => {
                    let file = beside(path, &percent_decoded(uri)).map_err(bad)?;
                    let bytes = super::read_bytes(&file, limits).map_err(|e| bad(format!("its part {e}")))?;
                    files.push(InputFile::of(&file, &bytes));
                    bytes
                }
            },
        };
        out.push(bytes);
    }
    Ok((out, files))
}

#[derive(Default)]
struct Builder<'p> {
    buffers: Vec<Vec<u8>>,
    pictures: Pictures<'p>,
    texturing: Texturing,
    see_through: usize,
    out: MeshFile,
    normals: Vec<DVec3>,
    vertex_colors: Vec<Color>,
    /// Base colour per triangle.
    base: Vec<Color>,
    painted: bool,
    smooth: bool,
    skipped: usize,
    visits_left: usize,
}

/// Deepest nesting of nodes that is followed.
const MAX_DEPTH: usize = 200;

impl Builder<'_> {
    /// * `above`: path of the nodes above.
    fn node(&mut self, node: &Node<'_>, parent: DMat4, above: &str, depth: usize) -> Result<(), String> {
        if self.visits_left == 0 || depth > MAX_DEPTH {
            return Err("its nodes run in a circle or are nested too deeply; repair it".into());
        }
        self.visits_left -= 1;
        let columns = node.transform().matrix().map(|c| c.map(f64::from));
        let transform = parent * DMat4::from_cols_array_2d(&columns);
        let name = node.name().or_else(|| node.mesh().and_then(|m| m.name())).unwrap_or("").trim();
        let path =
            if above.is_empty() || name.is_empty() { format!("{above}{name}") } else { format!("{above}/{name}") };
        if let Some(mesh) = node.mesh() {
            self.out.names.push(path.clone());
            for primitive in mesh.primitives() {
                self.primitive(&primitive, transform)?;
            }
        }
        for child in node.children() {
            self.node(&child, transform, &path, depth + 1)?;
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive<'_>, transform: DMat4) -> Result<(), String> {
        let (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) = primitive.mode() else {
            self.skipped += 1;
            return Ok(());
        };
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.skipped += 1;
            return Ok(());
        };
        let material = primitive.material();
        let base = material.pbr_metallic_roughness().base_color_factor().map(f64::from);
        if material.alpha_mode() != AlphaMode::Opaque {
            // A fully transparent material is not drawn.
            if base[3] <= 0.0 {
                return Ok(());
            }
            self.see_through += 1;
        }
        let positions = self.values(&positions)?;
        let (first, count) = (self.out.positions.len(), positions.len());
        self.out.positions.extend(positions.iter().map(|p| z_up(transform.transform_point3(triple(p)))));
        let normals = primitive.get(&Semantic::Normals).map(|a| self.values(&a)).transpose()?;
        let turn = transform.inverse().transpose();
        self.smooth |= normals.is_some();
        self.normals.extend((0..count).map(|i| {
            let n = normals.as_ref().and_then(|n| n.get(i)).map_or(DVec3::ZERO, triple);
            z_up(turn.transform_vector3(n)).normalize_or_zero()
        }));
        let colors = primitive.get(&Semantic::Colors(0)).map(|a| self.values(&a)).transpose()?;
        self.painted |= colors.is_some();
        self.vertex_colors.extend((0..count).map(|i| {
            let c = colors.as_ref().and_then(|c| c.get(i)).map_or(DVec3::ONE, triple);
            srgb([c.x * base[0], c.y * base[1], c.z * base[2]])
        }));
        let corners: Vec<u32> = match primitive.indices() {
            Some(indices) => self.values(&indices)?.iter().map(|v| v[0] as u32).collect(),
            None => (0..count as u32).collect(),
        };
        if let Some(v) = corners.iter().find(|v| **v as usize >= count) {
            return Err(format!("a triangle names vertex {v} of {count}; it is damaged"));
        }
        if self.out.positions.len() > u32::MAX as usize {
            return Err("it has more than 4 billion vertices; split it".into());
        }
        let (texture, places) = self.texture(primitive, count)?;
        // A mirrored node turns its triangles inside out.
        let mirrored = transform.determinant() < 0.0;
        for [a, b, c] in triangles(primitive.mode(), &corners) {
            let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] };
            self.out.triangles.push([a, b, c].map(|v| v + first as u32));
            self.base.push(srgb([base[0], base[1], base[2]]));
            self.out.parts.push(self.out.names.len().saturating_sub(1) as u32);
            self.texturing.of_triangle.push(texture);
            let place = |v: u32| places.get(v as usize).copied().unwrap_or_default();
            self.texturing.corners.push([a, b, c].map(place));
        }
        Ok(())
    }

    /// Number of the picture of a part's base colour, and the places of its vertices there.
    fn texture(&mut self, primitive: &Primitive<'_>, count: usize) -> Result<(u32, Vec<Vec2>), String> {
        let none = (Texturing::NONE, Vec::new());
        let Some(info) = primitive.material().pbr_metallic_roughness().base_color_texture() else { return Ok(none) };
        let Some(places) = primitive.get(&Semantic::TexCoords(info.tex_coord())) else { return Ok(none) };
        let places: Vec<Vec2> = self.values(&places)?.iter().map(|v| Vec2::new(v[0] as f32, v[1] as f32)).collect();
        let fine = places.len() >= count && places.iter().all(|p| p.is_finite());
        Ok(match self.pictures.number(&info.texture(), &self.buffers).filter(|_| fine) {
            Some(number) => (number, places),
            None => none,
        })
    }

    /// Elements of an accessor, each with its numbers; normalized integers as shares.
    fn values(&self, accessor: &Accessor<'_>) -> Result<Vec<[f64; 4]>, String> {
        let damaged = || "a part of it lies outside its buffer; it is truncated or damaged, get it again".to_owned();
        if accessor.sparse().is_some() {
            return Err("it has sparse accessors, which are not read; store them in full".into());
        }
        let per = match accessor.dimensions() {
            Dimensions::Scalar => 1,
            Dimensions::Vec2 => 2,
            Dimensions::Vec3 => 3,
            Dimensions::Vec4 => 4,
            _ => return Err("it has matrices where vectors are expected; it is damaged".into()),
        };
        let view = accessor.view().ok_or_else(damaged)?;
        let bytes = self.buffers.get(view.buffer().index()).ok_or_else(damaged)?;
        let end = view.offset().checked_add(view.length()).ok_or_else(damaged)?;
        let bytes = bytes.get(view.offset()..end).ok_or_else(damaged)?;
        let stride = view.stride().unwrap_or(accessor.size()).max(1);
        let needed = match accessor.count() {
            0 => 0,
            n => (n - 1)
                .checked_mul(stride)
                .and_then(|b| b.checked_add(accessor.offset())?.checked_add(accessor.size()))
                .ok_or_else(damaged)?,
        };
        if needed > bytes.len() {
            return Err(damaged());
        }
        let part = accessor.size() / per;
        let element = |i: usize| {
            let mut out = [0.0, 0.0, 0.0, 1.0];
            for (k, out) in out.iter_mut().enumerate().take(per) {
                let at = accessor.offset() + i * stride + k * part;
                *out = number(accessor.data_type(), accessor.normalized(), &bytes[at..at + part]);
            }
            out
        };
        Ok((0..accessor.count()).map(element).collect())
    }
}

fn number(kind: DataType, normalized: bool, b: &[u8]) -> f64 {
    let share = |v: f64, largest: f64| if normalized { (v / largest).max(-1.0) } else { v };
    match kind {
        DataType::I8 => share((b[0] as i8).into(), 127.0),
        DataType::U8 => share(b[0].into(), 255.0),
        DataType::I16 => share(i16::from_le_bytes([b[0], b[1]]).into(), 32_767.0),
        DataType::U16 => share(u16::from_le_bytes([b[0], b[1]]).into(), 65_535.0),
        DataType::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
        DataType::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
    }
}

fn triple(v: &[f64; 4]) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

/// glTF's y axis points up, its z axis towards the viewer.
fn z_up(p: DVec3) -> DVec3 {
    DVec3::new(p.x, -p.z, p.y)
}

/// A linear colour as it is stored.
fn srgb(linear: [f64; 3]) -> Color {
    color(linear.map(|v| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }))
}

/// Corners of lists, strips and fans of triangles.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
            .collect(),
        Mode::TriangleFan => corners.windows(2).skip(1).map(|p| [corners[0], p[0], p[1]]).collect(),
        _ => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// glTF 2.0, 3.6.2.2: a normalised integer c is max(c / largest, -1).
    #[test]
    fn stored_numbers() {
        let stored = |kind, bytes: &[u8]| [false, true].map(|normalized| number(kind, normalized, bytes));
        assert_eq!(stored(DataType::I8, &[127]), [127.0, 1.0]);
        assert_eq!(stored(DataType::I8, &[128]), [-128.0, -1.0]);
        assert_eq!(stored(DataType::U8, &[255]), [255.0, 1.0]);
        assert_eq!(stored(DataType::I16, &32_767i16.to_le_bytes()), [32_767.0, 1.0]);
        assert_eq!(stored(DataType::I16, &(-32_768i16).to_le_bytes()), [-32_768.0, -1.0]);
        assert_eq!(stored(DataType::U16, &65_535u16.to_le_bytes()), [65_535.0, 1.0]);
        assert_eq!(stored(DataType::U32, &70_000u32.to_le_bytes()), [70_000.0; 2]);
        assert_eq!(stored(DataType::F32, &0.5f32.to_le_bytes()), [0.5; 2]);
    }

    #[test]
    fn strips_and_fans_of_a_flat_patch_face_one_way() {
        // A zigzag over a level patch, and a fan around its first corner.
        let places = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0]];
        let fan = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        for (mode, places, count) in [(Mode::TriangleStrip, &places[..], 4), (Mode::TriangleFan, &fan[..], 3)] {
            let corners: Vec<u32> = (0..places.len() as u32).collect();
            let areas: Vec<f64> = triangles(mode, &corners)
                .into_iter()
                .map(|t| {
                    let [a, b, c] = t.map(|v| places[v as usize]);
                    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
                })
                .collect();
            assert_eq!(areas.len(), count);
            let first = areas[0].signum();
            assert!(areas.iter().all(|a| a.abs() > 0.5 && a.signum() == first), "{mode:?}: {areas:?}");
        }
    }
}
