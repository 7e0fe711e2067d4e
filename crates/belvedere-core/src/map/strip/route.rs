//! Smooths a route with a Gaussian so that a strip fits it.

use super::curve::PlanCurve;
use super::{StripError, in_range, overlap};
use glam::DVec2;

/// The least radius of curvature is the half width over this, so that lengths across the strip change by no more than a factor of 5.
pub const BEND_SHARE: f64 = 0.8;
/// Samples per smoothing width.
const SAMPLES: f64 = 8.0;
/// Nodes of the curve per half width.
const NODES: f64 = 16.0;
/// Reach of the Gaussian to both sides, standard deviations.
const TAILS: f64 = 6.0;
/// Automatic smoothing grows by this factor until the strip fits.
const GROWTH: f64 = 1.15;
/// First standard deviation of automatic smoothing, as a share of the half width.
const FIRST: f64 = 0.25;
/// Least share of the route's length that the smoothed route must keep.
const LEFT: f64 = 0.1;
/// Most samples and nodes.
const MOST_NODES: f64 = 200_000.0;

/// A route, smoothed.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothedRoute {
    /// The curve.
    pub curve: PlanCurve,
    /// Standard deviation of the average along the route, scene units.
    pub smoothing: f64,
    /// Largest distance of the route from the curve, scene units.
    pub off: f64,
    /// Point of the route at that distance, scene coordinates.
    pub off_at: DVec2,
}

impl SmoothedRoute {
    /// A curve near a route whose strip of this half width neither folds nor meets itself.
    ///
    /// The route is averaged along its length with a Gaussian, mirrored through its ends so that these stay where they are. Without
    /// `smoothing` the least width of the Gaussian is taken that the strip fits (it grows in steps of 15 % from a quarter of
    /// `half_width`); the wider it is the more the route becomes the straight line between its ends.
    ///
    /// * `points`: the route in plan, scene coordinates; doubled points do not matter.
    /// * `half_width`: scene units, > 0.
    /// * `smoothing`: standard deviation of the Gaussian, scene units, > 0.
    ///
    /// # Errors
    /// Every [`StripError`] but that of the share. Source: ours.
    pub fn new(points: &[DVec2], half_width: f64, smoothing: Option<f64>) -> Result<Self, StripError> {
        let route = Polyline::new(points)?;
        in_range("half_width", half_width, 1e-6, 1e9)?;
        if let Some(sigma) = smoothing {
            in_range("smoothing", sigma, 1e-6, 1e9)?;
            return Ok(route.finished(fitted(&route, half_width, sigma)?, sigma));
        }
        let mut sigma = FIRST * half_width;
        let length = route.length();
        loop {
            match fitted(&route, half_width, sigma) {
                Ok(curve) if curve.length() >= LEFT * length => return Ok(route.finished(curve, sigma)),
                Ok(curve) => return Err(StripError::Winds { length, left: curve.length(), half_width }),
                Err(e @ StripError::TooFine { .. }) => return Err(e),
                // By now the average is the straight line between the ends.
                Err(_) if sigma > 4.0 * length => {
                    return Err(StripError::Winds { length, left: route.end().length(), half_width });
                }
                Err(_) => sigma *= GROWTH,
            }
        }
    }
}

/// The route smoothed with standard deviation `sigma`, if the strip fits it.
fn fitted(route: &Polyline, half_width: f64, sigma: f64) -> Result<PlanCurve, StripError> {
    let curve = route.smoothed(sigma, half_width)?;
    let reach = overlap::reach(&curve, half_width)?;
    Ok(curve.with_reach(reach))
}

/// Distinct points in order.
struct Polyline {
    /// Relative to the first point.
    points: Vec<DVec2>,
    origin: DVec2,
    /// Length up to each point.
    along: Vec<f64>,
}

