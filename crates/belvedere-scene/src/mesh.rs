//! Triangle meshes.

mod boxes;
mod openness;
mod parts;

use belvedere_core::{Aabb, DVec3};
use glam::{Vec2, Vec3};
use std::sync::Arc;

use crate::texture::Texturing;
use crate::{Color, Placement, RigidParts};
use boxes::Boxes;
use openness::Openness;

pub use openness::triangle_lattice;

/// Colours of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum MeshColors {
    /// None of its own: the layer's.
    #[default]
    Layer,
    /// One per vertex.
    PerVertex(Vec<Color>),
    /// One per triangle.
    PerTriangle(Vec<Color>),
}

/// Triangles over shared vertices. Plain data: finite, and every index has its vertex. Copies share vertices and triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    origin: DVec3,
    positions: Arc<Vec<Vec3>>,
    triangles: Arc<Vec<[u32; 3]>>,
    boxes: Boxes,
    normals: Option<Vec<Vec3>>,
    colors: MeshColors,
    /// Number of the part that each triangle belongs to; empty = one part.
    parts: Vec<u32>,
    openness: Openness,
    /// Pictures on it.
    texturing: Option<Box<Texturing>>,
}

/// Errors of a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is not finite in single precision.
    #[error("vertex {vertex} lies at {position}, which is not finite; repair the mesh")]
    NotFinite {
        /// Number of the vertex.
        vertex: usize,
        /// Its position, scene coordinates.
        position: DVec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex} of {vertices}; repair the mesh")]
    Index {
        /// Number of the triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// The number of colours, normals, parts, shares of light or texture positions does not fit.
    #[error("the mesh has {found} {what} for {expected}; give one for each or none")]
    Count {
        /// Kind of the values.
        what: &'static str,
        /// Number given.
        found: usize,
        /// Number needed.
        expected: usize,
    },
    /// More vertices or triangles than `Mesh::MAX`.
    #[error("the mesh has {count} {what}, at most {limit} are possible; split it", limit = Mesh::MAX)]
    TooMany {
        /// `vertices` or `triangles`.
        what: &'static str,
        /// Their number.
        count: usize,
    },
}

impl Mesh {
    /// Most vertices and most triangles.
    pub const MAX: usize = 1 << 28;

