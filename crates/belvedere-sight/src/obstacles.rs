//! Lines of sight along straight and curved rays, past terrain, boxes and meshes.

use crate::{BoxTree, Carried, Ground, LayerPart, Lift, MeshTree, Solids, TreeMemory};
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::{LayerKind, Scene};

/// Terrain, boxes and meshes of a scene, which can hide points. Those that something shines through hide none, and are left out unless
/// other [`Solids`] are asked for.
pub struct Obstacles<'a> {
    grounds: Vec<(usize, Ground<'a>)>,
    boxes: BoxTree,
    meshes: Vec<(usize, MeshTree<'a>)>,
    /// Rigid bodies as a view carries them, and the view of the carried bodies.
    bodies: Option<Box<(Obstacles<'static>, View)>>,
}

/// The layers, and parts of a layer, that are left out.
#[derive(Debug, Clone, Copy, Default)]
struct Without<'w> {
    layers: &'w [usize],
    /// Parts of a mesh or boxes of a layer, by its index and their numbers.
    parts: Option<(usize, &'w [u32])>,
    /// Those that are kept.
    solids: Solids,
    /// Trees of meshes that were built before.
    trees: Option<&'w TreeMemory>,
}

/// Options of the test of a line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SightOptions {
    /// Largest distance between a curved ray and the chords that stand for it near the ground, scene units.
    pub chord_m: f64,
    /// Largest clearance that is measured, scene units; 0 = only whether the point is visible.
    pub cap_m: f64,
    /// Plan distance from the point, scene units, within which a height over the ground counts only if it is smaller than
    /// that of the point itself.
    pub guard_m: f64,
}

impl<'a> Obstacles<'a> {
    /// Prepares terrain, boxes and meshes of `scene`: one pass over the nodes and the triangles.
    pub fn new(scene: &'a Scene) -> Self {
        Self::of_solids(scene, Solids::Opaque)
    }

    /// The same with other solids.
    pub fn of_solids(scene: &'a Scene, solids: Solids) -> Self {
        Self::lifted(scene, None, solids)
    }

    /// The same with other solids and without some layers, by their index.
    pub fn of_solids_without(scene: &'a Scene, solids: Solids, layers: &[usize]) -> Self {
        Self::of(scene, Without { solids, layers, ..Without::default() }, None, None)
    }

    /// The same without some layers, by their index, so that a feature does not hide itself, and without some parts of a mesh, or some
    /// boxes of a layer of boxes, by the index of the layer and their numbers.
    ///
    /// * `trees`: remembers what takes long to build.
    pub fn without(scene: &'a Scene, layers: &[usize], parts: Option<(usize, &[u32])>, trees: &TreeMemory) -> Self {
        Self::of(scene, Without { layers, parts, trees: Some(trees), ..Without::default() }, None, None)
    }

    /// The same where the ground, and boxes and meshes with it, may be displaced vertically.
    pub fn lifted(scene: &'a Scene, lift: Option<Lift<'_>>, solids: Solids) -> Self {
        Self::of(scene, Without { solids, ..Without::default() }, lift, None)
    }

    /// The same without rigid bodies, see [`Obstacles::of_bodies`].
    pub fn beside_bodies(scene: &'a Scene, lift: Option<Lift<'_>>, carried: &Carried, solids: Solids) -> Self {
        Self::of(scene, Without { solids, ..Without::default() }, lift, Some(carried))
    }

    /// Rigid bodies alone, as a view carries them: in the space of [`Carried::after`]. Triangles are numbered by [`belvedere_scene::Mesh::part`].
    pub fn of_bodies(scene: &Scene, carried: &Carried, solids: Solids) -> Obstacles<'static> {
        let mesh = |i: usize| {
            let (kind, mesh) = (&scene.layers[i].kind, carried.mesh(scene, i)?);
            match (solids.of(i, kind), kind.triangles()) {
                (LayerPart::Nothing, _) => None,
                (held @ LayerPart::Triangles { .. }, Some(layer)) => {
                    let holds = |t: usize| mesh.part(t).is_none_or(|number| held.holds(layer, number as usize));
                    Some((i, MeshTree::owned(mesh.only(&holds))))
                }
                _ => Some((i, MeshTree::owned(mesh))),
            }
        };
        let meshes = (0..scene.layers.len()).filter_map(mesh).collect();
        Obstacles { grounds: Vec::new(), boxes: BoxTree::new([], None), meshes, bodies: None }
    }

    /// Obstacles for the rays of `view`: if it carries rigid bodies as a whole, [`Obstacles::clearance`] tests its rays (and no other
    /// view's) against the carried bodies.
    pub fn seen_by(scene: &'a Scene, view: &View) -> Self {
        match Carried::new(scene, view) {
            Some(carried) => {
                let bodies =
                    Some(Box::new((Self::of_bodies(scene, &carried, Solids::Opaque), carried.after().clone())));
                Self { bodies, ..Self::beside_bodies(scene, None, &carried, Solids::Opaque) }
            }
            None => Self::new(scene),
        }
    }

    fn of(scene: &'a Scene, without: Without<'_>, lift: Option<Lift<'_>>, carried: Option<&Carried>) -> Self {
        let (mut grounds, mut boxes, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        for (i, layer) in scene.layers.iter().enumerate().filter(|(i, _)| !without.layers.contains(i)) {
            let held = without.solids.of(i, &layer.kind);
            if held == LayerPart::Nothing {
                continue;
            }
            let left_out = without.parts.filter(|(layer, _)| *layer == i).map_or(&[][..], |(_, parts)| parts);
            match &layer.kind {
                LayerKind::Terrain(t) => grounds.push((i, Ground::lifted(&t.heightfield, lift))),
                LayerKind::Boxes(_) if carried.is_some_and(|c| c.layer(i).is_some()) => {}
                LayerKind::Boxes(b) => {
                    let kept = b.boxes.iter().enumerate().filter(|(k, _)| !left_out.contains(&(*k as u32)));
                    boxes.extend(kept.map(|(k, shape)| ([i, k], shape)));
                }
                LayerKind::Mesh(_) | LayerKind::Own(_) | LayerKind::Molecule(_) => {
                    let Some(m) = layer.kind.triangles() else { continue };
                    if let (Some(trees), LayerPart::Everything) = (without.trees, held) {
                        meshes.push((i, trees.without_parts(&m.mesh, left_out)));
                        continue;
                    }
                    let b = m.mesh.bounds();
                    let lift = lift.filter(|_| !b.is_empty()).map(|lift| lift(b.min.truncate(), b.max.truncate()));
                    let lift = lift.unwrap_or([0.0; 2]);
                    let bodies = carried.and_then(|c| c.layer(i));
                    let is_in = |t: usize| !left_out.iter().any(|part| m.mesh.part(t) == Some(*part));
                    let is_loose = |t: usize| bodies.is_none_or(|b| !b.holds(t)) && held.holds(m, t) && is_in(t);
                    let some = bodies.is_some() || held != LayerPart::Everything;
                    let loose = some.then(|| {
                        (0..m.mesh.triangles().len() as u32).filter(|t| is_loose(*t as usize)).collect::<Vec<_>>()
                    });
                    match loose {
                        Some(loose) if loose.is_empty() => {}
                        Some(loose) => meshes.push((i, MeshTree::over(&m.mesh, loose, lift))),
                        None => meshes.push((i, MeshTree::lifted(&m.mesh, lift))),
                    }
                }
                // Lines, areas and points hide nothing; voxels have no surface.
                LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_) | LayerKind::Volume(_) => {}
            }
        }
        Self { grounds, boxes: BoxTree::new(boxes, lift), meshes, bodies: None }
    }

    /// The terrain layers, each with its index in the scene.
    pub fn grounds(&self) -> &[(usize, Ground<'a>)] {
        &self.grounds
    }

    /// The boxes of all layers.
    pub fn boxes(&self) -> &BoxTree {
        &self.boxes
    }

    /// The meshes, each with the index of its layer in the scene.
    pub fn meshes(&self) -> &[(usize, MeshTree<'a>)] {
        &self.meshes
    }

    /// Smallest box around all boxes and meshes, for every displacement of the ground under them.
    pub fn solid_bounds(&self) -> Aabb {
        self.meshes.iter().fold(self.boxes.bounds(), |b, (_, tree)| b.union(tree.bounds()))
    }

    /// Whether every curve within `reach` (scene units, >= 0) of the straight segment `a b`, point by point, meets no obstacle.
    /// Never wrongly true, see [`Ground::is_clear`].
    pub fn is_clear(&self, a: DVec3, b: DVec3, reach: f64) -> bool {
        self.grounds.iter().all(|(_, g)| g.is_clear(a, b, reach)) && self.is_free(a, b, reach)
    }

    /// Whether no box and no triangle of a mesh comes within `reach` of the straight segment `a b`; never wrongly true.
    fn is_free(&self, a: DVec3, b: DVec3, reach: f64) -> bool {
        let near_mesh = |tree: &MeshTree<'_>| {
            let mut near = false;
            tree.near(a, b, reach, &mut |_| {
                near = true;
                f64::NEG_INFINITY
            });
            near
        };
        self.boxes.near(a, b, reach, &mut |_, _| false) && !self.meshes.iter().any(|(_, tree)| near_mesh(tree))
    }

    /// Height of `p` over the highest terrain below or above it; `None` beside all terrain.
    pub fn above_ground(&self, p: DVec3) -> Option<f64> {
        let heights = self.grounds.iter().filter_map(|(_, g)| g.heightfield().surface_at(p.truncate()));
        heights.map(|h| p.z - h).min_by(f64::total_cmp)
    }

    /// [`Ground::min_gap`] over all obstacles; a segment through a box has a negative gap, and so has one through a mesh, the smallest
    /// possible one, for a surface has no depth.
    pub fn min_gap(&self, a: DVec3, b: DVec3, cap: f64, floor: f64) -> f64 {
        let mut best = cap;
        for (_, ground) in &self.grounds {
            best = ground.min_gap(a, b, best, floor);
            if best < floor {
                return best;
            }
        }
        self.boxes.near(a, b, 0.0, &mut |shape, _| {
            if let Some(depth) = shape.depth_inside(a, b) {
                best = best.min(-depth.max(f64::MIN_POSITIVE));
            }
            best >= floor
        });
        if best > -f64::MIN_POSITIVE && self.meshes.iter().any(|(_, m)| m.is_crossed(a, b)) {
            best = -f64::MIN_POSITIVE;
        }
        best
    }

    /// Clearance of the line of sight of `view` to `p_world`, which has an image at `pixel` and `depth`:
    /// the smallest height of the (curved) ray over the ground between the near plane and the point, in scene units;
    /// negative = hidden, by the depth of the ray under ground. At most `options.cap_m`.
    ///
    /// `lift` is the height of the point over its own ground. Near the point (see [`SightOptions::guard_m`]) only a ray that
    /// comes closer to the ground than that counts.
    ///
    /// The ray is the inverse of the view's stages at that pixel, followed by depth; the terrain is never displaced.
    pub fn clearance(
        &self,
        view: &View,
        (p_world, lift): (DVec3, f64),
        (pixel, depth): (DVec2, f64),
        options: &SightOptions,
    ) -> f64 {
        self.clearance_to(view, (Some(p_world), lift), (pixel, depth), options)
    }

    /// [`Obstacles::clearance`] of a point on a rigid body that the view carries as a whole: its image is `pixel` and `depth`; the
    /// world point of the ray at that depth may be another one, or absent.
    pub fn clearance_of_body(&self, view: &View, (pixel, depth): (DVec2, f64), options: &SightOptions) -> f64 {
        let end = view.ray(pixel).at(depth).ok().map(|r| r.point);
        self.clearance_to(view, (end, 0.0), (pixel, depth), options)
    }

    fn clearance_to(
        &self,
        view: &View,
        (p_world, lift): (Option<DVec3>, f64),
        (pixel, depth): (DVec2, f64),
        options: &SightOptions,
    ) -> f64 {
        let beside = self.clearance_beside_bodies(view, (p_world, lift), (pixel, depth), options);
        let Some((bodies, after)) = self.bodies.as_deref().filter(|_| beside >= 0.0) else { return beside };
        let Ok(end) = after.ray(pixel).at(depth) else { return beside };
        // A surface has no depth: the test is only whether the ray passes it.
        let whether = SightOptions { cap_m: 0.0, ..*options };
        let behind = bodies.clearance_beside_bodies(after, (Some(end.point), lift), (pixel, depth), &whether);
        if behind < 0.0 { behind } else { beside }
    }

    fn clearance_beside_bodies(
        &self,
        view: &View,
        (p_world, lift): (Option<DVec3>, f64),
        (pixel, depth): (DVec2, f64),
        options: &SightOptions,
    ) -> f64 {
        let near = view.pinhole().near.min(depth);
        let ray = view.ray(pixel);
        let at = |w: f64| if w >= depth { p_world } else { ray.at(w).ok().map(|r| r.point) };
        let straight = view.stages().is_empty();
        let guard_depth = p_world.map_or(depth, |p| self.guard_depth(&at, p, near, depth, options.guard_m));
        let floor = if options.cap_m > 0.0 { f64::NEG_INFINITY } else { 0.0 };
        let walk = |from: f64, to: f64, cap: f64, floor: f64| {
            if straight {
                return at(from).map_or(cap, |a| at(to).map_or(cap, |b| self.min_gap(a, b, cap, floor)));
            }
            let pieces = 12;
            let depth_at = |i: usize| from + (to - from) * i as f64 / pieces as f64;
            let mut chords = Chords { obstacles: self, at: &at, chord_m: options.chord_m, floor, best: cap };
            // From the point towards the eye: occluders are usually near the point.
            for i in (0..pieces).rev() {
                let (w0, w1) = (depth_at(i), depth_at(i + 1));
                chords.walk((w0, at(w0)), (w1, at(w1)), 0);
                if chords.best < floor {
                    break;
                }
            }
            chords.best
        };
        let own = if options.cap_m > 0.0 { (lift - 1e-3).max(0.0) } else { 0.0 };
        let beside = walk(guard_depth, depth, own, floor);
        if beside < 0.0 && options.cap_m <= 0.0 {
            return beside;
        }
        let along = walk(near, guard_depth, options.cap_m, floor);
        if beside < own { along.min(beside) } else { along }
    }

    /// Depth at which the ray comes within `guard` of its end, in plan.
    fn guard_depth(&self, at: &dyn Fn(f64) -> Option<DVec3>, p: DVec3, near: f64, depth: f64, guard: f64) -> f64 {
        let step = 1e-4 * (depth - near);
        let Some(before) = at(depth - step).filter(|_| step > 0.0) else { return depth };
        let speed = (p - before).truncate().length() / step;
        if speed * (depth - near) <= guard { near } else { depth - guard / speed }
    }
}

/// Walks a curve by chords, which are halved until their error cannot change the result.
struct Chords<'a> {
    obstacles: &'a Obstacles<'a>,
    at: &'a dyn Fn(f64) -> Option<DVec3>,
    chord_m: f64,
    floor: f64,
    best: f64,
}

