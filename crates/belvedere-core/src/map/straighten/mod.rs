//! Space around a line follows it as the line is straightened: a strip along a route, in plan, or a tube along a centreline.

mod bound;
mod curve;
mod dimension;
mod overlap;
mod smooth;
mod tree;

pub use curve::{Curve, Foot, Frame};
pub use dimension::{Across, Dimension, Plan, Shape, Space, Vector};
pub use overlap::BEND_SHARE;
pub use smooth::Smoothed;

use super::{Miss, SpaceMap};
use crate::plain::number;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// A route, smoothed so that a strip fits.
pub type SmoothedRoute = Smoothed<Plan>;
/// A centreline, smoothed so that a tube fits.
pub type SmoothedCentreline = Smoothed<Space>;

/// A strip of the ground along a route that is straightened, as in panoramas along a road; heights stay as they are.
pub type Strip = Straightened<Plan>;

/// A tube along a centreline that is straightened with its surroundings, as in curved planar reformations of vessels.
///
/// ```
/// use belvedere_core::map::straighten::{SmoothedCentreline, Tube};
/// use belvedere_core::{DVec3, SpaceMap};
/// let helix: Vec<DVec3> = (0..=80).map(|i| f64::from(i) * 0.1).map(|t| DVec3::new(40.0 * t.cos(), 40.0 * t.sin(), 6.0 * t)).collect();
/// let vessel = SmoothedCentreline::new(&helix, 10.0, None)?;
/// let tube = Tube::new(vessel.curve, 10.0, 1.0, helix[0])?;
/// let [start, end] = [helix[0], helix[80]].map(|p| tube.apply(p).unwrap());
/// assert!(start.distance(end) > 317.0 && start.distance(end) < 324.0); // 8 radians, unwound
/// # Ok::<(), belvedere_core::map::straighten::StraightenError>(())
/// ```
pub type Tube = Straightened<Space>;

