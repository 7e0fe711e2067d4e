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
mod tests;