impl Polyline {
    fn new(points: &[DVec2]) -> Result<Self, StripError> {
        if let Some(index) = points.iter().position(|p| !(p.is_finite() && p.abs().max_element() <= 1e9)) {
            return Err(StripError::NotFinite { index, value: points[index] });
        }
        let origin = points.first().copied().unwrap_or_default();
        let mut out = Self { points: Vec::new(), origin, along: Vec::new() };
        for p in points.iter().map(|p| *p - origin) {
            let step = out.points.last().map_or(0.0, |last: &DVec2| last.distance(p));
            if out.points.is_empty() || step > 0.0 {
                out.along.push(out.length() + step);
                out.points.push(p);
            }
        }
        if !(out.length() > 1e-6) {
            return Err(StripError::TooShort { points: points.len(), length: out.length() });
        }
        Ok(out)
    }

    fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    fn end(&self) -> DVec2 {
        self.points.last().copied().unwrap_or_default()
    }

    /// `steps + 1` samples, evenly spaced along the length.
    fn resampled(&self, steps: usize) -> Vec<DVec2> {
        let mut k = 0;
        let sample = |i: usize| {
            let at = self.length() * i as f64 / steps as f64;
            while k + 2 < self.points.len() && self.along[k + 1] < at {
                k += 1;
            }
            let t = ((at - self.along[k]) / (self.along[k + 1] - self.along[k])).clamp(0.0, 1.0);
            self.points[k].lerp(self.points[k + 1], t)
        };
        (0..=steps).map(sample).collect()
    }

    /// The average by a Gaussian, as a curve.
    fn smoothed(&self, sigma: f64, half_width: f64) -> Result<PlanCurve, StripError> {
        let (coarse, fine) = (sigma / SAMPLES, (sigma / SAMPLES).min(half_width / NODES));
        if !(self.length() / fine <= MOST_NODES) {
            return Err(StripError::TooFine { length: self.length(), fine, most: MOST_NODES });
        }
        let steps = (self.length() / coarse).ceil().max(SAMPLES) as usize;
        let step = self.length() / steps as f64;
        let average = Average { samples: self.resampled(steps), end: self.end(), kernel: Kernel::new(sigma / step) };
        let places: Vec<[DVec2; 3]> = (0..=steps).map(|i| average.at(i)).collect();
        let (bend, sharpest) = sharpest(&places);
        let radius = 1.0 / bend;
        if !(BEND_SHARE * radius >= half_width) {
            let at = self.origin + places[sharpest][0];
            return Err(StripError::Radius { at, radius, half_width, widest: BEND_SHARE * radius });
        }
        let (curvature, spacing) = by_arc_length(&places, fine);
        let tangent = places[0][1].normalize_or(DVec2::X);
        let curve = PlanCurve::through(curvature, spacing, 0.0, (DVec2::ZERO, tangent));
        // Turns the curve back by the quadrature error in direction; both ends share the rest of the error.
        let reached = curve.at(curve.length()).p;
        let back = (reached.x * self.end().x + reached.y * self.end().y, reached.perp_dot(self.end()));
        let turn = DVec2::new(back.0, back.1).normalize_or(DVec2::X);
        let start = self.origin + 0.5 * (self.end() - turn.rotate(reached));
        Ok(PlanCurve::through(curve.curvature().to_vec(), spacing, 0.0, (start, turn.rotate(tangent))))
    }

    fn finished(&self, curve: PlanCurve, smoothing: f64) -> SmoothedRoute {
        let steps = (4.0 * self.length() / curve.spacing()).ceil().clamp(1.0, MOST_NODES) as usize;
        let off = |p: &DVec2| {
            let p = self.origin + *p;
            (curve.at(curve.nearest(p)).p.distance(p), p)
        };
        let samples = self.resampled(steps);
        let farthest =
            samples.iter().chain(&self.points).map(off).fold((0.0, self.origin), |a, b| if b.0 > a.0 { b } else { a });
        SmoothedRoute { curve, smoothing, off: farthest.0, off_at: farthest.1 }
    }
}

/// Largest curvature and its index: at the samples and, by the turn of the tangent, between them, where a hairpin may hide.
fn sharpest(places: &[[DVec2; 3]]) -> (f64, usize) {
    let speed = |i: usize| places[i][1].length();
    let at = |i: usize| bend(&places[i]).abs();
    let between = |i: usize| {
        let turn = places[i][1].angle_to(places[i + 1][1]).abs();
        if turn == 0.0 { 0.0 } else { turn / (0.5 * (speed(i) + speed(i + 1))) }
    };
    let all = (0..places.len()).map(|i| (at(i), i)).chain((0..places.len() - 1).map(|i| (between(i), i)));
    let known = all.map(|(k, i)| if k.is_finite() { (k, i) } else { (f64::INFINITY, i) });
    known.fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
}