/// Errors of a strip or tube.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StraightenError {
    /// A coordinate is not finite, or beyond 1e9.
    #[error("point {index} of the {} is at {}; every coordinate must be a number between -1e9 and 1e9", shape.line(), shape.place(*value))]
    NotFinite {
        /// What was asked for.
        shape: Shape,
        /// Number of the point, from 0.
        index: usize,
        /// The point.
        value: DVec3,
    },
    /// The line has no length.
    #[error("the {} has {points} points and is {} long; at least 2 points apart from each other are needed", shape.line(), number(*length))]
    TooShort {
        /// What was asked for.
        shape: Shape,
        /// Points.
        points: usize,
        /// Length.
        length: f64,
    },
    /// The line is a loop, or leads there and back.
    #[error(
        "the {line} winds back to where it was: smoothed until a {name} of {width} {half_width} fits, {left:.2} are left of its {length:.2}; take a narrower {name}, or a part of the {line}",
        line = shape.line(), name = shape.name(), width = shape.width()
    )]
    Winds {
        /// What was asked for.
        shape: Shape,
        /// Length of the line.
        length: f64,
        /// Length of the smoothed line.
        left: f64,
        /// Half width or radius that was asked for.
        half_width: f64,
    },
    /// The smoothed line bends too sharply for the half width.
    #[error(
        "the smoothed {} bends with a radius of {radius:.2} at {}, too sharp for a {} of {half_width}; the widest that works is {widest:.2}, or smooth more",
        shape.line(), shape.place(*at), shape.width()
    )]
    Radius {
        /// What was asked for.
        shape: Shape,
        /// Position of the bend, scene coordinates.
        at: DVec3,
        /// Least radius of curvature.
        radius: f64,
        /// Half width or radius that was asked for.
        half_width: f64,
        /// Largest one that this bend allows.
        widest: f64,
    },
    /// The strip or tube overlaps itself.
    #[error(
        "the {} overlaps itself at {}: two parts of the smoothed {} are {distance:.2} apart, a {} of {half_width} needs more than twice that; the widest that works there is {widest:.2}, or smooth more",
        shape.name(), shape.place(*at), shape.line(), shape.width()
    )]
    Overlap {
        /// What was asked for.
        shape: Shape,
        /// Midpoint between both parts, scene coordinates.
        at: DVec3,
        /// Their distance.
        distance: f64,
        /// Half width or radius that was asked for.
        half_width: f64,
        /// Largest one that this distance allows.
        widest: f64,
    },
    /// The curve needs more nodes than the limit.
    #[error(
        "a {} of {length:.2} with nodes {fine:.2} apart needs more than {most} of them; take a wider {} or smooth more",
        shape.line(), shape.name()
    )]
    TooFine {
        /// What was asked for.
        shape: Shape,
        /// Length of the line.
        length: f64,
        /// Node spacing that half width and smoothing need.
        fine: f64,
        /// Most nodes.
        most: f64,
    },
    /// Too many places of the line lie within reach of each other.
    #[error(
        "a {width} of {half_width} reaches about {near:.0} of the {nodes} nodes of the {line} from each of them, more than {most:.0} pairs; smooth more, or take a narrower {name}",
        width = shape.width(), line = shape.line(), name = shape.name()
    )]
    TooMany {
        /// What was asked for.
        shape: Shape,
        /// Half width or radius that was asked for.
        half_width: f64,
        /// Nodes of the curve.
        nodes: usize,
        /// Those within reach of one of them, about.
        near: f64,
        /// Most pairs.
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

/// Most pairs of nodes within reach of each other of a line whose surroundings are parted: nine seconds of a core.
const MOST_PAIRS: f64 = 1e8;

/// A position as a point of the scene, at height 0 in plan.
fn place<D: Dimension>(at: D::Vector) -> DVec3 {
    D::with(at, DVec3::ZERO)
}

/// `value`, if it is in a range.
fn in_range(key: &'static str, value: f64, min: f64, max: f64) -> Result<f64, StraightenError> {
    if (min..=max).contains(&value) { Ok(value) } else { Err(StraightenError::Range { key, value, min, max }) }
}

/// What lies around a line, carried as the line is straightened.
///
/// A point has an arc length `g`, that of its foot on the smoothed line `X`, and an offset `a` from it there. It goes to the same
/// arc length and offset of another curve: `Y(g) + a N(g)`. `Y` is `X` with its curvature times `1 - share`, through the
/// anchor as `X` is: there nothing moves, and the line unrolls ahead and behind. Lengths along the line and offsets from it stay
/// as they are. The determinant of the Jacobian is `(1 - kap_Y a) / (1 - kap_X a) > 0`. Points farther from the line than the half
/// width have no image.
///
/// In plan ([`Strip`]) `N` is the normal to the left, and heights are unchanged; in space ([`Tube`]) curvature and offset have two parts, along
/// normals that turn about the line no more than they must (the frame of Bishop 1975).
///
/// Source: ours; strips along a road as in panorama maps, straightened vessels as in Kanitsar and others, CPR - Curved Planar Reformation, 2002.
///
/// ```
/// use belvedere_core::map::straighten::{SmoothedRoute, Strip};
/// use belvedere_core::{DVec2, DVec3, SpaceMap};
/// let bend: Vec<DVec2> = (0..=40).map(|i| 1000.0 * DVec2::from_angle(0.04 * f64::from(i))).collect();
/// let route = SmoothedRoute::new(&bend, 200.0, None)?;
/// let strip = Strip::new(route.curve, 200.0, 1.0, bend[0])?;
/// let [start, end] = [bend[0], bend[40]].map(|p| strip.apply(p.extend(30.0)).unwrap());
/// assert!((end - start).length() > 1580.0 && start.distance(end) < 1600.1); // a quarter of a circle of radius 1000, unrolled
/// # Ok::<(), belvedere_core::map::straighten::StraightenError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Straightened<D: Dimension> {
    line: Arc<Curve<D>>,
    unrolled: Arc<Curve<D>>,
    half_width: f64,
    share: f64,
    /// Arc length of the anchor.
    anchor: f64,
    largest_curvature: f64,
    /// Whether no point within the half width has two feet, neither on the line nor on the unrolled one. Else points belong to the nearest
    /// place of the line, as far as they are the nearest to it after it is unrolled, too.
    single: bool,
    /// If not, the offsets that belong to each node of the line: those on this side of lines across it, `normal . offset <= distance`.
    cells: Arc<Vec<overlap::Cell<D>>>,
}

