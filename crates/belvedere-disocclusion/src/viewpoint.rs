//! Viewpoint adjustment: a small move of the camera may save much deformation.
//!
//! The eye moves in a small box of azimuth, distance and height around the point looked at. Minimised is
//! `(1 - s) E(V) / E(user) + s |q|^2 + barrier`, q the move in units of the box, E the energy of the deformation that the
//! eye needs (Deng et al. 2013 leave it as future work; the slider s is the idea of the 2011 predecessor).

use belvedere_core::{DVec2, DVec3};

/// Deformation as a function of the eye.
pub trait ViewpointEnergy {
    /// Cheap estimate for the search over the whole box; the energy of the greedy pass, say. `None`: unusable eye.
    fn coarse(&mut self, eye: DVec3) -> Option<f64> {
        self.energy(eye)
    }

    /// Energy of the deformation for an eye, >= 0; that of the quadratic program. `None`: unusable eye.
    fn energy(&mut self, eye: DVec3) -> Option<f64>;

    /// dE/dz of the eye where [`Self::energy`] was asked last (see [`height_slope`]); `None`: differences are taken.
    fn slope(&mut self) -> Option<f64> {
        None
    }
}

impl<F: FnMut(DVec3) -> Option<f64>> ViewpointEnergy for F {
    fn energy(&mut self, eye: DVec3) -> Option<f64> {
        self(eye)
    }
}

/// dE/dz_V of the quadratic program by the envelope theorem: `-m^T dg/dz_V`. A row of a line of sight asks for at most
/// `g = ... + tau z_V`, so its share is its multiplier (>= 0) times tau. Exact for rise and fall of the eye over a fixed
/// place, where no row changes.
pub fn height_slope(rows: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    -rows.into_iter().map(|(multiplier, tau)| multiplier * tau).sum::<f64>()
}

/// The box, the slider and the effort.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewpointOptions {
    /// 0 = move the camera, 1 = only deform (the eye stays).
    pub slider: f64,
    /// Largest turn about the point looked at, radians, >= 0.
    pub azimuth: f64,
    /// Largest relative change of the horizontal distance, 0..1.
    pub distance: f64,
    /// Largest rise or fall of the eye, metres, >= 0.
    pub height_m: f64,
    /// Height over ground under which the eye is pushed up, metres, > 0.
    pub clearance_m: f64,
    /// Eyes of the search along azimuth, distance and height; 1 = none.
    pub search: [usize; 3],
    /// Steps of the projected gradient.
    pub steps: usize,
}

impl Default for ViewpointOptions {
    fn default() -> Self {
        Self {
            slider: 0.5,
            azimuth: 10f64.to_radians(),
            distance: 0.2,
            height_m: 200.0,
            clearance_m: 50.0,
            search: [5, 3, 3],
            steps: 8,
        }
    }
}

/// A better eye.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct AdjustedViewpoint {
    /// The eye.
    pub eye: DVec3,
    /// Distance from the eye that was given.
    pub moved_m: f64,
    /// Energy at the eye that was given and at the new one.
    pub energy: [f64; 2],
    /// Evaluations of the energy: in the search and in the descent.
    pub evaluations: [usize; 2],
}

/// The best eye near `user`, which looks at `target`.
///
/// * `ground`: height of the ground at x, y, `None` outside the data.
///
/// `None` if the eye given has no energy. The eye stays where it is if nothing has to be deformed, or at slider 1.
pub fn adjust_viewpoint(
    user: DVec3,
    target: DVec3,
    ground: &dyn Fn(DVec2) -> Option<f64>,
    energy: &mut dyn ViewpointEnergy,
    options: &ViewpointOptions,
) -> Option<AdjustedViewpoint> {
    let start = energy.energy(user).filter(|e| e.is_finite())?;
    let slider = options.slider.clamp(0.0, 1.0);
    let stays = AdjustedViewpoint { eye: user, moved_m: 0.0, energy: [start; 2], evaluations: [0, 1] };
    if !(start > 0.0) || slider == 1.0 {
        return Some(stays);
    }
    let slope = energy.slope();
    let mut search = Search { user, target, ground, energy, options, slider, start, asked: [0, 1] };
    let cost = search.cost(DVec3::ZERO, Some(start)).unwrap_or(f64::INFINITY);
    let mut best = Trial { q: DVec3::ZERO, cost, slope };
    if let Some(trial) = search.scan().and_then(|q| search.exact(q)).filter(|p| p.cost < best.cost) {
        best = trial;
    }
    let q = search.descend(best).q;
    let eye = search.eye(q);
    let end = if q == DVec3::ZERO { start } else { search.energy.energy(eye)? };
    Some(AdjustedViewpoint { eye, moved_m: eye.distance(user), energy: [start, end], evaluations: search.asked })
}

/// A point of the box that was evaluated.
#[derive(Clone, Copy)]
struct Trial {
    q: DVec3,
    cost: f64,
    slope: Option<f64>,
}

struct Search<'a> {
    user: DVec3,
    target: DVec3,
    ground: &'a dyn Fn(DVec2) -> Option<f64>,
    energy: &'a mut dyn ViewpointEnergy,
    options: &'a ViewpointOptions,
    slider: f64,
    start: f64,
    asked: [usize; 2],
}

