//! Rays of neighbouring pixels: every sixteenth of a row is computed, those between are interpolated, number by number.
//!
//! A ray changes smoothly with its pixel. Columns `x`, `x + 16`, `x + 32` give a quadratic of every number that describes a ray; where it is
//! not close to the ray of column `x + 8`, each ray is computed on its own.

use super::arc::{Arc, Joined, LatticeConic, NEAR};
use super::clip::Clip;
use super::cubic::Cubic;
use belvedere_core::map::curved_rays::{RayPiece, Shape};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::Volume;

/// Columns between computed rays, and those that three of them serve.
const APART: usize = 16;
pub(super) const TILE: usize = 2 * APART;
/// Largest number of cubics of a bent piece.
const MAX_PARTS: usize = 48;
/// Numbers of a straight piece: lattice coordinates at depth 0, their change per unit of depth, that of the length, first and last depth.
const OF_LINE: usize = 9;
/// Numbers of a cubic: coefficients of the lattice coordinates, length, coefficients of the depth.
const OF_CUBIC: usize = 17;

/// Form of a piece of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Piece {
    /// Straight, perhaps without end.
    Line { endless: bool },
    /// Bent: a number of cubics.
    Bent { parts: usize },
}

/// Where a line or a cubic of all rays of a tile lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reach {
    Inside,
    Outside,
    Unknown,
}

/// A ray as numbers.
#[derive(Debug, Clone, Default)]
struct Skeleton {
    pieces: Vec<Piece>,
    numbers: Vec<f64>,
}

/// The rays of a row.
pub(super) struct Sheaf<'a> {
    view: &'a View,
    volume: &'a Volume,
    range: [f64; 2],
    /// Pixel coordinates of the ray of column 0.
    first: DVec2,
    /// First column of the current tile.
    at: Option<usize>,
    /// Whether its rays can be interpolated, and then its three computed rays.
    holds: bool,
    computed: [Skeleton; 3],
    /// For each line and cubic where it lies.
    reaches: Vec<Reach>,
}

impl<'a> Sheaf<'a> {
    /// * `range`: nearest depth, and a depth beyond which no surface is seen. `first`: pixel coordinates of the ray of column 0.
    pub(super) fn new(view: &'a View, volume: &'a Volume, range: [f64; 2], first: DVec2) -> Self {
        Self { view, volume, range, first, at: None, holds: false, computed: Default::default(), reaches: Vec::new() }
    }

    /// Hands over the parts of the ray of a column that lie in the volume between two depths. Returns false where it must be computed on
    /// its own.
    pub(super) fn ray(&mut self, x: usize, range: [f64; 2], clip: &mut Clip<'_, '_>) -> bool {
        let first = x / TILE * TILE;
        if self.at != Some(first) {
            let follows = self.holds && self.at.is_some_and(|at| at + TILE == first);
            self.holds = (follows && self.tile(first, true)) || self.tile(first, false);
            self.at = Some(first);
        }
        if self.holds {
            self.interpolated((x - first) as f64, range, clip);
        }
        self.holds
    }

    /// Computes the rays of a tile; `goes_on`: the last ray of the tile before is its first.
    fn tile(&mut self, first: usize, goes_on: bool) -> bool {
        let begin = if goes_on { Some(std::mem::take(&mut self.computed[2])) } else { self.skeleton(first, None) };
        let Some(begin) = begin else { return false };
        let like = |x: usize| self.skeleton(x, Some(&begin.pieces));
        let (middle, end, between) = (like(first + APART), like(first + TILE), like(first + APART / 2));
        let (Some(middle), Some(end), Some(between)) = (middle, end, between) else { return false };
        self.computed = [begin, middle, end];
        self.reaches = self.reaches();
        self.is_close(&between)
    }

