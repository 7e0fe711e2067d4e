//! Ribbons: smooth bands through the alpha carbons of proteins, arrows along strands, bands and slabs of nucleic acids.

use super::Secondary;
use super::openness::{Around, Shades};
use super::shape::Shape;
use super::sphere::rod;
use super::trace::{Base, Kind, Link, Trace};
use crate::Color;
use belvedere_core::DVec3;
use rayon::prelude::*;

/// Half of width and thickness, angstrom, and how square a cross-section is: exponent of its superellipse, 2 = an ellipse.
#[derive(Debug, Clone, Copy)]
struct Section {
    half: [f64; 2],
    square: f64,
}

const COIL: Section = Section { half: [0.32, 0.32], square: 2.0 };
const HELIX: Section = Section { half: [1.30, 0.24], square: 2.6 };
const STRAND: Section = Section { half: [1.10, 0.24], square: 7.0 };
const NUCLEIC: Section = Section { half: [0.95, 0.36], square: 2.6 };
/// Half the width of an arrow at its start and at its end, and where it starts before the last residue, and ends behind it, residues.
const ARROW: [f64; 2] = [1.9, 0.25];
const ARROW_FROM: f64 = 1.0;
const ARROW_TO: f64 = 0.5;
/// Half the thickness of the slab of a base, the margin around its atoms, and the radius of its rod, angstrom.
const SLAB: f64 = 0.28;
const MARGIN: f64 = 0.3;
const ROD: f64 = 0.26;
/// Radius of a residue that takes light from others, angstrom.
const SHADE: f64 = 1.5;

/// Steps along a residue and around a section.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fineness {
    pub(super) along: usize,
    pub(super) around: usize,
}

impl Fineness {
    /// By the number of residues, or as stated (1..=16).
    pub(super) fn of(residues: usize, detail: Option<u32>) -> Self {
        let (along, around) = match (detail, residues) {
            (Some(d), _) => (2 + d as usize, 6 + 2 * d as usize),
            (None, 0..=3_000) => (8, 16),
            (None, 3_001..=12_000) => (6, 12),
            (None, _) => (4, 8),
        };
        // An even number of steps along, so that a residue begins at one.
        Self { along: along + along % 2, around }
    }
}

/// The ribbons of all traces. The colour and the part of a piece are those of the atom that its residue stands at.
pub(super) fn build(traces: &[Trace], colors: &[Color], fine: Fineness) -> Vec<Shape> {
    let centers: Vec<DVec3> = traces.iter().flat_map(|t| &t.links).map(|l| l.at).collect();
    let shades = Shades::new(centers.clone(), vec![SHADE; centers.len()]);
    let mut firsts = Vec::with_capacity(traces.len());
    traces.iter().fold(0, |first, trace| {
        firsts.push(first);
        first + trace.links.len()
    });
    let one = |(trace, first): (&Trace, &usize)| {
        // What a ribbon is itself takes no light from it.
        let near: Vec<Around> = (0..trace.links.len())
            .map(|i| shades.around_but(first + i, |k| k + 2 >= first + i && k <= first + i + 2))
            .collect();
        Maker { trace, colors, fine, near, line: Line::of(trace) }.made()
    };
    traces.par_iter().zip(&firsts).map(one).collect()
}

/// Middle line of a ribbon, and the direction of its width.
struct Line {
    points: Vec<DVec3>,
    sides: Vec<DVec3>,
}

