//! Beams of parallel light: prisms without ends along one direction.

use belvedere_core::DVec3;

/// Axes of parallel light: two across its direction, and the direction towards its source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightAxes {
    pub(crate) origin: DVec3,
    /// Orthonormal.
    pub(crate) axes: [DVec3; 3],
}

/// Extent along each of the axes, scene units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
}

impl LightAxes {
    /// Coordinates of a point along the axes.
    #[inline]
    pub(crate) fn place(&self, p: DVec3) -> [f64; 3] {
        let d = p - self.origin;
        self.axes.map(|axis| d.dot(axis))
    }

    /// Extent of a box along the axes.
    /// * `half`: from its centre to three of its faces.
    pub(crate) fn reach_of_box(&self, center: DVec3, half: [DVec3; 3]) -> Reach {
        let (at, side) =
            (self.place(center), self.axes.map(|axis| half.map(|h| axis.dot(h).abs()).iter().sum::<f64>()));
        let end = |sign: f64| std::array::from_fn(|k| at[k] + sign * side[k]);
        Reach { low: end(-1.0), high: end(1.0) }
    }
}

/// A beam of parallel light with a rectangular section.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beam {
    pub(crate) light: LightAxes,
    /// Section, from and to, along the two axes across the light.
    pub(crate) section: [[f64; 2]; 2],
}

impl Beam {
    /// Whether a box along the axes of the scene may come into the beam; never wrongly `false`.
    #[inline]
    pub(crate) fn meets(&self, center: DVec3, half: DVec3) -> bool {
        let d = center - self.light.origin;
        [0, 1].into_iter().all(|k| {
            let axis = self.light.axes[k];
            let (at, side) = (d.dot(axis), axis.abs().dot(half));
            at + side >= self.section[k][0] && at - side <= self.section[k][1]
        })
    }

    /// Farthest place of a box along the light.
    #[inline]
    pub(crate) fn highest_in(&self, center: DVec3, half: DVec3) -> f64 {
        let axis = self.light.axes[2];
        (center - self.light.origin).dot(axis) + axis.abs().dot(half)
    }

    /// Farthest place along the light at which a point of the beam is no higher than `z`.
    #[inline]
    pub(crate) fn place_at_height(&self, z: f64) -> f64 {
        let LightAxes { origin, axes } = self.light;
        let lowest = [0, 1].map(|k| self.section[k].map(|at| at * axes[k].z)).map(|[a, b]| a.min(b));
        (z - origin.z - lowest[0] - lowest[1]) / axes[2].z
    }
}
