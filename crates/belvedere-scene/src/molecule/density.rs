//! Gaussian density of atoms on a grid of bounded size.
//!
//! Each atom adds exp(B (1 - d^2 / r^2)), r its van der Waals radius, at distance d; where the sum is 1 the surface is drawn. That of one
//! atom alone is its sphere exactly; where atoms are near each other the surface runs smoothly over them. Source: Blinn 1982, with
//! the radii of the atoms as in Grant and Pickup 1995; B is ours.

use belvedere_core::{Aabb, DVec3};
use rayon::prelude::*;

/// How steeply the density of an atom falls.
const STEEP: f64 = 2.2;
/// Distance, as a multiple of the radius, beyond which an atom adds nothing: less than 0.01 there.
const REACH: f64 = 1.78;
/// Density of empty space: the logarithm stays finite.
const LEAST: f32 = 1e-6;
/// Finest spacing, angstrom, most samples, and the square angstrom of surface per atom and triangles by which the spacing is chosen.
const FINEST: f64 = 0.7;
const MOST_SAMPLES: f64 = 2.4e7;
const TRIANGLES: f64 = 5.0e6;
const PER_ATOM: f64 = 16.0;
const PER_CELL: f64 = 4.5;
/// Layers that are made together.
const SLAB: usize = 8;
/// No atom.
const NONE: u32 = u32::MAX;

/// A ball of the density: centre and radius, angstrom.
pub(super) type Ball = (DVec3, f64);

/// Samples of the logarithm of the density, x fastest.
pub(super) struct Density<'b> {
    balls: &'b [Ball],
    pub(super) origin: DVec3,
    pub(super) spacing: f64,
    pub(super) size: [usize; 3],
    /// Natural logarithm of the density, > 0 inside.
    pub(super) values: Vec<f32>,
    /// The ball that adds most at each sample.
    owners: Vec<u32>,
}

/// Spacing of the grid for balls, angstrom: by their number, or by a stated detail (1..=16), and never too fine for the memory.
pub(super) fn spacing(bounds: &Aabb, atoms: usize, detail: Option<u32>) -> f64 {
    let chosen = match detail {
        Some(detail) => 1.6 / f64::from(detail.clamp(1, 16)).sqrt(),
        None => (atoms as f64 * PER_ATOM * PER_CELL / TRIANGLES).sqrt().max(FINEST),
    };
    let sides = bounds.max - bounds.min;
    let mut spacing = chosen;
    while (sides / spacing + 4.0).to_array().into_iter().product::<f64>() > MOST_SAMPLES {
        spacing *= 1.05;
    }
    spacing
}

impl<'b> Density<'b> {
    /// Density of balls, of which there is one at least.
    pub(super) fn new(balls: &'b [Ball], detail: Option<u32>) -> Self {
        let around = |(c, r): &Ball| [*c - DVec3::splat(REACH * r), *c + DVec3::splat(REACH * r)];
        let bounds = Aabb::of(balls.iter().flat_map(around));
        let spacing = spacing(&bounds, balls.len(), detail);
        // A layer of empty samples all around closes the surface.
        let origin = bounds.min - DVec3::splat(spacing);
        let size = ((bounds.max - origin) / spacing).to_array().map(|n| n.ceil() as usize + 2);
        let layer = size[0] * size[1];
        let (mut values, mut owners) = (vec![0f32; layer * size[2]], vec![NONE; layer * size[2]]);
        let slabs = size[2].div_ceil(SLAB);
        let mut of_slab: Vec<Vec<u32>> = vec![Vec::new(); slabs];
        for (i, (c, r)) in balls.iter().enumerate() {
            let place = |z: f64| ((z - origin.z) / spacing).max(0.0) as usize / SLAB;
            for list in &mut of_slab[place(c.z - REACH * r)..=place(c.z + REACH * r).min(slabs - 1)] {
                list.push(i as u32);
            }
        }
        let grid = Grid { origin, spacing, size };
        values.par_chunks_mut(layer * SLAB).zip(owners.par_chunks_mut(layer * SLAB)).enumerate().for_each(
            |(slab, (values, owners))| {
                let mut most = vec![0f32; values.len()];
                for &i in &of_slab[slab] {
                    grid.splat(balls[i as usize], i, slab * SLAB, (&mut *values, &mut *owners, &mut most));
                }
                values.iter_mut().for_each(|v| *v = v.max(LEAST).ln());
            },
        );
        Self { balls, origin, spacing, size, values, owners }
    }

    pub(super) fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    pub(super) fn place(&self, at: [usize; 3]) -> DVec3 {
        self.origin + self.spacing * DVec3::from_array(at.map(|n| n as f64))
    }

