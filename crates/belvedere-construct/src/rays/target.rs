//! Targets: things that must be seen, and the share of them that a view shows.

use super::surface_points;
use crate::surface_samples::spread;
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::{LayerKind, OwnLayer, Scene, Unit};
use belvedere_sight::{Obstacles, SightOptions, TreeMemory, Voxels};
use std::sync::Arc;

/// A thing that must be seen, as points.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Points that stand for it, scene coordinates.
    pub points: Vec<DVec3>,
    /// The box around it.
    pub bounds: Aabb,
    /// Layers that are the target themselves, by their index: they do not hide it.
    pub own_layers: Vec<usize>,
    /// Parts of a mesh, atoms of a molecule, or boxes of a layer, that are the target themselves: the index of the layer, and their
    /// numbers, rising.
    pub own_parts: Option<(usize, Vec<u32>)>,
    /// The points are the middles of balls of these radii, scene units, and seen if the front of the ball is; empty for points of their own.
    pub radii: Vec<f64>,
    /// The points lie on a surface with these outward unit normals: one counts where it faces the eye, by the area that its piece of the
    /// surface fills in the picture. 0 or nothing for a point that counts from everywhere.
    pub facing: Vec<DVec3>,
}

/// Most balls that are tested.
const MOST_BALLS: usize = 64;
/// Points on ribbons and smooth surfaces; about half of them face the eye.
const ON_SURFACE: usize = 48;
/// Distance of these points before their surface, share of its extent.
const BEFORE: f64 = 1e-4;
/// Share of light that volumes must let through for a point to be seen.
const SEEN: f64 = 0.5;

impl Target {
    /// A whole layer, by its index: points all over its surface; of a molecule or mesh with a selection of what must be seen, the atoms
    /// or parts of that. `None` if the layer has no extent in space of its own (terrain, areas) or holds nothing.
    pub fn layer(scene: &Scene, index: usize) -> Option<Self> {
        let layer = scene.layers.get(index)?;
        let bounds = layer.bounds();
        if bounds.is_empty() {
            return None;
        }
        match &layer.kind {
            LayerKind::Terrain(_) | LayerKind::Area(_) => None,
            LayerKind::Line(l) => {
                Some(Self::points(l.features.iter().flat_map(|f| &f.points).map(|&p| p + l.lift_m * DVec3::Z)))
            }
            LayerKind::Point(l) => Some(Self::points(l.features.iter().map(|f| f.position + l.lift_m * DVec3::Z))),
            LayerKind::Molecule(m) if m.wanted.is_some() => {
                let mask = m.wanted.as_ref()?.mask(&m.molecule);
                Self::atoms(scene, index, &(0..mask.len()).filter(|&i| mask[i]).collect::<Vec<_>>())
            }
            LayerKind::Volume(layer) => {
                let points = layer.visible_voxels(MOST_BALLS);
                (!points.is_empty()).then(|| Self { own_layers: vec![index], ..Self::points(points) })
            }
            LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => match &m.wanted {
                Some(parts) => Self::parts(scene, index, parts),
                None => {
                    let points = surface_points::on_triangles((0..m.mesh.triangles().len()).map(|t| m.mesh.corners(t)));
                    Some(Self { own_layers: vec![index], points, ..Self::around(bounds) })
                }
            },
            LayerKind::Molecule(m) => {
                let mesh = &m.surface.mesh;
                let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect();
                let mut target = Self { own_layers: vec![index], ..Self::points([]) };
                target.add_surface(&triangles);
                Some(target)
            }
            LayerKind::Boxes(b) => {
                let points = surface_points::on_boxes(&b.boxes);
                Some(Self { own_layers: vec![index], points, ..Self::around(bounds) })
            }
        }
    }

    /// Named parts of a mesh, or boxes of a layer, by their numbers: points all over their surface. `None` if there are none.
    pub fn parts(scene: &Scene, index: usize, parts: &[u32]) -> Option<Self> {
        let mut parts = parts.to_vec();
        parts.sort_unstable();
        let (bounds, points) = match &scene.layers.get(index)?.kind {
            LayerKind::Mesh(layer) | LayerKind::Own(OwnLayer { surface: layer, .. }) => {
                let mesh = &layer.mesh;
                let is_own = |&t: &usize| mesh.part(t).is_some_and(|part| parts.binary_search(&part).is_ok());
                let own: Vec<usize> = (0..mesh.triangles().len()).filter(is_own).collect();
                let corners = own.iter().map(|&t| mesh.corners(t));
                (Aabb::of(corners.clone().flatten()), surface_points::on_triangles(corners))
            }
            LayerKind::Boxes(layer) => {
                let own: Vec<_> = parts.iter().filter_map(|&k| layer.boxes.get(k as usize)).copied().collect();
                (Aabb::of(own.iter().flat_map(|shape| shape.corners())), surface_points::on_boxes(&own))
            }
            _ => return None,
        };
        (!bounds.is_empty()).then(|| Self { own_parts: Some((index, parts)), points, ..Self::around(bounds) })
    }

