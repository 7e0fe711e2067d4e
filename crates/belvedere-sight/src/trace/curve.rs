//! The curved ray of a pixel as chords with a bound on its distance from them.

use crate::fast::Fast;
use crate::trace::row::Row;
use belvedere_core::map::curved_rays::{RayPiece, Shape};
use belvedere_core::map::unroll::Unroll;
use belvedere_core::{DVec2, DVec3, EarthCurvature, RayPath, SplineBend, Stage, TerrainDisocclusion, View};
use std::borrow::Cow;

/// Number of spans into which a ray of unknown shape is first divided.
const SPANS: usize = 8;
/// Largest deviation between the right axes of camera and curve at which the rays of an image row bend alike.
const ALIKE: f64 = 1e-12;

/// A view split into smooth displacements, which bend rays, and the displacement of the ground, which is applied to the ground instead.
///
/// Earth curvature and terrain disocclusion both move points of a vertical line alike, so their order does not matter and the
/// latter may be left on the ground: there it is a height per point of the map, kinks and all, and no curve has to follow it.
pub struct Split<'a> {
    pub(crate) view: Cow<'a, View>,
    smooth: View,
    /// The displacement of the ground.
    pub ground: Option<&'a TerrainDisocclusion>,
    earth: Option<Parabola>,
    bend: Option<&'a SplineBend>,
    straightened: Option<(&'a Stage, View)>,
    circle: Option<Unroll>,
    kind: Kind,
}

/// Shape of the rays, beside the earth's curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Straight or curved rays: pieces in closed form.
    Pieces,
    /// A spline whose curve lies across the image's rows.
    Rows,
    /// A circle around the eye is unrolled: straight rays.
    Circle,
    /// Any other stages.
    Any,
}

/// Inverse of the earth's curvature: heights grow with the square of the distance from the eye.
#[derive(Debug, Clone, Copy)]
struct Parabola {
    eye: DVec2,
    factor: f64,
}

impl Parabola {
    fn new(earth: &EarthCurvature) -> Self {
        Self { eye: earth.eye.truncate(), factor: (1.0 - earth.refraction) / (2.0 * earth.radius) }
    }

    fn raise(self, p: DVec3) -> DVec3 {
        p + self.factor * (p.truncate() - self.eye).length_squared() * DVec3::Z
    }

    /// Bound on the distance from the raised chord of a curve within `reach` of the chord `a b`.
    ///
    /// On the chord the square deviates by at most a quarter of the squared length, beside it by `2 r |p - eye| + r^2`.
    fn reach(self, a: DVec3, b: DVec3, reach: f64) -> f64 {
        let (a, b) = (a.truncate(), b.truncate());
        let far = a.distance(self.eye).max(b.distance(self.eye));
        reach + self.factor.abs() * (0.25 * a.distance_squared(b) + reach * (2.0 * far + reach))
    }
}

impl<'a> Split<'a> {
    /// Splits a view.
    pub fn new(view: &'a View) -> Self {
        Self::of(Cow::Borrowed(view), view.ground(), view.straightener(), view.spline_bend())
    }

    /// For a view of carried rigid bodies, bent by curved rays alone.
    pub(crate) fn after_bodies(view: View) -> Self {
        Self::of(Cow::Owned(view), None, None, None)
    }

    fn of(
        view: Cow<'a, View>,
        ground: Option<&'a TerrainDisocclusion>,
        straightened: Option<&'a Stage>,
        bend: Option<&'a SplineBend>,
    ) -> Self {
        let stages: Vec<Stage> =
            view.stages().iter().filter(|s| !matches!(Fast::of(s), Fast::Ground(_))).cloned().collect();
        let earth = view.earth().map(Parabola::new);
        let straightened = straightened.and_then(|stage| {
            let later = view.stages().iter().skip_while(|s| !s.has_border()).skip(1).cloned().collect();
            // The tail of a chain is a valid chain.
            Some((stage, View::new(view.pinhole().clone(), later).ok()?))
        });
        let unknown = stages.iter().any(|s| matches!(Fast::of(s), Fast::None | Fast::Circle(_)) && !s.bends_rays());
        let circle = match stages.iter().map(Fast::of).filter(|s| !matches!(s, Fast::Earth(_))).collect::<Vec<_>>()[..]
        {
            [Fast::Circle(circle)] => Some(*circle),
            _ => None,
        };
        let kind = match (bend, stages.iter().any(Stage::bends_rays)) {
            _ if circle.is_some() => Kind::Circle,
            _ if unknown => Kind::Any,
            (None, _) => Kind::Pieces,
            (Some(bend), false) => {
                let across = |axis: DVec3| view.pinhole().right.dot(axis).abs() <= ALIKE;
                if bend.curve_axes().into_iter().all(across) { Kind::Rows } else { Kind::Any }
            }
            _ => Kind::Any,
        };
        // A chain without one of its stages is valid if the chain is.
        let smooth = View::new(view.pinhole().clone(), stages).unwrap_or_else(|_| view.as_ref().clone());
        Self { view, smooth, ground, earth, bend, straightened, circle, kind }
    }

