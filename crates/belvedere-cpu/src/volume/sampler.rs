//! Trilinear interpolation of several positions at once, and of gradients.

use crate::simd::nearest;
use belvedere_scene::Volume;

/// A stored value; neighbours along x are read together.
pub(super) trait Voxel: Copy + Sync {
    type Two: Copy;
    type Four: Copy;
    const NO_TWO: Self::Two;
    const NO_FOUR: Self::Four;
    fn two(values: [Self; 2]) -> Self::Two;
    fn four(values: [Self; 4]) -> Self::Four;
    /// Value `K` of the two that were read.
    fn of_two<const K: usize>(two: Self::Two) -> f32;
    fn of_four<const K: usize>(four: Self::Four) -> f32;
}

impl Voxel for u8 {
    type Two = u16;
    type Four = u32;
    const NO_TWO: u16 = 0;
    const NO_FOUR: u32 = 0;

    #[inline(always)]
    fn two(values: [u8; 2]) -> u16 {
        u16::from_le_bytes(values)
    }

    #[inline(always)]
    fn four(values: [u8; 4]) -> u32 {
        u32::from_le_bytes(values)
    }

    #[inline(always)]
    fn of_two<const K: usize>(two: u16) -> f32 {
        ((u32::from(two) >> (8 * K)) & 0xff) as i32 as f32
    }

    #[inline(always)]
    fn of_four<const K: usize>(four: u32) -> f32 {
        ((four >> (8 * K)) & 0xff) as i32 as f32
    }
}

/// Two 16-bit numbers in one word: `K` of them to a float.
macro_rules! sixteen_bits {
    ($type:ty, $two:expr) => {
        impl Voxel for $type {
            type Two = u32;
            type Four = [u32; 2];
            const NO_TWO: u32 = 0;
            const NO_FOUR: [u32; 2] = [0; 2];

            #[inline(always)]
            fn two([a, b]: [$type; 2]) -> u32 {
                u32::from(a.cast_unsigned_16()) | (u32::from(b.cast_unsigned_16()) << 16)
            }

            #[inline(always)]
            fn four([a, b, c, d]: [$type; 4]) -> [u32; 2] {
                [Self::two([a, b]), Self::two([c, d])]
            }

            #[inline(always)]
            fn of_two<const K: usize>(two: u32) -> f32 {
                let half: fn(u32, usize) -> i32 = $two;
                half(two, K) as f32
            }

            #[inline(always)]
            fn of_four<const K: usize>(four: [u32; 2]) -> f32 {
                let half: fn(u32, usize) -> i32 = $two;
                half(four[K / 2], K % 2) as f32
            }
        }
    };
}

/// Bits of 16-bit numbers.
trait Bits {
    fn cast_unsigned_16(self) -> u16;
}

impl Bits for u16 {
    #[inline(always)]
    fn cast_unsigned_16(self) -> u16 {
        self
    }
}

impl Bits for i16 {
    #[inline(always)]
    fn cast_unsigned_16(self) -> u16 {
        self.cast_unsigned()
    }
}

sixteen_bits!(u16, |two, k| ((two >> (16 * k)) & 0xffff) as i32);
sixteen_bits!(i16, |two, k| ((two << (16 - 16 * k)) as i32) >> 16);

impl Voxel for f32 {
    type Two = [f32; 2];
    type Four = [f32; 4];
    const NO_TWO: [f32; 2] = [0.0; 2];
    const NO_FOUR: [f32; 4] = [0.0; 4];

    #[inline(always)]
    fn two(values: [f32; 2]) -> [f32; 2] {
        values
    }

    #[inline(always)]
    fn four(values: [f32; 4]) -> [f32; 4] {
        values
    }

    #[inline(always)]
    fn of_two<const K: usize>(two: [f32; 2]) -> f32 {
        two[K]
    }

    #[inline(always)]
    fn of_four<const K: usize>(four: [f32; 4]) -> f32 {
        four[K]
    }
}

/// The voxels of a volume.
#[derive(Clone, Copy)]
pub(super) struct Sampler<'v, T> {
    values: &'v [T],
    /// Index strides along y and z.
    stride: [usize; 2],
    /// Largest coordinates, and numbers of the last cells.
    most: [f32; 3],
    last: [i32; 3],
}

/// Cells of positions, and the fractions inside them.
struct Cells<const N: usize> {
    cell: [[i32; N]; 3],
    share: [[f32; N]; 3],
}

#[inline(always)]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

impl<'v, T: Voxel> Sampler<'v, T> {
    /// * `values`: those of `volume`.
    pub(super) fn new(volume: &Volume, values: &'v [T]) -> Self {
        let [nx, ny, nz] = volume.dims();
        let most = [nx, ny, nz].map(|n| (n - 1) as f32);
        Self { values, stride: [nx, nx * ny], most, last: [nx, ny, nz].map(|n| n as i32 - 2) }
    }

    #[inline(always)]
    fn cells<const N: usize>(&self, p: &[[f32; N]; 3]) -> Cells<N> {
        let mut cell = [[0i32; N]; 3];
        let mut share = [[0.0f32; N]; 3];
        for a in 0..3 {
            let (most, last) = (self.most[a], self.last[a]);
            for l in 0..N {
                // In this order NaN becomes 0.
                let q = if p[a][l] > 0.0 { p[a][l] } else { 0.0 };
                let q = if q < most { q } else { most };
                // Rounds down; on a whole number perhaps to the one before, which gives the same value.
                let c = nearest(q - 0.5).min(last).max(0);
                cell[a][l] = c;
                share[a][l] = q - c as f32;
            }
        }
        Cells { cell, share }
    }

