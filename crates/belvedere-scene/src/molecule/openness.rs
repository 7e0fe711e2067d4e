//! Openness between atoms: the share of the light from all around that reaches a point.

use super::near::Cells;
use belvedere_core::DVec3;

/// Atoms farther than this take no light, angstrom.
const REACH: f64 = 6.5;

/// Strength by which directions that neighbours cover darken a point.
const STRENGTH: f64 = 0.62;

/// Balls that shade each other.
pub(super) struct Shades {
    cells: Cells,
    centers: Vec<DVec3>,
    radii: Vec<f64>,
}

/// The balls near one ball: centres and radii.
pub(super) struct Around(Vec<(DVec3, f64)>);

impl Shades {
    /// * `radii`: of the balls that take light, angstrom.
    pub(super) fn new(centers: Vec<DVec3>, radii: Vec<f64>) -> Self {
        Self { cells: Cells::new(centers.clone(), REACH), centers, radii }
    }

    /// The balls around number `i`, without itself.
    pub(super) fn around(&self, i: usize) -> Around {
        self.around_but(i, |k| k == i)
    }

    /// The balls around number `i`, without some.
    pub(super) fn around_but(&self, i: usize, but: impl Fn(usize) -> bool) -> Around {
        let mut out = Vec::new();
        self.cells.near(self.centers[i], |k, _| {
            if !but(k) {
                out.push((self.centers[k], self.radii[k]));
            }
        });
        Around(out)
    }
}

impl Around {
    /// Share of even light from all around, weighted by its slant as on matt paper, that reaches a point with a unit normal: in (0, 1].
    ///
    /// A ball of radius r at distance d towards u takes (n u) r^2 / d^2 of it (the form factor of a ball over the horizon). Balls behind
    /// each other would count twice, so the sum goes through an exponential. Source: form factors of radiosity; the rest is ours.
    pub(super) fn open(&self, p: DVec3, normal: DVec3) -> f64 {
        let mut taken = 0.0;
        for &(center, radius) in &self.0 {
            let way = center - p;
            let squared = way.length_squared().max(1e-6);
            let fade = 1.0 - squared / (REACH * REACH);
            if fade > 0.0 {
                let slant = (way.dot(normal) / squared.sqrt()).max(0.0);
                taken += slant * (radius * radius / squared).min(1.0) * fade;
            }
        }
        (-STRENGTH * taken).exp()
    }

    /// Whether all of these points lie inside one ball shrunk by `share`: nothing between them can be seen.
    pub(super) fn hides(&self, points: &[DVec3], share: f64) -> bool {
        self.0.iter().any(|&(c, r)| {
            let reach = share * r;
            points.iter().all(|p| p.distance_squared(c) < reach * reach)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_taken_by_what_stands_over_the_surface() {
        let lit = |neighbours: &[(DVec3, f64)], n: DVec3| Around(neighbours.to_vec()).open(DVec3::ZERO, n);
        assert_eq!(lit(&[], DVec3::Z), 1.0);
        let above = [(DVec3::new(0.0, 0.0, 3.0), 1.5)];
        assert_eq!(lit(&above, -DVec3::Z), 1.0, "behind the surface");
        let (straight, slanted) = (lit(&above, DVec3::Z), lit(&above, DVec3::new(1.0, 0.0, 1.0).normalize()));
        assert!(straight < slanted && slanted < 1.0 && straight > 0.5, "{straight} {slanted}");
        let both = [above[0], (DVec3::new(2.0, 0.0, 2.0), 1.5)];
        assert!(lit(&both, DVec3::Z) < straight);
        assert_eq!(lit(&[(DVec3::new(0.0, 0.0, 7.0), 1.5)], DVec3::Z), 1.0, "out of reach");
    }

    #[test]
    fn triangles_inside_one_ball_are_hidden_and_across_two_are_not() {
        let around = Around(vec![(DVec3::ZERO, 1.0), (DVec3::X, 1.0)]);
        let t = |x: f64| [DVec3::new(x - 0.2, 0.0, 0.0), DVec3::new(x + 0.2, 0.0, 0.0), DVec3::new(x, 0.2, 0.0)];
        assert!(around.hides(&t(-0.5), 0.99) && around.hides(&t(1.5), 0.99));
        assert!(!around.hides(&t(1.9), 0.99));
        assert!(!around.hides(&[DVec3::new(-0.9, 0.0, 0.0), DVec3::new(1.9, 0.0, 0.0)], 0.99));
    }
}
