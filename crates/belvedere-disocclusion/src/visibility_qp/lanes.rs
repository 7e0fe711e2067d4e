//! Neighbouring lines of sight abreast, one per lane of a register: a bound of what they miss, by which most are let pass.

use super::register::{LANES, Lane, indices, load, split, store};
use super::surface::{Surface, facet_in_cell};
use super::walk::{Chord, Clearance};
use pulp::{Arch, Simd, WithSimd};

/// Straight lines of sight from their points to the eye, each over the part of it that counts. Spare lanes repeat the last
/// line.
pub(super) struct Lanes {
    /// Points by axis; the third is x - y.
    p: [Lane; 3],
    /// Vectors from the points to the eye, by the same axes, and their inverses.
    d: [Lane; 3],
    per: [Lane; 3],
    /// Heights of the lines at the points, and their rise from there to the eye.
    z: [Lane; 2],
    part: [Lane; 2],
    /// Clearance without its tolerance: at the point, and by how much more far from it.
    asked: [f64; 2],
}

impl Lanes {
    /// * `lines`: with the parts of them that count; not empty, at most [`LANES`].
    pub(super) fn new(lines: &[(usize, Chord, [f64; 2])], clearance: &Clearance) -> Self {
        let each = |of: &dyn Fn(&Chord, [f64; 2]) -> f64| -> Lane {
            std::array::from_fn(|l| {
                let (_, chord, part) = &lines[l.min(lines.len() - 1)];
                of(chord, *part)
            })
        };
        let p = [each(&|c, _| c.ends[0].x), each(&|c, _| c.ends[0].y), each(&|c, _| c.ends[0].x - c.ends[0].y)];
        let way = |c: &Chord| c.ends[1] - c.ends[0];
        let d = [each(&|c, _| way(c).x), each(&|c, _| way(c).y), each(&|c, _| way(c).x - way(c).y)];
        Self {
            p,
            d,
            per: d.map(|d| d.map(|d| 1.0 / d)),
            z: [each(&|c, _| c.z[0]), each(&|c, _| c.z[1] - c.z[0])],
            part: [each(&|_, part| part[0]), each(&|_, part| part[1])],
            asked: [clearance.near, 1.0 - clearance.near].map(|s| s * (clearance.margin - clearance.tolerance)),
        }
    }

    /// For each part (the same for all lines) and each line, the largest height by which it misses the required clearance beyond the
    /// tolerance; negative where all kinks and ends keep it.
    pub(super) fn most(&self, surface: &Surface, parts: &[[f64; 2]], out: &mut Vec<Lane>) {
        Arch::new().dispatch(Most { lanes: self, surface, parts, out });
    }
}

/// Task for the widest available SIMD registers.
struct Most<'a> {
    lanes: &'a Lanes,
    surface: &'a Surface,
    parts: &'a [[f64; 2]],
    out: &'a mut Vec<Lane>,
}

impl WithSimd for Most<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let begin = self.out.len();
        self.out.resize(begin + self.parts.len(), [0.0; LANES]);
        for k in 0..LANES / S::F64_LANES {
            let lines = Register::new(simd, self.lanes, k);
            for (part, out) in self.parts.iter().zip(&mut self.out[begin..]) {
                S::as_mut_simd_f64s(out).0[k] = lines.most(self.surface, *part);
            }
        }
    }
}

/// Lines of one register.
struct Register<S: Simd> {
    simd: S,
    p: [S::f64s; 3],
    d: [S::f64s; 3],
    per: [S::f64s; 3],
    z: [S::f64s; 2],
    part: [S::f64s; 2],
    asked: [S::f64s; 2],
}

/// Positions of the lines, each at a parameter of its own.
#[derive(Clone, Copy)]
struct Place<S: Simd> {
    t: S::f64s,
    x: S::f64s,
    y: S::f64s,
}

