//! Curves in plan of piecewise linear curvature (clothoids), with straight ends.

use super::tree::{Discs, Node};
use glam::DVec2;

/// A plane curve over its arc length `g` whose curvature is linear between evenly spaced nodes and 0 at both ends (clothoids joined with
/// continuous curvature); beyond its ends it goes on straight. Positions, tangents and curvatures belong together to rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanCurve {
    /// Scene position to which the nodes are relative.
    origin: DVec2,
    /// Arc length between nodes, scene units.
    spacing: f64,
    curvature: Vec<f64>,
    nodes: Vec<Node>,
    discs: Discs,
    /// Whether it is a line.
    straight: bool,
    /// First and last arc length at which the strip around the curve is still single, scene units.
    reach: [f64; 2],
}

/// Position, tangent and curvature at a point of a [`PlanCurve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanFrame {
    /// Position, scene coordinates.
    pub p: DVec2,
    /// Unit tangent.
    pub tangent: DVec2,
    /// Curvature, 1 / scene unit; positive where the curve turns left.
    pub curvature: f64,
}

impl PlanFrame {
    /// Unit normal, to the left.
    pub fn normal(&self) -> DVec2 {
        self.tangent.perp()
    }
}

/// Arc length of the foot of a point and its distance to the left of the curve there, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripPoint {
    /// Arc length; below 0 and above the curve's length on its straight ends.
    pub g: f64,
    /// Signed distance, positive to the left.
    pub a: f64,
}

/// Nodes and weights of the Gauss-Legendre rule with four points on 0..=1.
const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_1],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_1],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

impl PlanCurve {
    /// The curve with these curvatures at nodes `spacing` apart that has the position and tangent `frame` at arc length `g`.
    ///
    /// `spacing` times the largest curvature must not exceed 0.06, so that quadrature is exact to rounding.
    pub(super) fn through(curvature: Vec<f64>, spacing: f64, g: f64, frame: (DVec2, DVec2)) -> Self {
        let (p, tangent) = frame;
        let last = curvature.len() - 1;
        let i = ((g / spacing).floor().max(0.0) as usize).min(last.saturating_sub(1));
        let piece = |i: usize| [curvature[i], curvature[i + 1]];
        let mut nodes = vec![Node { p: DVec2::ZERO, tangent }; last + 1];
        // Backwards to the node before the frame, then on from there.
        let s = g.min(last as f64 * spacing) - i as f64 * spacing;
        let straight = g - i as f64 * spacing - s;
        nodes[i] = if s < 0.0 {
            Node { p: -s * tangent, tangent }
        } else {
            let at = advance(piece(i), spacing, s);
            let tangent = tangent.rotate(at.turned.conjugate());
            Node { p: -at.way.rotate(tangent) - straight * at.turned.rotate(tangent), tangent }
        };
        for k in i..last {
            let at = advance(piece(k), spacing, spacing);
            let from = nodes[k];
            nodes[k + 1] =
                Node { p: from.p + at.way.rotate(from.tangent), tangent: at.turned.rotate(from.tangent).normalize() };
        }
        for k in (0..i).rev() {
            let at = advance(piece(k), spacing, spacing);
            let to = nodes[k + 1];
            let tangent = to.tangent.rotate(at.turned.conjugate()).normalize();
            nodes[k] = Node { p: to.p - at.way.rotate(tangent), tangent };
        }
        let discs = Discs::new(&nodes, spacing, &curvature);
        let straight = curvature.iter().all(|k| *k == 0.0);
        Self { origin: p, spacing, curvature, nodes, discs, straight, reach: [f64::NEG_INFINITY, f64::INFINITY] }
    }

    pub(super) fn with_reach(self, reach: [f64; 2]) -> Self {
        Self { reach, ..self }
    }

    /// The same curve with its curvature scaled, through its own frame at `g`.
    pub(super) fn unbent(&self, factor: f64, g: f64) -> Self {
        let frame = self.at(g);
        let curvature = self.curvature.iter().map(|k| factor * k).collect();
        Self::through(curvature, self.spacing, g, (frame.p, frame.tangent)).with_reach(self.reach)
    }

    /// Length between the straight ends, scene units.
    pub fn length(&self) -> f64 {
        (self.curvature.len() - 1) as f64 * self.spacing
    }

