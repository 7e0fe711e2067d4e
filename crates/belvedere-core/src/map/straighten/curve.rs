//! Curves of piecewise linear curvature, with straight ends.

use super::dimension::{Across, Dimension, Vector};
use super::tree::Balls;

/// A curve over its arc length `g` whose curvature is linear between evenly spaced nodes and 0 at both ends (in plan: clothoids joined with
/// continuous curvature); beyond its ends it goes on straight. Positions, frames and curvatures belong together to rounding in plan, in
/// space to the fourth power of the turn between nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<D: Dimension> {
    /// Scene position to which the nodes are relative.
    origin: D::Vector,
    /// Arc length between nodes, scene units.
    spacing: f64,
    curvature: Vec<D::Across>,
    nodes: Vec<Node<D>>,
    balls: Balls<D::Vector>,
    /// Whether it is a line.
    straight: bool,
    /// First and last arc length at which what lies around the curve is still single, scene units.
    reach: [f64; 2],
}

/// Position, relative to the curve's origin, and frame at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node<D: Dimension> {
    pub(super) p: D::Vector,
    pub(super) turn: D::Turn,
}

/// Position, frame and curvature at a point of a [`Curve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<D: Dimension> {
    /// Position, scene coordinates.
    pub p: D::Vector,
    /// Turn of the frame: its first axis is the tangent.
    pub turn: D::Turn,
    /// Curvature, 1 / scene unit, along the other axes.
    pub curvature: D::Across,
}

impl<D: Dimension> Frame<D> {
    /// Unit tangent.
    pub fn tangent(&self) -> D::Vector {
        D::vector(self.turn, 1.0, D::Across::default())
    }

    /// The point with this offset from the curve, scene units.
    pub fn beside(&self, across: D::Across) -> D::Vector {
        self.p + D::vector(self.turn, 0.0, across)
    }
}

/// Arc length of the foot of a point and its offset from the curve there, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot<D: Dimension> {
    /// Arc length; below 0 and above the curve's length on its straight ends.
    pub g: f64,
    /// Offset; in plan positive to the left.
    pub a: D::Across,
}

impl<D: Dimension> Curve<D> {
    /// The curve with these curvatures at nodes `spacing` apart that has the position and turn `frame` at arc length `g`.
    ///
    /// `spacing` times the largest curvature must not exceed 0.06, so that quadrature is exact to rounding.
    pub(super) fn through(curvature: Vec<D::Across>, spacing: f64, g: f64, frame: (D::Vector, D::Turn)) -> Self {
        let (p, turn) = frame;
        let last = curvature.len() - 1;
        let i = ((g / spacing).floor().max(0.0) as usize).min(last.saturating_sub(1));
        let piece = |i: usize| [curvature[i], curvature[i + 1]];
        let ahead = |turn: D::Turn, by: f64| D::vector(turn, by, D::Across::default());
        let mut nodes = vec![Node { p: D::Vector::default(), turn }; last + 1];
        // Backwards to the node before the frame, then on from there.
        let s = g.min(last as f64 * spacing) - i as f64 * spacing;
        let straight = g - i as f64 * spacing - s;
        nodes[i] = if s < 0.0 {
            Node { p: ahead(turn, -s), turn }
        } else {
            let (way, turned) = D::advance(piece(i), spacing, s);
            let before = D::then(turn, D::back(turned));
            Node { p: -D::turned(before, way) - ahead(turn, straight), turn: before }
        };
        for k in i..last {
            let (way, turned) = D::advance(piece(k), spacing, spacing);
            let from = nodes[k];
            nodes[k + 1] = Node { p: from.p + D::turned(from.turn, way), turn: D::then(from.turn, turned) };
        }
        for k in (0..i).rev() {
            let (way, turned) = D::advance(piece(k), spacing, spacing);
            let turn = D::then(nodes[k + 1].turn, D::back(turned));
            nodes[k] = Node { p: nodes[k + 1].p - D::turned(turn, way), turn };
        }
        let places: Vec<D::Vector> = nodes.iter().map(|n| n.p).collect();
        let bends: Vec<f64> = curvature.iter().map(|k| k.length()).collect();
        let balls = Balls::new(&places, spacing, &bends);
        let straight = bends.iter().all(|k| *k == 0.0);
        Self { origin: p, spacing, curvature, nodes, balls, straight, reach: [f64::NEG_INFINITY, f64::INFINITY] }
    }

