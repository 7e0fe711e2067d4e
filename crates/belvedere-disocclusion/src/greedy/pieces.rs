//! Transforms of parts of a cell.

use super::equations::Affine;

/// What is done to a cell, by distance to the eye in plan: rings around the eye, the nearest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Pieces {
    /// Outer radii of all rings but the last, ascending, scene units.
    radii: Vec<f64>,
    /// One per ring; none at all = nothing is done.
    affine: Vec<Affine>,
    /// Largest scale and shift of all rings.
    bound: Affine,
}

impl Default for Pieces {
    fn default() -> Self {
        Self { radii: Vec::new(), affine: Vec::new(), bound: Affine::IDENTITY }
    }
}

impl Pieces {
    /// What is done at distance `rho`.
    pub fn at(&self, rho: f64) -> Affine {
        if self.alike() { self.bound } else { self.affine[self.radii.partition_point(|&r| r <= rho)] }
    }

    /// Ground of the cell that was at least 0 high is nowhere higher than this makes it.
    #[inline(always)]
    pub(super) fn bound(&self) -> Affine {
        self.bound
    }

    /// The same between two distances to the eye, and whether it is what is done at all of them.
    #[inline(always)]
    pub(super) fn between(&self, [near, far]: [f64; 2]) -> (Affine, bool) {
        if self.alike() { (self.bound, true) } else { self.rings_between(near, far) }
    }

    fn rings_between(&self, near: f64, far: f64) -> (Affine, bool) {
        let first = self.radii.partition_point(|&r| r <= near);
        let last = first + self.radii[first..].iter().take_while(|r| **r <= far).count();
        (self.affine[first + 1..=last].iter().fold(self.affine[first], Affine::larger), first == last)
    }

    /// Whether everywhere the same is done; then [`Self::bound`] is what is done.
    #[inline(always)]
    pub(super) fn alike(&self) -> bool {
        self.affine.len() <= 1
    }

    /// Whether anything is done.
    pub fn changed(&self) -> bool {
        !self.affine.is_empty()
    }

    /// Outer radii of the rings (the last infinite) and what is done in them.
    pub fn rings(&self) -> impl Iterator<Item = (f64, Affine)> {
        self.radii.iter().copied().chain([f64::INFINITY]).zip(self.affine.iter().copied())
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
        let last = if below < f64::INFINITY { ring } else { self.radii.len() };
        self.affine[..=last].iter_mut().for_each(|a| *a = change(*a));
        self.bound = self.affine[1..].iter().fold(self.affine[0], Affine::larger);
        divide
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_divided_once_and_changed_below_the_radius() {
        let lower = |by: f64| move |a: Affine| Affine { shift: a.shift - by, ..a };
        let mut pieces = Pieces::default();
        assert!(!pieces.changed() && pieces.at(5.0) == Affine::IDENTITY);
        assert!(pieces.change(100.0, lower(1.0)));
        assert!(pieces.change(50.0, lower(10.0)));
        assert!(!pieces.change(100.0, lower(2.0)), "that radius is there already");
        assert!(!pieces.change(f64::INFINITY, lower(100.0)));
        let at = |rho: f64| pieces.at(rho).shift;
        assert_eq!(
            (at(0.0), at(49.9), at(50.0), at(99.9), at(100.0), at(1e9)),
            (-113.0, -113.0, -103.0, -103.0, -100.0, -100.0)
        );
        let rings: Vec<(f64, f64)> = pieces.rings().map(|(r, a)| (r, a.shift)).collect();
        assert_eq!(rings, [(50.0, -113.0), (100.0, -103.0), (f64::INFINITY, -100.0)]);
        let mut whole = Pieces::default();
        assert!(!whole.change(f64::INFINITY, lower(7.0)));
        assert_eq!((whole.at(3.0).shift, whole.rings().count()), (-7.0, 1));
    }
}