    /// Atoms of a molecule, by their numbers: as balls, or where they are drawn as ribbons or smooth surfaces by points all over these. Those
    /// that are not drawn, or buried under a smooth surface, are left out. `None` if none is drawn.
    pub fn atoms(scene: &Scene, index: usize, atoms: &[usize]) -> Option<Self> {
        let layer = scene.layers.get(index)?.kind.molecule()?;
        let mesh = &layer.surface.mesh;
        let mut drawn = vec![false; layer.molecule.atoms().len()];
        for part in (0..mesh.triangles().len()).filter_map(|t| mesh.part(t)) {
            drawn[part as usize] = true;
        }
        // A ribbon shows its residue at one atom.
        let stand_ins = atoms.iter().filter_map(|&i| layer.stand_in(i));
        let mut own: Vec<usize> = stand_ins.filter(|&i| drawn.get(i) == Some(&true)).collect();
        own.sort_unstable();
        own.dedup();
        let balls = own.iter().filter(|i| layer.is_ball(**i)).map(|&i| (layer.center(i), layer.radius(i)));
        let mut target = Self::balls(balls);
        let on_surface = |t: &usize| {
            let part = mesh.part(*t).map(|part| part as usize);
            part.is_some_and(|part| !layer.is_ball(part) && own.binary_search(&part).is_ok())
        };
        let surface: Vec<[DVec3; 3]> =
            (0..mesh.triangles().len()).filter(on_surface).map(|t| mesh.corners(t)).collect();
        target.add_surface(&surface);
        let numbers = own.iter().map(|&i| i as u32).collect();
        (!own.is_empty()).then_some(Self { own_parts: Some((index, numbers)), ..target })
    }

    /// Adds points all over a surface.
    fn add_surface(&mut self, triangles: &[[DVec3; 3]]) {
        let bounds = Aabb::of(triangles.iter().flatten().copied());
        let off = BEFORE * (bounds.max - bounds.min).length();
        let samples = if bounds.is_empty() { Vec::new() } else { spread(triangles, ON_SURFACE, off) };
        self.radii.resize(self.points.len(), 0.0);
        self.facing.resize(self.points.len(), DVec3::ZERO);
        for sample in samples {
            self.points.push(sample.p_world);
            self.radii.push(0.0);
            self.facing.push(sample.surface.unwrap_or(DVec3::ZERO));
        }
        self.bounds = self.bounds.union(bounds);
    }

    /// The same with further points that must be seen.
    pub fn with_points(&self, points: &[DVec3]) -> Self {
        let mut more = self.clone();
        more.radii.resize(self.points.len(), 0.0);
        more.facing.resize(self.points.len(), DVec3::ZERO);
        more.points.extend(points.iter().filter(|p| p.is_finite()));
        more
    }

    /// The points of a box.
    pub fn around(bounds: Aabb) -> Self {
        let points = surface_points::on_bounds(bounds);
        Self { bounds, ..Self::points(points) }
    }

    /// Balls, such as atoms: middle and radius, scene units. Of many balls some are tested, evenly chosen.
    pub fn balls(balls: impl IntoIterator<Item = (DVec3, f64)>) -> Self {
        let all: Vec<(DVec3, f64)> = balls.into_iter().filter(|(p, _)| p.is_finite()).collect();
        let every = all.len().div_ceil(MOST_BALLS).max(1);
        let (points, radii): (Vec<_>, Vec<_>) = all.into_iter().step_by(every).unzip();
        Self { radii, ..Self::points(points) }
    }

    /// Points, e.g. on a surface or along a line.
    pub fn points(points: impl IntoIterator<Item = DVec3>) -> Self {
        let points: Vec<DVec3> = points.into_iter().filter(|p| p.is_finite()).collect();
        let bounds = Aabb::of(points.iter().copied());
        Self { points, bounds, own_layers: Vec::new(), own_parts: None, radii: Vec::new(), facing: Vec::new() }
    }

