//! Relief as mapmakers draw it: heights raised or lowered from foreground to background, shown in plan, on a curved horizon, over ground
//! whose large forms are levelled.

mod base;

pub use base::{BaseError, BaseSurface};

use super::spline::ReferencePlane;
use super::{Miss, SpaceMap, finite};
use crate::plain::number;
use crate::{Aabb, Pinhole};
use glam::{DMat2, DMat3, DVec2, DVec3};
use std::sync::Arc;

/// Parameters of a change of relief.
#[derive(Debug, Clone, PartialEq)]
pub struct ReliefShape {
    /// Factor of heights over the plane in the foreground and in the background, 0.01..=100.
    pub exaggeration: [f64; 2],
    /// Shift in plan, away from the viewer, per unit of height, 0..=5: plan oblique relief.
    pub oblique: f64,
    /// Radius of the horizon in the background, scene units, > 0; infinite = straight.
    pub horizon_radius: f64,
    /// Share of the large forms that is taken away, 0..=1.
    pub levelling: f64,
    /// Distances from the eye in plan, along the heading, at which the foreground ends and the background begins, scene units, rising.
    pub range: [f64; 2],
}

impl ReliefShape {
    /// The shape that changes nothing, over a range of two distances, scene units.
    pub fn none(range: [f64; 2]) -> Self {
        Self { exaggeration: [1.0; 2], oblique: 0.0, horizon_radius: f64::INFINITY, levelling: 0.0, range }
    }
}

/// A range in words.
fn range_words(min: f64, max: f64) -> String {
    if max.is_infinite() { "greater than 0".into() } else { format!("in {}..={}", number(min), number(max)) }
}

/// An invalid shape of relief.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReliefError {
    /// A parameter is out of range.
    #[error("{key} is {}, it must be {}", number(*value), range_words(*min, *max))]
    Range {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// The background does not begin beyond the foreground.
    #[error("range is [{near}, {far}]; the background must begin farther away than the foreground ends")]
    Order {
        /// End of the foreground.
        near: f64,
        /// Start of the background.
        far: f64,
    },
    /// Levelling without a surface to level by, or over a tilted plane.
    #[error("levelling needs terrain over a level reference plane")]
    NoBase,
}

/// Changes of relief for one camera.
///
/// With b the distance along the heading, a to the right and d over the plane, t = smoothstep of b over the range, B the large forms:
/// `e = (d - levelling B) lerp(x_f, x_b, t)`, `b' = b + oblique e`, `d' = e - t a^2 / 2 R`, `a' = a`. The determinant of its Jacobian is
/// `lerp(x_f, x_b, t) (1 + oblique t' a^2 / 2 R) > 0`.
///
/// Source: vertical exaggeration and curved horizon of foreground and background after Jenny et al. 2010 (Terrain Bender), plan oblique
/// relief after Jenny and Patterson 2007, in our form; levelling is ours.
///
/// ```
/// use belvedere_core::map::relief::{Relief, ReliefShape};
/// use belvedere_core::map::spline::ReferencePlane;
/// use belvedere_core::{DVec3, Pinhole, Projection, SpaceMap};
/// let camera = Pinhole::look_at(
///     DVec3::new(0.0, -1000.0, 500.0), DVec3::ZERO, DVec3::Z,
///     Projection::Perspective { fov_y: 0.8 }, [1280, 720], 1.0, None,
/// )?;
/// let shape = ReliefShape { exaggeration: [1.0, 2.0], ..ReliefShape::none([1000.0, 3000.0]) };
/// let relief = Relief::new(&camera, &ReferencePlane::level(0.0), shape, None)?;
/// assert_eq!(relief.apply(DVec3::new(0.0, 5000.0, 300.0)).unwrap().z, 600.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    origin: DVec3,
    right: DVec3,
    heading: DVec3,
    normal: DVec3,
    shape: ReliefShape,
    base: Option<Arc<BaseSurface>>,
    /// Height of the plane, scene units, from which base heights are measured.
    plane: f64,
}

/// Exaggeration and curvature drop at a distance, with derivatives.
#[derive(Debug, Clone, Copy)]
struct At {
    /// Exaggeration and its derivative.
    factor: [f64; 2],
    /// `t / 2 R` and its derivative.
    drop: [f64; 2],
}

