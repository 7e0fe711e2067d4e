//! Colour of molecules: soft light from behind the viewer's left shoulder, with shadows if they are wanted, darker between atoms, inked where
//! the surface turns away.

use crate::geometry::block::DrawnTriangle;
use crate::shade::key_light::{self, KeyShadows};
use belvedere_composite::color::{Rgb, linear, smoothstep};
use belvedere_core::{DVec3, View};
use belvedere_scene::MeshLayer;
use std::sync::Arc;

/// Share of ambient light, and the part of it that comes from below.
const AROUND: f32 = 0.50;
const FROM_BELOW: f32 = 0.62;
/// Direct light, and the highlight.
const DIRECT: f32 = 0.72;
const HIGHLIGHT: f32 = 0.16;
const SHARPNESS: i32 = 28;
/// Share of the direct light that shadows take: their colours stay readable.
const SHADOW: f32 = 0.8;
/// Share of the colour that the ink takes, and the cosines between which it fades in.
const INK: f32 = 0.62;
const INKED: [f32; 2] = [0.10, 0.42];

/// A molecule ready for colouring. A molecule has no upright direction, so the light is fixed to the camera and not to the map.
pub(crate) struct MoleculeShade<'a> {
    layer: &'a MeshLayer,
    view: &'a View,
    straight: bool,
    light: DVec3,
    up: DVec3,
    shadows: Option<Arc<KeyShadows>>,
}

impl<'a> MoleculeShade<'a> {
    pub(crate) fn new(layer: &'a MeshLayer, view: &'a View, shadows: Option<Arc<KeyShadows>>) -> Self {
        let pinhole = view.pinhole();
        Self { layer, view, straight: !view.is_bent(), light: key_light::towards(pinhole), up: -pinhole.down, shadows }
    }

    /// True position of a sample.
    pub(crate) fn place(&self, found: &DrawnTriangle<'_>, weights: [f64; 3]) -> DVec3 {
        let corners = self.layer.mesh.corners(found.block.origin[0] + found.parent as usize);
        corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
    }

    /// Colour of a sample.
    pub(crate) fn shade(&self, found: &DrawnTriangle<'_>, weights: [f64; 3]) -> Rgb {
        self.color(found.block.origin[0] + found.parent as usize, weights, self.place(found, weights))
    }

    /// See [`MoleculeShade::shade`], at a point of the surface.
    pub(crate) fn color_at(&self, triangle: usize, p: DVec3) -> Rgb {
        self.color(triangle, self.layer.mesh.weights_at(triangle, p), p)
    }

    fn color(&self, triangle: usize, weights: [f64; 3], p: DVec3) -> Rgb {
        let mesh = &self.layer.mesh;
        let (n, towards) = (mesh.normal_at(triangle, weights), self.towards_eye(p));
        let color = mesh.color_at(triangle, weights).unwrap_or(self.layer.color);
        let open = mesh.openness_at(triangle, weights) as f32;
        let facing = n.dot(towards).abs() as f32;
        // Wrapped diffuse light shades small balls softly.
        let lit = ((n.dot(self.light) as f32 + 0.25) / 1.25).max(0.0);
        let shown = 1.0 - SHADOW * (1.0 - self.shadows.as_ref().map_or(1.0, |s| s.lit(p, n)));
        let around = FROM_BELOW + (1.0 - FROM_BELOW) * (0.5 + 0.5 * n.dot(self.up) as f32);
        let half = (self.light + towards).normalize_or(self.light);
        let shine = (n.dot(half).max(0.0) as f32).powi(SHARPNESS) * HIGHLIGHT * open * open * shown;
        let ink = 1.0 - INK * (1.0 - smoothstep(INKED[0], INKED[1], facing));
        // Gaps between chains tell their depth by being dark.
        let light = DIRECT * lit * shown * (0.35 + 0.65 * open) + AROUND * around * open * open;
        (linear([color.r, color.g, color.b]) * light + Rgb::splat(shine)) * ink
    }

    /// Unit vector from a point towards the eye, along the ray that sees it.
    fn towards_eye(&self, p: DVec3) -> DVec3 {
        let pinhole = self.view.pinhole();
        let straight =
            if pinhole.is_orthographic() { -pinhole.forward } else { (pinhole.eye - p).normalize_or(self.light) };
        if self.straight {
            return straight;
        }
        // The pixel is constant along the ray, which is therefore perpendicular to the gradients of x and y.
        match self.view.jacobian(p) {
            Ok([x, y]) => x.cross(y).try_normalize().map_or(straight, |ray| -ray),
            Err(_) => straight,
        }
    }
}