    /// Its middle.
    pub fn center(&self) -> DVec3 {
        self.bounds.center()
    }

    /// Half its largest extent.
    pub fn extent(&self) -> f64 {
        0.5 * (self.bounds.max - self.bounds.min).length() + self.radius()
    }

    /// Largest radius of its balls, scene units; 0 for points of their own.
    pub fn radius(&self) -> f64 {
        self.radii.iter().copied().fold(0.0, f64::max)
    }
}

/// Visibility of a target in a view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Share of its points that are in the picture and seen, 0..=1.
    pub share: f64,
    /// Light that comes from them, 0..=1: the mean of what volumes let through, nothing from points behind other things.
    pub light: f64,
}

/// How much views show of a target, by lines of sight along their rays past everything else in the scene. Volumes hide a point where
/// they absorb more than half of its light.
pub struct TargetSight<'a> {
    scene: &'a Scene,
    /// Lowest height of the scene, where it has ground.
    lowest: Option<f64>,
    target: &'a Target,
    obstacles: Arc<Obstacles<'a>>,
    voxels: Arc<Voxels<'a>>,
    /// Whether no volume takes light away.
    is_clear: bool,
    sight: SightOptions,
}

impl<'a> TargetSight<'a> {
    /// One pass over the scene.
    pub fn new(scene: &'a Scene, target: &'a Target) -> Self {
        Self::remembering(scene, target, &TreeMemory::default())
    }

    /// The same with trees over meshes that earlier calls built.
    pub fn remembering(scene: &'a Scene, target: &'a Target, trees: &TreeMemory) -> Self {
        let extent = (2.0 * target.extent()).max(1e-9);
        let cell = scene.terrain().map_or(0.0, |t| t.spacing().max_element());
        let bounds = scene.bounds();
        let whole = if bounds.is_empty() { 0.0 } else { (bounds.max - bounds.min).length() };
        let chord_m = (1e-3 * extent).max(2e-5 * whole) + 0.05 * cell;
        let sight = SightOptions { chord_m, cap_m: 0.0, guard_m: 1.5 * cell };
        let voxels = Voxels::without(scene, &target.own_layers);
        let own_parts = target.own_parts.as_ref().map(|(layer, parts)| (*layer, &parts[..]));
        let obstacles = Obstacles::without(scene, &target.own_layers, own_parts, trees);
        // Molecules and volumes have no ground.
        let lowest = (scene.unit == Unit::Metre && !bounds.is_empty()).then_some(bounds.min.z);
        let is_clear = !scene.layers.iter().any(|layer| layer.kind.volume().is_some());
        let (obstacles, voxels) = (Arc::new(obstacles), Arc::new(voxels));
        Self { scene, lowest, target, obstacles, voxels, is_clear, sight }
    }

    /// The same lines of sight to other points of the target.
    pub fn to_points(&self, target: &'a Target) -> Self {
        Self { target, obstacles: self.obstacles.clone(), voxels: self.voxels.clone(), ..*self }
    }