    /// A mesh of vertices (scene coordinates), triangles (counter-clockwise from outside where that is known) and colours.
    ///
    /// Positions are kept to 24 bits of the mesh's extent, relative to its middle. Triangles without area are left out.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn new(positions: &[DVec3], triangles: Vec<[u32; 3]>, colors: MeshColors) -> Result<Self, MeshError> {
        Self::in_parts(positions, triangles, colors, Vec::new())
    }

    /// [`Mesh::new`] of several parts: `parts` holds the number of the part that each triangle belongs to.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn in_parts(
        positions: &[DVec3],
        triangles: Vec<[u32; 3]>,
        colors: MeshColors,
        parts: Vec<u32>,
    ) -> Result<Self, MeshError> {
        Self::textured(positions, triangles, colors, parts, None)
    }

    /// [`Mesh::in_parts`] with pictures, which multiply its colours; without parts if `parts` is empty.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn textured(
        positions: &[DVec3],
        triangles: Vec<[u32; 3]>,
        colors: MeshColors,
        parts: Vec<u32>,
        texturing: Option<Texturing>,
    ) -> Result<Self, MeshError> {
        for (what, count) in [("vertices", positions.len()), ("triangles", triangles.len())] {
            if count > Self::MAX {
                return Err(MeshError::TooMany { what, count });
            }
        }
        if let Some(vertex) = positions.iter().position(|p| !p.as_vec3().is_finite()) {
            return Err(MeshError::NotFinite { vertex, position: positions[vertex] });
        }
        let beyond = |t: &[u32; 3]| t.iter().copied().find(|&v| v as usize >= positions.len());
        if let Some((triangle, vertex)) = triangles.iter().enumerate().find_map(|(i, t)| Some((i, beyond(t)?))) {
            return Err(MeshError::Index { triangle, vertex, vertices: positions.len() });
        }
        let (found, expected) = match &colors {
            MeshColors::Layer => (0, 0),
            MeshColors::PerVertex(c) => (c.len(), positions.len()),
            MeshColors::PerTriangle(c) => (c.len(), triangles.len()),
        };
        if found != expected {
            return Err(MeshError::Count { what: "colours", found, expected });
        }
        if !parts.is_empty() && parts.len() != triangles.len() {
            return Err(MeshError::Count { what: "numbers of parts", found: parts.len(), expected: triangles.len() });
        }
        let places = texturing.iter().flat_map(|t| [t.of_triangle.len(), t.corners.len()]);
        if let Some(found) = places.into_iter().find(|n| *n != triangles.len()) {
            return Err(MeshError::Count { what: "places in pictures", found, expected: triangles.len() });
        }
        let bounds = Aabb::of(positions.iter().copied());
        let origin = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().round() };
        let positions: Vec<Vec3> = positions.iter().map(|&p| (p - origin).as_vec3()).collect();
        let mut mesh = Self {
            origin,
            positions: positions.into(),
            triangles: triangles.into(),
            boxes: Boxes::default(),
            normals: None,
            colors,
            parts,
            openness: Openness::Unknown,
            texturing: texturing.map(Box::new),
        };
        mesh.drop_degenerate();
        Ok(mesh)
    }

    /// Whether both are the same triangles in the same parts, in the same memory: a copy of a mesh, with other colours perhaps.
    pub fn shares_triangles(&self, other: &Self) -> bool {
        let same = Arc::ptr_eq(&self.positions, &other.positions) && Arc::ptr_eq(&self.triangles, &other.triangles);
        same && self.origin == other.origin && self.parts == other.parts
    }

    /// This mesh with a unit normal per vertex, for smooth shading; zero = not known there.
    ///
    /// # Errors
    /// [`MeshError::Count`].
    pub fn with_normals(mut self, normals: &[DVec3]) -> Result<Self, MeshError> {
        if normals.len() != self.positions.len() {
            let (found, expected) = (normals.len(), self.positions.len());
            return Err(MeshError::Count { what: "normals", found, expected });
        }
        self.normals = Some(normals.iter().map(|n| n.normalize_or_zero().as_vec3()).collect());
        Ok(self)
    }

    /// This mesh, given in coordinates of its layer, at a placement in the scene.
    pub fn placed(&self, at: &Placement) -> Self {
        let origin = at.apply(self.origin);
        let turned = |v: &Vec3| at.turn(v.as_dvec3()).as_vec3();
        let positions: Vec<Vec3> = self.positions.iter().map(turned).collect();
        let normals = self.normals.as_ref().map(|normals| normals.iter().map(turned).collect());
        Self { origin, positions: positions.into(), boxes: Boxes::default(), normals, ..self.clone() }
    }

    fn drop_degenerate(&mut self) {
        let at = |v: u32| self.positions[v as usize].as_dvec3();
        let has_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(at);
            (b - a).cross(c - a) != DVec3::ZERO
        };
        let kept: Vec<bool> = self.triangles.iter().map(has_area).collect();
        self.retain(&kept);
    }

    /// Removes triangles with their colours, parts, openness and texture positions; vertices stay.
    fn retain(&mut self, kept: &[bool]) {
        let mut keep = kept.iter();
        self.boxes = Boxes::default();
        Arc::make_mut(&mut self.triangles).retain(|_| keep.next() == Some(&true));
        if let MeshColors::PerTriangle(colors) = &mut self.colors {
            let mut keep = kept.iter();
            colors.retain(|_| keep.next() == Some(&true));
        }
        let mut keep = kept.iter();
        self.parts.retain(|_| keep.next() == Some(&true));
        self.openness.retain(kept);
        if let Some(t) = &mut self.texturing {
            let mut keep = kept.iter();
            t.of_triangle.retain(|_| keep.next() == Some(&true));
            let mut keep = kept.iter();
            t.corners.retain(|_| keep.next() == Some(&true));
        }
    }

    /// Shares the vertices and triangles of another mesh if they are equal, so that both are known to be one surface.
    pub fn share(&mut self, other: &Self) {
        let equal = self.origin == other.origin
            && self.positions.len() == other.positions.len()
            && self.triangles == other.triangles
            && self.positions == other.positions;
        if equal {
            self.positions = Arc::clone(&other.positions);
            self.triangles = Arc::clone(&other.triangles);
            self.boxes = other.boxes.clone();
        }
    }

    /// Whether both are known to be one surface, whatever their colours: copies, or made so by [`Mesh::share`].
    pub fn is_surface_of(&self, other: &Self) -> bool {
        self.origin == other.origin
            && Arc::ptr_eq(&self.positions, &other.positions)
            && Arc::ptr_eq(&self.triangles, &other.triangles)
    }

    /// Number of the part that a triangle belongs to; `None` if the mesh has no parts.
    pub fn part(&self, triangle: usize) -> Option<u32> {
        self.parts.get(triangle).copied()
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Vertex numbers of every triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Middle of the mesh that its vertices are kept relative to, scene coordinates.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Vertices relative to [`Mesh::origin`].
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Position of a vertex, scene coordinates.
    pub fn vertex(&self, index: u32) -> DVec3 {
        self.origin + self.positions[index as usize].as_dvec3()
    }

    /// Corners of a triangle, scene coordinates.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.vertex(v))
    }

    /// Unit normal of a triangle, to the side from which its corners run counter-clockwise.
    pub fn face_normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.triangles[triangle].map(|v| self.positions[v as usize].as_dvec3());
        (b - a).cross(c - a).normalize_or(DVec3::Z)
    }

    /// Unit normal at a point of a triangle given by the weights of its corners, on the side of [`Mesh::face_normal`].
    pub fn normal_at(&self, triangle: usize, weights: [f64; 3]) -> DVec3 {
        let face = self.face_normal(triangle);
        let Some(normals) = &self.normals else { return face };
        let corners = self.triangles[triangle].map(|v| normals[v as usize].as_dvec3());
        let smooth = corners.iter().zip(weights).fold(DVec3::ZERO, |sum, (&n, w)| {
            // In a file, normals may contradict the order of the corners.
            sum + w * if n.dot(face) < 0.0 { -n } else { n }
        });
        smooth.normalize_or(face)
    }

    /// Colour at a point of a triangle given by the weights of its corners; `None` = the layer's.
    pub fn color_at(&self, triangle: usize, weights: [f64; 3]) -> Option<Color> {
        match &self.colors {
            MeshColors::Layer => None,
            MeshColors::PerTriangle(colors) => colors.get(triangle).copied(),
            MeshColors::PerVertex(colors) => {
                let c = self.triangles[triangle].map(|v| colors[v as usize]);
                let mix = |part: fn(&Color) -> u8| {
                    let sum: f64 = c.iter().zip(weights).map(|(c, w)| w * f64::from(part(c))).sum();
                    sum.round().clamp(0.0, 255.0) as u8
                };
                Some(Color { r: mix(|c| c.r), g: mix(|c| c.g), b: mix(|c| c.b), a: mix(|c| c.a) })
            }
        }
    }

    /// [`Mesh::color_at`] times the colour of the triangle's picture there.
    ///
    /// * `footprint`: side of the square over which the picture is averaged, scene units.
    pub fn surface_color_at(&self, triangle: usize, weights: [f64; 3], footprint: f64) -> Option<Color> {
        let own = self.color_at(triangle, weights);
        let Some((texture, corners)) = self.texturing.as_ref().and_then(|t| t.of(triangle)) else { return own };
        let place = corners.iter().zip(weights).fold(Vec2::ZERO, |sum, (c, w)| sum + w as f32 * *c);
        let [width, height] = texture.size().map(|n| n as f32);
        let [a, b] = [corners[1] - corners[0], corners[2] - corners[0]].map(|e| e * Vec2::new(width, height));
        let [p, q, r] = self.corners(triangle);
        let area = (q - p).cross(r - p).length();
        let pixels_per_unit = (f64::from(a.perp_dot(b).abs()) / area.max(f64::MIN_POSITIVE)).sqrt();
        let texel = texture.at(place, (pixels_per_unit * footprint) as f32);
        Some(own.map_or(texel, |own| own.times(texel)))
    }

    /// Weights of a triangle's corners at a point of its plane; they sum to 1.
    pub fn weights_at(&self, triangle: usize, p: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners(triangle);
        let n = (b - a).cross(c - a);
        let per = 1.0 / n.length_squared();
        let v = (p - a).cross(c - a).dot(n) * per;
        let w = (b - a).cross(p - a).dot(n) * per;
        [1.0 - v - w, v, w]
    }

    /// Smallest box around all vertices.
    pub fn bounds(&self) -> Aabb {
        let used = self.triangles.iter().flatten().map(|&v| self.vertex(v));
        Aabb::of(used)
    }
}

