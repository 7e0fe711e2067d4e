//! A strip along a route, unrolled: space follows the route in plan as it is straightened.

mod bound;
mod curve;
mod overlap;
mod route;
mod tree;

pub use curve::{PlanCurve, PlanFrame, StripPoint};
pub use route::{BEND_SHARE, SmoothedRoute};

use super::{Miss, SpaceMap};
use crate::plain::number;
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;

/// Errors of a strip.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StripError {
    /// A coordinate is not finite, or beyond 1e9.
    #[error("point {index} of the route is at {value}; every coordinate must be a number between -1e9 and 1e9")]
    NotFinite {
        /// Number of the point, from 0.
        index: usize,
        /// The point.
        value: DVec2,
    },
    /// The route has no length.
    #[error("the route has {points} points and is {} long; at least 2 points apart from each other are needed", number(*length))]
    TooShort {
        /// Points.
        points: usize,
        /// Length in plan.
        length: f64,
    },
    /// The route is a loop, or leads there and back.
    #[error(
        "the route winds back to where it was: smoothed until a strip of half width {half_width} fits, {left:.2} are left of its {length:.2}; take a narrower strip, or a part of the route"
    )]
    Winds {
        /// Length in plan.
        length: f64,
        /// Length of the smoothed route.
        left: f64,
        /// Half width that was asked for.
        half_width: f64,
    },
    /// The smoothed route bends too sharply for the half width.
    #[error(
        "the smoothed route bends with a radius of {radius:.2} at ({:.2}, {:.2}), too sharp for a half width of {half_width}; the widest that works is {widest:.2}, or smooth more",
        at.x, at.y
    )]
    Radius {
        /// Position of the bend, scene coordinates.
        at: DVec2,
        /// Least radius of curvature.
        radius: f64,
        /// Half width that was asked for.
        half_width: f64,
        /// Largest half width that this radius allows.
        widest: f64,
    },
    /// The strip overlaps itself.
    #[error(
        "the strip overlaps itself at ({:.2}, {:.2}): two parts of the smoothed route are {distance:.2} apart, a half width of {half_width} needs more than twice that; the widest that works there is {widest:.2}, or smooth more",
        at.x, at.y
    )]
    Overlap {
        /// Midpoint between both parts, scene coordinates.
        at: DVec2,
        /// Their distance.
        distance: f64,
        /// Half width that was asked for.
        half_width: f64,
        /// Largest half width that this distance allows.
        widest: f64,
    },
    /// The curve needs more nodes than the limit.
    #[error(
        "a route of {length:.2} with nodes {fine:.2} apart needs more than {most} of them; take a wider strip or smooth more"
    )]
    TooFine {
        /// Length of the route.
        length: f64,
        /// Node spacing that half width and smoothing need.
        fine: f64,
        /// Most nodes.
        most: f64,
    },
    /// Out of range.
    #[error("{key} is {}, it must be in {}..={}", number(*value), number(*min), number(*max))]
    Range {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Least.
        min: f64,
        /// Most.
        max: f64,
    },
}

/// `value`, if it is in a range.
fn in_range(key: &'static str, value: f64, min: f64, max: f64) -> Result<f64, StripError> {
    if (min..=max).contains(&value) { Ok(value) } else { Err(StripError::Range { key, value, min, max }) }
}

/// A strip of the ground along a route that is straightened, as in panoramas along a road.
///
/// In plan a point has an arc length `g`, that of its foot on the smoothed route `X`, and a distance `a` to the left of it. It goes to the same
/// arc length and distance of another curve: `Y(g) + a N(g)`, heights unchanged. `Y` is `X` with its curvature times `1 - share`, through the
/// anchor as `X` is: there nothing moves, and the road unrolls ahead and behind. Lengths along the route and distances from it stay
/// as they are. The determinant of the Jacobian is `(1 - kap_Y a) / (1 - kap_X a) > 0`. Points farther from the route than the half
/// width have no image.
///
/// Source: ours; strips along a road as in panorama maps.
///
/// ```
/// use belvedere_core::map::strip::{SmoothedRoute, Strip};
/// use belvedere_core::{DVec2, DVec3, SpaceMap};
/// let bend: Vec<DVec2> = (0..=40).map(|i| 1000.0 * DVec2::from_angle(0.04 * f64::from(i))).collect();
/// let route = SmoothedRoute::new(&bend, 200.0, None)?;
/// let strip = Strip::new(route.curve, 200.0, 1.0, bend[0])?;
/// let [start, end] = [bend[0], bend[40]].map(|p| strip.apply(p.extend(30.0)).unwrap());
/// assert!((end - start).length() > 1580.0 && start.distance(end) < 1600.1); // a quarter of a circle of radius 1000, unrolled
/// # Ok::<(), belvedere_core::map::strip::StripError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    route: Arc<PlanCurve>,
    unrolled: Arc<PlanCurve>,
    half_width: f64,
    share: f64,
    /// Arc length of the anchor.
    anchor: f64,
    largest_curvature: f64,
}

