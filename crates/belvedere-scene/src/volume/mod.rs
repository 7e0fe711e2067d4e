//! Volumes of voxels: values on a lattice, placed in the scene by an affine map, and how they are drawn.

mod bricks;
mod histogram;
mod layer;
mod presets;
mod transfer;

pub use bricks::{BRICK, Bricks};
pub use layer::{VolumeLayer, VolumeModel};
pub use presets::{SLICE, TRANSFER_NAMES, WALL, threshold};
pub use transfer::{TransferError, TransferFunction, TransferPoint, absorbed};

use belvedere_core::{Aabb, DMat3, DVec3};

/// Fewest voxels along an axis: values are interpolated between them.
pub const LEAST_VOXELS: usize = 2;
/// Most voxels along an axis.
pub const MOST_VOXELS: usize = 1 << 16;

/// Values of voxels, x fastest, then y, then z.
#[derive(Debug, Clone, PartialEq)]
pub enum VoxelValues {
    /// 0 to 255.
    U8(Vec<u8>),
    /// 0 to 65535.
    U16(Vec<u16>),
    /// -32768 to 32767.
    I16(Vec<i16>),
    /// Finite numbers.
    F32(Vec<f32>),
}

impl VoxelValues {
    /// Number of voxels.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::I16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// Whether there is no voxel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes per voxel.
    pub fn bytes_each(&self) -> usize {
        match self {
            Self::U8(_) => 1,
            Self::U16(_) | Self::I16(_) => 2,
            Self::F32(_) => 4,
        }
    }

    /// Name of the type: `uint8`, `uint16`, `int16`, `float32`.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::U8(_) => "uint8",
            Self::U16(_) => "uint16",
            Self::I16(_) => "int16",
            Self::F32(_) => "float32",
        }
    }

    /// Value of a voxel by its number.
    ///
    /// # Panics
    /// If there is no such voxel.
    #[inline]
    pub fn at(&self, i: usize) -> f32 {
        match self {
            Self::U8(v) => f32::from(v[i]),
            Self::U16(v) => f32::from(v[i]),
            Self::I16(v) => f32::from(v[i]),
            Self::F32(v) => v[i],
        }
    }

    fn range(&self) -> [f32; 2] {
        fn of<T: Copy + PartialOrd + Into<f32>>(v: &[T]) -> [f32; 2] {
            let Some(first) = v.first() else { return [0.0; 2] };
            let (mut lo, mut hi) = (*first, *first);
            for x in v {
                lo = if *x < lo { *x } else { lo };
                hi = if *x > hi { *x } else { hi };
            }
            [lo.into(), hi.into()]
        }
        match self {
            Self::U8(v) => of(v),
            Self::U16(v) => of(v),
            Self::I16(v) => of(v),
            Self::F32(v) => of(v),
        }
    }
}

/// Errors of a volume.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeError {
    /// Too few or too many voxels along an axis.
    #[error(
        "the volume has {} x {} x {} voxels; every axis needs {LEAST_VOXELS} to {MOST_VOXELS}, check the dimensions",
        dims[0], dims[1], dims[2]
    )]
    Dims {
        /// Voxels along x, y, z.
        dims: [usize; 3],
    },
    /// Dimensions and values disagree.
    #[error(
        "the volume has {found} values, {} x {} x {} voxels need {needed}; check the dimensions and the type",
        dims[0], dims[1], dims[2]
    )]
    Count {
        /// Voxels along x, y, z.
        dims: [usize; 3],
        /// Values needed.
        needed: usize,
        /// Values found.
        found: usize,
    },
    /// A value is not finite.
    #[error("voxel {at} has the value {value}, values must be finite numbers; replace it")]
    NotFinite {
        /// Number of the first such voxel.
        at: usize,
        /// Its value.
        value: f32,
    },
    /// The axes do not span space.
    #[error(
        "the axes of the volume span no space (volume of a voxel {volume:e}, edges {}, {}, {}); give finite, independent axes and spacings other than 0",
        edges[0], edges[1], edges[2]
    )]
    Axes {
        /// Volume of a voxel, cubic scene units.
        volume: f64,
        /// Lengths of its edges, scene units.
        edges: [f64; 3],
    },
}

