//! The formulas of the greedy pass, one function each. Numbers are those of Deng et al. 2013.
//!
//! Heights are over the datum, the lowest height of the ground: scaling acts about it.

/// Affine change of the heights of a piece of ground: `z = scale h + shift` with h its original height; (1) to (4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine {
    /// Factor, 0..=1.
    pub(super) scale: f64,
    /// Displacement, scene units, <= 0.
    pub(super) shift: f64,
}

impl Affine {
    /// Leaves heights as they are.
    pub(super) const IDENTITY: Self = Self { scale: 1.0, shift: 0.0 };

    /// Height of ground whose original height is `h`.
    pub(super) fn of(&self, h: f64) -> f64 {
        self.scale * h + self.shift
    }
}

/// (5): the factor that brings ground of height `z` down to a line of sight of height `limit`.
///
/// The height of the line is the numerator: the inverse ratio would raise the ground.
pub(super) fn scale_to_clear(limit: f64, z: f64) -> f64 {
    limit / z
}

/// (6): the displacement that brings ground of height `z` down to that line of sight.
pub(super) fn shift_to_clear(limit: f64, z: f64) -> f64 {
    limit - z
}

/// (7): scaling by `scale` with share `lambda` and displacement by `shift` with share `1 - lambda`, after `now`.
///
/// The result lies between the two: ground that each of them alone brings below a line is below it for every `lambda` in 0..=1.
pub(super) fn blended(now: Affine, scale: f64, shift: f64, lambda: f64) -> Affine {
    let factor = 1.0 + (scale - 1.0) * lambda;
    Affine { scale: factor * now.scale, shift: factor * now.shift + (1.0 - lambda) * shift }
}

/// Arguments of the cost (10) of a blend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlendCost<'a> {
    /// Affine change of the hit cell so far.
    pub(super) now: Affine,
    /// [`scale_to_clear`] of the hit.
    pub(super) scale: f64,
    /// [`shift_to_clear`] of the hit.
    pub(super) shift: f64,
    /// Share of the cell that is higher than the line of sight at the hit.
    pub(super) higher_share: f64,
    /// Mean original height of that part.
    pub(super) higher_mean: f64,
    /// Mean original height of the cell.
    pub(super) mean: f64,
    /// For each neighbour its share of the cell's border, and its affine change.
    pub(super) neighbours: &'a [(f64, Affine)],
    /// Weight of (9).
    pub(super) eta: f64,
    /// Weight of displacements in (9).
    pub(super) mu: f64,
    /// Weight of displacements in (8).
    pub(super) mu_dev: f64,
}

