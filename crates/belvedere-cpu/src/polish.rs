//! The very place that the centre of a pixel sees.
//!
//! The rasteriser draws bent edges straight to within a tolerance in pixels. On ground seen under a small angle that is little on the
//! image and much in depth. Where depths and places are asked for, the place found is moved on its surface, by Newton steps on the
//! true map, until its image is the centre of the pixel.

use crate::blocks::{BOX_TRIANGLES, Found};
use crate::lens::Lens;
use crate::pass::Pass;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, LayerKind, Scene};

/// Steps at most, and the distance from the centre that is near enough, pixels.
const STEPS: usize = 10;
const NEAR_PX: f64 = 2e-4;
/// A place whose image stays farther from the centre than this is no better than the one before, pixels.
const ACCEPTED_PX: f64 = 5e-3;
/// Farther than this no place is moved, pixels on its surface.
const REACH_PX: f64 = 3.0;

/// Surfaces and maps of a frame.
pub(crate) struct Polish<'a> {
    scene: &'a Scene,
    passes: &'a [Pass<'a>],
    lens: &'a Lens,
}

/// A surface to move on.
enum Surface<'a> {
    Ground(&'a Heightfield),
    /// Point and unit normal.
    Plane(DVec3, DVec3),
}

impl<'a> Polish<'a> {
    pub(crate) fn new(scene: &'a Scene, passes: &'a [Pass<'a>], lens: &'a Lens) -> Self {
        Self { scene, passes, lens }
    }

    /// Place and depth that `pixel` sees of the surface found there, near `place`; `None` if it cannot be told better.
    pub(crate) fn place(&self, found: &Found<'_>, place: DVec3, pixel: DVec2) -> Option<(DVec3, f32)> {
        let surface = self.surface(found)?;
        let (mut p, mut image) = (place, self.image(place)?);
        let mut best = (image.0.distance(pixel), p, image.1);
        let first = best.0;
        for _ in 0..STEPS {
            if best.0 <= NEAR_PX {
                break;
            }
            let along = surface.tangents(p);
            // Twenty pixels' thousandths: far above rounding, far below what bends.
            let h = 0.02 * self.lens.footprint(image.1);
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
        (best.0 <= ACCEPTED_PX || best.0 < 0.1 * first).then_some((best.1, best.2 as f32))
    }

    fn surface(&self, found: &Found<'_>) -> Option<Surface<'a>> {
        let first = found.block.origin[0];
        let corners = match &self.scene.layers.get(found.block.layer as usize)?.kind {
            LayerKind::Terrain(t) => return Some(Surface::Ground(&t.heightfield)),
            LayerKind::Boxes(b) => {
                let corners = b.boxes.get(first + (found.parent / 12) as usize)?.corners();
                BOX_TRIANGLES[(found.parent % 12) as usize].map(|k| corners[k])
            }
            LayerKind::Mesh(m) => m.mesh.corners(first + found.parent as usize),
            _ => return None,
        };
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()?;
        Some(Surface::Plane(corners[0], normal))
    }

    /// Pixel and depth of a place.
    fn image(&self, p: DVec3) -> Option<(DVec2, f64)> {
        let holds = |pass: &&Pass<'_>| pass.margins(p).iter().all(|m| *m >= 0.0);
        let pass = if self.passes.len() == 1 { self.passes.first() } else { self.passes.iter().find(holds) };
        let v = self.lens.view_from(pass?.displace(p)?);
        (v.z > 0.0).then(|| (self.lens.pixel(v), v.z))
    }
}

impl Surface<'_> {
    /// Two directions along the surface.
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

    /// The surface near a point beside it.
    fn at(&self, p: DVec3) -> Option<DVec3> {
        match self {
            Self::Plane(point, normal) => Some(p - normal.dot(p - *point) * *normal),
            Self::Ground(hf) => Some(p.truncate().extend(hf.surface_at(p.truncate())?)),
        }
    }
}
