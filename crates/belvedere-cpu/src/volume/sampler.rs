//! Trilinear interpolation of several positions at once.

use crate::simd::nearest;
use belvedere_scene::Volume;

/// Positions that are interpolated together.
pub(super) const GROUP: usize = 8;
pub(super) type Group = [f32; GROUP];

/// A stored value.
pub(super) trait Voxel: Copy + Sync {
    fn number(self) -> f32;
}

impl Voxel for u8 {
    #[inline(always)]
    fn number(self) -> f32 {
        f32::from(self)
    }
}

impl Voxel for u16 {
    #[inline(always)]
    fn number(self) -> f32 {
        f32::from(self)
    }
}

impl Voxel for i16 {
    #[inline(always)]
    fn number(self) -> f32 {
        f32::from(self)
    }
}

impl Voxel for f32 {
    #[inline(always)]
    fn number(self) -> f32 {
        self
    }
}

/// The voxels of a volume.
#[derive(Clone, Copy)]
pub(super) struct Sampler<'v, T> {
    values: &'v [T],
    /// Voxels to the next along y and z.
    stride: [usize; 2],
    /// Largest coordinates, and those of the last cell.
    most: [f32; 3],
    last: [i32; 3],
}

impl<'v, T: Voxel> Sampler<'v, T> {
    /// * `values`: those of `volume`.
    pub(super) fn new(volume: &Volume, values: &'v [T]) -> Self {
        let [nx, ny, nz] = volume.dims();
        let most = [nx, ny, nz].map(|n| (n - 1) as f32);
        Self { values, stride: [nx, nx * ny], most, last: [nx, ny, nz].map(|n| n as i32 - 2) }
    }

    /// Values at lattice coordinates; positions outside count as the nearest inside.
    #[inline(always)]
    pub(super) fn at(&self, p: &[Group; 3]) -> Group {
        let mut cell = [[0i32; GROUP]; 3];
        let mut f = [[0.0f32; GROUP]; 3];
        for a in 0..3 {
            let (most, last) = (self.most[a], self.last[a]);
            for l in 0..GROUP {
                // In this order NaN becomes 0.
                let q = if p[a][l] > 0.0 { p[a][l] } else { 0.0 };
                let q = if q < most { q } else { most };
                // The whole number below, or at a whole number perhaps the one before: the value is the same.
                let c = nearest(q - 0.5).min(last).max(0);
                cell[a][l] = c;
                f[a][l] = q - c as f32;
            }
        }
        let [sy, sz] = self.stride;
        let mut corner = [[0.0f32; GROUP]; 8];
        for l in 0..GROUP {
            let base = cell[2][l] as usize * sz + cell[1][l] as usize * sy + cell[0][l] as usize;
            if let Some(v) = self.values.get(base..base + sz + sy + 2) {
                corner[0][l] = v[0].number();
                corner[1][l] = v[1].number();
                corner[2][l] = v[sy].number();
                corner[3][l] = v[sy + 1].number();
                corner[4][l] = v[sz].number();
                corner[5][l] = v[sz + 1].number();
                corner[6][l] = v[sz + sy].number();
                corner[7][l] = v[sz + sy + 1].number();
            }
        }
        let mut out = [0.0; GROUP];
        for l in 0..GROUP {
            let x = |k: usize| corner[k][l] + f[0][l] * (corner[k + 1][l] - corner[k][l]);
            let (y0, y1) = (x(0) + f[1][l] * (x(2) - x(0)), x(4) + f[1][l] * (x(6) - x(4)));
            out[l] = y0 + f[2][l] * (y1 - y0);
        }
        out
    }

    /// Central differences over a voxel to both sides, per voxel.
    #[inline(always)]
    pub(super) fn gradient(&self, p: [f32; 3]) -> [f32; 3] {
        let mut around = [[0.0; GROUP]; 3];
        for a in 0..3 {
            around[a] = [p[a]; GROUP];
            around[a][2 * a] += 1.0;
            around[a][2 * a + 1] -= 1.0;
        }
        let v = self.at(&around);
        std::array::from_fn(|a| 0.5 * (v[2 * a] - v[2 * a + 1]))
    }
}