/// Chords are halved at most this often.
const MAX_HALVINGS: u32 = 14;
/// Most halvings where part of the ray has no world point (outside the domain of a stage).
const MAX_HALVINGS_OF_NOTHING: u32 = 6;

impl Chords<'_> {
    fn walk(&mut self, (w0, p0): (f64, Option<DVec3>), (w1, p1): (f64, Option<DVec3>), halvings: u32) {
        if self.best < self.floor {
            return;
        }
        let middle_depth = 0.5 * (w0 + w1);
        let middle = (self.at)(middle_depth);
        let split_at = match (p0, middle, p1) {
            (Some(a), Some(m), Some(b)) => {
                let bow = (m - 0.5 * (a + b)).length();
                if bow <= self.chord_m || halvings >= MAX_HALVINGS {
                    self.best = self.obstacles.min_gap(a, b, self.best, self.floor);
                    return;
                }
                // A curve stays within a few times the bow at its middle; if even that is clear, so is the curve.
                let safe = self.best + 4.0 * bow;
                if self.obstacles.min_gap(a, b, safe, safe) >= safe && self.obstacles.is_free(a, b, 4.0 * bow) {
                    return;
                }
                MAX_HALVINGS
            }
            (None, None, None) => 2,
            _ => MAX_HALVINGS_OF_NOTHING,
        };
        if halvings >= split_at {
            return;
        }
        self.walk((middle_depth, middle), (w1, p1), halvings + 1);
        self.walk((w0, p0), (middle_depth, middle), halvings + 1);
    }
}
