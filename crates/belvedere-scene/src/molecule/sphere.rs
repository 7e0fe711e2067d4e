//! Balls and rods of triangles.

use belvedere_core::DVec3;
use std::collections::HashMap;

/// A unit ball of triangles: an icosahedron whose faces are cut `n` times along each edge and carried onto the sphere.
///
/// Source: geodesic subdivision in its plain form; its triangles are even to a fifth.
pub(super) struct Ball {
    /// Corners on the unit sphere: outward normals.
    pub(super) normals: Vec<DVec3>,
    /// Counter-clockwise from outside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Distance of the nearest face from the centre.
    pub(super) inner: f64,
}

impl Ball {
    /// A ball of 20 `n`^2 triangles.
    pub(super) fn new(n: usize) -> Self {
        let n = n.max(1);
        let (corners, faces) = icosahedron();
        let mut ball = Self { normals: Vec::new(), triangles: Vec::new(), inner: 1.0 };
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        for face in faces {
            let [a, b, c] = face.map(|i| corners[i]);
            // Faces share the corners on their edges.
            let mut at = |i: usize, k: usize| {
                let p = (a * (n - i - k) as f64 + b * i as f64 + c * k as f64).normalize();
                let key = (p * 1e7).round().to_array().map(|v| v as i64);
                *known.entry(key).or_insert_with(|| {
                    ball.normals.push(p);
                    ball.normals.len() as u32 - 1
                })
            };
            for i in 0..n {
                for k in 0..n - i {
                    ball.triangles.push([at(i, k), at(i + 1, k), at(i, k + 1)]);
                    if i + k + 1 < n {
                        ball.triangles.push([at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]);
                    }
                }
            }
        }
        let distance = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| ball.normals[v as usize]);
            (b - a).cross(c - a).normalize().dot(a)
        };
        ball.inner = ball.triangles.iter().map(distance).fold(1.0, f64::min);
        ball
    }

    /// Factor by which the corners lie outside the sphere that the ball stands for, so that the ball is as large as the sphere on average.
    pub(super) fn outer(&self) -> f64 {
        2.0 / (1.0 + self.inner)
    }
}

fn icosahedron() -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut corners = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        corners.extend([DVec3::new(0.0, s, t * g), DVec3::new(s, t * g, 0.0), DVec3::new(t * g, 0.0, s)]);
    }
    // Corners two apart are neighbours; three mutual neighbours are a face.
    let near = |a: usize, b: usize| (corners[a].distance(corners[b]) - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(corners[a]) > 0.0;
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (corners, faces)
}

/// A rod between two points: normals around it, and the corners at both ends in turn, `2 sides` triangles.
///
/// * `axis`: from one end to the other, not zero.
pub(super) fn rod(sides: usize, axis: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let along = axis.normalize_or(DVec3::Z);
    let (u, v) = along.any_orthonormal_pair();
    // Counter-clockwise seen from the tip, for either orientation of the pair.
    let v = if u.cross(v).dot(along) < 0.0 { -v } else { v };
    let normals = (0..sides).map(|i| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / sides as f64).sin_cos();
        cos * u + sin * v
    });
    let n = sides as u32;
    let walls = (0..n).flat_map(|i| {
        let k = (i + 1) % n;
        [[2 * i, 2 * k, 2 * k + 1], [2 * i, 2 * k + 1, 2 * i + 1]]
    });
    (normals.collect(), walls.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_closed_round_and_look_outwards() {
        for n in 1..=8 {
            let ball = Ball::new(n);
            // Euler: corners - edges + faces = 2.
            assert_eq!((ball.normals.len(), ball.triangles.len()), (10 * n * n + 2, 20 * n * n));
            let mut edges = HashMap::new();
            let mut volume = 0.0;
            for t in &ball.triangles {
                let [a, b, c] = t.map(|v| ball.normals[v as usize]);
                assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
                volume += a.dot(b.cross(c)) / 6.0;
                for (p, q) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    *edges.entry((p, q)).or_insert(0) += 1;
                }
            }
            assert!(edges.iter().all(|((p, q), n)| *n == 1 && edges.contains_key(&(*q, *p))), "closed");
            let sphere = 4.0 / 3.0 * std::f64::consts::PI;
            let scaled = volume * ball.outer().powi(3) / sphere;
            assert!(n < 3 || (scaled - 1.0).abs() < 0.02, "{n}: {scaled}");
            assert!(ball.inner > 1.0 - 0.3 / (n * n) as f64, "{n}: {}", ball.inner);
        }
    }

    #[test]
    fn rods_look_outwards() {
        for axis in [DVec3::Z, DVec3::new(1.0, -2.0, 0.5), -DVec3::X] {
            let (normals, triangles) = rod(7, axis);
            let corner = |v: u32| normals[v as usize / 2] + f64::from(v % 2) * axis;
            assert_eq!(triangles.len(), 14);
            for t in triangles {
                let [a, b, c] = t.map(corner);
                let middle =
                    (normals[t[0] as usize / 2] + normals[t[1] as usize / 2] + normals[t[2] as usize / 2]) / 3.0;
                assert!((b - a).cross(c - a).dot(middle) > 0.0);
            }
        }
    }
}