    /// Height by which the ground at a point is displaced, scene units.
    pub fn lift(&self, p: DVec3) -> f64 {
        self.ground.map_or(0.0, |g| g.delta_at(p))
    }

    /// Bound on the absolute lift of the ground between two points.
    pub fn most_lift(&self, a: DVec3, b: DVec3) -> f64 {
        self.ground.map_or(0.0, |g| {
            let (min, max) = (a.min(b).truncate(), a.max(b).truncate());
            let [lo, hi] = g.grid().range_over(min, max).unwrap_or([0.0; 2]);
            lo.abs().max(hi.abs())
        })
    }

    /// Shape common to the rays of an image row (`y` in pixels), over a range of depths.
    pub fn row(&self, y: f64, range: [f64; 2]) -> Option<Row<'a>> {
        let bend = self.bend.filter(|_| self.kind == Kind::Rows)?;
        Some(Row::new(bend, self.view.pinhole(), y, range))
    }

    /// The ray of a pixel; `row` is the common shape of its image row.
    pub fn curve<'s>(&'s self, pixel: DVec2, row: Option<&'s Row<'a>>) -> Curve<'s, 'a> {
        let ray = self.smooth.ray(pixel);
        let shape = match (self.kind, row) {
            (Kind::Rows, Some(row)) => Curved::Row { row, lateral: row.lateral(self.view.pinhole().line(pixel)) },
            (Kind::Circle, _) => {
                let (from, per_depth) = self.view.pinhole().line(pixel);
                match self.circle.map(|circle| circle.straight_ray(from, per_depth)) {
                    Some(Ok(line)) => Curved::Pieces(line.into_iter().map(straight).collect()),
                    _ => Curved::Any(ray),
                }
            }
            (Kind::Pieces, _) => match ray.pieces() {
                Ok(pieces) => Curved::Pieces(pieces),
                Err(_) => Curved::Any(ray),
            },
            _ => Curved::Any(ray),
        };
        let earth = if matches!(shape, Curved::Any(_)) { None } else { self.earth };
        let straightened = self.straightened.as_ref().map(|(stage, later)| (*stage, later.ray(pixel)));
        Curve { shape, earth, straightened }
    }

    /// Whether the rays of a row lie evenly on a line at every depth, so that space clear between two of them is clear for all between.
    pub(crate) fn rows_are_straight(&self) -> bool {
        self.kind == Kind::Rows || (self.kind == Kind::Pieces && !self.view.stages().iter().any(|s| s.bends_rays()))
    }

    /// Largest height of two points of a row at one depth above the rays between them, due to the earth's curvature, scene units.
    pub(crate) fn sag(&self, a: DVec3, b: DVec3) -> f64 {
        self.earth.map_or(0.0, |e| 0.25 * e.factor.abs() * (a - b).truncate().length_squared())
    }
}

/// One straight piece, by its point and step per unit of depth.
fn straight([from, per_depth]: [DVec3; 2]) -> RayPiece {
    RayPiece { segment: 0, depth: [0.0, f64::INFINITY], shape: Shape::Line { from, per_depth } }
}

/// A ray.
pub struct Curve<'s, 'a> {
    shape: Curved<'s, 'a>,
    earth: Option<Parabola>,
    /// The stage that straightens a strip or tube, and the ray up to it.
    straightened: Option<(&'a Stage, RayPath<'s>)>,
}

enum Curved<'s, 'a> {
    /// Straight, conic and other pieces.
    Pieces(Vec<RayPiece>),
    /// The common shape of the row, and the ray's position across it: at depth 0 and per unit of depth.
    Row { row: &'s Row<'a>, lateral: [f64; 2] },
    /// Points by the inverse of the stages.
    Any(RayPath<'s>),
}

/// Part of a ray and its chord.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    /// Depths at which it begins and ends, scene units.
    pub depth: [f64; 2],
    /// Points of the ray at these depths; `None` where it has none.
    ends: [Option<DVec3>; 2],
    /// Bound on the distance between ray and chord at equal shares of the depths, scene units.
    pub reach: f64,
    /// Number of the piece, or of the node of the row.
    at: u32,
}