impl Strip {
    /// * `route`: from [`SmoothedRoute::new`] with this half width, or a greater one.
    /// * `half_width`: largest distance from the route, scene units, > 0.
    /// * `share`: of the curvature that is taken away, 0..=1; 1 = straight, 0 = no change.
    /// * `anchor`: nothing moves where the route is nearest to it, scene coordinates.
    ///
    /// # Errors
    /// [`StripError::Range`]; [`StripError::Radius`] and [`StripError::Overlap`] if the route is too sharp or too close to itself
    /// for the half width, or overlaps itself when it is straightened in part.
    pub fn new(route: PlanCurve, half_width: f64, share: f64, anchor: DVec2) -> Result<Self, StripError> {
        in_range("half_width", half_width, 1e-6, 1e9)?;
        in_range("share", share, 0.0, 1.0)?;
        in_range("anchor", anchor.x, -1e9, 1e9)?;
        in_range("anchor", anchor.y, -1e9, 1e9)?;
        let largest_curvature = route.largest_curvature();
        let radius = 1.0 / largest_curvature;
        if !(half_width <= BEND_SHARE * radius * (1.0 + 1e-9)) {
            let at = route.positions().zip(route.curvature()).find(|(_, k)| k.abs() >= largest_curvature);
            let at = at.map_or(DVec2::ZERO, |(p, _)| p);
            return Err(StripError::Radius { at, radius, half_width, widest: BEND_SHARE * radius });
        }
        let reach = overlap::reach(&route, half_width)?;
        let route = route.with_reach(reach);
        let anchor = route.nearest(anchor);
        let unrolled = unrolled(&route, half_width, share, anchor)?;
        let reach = unrolled.reach();
        let route = Arc::new(route.with_reach(reach));
        Ok(Self { route, unrolled: Arc::new(unrolled), half_width, share, anchor, largest_curvature })
    }

    /// This strip at a share of its strength, 0 < share <= 1; `None` where that curve overlaps itself.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        let share = share * self.share;
        let unrolled = unrolled(&self.route, self.half_width, share, self.anchor).ok()?;
        let route = Arc::new(self.route.as_ref().clone().with_reach(unrolled.reach()));
        Some(Self { route, unrolled: Arc::new(unrolled), share, ..self.clone() })
    }

    /// The smoothed route.
    pub fn route(&self) -> &PlanCurve {
        &self.route
    }

    /// The curve that it is carried onto.
    pub fn unrolled(&self) -> &PlanCurve {
        &self.unrolled
    }

    /// Largest distance from the route, scene units.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Share of the curvature that is taken away.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Point of the route where nothing moves, scene coordinates.
    pub fn anchor(&self) -> DVec2 {
        self.route.at(self.anchor).p
    }

    /// Arc length and distance to the left of a point's foot on the route; `None` outside the domain.
    pub fn coordinates(&self, p: DVec3) -> Option<StripPoint> {
        if p.is_finite() { self.route.foot(p.truncate(), self.half_width) } else { None }
    }

    /// Image of a point with these coordinates.
    fn image(&self, p: DVec3, at: StripPoint) -> DVec3 {
        carried(&self.route, &self.unrolled, at.g, p.truncate()).extend(p.z)
    }

    /// Lower bound on the distance in plan, scene units, of a displaced point from the image of the domain; 0 or less inside and near it.
    pub fn outside(&self, p_displaced: DVec3) -> f64 {
        self.unrolled.distance(p_displaced.truncate()) - self.half_width
    }

    /// Image in plan of a point with these coordinates, and the derivative there: its columns along x and y.
    fn linear(&self, p: DVec2, at: StripPoint) -> (DVec2, [DVec2; 2]) {
        let (from, to) = (self.route.relative(at.g), self.unrolled.relative(at.g));
        let image = carried(&self.route, &self.unrolled, at.g, p);
        let stretch = (1.0 - to.curvature * at.a) / (1.0 - from.curvature * at.a);
        let column =
            |axis: DVec2| stretch * axis.dot(from.tangent) * to.tangent + axis.dot(from.normal()) * to.normal();
        (image, [column(DVec2::X), column(DVec2::Y)])
    }
}

/// The route with its curvature times `1 - share`, and the reach within which neither strip overlaps itself.
fn unrolled(route: &PlanCurve, half_width: f64, share: f64, anchor: f64) -> Result<PlanCurve, StripError> {
    if share == 0.0 {
        return Ok(route.clone());
    }
    let curve = route.unbent(1.0 - share, anchor);
    let ([first, last], [from, to]) = (route.reach(), overlap::reach(&curve, half_width)?);
    Ok(curve.with_reach([first.max(from), last.min(to)]))
}

/// Image of a point that keeps its arc length `g` and distance from one curve to the other; equal curves move nothing.
fn carried(from: &PlanCurve, to: &PlanCurve, g: f64, p: DVec2) -> DVec2 {
    let (x, y) = (from.relative(g), to.relative(g));
    let v = p - from.origin() - x.p;
    let turn = DVec2::new(x.tangent.dot(y.tangent) - 1.0, x.tangent.perp_dot(y.tangent));
    p + ((to.origin() - from.origin()) + (y.p - x.p) + turn.rotate(v))
}

impl SpaceMap for Strip {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let at = self.coordinates(p).ok_or(Miss::OutsideDomain)?;
        Ok(self.image(p, at))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let q = p_displaced.truncate();
        let at = if p_displaced.is_finite() { self.unrolled.foot(q, self.half_width) } else { None };
        let at = at.ok_or(Miss::OutsideDomain)?;
        Ok(carried(&self.unrolled, &self.route, at.g, q).extend(p_displaced.z))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let at = self.coordinates(p).ok_or(Miss::OutsideDomain)?;
        let (_, [x, y]) = self.linear(p.truncate(), at);
        Ok(DMat3::from_cols(x.extend(0.0), y.extend(0.0), DVec3::Z))
    }
}
