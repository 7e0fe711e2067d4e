//! First hits of curved rays on the surfaces of a scene.

use crate::screen::Screen;
use crate::sections::{Exposure, Sections, Shown};
use crate::trace::curve::{Curve, Span, Split};
use crate::trace::root::root;
use crate::{Carried, GridLine, Lift, MeshTree, Obstacles, Solids, UprightBox};
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::{CellTriangle, Heightfield, LayerKind, NodeState, Scene};
use std::ops::ControlFlow;

/// Distance of a ray from its chord, pixels, below which the chord is used to find its hits.
const CHORD_PX: f64 = 1e-3;
/// Largest number of halvings of a span, and of a span without any point of the ray.
const MAX_HALVINGS: u32 = 40;
const MAX_HALVINGS_OF_NOTHING: u32 = 3;
/// The same where it may enter a strip.
const MAX_HALVINGS_BESIDE_STRIP: u32 = 12;

/// First hit of the ray of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Depth at which it is seen, scene units.
    pub depth: f64,
    /// True (undisplaced) world point, scene coordinates.
    pub point: DVec3,
    /// Segment of the curved ray, see [`belvedere_core::Displaced::segment`].
    pub segment: u32,
    /// Part of the layer.
    pub part: Part,
}

impl RayHit {
    /// Number of the triangle of a mesh or of a molecule's surface; `None` on everything else.
    pub fn triangle(&self) -> Option<usize> {
        match self.part {
            Part::Triangle(index, _) => Some(index),
            _ => None,
        }
    }
}

/// Part of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// Cell (column, row) of a terrain, and which of its triangles.
    Cell([usize; 2], CellTriangle),
    /// Number of a box and the outward normal of its face.
    Face(usize, DVec3),
    /// Number of a triangle of a mesh and whether it is seen from the side where its corners run counter-clockwise.
    Triangle(usize, bool),
    /// Inside a volume.
    Voxels,
}

/// A scene prepared for rays of one view.
///
/// The ray `RayPath::at` of every pixel is followed by depth; nothing is subdivided, projected or rasterised. Spans of the ray that clear
/// the ground and the boxes by more than their bend are skipped; in the others the sign of the height over the drawn surface
/// ([`Heightfield::surface_in_cell`]), or of the distance from a box, is followed from cell to cell, and a change of sign is bracketed to
/// about 1e-12 of the depth. The maximum mipmap is that of Tevs et al. 2008; curved rays through it are ours.
pub struct Tracer<'a> {
    pub(crate) split: Split<'a>,
    screen: Screen,
    pub(crate) obstacles: Obstacles<'a>,
    /// Bounds of all boxes and meshes, displaced with the ground.
    solid: Aabb,
    pub(crate) range: [f64; 2],
    sections: Option<Sections<'a>>,
    exposure: Exposure,
    /// Set if this tracer holds the carried rigid bodies.
    carried: Option<(Carried, &'a Scene)>,
    /// Tracer of the rigid bodies, if the view carries any.
    pub(crate) bodies: Option<Box<Tracer<'a>>>,
}

impl<'a> Tracer<'a> {
    /// Prepares terrain, boxes and meshes of `scene`: one pass over the nodes and the triangles.
    ///
    /// Where styling sections show layers in part, a ray hits only surfaces that its pixel's threshold shows. Solids that something shines
    /// through are hit, those with an opacity of 0 are not.
    pub fn new(scene: &'a Scene, view: &'a View) -> Self {
        let sections = Sections::of(scene, view, None, true);
        Self::exposed((scene, Solids::Drawn), view, sections, Exposure::new(1, 1))
    }

    /// The same without solids that are seen through: rays go on to what is behind them.
    pub fn of_opaque(scene: &'a Scene, view: &'a View) -> Self {
        let sections = Sections::of(scene, view, None, true);
        Self::exposed((scene, Solids::Opaque), view, sections, Exposure::new(1, 1))
    }