    fn reaches(&self) -> Vec<Reach> {
        let place = |k: usize, i: usize| DVec3::from_slice(&self.computed[k].numbers[i..]);
        let (mut out, mut from) = (Vec::new(), 0);
        for piece in &self.computed[0].pieces {
            match *piece {
                Piece::Line { endless } => {
                    let end = |k: usize, i: usize| place(k, from) + self.computed[k].numbers[i] * place(k, from + 3);
                    let ends = [from + 7, from + 8].map(|i| [0, 1, 2].map(|k| end(k, i)));
                    // Their points are products of two interpolated numbers.
                    out.push(if endless { Reach::Unknown } else { self.reach(&ends, 0.5) });
                    from += OF_LINE;
                }
                Piece::Bent { parts } => {
                    for _ in 0..parts {
                        let hulls = [0, 1, 2].map(|k| Cubic([0, 3, 6, 9].map(|i| place(k, from + i))).hull());
                        // A quadratic leaves the range of its values at 0, 1, 2 by at most an eighth of it.
                        out.push(self.reach(&[0, 1, 2, 3].map(|i| hulls.map(|hull| hull[i])), 0.125));
                        from += OF_CUBIC;
                    }
                }
            }
        }
        out
    }

    /// Where the hull of points lies that change with the column.
    ///
    /// * `points`: each of three rays. `beyond`: share of the range of these three by which the others may leave it.
    fn reach(&self, points: &[[DVec3; 3]], beyond: f64) -> Reach {
        let most = DVec3::from_array(self.volume.dims().map(|n| (n - 1) as f64));
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for [a, b, c] in points {
            let (least, greatest) = (a.min(*b).min(*c), a.max(*b).max(*c));
            let room = beyond * (greatest - least) + 1e-6;
            (lo, hi) = (lo.min(least - room), hi.max(greatest + room));
        }
        if hi.cmplt(DVec3::ZERO).any() || lo.cmpgt(most).any() {
            Reach::Outside
        } else if lo.cmpge(DVec3::ZERO).all() && hi.cmple(most).all() {
            Reach::Inside
        } else {
            Reach::Unknown
        }
    }

    /// The ray of a column; `like`: with pieces of these forms, else there is none.
    fn skeleton(&self, x: usize, like: Option<&[Piece]>) -> Option<Skeleton> {
        let pieces = self.view.ray(self.first + DVec2::new(x as f64, 0.0)).pieces().ok()?;
        if like.is_some_and(|like| like.len() != pieces.len()) {
            return None;
        }
        let mut out = Skeleton::default();
        for (i, piece) in pieces.iter().enumerate() {
            let form = self.describe(piece, like.map(|like| like[i]), &mut out.numbers)?;
            out.pieces.push(form);
        }
        out.numbers.iter().all(|v| v.is_finite()).then_some(out)
    }

    fn describe(&self, piece: &RayPiece, like: Option<Piece>, out: &mut Vec<f64>) -> Option<Piece> {
        let form = match &piece.shape {
            Shape::Line { from, per_depth } => {
                let [begin, end] = piece.depth;
                let endless = end == f64::INFINITY;
                let place = self.volume.lattice_from_scene(*from - begin * *per_depth);
                let change = *self.volume.lattice_axes() * *per_depth;
                out.extend(place.to_array().into_iter().chain(change.to_array()));
                out.extend([per_depth.length(), begin, if endless { begin } else { end }]);
                Piece::Line { endless }
            }
            Shape::Conic(arc) => self.bent(&LatticeConic::new(self.volume, arc), like, out)?,
            Shape::C2(arc) => self.bent(arc, like, out)?,
        };
        like.is_none_or(|like| like == form).then_some(form)
    }

    /// Cubics over equal parts of the parameter: as many as `like` has, else as few as are close enough.
    fn bent(&self, arc: &impl Arc, like: Option<Piece>, out: &mut Vec<f64>) -> Option<Piece> {
        // Neighbouring rays need as many or a few more.
        let (mut parts, most, near) = match like {
            Some(Piece::Bent { parts }) => (parts, parts, NEAR),
            Some(Piece::Line { .. }) => return None,
            None => (1, MAX_PARTS, 0.5 * NEAR),
        };
        loop {
            let knots = 2 * parts;
            let knots: Vec<_> = (0..=knots).map(|k| arc.knot(self.volume, k as f64 / knots as f64)).collect();
            let joined: Vec<_> = knots.windows(3).step_by(2).map(|k| Joined::new(&k[0], &k[1], &k[2])).collect();
            if joined.iter().all(|j| j.off_squared <= near * near && !j.is_uneven) {
                for j in &joined {
                    out.extend(j.curve.0.iter().flat_map(|c| c.to_array()));
                    out.push(j.length);
                    out.extend(j.depth.0);
                }
                return Some(Piece::Bent { parts });
            }
            parts += (parts / 4).max(1);
            if parts > most {
                return None;
            }
        }
    }