/// Values on a lattice of voxels, placed in the scene.
///
/// Voxel `(i, j, k)` is a sample at `origin + axes * (i, j, k)`; between voxels values are interpolated trilinearly. The volume ends
/// at its outer voxels: it fills the lattice coordinates `0..=dims - 1`.
///
/// ```
/// use belvedere_core::{DMat3, DVec3};
/// use belvedere_scene::{Volume, VoxelValues};
///
/// let values = VoxelValues::U8(vec![0, 1, 2, 3, 4, 5, 6, 7]);
/// let volume = Volume::new([2, 2, 2], DMat3::IDENTITY, DVec3::ZERO, values)?;
/// assert_eq!(volume.at(DVec3::new(1.0, 0.5, 0.0)), Some(2.0));
/// # Ok::<(), belvedere_scene::VolumeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    dims: [usize; 3],
    axes: DMat3,
    inverse: DMat3,
    origin: DVec3,
    values: VoxelValues,
    range: [f32; 2],
    bricks: Bricks,
}

impl Volume {
    /// A volume; one pass over the values sums up its bricks.
    ///
    /// * `dims`: voxels along x, y, z.
    /// * `axes`: columns are the steps from a voxel to the next along x, y, z, scene units.
    /// * `origin`: position of voxel (0, 0, 0), scene units.
    ///
    /// # Errors
    /// Every [`VolumeError`].
    pub fn new(dims: [usize; 3], axes: DMat3, origin: DVec3, values: VoxelValues) -> Result<Self, VolumeError> {
        if dims.iter().any(|n| !(LEAST_VOXELS..=MOST_VOXELS).contains(n)) {
            return Err(VolumeError::Dims { dims });
        }
        // At most 2^48 by the check above.
        let needed = dims.iter().product();
        if values.len() != needed {
            return Err(VolumeError::Count { dims, needed, found: values.len() });
        }
        if let VoxelValues::F32(v) = &values
            && let Some(at) = v.iter().position(|x| !x.is_finite())
        {
            return Err(VolumeError::NotFinite { at, value: v[at] });
        }
        let range = values.range();
        let bricks = Bricks::of(dims, &values);
        let placed = Placement::new(axes, origin)?;
        Ok(Self { dims, axes, inverse: placed.0, origin, values, range, bricks })
    }

    /// This volume moved: a voxel at scene position `p` goes to `turn * p + offset`.
    ///
    /// # Errors
    /// [`VolumeError::Axes`].
    pub fn placed(self, turn: DMat3, offset: DVec3) -> Result<Self, VolumeError> {
        let (axes, origin) = (turn * self.axes, turn * self.origin + offset);
        let Placement(inverse) = Placement::new(axes, origin)?;
        Ok(Self { axes, inverse, origin, ..self })
    }

    /// Voxels along x, y, z.
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// Steps from a voxel to the next along x, y, z, scene units, as columns.
    pub fn axes(&self) -> &DMat3 {
        &self.axes
    }

    /// Position of voxel (0, 0, 0), scene units.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The values.
    pub fn values(&self) -> &VoxelValues {
        &self.values
    }

    /// Least and greatest value.
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// Whether all values are the same.
    pub fn is_constant(&self) -> bool {
        self.range[0] == self.range[1]
    }

    /// Least and greatest values of bricks.
    pub fn bricks(&self) -> &Bricks {
        &self.bricks
    }

    /// The shortest edge of a voxel, scene units.
    pub fn voxel_edge(&self) -> f64 {
        [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis].map(DVec3::length).into_iter().fold(f64::MAX, f64::min)
    }

    /// Lattice coordinates of a scene position: whole numbers are voxels.
    pub fn lattice_from_scene(&self, p: DVec3) -> DVec3 {
        self.inverse * (p - self.origin)
    }

    /// Scene units to lattice units: the inverse of [`Volume::axes`].
    pub fn lattice_axes(&self) -> &DMat3 {
        &self.inverse
    }

    /// Scene position of lattice coordinates.
    pub fn scene_from_lattice(&self, q: DVec3) -> DVec3 {
        self.axes * q + self.origin
    }

