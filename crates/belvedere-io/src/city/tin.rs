//! Triangulation of a polygon, refined by longest-edge bisection until a height function is met; neighbours share their corners.

use belvedere_scene::Polygon;
use earcut::Earcut;
use glam::DVec2;
use std::collections::HashMap;

/// Edges shorter than this are not halved, metres.
const SHORTEST_M: f64 = 4.0;
/// Most pieces along an edge of a triangle between which heights are compared.
const MOST_STEPS: usize = 24;
/// Rounds of refinement.
const ROUNDS: usize = 14;

/// Triangles of a polygon in plan, counter-clockwise.
#[derive(Debug, Clone, Default)]
pub(super) struct Tin {
    pub points: Vec<DVec2>,
    pub triangles: Vec<[u32; 3]>,
    /// Triangle to the left of every directed edge.
    left_of: HashMap<[u32; 2], usize>,
}

/// A sample position in a triangle, its barycentric weights, and the area that it represents, m^2.
pub(super) struct Sample {
    pub at: DVec2,
    pub triangle: usize,
    pub shares: [f64; 3],
    pub area_m2: f64,
}

impl Tin {
    /// The triangles of a polygon; `None` if its rings touch, so that an edge has two triangles on one side.
    pub(super) fn of(polygon: &Polygon, earcut: &mut Earcut<f64>) -> Option<Self> {
        let rings = || std::iter::once(&polygon.outer).chain(&polygon.holes);
        let points: Vec<DVec2> = rings().flatten().copied().collect();
        let origin = *points.first()?;
        let starts = rings().scan(0, |sum, ring| {
            *sum += ring.len() as u32;
            Some(*sum)
        });
        let holes: Vec<u32> = starts.take(polygon.holes.len()).collect();
        let mut corners: Vec<u32> = Vec::new();
        earcut.earcut(points.iter().map(|p| (*p - origin).to_array()), &holes, &mut corners);
        let mut out = Self { points, ..Self::default() };
        for t in corners.chunks_exact(3) {
            let turned = out.doubled_area([t[0], t[1], t[2]]) < 0.0;
            let triangle = if turned { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] };
            out.triangles.push(triangle);
            for edge in edges(triangle) {
                if out.left_of.insert(edge, out.triangles.len() - 1).is_some() {
                    return None;
                }
            }
        }
        (!out.triangles.is_empty()).then_some(out)
    }

    fn doubled_area(&self, [a, b, c]: [u32; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| self.points[i as usize]);
        (b - a).perp_dot(c - a)
    }

    fn left(&mut self, edge: [u32; 2], number: usize) {
        self.left_of.insert(edge, number);
    }

    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        self.points[a as usize].distance(self.points[b as usize])
    }

    /// Edges with the polygon on their left only.
    pub(super) fn rim(&self) -> Vec<[u32; 2]> {
        let edges = self.triangles.iter().flat_map(|t| edges(*t));
        edges.filter(|[a, b]| !self.left_of.contains_key(&[*b, *a])).collect()
    }

    /// Samples over a triangle and its edges, at most `step` metres apart, or 25 along an edge.
    pub(super) fn samples(&self, number: usize, step: f64) -> impl Iterator<Item = Sample> + '_ {
        let corners = self.triangles[number];
        let longest = edges(corners).map(|e| self.length(e)).into_iter().fold(0.0, f64::max);
        let n = ((longest / step).ceil() as usize).clamp(1, MOST_STEPS);
        let area_m2 = 0.5 * self.doubled_area(corners) / ((n + 1) * (n + 2) / 2) as f64;
        (0..=n).flat_map(move |i| {
            (0..=n - i).map(move |j| {
                let shares = [i, j, n - i - j].map(|k| k as f64 / n as f64);
                let at = (0..3).map(|k| shares[k] * self.points[corners[k] as usize]).sum();
                Sample { at, triangle: number, shares, area_m2 }
            })
        })
    }

    /// Halves edges until `worst` of every triangle, the largest difference of heights in it, is at most `tolerance`, or there are
    /// `most` triangles.
    pub(super) fn refine(&mut self, tolerance: f64, most: usize, worst: impl Fn(&Self, usize) -> f64) {
        let mut dirty: Vec<usize> = (0..self.triangles.len()).collect();
        for _ in 0..ROUNDS {
            let mut bad: Vec<[u32; 2]> = Vec::new();
            for number in std::mem::take(&mut dirty) {
                let Some(longest) = self.longest(number).filter(|_| worst(self, number) > tolerance) else { continue };
                bad.push(longest);
            }
            bad.sort_by(|a, b| self.length(*b).total_cmp(&self.length(*a)));
            for [a, b] in bad {
                let known = self.left_of.contains_key(&[a, b]) || self.left_of.contains_key(&[b, a]);
                if known && self.triangles.len() < most {
                    self.halve([a, b], &mut dirty);
                }
            }
            dirty.sort_unstable();
            dirty.dedup();
            if dirty.is_empty() {
                break;
            }
        }
    }

    fn longest(&self, number: usize) -> Option<[u32; 2]> {
        let all = edges(self.triangles[number]).into_iter();
        all.max_by(|a, b| self.length(*a).total_cmp(&self.length(*b))).filter(|e| self.length(*e) >= 2.0 * SHORTEST_M)
    }

    fn halve(&mut self, [a, b]: [u32; 2], dirty: &mut Vec<usize>) {
        let middle = self.points.len() as u32;
        self.points.push(0.5 * (self.points[a as usize] + self.points[b as usize]));
        let mut outer = Vec::new();
        for [a, b] in [[a, b], [b, a]] {
            let Some(number) = self.left_of.remove(&[a, b]) else { continue };
            let c = opposite(self.triangles[number], [a, b]);
            let second = self.triangles.len();
            self.triangles.push([middle, b, c]);
            self.triangles[number] = [a, middle, c];
            for (triangle, number) in [([a, middle, c], number), ([middle, b, c], second)] {
                edges(triangle).into_iter().for_each(|e| self.left(e, number));
                dirty.push(number);
            }
            outer.extend([[b, c], [c, a]]);
        }
        self.make_delaunay(outer, dirty);
    }

    /// Turns edges whose triangles see each other's corner within their circle.
    fn make_delaunay(&mut self, mut edges_left: Vec<[u32; 2]>, dirty: &mut Vec<usize>) {
        let mut turns = 0;
        while let Some([a, b]) = edges_left.pop() {
            let (Some(&one), Some(&two)) = (self.left_of.get(&[a, b]), self.left_of.get(&[b, a])) else { continue };
            let (c, d) = (opposite(self.triangles[one], [a, b]), opposite(self.triangles[two], [b, a]));
            if turns > 200 || !self.should_turn([a, b], [c, d]) {
                continue;
            }
            turns += 1;
            self.left_of.remove(&[a, b]);
            self.left_of.remove(&[b, a]);
            for (number, triangle) in [(one, [c, d, b]), (two, [d, c, a])] {
                self.triangles[number] = triangle;
                edges(triangle).into_iter().for_each(|e| self.left(e, number));
                dirty.push(number);
            }
            edges_left.extend([[a, d], [d, b], [b, c], [c, a]]);
        }
    }

    fn should_turn(&self, [a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
        let [p, q, r, s] = [a, b, c, d].map(|i| self.points[i as usize]);
        let angle = |at: DVec2| (p - at).angle_to(q - at).abs();
        let convex = [[c, d, b], [d, c, a]].into_iter().all(|t| self.doubled_area(t) > 1e-6);
        convex && angle(r) + angle(s) > std::f64::consts::PI + 1e-6
    }
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The corner of a triangle that is not on an edge of it.
fn opposite(triangle: [u32; 3], edge: [u32; 2]) -> u32 {
    triangle.into_iter().find(|v| !edge.contains(v)).unwrap_or(triangle[0])
}
