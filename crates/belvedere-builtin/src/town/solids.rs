//! Houses: walls and roofs over rectangles.

use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{CityFace, Surface};

/// A rectangle in plan: corner, direction of its front, sizes along and across the front, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rect {
    pub(super) corner: DVec2,
    pub(super) along: DVec2,
    pub(super) length: f64,
    pub(super) depth: f64,
}

impl Rect {
    /// Corners, counter-clockwise.
    pub(super) fn corners(&self) -> [DVec2; 4] {
        let (u, v) = (self.along * self.length, self.along.perp() * self.depth);
        [self.corner, self.corner + u, self.corner + u + v, self.corner + v]
    }

    pub(super) fn area(&self) -> f64 {
        self.length * self.depth
    }

    /// Whether two rectangles share more than a rim of 1 cm (separating axes).
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        let span = |corners: &[DVec2; 4], axis: DVec2| {
            corners
                .iter()
                .map(|p| p.dot(axis))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], t| [lo.min(t), hi.max(t)])
        };
        let (a, b) = (self.corners(), other.corners());
        [self.along, self.along.perp(), other.along, other.along.perp()].iter().all(|&axis| {
            let ([lo, hi], [from, to]) = (span(&a, axis), span(&b, axis));
            hi.min(to) - lo.max(from) > 0.01
        })
    }
}

/// Roofs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Roof {
    /// Ridge along the front.
    Gabled,
    /// Ridge across the front.
    GableFront,
    /// All sides slope to a ridge along the longer side.
    Hipped,
    /// All sides slope to one point.
    Pyramid,
}

/// Faces of a solid on the ground at height 0: walls up to `eaves`, a roof up to `ridge`, metres.
pub(super) fn solid(rect: &Rect, roof: Roof, eaves: f64, ridge: f64) -> Vec<CityFace> {
    let mut p = rect.corners();
    let turned = match roof {
        Roof::GableFront => true,
        Roof::Hipped => rect.depth > rect.length,
        _ => false,
    };
    if turned {
        p.rotate_left(1);
    }
    let (ends, length) = ([0.5 * (p[3] + p[0]), 0.5 * (p[1] + p[2])], p[0].distance(p[1]));
    // Share of the ridge that a hip removes at either end.
    let cut = match roof {
        Roof::Hipped => (0.5 * p[1].distance(p[2]) / length).min(0.5),
        Roof::Pyramid => 0.5,
        _ => 0.0,
    };
    let tops = [ends[0].lerp(ends[1], cut).extend(ridge), ends[1].lerp(ends[0], cut).extend(ridge)];
    let up = p.map(|q| q.extend(eaves));
    let gabled = cut == 0.0;
    let mut faces = vec![face(Surface::Ground, [p[3], p[2], p[1], p[0]].map(|q| q.extend(0.0)).to_vec())];
    for k in 0..4 {
        let next = (k + 1) % 4;
        let mut wall = vec![p[k].extend(0.0), p[next].extend(0.0), up[next]];
        if gabled && k % 2 == 1 {
            wall.push(if k == 1 { tops[1] } else { tops[0] });
        }
        wall.push(up[k]);
        faces.push(face(Surface::Wall, wall));
    }
    let mut roofs = vec![vec![up[0], up[1], tops[1], tops[0]], vec![up[2], up[3], tops[0], tops[1]]];
    if !gabled {
        roofs.extend([vec![up[1], up[2], tops[1]], vec![up[3], up[0], tops[0]]]);
    }
    for mut ring in roofs {
        ring.dedup_by(|a, b| a.distance_squared(*b) < 1e-12);
        faces.push(face(Surface::Roof, ring));
    }
    faces
}

/// Faces of a closed body of rings one above the other, equal in number of corners, counter-clockwise; the ends may be points.
pub(super) fn stacked(rings: &[Vec<DVec3>]) -> Vec<CityFace> {
    let mut faces = Vec::new();
    for pair in rings.windows(2) {
        let (low, high) = (&pair[0], &pair[1]);
        let count = low.len().max(high.len());
        let at = |ring: &[DVec3], k: usize| ring[k % ring.len()];
        for k in 0..count {
            let mut ring = vec![at(low, k), at(low, k + 1), at(high, k + 1), at(high, k)];
            ring.dedup();
            faces.push(face(Surface::Other, ring));
        }
    }
    faces
}

pub(super) fn face(surface: Surface, ring: Vec<DVec3>) -> CityFace {
    CityFace { surface, rings: vec![ring], picture: None }
}