impl Span {
    /// Ends of the chord; `None` where the ray has none.
    pub fn chord(&self) -> Option<(DVec3, DVec3)> {
        Some((self.ends[0]?, self.ends[1]?))
    }

    /// Whether the ray has a point at one of its ends.
    pub fn has_point(&self) -> bool {
        self.ends.iter().any(Option::is_some)
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.reach == 0.0
    }

    pub(crate) fn depth_at(&self, t: f64) -> f64 {
        self.depth[0] + t * (self.depth[1] - self.depth[0])
    }
}

impl Curve<'_, '_> {
    /// Point at a depth; `None` where the ray has none.
    pub(crate) fn at(&self, depth: f64) -> Option<DVec3> {
        let p = match &self.shape {
            Curved::Pieces(pieces) => {
                let piece = pieces.iter().find(|p| depth <= p.depth[1])?;
                piece.at(depth)
            }
            Curved::Row { row, lateral } => row.at(depth, lateral[0] + depth * lateral[1])?,
            Curved::Any(ray) => return ray.at(depth).ok().map(|p| p.point),
        };
        Some(self.raised(p))
    }

    /// Whether the ray may have points between two depths at which it has none; `None` where there is no strip or tube to tell.
    ///
    /// Up to it the ray is nearly straight: it stays no farther from the middle of the span than its ends.
    pub fn may_enter(&self, span: &Span) -> Option<bool> {
        let (stage, before) = self.straightened.as_ref()?;
        let at = |w: f64| before.at(w).ok().map(|p| p.point);
        stage.may_hold([at(span.depth[0])?, at(span.depth_at(0.5))?, at(span.depth[1])?])
    }

    /// Segment of the ray at a depth, see [`belvedere_core::Displaced::segment`].
    pub(crate) fn segment(&self, depth: f64) -> u32 {
        match &self.shape {
            Curved::Pieces(pieces) => pieces.iter().find(|p| depth <= p.depth[1]).map_or(0, |p| p.segment),
            Curved::Row { .. } => 0,
            Curved::Any(ray) => ray.at(depth).map_or(0, |p| p.segment),
        }
    }

    fn raised(&self, p: DVec3) -> DVec3 {
        self.earth.map_or(p, |earth| earth.raise(p))
    }

    /// Spans that cover a range of depths, in order.
    pub fn spans(&self, [near, far]: [f64; 2]) -> Vec<Span> {
        match &self.shape {
            Curved::Pieces(pieces) => {
                let parts = pieces.iter().enumerate().filter_map(|(i, piece)| {
                    let [a, b] = [piece.depth[0].max(near), piece.depth[1].min(far)];
                    (a < b).then(|| self.piece_span(i, [a, b], [piece.at(a), piece.at(b)]))
                });
                parts.collect()
            }
            Curved::Row { .. } => self.row_span(0).into_iter().collect(),
            Curved::Any(ray) => {
                let depth = |i: usize| near + (far - near) * i as f64 / SPANS as f64;
                (0..SPANS).map(|i| sampled(ray, [depth(i), depth(i + 1)])).collect()
            }
        }
    }

    /// Both halves of a span.
    pub fn halves(&self, span: &Span) -> Vec<Span> {
        let [a, b] = span.depth;
        let middle = 0.5 * (a + b);
        match &self.shape {
            Curved::Pieces(pieces) => {
                let piece = &pieces[span.at as usize];
                let [p, q, r] = [a, middle, b].map(|w| piece.at(w));
                let i = span.at as usize;
                vec![self.piece_span(i, [a, middle], [p, q]), self.piece_span(i, [middle, b], [q, r])]
            }
            Curved::Row { row, .. } => {
                row.children(span.at).into_iter().flatten().filter_map(|i| self.row_span(i)).collect()
            }
            Curved::Any(ray) => vec![sampled(ray, [a, middle]), sampled(ray, [middle, b])],
        }
    }

