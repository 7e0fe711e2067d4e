//! Triangles of their vertices.

use crate::shared_bytes::{SharedBytes, positions};
use crate::{IoError, Limits, Loaded, MeshFile};
use belvedere_scene::{Color, MeshColors};
use serde_json::json;
use std::path::Path;

/// Triangles, scene units or those of the layer's transform.
#[derive(Clone)]
pub struct Triangles {
    vertices: SharedBytes,
    faces: SharedBytes,
    colors: Option<SharedBytes>,
}

impl Triangles {
    /// * `vertices`: f64 x, y, z of each, finite.
    /// * `faces`: u32 numbers of three vertices each, from 0; at least one.
    /// * `colors`: u8 red, green, blue of each vertex, sRGB.
    ///
    /// # Errors
    /// A sentence for anything else.
    pub fn new(vertices: SharedBytes, faces: SharedBytes, colors: Option<SharedBytes>) -> Result<Self, String> {
        let made = Self { vertices, faces, colors };
        let [points, corners] = [made.vertices.len(), made.faces.len()];
        if points % 24 != 0 || corners % 12 != 0 || corners == 0 {
            return Err(format!("{points} bytes of vertices and {corners} of faces are no triangles"));
        }
        let count = points / 24;
        if let Some(beyond) = made.corners().flatten().find(|v| *v as usize >= count) {
            return Err(format!("a face names vertex {beyond}, and there are {count}, from 0; correct the faces"));
        }
        if let Some(bad) = positions(&made.vertices).position(|p| !p.as_vec3().is_finite()) {
            return Err(format!("vertex {bad} of {count} is not finite; leave it out"));
        }
        if made.colors.as_ref().is_some_and(|colors| colors.len() != 3 * count) {
            return Err(format!("the colours do not suit {count} vertices; give three bytes to each"));
        }
        Ok(made)
    }

    fn corners(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let corner = |b: &[u8; 12], i: usize| u32::from_le_bytes(std::array::from_fn(|k| b[4 * i + k]));
        let (faces, _) = self.faces.as_chunks::<12>();
        faces.iter().map(move |b| std::array::from_fn(|i| corner(b, i)))
    }

    /// The mesh.
    ///
    /// # Errors
    /// [`IoError::Format`] if it is too large for `limits`.
    pub fn mesh(&self, path: &Path, limits: &Limits) -> Result<Loaded<MeshFile>, IoError> {
        let (_, parts) = self.layout();
        let bytes: usize = parts.iter().map(|part| part.len()).sum();
        limits.ask("the mesh", 2 * bytes as u64).map_err(|reason| IoError::format(path, reason))?;
        let colors = self.colors.as_ref().map(|colors| {
            let (colors, _) = colors.as_chunks::<3>();
            MeshColors::PerVertex(colors.iter().map(|&[r, g, b]| Color::rgb(r, g, b)).collect())
        });
        Ok(Loaded::clean(MeshFile {
            format: "array",
            positions: positions(&self.vertices).collect(),
            triangles: self.corners().collect(),
            colors: colors.unwrap_or_default(),
            ..MeshFile::default()
        }))
    }

    pub(super) fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        let parts = [Some(&self.vertices), Some(&self.faces), self.colors.as_ref()];
        let parts: Vec<&[u8]> = parts.into_iter().flatten().map(|part| &**part).collect();
        let (vertices, faces, colors) = (parts[0].len() / 24, parts[1].len() / 12, self.colors.is_some());
        (json!({ "array": "triangles", "colors": colors, "faces": faces, "vertices": vertices }), parts)
    }

    /// The triangles as binary PLY.
    pub(super) fn ply(&self) -> Vec<u8> {
        let (_, parts) = self.layout();
        let (vertices, faces) = (parts[0].as_chunks::<24>().0, parts[1].as_chunks::<12>().0);
        let colors = parts.get(2).map(|colors| colors.as_chunks::<3>().0);
        let channels = ["red", "green", "blue"].map(|name| format!("property uchar {name}\n")).concat();
        let mut out = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}element face {}\n\
             property list uchar int vertex_indices\nend_header\n",
            vertices.len(),
            if colors.is_some() { channels } else { String::new() },
            faces.len()
        )
        .into_bytes();
        for (i, vertex) in vertices.iter().enumerate() {
            out.extend(vertex);
            out.extend(colors.iter().flat_map(|colors| colors[i]));
        }
        faces.iter().for_each(|face| out.extend([3].iter().chain(face)));
        out
    }
}
