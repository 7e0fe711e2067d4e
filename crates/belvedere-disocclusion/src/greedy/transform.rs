//! Change of a cell: one affine transform per ring around the eye.

use super::equations::Affine;

/// The transforms of a cell by distance to the eye in plan, the nearest ring first.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct CellTransform {
    /// Outer radii of all rings but the last, ascending, scene units.
    radii: Vec<f64>,
    /// One per ring; none at all = the cell is unchanged.
    affine: Vec<Affine>,
}

impl CellTransform {
    /// The transform at distance `rho`.
    pub(super) fn at(&self, rho: f64) -> Affine {
        self.affine.get(self.radii.partition_point(|&r| r <= rho)).copied().unwrap_or(Affine::IDENTITY)
    }

    /// Whether the cell was changed.
    pub(super) fn changed(&self) -> bool {
        !self.affine.is_empty()
    }

    /// Changes everything nearer than `below` (infinite = the whole cell). Says whether a ring had to be divided.
    pub(super) fn change(&mut self, below: f64, mut change: impl FnMut(Affine) -> Affine) -> bool {
        if self.affine.is_empty() {
            self.affine.push(Affine::IDENTITY);
        }
        let ring = self.radii.partition_point(|&r| r < below);
        let divide = below < f64::INFINITY && self.radii.get(ring) != Some(&below);
        if divide {
            self.radii.insert(ring, below);
            self.affine.insert(ring, self.affine[ring]);
        }
        self.affine[..=ring].iter_mut().for_each(|a| *a = change(*a));
        divide
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_divided_once_and_changed_below_the_radius() {
        let lower = |by: f64| move |a: Affine| Affine { shift: a.shift - by, ..a };
        let mut cell = CellTransform::default();
        assert!(!cell.changed() && cell.at(5.0) == Affine::IDENTITY);
        assert!(cell.change(100.0, lower(1.0)));
        assert!(cell.change(50.0, lower(10.0)));
        assert!(!cell.change(100.0, lower(2.0)), "that radius is there already");
        assert!(!cell.change(f64::INFINITY, lower(100.0)));
        let at = |rho: f64| cell.at(rho).shift;
        assert_eq!(
            (at(0.0), at(49.9), at(50.0), at(99.9), at(100.0), at(1e9)),
            (-113.0, -113.0, -103.0, -103.0, -100.0, -100.0)
        );
        let mut whole = CellTransform::default();
        assert!(!whole.change(f64::INFINITY, lower(7.0)));
        assert_eq!((whole.at(3.0).shift, whole.changed()), (-7.0, true));
    }
}
