//! Ranges of values in the bricks of a volume, by which empty space is skipped.

use super::VoxelValues;
use rayon::prelude::*;

/// Cells along an edge of a brick.
pub const BRICK: usize = 8;

/// Ranges of values, one per brick of [`BRICK`]^3 cells, x fastest.
///
/// A brick's range covers the voxels at its borders, which it shares with its neighbours, so it holds every interpolated value.
#[derive(Debug, Clone, PartialEq)]
pub struct Bricks {
    dims: [usize; 3],
    ranges: Vec<[f32; 2]>,
}

impl Bricks {
    pub(super) fn of(dims: [usize; 3], values: &VoxelValues) -> Self {
        match values {
            VoxelValues::U8(v) => Self::summed(dims, v),
            VoxelValues::U16(v) => Self::summed(dims, v),
            VoxelValues::I16(v) => Self::summed(dims, v),
            VoxelValues::F32(v) => Self::summed(dims, v),
        }
    }

    fn summed<T: Copy + PartialOrd + Into<f32> + Sync>([nx, ny, nz]: [usize; 3], values: &[T]) -> Self {
        let dims = [nx, ny, nz].map(|n| (n - 1).div_ceil(BRICK));
        let of = |i: usize| {
            let brick = [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]];
            let span = |a: usize, n: usize| brick[a] * BRICK..(brick[a] * BRICK + BRICK + 1).min(n);
            let xs = span(0, nx);
            let first = values[(span(2, nz).start * ny + span(1, ny).start) * nx + xs.start];
            let (mut lo, mut hi) = (first, first);
            for z in span(2, nz) {
                for y in span(1, ny) {
                    let row = (z * ny + y) * nx;
                    for v in &values[row + xs.start..row + xs.end] {
                        lo = if *v < lo { *v } else { lo };
                        hi = if *v > hi { *v } else { hi };
                    }
                }
            }
            [lo.into(), hi.into()]
        };
        let ranges = (0..dims.iter().product()).into_par_iter().map(of).collect();
        Self { dims, ranges }
    }

    /// Bricks along x, y, z.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Least and greatest value of each.
    pub fn ranges(&self) -> &[[f32; 2]] {
        &self.ranges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bricks_share_their_borders() {
        let dims = [17, 9, 10];
        let mut values = vec![3u8; 17 * 9 * 10];
        values[8] = 200;
        values[(9 * 9 + 8) * 17 + 16] = 1;
        let bricks = Bricks::of(dims, &VoxelValues::U8(values));
        assert_eq!(bricks.dims(), [2, 1, 2]);
        assert_eq!(bricks.ranges(), [[3.0, 200.0], [3.0, 200.0], [3.0, 3.0], [1.0, 3.0]]);
    }
}