    /// First and last arc length of the domain, outside which [`super::Strip`] has no image.
    pub fn reach(&self) -> [f64; 2] {
        self.reach
    }

    /// Arc length between nodes, scene units.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Curvatures at the nodes, 1 / scene unit.
    pub fn curvature(&self) -> &[f64] {
        &self.curvature
    }

    /// Largest curvature, 1 / scene unit.
    pub fn largest_curvature(&self) -> f64 {
        self.curvature.iter().fold(0.0, |most, k| most.max(k.abs()))
    }

    /// Positions of the nodes, scene coordinates.
    pub fn positions(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.nodes.iter().map(|n| self.origin + n.p)
    }

    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub(super) fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Number of the last piece.
    fn last(&self) -> usize {
        self.nodes.len() - 2
    }

    /// Piece and arc length within it.
    fn piece(&self, g: f64) -> (usize, f64) {
        let i = ((g / self.spacing).floor().max(0.0) as usize).min(self.last());
        (i, g - i as f64 * self.spacing)
    }

    /// The frame at arc length `g`, finite.
    pub fn at(&self, g: f64) -> PlanFrame {
        let frame = self.relative(g);
        PlanFrame { p: self.origin + frame.p, ..frame }
    }

    /// The frame at arc length `g`, relative to the origin.
    pub(super) fn relative(&self, g: f64) -> PlanFrame {
        let length = self.length();
        if g <= 0.0 || g >= length {
            let (node, by) = if g <= 0.0 { (self.nodes[0], g) } else { (self.nodes[self.last() + 1], g - length) };
            return PlanFrame { p: node.p + by * node.tangent, tangent: node.tangent, curvature: 0.0 };
        }
        let (i, s) = self.piece(g);
        self.on_piece(i, s)
    }

    fn on_piece(&self, i: usize, s: f64) -> PlanFrame {
        let (node, k) = (self.nodes[i], [self.curvature[i], self.curvature[i + 1]]);
        let at = advance(k, self.spacing, s);
        PlanFrame {
            p: node.p + at.way.rotate(node.tangent),
            tangent: at.turned.rotate(node.tangent),
            curvature: k[0] + (k[1] - k[0]) * (s / self.spacing),
        }
    }

    /// The foot of `p` within `width` of the curve and its straight ends, if there is one inside [`PlanCurve::reach`]. Unique where the
    /// strip of that width is single.
    pub fn foot(&self, p: DVec2, width: f64) -> Option<StripPoint> {
        let q = p - self.origin;
        let inside = |foot: &StripPoint| foot.a.abs() <= width && foot.g >= self.reach[0] && foot.g <= self.reach[1];
        if self.straight {
            return Some(self.beside_start(q)).filter(inside);
        }
        self.on_end(q).into_iter().flatten().find(inside).or_else(|| self.foot_between(q, width).filter(inside))
    }

    /// The foot on the line through the start.
    fn beside_start(&self, q: DVec2) -> StripPoint {
        let (first, v) = (self.nodes[0], q - self.nodes[0].p);
        StripPoint { g: v.dot(first.tangent), a: first.tangent.perp_dot(v) }
    }

    /// Feet on the straight ends.
    pub(super) fn on_end(&self, q: DVec2) -> [Option<StripPoint>; 2] {
        let last = self.nodes[self.last() + 1];
        let (before, w) = (self.beside_start(q), q - last.p);
        let beyond = StripPoint { g: w.dot(last.tangent), a: last.tangent.perp_dot(w) };
        [
            (before.g <= 0.0).then_some(before),
            (beyond.g >= 0.0).then_some(StripPoint { g: beyond.g + self.length(), ..beyond }),
        ]
    }

    /// Foot of the perpendicular from `q` between the ends, on a piece with `q` ahead of its start and behind its end.
    fn foot_between(&self, q: DVec2, width: f64) -> Option<StripPoint> {
        let ahead = |i: usize| (q - self.nodes[i].p).dot(self.nodes[i].tangent);
        self.discs.find(q, width, &ahead, &mut |i| {
            Some(self.foot_on(q, i, [ahead(i), ahead(i + 1)])).filter(|foot| foot.a.abs() <= width)
        })
    }

