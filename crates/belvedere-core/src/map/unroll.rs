//! The circle around the eye, unrolled: panoramas on a cylinder or a sphere up to the whole circle.

use super::{Miss, SpaceMap};
use crate::Aabb;
use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// Least distance in plan from the eye, as a share of the distance, at which a point has an azimuth.
const NEAREST: f64 = 1e-12;
/// No point farther away from the eye has an image, scene units.
const MOST: f64 = 1e150;
/// Largest second derivative of `r atan(z / r)` by `z`, times `r`: at a slope of 1 / sqrt(3).
const SPHERE_BEND: f64 = 0.650;
/// Distance of a point from the seam on either side of it, shares of its distance from the eye.
const BESIDE: f64 = 1e-9;

/// What the picture is unrolled from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Roll {
    /// A cylinder about the vertical through the eye: rows are slopes, what is upright is straight.
    #[default]
    Cylinder,
    /// A sphere: rows are angles over the horizon, evenly spaced (equirectangular).
    Sphere,
}

/// The surroundings of the eye, unrolled about its vertical.
///
/// A point has an azimuth `psi` from the heading, a distance `r` from the eye in plan and a height `z` over it. It goes to `r psi` to the right,
/// `r` ahead and `z - slope r` up; on a sphere to `r (atan(z / r) - slope)` up. A level pinhole at the eye then shows the column `f psi` and
/// the row `f (z / r - slope)`, and the depth of a point is `r`. The determinant of the Jacobian is 1, on a sphere the squared cosine of the
/// angle over the horizon. Points on the vertical through the eye, and beyond half the span, have no image.
///
/// Source: central cylindrical and equirectangular projection; as a displacement: ours.
///
/// ```
/// use belvedere_core::map::unroll::{Roll, Unroll};
/// use belvedere_core::{DVec2, DVec3, SpaceMap};
/// let around = Unroll::new(DVec3::ZERO, DVec2::Y, std::f64::consts::TAU, 0.0, Roll::Cylinder).unwrap();
/// let east = around.apply(DVec3::new(100.0, 0.0, 7.0)).unwrap();
/// assert!(east.distance(DVec3::new(50.0 * std::f64::consts::PI, 100.0, 7.0)) < 1e-9); // a quarter turn to the right
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unroll {
    eye: DVec3,
    forward: DVec2,
    right: DVec2,
    /// Half of the span, radians, at most pi.
    half: f64,
    slope: f64,
    roll: Roll,
}

/// The half plane behind the eye at which the picture is cut open, upright, over a line from a point into a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    eye: DVec2,
    forward: DVec2,
    right: DVec2,
}

/// Place of a point around the eye.
#[derive(Debug, Clone, Copy)]
struct Around {
    psi: f64,
    r: f64,
    z: f64,
}

impl Unroll {
    /// * `eye`: scene coordinates. `heading`: direction in plan of the middle of the picture, not 0.
    /// * `span`: angle that the picture shows, radians, in (0, 2 pi]. `slope`: height over distance that the middle row shows.
    ///
    /// `None` if one of them is not.
    pub fn new(eye: DVec3, heading: DVec2, span: f64, slope: f64, roll: Roll) -> Option<Self> {
        let forward = heading.try_normalize()?;
        let half = 0.5 * span;
        let valid = eye.is_finite() && slope.is_finite() && half > 0.0 && half <= PI * (1.0 + 1e-12);
        valid.then_some(Self { eye, forward, right: -forward.perp(), half: half.min(PI), slope, roll })
    }

    /// Eye about whose vertical the picture is unrolled, scene coordinates.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Direction in plan of the middle of the picture, of length 1.
    pub fn heading(&self) -> DVec2 {
        self.forward
    }

    /// Angle that is shown, radians.
    pub fn span(&self) -> f64 {
        2.0 * self.half
    }

    /// Whether rows are angles, so that heights change their length.
    pub fn is_sphere(&self) -> bool {
        self.roll == Roll::Sphere
    }

    /// Where the picture is cut open.
    pub fn seam(&self) -> Seam {
        Seam { eye: self.eye.truncate(), forward: self.forward, right: self.right }
    }

    fn around(&self, p: DVec3) -> Option<Around> {
        let v = p - self.eye;
        let (s, f) = (v.truncate().dot(self.right), v.truncate().dot(self.forward));
        let (r, psi) = (s.hypot(f), s.atan2(f));
        let is_inside = r > NEAREST * v.z.abs() && r > f64::MIN_POSITIVE && psi.abs() <= self.half;
        (is_inside && r.max(v.z.abs()) < MOST).then_some(Around { psi, r, z: v.z })
    }

    fn risen(&self, r: f64, z: f64) -> f64 {
        match self.roll {
            Roll::Cylinder => z,
            Roll::Sphere => r * (z / r).atan(),
        }
    }