    /// Indices of the first voxels of cells.
    #[inline(always)]
    fn numbers<const N: usize>(&self, cell: &[[i32; N]; 3]) -> [usize; N] {
        let [sy, sz] = self.stride;
        let mut within = [0u32; N];
        for l in 0..N {
            // A layer has at most 2^32 voxels.
            within[l] = cell[1][l] as u32 * sy as u32 + cell[0][l] as u32;
        }
        let mut out = [0; N];
        for l in 0..N {
            out[l] = cell[2][l] as usize * sz + within[l] as usize;
        }
        out
    }

    #[inline(always)]
    fn two(&self, rest: &[T], off: usize) -> T::Two {
        match rest.get(off..off + 2) {
            Some(&[a, b]) => T::two([a, b]),
            _ => T::NO_TWO,
        }
    }

    #[inline(always)]
    fn four(&self, at: usize) -> T::Four {
        match self.values.get(at..).and_then(|v| v.first_chunk::<4>()) {
            Some(v) => T::four(*v),
            None => T::NO_FOUR,
        }
    }

    /// Values at lattice coordinates; positions outside are clamped.
    #[inline(always)]
    pub(super) fn at<const N: usize>(&self, p: &[[f32; N]; 3]) -> [f32; N] {
        let Cells { cell, share } = self.cells(p);
        let [sy, sz] = self.stride;
        let numbers = self.numbers(&cell);
        let mut rows = [[T::NO_TWO; N]; 4];
        for l in 0..N {
            let rest = self.values.get(numbers[l]..).unwrap_or(&[]);
            for (k, off) in [0, sy, sz, sz + sy].into_iter().enumerate() {
                rows[k][l] = self.two(rest, off);
            }
        }
        let mut out = [0.0; N];
        for l in 0..N {
            let x = |k: usize| mix(T::of_two::<0>(rows[k][l]), T::of_two::<1>(rows[k][l]), share[0][l]);
            let (y0, y1) = (mix(x(0), x(1), share[1][l]), mix(x(2), x(3), share[1][l]));
            out[l] = mix(y0, y1, share[2][l]);
        }
        out
    }

    /// Central differences over two voxels, per voxel.
    #[inline(always)]
    pub(super) fn gradients<const N: usize>(&self, p: &[[f32; N]; 3]) -> [[f32; N]; 3] {
        let Cells { mut cell, share } = self.cells(p);
        let mut deep = [true; N];
        for (along, last) in cell.iter().zip(self.last) {
            for l in 0..N {
                deep[l] &= along[l] >= 1 && along[l] < last;
            }
        }
        let Some(inner) = deep.iter().position(|d| *d) else { return self.gradients_anywhere(p) };
        if deep.iter().all(|d| *d) {
            return self.gradients_inside(&self.numbers(&cell), &share);
        }
        // What a position gets does not depend on the others.
        for along in &mut cell {
            let instead = along[inner];
            for l in 0..N {
                along[l] = if deep[l] { along[l] } else { instead };
            }
        }
        let (inside, border) = (self.gradients_inside(&self.numbers(&cell), &share), self.gradients_anywhere(p));
        std::array::from_fn(|a| std::array::from_fn(|l| if deep[l] { inside[a][l] } else { border[a][l] }))
    }

    /// Away from the border: interpolated differences of the neighbouring voxels, which gives the same result.
    #[inline(always)]
    fn gradients_inside<const N: usize>(&self, numbers: &[usize; N], share: &[[f32; N]; 3]) -> [[f32; N]; 3] {
        let [sy, sz] = self.stride;
        // Rows of four along x by their offsets along y and z, -1..=2; those at both ends of both are not needed.
        let mut rows = [[[T::NO_FOUR; N]; 4]; 4];
        for (z, rows) in rows.iter_mut().enumerate() {
            for (y, row) in rows.iter_mut().enumerate() {
                if (y == 0 || y == 3) && (z == 0 || z == 3) {
                    continue;
                }
                for l in 0..N {
                    row[l] = self.four(numbers[l] + z * sz + y * sy - sz - sy - 1);
                }
            }
        }
        let mut out = [[0.0; N]; 3];
        for l in 0..N {
            let [fx, fy, fz] = [share[0][l], share[1][l], share[2][l]];
            // Along x through the middle, and the difference over two voxels.
            let along = |z: usize, y: usize| mix(T::of_four::<1>(rows[z][y][l]), T::of_four::<2>(rows[z][y][l]), fx);
            let change = |z: usize, y: usize| {
                let row = rows[z][y][l];
                let (before, after) =
                    (T::of_four::<2>(row) - T::of_four::<0>(row), T::of_four::<3>(row) - T::of_four::<1>(row));
                mix(before, after, fx)
            };
            out[0][l] = 0.5 * mix(mix(change(1, 1), change(1, 2), fy), mix(change(2, 1), change(2, 2), fy), fz);
            let over_y = |z: usize| mix(along(z, 2) - along(z, 0), along(z, 3) - along(z, 1), fy);
            out[1][l] = 0.5 * mix(over_y(1), over_y(2), fz);
            let plane = |z: usize| mix(along(z, 1), along(z, 2), fy);
            out[2][l] = 0.5 * mix(plane(2) - plane(0), plane(3) - plane(1), fz);
        }
        out
    }

    #[inline(never)]
    fn gradients_anywhere<const N: usize>(&self, p: &[[f32; N]; 3]) -> [[f32; N]; 3] {
        let moved = |axis: usize, by: f32| {
            let mut q = *p;
            q[axis].iter_mut().for_each(|v| *v += by);
            self.at(&q)
        };
        std::array::from_fn(|axis| {
            let (after, before) = (moved(axis, 1.0), moved(axis, -1.0));
            std::array::from_fn(|l| 0.5 * (after[l] - before[l]))
        })
    }
}

#[cfg(test)]
mod tests;
