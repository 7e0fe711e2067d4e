//! Cameras in single precision.

use crate::geometry::project::{Part, Projector};
use crate::geometry::spline_from_eye::SplineFromEye;
use crate::screen::SUB;
use crate::simd::nearest;
use belvedere_core::DVec3;

/// Images farther than this from the image centre, pixels, are left to double precision: the fixed-point numbers of
/// nearer ones fit the mantissa.
const REACH_PX: f32 = 16_000.0;
/// An affine function of a position relative to the eye.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form {
    gradient: [f32; 3],
    at_eye: f32,
}

impl Form {
    pub(super) fn new(gradient: DVec3, at_eye: f64) -> Self {
        Self { gradient: gradient.to_array().map(|g| g as f32), at_eye: at_eye as f32 }
    }

    /// The value at a position; what does not depend on x and z comes first, for it is the same along a row of nodes.
    #[inline(always)]
    pub(super) fn at(self, [x, y, z]: [f32; 3]) -> f32 {
        ((self.at_eye + self.gradient[1] * y) + self.gradient[0] * x) + self.gradient[2] * z
    }
}

/// A turn with conic arcs: `v + phi(a, b) shift`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bend {
    pub(super) a: Form,
    pub(super) b: Form,
    pub(super) m: f32,
    pub(super) shift: [f32; 3],
}

/// Fixed-point pixel, nearness, and a flag that is not 0 where these cannot be used.
type Image = (i32, i32, f32, u32);

/// A camera for many positions.
pub(super) trait Camera {
    /// * `p`: relative to the eye. `curve`: of [`Camera::curve`].
    fn image(&self, p: [f32; 3], curve: [f32; 4]) -> Image;

    /// What is read from a table, before all positions of a group are computed at once.
    #[inline(always)]
    fn curve(&self, _: [f32; 3]) -> [f32; 4] {
        [0.0; 4]
    }
}

pub(super) struct Perspective<'p, 'a> {
    projector: &'p Projector<'a>,
    part: &'p Part,
}

impl Perspective<'_, '_> {
    /// View space before any turn.
    #[inline(always)]
    fn view(&self, p: [f32; 3]) -> [f32; 3] {
        self.part.view.map(|form| form.at(p))
    }

    #[inline(always)]
    fn photograph(&self, [vx, vy, vz]: [f32; 3], scale: f32, q: f32) -> Image {
        let p = self.projector;
        let (px, py) = (vx * scale, vy * scale);
        let (x, y) = (p.center[0].wrapping_add(fixed(px)), p.center[1].wrapping_add(fixed(py)));
        let seen = (vz >= p.near) & (vz <= p.far) & (px.abs() <= REACH_PX) & (py.abs() <= REACH_PX);
        (x, y, q, u32::from(!seen))
    }
}

impl Camera for Perspective<'_, '_> {
    #[inline(always)]
    fn image(&self, p: [f32; 3], _: [f32; 4]) -> Image {
        let v = self.view(p);
        let q = 1.0 / v[2];
        self.photograph(v, self.projector.scale * q, q)
    }
}

struct Parallel<'p, 'a>(Perspective<'p, 'a>);

impl Camera for Parallel<'_, '_> {
    #[inline(always)]
    fn image(&self, p: [f32; 3], _: [f32; 4]) -> Image {
        let v = self.0.view(p);
        self.0.photograph(v, self.0.projector.scale, -v[2])
    }
}

struct Bent<'p, 'a> {
    straight: Perspective<'p, 'a>,
    bend: &'p Bend,
}

impl Camera for Bent<'_, '_> {
    #[inline(always)]
    fn image(&self, p: [f32; 3], _: [f32; 4]) -> Image {
        let (a, b) = (self.bend.a.at(p), self.bend.b.at(p));
        let (phi, shift) = (phi(self.bend.m, a, b), self.bend.shift);
        let [vx, vy, vz] = self.straight.view(p);
        let v = [vx + phi * shift[0], vy + phi * shift[1], vz + phi * shift[2]];
        let q = 1.0 / v[2];
        self.straight.photograph(v, self.straight.projector.scale * q, q)
    }
}

/// A spline bend in the coordinates of the view.
#[derive(Debug)]
pub(super) struct Spline {
    table: SplineFromEye,
    /// Across the bend, along the curve in pieces, over the reference plane.
    right: Form,
    heading: Form,
    normal: Form,
    /// View space per unit across the bend and along the axes of the curve's plane.
    axes: [[f32; 3]; 3],
}

