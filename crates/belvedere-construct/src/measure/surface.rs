//! Whether the buffers of a picture show a piece of a surface in space.

use super::image::{SampleImage, facing};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Frame;

/// Whether a sample faces the eye and the four pixels around it show its layer at its depth: each votes with its bilinear weight, and
/// expects the depth of the sample's tangent plane.
pub(super) fn in_buffer(
    view: &View,
    (p, normal): (DVec3, DVec3),
    layer: usize,
    image: &SampleImage,
    frame: &Frame,
) -> bool {
    if facing(view, p, normal) <= 0.0 {
        return false;
    }
    let pinhole = view.pinhole();
    let pixel = if pinhole.is_orthographic() { 1.0 } else { image.depth } / pinhole.scale_px();
    let gradient = depth_gradient(view, p, normal, pixel);
    // Balls and corners leave their tangent plane within a pixel, by about as much as a pixel is wide.
    let tolerance = 0.7 * gradient.length().min(8.0 * pixel) + pixel + 1e-6 * image.depth;
    let corner = (image.pixel - 0.5).floor();
    let part = image.pixel - 0.5 - corner;
    let mut seen = 0.0;
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let at = corner + DVec2::new(dx, dy);
        let column = (at.x.max(0.0) as usize).min(frame.width - 1);
        let row = (at.y.max(0.0) as usize).min(frame.height - 1);
        let k = row * frame.width + column;
        let expected = image.depth + gradient.dot(at + 0.5 - image.pixel).clamp(-8.0 * pixel, 8.0 * pixel);
        let weight = (1.0 - (part.x - dx).abs()) * (1.0 - (part.y - dy).abs());
        if frame.id[k] as usize == layer + 1 && f64::from(frame.depth[k]) >= expected - tolerance {
            seen += weight;
        }
    }
    seen >= 0.5
}

/// Change of depth per pixel along the tangent plane; zero where it is seen from its edge.
fn depth_gradient(view: &View, p: DVec3, normal: DVec3, step: f64) -> DVec2 {
    let (u, v) = normal.any_orthonormal_pair();
    let image = |p: DVec3| view.project(p).ok();
    let (Some(i0), Some(iu), Some(iv)) = (image(p), image(p + step * u), image(p + step * v)) else {
        return DVec2::ZERO;
    };
    let (pu, pv) = (iu.pixel - i0.pixel, iv.pixel - i0.pixel);
    let (wu, wv) = (iu.depth - i0.depth, iv.depth - i0.depth);
    let area = pu.perp_dot(pv);
    if area.abs() < 1e-6 {
        return DVec2::ZERO;
    }
    DVec2::new(wu * pv.y - wv * pu.y, wv * pu.x - wu * pv.x) / area
}