impl<S: Simd> Register<S> {
    /// The k-th register of lanes.
    #[inline(always)]
    fn new(simd: S, lanes: &Lanes, k: usize) -> Self {
        let one = |lane: &Lane| S::as_simd_f64s(lane).0[k];
        let three = |[a, b, c]: &[Lane; 3]| [one(a), one(b), one(c)];
        let two = |[a, b]: &[Lane; 2]| [one(a), one(b)];
        Self {
            simd,
            p: three(&lanes.p),
            d: three(&lanes.d),
            per: three(&lanes.per),
            z: two(&lanes.z),
            part: two(&lanes.part),
            asked: lanes.asked.map(|asked| simd.splat_f64s(asked)),
        }
    }

    /// At every kink of the drawn ground and of the displacement, and at the ends.
    #[inline(always)]
    fn most(&self, surface: &Surface, [a, b]: [f64; 2]) -> S::f64s {
        let simd = self.simd;
        let within = [simd.max_f64s(self.part[0], simd.splat_f64s(a)), simd.min_f64s(self.part[1], simd.splat_f64s(b))];
        let mut most = simd.splat_f64s(f64::NEG_INFINITY);
        self.edges::<0>(surface, within, &mut most);
        self.edges::<1>(surface, within, &mut most);
        self.edges::<2>(surface, within, &mut most);
        if simd.reduce_max_f64s(self.part[0]) >= a {
            self.judge_between(surface, within[0], within, &mut most);
        }
        if simd.reduce_min_f64s(self.part[1]) <= b {
            self.judge_between(surface, within[1], within, &mut most);
        }
        most
    }

    #[inline(always)]
    fn at(&self, axis: usize, t: S::f64s) -> S::f64s {
        self.simd.mul_add_e_f64s(t, self.d[axis], self.p[axis])
    }

    /// Parameters at which a coordinate (x, y, x - y) has a value.
    #[inline(always)]
    fn crossing(&self, axis: usize, value: f64) -> S::f64s {
        let simd = self.simd;
        simd.mul_f64s(simd.sub_f64s(simd.splat_f64s(value), self.p[axis]), self.per[axis])
    }

    /// First and last whole value of a coordinate within the parts, and possibly one more.
    #[inline(always)]
    fn range(&self, axis: usize, [from, to]: [S::f64s; 2]) -> [f64; 2] {
        // Parts may end at one; rounding must not lose it.
        const NUDGE: f64 = 1e-6;
        let (a, b) = (self.at(axis, from), self.at(axis, to));
        let low = self.simd.reduce_min_f64s(self.simd.min_f64s(a, b));
        let high = self.simd.reduce_max_f64s(self.simd.max_f64s(a, b));
        [(low - NUDGE).ceil(), (high + NUDGE).floor()]
    }

    /// Kinks at one family of edges: lines x = k, y = k, or x - y = k.
    #[inline(always)]
    fn edges<const FAMILY: usize>(&self, surface: &Surface, within: [S::f64s; 2], most: &mut S::f64s) {
        let simd = self.simd;
        let last = [(surface.cols - 1) as f64, (surface.rows - 1) as f64];
        let cols = simd.splat_f64s(surface.cols as f64);
        // The diagonals of the corners are nodes of the other families.
        let limits = [[0.0, last[0]], [0.0, last[1]], [1.0 - last[1], last[0] - 1.0]][FAMILY];
        let none = simd.splat_f64s(0.0);
        let [first, end] = self.range(FAMILY, within);
        let (mut k, until) = (first.max(limits[0]), end.min(limits[1]));
        let stride = [surface.cols, 1, surface.cols + 1][FAMILY];
        // The coordinate that runs along the edges.
        let along = usize::from(FAMILY == 0);
        while k <= until {
            let (t, line) = (self.crossing(FAMILY, k), simd.splat_f64s(k));
            let place = self.at(along, t);
            let end = if FAMILY == 2 { last[0].min(last[1] + k) } else { last[along] } - 1.0;
            let (whole, share) = split(simd, place, end);
            let (corner, x, y) = match FAMILY {
                0 => (simd.mul_add_e_f64s(whole, cols, line), line, place),
                1 => (simd.mul_add_e_f64s(line, cols, whole), place, line),
                _ => {
                    let row = simd.max_f64s(simd.sub_f64s(whole, line), simd.splat_f64s(0.0));
                    (simd.mul_add_e_f64s(row, cols, whole), place, simd.sub_f64s(place, line))
                }
            };
            let node = indices(simd, corner);
            let (mut from, mut to) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..S::F64_LANES {
                let node = node[l] as usize;
                (from[l], to[l]) = (surface.heights[node], surface.heights[node + stride]);
            }
            let (from, to) = (load::<S>(&from), load::<S>(&to));
            let ground = simd.mul_add_e_f64s(share, simd.sub_f64s(to, from), from);
            let facet = if FAMILY == 2 { simd.sub_f64s(share, simd.mul_f64s(share, share)) } else { none };
            self.judge(surface, Place { t, x, y }, [ground, facet], within, most);
            k += 1.0;
        }
    }

