//! Images of many positions at a time: nodes of a row of the ground, and vertices of meshes.

use crate::geometry::project::cameras::{Camera, WithCamera, choose};
use crate::geometry::project::{Part, Projector};
use crate::screen::Row;
use crate::simd::Kernel;

/// Positions projected at a time.
pub(crate) const LANES: usize = 16;

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
    fn run(self) -> bool {
        let (projector, part) = (self.projector, self.part);
        choose(projector, part, self).unwrap_or(false)
    }
}

impl WithCamera for Run<'_, '_, '_> {
    type Output = bool;

    /// Computes all nodes in groups of `LANES`; the last group overlaps the one before.
    #[inline(always)]
    fn with(mut self, camera: &impl Camera) -> bool {
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
}

impl Run<'_, '_, '_> {
    /// `N` nodes from number `from` on.
    #[inline(always)]
    fn some<const N: usize>(&mut self, from: usize, camera: &impl Camera, missed: &mut [u32; LANES]) {
        let Row { x, y, q } = &mut *self.out;
        let (Some(xs), Some(hs)) = (self.x[from..].first_chunk::<N>(), self.heights[from..].first_chunk::<N>()) else {
            return;
        };
        let ends = (x[from..].first_chunk_mut::<N>(), y[from..].first_chunk_mut::<N>());
        let ((Some(px), Some(py)), Some(pq)) = (ends, q[from..].first_chunk_mut::<N>()) else { return };
        let mut zs = [0.0; N];
        for i in 0..N {
            zs[i] = self.projector.z(xs[i], self.y, hs[i]);
        }
        let misses;
        (*px, *py, *pq, misses) = images(camera, xs, &[self.y; N], &zs);
        missed.iter_mut().zip(misses).for_each(|(all, miss)| *all |= miss);
    }
}

/// Positions relative to the eye and their images, as many as fit whole groups of [`LANES`].
#[derive(Debug, Default)]
pub(crate) struct Batch {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    pub(crate) images: [Vec<i32>; 2],
    pub(crate) nearness: Vec<f32>,
    /// 0 where the image can be used.
    pub(crate) missed: Vec<u32>,
}

/// Images of the positions of a batch, see [`Projector::batch`].
pub(super) struct BatchRun<'r, 'a> {
    pub(super) projector: &'r Projector<'a>,
    pub(super) part: &'r Part,
    pub(super) batch: &'r mut Batch,
}

impl Kernel for BatchRun<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let (projector, part) = (self.projector, self.part);
        choose(projector, part, self).is_some()
    }
}

impl WithCamera for BatchRun<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with(self, camera: &impl Camera) {
        let earth = self.projector.earth;
        let Batch { x, y, z, images: [px, py], nearness, missed } = self.batch;
        let places = x.as_chunks::<LANES>().0.iter().zip(y.as_chunks::<LANES>().0).zip(z.as_chunks::<LANES>().0);
        let outs = px.as_chunks_mut::<LANES>().0.iter_mut().zip(py.as_chunks_mut::<LANES>().0);
        let outs = outs.zip(nearness.as_chunks_mut::<LANES>().0).zip(missed.as_chunks_mut::<LANES>().0);
        for (((x, y), z), (((px, py), q), missed)) in places.zip(outs) {
            let mut dropped = [0.0; LANES];
            for i in 0..LANES {
                dropped[i] = z[i] - earth * (x[i] * x[i] + y[i] * y[i]);
            }
            (*px, *py, *q, *missed) = images(camera, x, y, &dropped);
        }
    }
}

/// Images of `N` positions.
#[inline(always)]
fn images<const N: usize>(
    camera: &impl Camera,
    x: &[f32; N],
    y: &[f32; N],
    z: &[f32; N],
) -> ([i32; N], [i32; N], [f32; N], [u32; N]) {
    // Local arrays, so that the compiler knows that they do not overlap.
    let (mut px, mut py, mut q, mut missed) = ([0; N], [0; N], [0.0; N], [0; N]);
    let mut curve = [[0.0; 4]; N];
    for i in 0..N {
        curve[i] = camera.curve([x[i], y[i], z[i]]);
    }
    for i in 0..N {
        (px[i], py[i], q[i], missed[i]) = camera.image([x[i], y[i], z[i]], curve[i]);
    }
    (px, py, q, missed)
}