impl<D: Dimension> Straightened<D> {
    /// * `line`: from [`Smoothed::new`] with this half width, or a greater one.
    /// * `half_width`: largest distance from the line, scene units, > 0.
    /// * `share`: of the curvature that is taken away, 0..=1; 1 = straight, 0 = no change.
    /// * `anchor`: nothing moves where the line is nearest to it, scene coordinates.
    ///
    /// # Errors
    /// [`StraightenError::Range`]; [`StraightenError::Radius`] and [`StraightenError::Overlap`] if the line is too sharp or too close to itself
    /// for the half width, or overlaps itself when it is straightened in part.
    pub fn new(line: Curve<D>, half_width: f64, share: f64, anchor: D::Vector) -> Result<Self, StraightenError> {
        in_range("half_width", half_width, 1e-6, 1e9)?;
        in_range("share", share, 0.0, 1.0)?;
        for coordinate in anchor.components() {
            in_range("anchor", *coordinate, -1e9, 1e9)?;
        }
        let largest_curvature = line.largest_curvature();
        let radius = 1.0 / largest_curvature;
        if !(half_width <= BEND_SHARE * radius * (1.0 + 1e-9)) {
            let at = line.positions().zip(line.curvature()).find(|(_, k)| k.length() >= largest_curvature);
            let (shape, at) = (D::SHAPE, place::<D>(at.map_or(D::Vector::default(), |(p, _)| p)));
            return Err(StraightenError::Radius { shape, at, radius, half_width, widest: BEND_SHARE * radius });
        }
        let reach = overlap::reach(&line, half_width)?;
        let line = line.with_reach(reach);
        let anchor = line.nearest(anchor);
        let unrolled = unrolled(&line, half_width, share, anchor)?;
        let reach = unrolled.reach();
        let line = Arc::new(line.with_reach(reach));
        Ok(Self {
            line,
            unrolled: Arc::new(unrolled),
            half_width,
            share,
            anchor,
            largest_curvature,
            single: true,
            cells: Arc::default(),
        })
    }

    /// The same for any half width: where parts of the line come nearer to each other, or where it bends too sharply, what lies between them
    /// belongs to the nearest one, and has no image where the line bends with less than 1.25 times its distance. It has none beyond the ends of
    /// the line either.
    ///
    /// # Errors
    /// [`StraightenError::Range`], [`StraightenError::TooMany`].
    pub fn parted(line: Curve<D>, half_width: f64, share: f64, anchor: D::Vector) -> Result<Self, StraightenError> {
        match Self::new(line.clone(), half_width, share, anchor) {
            Err(StraightenError::Radius { .. } | StraightenError::Overlap { .. }) => {}
            done => return done,
        }
        let nodes = line.curvature().len();
        let near = (4.0 * half_width / line.spacing()).min(nodes as f64);
        if !(near * nodes as f64 <= MOST_PAIRS) {
            return Err(StraightenError::TooMany { shape: D::SHAPE, half_width, nodes, near, most: MOST_PAIRS });
        }
        let reach = [0.0, line.length()];
        let largest_curvature = line.largest_curvature();
        let line = line.with_reach(reach);
        let anchor = line.nearest(anchor);
        let unrolled = Arc::new(line.unbent(1.0 - share, anchor));
        let cells = Arc::new(overlap::cells(&line, &unrolled, half_width));
        Ok(Self { line: Arc::new(line), unrolled, half_width, share, anchor, largest_curvature, single: false, cells })
    }