    fn placed(&self, right: f64, ahead: f64, up: f64) -> DVec3 {
        self.eye + (right * self.right + ahead * self.forward).extend(up)
    }

    /// See [`crate::map::StageMap::edge_bound`]: an eighth of a bound on the second derivative along the edge.
    ///
    /// Along a straight line at distance `h` from the eye in plan `r'' = h^2 / r^3`, and `(r psi)'' = psi r''`. Source: ours.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        let (Some(a), Some(b)) = (self.around(p0), self.around(p1)) else { return f64::INFINITY };
        if self.seam().parts(p0, p1) {
            return f64::INFINITY;
        }
        let (v, step) = ((p0 - self.eye).truncate(), (p1 - p0).truncate());
        let length2 = step.length_squared();
        if length2 == 0.0 && self.roll == Roll::Cylinder {
            return 0.0;
        }
        let nearest = if length2 > 0.0 { (-v.dot(step) / length2).clamp(0.0, 1.0) } else { 0.0 };
        let least = (v + nearest * step).length();
        // Twice the area of the triangle with the eye, squared: h^2 times the squared length.
        let area2 = v.perp_dot(step).powi(2);
        let bend = area2 / least.powi(3);
        let psi = a.psi.abs().max(b.psi.abs());
        let steep = (a.z.abs().max(b.z.abs()) / least).min(1e150);
        let (tilt, more) = match self.roll {
            Roll::Cylinder => (self.slope.abs(), 0.0),
            Roll::Sphere => {
                // The second derivative by z is 2 t / (1 + t^2)^2 / r at a slope t.
                let [low, high] = [a.z.min(b.z), a.z.max(b.z)];
                let flattest = if low > 0.0 { low } else { (-high).max(0.0) } / a.r.max(b.r);
                let bend = (2.0 * steep / (1.0 + flattest * flattest).powi(2)).min(SPHERE_BEND);
                let rise = (p1.z - p0.z).abs() + length2.sqrt() * steep;
                (steep.atan() + self.slope.abs(), bend * rise * rise / least)
            }
        };
        0.125 * (bend * (1.0 + psi * psi + tilt * tilt).sqrt() + more)
    }

    /// The straight ray in the world, point and step per unit of depth, of a ray behind the stage that begins at the eye and goes one unit
    /// ahead per unit of depth. `None` if it has no points; the error if it is no such ray.
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if it begins elsewhere or goes on at another pace.
    pub fn straight_ray(&self, from: DVec3, per_depth: DVec3) -> Result<Option<[DVec3; 2]>, Miss> {
        let plan = per_depth.truncate();
        let is_own =
            from.distance(self.eye) <= 1e-9 * (1.0 + self.eye.length()) && (plan.dot(self.forward) - 1.0).abs() < 1e-9;
        if !is_own {
            return Err(Miss::OutsideDomain);
        }
        let (psi, up) = (plan.dot(self.right), per_depth.z + self.slope);
        let steep = match self.roll {
            Roll::Cylinder => up,
            Roll::Sphere if up.abs() < FRAC_PI_2 => up.tan(),
            Roll::Sphere => return Ok(None),
        };
        let step = (psi.sin() * self.right + psi.cos() * self.forward).extend(steep);
        Ok((psi.abs() <= self.half).then_some([self.eye, step]))
    }

    /// See [`crate::map::StageMap::displaced_bounds`]; `None` for a box over the eye or the seam.
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        let [psi, r] = self.ranges(bounds)?;
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (psi, r, z) in corners(psi, r, [bounds.min.z - self.eye.z, bounds.max.z - self.eye.z]) {
            let q = DVec3::new(psi * r, r, self.risen(r, z));
            (min, max) = (min.min(q), max.max(q));
        }
        // What rises with the distance may fall by the slope.
        let falls = r.map(|r| self.slope * r);
        min.z -= falls[0].max(falls[1]);
        max.z -= falls[0].min(falls[1]);
        let room = 1e-12 * min.abs().max(max.abs());
        let box_ahead = Aabb { min: min - room, max: max + room };
        Some(Aabb::of(box_ahead.corners().map(|q| self.placed(q.x, q.y, q.z))))
    }

    /// Whether no point of a box has an image; `false` also where that is not known.
    pub fn misses(&self, bounds: &Aabb) -> bool {
        self.ranges(bounds).is_some_and(|[psi, _]| psi[0] > self.half || psi[1] < -self.half)
    }

    /// Least and greatest azimuth and distance of a box that is not over the eye or the seam.
    fn ranges(&self, bounds: &Aabb) -> Option<[[f64; 2]; 2]> {
        let (min, max) = (bounds.min.truncate(), bounds.max.truncate());
        if bounds.is_empty() || !(min.is_finite() && max.is_finite()) {
            return None;
        }
        let eye = self.eye.truncate();
        let least = eye.clamp(min, max).distance(eye);
        let plan = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        let cut = (0..4).any(|i| self.seam().parts(plan[i].extend(0.0), plan[(i + 1) % 4].extend(0.0)));
        if !(least > 0.0) || cut {
            return None;
        }
        let place = |p: &DVec2| {
            let v = *p - eye;
            (v.dot(self.right).atan2(v.dot(self.forward)), v.length())
        };
        let places = plan.each_ref().map(place);
        let psi = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], p| [lo.min(p.0), hi.max(p.0)]);
        // Corners on the seam may be taken for those on its other side.
        (psi[1] - psi[0] < PI).then(|| [psi, [least, places.iter().map(|p| p.1).fold(0.0, f64::max)]])
    }
}