impl Line {
    fn of(trace: &Trace) -> Self {
        let links = &trace.links;
        let n = links.len();
        let is_strand = |i: usize| links[i].structure == Secondary::Strand;
        // The zigzag of a strand is flattened.
        let point = |i: usize| match links[i].at {
            at if i > 0 && i + 1 < n && is_strand(i) => 0.5 * at + 0.25 * (links[i - 1].at + links[i + 1].at),
            at => at,
        };
        let points: Vec<DVec3> = (0..n).map(point).collect();
        let along = |i: usize| (links[(i + 1).min(n - 1)].at - links[i.saturating_sub(1)].at).normalize_or(DVec3::Z);
        let across = |i: usize| -> DVec3 {
            let t = along(i);
            let stated = match trace.kind {
                Kind::Protein => links[i].side,
                Kind::Nucleic => links[i].side.map(|side| t.cross(side)),
            };
            let bent = || {
                let k = i.clamp(1, n.max(3) - 2);
                if n < 3 { DVec3::ZERO } else { (links[k].at - links[k - 1].at).cross(links[k + 1].at - links[k].at) }
            };
            let flat = |v: DVec3| (v - v.dot(t) * t).try_normalize();
            stated.and_then(flat).or_else(|| flat(bent())).unwrap_or_else(|| t.any_orthonormal_vector())
        };
        let mut raw: Vec<DVec3> = (0..n).map(across).collect();
        for i in 1..n {
            if raw[i].dot(raw[i - 1]) < 0.0 {
                raw[i] = -raw[i];
            }
        }
        // The peptide plane lies between its alpha carbon and the next.
        let side = |i: usize| {
            let before = if i > 0 && trace.kind == Kind::Protein { raw[i - 1] } else { raw[i] };
            (raw[i] + before).normalize_or(raw[i])
        };
        Self { points, sides: (0..n).map(side).collect() }
    }

    /// Point and unit tangent at a place, 0 = the first residue: a cubic through all points (Catmull and Rom 1974).
    fn at(&self, u: f64) -> (DVec3, DVec3) {
        let n = self.points.len();
        let i = (u.floor().max(0.0) as usize).min(n - 2);
        let f = u - i as f64;
        let p = |k: isize| self.points[k.clamp(0, n as isize - 1) as usize];
        let i = i as isize;
        let (a, b) = (p(i), p(i + 1));
        let (ta, tb) = (0.5 * (b - p(i - 1)), 0.5 * (p(i + 2) - a));
        let (f2, f3) = (f * f, f * f * f);
        let point =
            (2.0 * f3 - 3.0 * f2 + 1.0) * a + (f3 - 2.0 * f2 + f) * ta + (3.0 * f2 - 2.0 * f3) * b + (f3 - f2) * tb;
        let way = (6.0 * f2 - 6.0 * f) * (a - b) + (3.0 * f2 - 4.0 * f + 1.0) * ta + (3.0 * f2 - 2.0 * f) * tb;
        (point, way.try_normalize().unwrap_or_else(|| (b - a).normalize_or(DVec3::Z)))
    }

    /// Unit direction of the width at a place with a tangent.
    fn side(&self, u: f64, tangent: DVec3) -> DVec3 {
        let i = (u.floor().max(0.0) as usize).min(self.sides.len() - 2);
        let side = self.sides[i].lerp(self.sides[i + 1], u - i as f64);
        (side - side.dot(tangent) * tangent).try_normalize().unwrap_or_else(|| tangent.any_orthonormal_vector())
    }
}

struct Maker<'a> {
    trace: &'a Trace,
    colors: &'a [Color],
    fine: Fineness,
    near: Vec<Around>,
    line: Line,
}

