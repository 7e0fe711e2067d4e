//! Translucent, flat, convex faces, in front of surfaces or faintly behind them.

use crate::color::{Packed, Rgb, linear};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::OverlayFace;
use belvedere_sight::pass::Pass;
use belvedere_sight::screen::Screen;

/// Factor of the opacity behind surfaces.
const BEHIND: f32 = 0.35;

/// A face on the image.
#[derive(Debug)]
pub(crate) struct Face {
    /// Inward edges: `normal . p - offset` is the distance inside, pixels.
    edges: Vec<(DVec2, f64)>,
    lo: DVec2,
    hi: DVec2,
    /// Nearness (1 / depth, in parallel projection -depth) at pixel `p` is `q.x p.x + q.y p.y + q.z`.
    q: DVec3,
    color: Rgb,
    alpha: f32,
}

impl Face {
    /// `None` if no part of it can be visible.
    pub(crate) fn new(face: &OverlayFace, pass: &Pass<'_>, screen: &Screen) -> Option<Self> {
        let corners: Vec<DVec3> =
            face.corners.iter().map(|&p| Some(screen.view_from(pass.displace(p)?))).collect::<Option<_>>()?;
        let corners = clipped(corners, screen);
        if corners.len() < 3 {
            return None;
        }
        let pixels: Vec<DVec2> = corners.iter().map(|&v| screen.pixel(v)).collect();
        let area: f64 = (0..pixels.len()).map(|i| pixels[i].perp_dot(pixels[(i + 1) % pixels.len()])).sum();
        if area.abs() < 1e-6 {
            return None;
        }
        let mut edges = Vec::new();
        for (i, &a) in pixels.iter().enumerate() {
            let d = pixels[(i + 1) % pixels.len()] - a;
            if d.length() > 1e-9 {
                let normal = d.perp().normalize() * area.signum();
                edges.push((normal, normal.dot(a)));
            }
        }
        let nearness = |v: DVec3| if screen.ortho { -v.z } else { 1.0 / v.z };
        let q = plane(&pixels, &corners.iter().map(|&v| nearness(v)).collect::<Vec<_>>())?;
        let (lo, hi) = pixels.iter().fold((pixels[0], pixels[0]), |(l, h), p| (l.min(*p), h.max(*p)));
        let c = face.color;
        Some(Self { edges, lo, hi, q, color: linear([c.r, c.g, c.b]), alpha: f32::from(c.a) / 255.0 })
    }

    /// Draws the rows from `y0` on; `depth` are those of the whole picture.
    pub(crate) fn draw(&self, screen: &Screen, y0: i32, color: &mut [Packed], depth: &[f32]) {
        let width = screen.width;
        let rows = color.len() as i32 / width.max(1);
        let range = |lo: f64, hi: f64, from: i32, to: i32| {
            let low = (lo - 1.0).clamp(f64::from(from), f64::from(to)) as i32;
            low..((hi + 1.0).clamp(f64::from(from), f64::from(to)) as i32)
        };
        for y in range(self.lo.y, self.hi.y, y0, y0 + rows) {
            for x in range(self.lo.x, self.hi.x, 0, width) {
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let inside = self.edges.iter().map(|(n, o)| n.dot(p) - o).fold(f64::INFINITY, f64::min);
                let cover = (inside + 0.5).clamp(0.0, 1.0) as f32;
                if cover <= 0.0 {
                    continue;
                }
                let q = self.q.dot(p.extend(1.0));
                let here = if screen.ortho { -q } else { 1.0 / q.max(1e-30) };
                let seen = here <= f64::from(depth[(y * width + x) as usize]);
                let alpha = cover * self.alpha * if seen { 1.0 } else { BEHIND };
                let c = &mut color[((y - y0) * width + x) as usize];
                *c = Packed::new(c.rgb().lerp(self.color, alpha));
            }
        }
    }
}

/// The part of a convex polygon in front of the near plane and inside the guard planes.
fn clipped(mut corners: Vec<DVec3>, screen: &Screen) -> Vec<DVec3> {
    for plane in 0..belvedere_sight::screen::PLANES {
        let mut out = Vec::with_capacity(corners.len() + 1);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            let (da, db) = (screen.clip_distances(a)[plane], screen.clip_distances(b)[plane]);
            if da >= 0.0 {
                out.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                out.push(a.lerp(b, da / (da - db)));
            }
        }
        corners = out;
        if corners.is_empty() {
            break;
        }
    }
    corners.retain(|c| c.is_finite());
    corners
}

/// The affine function of the pixel with these values, from the three corners that span the most.
fn plane(pixels: &[DVec2], values: &[f64]) -> Option<DVec3> {
    let n = pixels.len();
    let spread = |i: usize, j: usize| (pixels[i] - pixels[0]).perp_dot(pixels[j] - pixels[0]);
    let pairs = (1..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let (i, j) = pairs.max_by(|a, b| spread(a.0, a.1).abs().total_cmp(&spread(b.0, b.1).abs()))?;
    let (d, e) = (pixels[i] - pixels[0], pixels[j] - pixels[0]);
    let (u, v) = (values[i] - values[0], values[j] - values[0]);
    let det = d.perp_dot(e);
    let g = DVec2::new(u * e.y - v * d.y, v * d.x - u * e.x) / det;
    let q = g.extend(values[0] - g.dot(pixels[0]));
    q.is_finite().then_some(q)
}
