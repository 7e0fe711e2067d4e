//! The exact surface point at the centre of a pixel (Newton's method).
//!
//! The rasteriser draws bent edges straight to within a tolerance in pixels. On ground seen at a grazing angle that error is small on
//! the image and large in depth. Where depths and points are asked for, the point found is moved on its surface, by Newton steps on the
//! exact map, until its image is the centre of the pixel.

use crate::geometry::block::DrawnTriangle;
use crate::geometry::pass::{BodyPasses, Pass};
use crate::screen::Screen;
use belvedere_core::{DVec2, DVec3, RigidMotion};
use belvedere_scene::{BoxShape, Heightfield, LayerKind, Scene};
use glam::DMat3;

/// Largest number of Newton steps, and the distance from the centre at which they stop, pixels.
const NEWTON_STEPS: usize = 10;
const NEAR_PX: f64 = 2e-4;
/// Largest distance from the centre at which a moved point is accepted, pixels.
const ACCEPTED_PX: f64 = 5e-3;
/// Largest distance by which a point is moved, pixels on its surface.
const REACH_PX: f64 = 3.0;

/// Height over the ground, pixels, above which a ray cannot meet ground that level of detail leaves out.
const CLEAR_PX: f64 = 0.8;
/// Largest number of steps of an eighth of a cell along a ray, halvings of the step that crosses the ground, and rounds of both.
const MOST_STEPS: u32 = 128;
const HALVINGS: usize = 10;
const ROUNDS: usize = 4;

/// A point on a surface, the distance of its image from the pixel, pixels, and its depth.
#[derive(Debug, Clone, Copy)]
struct Solution {
    off: f64,
    p: DVec3,
    depth: f64,
}

/// A ray near a point: the point and its depth, the displacement towards the eye per unit of depth, and pixels per unit of height.
struct Ray {
    near: DVec3,
    depth: f64,
    towards: DVec3,
    px_per_z: f64,
}

/// Surfaces and maps of a frame.
pub(crate) struct PixelCenters<'a> {
    scene: &'a Scene,
    passes: &'a [Pass<'a>],
    bodies: Option<&'a BodyPasses<'a>>,
    screen: &'a Screen,
}

/// The map of one pass.
struct PassCenters<'a> {
    pass: &'a Pass<'a>,
    screen: &'a Screen,
}

/// The surface on which a point is moved.
enum Surface<'a> {
    Ground(&'a Heightfield),
    /// Point and unit normal.
    Plane(DVec3, DVec3),
}