    /// The same at a share of its strength, 0 < share <= 1; `None` where that curve overlaps itself.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        let share = share * self.share;
        if !self.single {
            let unrolled = self.line.unbent(1.0 - share, self.anchor);
            let cells = Arc::new(overlap::cells(&self.line, &unrolled, self.half_width));
            return Some(Self { unrolled: Arc::new(unrolled), cells, share, ..self.clone() });
        }
        let unrolled = unrolled(&self.line, self.half_width, share, self.anchor).ok()?;
        let line = Arc::new(self.line.as_ref().clone().with_reach(unrolled.reach()));
        Some(Self { line, unrolled: Arc::new(unrolled), share, ..self.clone() })
    }

    /// The smoothed line.
    pub fn line(&self) -> &Curve<D> {
        &self.line
    }

    /// The curve that it is carried onto.
    pub fn unrolled(&self) -> &Curve<D> {
        &self.unrolled
    }

    /// Largest distance from the line, scene units.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Whether all within the half width has an image, see [`Straightened::parted`].
    pub fn is_whole(&self) -> bool {
        self.single
    }

    /// Share of the curvature that is taken away.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Point of the line where nothing moves, scene coordinates.
    pub fn anchor(&self) -> D::Vector {
        self.line.at(self.anchor).p
    }

    /// Arc length and offset of a point's foot on the line; `None` outside the domain.
    pub fn coordinates(&self, p: DVec3) -> Option<Foot<D>> {
        if !p.is_finite() {
            return None;
        }
        let p = D::of(p);
        if self.single { self.line.foot(p, self.half_width) } else { self.held(&self.line, p) }
    }

    /// The foot of a displaced point on the unrolled line; `None` outside the image of the domain.
    fn displaced_coordinates(&self, q: D::Vector) -> Option<Foot<D>> {
        if self.single { self.unrolled.foot(q, self.half_width) } else { self.held(&self.unrolled, q) }
    }

    /// The nearest foot on a curve, if the offset belongs to it.
    fn held(&self, curve: &Curve<D>, p: D::Vector) -> Option<Foot<D>> {
        let foot = curve.closest(p)?;
        let [first, last] = curve.reach();
        let is_inside = foot.a.length() <= self.half_width && (first..=last).contains(&foot.g);
        (is_inside && self.has_room(foot)).then_some(foot)
    }

    /// Whether an offset belongs to its place of the line: to the nodes before and behind it.
    fn has_room(&self, foot: Foot<D>) -> bool {
        let last = self.cells.len() - 1;
        let i = ((foot.g / self.line.spacing()).floor().max(0.0) as usize).min(last);
        let holds = |cell: &overlap::Cell<D>| cell.iter().all(|(normal, most)| normal.dot(foot.a) <= *most);
        holds(&self.cells[i]) && holds(&self.cells[(i + 1).min(last)])
    }

    /// Image of a point with these coordinates.
    fn image(&self, p: DVec3, at: Foot<D>) -> DVec3 {
        D::with(carried(&self.line, &self.unrolled, at.g, D::of(p)), p)
    }

    /// How what stands at a point turns.
    pub(crate) fn rotation_at(&self, p: DVec3) -> Result<DMat3, Miss> {
        let at = self.coordinates(p).ok_or(Miss::OutsideDomain)?;
        let [from, to] = [&self.line, &self.unrolled].map(|curve| curve.relative(at.g).turn);
        let turn = D::then(to, D::back(from));
        let turned = |axis: DVec3| D::with(D::turned(turn, D::of(axis)), axis);
        Ok(DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z)))
    }

    /// Lower bound on the distance, scene units, of a displaced point from the image of the domain; 0 or less inside and near it.
    pub fn outside(&self, p_displaced: DVec3) -> f64 {
        self.unrolled.distance(D::of(p_displaced)) - self.half_width
    }

    /// Image of a point with these coordinates, and the derivative there: its columns along the axes, the first ones of three.
    fn linear(&self, p: D::Vector, at: Foot<D>) -> (D::Vector, [D::Vector; 3]) {
        let (from, to) = (self.line.relative(at.g), self.unrolled.relative(at.g));
        let image = carried(&self.line, &self.unrolled, at.g, p);
        let stretch = (1.0 - to.curvature.dot(at.a)) / (1.0 - from.curvature.dot(at.a));
        let mut columns = [D::Vector::default(); 3];
        for (column, axis) in columns.iter_mut().zip(D::Vector::AXES) {
            let (along, across) = D::parts(from.turn, *axis);
            *column = D::vector(to.turn, stretch * along, across);
        }
        (image, columns)
    }
}

/// The line with its curvature times `1 - share`, and the reach within which what lies around either does not overlap itself.
fn unrolled<D: Dimension>(
    line: &Curve<D>,
    half_width: f64,
    share: f64,
    anchor: f64,
) -> Result<Curve<D>, StraightenError> {
    if share == 0.0 {
        return Ok(line.clone());
    }
    let curve = line.unbent(1.0 - share, anchor);
    let ([first, last], [from, to]) = (line.reach(), overlap::reach(&curve, half_width)?);
    Ok(curve.with_reach([first.max(from), last.min(to)]))
}

/// Image of a point that keeps its arc length `g` and offset from one curve to the other; equal curves move nothing.
fn carried<D: Dimension>(from: &Curve<D>, to: &Curve<D>, g: f64, p: D::Vector) -> D::Vector {
    let (x, y) = (from.relative(g), to.relative(g));
    let v = p - from.origin() - x.p;
    let turned = D::turned(D::then(y.turn, D::back(x.turn)), v);
    p + ((to.origin() - from.origin()) + (y.p - x.p) + (turned - v))
}

impl<D: Dimension> SpaceMap for Straightened<D> {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let at = self.coordinates(p).ok_or(Miss::OutsideDomain)?;
        Ok(self.image(p, at))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let q = D::of(p_displaced);
        let at = if p_displaced.is_finite() { self.displaced_coordinates(q) } else { None };
        let at = at.ok_or(Miss::OutsideDomain)?;
        Ok(D::with(carried(&self.unrolled, &self.line, at.g, q), p_displaced))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let at = self.coordinates(p).ok_or(Miss::OutsideDomain)?;
        let (_, columns) = self.linear(D::of(p), at);
        let mut out = DMat3::IDENTITY;
        for (i, column) in columns.into_iter().enumerate().take(D::Vector::AXES.len()) {
            *out.col_mut(i) = D::with(column, DVec3::ZERO);
        }
        Ok(out)
    }
}