/// Combinations of ends of three ranges.
fn corners(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> impl Iterator<Item = (f64, f64, f64)> {
    (0..8).map(move |i| (a[i & 1], b[i >> 1 & 1], c[i >> 2]))
}

impl Seam {
    /// Signed distance to the right of the plane of the seam, and distance ahead of the eye.
    fn place(&self, p: DVec3) -> [f64; 2] {
        let v = p.truncate() - self.eye;
        [v.dot(self.right), v.dot(self.forward)]
    }

    /// Whether it lies between the ends of an edge, whose images are then apart.
    pub fn parts(&self, p0: DVec3, p1: DVec3) -> bool {
        let ([s0, f0], [s1, f1]) = (self.place(p0), self.place(p1));
        // A point on the plane itself is one to its right.
        (s0 < 0.0) != (s1 < 0.0) && f0 * s1.abs() + f1 * s0.abs() < 0.0
    }

    /// Share of an edge at which it meets the plane of the seam, and the point there on the left and on the right side; `None` if its ends
    /// are on one side. The same for both directions of the edge.
    pub fn crossing(&self, p0: DVec3, p1: DVec3) -> Option<(f64, [DVec3; 2])> {
        let [s0, s1] = [p0, p1].map(|p| self.place(p)[0]);
        if (s0 < 0.0) == (s1 < 0.0) {
            return None;
        }
        let (left, right, from) = if s0 < 0.0 { (p0, p1, -s0) } else { (p1, p0, -s1) };
        let share = from / (s1 - s0).abs();
        let at = left.lerp(right, share);
        let beside = (BESIDE * (at.truncate() - self.eye).length() * self.right).extend(0.0);
        Some((if s0 < 0.0 { share } else { 1.0 - share }, [at - beside, at + beside]))
    }

    /// Whether a point lies to the left of the plane.
    pub fn is_left(&self, p: DVec3) -> bool {
        self.place(p)[0] < 0.0
    }
}

impl SpaceMap for Unroll {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let at = self.around(p).ok_or(Miss::OutsideDomain)?;
        Ok(self.placed(at.r * at.psi, at.r, self.risen(at.r, at.z) - self.slope * at.r))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let w = p_displaced - self.eye;
        let (x, r) = (w.truncate().dot(self.right), w.truncate().dot(self.forward));
        let (psi, up) = (x / r, w.z + self.slope * r);
        if !(r > NEAREST * up.abs() && psi.abs() <= self.half && r.max(up.abs()) < MOST) {
            return Err(Miss::OutsideDomain);
        }
        let z = match self.roll {
            Roll::Cylinder => up,
            Roll::Sphere if (up / r).abs() < FRAC_PI_2 => r * (up / r).tan(),
            Roll::Sphere => return Err(Miss::OutsideDomain),
        };
        let (sin, cos) = psi.sin_cos();
        Ok(self.placed(r * sin, r * cos, z))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let Around { psi, r, z } = self.around(p).ok_or(Miss::OutsideDomain)?;
        let (sin, cos) = psi.sin_cos();
        let [by_r, by_z] = match self.roll {
            Roll::Cylinder => [0.0, 1.0],
            Roll::Sphere => {
                let theta = (z / r).atan();
                [theta - theta.sin() * theta.cos(), theta.cos().powi(2)]
            }
        };
        // Derivatives by a step to the right and ahead of the eye.
        let column = |step: DVec2| {
            let (s, f) = (step.dot(self.right), step.dot(self.forward));
            let (out, across) = (s * sin + f * cos, s * cos - f * sin);
            let plan = (psi * out + across) * self.right + out * self.forward;
            plan.extend((by_r - self.slope) * out)
        };
        Ok(DMat3::from_cols(column(DVec2::X), column(DVec2::Y), by_z * DVec3::Z))
    }
}