    /// Smallest box around the outer voxels, scene coordinates.
    pub fn bounds(&self) -> Aabb {
        let most = DVec3::from_array(self.dims.map(|n| (n - 1) as f64));
        let corners = Aabb { min: DVec3::ZERO, max: most }.corners();
        Aabb::of(corners.map(|q| self.scene_from_lattice(q)))
    }

    /// Value at lattice coordinates, interpolated trilinearly; `None` outside.
    pub fn at(&self, q: DVec3) -> Option<f64> {
        let most = DVec3::from_array(self.dims.map(|n| (n - 1) as f64));
        if !(q.cmpge(DVec3::ZERO).all() && q.cmple(most).all()) {
            return None;
        }
        let cell: [usize; 3] = std::array::from_fn(|a| (q[a] as usize).min(self.dims[a] - 2));
        let f = q - DVec3::from_array(cell.map(|c| c as f64));
        let mut sum = 0.0;
        for corner in 0..8 {
            let step = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3).map(|a| if step[a] == 1 { f[a] } else { 1.0 - f[a] }).product();
            let [x, y, z] = std::array::from_fn(|a| cell[a] + step[a]);
            sum += weight * f64::from(self.values.at((z * self.dims[1] + y) * self.dims[0] + x));
        }
        Some(sum)
    }
}

/// The inverse of axes that span space.
struct Placement(DMat3);

impl Placement {
    fn new(axes: DMat3, origin: DVec3) -> Result<Self, VolumeError> {
        let edges = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        let (volume, box_volume) = (axes.determinant(), edges.iter().product::<f64>());
        let inverse = axes.inverse();
        let spans = volume.abs() > 1e-9 * box_volume && inverse.is_finite() && axes.is_finite() && origin.is_finite();
        if spans { Ok(Self(inverse)) } else { Err(VolumeError::Axes { volume, edges }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(values: VoxelValues) -> Result<Volume, VolumeError> {
        Volume::new([2, 2, 2], DMat3::IDENTITY, DVec3::ZERO, values)
    }

    #[test]
    fn what_cannot_be_a_volume_is_refused_with_numbers() {
        let one = |e: VolumeError| e.to_string();
        let flat = Volume::new([4, 1, 2], DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(vec![0; 8]));
        assert!(one(flat.unwrap_err()).contains("4 x 1 x 2"));
        assert!(one(cube(VoxelValues::U8(vec![0; 7])).unwrap_err()).contains("7 values, 2 x 2 x 2 voxels need 8"));
        let mut odd = vec![0.0; 8];
        odd[5] = f32::NAN;
        assert!(one(cube(VoxelValues::F32(odd)).unwrap_err()).starts_with("voxel 5 has the value NaN"));
        let thin = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0));
        let thin = Volume::new([2; 3], thin, DVec3::ZERO, VoxelValues::U8(vec![0; 8]));
        assert!(matches!(thin, Err(VolumeError::Axes { .. })));
    }

    #[test]
    fn places_and_values_go_together() {
        let turn = DMat3::from_rotation_z(0.5) * DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5));
        let values = VoxelValues::I16((0..60).map(|i| i * 7 % 31 - 15).collect());
        let volume = Volume::new([3, 4, 5], turn, DVec3::new(9.0, -4.0, 2.0), values).unwrap();
        let q = DVec3::new(1.25, 2.5, 3.75);
        let back = volume.lattice_from_scene(volume.scene_from_lattice(q));
        assert!(back.distance(q) < 1e-12);
        assert_eq!(volume.at(DVec3::new(2.0, 3.0, 4.0)), Some(f64::from(volume.values().at(59))));
        assert_eq!(volume.at(DVec3::new(2.01, 3.0, 4.0)), None);
        assert_eq!(volume.range(), [-15.0, 15.0]);
        assert_eq!(volume.voxel_edge(), 0.5);
        let moved = volume.clone().placed(DMat3::from_diagonal(DVec3::splat(2.0)), DVec3::X).unwrap();
        assert!(moved.scene_from_lattice(q).distance(2.0 * volume.scene_from_lattice(q) + DVec3::X) < 1e-12);
    }
}
