//! GLB, the binary form of glTF 2.0: y up, single precision, one buffer.

use super::ExportReport;
use super::sheet::Sheet;
use crate::{Advice, BelvedereError};
use belvedere_core::{DMat3, DQuat, DVec3, Pinhole, Projection};
use serde_json::{Value, json};

/// Bytes of a file at most: its length is a 32-bit number.
const MOST_BYTES: usize = u32::MAX as usize - (1 << 20);

/// A point of the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ball {
    pub(super) name: String,
    pub(super) layer: String,
    /// Displaced, scene coordinates.
    pub(super) at: DVec3,
    pub(super) radius: f64,
    /// Linear red, green, blue.
    pub(super) color: [f32; 3],
}

/// What a file holds.
pub(super) struct Content<'a> {
    /// Surfaces by their layers.
    pub(super) sheets: &'a [(String, Sheet)],
    pub(super) balls: &'a [Ball],
    pub(super) pinhole: &'a Pinhole,
    /// Scene coordinates of the file's origin.
    pub(super) origin: DVec3,
    pub(super) report: &'a ExportReport,
}

/// Axes of glTF: x east, y up, z south.
fn turned(p: DVec3) -> DVec3 {
    DVec3::new(p.x, p.z, -p.y)
}

/// The file.
pub(super) fn bytes(content: &Content<'_>) -> Result<Vec<u8>, BelvedereError> {
    let mut file = File::default();
    let mut nodes = vec![camera_node(content)];
    for (layer, sheet) in content.sheets {
        let mesh = file.sheet(layer, sheet, content.origin);
        nodes.push(json!({ "name": layer, "mesh": mesh }));
    }
    let mut known: Vec<([f32; 3], usize)> = Vec::new();
    for ball in content.balls {
        let mesh = match known.iter().find(|(color, _)| *color == ball.color) {
            Some((_, mesh)) => *mesh,
            None => {
                let mesh = file.ball(ball.color);
                known.push((ball.color, mesh));
                mesh
            }
        };
        nodes.push(json!({
            "name": ball.name,
            "mesh": mesh,
            "translation": turned(ball.at - content.origin).to_array(),
            "scale": [ball.radius, ball.radius, ball.radius],
            "extras": { "layer": ball.layer },
        }));
    }
    let bin = std::mem::take(&mut file.bin);
    if bin.len() > MOST_BYTES {
        let large = format!("the file would have {} MiB, at most 4095 are possible; ", bin.len() >> 20);
        let advice = Advice::new("give a smaller {}", &["ground_nodes"]).before(large);
        return Err(BelvedereError::Argument(advice));
    }
    let whole = json!({
        "asset": { "version": "2.0", "generator": format!("belvedere {}", crate::VERSION) },
        "scene": 0,
        "scenes": [{
            "name": "belvedere",
            "nodes": (0..nodes.len()).collect::<Vec<_>>(),
            "extras": { "belvedere": extras(content) },
        }],
        "nodes": nodes,
        "cameras": [camera(content.pinhole, content)],
        "meshes": file.meshes,
        "materials": file.materials,
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": bin.len() }],
    });
    packed(&whole, bin)
}

/// Header, JSON and binary chunk.
fn packed(whole: &Value, mut bin: Vec<u8>) -> Result<Vec<u8>, BelvedereError> {
    let mut text = crate::output::json(whole)?.trim_end().to_owned().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + bin.len();
    let mut out = Vec::with_capacity(length);
    out.extend(b"glTF");
    out.extend([2, length as u32].map(u32::to_le_bytes).as_flattened());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    Ok(out)
}

/// What a straight camera cannot say, and where the file lies.
fn extras(content: &Content<'_>) -> Value {
    let report = content.report;
    json!({
        "origin": report.origin,
        "crs": report.crs,
        "unit": report.unit,
        "image": report.view.image,
        "fov_y_deg": report.view.fov_y_deg,
        "scale_px": report.view.scale_px,
        "stages": report.stages,
        "axes": "x east, y up, z south; scene = origin + (x, -z, y)",
        "meaning": "vertices stand where the stages displace them: the camera of this file sees each point at its pixel of the picture",
    })
}

fn camera_node(content: &Content<'_>) -> Value {
    let p = content.pinhole;
    // A camera of glTF looks along its own -z, y up.
    let axes = DMat3::from_cols(turned(p.right), turned(-p.down), turned(-p.forward));
    json!({
        "name": "camera",
        "camera": 0,
        "translation": turned(p.eye - content.origin).to_array(),
        "rotation": DQuat::from_mat3(&axes).normalize().to_array(),
    })
}

fn camera(p: &Pinhole, content: &Content<'_>) -> Value {
    let [width, height] = p.image.map(f64::from);
    let depths = content.sheets.iter().flat_map(|(_, sheet)| sheet.carried.iter().flatten());
    let depths = depths.chain(content.balls.iter().map(|ball| &ball.at)).map(|at| (*at - p.eye).dot(p.forward));
    let far = p.far.unwrap_or_else(|| 2.0 * depths.fold(2.0 * p.near, f64::max));
    match p.projection {
        Projection::Perspective { fov_y } => json!({
            "name": "camera",
            "type": "perspective",
            "perspective": { "yfov": fov_y, "aspectRatio": width / height, "znear": p.near, "zfar": far },
        }),
        Projection::Orthographic { .. } => json!({
            "name": "camera",
            "type": "orthographic",
            "orthographic": { "xmag": 0.5 * width / p.scale_px(), "ymag": 0.5 * height / p.scale_px(), "znear": 0.0, "zfar": far },
        }),
    }
}

