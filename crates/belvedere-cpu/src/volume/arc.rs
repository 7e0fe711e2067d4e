//! Bent pieces of rays, and the cubics between points of them.

use super::cubic::Cubic;
use belvedere_core::DVec3;
use belvedere_core::conic::ConicArc;
use belvedere_core::map::curved_rays::{Bend, C2Arc};
use belvedere_scene::Volume;

/// Largest distance of a cubic from the ray, voxels.
pub(super) const NEAR: f64 = 1e-3;
/// Relative change of speed above which a part is divided, so that lengths are accurate to about 1e-5.
const UNEVEN: f64 = 0.1;

/// A point of a bent piece.
#[derive(Clone, Copy)]
pub(super) struct Knot {
    pub(super) parameter: f64,
    /// Depth, and its derivative by the parameter.
    depth: [f64; 2],
    /// Lattice coordinates, and their derivative by the parameter.
    place: DVec3,
    slope: DVec3,
    /// Length of the derivative in the scene.
    speed: f64,
}

/// A bent piece of a ray over its parameter.
pub(super) trait Arc {
    fn knot(&self, volume: &Volume, u: f64) -> Knot;
    /// A triangle that contains the whole piece, lattice coordinates.
    fn corners(&self, volume: &Volume) -> [DVec3; 3];
}

/// A conic is carried into lattice coordinates once.
pub(super) struct LatticeConic(pub(super) Bend<ConicArc>);

impl LatticeConic {
    pub(super) fn new(volume: &Volume, arc: &Bend<ConicArc>) -> Self {
        let ConicArc { t, s, q, weight } = arc.curve;
        let [t, s, q] = [t, s, q].map(|p| volume.lattice_from_scene(p));
        Self(Bend { curve: ConicArc { t, s, q, weight }, depths: arc.depths })
    }
}

impl Arc for LatticeConic {
    #[inline]
    fn knot(&self, volume: &Volume, u: f64) -> Knot {
        let ConicArc { t, s, q, weight } = self.0.curve;
        let p = 1.0 - u;
        let (first, middle, last) = (p * p, 2.0 * weight * u * p, u * u);
        let scale = 1.0 / (first + middle + last);
        let (ts, qs) = (t - s, q - s);
        let [dt, ds, dq] = self.0.depths;
        let slope = (2.0 * scale * scale) * (qs * (weight * last + u * p) - ts * (weight * first + u * p));
        Knot {
            parameter: u,
            depth: [
                (first * dt + middle * ds + last * dq) * scale,
                (2.0 * scale * scale) * ((dq - ds) * (weight * last + u * p) - (dt - ds) * (weight * first + u * p)),
            ],
            place: s + (first * ts + last * qs) * scale,
            slope,
            speed: (*volume.axes() * slope).length(),
        }
    }

    fn corners(&self, _: &Volume) -> [DVec3; 3] {
        [self.0.curve.t, self.0.curve.s, self.0.curve.q]
    }
}

impl Arc for Bend<C2Arc> {
    fn knot(&self, volume: &Volume, u: f64) -> Knot {
        let slope = self.curve.derivative(u);
        // By differences.
        let [before, after] = [u - 1e-5, u + 1e-5].map(|u| u.clamp(0.0, 1.0));
        Knot {
            parameter: u,
            depth: [self.depth(u), (self.depth(after) - self.depth(before)) / (after - before)],
            place: volume.lattice_from_scene(self.curve.point(u)),
            slope: *volume.lattice_axes() * slope,
            speed: slope.length(),
        }
    }

    fn corners(&self, volume: &Volume) -> [DVec3; 3] {
        [self.curve.t, self.curve.s, self.curve.q].map(|p| volume.lattice_from_scene(p))
    }
}

/// A cubic between two points of a bent piece.
pub(super) struct Joined {
    pub(super) curve: Cubic,
    /// Length, scene units.
    pub(super) length: f64,
    pub(super) depth: Cubic<f64>,
    /// Squared distance of the piece's middle from the cubic, voxels.
    pub(super) off_squared: f64,
    /// Whether the speed changes too much for the length to be accurate.
    pub(super) is_uneven: bool,
}

impl Joined {
    /// * `middle`: the point halfway between the parameters of `a` and `b`.
    pub(super) fn new(a: &Knot, middle: &Knot, b: &Knot) -> Self {
        // Simpson's rule.
        let length = (b.parameter - a.parameter) * (a.speed + 4.0 * middle.speed + b.speed) / 6.0;
        let per_length = [a, b].map(|k| length / k.speed);
        let slopes = [a.slope * per_length[0], b.slope * per_length[1]];
        let curve = Cubic::hermite([a, b].map(|k| k.place), slopes);
        let rises = [a.depth[1] * per_length[0], b.depth[1] * per_length[1]];
        let depth = Cubic::hermite([a, b].map(|k| k.depth[0]), rises);
        // The cubic is parametrised by length: its middle is where half of the length is passed, to first order in the change of speed.
        let (off, along) = (curve.at(0.5) - middle.place, middle.slope);
        let across = off - along * (off.dot(along) / along.length_squared());
        let is_uneven = (a.speed - b.speed).abs() > UNEVEN * middle.speed;
        Self { curve, length, depth, off_squared: across.length_squared(), is_uneven }
    }
}
