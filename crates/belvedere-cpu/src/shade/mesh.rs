//! Colour of meshes: matt like the boxes, the same from both sides.

use crate::geometry::block::DrawnTriangle;
use crate::shade::around;
use crate::shade::relief::ReliefLight;
use belvedere_composite::color::{Rgb, linear, smoothstep};
use belvedere_core::DVec3;
use belvedere_scene::{Light, MeshLayer, Relief};
use glam::Vec3A;

/// Function that gives the share of the sun's disc visible at a point with a normal.
pub(crate) type Sun<'s> = dyn Fn(DVec3, DVec3) -> f32 + 's;

/// Openness in shading of a point that no ambient light reaches.
const DARKEST: f32 = 0.25;

/// Whether the visible side is the one from which the corners of a triangle run counter-clockwise.
pub(super) fn is_front(found: &DrawnTriangle<'_>) -> bool {
    let [a, b, c] = found.v.map(|v| [i64::from(v.screen.x), i64::from(v.screen.y)]);
    // y runs down the image: counter-clockwise in space is clockwise here.
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) <= 0
}

/// A mesh layer ready for colouring.
pub(crate) struct MeshShade<'a> {
    layer: &'a MeshLayer,
    light: ReliefLight,
    /// Lowest height and vertical extent.
    foot: f64,
    height: f64,
}

impl<'a> MeshShade<'a> {
    pub(crate) fn new(layer: &'a MeshLayer, light: &Light) -> Self {
        let bounds = layer.mesh.bounds();
        let height = (bounds.max.z - bounds.min.z).max(1e-9);
        Self { layer, light: ReliefLight::new(Relief::Sun, light), foot: bounds.min.z, height }
    }

    /// True position of a sample.
    pub(crate) fn place(&self, found: &DrawnTriangle<'_>, weights: [f64; 3]) -> DVec3 {
        let corners = self.layer.mesh.corners(found.block.origin[0] + found.parent as usize);
        corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
    }

    /// Unit normal of a triangle, to the side from which its corners run counter-clockwise.
    pub(super) fn face_normal(&self, triangle: usize) -> DVec3 {
        self.layer.mesh.face_normal(triangle)
    }

    /// Colour of a sample.
    pub(crate) fn shade(&self, found: &DrawnTriangle<'_>, weights: [f64; 3], footprint: f64, sun: &Sun<'_>) -> Rgb {
        let triangle = found.block.origin[0] + found.parent as usize;
        self.color(triangle, weights, is_front(found), (self.place(found, weights), footprint), sun)
    }

    /// * `footprint`: size of a pixel there, scene units; `front`: whether the visible side is the one from which the corners run counter-clockwise.
    fn color(
        &self,
        triangle: usize,
        weights: [f64; 3],
        front: bool,
        (p, footprint): (DVec3, f64),
        sun: &Sun<'_>,
    ) -> Rgb {
        let mesh = &self.layer.mesh;
        let normal = mesh.normal_at(triangle, weights);
        let n = if front { normal } else { -normal };
        let color = mesh.surface_color_at(triangle, weights, footprint).unwrap_or(self.layer.color);
        // Darker where the ambient light is blocked, else towards the foot; and from below.
        let open = if mesh.has_openness() {
            DARKEST + (1.0 - DARKEST) * mesh.openness_at(triangle, weights) as f32
        } else {
            let up = (((p.z - self.foot) / self.height) as f32).clamp(0.0, 1.0);
            0.60 + 0.40 * smoothstep(-0.1, 0.6, up)
        };
        let open = open * (1.0 - 0.25 * (-n.z as f32).max(0.0));
        // Shadows depend on the normal of the triangle, not on the smooth one.
        let face = mesh.face_normal(triangle);
        let sun = sun(p, if front { face } else { -face });
        let n = Vec3A::new(n.x as f32, n.y as f32, n.z as f32);
        let lit = self.light.at(n, open, sun) * 0.82 + around(n, open);
        linear([color.r, color.g, color.b]) * lit * (0.76 + 0.24 * open)
    }

    /// See [`MeshShade::color`], at a point of the mesh.
    pub(crate) fn color_at(&self, triangle: usize, front: bool, p: DVec3, footprint: f64, sun: &Sun<'_>) -> Rgb {
        self.color(triangle, self.layer.mesh.weights_at(triangle, p), front, (p, footprint), sun)
    }
}