#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
}

impl File {
    /// Adds an accessor over its own part of the buffer; returns its number.
    fn accessor(&mut self, bytes: &[u8], target: u32, accessor: Value) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = self.views.len();
        self.views
            .push(json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len(), "target": target }));
        self.bin.extend_from_slice(bytes);
        let mut accessor = accessor;
        accessor["bufferView"] = view.into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]], with_bounds: bool) -> usize {
        let mut accessor = json!({ "componentType": 5126, "type": "VEC3", "count": vectors.len() });
        if with_bounds {
            let fold = |start: f32, pick: fn(f32, f32) -> f32| -> [f32; 3] {
                std::array::from_fn(|k| vectors.iter().map(|v| v[k]).fold(start, pick))
            };
            accessor["min"] = fold(f32::INFINITY, f32::min).map(f64::from).to_vec().into();
            accessor["max"] = fold(f32::NEG_INFINITY, f32::max).map(f64::from).to_vec().into();
        }
        let bytes: Vec<u8> = vectors.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 34962, accessor)
    }

    fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 34963, json!({ "componentType": 5125, "type": "SCALAR", "count": 3 * triangles.len() }))
    }

    fn material(&mut self, name: &str, color: [f32; 3]) -> usize {
        let [r, g, b] = color.map(f64::from);
        self.materials.push(json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        }));
        self.materials.len() - 1
    }

    /// Adds the mesh of a surface; vertices that no triangle uses are left out.
    fn sheet(&mut self, layer: &str, sheet: &Sheet, origin: DVec3) -> usize {
        let mut numbers = vec![u32::MAX; sheet.world.len()];
        let (mut used, mut places) = (Vec::new(), Vec::new());
        for &v in sheet.triangles.iter().flatten() {
            if numbers[v as usize] == u32::MAX {
                numbers[v as usize] = used.len() as u32;
                used.push(v as usize);
                places.push(turned(sheet.carried[v as usize].unwrap_or(origin) - origin));
            }
        }
        let triangles: Vec<[u32; 3]> = sheet.triangles.iter().map(|t| t.map(|v| numbers[v as usize])).collect();
        let single: Vec<[f32; 3]> = places.iter().map(|p| p.as_vec3().to_array()).collect();
        let mut attributes = json!({ "POSITION": self.vectors(&single, true) });
        if sheet.smooth {
            attributes["NORMAL"] = self.vectors(&normals(&places, &triangles), false).into();
        }
        let colors: Vec<u8> = used.iter().flat_map(|&v| color_bytes(sheet.colors[v])).collect();
        let accessor = json!({ "componentType": 5123, "normalized": true, "type": "VEC4", "count": used.len() });
        attributes["COLOR_0"] = self.accessor(&colors, 34962, accessor).into();
        let indices = self.indices(&triangles);
        let material = self.material(layer, [1.0; 3]);
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
        self.meshes.push(json!({ "name": layer, "primitives": [primitive] }));
        self.meshes.len() - 1
    }

    /// Adds a ball of radius 1: an octahedron, split twice.
    fn ball(&mut self, color: [f32; 3]) -> usize {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let mut faces: Vec<[DVec3; 3]> = [[x, y, z], [y, -x, z], [-x, -y, z], [-y, x, z]].to_vec();
        let below: Vec<[DVec3; 3]> = faces.iter().map(|[a, b, _]| [*b, *a, -z]).collect();
        faces.extend(below);
        for _ in 0..2 {
            let split = |&[a, b, c]: &[DVec3; 3]| {
                let [m, n, o] = [a + b, b + c, c + a].map(DVec3::normalize);
                [[a, m, o], [m, b, n], [o, n, c], [m, n, o]]
            };
            faces = faces.iter().flat_map(split).collect();
        }
        let corners: Vec<[f32; 3]> = faces.iter().flatten().map(|p| p.as_vec3().to_array()).collect();
        let triangles: Vec<[u32; 3]> = (0..faces.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let (position, normal) = (self.vectors(&corners, true), self.vectors(&corners, false));
        let indices = self.indices(&triangles);
        let material = self.material("point", color);
        let attributes = json!({ "POSITION": position, "NORMAL": normal });
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
        self.meshes.push(json!({ "name": "point", "primitives": [primitive] }));
        self.meshes.len() - 1
    }
}

/// A colour of a vertex: linear, 16 bits, opaque.
fn color_bytes(color: [f32; 3]) -> [u8; 8] {
    let [r, g, b] = color.map(|v| (v.clamp(0.0, 1.0) * 65535.0).round() as u16);
    let words = [r, g, b, u16::MAX].map(u16::to_le_bytes);
    std::array::from_fn(|i| words[i / 2][i % 2])
}

/// Unit normals of vertices, by the areas of the triangles around them.
fn normals(places: &[DVec3], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; places.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| places[v as usize]);
        let n = (b - a).cross(c - a);
        t.iter().for_each(|v| sums[*v as usize] += n);
    }
    sums.iter().map(|n| n.normalize_or(DVec3::Y).as_vec3().to_array()).collect()
}
