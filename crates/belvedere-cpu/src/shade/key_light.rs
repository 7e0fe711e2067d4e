//! Soft shadows of molecules: a map of the places that are nearest to the key light, and the share of the light that passes by them.
//!
//! Sources: the map, Williams 1978; the share of samples around a place, Reeves, Salesin and Cook 1987; a penumbra as wide as what casts
//! the shadow is far, Fernando 2005. Samples that follow the plane of the receiver, all figures, and the fixed pattern are ours.

use belvedere_core::{DVec3, Pinhole};
use belvedere_scene::{LayerKind, Mesh, RenderJob};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Direction towards the light: right, down and forward of the camera.
const LIGHT: [f64; 3] = [-0.42, -0.58, -0.70];
/// Half the width of the light at a distance of 1.
const SPREAD: f32 = 0.05;
/// Cells of the map along the longest side, least and most, and for each pixel along the side of a square picture.
const CELLS: [f64; 2] = [256.0, 1536.0];
const PER_PIXEL: f64 = 1.2;
/// Rows of the map that a thread draws at a time.
const STRIP: usize = 32;
/// Samples by which what casts a shadow is sought, and by which its share is told.
const SOUGHT: usize = 12;
const COUNTED: usize = 20;
/// Offset of a place from its surface, and heights over its plane between which a sample fades to shadow, cells.
const OFF: f64 = 1.5;
const OVER: [f32; 2] = [0.7, 2.2];
/// Steepest plane of a receiver that samples follow.
const STEEPEST: f32 = 4.0;

/// Unit vector towards the key light, which stands above the viewer's left shoulder: molecules have no upright direction.
pub(super) fn towards(pinhole: &Pinhole) -> DVec3 {
    let [right, down, forward] = LIGHT;
    (right * pinhole.right + down * pinhole.down + forward * pinhole.forward).normalize()
}

/// Most bytes of the map.
pub(crate) const fn most_bytes() -> u64 {
    (CELLS[1] * CELLS[1]) as u64 * size_of::<f32>() as u64
}

/// What stands in the key light.
pub(crate) struct KeyShadows {
    /// Two directions across the light, and that towards it.
    axes: [DVec3; 3],
    origin: DVec3,
    /// Side of a cell, scene units.
    cell: f64,
    size: [usize; 2],
    /// Heights towards the light, cells; negative infinity where nothing stands.
    heights: Vec<f32>,
    /// The largest of them.
    top: f32,
    /// Places on a disc of radius 1: with a density that grows towards the middle, and even.
    sought: [[f32; 3]; SOUGHT],
    counted: [[f32; 3]; COUNTED],
}

impl KeyShadows {
    /// The shadows of all molecules through which nothing shines; `None` if there is none or shadows are not wanted.
    pub(crate) fn of(job: &RenderJob<'_>) -> Option<Self> {
        let casts = |kind: &LayerKind| kind.molecule().is_some() && !kind.is_see_through();
        let meshes = || job.scene.layers.iter().filter(|l| casts(&l.kind)).filter_map(|l| l.kind.triangles());
        if !job.light.shadows || meshes().all(|m| m.mesh.triangles().is_empty()) {
            return None;
        }
        let pinhole = job.view.pinhole();
        let pixels = pinhole.image.map(f64::from);
        let meshes: Vec<&Mesh> = meshes().map(|m| &m.mesh).collect();
        Some(Self::new(&meshes, towards(pinhole), (pixels[0] * pixels[1]).sqrt()))
    }

    /// * `side`: side of a square picture of as many pixels.
    fn new(meshes: &[&Mesh], light: DVec3, side: f64) -> Self {
        let (u, v) = light.any_orthonormal_pair();
        let axes = [u, v, light];
        let origin = meshes.first().map_or(DVec3::ZERO, |m| m.origin());
        let along = |p: DVec3| DVec3::from_array(axes.map(|axis| (p - origin).dot(axis)));
        let placed: Vec<Vec<DVec3>> = meshes
            .iter()
            .map(|m| (0..m.vertex_count() as u32).into_par_iter().map(|i| along(m.vertex(i))).collect())
            .collect();
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = placed.iter().flatten().fold(empty, |(low, high), p| (low.min(*p), high.max(*p)));
        let longest = (high - low).truncate().max_element().max(1e-9);
        let cell = longest / (PER_PIXEL * side).clamp(CELLS[0], CELLS[1]);
        let size = [high.x - low.x, high.y - low.y].map(|extent| (extent / cell) as usize + 1);
        let mut map = Self {
            axes,
            origin: origin + low.x * u + low.y * v + low.z * light,
            cell,
            size,
            heights: vec![f32::NEG_INFINITY; size[0] * size[1]],
            top: ((high.z - low.z) / cell) as f32,
            sought: disc(1.0),
            counted: disc(0.5),
        };
        for (mesh, placed) in meshes.iter().zip(placed) {
            let placed: Vec<DVec3> = placed.into_iter().map(|p| (p - low) / cell).collect();
            map.draw(mesh.triangles(), &placed);
        }
        map
    }