    /// Gradient of the values at a sample, per step.
    pub(super) fn gradient(&self, at: [usize; 3]) -> DVec3 {
        let slope = |axis: usize| {
            let (mut low, mut high) = (at, at);
            low[axis] = at[axis].saturating_sub(1);
            high[axis] = (at[axis] + 1).min(self.size[axis] - 1);
            let rise = self.values[self.index(high)] - self.values[self.index(low)];
            f64::from(rise) / (high[axis] - low[axis]).max(1) as f64
        };
        DVec3::new(slope(0), slope(1), slope(2))
    }

    /// The ball that adds most at `p`, of those that add most at some samples; `None` if nothing is added there.
    pub(super) fn owner(&self, p: DVec3, samples: impl IntoIterator<Item = usize>) -> Option<u32> {
        let owners = samples.into_iter().map(|s| self.owners[s]).filter(|o| *o != NONE);
        self.largest(p, owners)
    }

    /// That of some balls that adds most at `p`.
    pub(super) fn largest(&self, p: DVec3, balls: impl IntoIterator<Item = u32>) -> Option<u32> {
        let near = |i: u32| {
            let (c, r) = self.balls[i as usize];
            p.distance_squared(c) / (r * r)
        };
        balls.into_iter().min_by(|&a, &b| near(a).total_cmp(&near(b)).then(a.cmp(&b)))
    }
}

/// Places of samples.
struct Grid {
    origin: DVec3,
    spacing: f64,
    size: [usize; 3],
}

impl Grid {
    /// Adds a ball to the layers of a slab that begin at `first`.
    fn splat(
        &self,
        (c, r): Ball,
        number: u32,
        first: usize,
        (sums, owners, most): (&mut [f32], &mut [u32], &mut [f32]),
    ) {
        let [nx, ny, _] = self.size;
        let layers = sums.len() / (nx * ny);
        let q = (c - self.origin) / self.spacing;
        let reach = REACH * r / self.spacing;
        let range = |x: f64, low: usize, high: usize| {
            let from = (x - reach).ceil().max(low as f64) as usize;
            from..((x + reach).floor() + 1.0).clamp(0.0, high as f64) as usize
        };
        let scale = STEEP / (r / self.spacing).powi(2);
        for z in range(q.z, first, first + layers) {
            let dz = (z as f64 - q.z).powi(2);
            for y in range(q.y, 0, ny) {
                let dyz = dz + (y as f64 - q.y).powi(2);
                let row = ((z - first) * ny + y) * nx;
                for x in range(q.x, 0, nx) {
                    let d = dyz + (x as f64 - q.x).powi(2);
                    if d > reach * reach {
                        continue;
                    }
                    let add = ((STEEP - scale * d) as f32).exp();
                    let at = row + x;
                    sums[at] += add;
                    if add > most[at] {
                        (most[at], owners[at]) = (add, number);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_the_sum_of_its_balls_and_known_who_adds_most() {
        let balls =
            [(DVec3::new(0.3, -0.2, 0.1), 1.7), (DVec3::new(1.4, 0.2, 0.4), 1.5), (DVec3::new(9.0, 3.0, 2.0), 1.2)];
        let d = Density::new(&balls, Some(4));
        for at in [[3, 4, 5], [6, 5, 4], [8, 8, 8], [d.size[0] - 5, 9, 7]] {
            let p = d.place(at);
            let add = |(c, r): &Ball| {
                let share = p.distance_squared(*c) / (r * r);
                if share > REACH * REACH { 0.0 } else { (STEEP * (1.0 - share)).exp() }
            };
            let sum: f64 = balls.iter().map(add).sum();
            let value = f64::from(d.values[d.index(at)]);
            assert!((value - sum.max(f64::from(LEAST)).ln()).abs() < 1e-4, "{at:?} {value} {sum}");
            let largest =
                (0..3).filter(|&i| add(&balls[i]) > 0.0).max_by(|&a, &b| add(&balls[a]).total_cmp(&add(&balls[b])));
            assert_eq!(d.owner(p, [d.index(at)]), largest.map(|i| i as u32));
        }
        let [x, y, z] = d.size;
        let rim = |i: &usize| {
            let at = [i % x, i / x % y, i / x / y];
            at.contains(&0) || at == [x - 1, at[1], at[2]] || at[1] == y - 1 || at[2] == z - 1
        };
        assert!((0..d.values.len()).filter(rim).all(|i| d.values[i] < 0.0), "empty all around");
    }

    #[test]
    fn grids_stay_bounded_however_far_apart_atoms_are() {
        let far = Aabb { min: DVec3::splat(-1e6), max: DVec3::splat(1e6) };
        let h = spacing(&far, 2, None);
        assert!((2e6 / h).powi(3) < 1.01 * MOST_SAMPLES);
        let near = Aabb { min: DVec3::ZERO, max: DVec3::splat(40.0) };
        assert_eq!(spacing(&near, 500, None), FINEST);
        assert!(spacing(&near, 320_000, None) > 1.5);
        assert_eq!(spacing(&near, 500, Some(16)), 0.4);
    }
}