    pub(super) fn with_reach(self, reach: [f64; 2]) -> Self {
        Self { reach, ..self }
    }

    /// The same curve with its curvature scaled, through its own frame at `g`.
    pub(super) fn unbent(&self, factor: f64, g: f64) -> Self {
        let frame = self.at(g);
        let curvature = self.curvature.iter().map(|k| *k * factor).collect();
        Self::through(curvature, self.spacing, g, (frame.p, frame.turn)).with_reach(self.reach)
    }

    /// Length between the straight ends, scene units.
    pub fn length(&self) -> f64 {
        (self.curvature.len() - 1) as f64 * self.spacing
    }

    /// First and last arc length of the domain, outside which [`super::Straightened`] has no image.
    pub fn reach(&self) -> [f64; 2] {
        self.reach
    }

    /// Arc length between nodes, scene units.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Curvatures at the nodes, 1 / scene unit.
    pub fn curvature(&self) -> &[D::Across] {
        &self.curvature
    }

    /// Largest curvature, 1 / scene unit.
    pub fn largest_curvature(&self) -> f64 {
        self.curvature.iter().fold(0.0, |most, k| most.max(k.length()))
    }

    /// Positions of the nodes, scene coordinates.
    pub fn positions(&self) -> impl Iterator<Item = D::Vector> + '_ {
        self.nodes.iter().map(|n| self.origin + n.p)
    }

    pub(super) fn nodes(&self) -> &[Node<D>] {
        &self.nodes
    }

    pub(super) fn origin(&self) -> D::Vector {
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
    pub fn at(&self, g: f64) -> Frame<D> {
        let frame = self.relative(g);
        Frame { p: self.origin + frame.p, ..frame }
    }

    /// The frame at arc length `g`, relative to the origin.
    pub(super) fn relative(&self, g: f64) -> Frame<D> {
        let length = self.length();
        if g <= 0.0 || g >= length || self.straight {
            let (node, by) =
                if g <= 0.0 || self.straight { (self.nodes[0], g) } else { (self.nodes[self.last() + 1], g - length) };
            let p = node.p + D::vector(node.turn, by, D::Across::default());
            return Frame { p, turn: node.turn, curvature: D::Across::default() };
        }
        let (i, s) = self.piece(g);
        self.on_piece(i, s)
    }

    fn on_piece(&self, i: usize, s: f64) -> Frame<D> {
        let (node, k) = (self.nodes[i], [self.curvature[i], self.curvature[i + 1]]);
        let (way, turned) = D::advance(k, self.spacing, s);
        Frame {
            p: node.p + D::turned(node.turn, way),
            turn: D::then(node.turn, turned),
            curvature: k[0] + (k[1] - k[0]) * (s / self.spacing),
        }
    }

    /// The foot of `p` within `width` of the curve and its straight ends, if there is one inside [`Curve::reach`]. Unique where what
    /// lies so near is single.
    pub fn foot(&self, p: D::Vector, width: f64) -> Option<Foot<D>> {
        let q = p - self.origin;
        let inside = |foot: &Foot<D>| foot.a.length() <= width && foot.g >= self.reach[0] && foot.g <= self.reach[1];
        if self.straight {
            return Some(self.beside_start(q)).filter(inside);
        }
        self.on_end(q).into_iter().flatten().find(inside).or_else(|| self.foot_between(q, width).filter(inside))
    }

    /// The foot on the line through the start.
    fn beside_start(&self, q: D::Vector) -> Foot<D> {
        let (g, a) = D::parts(self.nodes[0].turn, q - self.nodes[0].p);
        Foot { g, a }
    }

    /// Feet on the straight ends.
    pub(super) fn on_end(&self, q: D::Vector) -> [Option<Foot<D>>; 2] {
        let last = self.nodes[self.last() + 1];
        let (before, (g, a)) = (self.beside_start(q), D::parts(last.turn, q - last.p));
        [(before.g <= 0.0).then_some(before), (g >= 0.0).then_some(Foot { g: g + self.length(), a })]
    }

    /// Foot of the perpendicular from `q` between the ends, on a piece with `q` ahead of its start and behind its end.
    fn foot_between(&self, q: D::Vector, width: f64) -> Option<Foot<D>> {
        let ahead = |i: usize| D::parts(self.nodes[i].turn, q - self.nodes[i].p).0;
        self.balls.find(q, width, &ahead, &mut |i| {
            Some(self.foot_on(q, i, [ahead(i), ahead(i + 1)])).filter(|foot| foot.a.length() <= width)
        })
    }

    /// Foot on piece `i` by Newton's iteration in a bracket. `ends`: distances by which `q` lies ahead of the piece's ends.
    fn foot_on(&self, q: D::Vector, i: usize, ends: [f64; 2]) -> Foot<D> {
        let [mut low, mut high] = [0.0, self.spacing];
        let mut s = if ends[0] > ends[1] { self.spacing * ends[0] / (ends[0] - ends[1]) } else { 0.5 * high };
        let mut frame = self.on_piece(i, s);
        for _ in 0..60 {
            let (ahead, across) = D::parts(frame.turn, q - frame.p);
            if ahead > 0.0 {
                low = s
            } else {
                high = s
            }
            let newton = s + ahead / (1.0 - frame.curvature.dot(across));
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let step = next - s;
            s = next;
            frame = self.on_piece(i, s);
            // Quadratic convergence: the next step would be below rounding.
            if step.abs() <= 1e-7 * self.spacing {
                break;
            }
        }
        Foot { g: i as f64 * self.spacing + s, a: D::parts(frame.turn, q - frame.p).1 }
    }

    /// Arc length, between the ends, of the curve's point nearest to `p`.
    pub fn nearest(&self, p: D::Vector) -> f64 {
        self.closest_between(p - self.origin).1.g
    }

    /// The foot of `p` at the nearest point of the curve; `None` if that is an end that `p` lies beyond.
    pub(super) fn closest(&self, p: D::Vector) -> Option<Foot<D>> {
        let q = p - self.origin;
        if self.straight {
            return Some(self.beside_start(q));
        }
        let (distance, foot) = self.closest_between(q);
        (foot.a.length() >= distance - 1e-6 * self.spacing).then_some(foot)
    }

    /// Distance and foot of the nearest point between the ends.
    fn closest_between(&self, q: D::Vector) -> (f64, Foot<D>) {
        let at_node =
            |i: usize, across: D::Across| (self.nodes[i].p.distance(q), Foot { g: i as f64 * self.spacing, a: across });
        let ask = |i: usize, best: f64| {
            let [from, to] = [i, i + 1].map(|i| q - self.nodes[i].p);
            // No point of a piece is farther from its chord than this.
            let sag =
                0.125 * self.spacing * self.spacing * self.curvature[i].length().max(self.curvature[i + 1].length());
            let chord = from - to;
            let share = (from.dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
            let far = best + 1.001 * sag;
            if (from - chord * share).length_squared() > far * far {
                return None;
            }
            let (from, to) = (D::parts(self.nodes[i].turn, from), D::parts(self.nodes[i + 1].turn, to));
            if from.0 >= 0.0 && to.0 <= 0.0 {
                let foot = self.foot_on(q, i, [from.0, to.0]);
                return Some((foot.a.length(), foot));
            }
            let ends = [at_node(i, from.1), at_node(i + 1, to.1)];
            Some(if ends[0].0 <= ends[1].0 { ends[0] } else { ends[1] })
        };
        self.balls.closest(q, (f64::INFINITY, Foot { g: 0.0, a: D::Across::default() }), &ask)
    }

    /// Whether the curve or its straight ends may come within `width` of a point; never wrongly false.
    pub(super) fn may_come_within(&self, p: D::Vector, width: f64) -> bool {
        let q = p - self.origin;
        if self.straight {
            return self.beside_start(q).a.length() <= width;
        }
        self.on_end(q).into_iter().flatten().any(|foot| foot.a.length() <= width) || self.balls.come_within(q, width)
    }

    /// Lower bound on the distance of `p` from the curve and its straight ends, below the true one by at most half the node spacing.
    pub fn distance(&self, p: D::Vector) -> f64 {
        let q = p - self.origin;
        if self.straight {
            return self.beside_start(q).a.length();
        }
        let ends = self.on_end(q).into_iter().flatten().map(|foot| foot.a.length());
        let between = (self.balls.nearest(q).1 - 0.5 * self.spacing).max(0.0);
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
            [k.max(a.length()).max(b.length()), change.max((b - a).length() / self.spacing)]
        })
    }
}