    fn piece_span(&self, i: usize, depth: [f64; 2], ends: [DVec3; 2]) -> Span {
        let Curved::Pieces(pieces) = &self.shape else { return sampled_nothing(depth) };
        let reach = match &pieces[i].shape {
            Shape::Line { .. } => 0.0,
            Shape::Conic(arc) => {
                let u = depth.map(|w| arc.parameter(w));
                conic_reach(arc.curve.weight, [arc.curve.t, arc.curve.s, arc.curve.q], arc.depths, u, ends, depth)
            }
            Shape::C2(_) => bow(|w| Some(pieces[i].at(w)), depth, ends),
        };
        // Allows for rounding of the points themselves.
        let reach = if reach > 0.0 { reach + 1e-13 * ends[0].abs().max(ends[1].abs()).max_element() } else { 0.0 };
        self.finished(depth, ends, reach, i as u32)
    }

    fn row_span(&self, i: u32) -> Option<Span> {
        let Curved::Row { row, lateral } = &self.shape else { return None };
        let node = row.node(i);
        let across = node.depth.map(|w| lateral[0] + w * lateral[1]);
        match node.ends {
            [Some(a), Some(b)] => {
                let ends = [row.world_point(a, across[0]), row.world_point(b, across[1])];
                Some(self.finished(node.depth, ends, node.reach, i))
            }
            [a, b] => {
                let ends = [a.map(|p| row.world_point(p, across[0])), b.map(|p| row.world_point(p, across[1]))];
                Some(Span { depth: node.depth, ends, reach: f64::INFINITY, at: i })
            }
        }
    }

    fn finished(&self, depth: [f64; 2], ends: [DVec3; 2], reach: f64, at: u32) -> Span {
        let reach = self.earth.map_or(reach, |earth| earth.reach(ends[0], ends[1], reach));
        Span { depth, ends: ends.map(|p| Some(self.raised(p))), reach, at }
    }
}

fn sampled_nothing(depth: [f64; 2]) -> Span {
    Span { depth, ends: [None; 2], reach: f64::INFINITY, at: 0 }
}

/// A span of a ray of unknown shape: its reach is an estimate, see [`bow`].
fn sampled(ray: &RayPath<'_>, depth: [f64; 2]) -> Span {
    let at = |w: f64| ray.at(w).ok().map(|p| p.point);
    let ends = depth.map(at);
    let [Some(a), Some(b)] = ends else { return Span { ends, ..sampled_nothing(depth) } };
    let rounding = 1e-12 * a.abs().max(b.abs()).max_element();
    Span { depth, ends, reach: bow(at, depth, [a, b]) + rounding, at: 0 }
}

/// Estimated distance of a curve from its chord, from three inner points: infinite if one of them is missing.
///
/// For a parabola the quarters have exactly the largest distance, for a cubic 97 % of it, for a kink three quarters: 1.5 times as much
/// is a bound for all three, and an estimate for other curves.
fn bow(at: impl Fn(f64) -> Option<DVec3>, [w0, w1]: [f64; 2], [a, b]: [DVec3; 2]) -> f64 {
    let off = |t: f64| at(w0 + t * (w1 - w0)).map_or(f64::INFINITY, |p| p.distance(a.lerp(b, t)));
    1.5 * [0.25, 0.5, 0.75].into_iter().map(off).fold(0.0, f64::max)
}

/// Largest distance between a conic arc and its chord at equal shares of the depths: exact.
///
/// Points and depths of the arc form one rational curve in four dimensions, and so does its part between two parameters, with a middle
/// control point `C` of weight `w`. The distance is affine, 0 at both ends and `D` at `C`, so it is `D` times the share of the middle Bernstein
/// term, at most `w / (1 + w)`. Source: ours, by the blossom of Farin.
fn conic_reach(
    weight: f64,
    points: [DVec3; 3],
    depths: [f64; 3],
    [u0, u1]: [f64; 2],
    [a, b]: [DVec3; 2],
    depth: [f64; 2],
) -> f64 {
    let blossom = |u: f64, v: f64| {
        let (p, q) = (1.0 - u, 1.0 - v);
        [p * q, weight * (p * v + q * u), u * v]
    };
    let sum = |b: [f64; 3]| b[0] + b[1] + b[2];
    let middle = blossom(u0, u1);
    let total = sum(middle);
    let relative = points.map(|p| p - a);
    let c = (middle[0] * relative[0] + middle[1] * relative[1] + middle[2] * relative[2]) / total;
    let w = (middle[0] * depths[0] + middle[1] * depths[1] + middle[2] * depths[2]) / total;
    let off = c - (b - a) * ((w - depth[0]) / (depth[1] - depth[0]));
    let w = total / (sum(blossom(u0, u0)) * sum(blossom(u1, u1))).sqrt();
    let reach = off.length() * w / (1.0 + w);
    if reach.is_nan() { f64::INFINITY } else { reach }
}

#[cfg(test)]
mod tests;