impl Relief {
    /// * `plane`: heights are measured from it; the heading is the camera's direction in it.
    /// * `base`: the large forms, needed where `shape.levelling > 0`.
    ///
    /// # Errors
    /// Every [`ReliefError`].
    pub fn new(
        pinhole: &Pinhole,
        plane: &ReferencePlane,
        shape: ReliefShape,
        base: Option<Arc<BaseSurface>>,
    ) -> Result<Self, ReliefError> {
        let [near, far] = shape.range;
        let ranges = [
            ("exaggeration", shape.exaggeration[0], 0.01, 100.0),
            ("exaggeration", shape.exaggeration[1], 0.01, 100.0),
            ("oblique", shape.oblique, 0.0, 5.0),
            ("horizon_radius", shape.horizon_radius, f64::MIN_POSITIVE, f64::INFINITY),
            ("levelling", shape.levelling, 0.0, 1.0),
            ("range", near, -1e9, 1e9),
            ("range", far, -1e9, 1e9),
        ];
        if let Some(&(key, value, min, max)) = ranges.iter().find(|r| !(r.2..=r.3).contains(&r.1)) {
            return Err(ReliefError::Range { key, value, min, max });
        }
        if far - near <= 1e-9 * far.abs().max(1.0) {
            return Err(ReliefError::Order { near, far });
        }
        let [right, heading] = plane.heading_axes(pinhole);
        let normal = plane.normal();
        let base = base.filter(|_| shape.levelling > 0.0);
        if shape.levelling > 0.0 && (base.is_none() || normal.distance(DVec3::Z) > 1e-12) {
            return Err(ReliefError::NoBase);
        }
        let origin = plane.foot(pinhole.eye);
        Ok(Self { origin, right, heading, normal, plane: origin.z, shape, base })
    }

    /// This relief at a share of its strength, 0 < share <= 1.
    pub(crate) fn eased(&self, share: f64) -> Self {
        let shape = ReliefShape {
            exaggeration: self.shape.exaggeration.map(|factor| factor.powf(share)),
            oblique: share * self.shape.oblique,
            horizon_radius: self.shape.horizon_radius / share,
            levelling: share * self.shape.levelling,
            range: self.shape.range,
        };
        Self { shape, ..self.clone() }
    }

    /// The parameters.
    pub fn shape(&self) -> &ReliefShape {
        &self.shape
    }

    /// Unit directions to the right, along the heading and off the plane.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right, self.heading, self.normal]
    }

    /// Distance to the right of the eye, along the heading, and over the plane.
    fn local(&self, p: DVec3) -> DVec3 {
        let v = p - self.origin;
        DVec3::new(v.dot(self.right), v.dot(self.heading), v.dot(self.normal))
    }

    fn scene(&self, q: DVec3) -> DVec3 {
        self.origin + q.x * self.right + q.y * self.heading + q.z * self.normal
    }

    fn at(&self, b: f64) -> At {
        let [near, far] = self.shape.range;
        let [front, back] = self.shape.exaggeration;
        let width = far - near;
        let u = ((b - near) / width).clamp(0.0, 1.0);
        let (t, dt) = (u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / width);
        let bow = 0.5 / self.shape.horizon_radius;
        At { factor: [front + t * (back - front), dt * (back - front)], drop: [t * bow, dt * bow] }
    }

    /// Large forms that are taken away, over the plane, at a scene position.
    fn levelled(&self, p: DVec3) -> f64 {
        self.base.as_ref().map_or(0.0, |base| self.shape.levelling * (base.height(p.truncate()) - self.plane))
    }

    /// Bounds over an interval of distances on the factor, the drop, and their first and second derivatives.
    fn most(&self, from: f64, to: f64) -> Most {
        let [near, far] = self.shape.range;
        let [front, back] = self.shape.exaggeration;
        let (at_from, at_to) = (self.at(from), self.at(to));
        let inside = from < far && to > near;
        // Of smoothstep: the first derivative is 3/2 at most, the second 6.
        let [once, twice] = if inside { [1.5 / (far - near), 6.0 / (far - near).powi(2)] } else { [0.0; 2] };
        let bow = 0.5 / self.shape.horizon_radius;
        Most {
            factor: at_from.factor[0].max(at_to.factor[0]),
            factor_once: once * (back - front).abs(),
            factor_twice: twice * (back - front).abs(),
            drop: at_to.drop[0].max(at_from.drop[0]),
            drop_once: once * bow,
            drop_twice: twice * bow,
        }
    }

    /// See [`crate::map::StageMap::edge_bound`]: an eighth of bounds on the second derivatives along the edge.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if !(p0.is_finite() && p1.is_finite()) {
            return f64::INFINITY;
        }
        let (q0, q1) = (self.local(p0), self.local(p1));
        let most = self.most(q0.y.min(q1.y), q0.y.max(q1.y));
        let step = (q1 - q0).abs();
        let bow = self.base.as_ref().map_or(0.0, |b| self.shape.levelling * b.bow((p1 - p0).truncate()));
        // Heights over the large forms lie within the bow of the chord between those of the ends.
        let [d0, d1] = [q0.z - self.levelled(p0), q1.z - self.levelled(p1)];
        let high = d0.abs().max(d1.abs()) + 0.125 * bow;
        let rise = (d1 - d0).abs() + 0.5 * bow;
        let heights =
            bow * most.factor + 2.0 * rise * most.factor_once * step.y + high * most.factor_twice * step.y.powi(2);
        let across = q0.x.abs().max(q1.x.abs());
        let horizon = most.drop_twice * (step.y * across).powi(2)
            + 4.0 * most.drop_once * step.y * across * step.x
            + 2.0 * most.drop * step.x * step.x;
        0.125 * (heights + horizon).hypot(self.shape.oblique * heights)
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || !bounds.min.is_finite() || !bounds.max.is_finite() {
            return None;
        }
        let corners = bounds.corners().map(|p| self.local(p));
        let [lo, hi] =
            corners.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], q| [lo.min(*q), hi.max(*q)]);
        let base = self.base.as_ref().map_or([0.0; 2], |base| {
            base.range(bounds.min.truncate(), bounds.max.truncate()).map(|h| self.shape.levelling * (h - self.plane))
        });
        let (from, to) = (self.at(lo.y), self.at(hi.y));
        let (d0, d1) = (lo.z - base[1], hi.z - base[0]);
        let products = [from.factor[0], to.factor[0]].map(|x| [x * d0, x * d1]);
        let e0 = products[0][0].min(products[1][0]);
        let e1 = products[0][1].max(products[1][1]);
        let across = lo.x.abs().max(hi.x.abs());
        let least_across = if lo.x <= 0.0 && hi.x >= 0.0 { 0.0 } else { lo.x.abs().min(hi.x.abs()) };
        let z = [e0 - to.drop[0] * across * across, e1 - from.drop[0] * least_across * least_across];
        let y = [lo.y + self.shape.oblique * e0, hi.y + self.shape.oblique * e1];
        let mut out = Aabb::EMPTY;
        for i in 0..8usize {
            let x = if i & 1 == 0 { lo.x } else { hi.x };
            out = out.including(self.scene(DVec3::new(x, y[i >> 1 & 1], z[i >> 2])));
        }
        Some(out)
    }
}