impl<'a> PixelCenters<'a> {
    /// * `bodies`: passes of the rigid bodies, if there are any.
    pub(crate) fn new(
        scene: &'a Scene,
        passes: &'a [Pass<'a>],
        bodies: Option<&'a BodyPasses<'a>>,
        screen: &'a Screen,
    ) -> Self {
        Self { scene, passes, bodies, screen }
    }

    /// Point and depth that `pixel` sees of the surface found there, near `near`; `None` if no better point is found.
    ///
    /// Ground drawn with level of detail may lack a fold of less than half a pixel that hides the point found, or have one that the exact
    /// ground lacks: the ray is therefore followed over the cells around.
    pub(crate) fn exact(&self, found: &DrawnTriangle<'_>, near: DVec3, pixel: DVec2) -> Option<(DVec3, f32)> {
        if found.block.bodies {
            // A carried body is a surface like any other at its carried position.
            let (motion, bodies) = (self.motion(found)?, self.bodies?);
            let [a, b, c] = self.corners(found)?.map(|p| motion.carry(p));
            let (surface, near) = (Surface::through(a, b, c)?, motion.carry(near));
            let settled = self.of_pass(&bodies.passes, found.block.passes, near, pixel)?.settle(&surface, near, pixel);
            return settled.map(|s| (motion.undo(s.p), s.depth as f32));
        }
        let surface = self.surface(found)?;
        let centers = self.of_pass(self.passes, found.block.passes, near, pixel)?;
        let settled = centers.settle(&surface, near, pixel);
        let first = match surface {
            Surface::Ground(hf) => centers.first_on(hf, settled, near, pixel),
            Surface::Plane(..) => None,
        };
        // A point where the record does not apply is not seen by any ray.
        let belongs = |s: &Solution| centers.pass.plain.margins(s.p).iter().all(|m| *m >= -1e-6 * s.depth);
        first.filter(belongs).or(settled.filter(belongs)).map(|s| (s.p, s.depth as f32))
    }

    /// The pass, among those that drew the surface, whose image of `p` is nearest to `pixel`.
    fn of_pass(
        &self,
        passes: &'a [Pass<'a>],
        [first, last]: [usize; 2],
        p: DVec3,
        pixel: DVec2,
    ) -> Option<PassCenters<'a>> {
        let mut all = passes.get(first..=last)?.iter().map(|pass| PassCenters { pass, screen: self.screen });
        if first == last {
            return all.next();
        }
        let holding = all.filter(|c| c.pass.plain.margins(p).iter().all(|m| *m >= 0.0));
        let off = holding.filter_map(|c| Some((c.image(p)?.0.distance_squared(pixel), c)));
        off.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| c)
    }

    fn surface(&self, found: &DrawnTriangle<'_>) -> Option<Surface<'a>> {
        if let Some(t) = self.scene.layers.get(found.block.layer as usize)?.kind.terrain() {
            return Some(Surface::Ground(&t.heightfield));
        }
        let [a, b, c] = self.corners(found)?;
        Surface::through(a, b, c)
    }

    /// Corners of a triangle of boxes or a mesh, scene coordinates.
    fn corners(&self, found: &DrawnTriangle<'_>) -> Option<[DVec3; 3]> {
        let first = found.block.origin[0];
        match &self.scene.layers.get(found.block.layer as usize)?.kind {
            LayerKind::Boxes(b) => {
                let corners = b.boxes.get(first + (found.parent / 12) as usize)?.corners();
                Some(BoxShape::TRIANGLES[(found.parent % 12) as usize].map(|k| corners[k]))
            }
            kind => Some(kind.triangles()?.mesh.corners(first + found.parent as usize)),
        }
    }

    /// Motion of the body that a triangle belongs to.
    fn motion(&self, found: &DrawnTriangle<'_>) -> Option<&'a RigidMotion> {
        let layer = found.block.layer as usize;
        let per_origin = if self.scene.layers.get(layer)?.kind.boxes().is_some() { 12 } else { 1 };
        let triangle = per_origin * found.block.origin[0] + found.parent as usize;
        self.bodies?.carried.layer(layer)?.body(triangle).map(|(_, motion)| motion)
    }
}

impl PassCenters<'_> {
    /// The first point on the ground near the point that Newton's method found, or near `near`; `None` if there is no accepted one.
    fn first_on(&self, hf: &Heightfield, settled: Option<Solution>, near: DVec3, pixel: DVec2) -> Option<Solution> {
        let mut at = settled.unwrap_or(Solution { off: f64::INFINITY, p: near, depth: 0.0 });
        for _ in 0..ROUNDS {
            let p = self.first_near(hf, &at, pixel)?;
            let (image, depth) = self.image(p)?;
            at = Solution { off: image.distance(pixel), p, depth };
            if at.off <= NEAR_PX || at.off > REACH_PX {
                break;
            }
        }
        (at.off <= ACCEPTED_PX).then_some(at)
    }

    /// Newton steps on the surface from `near` to the point whose image is `pixel`.
    fn settle(&self, surface: &Surface<'_>, near: DVec3, pixel: DVec2) -> Option<Solution> {
        // The start may lie off the ground, where level of detail was used.
        let mut p = surface.at(near)?;
        let mut image = self.image(p)?;
        let mut best = (image.0.distance(pixel), p, image.1);
        let first = best.0;
        for _ in 0..NEWTON_STEPS {
            if best.0 <= NEAR_PX {
                break;
            }
            let along = surface.tangents(p);
            // Step of the differences, a fiftieth of a pixel: far above rounding, far below the scale of bends.
            let h = 0.02 * self.screen.footprint(image.1);
            let [ex, ey] =
                [self.image(p + h * along[0])?.0, self.image(p + h * along[1])?.0].map(|q| (q - image.0) / h);
            let (miss, det) = (pixel - image.0, ex.perp_dot(ey));
            let step = DVec2::new(miss.perp_dot(ey), ex.perp_dot(miss)) / det;
            if !step.is_finite() {
                break;
            }
            p = surface.at(p + step.x * along[0] + step.y * along[1])?;
            image = self.image(p)?;
            let off = image.0.distance(pixel);
            if off < best.0 {
                best = (off, p, image.1);
            } else if off > REACH_PX {
                break;
            }
        }
        let (off, p, depth) = best;
        (off <= ACCEPTED_PX || off < 0.1 * first).then_some(Solution { off, p, depth })
    }

    /// First point near a start where the ray of `pixel` enters the ground, followed while it stays within [`CLEAR_PX`] of the ground;
    /// `None` if that is the point found by Newton's method.
    ///
    /// The ray is taken as straight here. Bisection converges at edges of the ground where Newton's method oscillates.
    fn first_near(&self, hf: &Heightfield, start: &Solution, pixel: DVec2) -> Option<DVec3> {
        let ray = self.ray(start.p, pixel)?;
        // An eighth of a cell on the map.
        let depth_step = 0.125 * hf.spacing().min_element() / ray.towards.truncate().length();
        let step = ray.towards * depth_step;
        let clear = CLEAR_PX / ray.px_per_z;
        if !step.is_finite() || !clear.is_finite() {
            return None;
        }
        let gap = |k: f64| {
            if ray.depth - k * depth_step < self.screen.near {
                return None;
            }
            let q = ray.near + k * step;
            hf.surface_at(q.truncate()).map(|z| q.z - z)
        };
        // Towards the eye until the ray is well above the ground; the last point below it counts.
        let settled = start.off <= NEAR_PX;
        let mut under = if settled || gap(0.0)? >= 0.0 { None } else { Some(0.0) };
        // A first small step, for an edge that hides the point found and that longer steps would miss.
        for k in std::iter::once(0.02).chain((1..=MOST_STEPS).map(f64::from)) {
            match gap(k) {
                Some(g) if g < -1e-6 * clear => under = Some(k),
                Some(g) if g <= clear => {}
                _ => break,
            }
        }
        if under.is_none() && !settled {
            // The ray passes over the point found: continue until it goes under the ground.
            under = (1..=MOST_STEPS).map(|k| -f64::from(k)).find(|&k| gap(k).is_none_or(|g| g < 0.0));
        }
        let mut under = under?;
        let mut over = (under + 1.0).floor();
        let mut ends = [gap(over)?, gap(under)?];
        if !(ends[0] >= 0.0 && ends[1] <= 0.0) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (over + under);
            let g = gap(middle)?;
            if g < 0.0 { (under, ends[1]) = (middle, g) } else { (over, ends[0]) = (middle, g) }
        }
        let share = ends[0] / (ends[0] - ends[1]);
        let q = ray.near + (over + share * (under - over)) * step;
        Some(q.truncate().extend(hf.surface_at(q.truncate())?))
    }

    /// The ray of a pixel near a point, straight.
    fn ray(&self, p: DVec3, pixel: DVec2) -> Option<Ray> {
        let here = self.image(p)?;
        let h = 0.02 * self.screen.footprint(here.1);
        let by = |axis: DVec3| {
            let q = self.image(p + h * axis)?;
            Some((q.0 - here.0).extend(q.1 - here.1) / h)
        };
        let change = DMat3::from_cols(by(DVec3::X)?, by(DVec3::Y)?, by(DVec3::Z)?);
        let back = change.inverse();
        let near = p + back * (pixel - here.0).extend(0.0);
        Some(Ray { near, depth: here.1, towards: back * DVec3::NEG_Z, px_per_z: change.z_axis.truncate().length() })
    }

    /// Pixel and depth of the image of a point.
    fn image(&self, p: DVec3) -> Option<(DVec2, f64)> {
        let v = self.screen.view_from(self.pass.plain.displace(p)?);
        (v.z >= self.screen.near).then(|| (self.screen.pixel(v), v.z))
    }
}