    /// The same for chosen solids and samples.
    ///
    /// * `solids`: those of the scene that rays meet; `exposure`: thresholds of the samples.
    pub fn exposed(
        (scene, solids): (&'a Scene, Solids),
        view: &'a View,
        sections: Option<Sections<'a>>,
        exposure: Exposure,
    ) -> Self {
        let split = Split::new(view);
        let lift = |min: DVec2, max: DVec2| split.ground.map_or([0.0; 2], |g| g.grid().span_over(min, max));
        let lift: Option<Lift<'_>> = if split.ground.is_some() { Some(&lift) } else { None };
        let carried = Carried::new(scene, view);
        let obstacles = match &carried {
            Some(carried) => Obstacles::beside_bodies(scene, lift, carried, solids),
            None => Obstacles::lifted(scene, lift, solids),
        };
        let bodies = carried.map(|c| Box::new(Self::of_bodies((scene, solids), c, sections.clone(), exposure.clone())));
        let range = [view.pinhole().near, deepest(scene, view)];
        let (screen, solid) = (Screen::new(view.pinhole()), obstacles.solid_bounds());
        Self { split, screen, obstacles, solid, range, sections, exposure, carried: None, bodies }
    }

    /// A tracer of the rigid bodies, in the space to which they are carried.
    fn of_bodies(
        (scene, solids): (&'a Scene, Solids),
        carried: Carried,
        sections: Option<Sections<'a>>,
        exposure: Exposure,
    ) -> Self {
        let view = carried.after();
        let obstacles = Obstacles::of_bodies(scene, &carried, solids);
        let solid = obstacles.solid_bounds();
        let range = [view.pinhole().near, deepest_in(&solid, view)];
        let (screen, split) = (Screen::new(view.pinhole()), Split::after_bodies(view.clone()));
        let carried = Some((carried, scene));
        Self { split, screen, obstacles, solid, range, sections, exposure, carried, bodies: None }
    }

    /// First hit of the ray of `pixel` between the near and far depth of the camera; `None` for the sky.
    ///
    /// Of surfaces at the same depth the layer listed first is hit.
    pub fn first_hit(&self, pixel: DVec2) -> Option<RayHit> {
        let row = self.split.row(pixel.y, self.range);
        let hit = self.hit_on(&self.split.curve(pixel, row.as_ref()), self.range[0], self.threshold(0, pixel));
        nearer(hit, self.bodies.as_ref().and_then(|bodies| bodies.first_hit(pixel)))
    }

    /// Threshold of a sample, by its number, of the pixel in which it lies.
    pub(crate) fn threshold(&self, sample: usize, pixel: DVec2) -> f64 {
        self.exposure.threshold(sample, pixel.x.floor() as i32, pixel.y.floor() as i32)
    }

    /// First hit of a curve that is known to hit nothing before depth `start`, for a sample with a threshold.
    pub(crate) fn hit_on(&self, curve: &Curve<'_, '_>, start: f64, threshold: f64) -> Option<RayHit> {
        let walk = Walk { tracer: self, curve, start, threshold };
        let spans = curve.spans([start, self.range[1]]);
        let (depth, layer, part) = spans.into_iter().find_map(|span| walk.span(span, 0))?;
        let point = walk.true_point(depth)?;
        let part = match part {
            Part::Face(index, _) => Part::Face(index, self.face(layer, index, point)),
            Part::Triangle(index, _) => Part::Triangle(index, self.is_front(layer, index, &|w| curve.at(w), depth)),
            cell => cell,
        };
        let hit = RayHit { layer, depth, point, segment: curve.segment(depth), part };
        if self.carried.is_some() { self.taken_back(hit) } else { Some(hit) }
    }

    /// A hit on a carried body, in the coordinates of its layer.
    fn taken_back(&self, hit: RayHit) -> Option<RayHit> {
        let Part::Triangle(index, front) = hit.part else { return None };
        let (_, tree) = self.obstacles.meshes().iter().find(|(i, _)| *i == hit.layer)?;
        let triangle = tree.mesh().part(index)? as usize;
        let (carried, scene) = self.carried.as_ref()?;
        let (_, motion) = carried.layer(hit.layer)?.body(triangle)?;
        let part = match &scene.layers.get(hit.layer)?.kind {
            LayerKind::Boxes(b) => Part::Face(triangle / 12, b.boxes.get(triangle / 12)?.normal_of(triangle % 12)),
            _ => Part::Triangle(triangle, front),
        };
        Some(RayHit { point: motion.undo(hit.point), part, ..hit })
    }

    /// The undisplaced position of a point on a triangle, by the triangle's number in its tree.
    fn place_of(&self, layer: usize, tree: &MeshTree<'_>, triangle: usize, p: DVec3) -> Option<DVec3> {
        let Some((carried, _)) = &self.carried else { return Some(p) };
        let (_, motion) = carried.layer(layer)?.body(tree.mesh().part(triangle)? as usize)?;
        Some(motion.undo(p))
    }

    /// Whether a box contains no surface of the scene.
    pub(crate) fn is_empty(&self, bounds: &Aabb) -> bool {
        let apart = bounds.min.cmpgt(self.solid.max).any() || bounds.max.cmplt(self.solid.min).any();
        apart && self.obstacles.grounds().iter().all(|(_, g)| g.is_off(bounds))
    }

    /// Finest spacing of the ground, scene units; infinite without ground.
    pub(crate) fn cell(&self) -> f64 {
        let spacing = self.obstacles.grounds().iter().map(|(_, g)| g.heightfield().spacing().min_element());
        spacing.fold(f64::INFINITY, f64::min)
    }

    /// Whether a ray hits the side of a triangle from which its corners run counter-clockwise.
    fn is_front(&self, layer: usize, triangle: usize, at: &impl Fn(f64) -> Option<DVec3>, depth: f64) -> bool {
        let Some((_, tree)) = self.obstacles.meshes().iter().find(|(i, _)| *i == layer) else { return true };
        let step = 1e-6 * depth;
        match (at(depth - step), at(depth)) {
            (Some(before), Some(here)) => tree.mesh().face_normal(triangle).dot(here - before) <= 0.0,
            _ => true,
        }
    }

    fn face(&self, layer: usize, index: usize, p: DVec3) -> DVec3 {
        let mut normal = DVec3::Z;
        self.obstacles.boxes().near(p, p, 1e-3 * p.length().max(1.0), &mut |shape, _| {
            if shape.layer == layer && shape.index == index {
                normal = shape.normal(p);
                return false;
            }
            true
        });
        normal
    }
}

/// The nearer of two hits; of two at one depth that of the layer listed first.
pub(crate) fn nearer(a: Option<RayHit>, b: Option<RayHit>) -> Option<RayHit> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if (b.depth, b.layer) < (a.depth, a.layer) { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Depth beyond which no surface is seen: the largest depth of a lattice over the scene's bounds, and a step more.
pub fn deepest(scene: &Scene, view: &View) -> f64 {
    deepest_in(&scene.bounds(), view)
}

fn deepest_in(bounds: &Aabb, view: &View) -> f64 {
    const LATTICE: usize = 24;
    let far = view.pinhole().far.unwrap_or(f64::INFINITY);
    let near = view.pinhole().near;
    if bounds.is_empty() {
        return (2.0 * near).min(far);
    }
    let mut largest = near;
    let mut step = 0.0f64;
    let share = |i: usize| i as f64 / LATTICE as f64;
    for k in 0..3 {
        let mut above: Vec<Option<f64>> = vec![None; LATTICE + 1];
        for j in 0..=LATTICE {
            let mut before: Option<f64> = None;
            for (i, above) in above.iter_mut().enumerate() {
                let p = bounds.min + (bounds.max - bounds.min) * DVec3::new(share(i), share(j), 0.5 * k as f64);
                let depth = view.project(p).ok().map(|image| image.depth);
                if let Some(d) = depth {
                    largest = largest.max(d);
                    for other in [before, *above].into_iter().flatten() {
                        step = step.max((d - other).abs());
                    }
                }
                (before, *above) = (depth, depth);
            }
        }
    }
    let straightened = view.straightener().map(|stage| stage.points_within(bounds)).unwrap_or_default();
    for depth in straightened.into_iter().filter_map(|p| view.project(p).ok()).map(|image| image.depth) {
        largest = largest.max(depth);
    }
    (largest + step + 1e-6 * largest).min(far).max(near * (1.0 + 1e-9))
}

/// Depth, layer and part of a hit.
pub(crate) type Found = (f64, usize, Part);

pub(crate) struct Walk<'t, 'a> {
    pub(crate) tracer: &'t Tracer<'a>,
    curve: &'t Curve<'t, 'a>,
    /// Depth up to which nothing is hit.
    start: f64,
    threshold: f64,
}

impl Walk<'_, '_> {
    /// First hit within a span.
    fn span(&self, span: Span, halvings: u32) -> Option<Found> {
        if span.depth[1] <= self.start {
            return None;
        }
        match span.chord().filter(|_| span.reach.is_finite()) {
            Some((a, b)) => {
                // A span that begins before the start cannot be skipped as a whole.
                if span.depth[0] >= self.start && self.tracer.obstacles.is_clear(a, b, span.reach) {
                    return None;
                }
                let fine = CHORD_PX * self.tracer.screen.footprint(span.depth[0]);
                if span.reach <= fine || halvings >= MAX_HALVINGS {
                    return self.search(&span, (a, b), span.reach);
                }
            }
            None => {
                let most = match span.has_point() {
                    true => MAX_HALVINGS,
                    false => match self.curve.may_enter(&span) {
                        Some(false) => return None,
                        Some(true) => MAX_HALVINGS_BESIDE_STRIP,
                        None => MAX_HALVINGS_OF_NOTHING,
                    },
                };
                if halvings >= most {
                    return None;
                }
            }
        }
        self.curve.halves(&span).into_iter().find_map(|half| self.span(half, halvings + 1))
    }

    /// First hit within a nearly straight span.
    fn search(&self, span: &Span, chord: (DVec3, DVec3), reach: f64) -> Option<Found> {
        let mut best: Option<Found> = None;
        let mut take = |found: Found| {
            if best.is_none_or(|b| (found.0, found.1) < (b.0, b.1)) {
                best = Some(found);
            }
        };
        for (layer, ground) in self.tracer.obstacles.grounds() {
            let mut follow =
                Follow { walk: self, layer: *layer, span, chord, reach, hf: ground.heightfield(), last: None };
            ground.walk(chord.0, chord.1, reach, &mut |cell, t0, t1| match follow.cell(cell, t0, t1) {
                ControlFlow::Break((depth, triangle)) => {
                    take((depth, *layer, Part::Cell(cell, triangle)));
                    false
                }
                ControlFlow::Continue(()) => true,
            });
        }
        self.tracer.obstacles.boxes().near(chord.0, chord.1, reach, &mut |shape, part| {
            if let Some(depth) = self.meet_box(shape, span, part) {
                take((depth, shape.layer, Part::Face(shape.index, DVec3::Z)));
            }
            true
        });
        self.meet_meshes(span, chord, reach, &mut take);
        best
    }

    /// Bound on the deviation of the distance from a plane from linear between two depths.
    pub(crate) fn sway(&self, span: &Span, reach: f64, w0: f64, w1: f64) -> f64 {
        let share = (w1 - w0) / (span.depth[1] - span.depth[0]);
        // The bow of a part of a curve is proportional to the square of its length.
        let bend = 4.0 * reach * share * share;
        let Some(ground) = self.tracer.split.ground else { return bend };
        match (self.curve.at(w0), self.curve.at(w1)) {
            (Some(a), Some(b)) => bend + ground.edge_bound(a, b),
            _ => bend,
        }
    }

    /// Undisplaced point at a depth.
    pub(crate) fn true_point(&self, depth: f64) -> Option<DVec3> {
        let p = self.curve.at(depth)?;
        Some(p - self.tracer.split.lift(p) * DVec3::Z)
    }

    /// Whether the sample shows the layer at a depth of its ray.
    pub(crate) fn shows(&self, layer: usize, depth: f64) -> bool {
        let Some(sections) = &self.tracer.sections else { return true };
        self.true_point(depth).is_some_and(|p| sections.shows(layer, sections.parameter(p), self.threshold))
    }

    /// Whether the sample shows a triangle, by its number in its tree, at a depth.
    pub(crate) fn shows_triangle(&self, layer: usize, tree: &MeshTree<'_>, triangle: usize, depth: f64) -> bool {
        let Some(sections) = &self.tracer.sections else { return true };
        let place = self.true_point(depth).and_then(|p| self.tracer.place_of(layer, tree, triangle, p));
        place.is_some_and(|p| sections.shows(layer, sections.parameter(p), self.threshold))
    }

    /// Whether the layer is shown everywhere.
    pub(crate) fn shows_all(&self, layer: usize) -> bool {
        self.tracer.sections.as_ref().is_none_or(|s| s.of_layer(layer) == Shown::Everything)
    }

    /// Depth at which the ray first crosses the surface of a box that its sample shows there.
    fn meet_box(&self, shape: &UprightBox, span: &Span, [t0, t1]: [f64; 2]) -> Option<f64> {
        let outside = |w: f64| self.true_point(w).map_or(f64::NAN, |p| shape.outside(p));
        let steps = if shape.is_sheared() { 64 } else { 8 };
        // Slack on both sides, so that the ends lie off the surface.
        let slack = 1e-3 * (t1 - t0) + 1e-12;
        let (t0, t1) = ((t0 - slack).max(0.0), (t1 + slack).min(1.0));
        let at = |i: usize| {
            let w = span.depth_at(t0 + (t1 - t0) * i as f64 / steps as f64);
            (w, outside(w))
        };
        let mut before = at(0);
        for i in 1..=steps {
            let now = at(i);
            if (before.1 > 0.0) != (now.1 > 0.0) && !before.1.is_nan() && !now.1.is_nan() {
                let depth = root(before, now, outside);
                if self.shows(shape.layer, depth) {
                    return Some(depth);
                }
            }
            before = now;
        }
        None
    }
}

/// Follows the height of a span over the ground from cell to cell.
struct Follow<'w, 't, 'a> {
    walk: &'w Walk<'t, 'a>,
    layer: usize,
    span: &'w Span,
    chord: (DVec3, DVec3),
    reach: f64,
    hf: &'w Heightfield,
    /// Depth at the end of the last part, and whether that lies above the ground.
    last: Option<(f64, bool)>,
}

/// The plane of a triangle: height at the cell's north-west corner, change per column and per row.
#[derive(Clone, Copy)]
struct Plane {
    corner: DVec2,
    z: f64,
    slope: DVec2,
}

impl Plane {
    /// Change of height per unit of length in plan: the sum of the absolute slopes along both axes.
    fn steepness(&self, hf: &Heightfield) -> f64 {
        let per_unit = (self.slope / hf.spacing()).abs();
        per_unit.x + per_unit.y
    }

    /// Height of a point over the plane.
    fn below(&self, hf: &Heightfield, p: DVec3) -> f64 {
        let f = hf.grid_from_scene(p.truncate()) - self.corner;
        p.z - (self.z + f.x * self.slope.x + f.y * self.slope.y)
    }
}

impl Follow<'_, '_, '_> {
    /// Depth of a hit in the cell, and the triangle that is hit.
    fn cell(&mut self, cell: [usize; 2], t0: f64, t1: f64) -> ControlFlow<(f64, CellTriangle)> {
        let [a, b] = [self.chord.0, self.chord.1].map(|p| self.hf.grid_from_scene(p.truncate()));
        for (triangle, [from, to]) in GridLine::between(a, b).by_triangle(cell, [t0, t1]) {
            if to <= from && !(from == t0 && t0 == t1) {
                continue;
            }
            match self.plane(cell, triangle) {
                Some(plane) => {
                    let met = self.triangle(&plane, from, to);
                    if let Some(depth) = met.filter(|depth| self.walk.shows(self.layer, *depth)) {
                        return ControlFlow::Break((depth, triangle));
                    }
                }
                None => self.last = None,
            }
        }
        ControlFlow::Continue(())
    }

    fn plane(&self, [col, row]: [usize; 2], triangle: CellTriangle) -> Option<Plane> {
        let nw = row * self.hf.cols() + col;
        let nodes = [nw, nw + 1, nw + self.hf.cols(), nw + self.hf.cols() + 1];
        let solid = triangle.corners().iter().all(|&k| self.hf.states()[nodes[k]] != NodeState::Void);
        let heights = nodes.map(|i| f64::from(self.hf.heights()[i]));
        let slope = triangle.slope(heights);
        solid.then(|| Plane { corner: DVec2::new(col as f64, row as f64), z: heights[0], slope })
    }

    fn triangle(&mut self, plane: &Plane, t0: f64, t1: f64) -> Option<f64> {
        let (walk, span, hf) = (self.walk, self.span, self.hf);
        // The chord decides where a curve within `reach` of it is clearly above or below.
        if walk.tracer.split.ground.is_none() {
            let over = |t: f64| plane.below(hf, self.chord.0.lerp(self.chord.1, t));
            let (a, b) = (over(t0), over(t1));
            let near = 1e-9 * self.chord.0.z.abs().max(1.0) + 1.001 * self.reach * (1.0 + plane.steepness(hf));
            if a.abs() > near
                && b.abs() > near
                && (a > 0.0) == (b > 0.0)
                && self.last.is_none_or(|(t, above)| t != t0 || above == (a > 0.0))
            {
                self.last = Some((t1, b > 0.0));
                return None;
            }
        }
        let depth = |t: f64| span.depth_at(t);
        let gap = |w: f64| walk.true_point(w).map_or(f64::NAN, |p| plane.below(hf, p));
        let (w0, w1) = (depth(t0), depth(t1));
        let (start, end) = ((w0, gap(w0)), (w1, gap(w1)));
        if start.1.is_nan() || end.1.is_nan() {
            self.last = None;
            return None;
        }
        let was = self.last.replace((t1, end.1 > 0.0));
        // Between two adjoining parts, rounding must not lose the change of sign.
        if was.is_some_and(|(t, above)| t == t0 && above != (start.1 > 0.0)) {
            return Some(w0);
        }
        if (start.1 > 0.0) != (end.1 > 0.0) {
            return Some(root(start, end, gap));
        }
        self.graze(start, end, &gap, 0)
    }

    /// A part whose ends lie on one side of the surface may touch it between them if the ray or the ground is bent.
    fn graze(&self, start: (f64, f64), end: (f64, f64), gap: &dyn Fn(f64) -> f64, halvings: u32) -> Option<f64> {
        let least = start.1.abs().min(end.1.abs());
        let sway = self.walk.sway(self.span, self.reach, start.0, end.0);
        if sway == 0.0 || least > sway || halvings > 12 {
            return None;
        }
        let middle = 0.5 * (start.0 + end.0);
        let here = (middle, gap(middle));
        if here.1.is_nan() {
            return None;
        }
        if (here.1 > 0.0) != (start.1 > 0.0) {
            return Some(root(start, here, gap));
        }
        self.graze(start, here, gap, halvings + 1).or_else(|| self.graze(here, end, gap, halvings + 1))
    }
}
