//! Distance of every brick to the nearest visible one, for skipping empty space.

use super::table::Table;
use belvedere_scene::Volume;
use belvedere_scene::volume::BRICK;

/// Edge of a brick, cells.
pub(super) const EDGE: f32 = BRICK as f32;

/// Distances of bricks.
pub(super) struct Leaps {
    dims: [usize; 3],
    /// Chebyshev distance to the nearest brick with anything visible, in bricks; 0 = visible itself.
    distance: Vec<u8>,
}

impl Leaps {
    pub(super) fn new(volume: &Volume, table: &Table) -> Self {
        let dims = volume.bricks().dims();
        let mut distance: Vec<u8> =
            volume.bricks().ranges().iter().map(|r| if table.is_visible(*r) { 0 } else { u8::MAX }).collect();
        // Chebyshev distances part by axes: along x, then y, then z, from both sides.
        let stride = [1, dims[0], dims[0] * dims[1]];
        for axis in 0..3 {
            for i in 0..distance.len() {
                if (i / stride[axis]).is_multiple_of(dims[axis]) {
                    spread(&mut distance, i, stride[axis], dims[axis]);
                }
            }
        }
        Self { dims, distance }
    }

    #[cfg(test)]
    pub(super) fn forget(&mut self) {
        self.distance.fill(0);
    }

    /// Whether no brick is visible.
    pub(super) fn is_clear(&self) -> bool {
        self.distance.iter().all(|d| *d > 0)
    }

    /// Bricks along x, y, z.
    pub(super) fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Whether any of the bricks in the ranges (end excluded) along each axis is visible.
    pub(super) fn shows(&self, cube: [[usize; 2]; 3]) -> bool {
        let [x, y, z] = std::array::from_fn(|a| cube[a][0]..cube[a][1].min(self.dims[a]));
        z.flat_map(|z| y.clone().map(move |y| (z * self.dims[1] + y) * self.dims[0]))
            .any(|row| self.distance[row + x.start..row + x.end].contains(&0))
    }

    /// Distance of a brick by its number, x fastest.
    #[inline(always)]
    pub(super) fn distance(&self, number: usize) -> u8 {
        self.distance.get(number).copied().unwrap_or(0)
    }
}

/// Lowers the distances of one line of bricks: the largest of the distances along the axes counts, so after a pass along one axis an
/// entry `d` away from another is at most the larger of `d` and that other entry.
fn spread(distance: &mut [u8], first: usize, stride: usize, n: usize) {
    let line: Vec<u8> = (0..n).map(|k| distance[first + k * stride]).collect();
    for k in 0..n {
        let mut best = line[k];
        // Only entries nearer than the best so far can improve it.
        for off in 1..n {
            if off >= usize::from(best) {
                break;
            }
            let off_u8 = off as u8;
            for other in [k.checked_sub(off), Some(k + off).filter(|o| *o < n)].into_iter().flatten() {
                best = best.min(line[other].max(off_u8));
            }
        }
        distance[first + k * stride] = best;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_nearest_visible_brick() {
        let dims = [7, 5, 6];
        let visible = [[1usize, 1, 0], [6, 4, 5]];
        let at = |i: usize| [i % 7, i / 7 % 5, i / 35];
        let mut distance: Vec<u8> = (0..210).map(|i| if visible.contains(&at(i)) { 0 } else { u8::MAX }).collect();
        for axis in 0..3 {
            let stride = [1, 7, 35];
            (0..210).filter(|i| at(*i)[axis] == 0).for_each(|i| spread(&mut distance, i, stride[axis], dims[axis]));
        }
        for (i, d) in distance.iter().enumerate() {
            let far = |v: &[usize; 3]| (0..3).map(|a| v[a].abs_diff(at(i)[a])).max();
            assert_eq!(Some(usize::from(*d)), visible.iter().filter_map(far).min(), "{:?}", at(i));
        }
    }
}