/// A layer of triangles.
#[derive(Debug, Clone)]
pub struct MeshLayer {
    /// The triangles.
    pub mesh: Mesh,
    /// Colour where the mesh has none of its own.
    pub color: Color,
    /// Names of its parts, as paths through the file: `town/church`; a triangle's part ([`Mesh::part`]) is an index into them.
    pub names: Vec<String>,
    /// The parts that `must_see` means; `None` = the whole mesh.
    pub wanted: Option<Vec<u32>>,
    /// The parts that bends carry as rigid bodies.
    pub rigid: RigidParts,
    /// Opacity, 0..=1, see [`crate::LayerKind::opacity`].
    pub opacity: f32,
    /// Whether part 0 is the ground between the others, which stays opaque.
    pub has_plate: bool,
}

impl MeshLayer {
    /// An opaque mesh without names.
    pub fn new(mesh: Mesh, color: Color) -> Self {
        let (names, wanted, rigid) = (Vec::new(), None, RigidParts::None);
        Self { mesh, color, names, wanted, rigid, opacity: 1.0, has_plate: false }
    }

    /// Whether what is behind a triangle, by its number, shines through it.
    pub fn is_see_through_at(&self, triangle: usize) -> bool {
        self.opacity < 1.0 && !(self.has_plate && self.mesh.part(triangle) == Some(0))
    }

    /// Numbers of the parts whose path, or a step of it, is `name`; case does not matter.
    pub fn parts_named(&self, name: &str) -> Vec<u32> {
        let is =
            |path: &str| path.eq_ignore_ascii_case(name) || path.split('/').any(|step| step.eq_ignore_ascii_case(name));
        self.names.iter().enumerate().filter(|(_, path)| is(path)).map(|(i, _)| i as u32).collect()
    }

    /// Name of the part that a triangle belongs to; `None` if it has none.
    pub fn name_of(&self, triangle: usize) -> Option<&str> {
        let name = self.names.get(self.mesh.part(triangle)? as usize)?;
        Some(name.as_str()).filter(|name| !name.is_empty())
    }
}

#[cfg(test)]
mod tests;
