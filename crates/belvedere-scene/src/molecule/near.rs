//! Neighbours in linear time: points sorted into the cells of a lattice.

use belvedere_core::DVec3;
use std::collections::HashMap;

/// Points by the cell they lie in.
pub(super) struct Cells {
    size: f64,
    /// Range of `order` by cell.
    ranges: HashMap<[i32; 3], [u32; 2]>,
    order: Vec<u32>,
    points: Vec<DVec3>,
}

impl Cells {
    /// * `size`: side of a cell, > 0; also the reach of [`Cells::near`].
    pub(super) fn new(points: Vec<DVec3>, size: f64) -> Self {
        let cell = |p: DVec3| cell_of(p, size);
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_by_cached_key(|&i| cell(points[i as usize]));
        let mut ranges: HashMap<[i32; 3], [u32; 2]> = HashMap::new();
        for (at, &i) in order.iter().enumerate() {
            let at = at as u32;
            ranges.entry(cell(points[i as usize])).or_insert([at, at])[1] = at + 1;
        }
        Self { size, ranges, order, points }
    }

    /// Visits the indices of all points nearer to `p` than the side of a cell, and their squared distances.
    pub(super) fn near(&self, p: DVec3, mut visit: impl FnMut(usize, f64)) {
        let [x, y, z] = cell_of(p, self.size);
        for cell in (0..27).map(|k| [x + k / 9 - 1, y + k / 3 % 3 - 1, z + k % 3 - 1]) {
            let Some(&[from, to]) = self.ranges.get(&cell) else { continue };
            for &i in &self.order[from as usize..to as usize] {
                let distance = self.points[i as usize].distance_squared(p);
                if distance < self.size * self.size {
                    visit(i as usize, distance);
                }
            }
        }
    }
}

fn cell_of(p: DVec3, size: f64) -> [i32; 3] {
    (p / size).floor().to_array().map(|v| v as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_find_what_looking_at_all_finds() {
        let mut seed = 3u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        let points: Vec<DVec3> = (0..400).map(|_| 20.0 * (DVec3::new(next(), next(), next()) - 0.5)).collect();
        let cells = Cells::new(points.clone(), 3.0);
        let mut found_any = 0;
        for p in &points {
            let mut found = Vec::new();
            cells.near(*p, |i, _| found.push(i));
            found.sort_unstable();
            found_any += found.len();
            let all: Vec<usize> = (0..points.len()).filter(|&i| points[i].distance(*p) < 3.0).collect();
            assert_eq!(found, all);
        }
        assert!(found_any > 2000, "{found_any}");
    }
}
