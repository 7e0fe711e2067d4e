//! Points all over the surfaces of a part of a scene.

use crate::surface_samples::{box_triangles, spread};
use belvedere_core::random::Random;
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{LayerKind, Scene};

/// Distance of a point in front of its surface, share of the extent of the region.
const IN_FRONT: f64 = 2e-5;

/// A point that stands for a piece of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SurfacePoint {
    /// A little before the surface, scene coordinates.
    pub(super) at: DVec3,
    /// Outward unit normal.
    pub(super) normal: DVec3,
    /// Area that it stands for.
    pub(super) area: f64,
    /// Whether the surface is the ground.
    pub(super) on_ground: bool,
}

/// About `count` points on ground, boxes and meshes within a region, each for about the same area. Deterministic.
pub(super) fn surface_points(scene: &Scene, region: &Aabb, count: usize) -> Vec<SurfacePoint> {
    let off = IN_FRONT * (region.max - region.min).length();
    let inside = |p: DVec3| p.cmpge(region.min).all() && p.cmple(region.max).all();
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    let mut keep = |t: [DVec3; 3]| {
        let Aabb { min, max } = Aabb::of(t);
        if min.cmple(region.max).all() && max.cmpge(region.min).all() {
            triangles.push(t);
        }
    };
    for layer in &scene.layers {
        match &layer.kind {
            LayerKind::Boxes(b) => b.boxes.iter().flat_map(box_triangles).for_each(&mut keep),
            kind => {
                if let Some(m) = kind.triangles() {
                    (0..m.mesh.triangles().len()).for_each(|t| keep(m.mesh.corners(t)));
                }
            }
        }
    }
    let ground = ground_points(scene, region, 4 * count, off);
    let ground_area: f64 = ground.iter().map(|p| p.area).sum();
    let area: f64 = triangles.iter().map(|[a, b, c]| 0.5 * (*b - *a).cross(*c - *a).length()).sum();
    let all = area + ground_area;
    if !(all > 0.0 && all.is_finite()) {
        return Vec::new();
    }
    let wanted = (count as f64 * area / all).ceil().max(1.0) as usize;
    let on_triangles = |count: usize| -> Vec<SurfacePoint> {
        let points = spread(&triangles, count, off).into_iter();
        let points = points.map(|s| {
            let normal = s.surface.unwrap_or(DVec3::Z);
            SurfacePoint { at: s.p_world, normal, area: s.amount, on_ground: false }
        });
        points.filter(|p| inside(p.at)).collect()
    };
    let mut points = on_triangles(wanted);
    if 2 * points.len() < wanted {
        // Large triangles reach far out of the region.
        points = on_triangles(wanted * (wanted / points.len().max(1)).min(16));
    }
    // Some of the many points on the ground are kept, each for a larger area.
    let wanted = (count as f64 * ground_area / all).ceil().max(1.0) as usize;
    let every = ground.len().div_ceil(wanted).max(1);
    points.extend(ground.into_iter().step_by(every).map(|p| SurfacePoint { area: p.area * every as f64, ..p }));
    points
}

/// Points on the first ground, one at random in each square of a lattice; not under boxes.
fn ground_points(scene: &Scene, region: &Aabb, count: usize, off: f64) -> Vec<SurfacePoint> {
    let Some(ground) = scene.terrain() else { return Vec::new() };
    let bounds = ground.bounds();
    let (low, high) = (region.min.max(bounds.min).truncate(), region.max.min(bounds.max).truncate());
    let extent = high - low;
    if !(extent.x > 0.0 && extent.y > 0.0) {
        return Vec::new();
    }
    let step = (extent.x * extent.y / count as f64).sqrt();
    let [cols, rows] = [extent.x, extent.y].map(|e| (e / step).ceil() as usize);
    let boxes = scene.layers.iter().filter_map(|l| l.kind.boxes().map(|b| &b.boxes));
    let boxes: Vec<_> = boxes.flatten().collect();
    let mut random = Random::new(0x6772_6f75_6e64);
    let mut points = Vec::with_capacity(cols * rows);
    for i in 0..cols * rows {
        let [u, v] = [random.unit(), random.unit()];
        let square = glam::DVec2::new((i % cols) as f64 + u, (i / cols) as f64 + v);
        let xy = low + square * extent / glam::DVec2::new(cols as f64, rows as f64);
        let e = 0.25 * ground.spacing().min_element();
        let height = |x: f64, y: f64| ground.surface_at(xy + glam::DVec2::new(x, y));
        let (Some(z), Some(east), Some(north)) = (height(0.0, 0.0), height(e, 0.0), height(0.0, e)) else { continue };
        let normal = DVec3::new(z - east, z - north, e).normalize();
        let at = xy.extend(z) + off * normal;
        let under = |b: &&&belvedere_scene::BoxShape| {
            let (sin, cos) = b.yaw.sin_cos();
            let d = at - b.base;
            let local = glam::DVec2::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x);
            (0.0..b.size.z).contains(&d.z.max(0.0)) && local.abs().cmplt(0.5 * b.size.truncate()).all()
        };
        let area = extent.x * extent.y / (cols * rows) as f64 / normal.z.max(0.05);
        if !boxes.iter().any(|b| under(&b)) && z >= region.min.z && z <= region.max.z {
            points.push(SurfacePoint { at, normal, area, on_ground: true });
        }
    }
    points
}
