//! Light from all around that reaches places on large molecules: how far matter in the way dims it, by direction.
//!
//! The lattice holds in each cell how much matter lies in it and, for the six directions along the axes, the share of the light from
//! around that direction. Rays sum up matter on their way, light falls exponentially with it. Source: ambient cubes (McTaggart 2004) with
//! the absorption of Beer and Lambert; figures are ours.

use super::density::Ball;
use belvedere_core::{Aabb, DVec3};
use rayon::prelude::*;

/// Cells along the longest side at most, and their least size, angstrom: of light from nearby, and of light from afar alone.
const MOST: f64 = 72.0;
const NEAR: f64 = 1.6;
const FAR: f64 = 3.0;
/// Distance at which rays begin, angstrom, where light from afar alone is meant: what is nearer is counted elsewhere.
const NEARER: f64 = 6.0;
/// Directions of rays. Each goes on for the longest side, in steps of a cell, farther away of this share of the way, at most of so many
/// cells: thin walls are met at random there, and the mean over rays counts.
const RAYS: usize = 32;
const GROWTH: f64 = 0.12;
const WIDEST: f64 = 2.5;
/// Matter on the way of a ray, cells, behind which no light is counted: 2 % of it are left.
const DARK: f64 = 5.0;
/// Share of light that a cell full of matter takes from a ray along one side.
const TAKEN: f64 = 0.55;
/// Distance before a surface at which its light is taken, cells, and the share of light there over a plane: the cells that it passes are
/// coarse, and stand in the way of slanting rays.
const BEFORE: f64 = 1.3;
const CLEAR: f64 = 0.88;
/// Strength of the whole.
const STRENGTH: f64 = 0.85;

/// Shares of light by cell and direction.
pub(super) struct Sky {
    origin: DVec3,
    cell: f64,
    size: [usize; 3],
    /// Of -x, +x, -y, +y, -z, +z; NaN where it is not known: far from matter.
    lobes: Vec<[f32; 6]>,
}

impl Sky {
    /// Light from near and far, for places on a smooth surface.
    pub(super) fn near(balls: &[Ball]) -> Self {
        Self::new(balls, NEAR, 0.0)
    }

    /// Light from afar, beside what [`super::openness`] says of neighbours.
    pub(super) fn far(balls: &[Ball]) -> Self {
        Self::new(balls, FAR, NEARER)
    }

    fn new(balls: &[Ball], least: f64, from: f64) -> Self {
        let bounds = Aabb::of(balls.iter().map(|b| b.0));
        let longest = (bounds.max - bounds.min).max_element();
        let cell = (longest / MOST).max(least);
        let origin = bounds.min - DVec3::splat(3.0 * cell);
        let size = ((bounds.max - origin) / cell).to_array().map(|n| n as usize + 4);
        let mut matter = vec![0f32; size.into_iter().product()];
        let index = |x: usize, y: usize, z: usize| (z * size[1] + y) * size[0] + x;
        for (c, r) in balls {
            // Bonded atoms share a third of their volume.
            let volume = 0.67 * 4.19 * r.powi(3) / cell.powi(3);
            let q = (*c - origin) / cell - DVec3::splat(0.5);
            let (low, f) = (q.floor(), q - q.floor());
            let [x, y, z] = low.to_array().map(|v| v as usize);
            for k in 0..8 {
                let bits = [k & 1, k >> 1 & 1, k >> 2];
                let w: f64 = (0..3).map(|a| if bits[a] == 1 { f[a] } else { 1.0 - f[a] }).product();
                matter[index(x + bits[0], y + bits[1], z + bits[2])] += (w * volume) as f32;
            }
        }
        matter.iter_mut().for_each(|m| *m = m.min(1.0));
        let length = longest / cell + 3.0;
        let first = (from / cell).max(1.5);
        let rays = Rays { matter: &matter, size, length, first };
        let lobes = (0..matter.len()).into_par_iter().map(|i| rays.lobes(i)).collect();
        Self { origin, cell, size, lobes }
    }