    /// Raises the cells whose middles lie under triangles. The highest counts, so their order does not.
    fn draw(&mut self, triangles: &[[u32; 3]], placed: &[DVec3]) {
        let width = self.size[0];
        let mut strips = vec![Vec::new(); self.size[1].div_ceil(STRIP)];
        for (i, corners) in triangles.iter().enumerate() {
            let y = corners.map(|v| placed[v as usize].y);
            let ends = [y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2])].map(|y| y.max(0.0) as usize / STRIP);
            for strip in strips.iter_mut().take(ends[1] + 1).skip(ends[0]) {
                strip.push(i as u32);
            }
        }
        self.heights.par_chunks_mut(STRIP * width).zip(strips).enumerate().for_each(|(k, (cells, own))| {
            for i in own {
                let corners = triangles[i as usize].map(|v| placed[v as usize]);
                raise(corners, (k * STRIP, width), cells);
            }
        });
    }

    /// Share of the key light that reaches a place with a unit normal, 0..=1.
    pub(crate) fn lit(&self, p: DVec3, normal: DVec3) -> f32 {
        let [nu, nv, nw] = self.axes.map(|axis| normal.dot(axis) as f32);
        if nw <= 0.0 {
            return 0.0;
        }
        let from = p + OFF * self.cell * normal - self.origin;
        let [u, v, w] = self.axes.map(|axis| (from.dot(axis) / self.cell) as f32);
        let left = self.top - w;
        if left <= 0.0 {
            return 1.0;
        }
        let slope = [nu, nv].map(|n| (-n / nw).clamp(-STEEPEST, STEEPEST));
        let reach = SPREAD * left;
        let (mut sum, mut count) = (0.0, 0);
        for [x, y, radius] in &self.sought {
            let (du, dv) = (reach * x, reach * y);
            let height = self.at(u + du, v + dv) - w;
            // What stands outside the cone of the light takes none of it.
            if height - slope[0] * du - slope[1] * dv > OVER[0] && 1.5 * SPREAD * height >= reach * radius {
                (sum, count) = (sum + height, count + 1);
            }
        }
        if count == 0 || count == SOUGHT {
            return if count == 0 { 1.0 } else { 0.0 };
        }
        let width = (SPREAD * sum / count as f32).max(1.0);
        let mut taken = 0.0;
        for [x, y, _] in &self.counted {
            let (du, dv) = (width * x, width * y);
            let above = self.at(u + du, v + dv) - w - slope[0] * du - slope[1] * dv;
            taken += ((above - OVER[0]) / (OVER[1] - OVER[0])).clamp(0.0, 1.0);
        }
        1.0 - taken / COUNTED as f32
    }

    #[inline(always)]
    fn at(&self, u: f32, v: f32) -> f32 {
        // Negative numbers are beyond all rows and columns when they are cut to whole ones without sign.
        let [x, y] = [u.floor() as i32 as u32 as usize, v.floor() as i32 as u32 as usize];
        if x < self.size[0] && y < self.size[1] { self.heights[y * self.size[0] + x] } else { f32::NEG_INFINITY }
    }
}

/// Places on a disc along a spiral of the golden angle, and their distance from the middle.
/// * `power`: 0.5 for even places, more for more of them near the middle.
fn disc<const N: usize>(power: f64) -> [[f32; 3]; N] {
    std::array::from_fn(|i| {
        let radius = ((i as f64 + 0.5) / N as f64).powf(power);
        let (sin, cos) = (TAU * 0.381_966_011_25 * i as f64).sin_cos();
        [radius * cos, radius * sin, radius].map(|v| v as f32)
    })
}

/// Raises cells of a strip of rows to a triangle.
/// * `first`, `width`: first row of the strip, and cells of a row.
fn raise(corners: [DVec3; 3], (first, width): (usize, usize), cells: &mut [f32]) {
    let [a, b, c] = corners;
    let area = (b - a).truncate().perp_dot((c - a).truncate());
    if area == 0.0 {
        return;
    }
    let rows = cells.len() / width;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let range = |low: f64, high: f64, first: usize, count: usize| {
        let from = (low - 0.5).ceil().max(first as f64) as usize;
        let to = ((high - 0.5).floor() + 1.0).clamp(first as f64, (first + count) as f64) as usize;
        from..to.max(from)
    };
    let [to_b, to_c] = [b - a, c - a];
    for y in range(low.y, high.y, first, rows) {
        for x in range(low.x, high.x, 0, width) {
            let at = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0) - a;
            let s = at.truncate().perp_dot(to_c.truncate()) / area;
            let t = to_b.truncate().perp_dot(at.truncate()) / area;
            if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
                let cell = &mut cells[(y - first) * width + x];
                *cell = cell.max((a.z + s * to_b.z + t * to_c.z) as f32);
            }
        }
    }
}

#[cfg(test)]
mod tests;
