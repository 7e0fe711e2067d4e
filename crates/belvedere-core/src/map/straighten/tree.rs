//! Bounding tree of balls (discs in plan) over the pieces of a curve.

use super::dimension::Vector;

/// A tree over pieces of equal length: each ball encloses two of the level below.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Balls<V> {
    /// From the pieces up to the whole curve.
    levels: Vec<Vec<Ball<V>>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball<V> {
    center: V,
    radius: f64,
    /// Largest curvature of its pieces.
    bend: f64,
}

impl<V: Vector> Balls<V> {
    /// * `nodes`: positions; `spacing`: arc length between them; `bends`: lengths of the curvature there, which changes linearly between them.
    pub(super) fn new(nodes: &[V], spacing: f64, bends: &[f64]) -> Self {
        // No point of a piece is farther from the middle of its chord than half its length.
        let leaf = |(pair, k): (&[V], &[f64])| Ball {
            center: (pair[0] + pair[1]) * 0.5,
            radius: 0.5 * spacing,
            bend: k[0].max(k[1]),
        };
        let mut levels = vec![nodes.windows(2).zip(bends.windows(2)).map(leaf).collect::<Vec<_>>()];
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
        q: V,
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
        (q, width): (V, f64),
        ahead: &impl Fn(usize) -> f64,
        ask: &mut impl FnMut(usize) -> Option<T>,
    ) -> Option<T> {
        let ball = self.levels[level][i];
        if (ball.center - q).length_squared() > (width + ball.radius) * (width + ball.radius) {
            return None;
        }
        if level == 0 || ball.bend * (width + 2.0 * ball.radius) < 1.0 {
            // The point is nearer than the centres of curvature: `ahead` falls along these pieces and has at most one zero.
            return passed([i << level, ((i + 1) << level).min(self.levels[0].len())], ahead).and_then(ask);
        }
        let below = &self.levels[level - 1];
        let (a, b) = (2 * i, 2 * i + 1);
        if b >= below.len() {
            return self.visit(level - 1, a, (q, width), ahead, ask);
        }
        let off = |k: usize| (below[k].center - q).length_squared();
        let (first, second) = if off(b) < off(a) { (b, a) } else { (a, b) };
        let found = self.visit(level - 1, first, (q, width), ahead, ask);
        found.or_else(|| self.visit(level - 1, second, (q, width), ahead, ask))
    }

    /// Whether a piece may come within `width` of a point; never wrongly false.
    pub(super) fn come_within(&self, q: V, width: f64) -> bool {
        self.comes_within(self.levels.len() - 1, 0, q, width)
    }

    fn comes_within(&self, level: usize, i: usize, q: V, width: f64) -> bool {
        let Ball { center, radius, .. } = self.levels[level][i];
        let off = center.distance(q);
        if off > width + radius {
            return false;
        }
        let below = |k: usize| k < self.levels[level - 1].len() && self.comes_within(level - 1, k, q, width);
        level == 0 || off + radius <= width || below(2 * i) || below(2 * i + 1)
    }

    /// The piece whose middle is nearest, and its distance.
    pub(super) fn nearest(&self, q: V) -> (usize, f64) {
        let (distance, piece) =
            self.closest(q, (f64::INFINITY, 0), &|i, _| Some((self.levels[0][i].center.distance(q), i)));
        (piece, distance)
    }

    /// The least of the distances that `ask` gives for pieces, and what it gives with it.
    ///
    /// * `best`: what is returned if no distance is less. `ask`: `None` for a piece that is no nearer than the best so far, else its distance, no less than that of its ball, and anything.
    pub(super) fn closest<T>(
        &self,
        q: V,
        mut best: (f64, T),
        ask: &impl Fn(usize, f64) -> Option<(f64, T)>,
    ) -> (f64, T) {
        self.closer(self.levels.len() - 1, 0, q, &mut best, ask);
        best
    }

    fn closer<T>(
        &self,
        level: usize,
        i: usize,
        q: V,
        best: &mut (f64, T),
        ask: &impl Fn(usize, f64) -> Option<(f64, T)>,
    ) {
        let ball = self.levels[level][i];
        if ball.center.distance(q) - ball.radius > best.0 {
            return;
        }
        if level == 0 {
            if let Some(found) = ask(i, best.0).filter(|found| found.0 < best.0) {
                *best = found;
            }
            return;
        }
        let below = &self.levels[level - 1];
        let (a, b) = (2 * i, 2 * i + 1);
        let off = |k: usize| (below[k].center - q).length_squared();
        let turned = b < below.len() && off(b) < off(a);
        for k in if turned { [b, a] } else { [a, b] } {
            if k < below.len() {
                self.closer(level - 1, k, q, best, ask);
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

fn around<V: Vector>(balls: &[Ball<V>]) -> Ball<V> {
    let bend = balls.iter().map(|d| d.bend).fold(0.0, f64::max);
    let [a, b] = [balls[0], balls[balls.len() - 1]];
    let apart = a.center.distance(b.center);
    if apart + b.radius <= a.radius {
        return Ball { bend, ..a };
    }
    if apart + a.radius <= b.radius {
        return Ball { bend, ..b };
    }
    let radius = 0.5 * (apart + a.radius + b.radius);
    let center = a.center + (b.center - a.center) * ((radius - a.radius) / apart);
    // A little more, for rounding.
    Ball { center, radius: radius * (1.0 + 1e-12), bend }
}