    /// Weights of the computed rays for a column of the tile.
    fn weights(along: f64) -> [f64; 3] {
        let t = along / APART as f64;
        [0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0)]
    }

    /// Some of the numbers of the ray with these weights.
    #[inline(always)]
    fn mixed<const N: usize>(&self, [a, b, c]: [f64; 3], from: usize) -> [f64; N] {
        let [p, q, r] = self.computed.each_ref().map(|s| s.numbers[from..].first_chunk::<N>());
        let (Some(p), Some(q), Some(r)) = (p, q, r) else { return [0.0; N] };
        std::array::from_fn(|i| a * p[i] + b * q[i] + c * r[i])
    }

    /// Whether the interpolated ray of a quarter of the tile is close to the computed one.
    fn is_close(&self, ray: &Skeleton) -> bool {
        let weights = Self::weights((APART / 2) as f64);
        let near = NEAR * self.volume.voxel_edge();
        let mut from = 0;
        ray.pieces.iter().all(|piece| match *piece {
            Piece::Line { endless } => {
                let (a, b) = (self.mixed::<OF_LINE>(weights, from), &ray.numbers[from..]);
                from += OF_LINE;
                let off = |w: f64| (0..3).map(|k| (a[k] - b[k] + w * (a[3 + k] - b[3 + k])).abs()).fold(0.0, f64::max);
                let end = if endless { self.range[1].min(1e3 * (1.0 + b[7])) } else { b[8] };
                let depths = (a[7] - b[7]).abs().max((a[8] - b[8]).abs());
                off(b[7]).max(off(end)) < NEAR && depths < near
            }
            Piece::Bent { parts } => (0..parts).all(|_| {
                let (a, b) = (self.mixed::<OF_CUBIC>(weights, from), &ray.numbers[from..]);
                from += OF_CUBIC;
                let off = |k: usize| (a[k] - b[k]).abs();
                let places = (0..3).all(|axis| (0..4).map(|k| off(3 * k + axis)).sum::<f64>() < NEAR);
                places && off(12) < near && (13..17).map(off).sum::<f64>() < near
            }),
        })
    }

    fn interpolated(&self, along: f64, [near, far]: [f64; 2], clip: &mut Clip<'_, '_>) {
        let weights = Self::weights(along);
        let mut from = 0;
        let mut reaches = self.reaches.iter().copied();
        for piece in &self.computed[0].pieces {
            match *piece {
                Piece::Line { endless } => {
                    if reaches.next() == Some(Reach::Outside) {
                        clip.leave();
                    } else {
                        let n = self.mixed::<OF_LINE>(weights, from);
                        let depth = [n[7].max(near), if endless { far } else { n[8].min(far) }];
                        if depth[0] < depth[1] {
                            let places = [0, 3].map(|k| DVec3::new(n[k], n[k + 1], n[k + 2]));
                            clip.lattice_line(places, n[6], depth);
                        }
                    }
                    from += OF_LINE;
                }
                Piece::Bent { parts } => {
                    for reach in reaches.by_ref().take(parts) {
                        if reach == Reach::Outside {
                            clip.leave();
                        } else {
                            let n = self.mixed::<OF_CUBIC>(weights, from);
                            let curve = Cubic([0, 3, 6, 9].map(|k| DVec3::new(n[k], n[k + 1], n[k + 2])));
                            let depth = Cubic([n[13], n[14], n[15], n[16]]);
                            clip.between(curve, n[12], depth, [near, far], reach == Reach::Inside);
                        }
                        from += OF_CUBIC;
                    }
                }
            }
        }
    }
}