impl Search<'_> {
    /// The eye at a point q of the box (-1..1: azimuth, distance, height).
    fn eye(&self, q: DVec3) -> DVec3 {
        if q == DVec3::ZERO {
            return self.user;
        }
        let arm = (self.user - self.target).truncate();
        let turned = DVec2::from_angle(q.x * self.options.azimuth).rotate(arm);
        let place = self.target.truncate() + turned * (1.0 + q.y * self.options.distance.clamp(0.0, 0.99));
        place.extend(self.user.z + q.z * self.options.height_m)
    }

    /// Cost of a point q of the box, from its deformation energy; `None` if the eye is under ground or the energy unusable.
    fn cost(&self, q: DVec3, energy: Option<f64>) -> Option<f64> {
        let eye = self.eye(q);
        let energy = energy.filter(|e| e.is_finite())?;
        // Outside the data there is no ground to collide with.
        let clearance = (self.ground)(eye.truncate()).map_or(f64::INFINITY, |z| eye.z - z);
        if !(clearance > 0.0) {
            return None;
        }
        let lack = (1.0 - clearance / self.options.clearance_m).max(0.0);
        let barrier = lack * lack * self.options.clearance_m / clearance;
        Some((1.0 - self.slider) * energy / self.start + self.slider * q.length_squared() + barrier)
    }

    fn exact(&mut self, q: DVec3) -> Option<Trial> {
        self.asked[1] += 1;
        let energy = self.energy.energy(self.eye(q));
        let slope = self.energy.slope();
        self.cost(q, energy).map(|cost| Trial { q, cost, slope })
    }

    /// The best point of a lattice over the box by the coarse energy, relative to the coarse energy of the middle.
    fn scan(&mut self) -> Option<DVec3> {
        let count = self.options.search.map(|n| n.max(1));
        let at = |i: usize, n: usize| if n > 1 { 2.0 * i as f64 / (n - 1) as f64 - 1.0 } else { 0.0 };
        if count == [1; 3] {
            return None;
        }
        // Estimate and exact energy may differ by a factor: the estimate is measured by itself.
        let middle = self.energy.coarse(self.user).filter(|e| *e > 0.0 && e.is_finite())?;
        self.asked[0] += 1;
        let mut best = (DVec3::ZERO, self.cost(DVec3::ZERO, Some(self.start)).unwrap_or(f64::INFINITY));
        for k in 0..count.iter().product() {
            let q = DVec3::new(
                at(k % count[0], count[0]),
                at(k / count[0] % count[1], count[1]),
                at(k / count[0] / count[1], count[2]),
            );
            if q == DVec3::ZERO {
                continue;
            }
            self.asked[0] += 1;
            let energy = self.energy.coarse(self.eye(q)).map(|e| e / middle * self.start);
            if let Some(cost) = self.cost(q, energy).filter(|c| *c < best.1) {
                best = (q, cost);
            }
        }
        (best.0 != DVec3::ZERO).then_some(best.0)
    }

    /// Projected gradient with halving steps; never ends higher than it began.
    fn descend(&mut self, mut place: Trial) -> Trial {
        let mut reach = 0.5;
        for _ in 0..self.options.steps {
            let Some(gradient) = self.gradient(place) else { break };
            let size = gradient.abs().max_element();
            if !(size > 0.0) {
                break;
            }
            let mut better = None;
            while better.is_none() && reach > 1e-3 {
                let q = (place.q - gradient * (reach / size)).clamp(-DVec3::ONE, DVec3::ONE);
                // Armijo's rule with the move that the box allows.
                let promised = 1e-3 * gradient.dot(place.q - q);
                if !(promised > 0.0) {
                    break;
                }
                better = self.exact(q).filter(|p| p.cost <= place.cost - promised);
                reach = if better.is_some() { (2.0 * reach).min(0.5) } else { 0.5 * reach };
            }
            match better {
                Some(better) => place = better,
                None => break,
            }
        }
        place
    }

    /// Gradient of the cost by one-sided differences into the box; the energy's part along the height by the envelope
    /// theorem where it is offered.
    fn gradient(&mut self, place: Trial) -> Option<DVec3> {
        const STEP: f64 = 0.02;
        if !place.cost.is_finite() {
            return None;
        }
        let q = place.q;
        let mut gradient = DVec3::ZERO;
        let reach = [self.options.azimuth, self.options.distance, self.options.height_m];
        for axis in (0..3).filter(|axis| reach[*axis] > 0.0) {
            let mut h = DVec3::ZERO;
            h[axis] = if q[axis] + STEP > 1.0 { -STEP } else { STEP };
            let slope = place.slope.filter(|s| axis == 2 && s.is_finite());
            gradient[axis] = if let Some(slope) = slope {
                let rest = (self.cost(q + h, Some(0.0))? - self.cost(q, Some(0.0))?) / h[axis];
                (1.0 - self.slider) * slope * self.options.height_m / self.start + rest
            } else {
                self.exact(q + h).map_or(0.0, |there| (there.cost - place.cost) / h[axis])
            };
        }
        Some(gradient)
    }
}