    /// Foot on piece `i` by Newton's iteration in a bracket. `ends`: distances by which `q` lies ahead of the piece's ends.
    fn foot_on(&self, q: DVec2, i: usize, ends: [f64; 2]) -> StripPoint {
        let [mut low, mut high] = [0.0, self.spacing];
        let mut s = if ends[0] > ends[1] { self.spacing * ends[0] / (ends[0] - ends[1]) } else { 0.5 * high };
        let mut frame = self.on_piece(i, s);
        for _ in 0..60 {
            let v = q - frame.p;
            let ahead = v.dot(frame.tangent);
            if ahead > 0.0 {
                low = s
            } else {
                high = s
            }
            let newton = s + ahead / (1.0 - frame.curvature * frame.tangent.perp_dot(v));
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let step = next - s;
            s = next;
            frame = self.on_piece(i, s);
            // Quadratic convergence: the next step would be below rounding.
            if step.abs() <= 1e-7 * self.spacing {
                break;
            }
        }
        StripPoint { g: i as f64 * self.spacing + s, a: frame.tangent.perp_dot(q - frame.p) }
    }

    /// Arc length, between the ends, of the curve's point nearest to `p`.
    pub fn nearest(&self, p: DVec2) -> f64 {
        let q = p - self.origin;
        let near = self.discs.nearest(q).0;
        let ahead = |i: usize| (q - self.nodes[i].p).dot(self.nodes[i].tangent);
        let places = (near.saturating_sub(1)..=(near + 1).min(self.last())).flat_map(|i| {
            let ends = [ahead(i), ahead(i + 1)];
            let start = i as f64 * self.spacing;
            let foot = (ends[0] >= 0.0 && ends[1] <= 0.0).then(|| self.foot_on(q, i, ends).g);
            foot.into_iter().chain([start, start + self.spacing])
        });
        let off = |g: f64| self.relative(g).p.distance_squared(q);
        places.fold((0.0, f64::INFINITY), |best, g| if off(g) < best.1 { (g, off(g)) } else { best }).0
    }

    /// Whether the curve or its straight ends may come within `width` of a point; never wrongly false.
    pub(super) fn may_come_within(&self, p: DVec2, width: f64) -> bool {
        let q = p - self.origin;
        if self.straight {
            return self.beside_start(q).a.abs() <= width;
        }
        self.on_end(q).into_iter().flatten().any(|foot| foot.a.abs() <= width) || self.discs.come_within(q, width)
    }

    /// Lower bound on the distance of `p` from the curve and its straight ends, below the true one by at most half the node spacing.
    pub fn distance(&self, p: DVec2) -> f64 {
        let q = p - self.origin;
        if self.straight {
            return self.beside_start(q).a.abs();
        }
        let ends = self.on_end(q).into_iter().flatten().map(|foot| foot.a.abs());
        let between = (self.discs.nearest(q).1 - 0.5 * self.spacing).max(0.0);
        ends.fold(between, f64::min)
    }

    /// Largest curvature and largest change of it between two arc lengths, 1 / scene unit and its square.
    pub(super) fn most(&self, from: f64, to: f64) -> [f64; 2] {
        if !(to > 0.0 && from < self.length()) {
            return [0.0; 2];
        }
        let (first, last) = (self.piece(from.max(0.0)).0, self.piece(to.min(self.length())).0);
        (first..=last).fold([0.0f64; 2], |[k, change], i| {
            let [a, b] = [self.curvature[i], self.curvature[i + 1]];
            [k.max(a.abs()).max(b.abs()), change.max((b - a).abs() / self.spacing)]
        })
    }
}

/// Displacement and turn along a piece from its start, whose tangent is (1, 0).
struct Advance {
    way: DVec2,
    /// Cosine and sine of the angle that it turns by.
    turned: DVec2,
}

trait Conjugate {
    fn conjugate(self) -> Self;
}

impl Conjugate for DVec2 {
    fn conjugate(self) -> Self {
        Self::new(self.x, -self.y)
    }
}

fn advance([k0, k1]: [f64; 2], spacing: f64, s: f64) -> Advance {
    let rate = 0.5 * (k1 - k0) / spacing;
    let angle = |t: f64| t * (k0 + rate * t);
    let way = GAUSS.iter().map(|[at, weight]| *weight * DVec2::from_angle(angle(at * s))).sum::<DVec2>();
    Advance { way: s * way, turned: DVec2::from_angle(angle(s)) }
}