/// Bounds over an interval of distances.
struct Most {
    factor: f64,
    factor_once: f64,
    factor_twice: f64,
    drop: f64,
    drop_once: f64,
    drop_twice: f64,
}

impl SpaceMap for Relief {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let q = self.local(finite(p)?);
        let at = self.at(q.y);
        let e = (q.z - self.levelled(p)) * at.factor[0];
        finite(self.scene(DVec3::new(q.x, q.y + self.shape.oblique * e, e - at.drop[0] * q.x * q.x)))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let q = self.local(finite(p_displaced)?);
        let b = self.distance_before(q);
        let at = self.at(b);
        let e = q.z + at.drop[0] * q.x * q.x;
        let on_plane = self.scene(DVec3::new(q.x, b, 0.0));
        finite(on_plane + (e / at.factor[0] + self.levelled(on_plane)) * self.normal)
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let q = self.local(finite(p)?);
        let at = self.at(q.y);
        let base = self.base.as_ref().map_or(DVec2::ZERO, |base| self.shape.levelling * base.gradient(p.truncate()));
        let plan = DMat2::from_cols(self.right.truncate(), self.heading.truncate()).transpose();
        let slope = plan * base;
        let height = q.z - self.levelled(p);
        let [factor, change] = at.factor;
        // Columns: to the right, along the heading, off the plane.
        let e = DVec3::new(-slope.x * factor, height * change - slope.y * factor, factor);
        let k = self.shape.oblique;
        let drop = DVec3::new(2.0 * at.drop[0] * q.x, at.drop[1] * q.x * q.x, 0.0);
        let rows = [DVec3::X, DVec3::Y + k * e, e - drop];
        let local = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        let axes = DMat3::from_cols(self.right, self.heading, self.normal);
        let jacobian = axes * local * axes.transpose();
        if jacobian.is_finite() { Ok(jacobian) } else { Err(Miss::OutsideDomain) }
    }
}

impl Relief {
    /// Distance b of a displaced point before the displacement: root of `b + oblique (d' + t(b) a^2 / 2 R) = b'`, whose left side rises
    /// with b, by Newton's method in a bracket.
    fn distance_before(&self, q: DVec3) -> f64 {
        let k = self.shape.oblique;
        let side = k * q.x * q.x;
        let rest = q.y - k * q.z;
        if k == 0.0 || side * 0.5 / self.shape.horizon_radius == 0.0 {
            return rest;
        }
        let most = side * 0.5 / self.shape.horizon_radius;
        let [mut lo, mut hi] = [rest - most, rest];
        let mut b = rest;
        for _ in 0..200 {
            let at = self.at(b);
            let off = b + side * at.drop[0] - rest;
            if off > 0.0 {
                hi = b
            } else {
                lo = b
            }
            let newton = b - off / (1.0 + side * at.drop[1]);
            let next = if newton >= lo && newton <= hi { newton } else { 0.5 * (lo + hi) };
            if (next - b).abs() <= 1e-15 * b.abs().max(1.0) {
                return next;
            }
            b = next;
        }
        b
    }
}