impl Spline {
    pub(super) fn new(table: SplineFromEye, view: [DVec3; 3]) -> Self {
        let in_view = |axis: DVec3| view.map(|v| v.dot(axis) as f32);
        let [u, v] = table.curve_axes;
        Self {
            right: Form::new(table.right, 0.0),
            heading: Form::new(table.heading_pieces, 0.0),
            normal: Form::new(table.normal, 0.0),
            axes: [table.right, u, v].map(in_view),
            table,
        }
    }
}

struct AlongCurve<'p, 'a> {
    straight: Perspective<'p, 'a>,
    spline: &'p Spline,
}

impl AlongCurve<'_, '_> {
    #[inline(always)]
    fn view(&self, p: [f32; 3], [u, v, nu, nv]: [f32; 4]) -> [f32; 3] {
        let Spline { right, normal, axes, .. } = self.spline;
        let (right, normal) = (right.at(p), normal.at(p));
        let (u, v) = (u + normal * nu, v + normal * nv);
        [0, 1, 2].map(|k| (axes[0][k] * right + axes[1][k] * u) + axes[2][k] * v)
    }

    #[inline(always)]
    fn table(&self, p: [f32; 3]) -> [f32; 4] {
        self.spline.table.at(self.spline.heading.at(p))
    }
}

impl Camera for AlongCurve<'_, '_> {
    #[inline(always)]
    fn image(&self, p: [f32; 3], curve: [f32; 4]) -> Image {
        let v = self.view(p, curve);
        let q = 1.0 / v[2];
        self.straight.photograph(v, self.straight.projector.scale * q, q)
    }

    #[inline(always)]
    fn curve(&self, p: [f32; 3]) -> [f32; 4] {
        self.table(p)
    }
}

struct ParallelAlongCurve<'p, 'a>(AlongCurve<'p, 'a>);

impl Camera for ParallelAlongCurve<'_, '_> {
    #[inline(always)]
    fn image(&self, p: [f32; 3], curve: [f32; 4]) -> Image {
        let v = self.0.view(p, curve);
        self.0.straight.photograph(v, self.0.straight.projector.scale, -v[2])
    }

    #[inline(always)]
    fn curve(&self, p: [f32; 3]) -> [f32; 4] {
        self.0.table(p)
    }
}

/// What to do with a camera, whichever it is.
pub(super) trait WithCamera {
    type Output;
    fn with(self, camera: &impl Camera) -> Self::Output;
}

/// Chooses the camera of a part of a projector; `None` if there is none.
#[inline(always)]
pub(super) fn choose<W: WithCamera>(projector: &Projector<'_>, part: &Part, work: W) -> Option<W::Output> {
    let straight = Perspective { projector, part };
    if let Some(spline) = &projector.spline {
        let camera = AlongCurve { straight, spline };
        return Some(if projector.ortho { work.with(&ParallelAlongCurve(camera)) } else { work.with(&camera) });
    }
    match (projector.ortho, &part.bend) {
        (false, None) => Some(work.with(&straight)),
        (false, Some(bend)) => Some(work.with(&Bent { straight, bend })),
        (true, None) => Some(work.with(&Parallel(straight))),
        // Turns need viewpoints; a parallel projection has none.
        (true, Some(_)) => None,
    }
}

/// phi of the modified model in single precision: `max(0, a - b)` outside the wedge, in it
/// `a = phi + m q`, `b = psi + m q`, `q = sqrt(phi psi)`.
///
/// With `d = m (a + b) + sqrt(m^2 (a - b)^2 + 4 a b)` it is `q = 2 a b / d`, and of phi and psi the larger one is
/// `n / d`, `n = max(a, b) d - 2 m a b`, the other `q^2` over that: no small difference is taken, and one quotient is.
#[inline(always)]
fn phi(m: f32, a: f32, b: f32) -> f32 {
    let ab = a * b;
    let difference = m * (a - b);
    let d = m * (a + b) + (difference * difference + 4.0 * ab).sqrt();
    let n = (if a > b { a } else { b }) * d - 2.0 * m * ab;
    let wedge = if a > b { [n, d] } else { [4.0 * ab * ab, n * d] };
    let outside = if a > b { a - b } else { 0.0 };
    if (a > 0.0) & (b > 0.0) { wedge[0] / wedge[1] } else { outside }
}

/// Nearest 1/256 pixel of a length below [`REACH_PX`].
#[inline(always)]
fn fixed(px: f32) -> i32 {
    nearest(px * SUB as f32)
}