    /// Takes positions within the parts into account.
    ///
    /// * `facet`: how far facets lie over the bilinear displacement, per factor of xy in a cell of the field.
    #[inline(always)]
    fn judge(
        &self,
        surface: &Surface,
        place: Place<S>,
        [ground, facet]: [S::f64s; 2],
        within: [S::f64s; 2],
        most: &mut S::f64s,
    ) {
        let (simd, lattice) = (self.simd, &surface.lattice);
        let last = [lattice.cols, lattice.rows].map(|n| (n.max(2) - 2) as f64);
        let per = [lattice.step.x, lattice.step.y].map(|step| simd.splat_f64s(1.0 / step));
        let (col, x) = split(simd, simd.mul_f64s(place.x, per[0]), last[0]);
        let (row, y) = split(simd, simd.mul_f64s(place.y, per[1]), last[1]);
        let cell = indices(simd, simd.mul_add_e_f64s(row, simd.splat_f64s(last[0] + 1.0), col));
        let mut patch = [[0.0; LANES]; 4];
        for l in 0..S::F64_LANES {
            let [c, cx, cy, cxy] = surface.patches[cell[l] as usize];
            (patch[0][l], patch[1][l], patch[2][l], patch[3][l]) = (c, cx, cy, cxy);
        }
        let [c, cx, cy, cxy] = [0, 1, 2, 3].map(|k| load::<S>(&patch[k]));
        let u = simd.mul_add_e_f64s(y, simd.mul_add_e_f64s(x, cxy, cy), simd.mul_add_e_f64s(x, cx, c));
        let u = simd.mul_add_e_f64s(simd.mul_f64s(facet, cxy), simd.mul_f64s(per[0], per[1]), u);
        let line = simd.mul_add_e_f64s(place.t, self.z[1], self.z[0]);
        let share = simd.min_f64s(simd.mul_f64s(simd.splat_f64s(5.0), place.t), simd.splat_f64s(1.0));
        let over = simd.sub_f64s(simd.add_f64s(ground, u), line);
        let missing = simd.mul_add_e_f64s(self.asked[1], share, simd.add_f64s(self.asked[0], over));
        let after = simd.less_than_or_equal_f64s(within[0], place.t);
        let counts = simd.and_m64s(after, simd.less_than_or_equal_f64s(place.t, within[1]));
        *most = simd.select_f64s(counts, simd.max_f64s(missing, *most), *most);
    }

    /// As [`Self::judge`], anywhere on the triangles.
    #[inline(always)]
    fn judge_between(&self, surface: &Surface, t: S::f64s, within: [S::f64s; 2], most: &mut S::f64s) {
        let place = Place { t, x: self.at(0, t), y: self.at(1, t) };
        let (x, y) = (store::<S>(place.x), store::<S>(place.y));
        let (mut ground, mut facet) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..S::F64_LANES {
            ground[l] = surface.ground([x[l], y[l]].into());
            facet[l] = facet_in_cell([x[l], y[l]].into());
        }
        self.judge(surface, place, [load::<S>(&ground), load::<S>(&facet)], within, most);
    }
}

#[cfg(test)]
mod tests;
