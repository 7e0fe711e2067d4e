//! Whether the strip or tube around a curve overlaps itself.

use super::curve::{Curve, Node};
use super::dimension::{Across, Dimension, Vector};
use super::{StraightenError, place};
use std::collections::HashMap;
use std::f64::consts::PI;

/// The least radius of curvature is the half width over this, so that lengths along the curve change by no more than a factor of 5.
pub const BEND_SHARE: f64 = 0.8;
/// Longest straight end, in multiples of the curve's length plus the half width.
const FAR: f64 = 1e4;

/// First and last arc length between which what lies within `half_width` of the curve and its straight ends does not overlap itself.
///
/// A curve of curvature at most 1 / rho stays outside the circles of radius rho that touch it, for an arc length of pi rho to both sides
/// (Blaschke; in space, where the angle to a point turns more slowly still, too); so no point within `half_width` < rho of it has two feet that
/// near together. Feet farther apart are excluded where points of the curve that are farther apart along it are farther than two half widths
/// from each other. The proof is in docs/algorithms/strip.md.
///
/// # Errors
/// [`StraightenError::Overlap`] if the curve itself comes too close; its straight ends are cut short instead.
pub(super) fn reach<D: Dimension>(curve: &Curve<D>, half_width: f64) -> Result<[f64; 2], StraightenError> {
    let apart = PI / curve.largest_curvature();
    // A point between nodes is at most half a spacing from one of them.
    let least = 2.0 * half_width + curve.spacing();
    if let Some((i, j, distance)) = closest(curve, least, apart) {
        let at = place::<D>(curve.origin() + (curve.nodes()[i].p + curve.nodes()[j].p) * 0.5);
        let widest = 0.5 * (distance - curve.spacing());
        return Err(StraightenError::Overlap { shape: D::SHAPE, at, distance, half_width, widest: widest.max(0.0) });
    }
    let far = FAR * (curve.length() + half_width);
    let [before, beyond] = ends(curve).map(|end| end.clear_of(curve, least, apart).min(far));
    // With less than half a circle between them, the ends diverge or stay apart like the legs of a U.
    let meet = curve.length() > apart;
    let both = if meet { apart_by(ends(curve), [before, beyond], least) } else { f64::INFINITY };
    Ok([-before.min(both), curve.length() + beyond.min(both)])
}

/// Offsets that belong to a node: `normal . offset <= distance` for each of these.
pub(super) type Cell<D> = Vec<(<D as Dimension>::Across, f64)>;

/// For each node of a curve and its unrolled form the offsets up to `most` that are nearer to it than to every other place of either, with
/// a spacing of nodes in hand, and whose bend is no sharper than [`BEND_SHARE`] allows.
///
/// An offset `a` is nearer to the node than to a place in the way `d` from it where `2 d' a <= |d|^2`, `d'` the part of `d` across the curve: what
/// belongs to a node is convex, and the least `|d|^2 / (2 |d'|)` is the global radius of curvature there (Gonzalez and Maddocks 1999).
pub(super) fn cells<D: Dimension>(line: &Curve<D>, unrolled: &Curve<D>, most: f64) -> Vec<Cell<D>> {
    let lattices = [line, unrolled].map(|curve| (curve, Cells::new::<D>(curve.nodes(), 2.0 * most)));
    let cell = |i: usize| {
        let mut bounds: Cell<D> = Vec::new();
        let mut bound = |across: D::Across, distance: f64| {
            if distance < most {
                bounds.push((across, distance));
            }
        };
        let curvature = line.curvature()[i];
        bound(curvature * (1.0 / curvature.length()), BEND_SHARE / curvature.length());
        for (curve, lattice) in &lattices {
            let node = curve.nodes()[i];
            for j in lattice.around(node.p).filter(|j| *j != i) {
                let way = curve.nodes()[j].p - node.p;
                let across = D::parts(node.turn, way).1;
                let length = across.length();
                bound(across * (1.0 / length), 0.5 * way.length_squared() / length - curve.spacing());
            }
        }
        D::needed(bounds, most)
    };
    (0..line.nodes().len()).map(cell).collect()
}

/// Nodes by the cells of a lattice.
struct Cells {
    cells: HashMap<[i64; 3], Vec<usize>>,
    spacing: f64,
}

