//! Bounding tree of discs over the pieces of a curve.

use glam::DVec2;

/// Position, relative to the curve's origin, and unit tangent at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub(super) p: DVec2,
    pub(super) tangent: DVec2,
}

/// A tree over pieces of equal length: each disc encloses two of the level below.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Discs {
    /// From the pieces up to the whole curve.
    levels: Vec<Vec<Disc>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Disc {
    center: DVec2,
    radius: f64,
    /// Largest curvature of its pieces.
    bend: f64,
}

impl Discs {
    /// * `spacing`: arc length between nodes; `curvature`: at the nodes, linear between them.
    pub(super) fn new(nodes: &[Node], spacing: f64, curvature: &[f64]) -> Self {
        // No point of a piece is farther from the middle of its chord than half its length.
        let leaf = |(pair, k): (&[Node], &[f64])| Disc {
            center: 0.5 * (pair[0].p + pair[1].p),
            radius: 0.5 * spacing,
            bend: k[0].abs().max(k[1].abs()),
        };
        let mut levels = vec![nodes.windows(2).zip(curvature.windows(2)).map(leaf).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            levels.push(below.chunks(2).map(around).collect());
        }
        Self { levels }
    }

    /// Calls `ask` for the pieces within `width` of `q` that may hold its foot, nearest branches first, until one returns `Some`.
    ///
    /// * `ahead`: distance by which `q` lies ahead of a node, along the tangent there.
    pub(super) fn find<T>(
        &self,
        q: DVec2,
        width: f64,
        ahead: &impl Fn(usize) -> f64,
        ask: &mut impl FnMut(usize) -> Option<T>,
    ) -> Option<T> {
        self.visit(self.levels.len() - 1, 0, (q, width), ahead, ask)
    }

    fn visit<T>(
        &self,
        level: usize,
        i: usize,
        (q, width): (DVec2, f64),
        ahead: &impl Fn(usize) -> f64,
        ask: &mut impl FnMut(usize) -> Option<T>,
    ) -> Option<T> {
        let disc = self.levels[level][i];
        if disc.center.distance_squared(q) > (width + disc.radius) * (width + disc.radius) {
            return None;
        }
        if level == 0 || disc.bend * (width + 2.0 * disc.radius) < 1.0 {
            // The point is nearer than the centres of curvature: `ahead` falls along these pieces and has at most one zero.
            return passed([i << level, ((i + 1) << level).min(self.levels[0].len())], ahead).and_then(ask);
        }
        let below = &self.levels[level - 1];
        let (a, b) = (2 * i, 2 * i + 1);
        if b >= below.len() {
            return self.visit(level - 1, a, (q, width), ahead, ask);
        }
        let off = |k: usize| below[k].center.distance_squared(q);
        let (first, second) = if off(b) < off(a) { (b, a) } else { (a, b) };
        let found = self.visit(level - 1, first, (q, width), ahead, ask);
        found.or_else(|| self.visit(level - 1, second, (q, width), ahead, ask))
    }

    /// Whether a piece may come within `width` of a point; never wrongly false.
    pub(super) fn come_within(&self, q: DVec2, width: f64) -> bool {
        self.comes_within(self.levels.len() - 1, 0, q, width)
    }

    fn comes_within(&self, level: usize, i: usize, q: DVec2, width: f64) -> bool {
        let Disc { center, radius, .. } = self.levels[level][i];
        let off = center.distance(q);
        if off > width + radius {
            return false;
        }
        let below = |k: usize| k < self.levels[level - 1].len() && self.comes_within(level - 1, k, q, width);
        level == 0 || off + radius <= width || below(2 * i) || below(2 * i + 1)
    }

    /// The piece whose middle is nearest, and its distance.
    pub(super) fn nearest(&self, q: DVec2) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        self.closer(self.levels.len() - 1, 0, q, &mut best);
        best
    }

    fn closer(&self, level: usize, i: usize, q: DVec2, best: &mut (usize, f64)) {
        let disc = self.levels[level][i];
        let distance = disc.center.distance(q);
        if level == 0 {
            if distance < best.1 {
                *best = (i, distance);
            }
            return;
        }
        if distance - disc.radius > best.1 {
            return;
        }
        let below = &self.levels[level - 1];
        let (a, b) = (2 * i, 2 * i + 1);
        let off = |k: usize| below[k].center.distance_squared(q);
        let turned = b < below.len() && off(b) < off(a);
        for k in if turned { [b, a] } else { [a, b] } {
            if k < below.len() {
                self.closer(level - 1, k, q, best);
            }
        }
    }
}

/// The piece between two nodes on which `ahead` changes from positive to negative, by bisection; `None` if it does not change.
fn passed([mut first, mut last]: [usize; 2], ahead: &impl Fn(usize) -> f64) -> Option<usize> {
    if !(ahead(first) >= 0.0 && ahead(last) <= 0.0) {
        return None;
    }
    while last - first > 1 {
        let middle = first.midpoint(last);
        if ahead(middle) >= 0.0 { first = middle } else { last = middle }
    }
    Some(first)
}

fn around(discs: &[Disc]) -> Disc {
    let bend = discs.iter().map(|d| d.bend).fold(0.0, f64::max);
    let [a, b] = [discs[0], discs[discs.len() - 1]];
    let apart = a.center.distance(b.center);
    if apart + b.radius <= a.radius {
        return Disc { bend, ..a };
    }
    if apart + a.radius <= b.radius {
        return Disc { bend, ..b };
    }
    let radius = 0.5 * (apart + a.radius + b.radius);
    let center = a.center + (radius - a.radius) / apart * (b.center - a.center);
    // A little more, for rounding.
    Disc { center, radius: radius * (1.0 + 1e-12), bend }
}