impl Maker<'_> {
    fn made(&self) -> Shape {
        let mut shape = Shape::default();
        let last = self.trace.links.len() - 1;
        let stations = self.stations();
        self.cap(&mut shape, 0.0, stations[0].1, -1.0);
        let mut before: Option<(f64, Section, u32)> = None;
        for (u, section) in stations {
            match before {
                // A step in width: a face across.
                Some((at, narrow, _)) if at == u => {
                    let [a, b] = [narrow, section].map(|s| self.ring(&mut shape, u, s, Some(-1.0)));
                    self.band(&mut shape, [a, b], u);
                }
                Some((at, _, ring)) => {
                    let next = self.ring(&mut shape, u, section, None);
                    self.band(&mut shape, [ring, next], 0.5 * (at + u));
                    before = Some((u, section, next));
                    continue;
                }
                None => {}
            }
            before = Some((u, section, self.ring(&mut shape, u, section, None)));
        }
        if let Some((u, section, _)) = before {
            self.cap(&mut shape, u, section, 1.0);
        }
        if self.trace.kind == Kind::Nucleic {
            (0..=last).for_each(|i| self.base(&mut shape, i));
        }
        shape
    }

    /// Places along the ribbon and the cross-sections there; two at one place are a step in width.
    fn stations(&self) -> Vec<(f64, Section)> {
        let links = &self.trace.links;
        let last = links.len() - 1;
        let steps = last * self.fine.along;
        let arrows = arrows(links);
        let mut out = Vec::with_capacity(steps + 1 + arrows.len());
        for k in 0..=steps {
            let u = k as f64 / self.fine.along as f64;
            let start = arrows.iter().find(|a| (u - a[0]).abs() < 1e-9);
            if start.is_some() {
                out.push((u, STRAND));
            }
            out.push((u, self.section(u, &arrows)));
        }
        out
    }

    fn section(&self, u: f64, arrows: &[[f64; 2]]) -> Section {
        let links = &self.trace.links;
        let own = |i: usize| match (self.trace.kind, links[i.min(links.len() - 1)].structure) {
            (Kind::Nucleic, _) => NUCLEIC,
            (_, Secondary::Coil) => COIL,
            (_, Secondary::Helix) => HELIX,
            (_, Secondary::Strand) => STRAND,
        };
        if let Some([from, to]) = arrows.iter().find(|a| u >= a[0] - 1e-9 && u <= a[1] + 1e-9) {
            let f = ((u - from) / (to - from)).clamp(0.0, 1.0);
            return Section { half: [ARROW[0] + f * (ARROW[1] - ARROW[0]), STRAND.half[1]], square: STRAND.square };
        }
        let i = u.floor() as usize;
        let f = u - i as f64;
        let (mut a, b) = (own(i), own(i + 1));
        // What follows the tip of an arrow begins as wide as that.
        if arrows.iter().any(|arrow| u > arrow[1] && u < arrow[1] + 0.6 && arrow[1].floor() as usize == i) {
            a = Section { half: [ARROW[1], STRAND.half[1]], square: STRAND.square };
        }
        let f = ((f - 0.25) / 0.5).clamp(0.0, 1.0);
        let f = f * f * (3.0 - 2.0 * f);
        let mix = |x: f64, y: f64| x + f * (y - x);
        Section { half: [mix(a.half[0], b.half[0]), mix(a.half[1], b.half[1])], square: mix(a.square, b.square) }
    }

    /// Adds a ring of vertices at a place; their normals look outwards, or along the line where `across` says in which direction.
    fn ring(&self, shape: &mut Shape, u: f64, section: Section, across: Option<f64>) -> u32 {
        let (center, tangent) = self.line.at(u);
        let side = self.line.side(u, tangent);
        let up = tangent.cross(side);
        let near = self.nearest(u);
        let (color, around) = (self.colors[self.trace.links[near].atom as usize], &self.near[near]);
        let first = shape.positions.len() as u32;
        let power = |v: f64, e: f64| v.signum() * v.abs().powf(e);
        let [w, t] = section.half;
        for k in 0..self.fine.around {
            let (sin, cos) = (std::f64::consts::TAU * (k as f64 + 0.5) / self.fine.around as f64).sin_cos();
            let e = 2.0 / section.square;
            let p = center + w * power(cos, e) * side + t * power(sin, e) * up;
            let out = power(cos, 2.0 - e) / w * side + power(sin, 2.0 - e) / t * up;
            let normal = across.map_or_else(|| out.normalize_or(side), |sign| sign * tangent);
            shape.vertex(p, normal, around.open(p, normal), color);
        }
        first
    }

    fn nearest(&self, u: f64) -> usize {
        (u.round().max(0.0) as usize).min(self.trace.links.len() - 1)
    }

    /// Joins two rings; the triangles belong to the residue at `u`.
    fn band(&self, shape: &mut Shape, [a, b]: [u32; 2], u: f64) {
        let (n, atom) = (self.fine.around as u32, self.trace.links[self.nearest(u)].atom);
        for k in 0..n {
            let next = (k + 1) % n;
            shape.triangle([a + k, a + next, b + next], atom);
            shape.triangle([a + k, b + next, b + k], atom);
        }
    }

    /// Closes an end.
    fn cap(&self, shape: &mut Shape, u: f64, section: Section, sign: f64) {
        let first = self.ring(shape, u, section, Some(sign));
        let (center, tangent) = self.line.at(u);
        let near = self.nearest(u);
        let atom = self.trace.links[near].atom;
        let open = self.near[near].open(center, sign * tangent);
        let middle = shape.vertex(center, sign * tangent, open, self.colors[atom as usize]);
        let n = self.fine.around as u32;
        for k in 0..n {
            let (a, b) = (first + k, first + (k + 1) % n);
            shape.triangle(if sign > 0.0 { [middle, a, b] } else { [middle, b, a] }, atom);
        }
    }

    /// The slab of a base and the rod that joins it to the ribbon.
    fn base(&self, shape: &mut Shape, i: usize) {
        let Some(Base { atom, rings, normal }) = &self.trace.links[i].base else { return };
        let (color, around) = (self.colors[*atom as usize], &self.near[i]);
        let middle = rings.iter().sum::<DVec3>() / rings.len() as f64;
        let foot = self.trace.links[i].side.map_or(middle, |side| self.trace.links[i].at + side);
        let way = middle - foot;
        let Some(x) = (way - way.dot(*normal) * *normal).try_normalize() else { return };
        let axes = [x, normal.cross(x), *normal];
        let reach = |axis: DVec3| {
            let all = rings.iter().map(|p| (*p - middle).dot(axis));
            all.fold([0f64; 2], |[low, high], v| [low.min(v), high.max(v)])
        };
        let [[x0, x1], [y0, y1], _] = axes.map(reach);
        let low = [x0 - MARGIN, y0 - MARGIN, -SLAB];
        let high = [x1 + MARGIN, y1 + MARGIN, SLAB];
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let n = sign * axes[axis];
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |k: usize| {
                    let (kb, kc) = ([0, 1, 1, 0][k], [0, 0, 1, 1][k]);
                    let pick = |a: usize, up: usize| if up == 1 { high[a] } else { low[a] };
                    let own = if sign > 0.0 { high[axis] } else { low[axis] };
                    middle + own * axes[axis] + pick(b, kb) * axes[b] + pick(c, kc) * axes[c]
                };
                let v = [0, 1, 2, 3].map(|k| {
                    let p = corner(k);
                    shape.vertex(p, n, around.open(p, n), color)
                });
                let [p, q, r, s] = if sign > 0.0 { v } else { [v[3], v[2], v[1], v[0]] };
                shape.triangle([p, q, r], *atom);
                shape.triangle([p, r, s], *atom);
            }
        }
        self.arm(shape, i, (foot, *atom));
    }

    /// The rod from the ribbon to the sugar and into the base.
    fn arm(&self, shape: &mut Shape, i: usize, (foot, atom): (DVec3, u32)) {
        let last = (self.trace.links.len() - 1) as f64;
        let places = (-4..=4).map(|k| (i as f64 + 0.25 * f64::from(k)).clamp(0.0, last));
        let points = places.map(|u| self.line.at(u).0);
        let Some(start) = points.min_by(|a, b| a.distance(foot).total_cmp(&b.distance(foot))) else { return };
        let Some(Base { rings, .. }) = &self.trace.links[i].base else { return };
        let Some(end) = rings.iter().copied().min_by(|a, b| a.distance(foot).total_cmp(&b.distance(foot))) else {
            return;
        };
        let (color, around) = (self.colors[atom as usize], &self.near[i]);
        for (from, to) in [(start, foot), (foot, end)] {
            let (normals, triangles) = rod(self.fine.around.min(10), to - from);
            let first = shape.positions.len() as u32;
            for normal in normals {
                for p in [from, to] {
                    let p = p + ROD * normal;
                    shape.vertex(p, normal, around.open(p, normal), color);
                }
            }
            triangles.into_iter().for_each(|t| shape.triangle(t.map(|v| v + first), atom));
        }
    }
}

/// Arrows at the ends of strands: where they start and end.
fn arrows(links: &[Link]) -> Vec<[f64; 2]> {
    let is_strand = |i: usize| links.get(i).is_some_and(|l| l.structure == Secondary::Strand);
    let ends = (1..links.len()).filter(|&i| is_strand(i) && is_strand(i - 1) && !is_strand(i + 1));
    let last = (links.len() - 1) as f64;
    ends.map(|i| [i as f64 - ARROW_FROM, (i as f64 + ARROW_TO).min(last)]).collect()
}

#[cfg(test)]
mod tests;