impl Surface<'_> {
    fn through(a: DVec3, b: DVec3, c: DVec3) -> Option<Self> {
        Some(Self::Plane(a, (b - a).cross(c - a).try_normalize()?))
    }

    /// Two tangents of the surface.
    fn tangents(&self, p: DVec3) -> [DVec3; 2] {
        match self {
            Self::Plane(_, normal) => {
                let (a, b) = normal.any_orthonormal_pair();
                [a, b]
            }
            Self::Ground(hf) => {
                let g = hf.grid_from_scene(p.truncate());
                let last = DVec2::new((hf.cols() - 2) as f64, (hf.rows() - 2) as f64);
                let cell = g.floor().clamp(DVec2::ZERO, last);
                let [c, r] = [cell.x as usize, cell.y as usize];
                let f = g - cell;
                let h = |dc: usize, dr: usize| f64::from(hf.heights()[(r + dr) * hf.cols() + c + dc]);
                let (east, south) = if f.x > f.y {
                    (h(1, 0) - h(0, 0), h(1, 1) - h(1, 0))
                } else {
                    (h(1, 1) - h(0, 1), h(0, 1) - h(0, 0))
                };
                let s = hf.spacing();
                [DVec3::new(1.0, 0.0, east / s.x), DVec3::new(0.0, 1.0, -south / s.y)]
            }
        }
    }

    /// The point of the surface near a point off it.
    fn at(&self, p: DVec3) -> Option<DVec3> {
        match self {
            Self::Plane(point, normal) => Some(p - normal.dot(p - *point) * *normal),
            Self::Ground(hf) => Some(p.truncate().extend(hf.surface_at(p.truncate())?)),
        }
    }
}
