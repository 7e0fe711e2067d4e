//! Axis-aligned boxes.

use glam::DVec3;

/// Axis-aligned box in scene coordinates; empty while `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest corner, scene units.
    pub min: DVec3,
    /// Largest corner, scene units.
    pub max: DVec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Smallest box around `points`; [`Aabb::EMPTY`] if there are none.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.including(p))
    }

    /// This box grown to contain `p`.
    #[inline]
    pub fn including(self, p: DVec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// Smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The eight corners; bit 0 of the index selects max x, bit 1 max y, bit 2 max z.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, lo: f64, hi: f64| if i >> bit & 1 == 1 { hi } else { lo };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// Centre of the box.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_is_the_mean_of_the_corners() {
        let bounds = Aabb { min: DVec3::new(-1.0, 2.0, 10.0), max: DVec3::new(3.0, 8.0, 11.0) };
        assert_eq!(bounds.center(), DVec3::new(1.0, 5.0, 10.5));
        assert_eq!(bounds.corners().into_iter().sum::<DVec3>() / 8.0, bounds.center());
    }
}
