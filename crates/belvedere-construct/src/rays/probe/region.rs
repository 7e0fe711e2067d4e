//! The part of a scene in which a probe searches.

use super::voxels::Voxels;
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::Scene;
use belvedere_sight::Obstacles;
use rayon::prelude::*;

/// Rays by which the straight picture is measured, across and down.
const RAYS: [u32; 2] = [24, 14];
/// Number of halvings that find the end of a ray.
const HALVINGS: usize = 26;
/// Reach of a probe, multiple of the median distance that the straight picture shows.
const REACH: f64 = 3.0;
/// Margin around everything that the straight picture could show, share of the reach.
const AROUND: f64 = 0.25;

/// The box in which a probe searches.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub(super) bounds: Aabb,
    /// Distance from the eye, scene units.
    pub(super) reach: f64,
}

impl Region {
    /// * `reach`: scene units; by default some times the median distance of what the straight picture shows.
    ///
    /// `None` if the picture could show nothing.
    pub(super) fn new(scene: &Scene, base: &View, reach: Option<f64>) -> Option<Self> {
        let solid = solid_bounds(scene);
        let pinhole = base.pinhole();
        if solid.is_empty() {
            return None;
        }
        let farthest = solid.corners().iter().map(|c| c.distance(pinhole.eye)).fold(0.0, f64::max);
        let farthest = pinhole.far.map_or(farthest, |far| farthest.min(far));
        let reach = match reach {
            Some(reach) => reach,
            None => REACH * median_distance(scene, base, farthest).unwrap_or(farthest),
        };
        let reach = reach.min(farthest);
        let [w, h] = pinhole.image.map(f64::from);
        let corners = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)];
        let ends = corners.map(|(x, y)| pinhole.unproject(DVec2::new(x, y), reach));
        let frustum = Aabb::of(ends.into_iter().chain([pinhole.eye]));
        let around = AROUND * reach;
        // Everything solid lies within; paths may pass over and beside it, not under it.
        let [low, high] = [solid.min - DVec3::new(around, around, 0.0), solid.max + around];
        let min = (frustum.min - around).max(low.min(pinhole.eye));
        let max = (frustum.max + around).min(high.max(pinhole.eye));
        let bounds = Aabb { min, max };
        let meets = bounds.min.cmplt(bounds.max).all()
            && bounds.min.cmplt(solid.max).all()
            && bounds.max.cmpgt(solid.min).all();
        (meets && reach > 0.0).then_some(Self { bounds, reach })
    }
}

/// Around everything that has a surface.
fn solid_bounds(scene: &Scene) -> Aabb {
    use belvedere_scene::LayerKind::{Boxes, Mesh, Molecule, Own, Terrain};
    let solid =
        scene.layers.iter().filter(|l| matches!(l.kind, Boxes(_) | Mesh(_) | Molecule(_) | Own(_) | Terrain(_)));
    solid.fold(Aabb::EMPTY, |b, l| b.union(l.bounds()))
}

/// Median length of the straight rays that end on a surface.
fn median_distance(scene: &Scene, base: &View, farthest: f64) -> Option<f64> {
    let obstacles = Obstacles::new(scene);
    let pinhole = base.pinhole();
    let [w, h] = pinhole.image.map(f64::from);
    let is_clear = |a: DVec3, b: DVec3| obstacles.min_gap(a, b, 0.0, 0.0) >= 0.0;
    let rays = 0..RAYS[0] * RAYS[1];
    let mut lengths: Vec<f64> = rays
        .into_par_iter()
        .filter_map(|i| {
            let at = DVec2::new(f64::from(i % RAYS[0]) + 0.5, f64::from(i / RAYS[0]) + 0.5);
            let pixel = at * DVec2::new(w / f64::from(RAYS[0]), h / f64::from(RAYS[1]));
            let (from, ray) = pinhole.line(pixel);
            let (from, ray) = (from + pinhole.near * ray, ray.normalize());
            let mut range = [0.0, farthest];
            if is_clear(from, from + farthest * ray) {
                return None;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (range[0] + range[1]);
                range[usize::from(!is_clear(from, from + middle * ray))] = middle;
            }
            Some(range[0])
        })
        .collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied().filter(|length| *length > 1e-6 * farthest)
}

/// For every cell whether it is free and the straight picture shows its middle.
pub(super) fn cells_seen(voxels: &Voxels, base: &View, obstacles: &Obstacles<'_>) -> Vec<bool> {
    let pinhole = base.pinhole();
    let is_seen = |cell: usize| {
        let center = voxels.center(cell);
        !voxels.is_solid(cell)
            && pinhole.project(center).is_ok_and(|(pixel, depth)| depth >= pinhole.near && pinhole.contains(pixel))
            && obstacles.min_gap(pinhole.eye, center, 0.0, 0.0) >= 0.0
    };
    (0..voxels.len()).into_par_iter().map(is_seen).collect()
}
