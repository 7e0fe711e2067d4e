//! Cameras in single precision, for many nodes of a row at a time.

use crate::geometry::project::{Part, Projector};
use crate::screen::{Row, SUB};
use crate::simd::{Kernel, nearest};
use belvedere_core::DVec3;

/// Images farther than this from the image centre, pixels, are left to double precision: the fixed-point numbers of
/// nearer ones fit the mantissa.
const REACH_PX: f32 = 16_000.0;
/// Nodes projected at a time.
const LANES: usize = 16;

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

    /// Part of the form that is constant along a row of nodes.
    #[inline(always)]
    pub(super) fn row(self, y: f32) -> f32 {
        self.at_eye + self.gradient[1] * y
    }

    #[inline(always)]
    pub(super) fn at(self, row: f32, x: f32, z: f32) -> f32 {
        (row + self.gradient[0] * x) + self.gradient[2] * z
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

/// A camera for the nodes of a row.
trait Camera {
    /// * `x`, `z`: relative to the eye.
    fn image(&self, x: f32, z: f32) -> Image;
}

struct Perspective<'p, 'a> {
    projector: &'p Projector<'a>,
    part: &'p Part,
    rows: [f32; 3],
}

impl Perspective<'_, '_> {
    /// View space before any turn.
    #[inline(always)]
    fn view(&self, x: f32, z: f32) -> [f32; 3] {
        let [right, down, forward] = &self.part.view;
        [right.at(self.rows[0], x, z), down.at(self.rows[1], x, z), forward.at(self.rows[2], x, z)]
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
    fn image(&self, x: f32, z: f32) -> Image {
        let v = self.view(x, z);
        let q = 1.0 / v[2];
        self.photograph(v, self.projector.scale * q, q)
    }
}

struct Parallel<'p, 'a>(Perspective<'p, 'a>);

impl Camera for Parallel<'_, '_> {
    #[inline(always)]
    fn image(&self, x: f32, z: f32) -> Image {
        let v = self.0.view(x, z);
        self.0.photograph(v, self.0.projector.scale, -v[2])
    }
}

struct Bent<'p, 'a> {
    straight: Perspective<'p, 'a>,
    bend: &'p Bend,
    rows: [f32; 2],
}

impl Camera for Bent<'_, '_> {
    #[inline(always)]
    fn image(&self, x: f32, z: f32) -> Image {
        let (a, b) = (self.bend.a.at(self.rows[0], x, z), self.bend.b.at(self.rows[1], x, z));
        let (phi, shift) = (phi(self.bend.m, a, b), self.bend.shift);
        let [vx, vy, vz] = self.straight.view(x, z);
        let v = [vx + phi * shift[0], vy + phi * shift[1], vz + phi * shift[2]];
        let q = 1.0 / v[2];
        self.straight.photograph(v, self.straight.projector.scale * q, q)
    }
}

/// Images of nodes of a row, see [`Projector::row`].
pub(super) struct Run<'r, 'a, 'o> {
    pub(super) projector: &'r Projector<'a>,
    pub(super) part: &'r Part,
    pub(super) x: &'r [f32],
    pub(super) y: f32,
    pub(super) heights: &'r [f32],
    pub(super) out: &'r mut Row<'o>,
}

impl Kernel for Run<'_, '_, '_> {
    type Output = bool;

    #[inline(always)]
    fn run(mut self) -> bool {
        let (projector, part) = (self.projector, self.part);
        let straight = Perspective { projector, part, rows: part.view.map(|f| f.row(self.y)) };
        match (projector.ortho, &part.bend) {
            (false, None) => self.all(&straight),
            (false, Some(bend)) => {
                let rows = [bend.a.row(self.y), bend.b.row(self.y)];
                self.all(&Bent { straight, bend, rows })
            }
            (true, None) => self.all(&Parallel(straight)),
            // Turns need viewpoints; a parallel projection has none.
            (true, Some(_)) => false,
        }
    }
}

impl Run<'_, '_, '_> {
    /// Computes all nodes in groups of `LANES`; the last group overlaps the one before.
    #[inline(always)]
    fn all(&mut self, camera: &impl Camera) -> bool {
        let n = self.x.len();
        let mut missed = [0; LANES];
        let mut i = 0;
        while i < n {
            match n - i {
                LANES.. => self.some::<LANES>(i, camera, &mut missed),
                left if n >= LANES && left > LANES / 4 => self.some::<LANES>(n - LANES, camera, &mut missed),
                _ if n >= LANES => self.some::<{ LANES / 4 }>(n - LANES / 4, camera, &mut missed),
                _ => (i..n).for_each(|i| self.some::<1>(i, camera, &mut missed)),
            }
            i += LANES;
        }
        missed.iter().fold(0, |a, b| a | b) == 0
    }

    /// `N` nodes from number `from` on.
    #[inline(always)]
    fn some<const N: usize>(&mut self, from: usize, camera: &impl Camera, missed: &mut [u32; LANES]) {
        let Row { x, y, q } = &mut *self.out;
        let (Some(xs), Some(hs)) = (self.x[from..].first_chunk::<N>(), self.heights[from..].first_chunk::<N>()) else {
            return;
        };
        let ends = (x[from..].first_chunk_mut::<N>(), y[from..].first_chunk_mut::<N>());
        let ((Some(px), Some(py)), Some(pq)) = (ends, q[from..].first_chunk_mut::<N>()) else { return };
        // Local arrays, so that the compiler knows that they do not overlap.
        let (mut ix, mut iy, mut iq, mut misses) = ([0; N], [0; N], [0.0; N], [0; N]);
        for i in 0..N {
            let z = self.projector.z(xs[i], self.y, hs[i]);
            (ix[i], iy[i], iq[i], misses[i]) = camera.image(xs[i], z);
        }
        (*px, *py, *pq) = (ix, iy, iq);
        missed.iter_mut().zip(misses).for_each(|(all, miss)| *all |= miss);
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