/// Curvature from two derivatives; not finite where the speed is 0.
fn bend(place: &[DVec2; 3]) -> f64 {
    place[1].perp_dot(place[2]) / place[1].length().powi(3)
}

/// Curvatures at evenly spaced arc lengths, about `fine` apart, and the spacing, of a curve given with two derivatives.
fn by_arc_length(places: &[[DVec2; 3]], fine: f64) -> (Vec<f64>, f64) {
    let speed: Vec<f64> = places.iter().map(|[_, d, _]| d.length()).collect();
    let mut along = vec![0.0; places.len()];
    for i in 1..places.len() {
        along[i] = along[i - 1] + 0.5 * (speed[i - 1] + speed[i]);
    }
    let (last, length) = (places.len() - 1, along[places.len() - 1]);
    let pieces = ((length / fine).ceil().min(MOST_NODES) as usize).max(last);
    let spacing = length / pieces as f64;
    let mut k = 0;
    let curvature = |i: usize| {
        if i == 0 || i == pieces {
            return 0.0;
        }
        let at = spacing * i as f64;
        while k + 2 < along.len() && along[k + 1] < at {
            k += 1;
        }
        let t = ((at - along[k]) / (along[k + 1] - along[k])).clamp(0.0, 1.0);
        let [from, to] = [bend(&places[k]), bend(&places[k + 1])];
        from + t * (to - from)
    };
    ((0..=pieces).map(curvature).collect(), spacing)
}

/// Weights of the Gaussian and its first two derivatives, at whole steps from 0 on.
struct Kernel {
    weights: Vec<[f64; 3]>,
}

impl Kernel {
    /// * `sigma`: standard deviation in steps.
    fn new(sigma: f64) -> Self {
        let tail = (TAILS * sigma).ceil() as usize;
        let value = |i: usize| (-0.5 * (i as f64 / sigma).powi(2)).exp();
        let total = value(0) + 2.0 * (1..=tail).map(value).sum::<f64>();
        let weight = |i: usize| {
            let (w, x, s2) = (value(i) / total, i as f64, sigma * sigma);
            [w, -w * x / s2, w * (x * x / s2 - 1.0) / s2]
        };
        let mut weights: Vec<[f64; 3]> = (0..=tail).map(weight).collect();
        // Normalised: the truncated tails must not shorten straight parts.
        let slope: f64 = weights.iter().enumerate().map(|(i, w)| -2.0 * i as f64 * w[1]).sum();
        weights.iter_mut().for_each(|w| w[1] /= slope);
        Self { weights }
    }
}

/// Gaussian average of the samples, which are mirrored through both ends as often as the kernel reaches.
struct Average {
    samples: Vec<DVec2>,
    end: DVec2,
    kernel: Kernel,
}

impl Average {
    fn sample(&self, i: isize) -> DVec2 {
        let n = self.samples.len() as isize - 1;
        // Mirrored through both ends, the route repeats, shifted by twice the vector from end to end.
        let (turns, rest) = (i.div_euclid(2 * n), i.rem_euclid(2 * n));
        let (start, end) = (self.samples[0], self.end);
        let shift = 2.0 * turns as f64 * (end - start);
        let here =
            if rest <= n { self.samples[rest as usize] } else { 2.0 * end - self.samples[(2 * n - rest) as usize] };
        here + shift
    }

    /// Averaged position and its first two derivatives with respect to the step.
    fn at(&self, i: usize) -> [DVec2; 3] {
        let i = i as isize;
        let (mut out, here) = ([DVec2::ZERO; 3], self.sample(i));
        for (k, w) in self.kernel.weights.iter().enumerate() {
            let (after, before) = (self.sample(i + k as isize), self.sample(i - k as isize));
            let (sum, difference) = (if k == 0 { after } else { after + before }, before - after);
            out[0] += w[0] * sum;
            out[1] += w[1] * difference;
            out[2] += w[2] * (after + before - 2.0 * here);
        }
        out
    }
}