impl Cells {
    fn new<D: Dimension>(nodes: &[Node<D>], spacing: f64) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        nodes.iter().enumerate().for_each(|(i, node)| cells.entry(node.p.cell(spacing)).or_default().push(i));
        Self { cells, spacing }
    }

    /// Numbers of the nodes in the cell of a point and those beside it: all within the spacing, and others.
    fn around<V: Vector>(&self, p: V) -> impl Iterator<Item = usize> + '_ {
        let beside = |along: bool| if along { -1..=1 } else { 0..=0 };
        let [x, y, z] = p.cell(self.spacing);
        let layers = beside(V::AXES.len() > 2).map(move |dz| z + dz);
        let rows = layers.flat_map(move |z| beside(true).map(move |dy| [y + dy, z]));
        let around = rows.flat_map(move |[y, z]| beside(true).map(move |dx| [x + dx, y, z]));
        around.filter_map(|cell| self.cells.get(&cell)).flatten().copied()
    }
}

/// Two nodes nearer than `least` that are more than `apart` along the curve from each other: the closest.
fn closest<D: Dimension>(curve: &Curve<D>, least: f64, apart: f64) -> Option<(usize, usize, f64)> {
    let nodes = curve.nodes();
    let gap = (apart / curve.spacing()).floor();
    if !(gap < nodes.len() as f64) {
        return None;
    }
    let gap = gap as usize;
    let cells = Cells::new::<D>(nodes, least);
    let mut best: Option<(usize, usize, f64)> = None;
    for (i, node) in nodes.iter().enumerate() {
        for j in cells.around(node.p).filter(|&j| j > i + gap) {
            let distance = nodes[j].p.distance(node.p);
            if distance <= least && best.is_none_or(|b| distance < b.2) {
                best = Some((i, j, distance));
            }
        }
    }
    best
}

/// A straight end, from the curve outwards.
#[derive(Clone, Copy)]
struct End<V> {
    from: V,
    along: V,
    /// Whether it is the one before the curve.
    first: bool,
}

fn ends<D: Dimension>(curve: &Curve<D>) -> [End<D::Vector>; 2] {
    let (first, last) = (curve.nodes()[0], curve.nodes()[curve.nodes().len() - 1]);
    let tangent = |node: Node<D>| D::vector(node.turn, 1.0, D::Across::default());
    [
        End { from: first.p, along: -tangent(first), first: true },
        End { from: last.p, along: tangent(last), first: false },
    ]
}

impl<V: Vector> End<V> {
    /// Length up to which the end stays `least` away from nodes that are more than `apart` from it along the curve.
    fn clear_of<D: Dimension<Vector = V>>(&self, curve: &Curve<D>, least: f64, apart: f64) -> f64 {
        let nodes = curve.nodes().iter().enumerate();
        let limits = nodes.filter_map(|(i, node)| {
            let g = i as f64 * curve.spacing();
            let way = if self.first { g } else { curve.length() - g };
            let v = node.p - self.from;
            let along = v.dot(self.along);
            let off = (v - self.along * along).length();
            let half = (off < least).then(|| (least * least - off * off).sqrt())?;
            let enters = (along - half).max(apart - way).max(0.0);
            (enters <= along + half).then_some(enters)
        });
        limits.fold(f64::INFINITY, f64::min)
    }
}

/// Length up to which both ends stay `least` apart, by bisection; at most the greater of the given lengths.
fn apart_by<V: Vector>(ends: [End<V>; 2], lengths: [f64; 2], least: f64) -> f64 {
    let near = |reach: f64| {
        let [a, b] = [0, 1].map(|k| (ends[k].from, ends[k].from + ends[k].along * lengths[k].min(reach)));
        between(a, b) <= least
    };
    let [mut low, mut high] = [0.0, lengths[0].max(lengths[1])];
    if !near(high) {
        return high;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if near(middle) { high = middle } else { low = middle }
    }
    low
}

/// Distance of two segments.
fn between<V: Vector>((a, a1): (V, V), (b, b1): (V, V)) -> f64 {
    let (u, v, w) = (a1 - a, b1 - b, a - b);
    let off = |s: f64, t: f64| (w + u * s - v * t).length();
    let (uu, uv, vv) = (u.length_squared(), u.dot(v), v.length_squared());
    // The point of one segment that is nearest to a point of the other.
    let on_a = |t: f64| if uu > 0.0 { ((t * uv - w.dot(u)) / uu).clamp(0.0, 1.0) } else { 0.0 };
    let on_b = |s: f64| if vv > 0.0 { ((s * uv + w.dot(v)) / vv).clamp(0.0, 1.0) } else { 0.0 };
    let ends = [off(0.0, on_b(0.0)), off(1.0, on_b(1.0)), off(on_a(0.0), 0.0), off(on_a(1.0), 1.0)];
    // Lines that are not parallel may be nearest to each other inside both segments.
    let inner = (uv * w.dot(v) - vv * w.dot(u)) / (uu * vv - uv * uv);
    let inside = (0.0..=1.0).contains(&inner).then(|| off(inner, on_b(inner)));
    ends.into_iter().chain(inside).fold(f64::INFINITY, f64::min)
}