    pub(super) fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// The target.
    pub fn target(&self) -> &'a Target {
        self.target
    }

    /// Height of a position above the terrain, or beside it above the lowest of the scene, metres; infinite in scenes without ground.
    pub(super) fn height_above_ground(&self, place: DVec3) -> f64 {
        let ground = self.scene.terrain().and_then(|t| t.surface_at(place.truncate())).or(self.lowest);
        ground.map_or(f64::INFINITY, |ground| place.z - ground)
    }

    /// Share of the target's points that are in the picture and seen, 0..=1.
    ///
    /// * `grow_px`: distance by which the points are first moved apart in the picture, sideways and upwards, pixels.
    pub fn share(&self, view: &View, grow_px: f64) -> f64 {
        self.shown(view, grow_px).share
    }

    /// What the view shows of the target; `grow_px` as in [`TargetSight::share`].
    pub fn shown(&self, view: &View, grow_px: f64) -> Shown {
        self.shown_over(view, grow_px, f64::NEG_INFINITY).unwrap_or(Shown { share: 0.0, light: 0.0 })
    }

    /// The same; `None` as soon as it is certain that no larger share than `least` is seen, which saves the remaining lines of sight. Where
    /// volumes let light through nothing is saved, for that counts as well.
    pub(super) fn shown_over(&self, view: &View, grow_px: f64, least: f64) -> Option<Shown> {
        let points = &self.target.points;
        let weights: Vec<f64> = (0..points.len()).map(|k| self.weight(view, k)).collect();
        let all = Some(weights.iter().sum::<f64>()).filter(|all| *all > 0.0).unwrap_or(1.0);
        let (mut hidden, mut sum) = (0.0, 0.0);
        for (k, (p, weight)) in points.iter().zip(&weights).enumerate().filter(|(_, (_, weight))| **weight > 0.0) {
            let radius = self.target.radii.get(k).copied().unwrap_or(0.0);
            let light = self.light(view, (*p, radius), grow_px);
            sum += weight * light;
            hidden += if light >= SEEN { 0.0 } else { *weight };
            if self.is_clear && (all - hidden) / all <= least {
                return None;
            }
        }
        let nothing = weights.iter().all(|weight| *weight == 0.0);
        Some(Shown { share: if nothing { 0.0 } else { (all - hidden) / all }, light: sum / all })
    }

    /// How much a point counts, 0..=1: by the angle between the normal of its surface and the ray that comes to it.
    fn weight(&self, view: &View, k: usize) -> f64 {
        let (p, Some(normal)) = (self.target.points[k], self.target.facing.get(k).filter(|n| **n != DVec3::ZERO))
        else {
            return 1.0;
        };
        let before = view.project(p).ok().and_then(|image| {
            let before = view.ray(image.pixel).at((1.0 - 1e-4) * image.depth).ok()?;
            Some(before.point)
        });
        normal.dot((before.unwrap_or(view.pinhole().eye) - p).normalize_or_zero()).max(0.0)
    }

    /// Share of the target's points that are in the picture, hidden or not, 0..=1.
    pub fn in_frame(&self, view: &View) -> f64 {
        let pinhole = view.pinhole();
        let inside = self.target.points.iter().filter(|p| {
            let in_range = |depth: f64| depth >= pinhole.near && pinhole.far.is_none_or(|far| depth <= far);
            view.project(**p).is_ok_and(|image| in_range(image.depth) && pinhole.contains(image.pixel))
        });
        inside.count() as f64 / self.target.points.len().max(1) as f64
    }

    /// Light that comes from a point.
    fn light(&self, view: &View, (p, radius): (DVec3, f64), grow_px: f64) -> f64 {
        let p = self.grown(view, p, grow_px);
        let Ok(image) = view.project(p) else { return 0.0 };
        let pinhole = view.pinhole();
        let in_range = image.depth >= pinhole.near && pinhole.far.is_none_or(|far| image.depth <= far);
        if !in_range || image.folded || !pinhole.contains(image.pixel) {
            return 0.0;
        }
        let (p, depth) = self.front(view, (p, radius), (image.pixel, image.depth));
        if self.obstacles.clearance(view, (p, 0.0), (image.pixel, depth), &self.sight) < 0.0 {
            return 0.0;
        }
        self.voxels.light(view, image.pixel, depth)
    }

    /// Where the ray to the middle of a ball meets the ball, and its depth there.
    fn front(&self, view: &View, (p, radius): (DVec3, f64), (pixel, depth): (DVec2, f64)) -> (DVec3, f64) {
        let step = 1e-4 * depth;
        let ray = view.ray(pixel);
        let at = |w: f64| ray.at(w).map(|r| r.point);
        match at(depth - step) {
            Ok(before) if radius > 0.0 => {
                let depth = (depth - step * 1.01 * radius / before.distance(p)).max(view.pinhole().near);
                at(depth).map_or((p, depth), |front| (front, depth))
            }
            _ => (p, depth),
        }
    }

    /// A point moved away from the middle of the target: to its side of the picture, and up if it lies in the upper half.
    fn grown(&self, view: &View, p: DVec3, grow_px: f64) -> DVec3 {
        let pinhole = view.pinhole();
        let v = p - self.target.center();
        let depth = (p - pinhole.eye).dot(pinhole.forward);
        if grow_px == 0.0 || !(depth > 0.0) {
            return p;
        }
        let by = grow_px * depth / pinhole.scale_px();
        let (x, y) = (v.dot(pinhole.right), v.dot(pinhole.down));
        // Points do not move down, into what the target stands on.
        let up = if y < 0.0 { -by * pinhole.down } else { DVec3::ZERO };
        p + up + if x == 0.0 { DVec3::ZERO } else { x.signum() * by * pinhole.right }
    }
}