impl BlendCost<'_> {
    /// The `lambda` of least cost: the vertex of the parabola (10), clamped to 0..=1; 0 if the cost does not depend on `lambda`.
    pub(super) fn best_lambda(&self) -> f64 {
        let Affine { scale: a, shift: b } = self.now;
        // scale = a + p lambda, shift = e + q lambda.
        let (p, q, e) = (a * (self.scale - 1.0), b * (self.scale - 1.0) - self.shift, b + self.shift);
        let change_scale = self.higher_share * self.higher_mean * self.higher_mean;
        let change_shift = self.mu_dev * (1.0 - self.higher_share);
        let (step_scale, step_shift) = (self.eta * self.mean * self.mean, self.eta * self.mu);
        let mut square = change_scale * p * p + change_shift * q * q;
        let mut linear = change_shift * q * e - change_scale * p * (1.0 - a);
        for &(share, other) in self.neighbours {
            square += share * (step_scale * p * p + step_shift * q * q);
            linear += share * (step_scale * p * (a - other.scale) + step_shift * q * (e - other.shift));
        }
        let lambda = -linear / square;
        if lambda.is_finite() { lambda.clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// (8), (9) and (10) as sums; [`BlendCost::best_lambda`] minimises them in closed form.
#[cfg(test)]
impl BlendCost<'_> {
    /// (8): how much the ground is changed: the higher part by scaling, the rest by displacement.
    ///
    /// The height in it is the mean of the higher part, and displacements weigh `mu_dev`; with 1 it is the printed formula.
    pub(super) fn deviation(&self, total: Affine) -> f64 {
        let (kappa, high) = (self.higher_share, self.higher_mean);
        kappa * (high * (1.0 - total.scale)).powi(2) + self.mu_dev * (1.0 - kappa) * total.shift.powi(2)
    }

    /// (9): the steps at the borders of the cell.
    pub(super) fn discontinuity(&self, total: Affine) -> f64 {
        let step = |&(share, other): &(f64, Affine)| {
            let (ds, dt) = (total.scale - other.scale, total.shift - other.shift);
            share * ((self.mean * ds).powi(2) + self.mu * dt * dt)
        };
        self.neighbours.iter().map(step).sum()
    }

    /// (10): cost of the blend (7) with `lambda`.
    pub(super) fn of(&self, lambda: f64) -> f64 {
        let total = blended(self.now, self.scale, self.shift, lambda);
        self.deviation(total) + self.eta * self.discontinuity(total)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::cells::tests::noise;
    use super::*;

    fn random(i: usize) -> impl FnMut(f64, f64) -> f64 {
        let mut k = 100 * i;
        move |low, high| {
            k += 1;
            low + (high - low) * noise(k, 77)
        }
    }

    #[test]
    fn lambda_is_the_best_of_4001() {
        let mut inside = 0;
        for i in 0..200 {
            let mut r = random(i);
            let neighbours: Vec<(f64, Affine)> =
                (0..5).map(|_| (0.2, Affine { scale: r(0.3, 1.0), shift: r(-400.0, 0.0) })).collect();
            let cost = BlendCost {
                now: Affine { scale: r(0.3, 1.0), shift: r(-300.0, 0.0) },
                scale: r(0.2, 1.0),
                shift: r(-500.0, 0.0),
                higher_share: r(0.0, 1.0),
                higher_mean: r(100.0, 2000.0),
                mean: r(100.0, 1500.0),
                neighbours: &neighbours,
                eta: r(0.0, 10.0),
                mu: r(0.0, 20.0),
                mu_dev: r(0.1, 20.0),
            };
            let ours = cost.best_lambda();
            let searched = (0..=4000).map(|k| f64::from(k) / 4000.0).min_by(|&x, &y| cost.of(x).total_cmp(&cost.of(y)));
            assert!((ours - searched.unwrap()).abs() <= 0.5 / 4000.0 + 1e-9, "case {i}: {ours} {searched:?}");
            inside += usize::from(ours > 0.0 && ours < 1.0);
        }
        assert!(inside > 50, "only {inside} cases have their best inside");
    }

    #[test]
    fn a_blend_clears_what_scaling_and_displacement_clear() {
        for i in 0..200 {
            let mut r = random(i);
            let now = Affine { scale: r(0.3, 1.0), shift: r(-100.0, 0.0) };
            let h = r(500.0, 1000.0);
            let z = now.of(h);
            let limit = r(1.0, z);
            let (s, d) = (scale_to_clear(limit, z), shift_to_clear(limit, z));
            assert!(s < 1.0 && d < 0.0);
            let cleared = blended(now, s, d, r(0.0, 1.0));
            assert!((cleared.of(h) - limit).abs() < 1e-9, "a single sample ends exactly at the line of sight");
            assert!(cleared.scale <= now.scale && cleared.scale >= 0.0 && cleared.of(h) < z);
        }
    }

    #[test]
    fn nothing_to_weigh_means_displacement() {
        let cost = BlendCost {
            now: Affine::IDENTITY,
            scale: 1.0,
            shift: 0.0,
            higher_share: 0.0,
            higher_mean: 0.0,
            mean: 0.0,
            neighbours: &[],
            eta: 5.0,
            mu: 10.0,
            mu_dev: 10.0,
        };
        assert_eq!(cost.best_lambda(), 0.0);
    }
}