    /// Share of light at a place with a unit normal, in (0, 1].
    pub(super) fn open(&self, p: DVec3, normal: DVec3) -> f64 {
        // Just before the surface, so that it is not in its own way.
        let q = (p + BEFORE * self.cell * normal - self.origin) / self.cell - DVec3::splat(0.5);
        let (low, f) = (q.floor(), q - q.floor());
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in 0..8 {
            let bits = [k & 1, k >> 1 & 1, k >> 2];
            let at: [usize; 3] = std::array::from_fn(|a| (low[a].max(0.0) as usize + bits[a]).min(self.size[a] - 1));
            let w: f64 = (0..3).map(|a| if bits[a] == 1 { f[a] } else { 1.0 - f[a] }).product();
            let lobes = &self.lobes[(at[2] * self.size[1] + at[1]) * self.size[0] + at[0]];
            if lobes[0].is_nan() {
                continue;
            }
            let lit: f64 =
                (0..3).map(|a| normal[a] * normal[a] * f64::from(lobes[2 * a + usize::from(normal[a] > 0.0)])).sum();
            sum += w * (lit / CLEAR).min(1.0);
            weights += w;
        }
        if weights < 1e-6 { 1.0 } else { (1.0 - STRENGTH * (1.0 - sum / weights)).clamp(0.02, 1.0) }
    }
}

struct Rays<'a> {
    matter: &'a [f32],
    size: [usize; 3],
    /// Where rays begin and end, cells.
    first: f64,
    length: f64,
}

impl Rays<'_> {
    fn at(&self, p: DVec3) -> Option<f32> {
        let inside = |v: f64, n: usize| v >= 0.0 && v < n as f64;
        let [nx, ny, nz] = self.size;
        (inside(p.x, nx) && inside(p.y, ny) && inside(p.z, nz))
            .then(|| self.matter[(p.z as usize * ny + p.y as usize) * nx + p.x as usize])
    }

    fn lobes(&self, i: usize) -> [f32; 6] {
        let [nx, ny, _] = self.size;
        let center = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64) + DVec3::splat(0.5);
        let near = (0..125).any(|k| {
            let off = DVec3::new(f64::from(k % 5 - 2), f64::from(k / 5 % 5 - 2), f64::from(k / 25 - 2));
            self.at(center + off).is_some_and(|m| m > 0.0)
        });
        if !near {
            return [f32::NAN; 6];
        }
        let (mut sums, mut weights) = ([0f64; 6], [0f64; 6]);
        for direction in directions() {
            let mut passed = 0.0;
            let mut way = self.first;
            while way < self.length && passed < DARK {
                let step = (GROWTH * way).clamp(1.0, WIDEST);
                let Some(matter) = self.at(center + way * direction) else { break };
                passed += step * f64::from(matter);
                way += step;
            }
            let light = (1.0 - TAKEN).powf(passed);
            for axis in 0..3 {
                let (k, w) = (2 * axis + usize::from(direction[axis] > 0.0), direction[axis].abs());
                sums[k] += w * light;
                weights[k] += w;
            }
        }
        std::array::from_fn(|k| (sums[k] / weights[k].max(1e-9)) as f32)
    }
}

/// Directions all around, evenly: a spiral by the golden angle.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..RAYS).map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / RAYS as f64;
        let (sin, cos) = (2.399_963_229_728_653 * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inside_of_a_shell_is_darker_than_its_outside() {
        // Atoms on a sphere of 30 angstrom, with a hole at the top.
        let n = 2500;
        let on = |k: usize| {
            let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
            let (sin, cos) = (2.399_963_229_728_653 * k as f64).sin_cos();
            30.0 * DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
        };
        let balls: Vec<Ball> = (0..n).map(on).filter(|p| p.z < 25.0).map(|p| (p, 1.7)).collect();
        for (sky, name) in [(Sky::near(&balls), "near"), (Sky::far(&balls), "far")] {
            let outside = sky.open(31.7 * DVec3::X, DVec3::X);
            let inside = sky.open(28.3 * DVec3::X, -DVec3::X);
            let bottom = sky.open(-28.3 * DVec3::Z, DVec3::Z);
            assert!(outside > 0.85, "{name}: {outside}");
            assert!(inside < 0.7 * outside, "{name}: {inside} {outside}");
            assert!(bottom > inside, "{name}: light falls through the hole: {bottom} {inside}");
        }
    }

    #[test]
    fn one_atom_and_places_far_from_matter_are_lit() {
        let sky = Sky::near(&[(DVec3::ONE, 1.7)]);
        for n in [DVec3::X, -DVec3::Y, DVec3::Z, DVec3::ONE.normalize()] {
            let open = sky.open(DVec3::ONE + 1.7 * n, n);
            assert!(open > 0.9 && open <= 1.0, "{open}");
        }
        assert_eq!(sky.open(DVec3::splat(1e5), DVec3::Z), 1.0);
        let sum: DVec3 = directions().sum();
        assert!(sum.length() < 1e-9 + 0.3 && directions().all(|d| (d.length() - 1.0).abs() < 1e-12));
    }
}
