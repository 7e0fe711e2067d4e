//! Smooths a line with a Gaussian so that a strip or tube fits around it.

use super::curve::Curve;
use super::dimension::{Dimension, Vector};
use super::overlap::{self, BEND_SHARE};
use super::{StraightenError, in_range, place};

/// Samples per smoothing width.
const SAMPLES: f64 = 8.0;
/// Nodes of the curve per half width.
const NODES: f64 = 16.0;
/// Reach of the Gaussian to both sides, standard deviations.
const TAILS: f64 = 6.0;
/// Automatic smoothing grows by this factor until it fits.
const GROWTH: f64 = 1.15;
/// First standard deviation of automatic smoothing, as a share of the half width.
const FIRST: f64 = 0.25;
/// Rounds between frame and curvature of a node.
const ROUNDS: usize = 2;
/// Least share of its length that the smoothed line must keep.
const LEFT: f64 = 0.1;
/// Most samples and nodes.
const MOST_NODES: f64 = 200_000.0;

/// A line, smoothed.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed<D: Dimension> {
    /// The curve.
    pub curve: Curve<D>,
    /// Standard deviation of the average along the line, scene units.
    pub smoothing: f64,
    /// Largest distance of the line from the curve, scene units.
    pub off: f64,
    /// Point of the line at that distance, scene coordinates.
    pub off_at: D::Vector,
}

impl<D: Dimension> Smoothed<D> {
    /// A curve near a line around which what lies within `half_width` neither folds nor meets itself.
    ///
    /// The line is averaged along its length with a Gaussian, mirrored through its ends so that these stay where they are. Without
    /// `smoothing` the least width of the Gaussian is taken that leaves room for it (it grows in steps of 15 % from a quarter of
    /// `half_width`); the wider it is the more the curve becomes the straight line between its ends.
    ///
    /// * `points`: the line, scene coordinates; doubled points do not matter.
    /// * `half_width`: scene units, > 0.
    /// * `smoothing`: standard deviation of the Gaussian, scene units, > 0.
    ///
    /// # Errors
    /// Every [`StraightenError`] but that of the share. Source: ours.
    pub fn new(points: &[D::Vector], half_width: f64, smoothing: Option<f64>) -> Result<Self, StraightenError> {
        let line = Polyline::<D>::new(points)?;
        in_range("half_width", half_width, 1e-6, 1e9)?;
        if let Some(sigma) = smoothing {
            in_range("smoothing", sigma, 1e-6, 1e9)?;
            return Ok(line.finished(fitted(&line, half_width, sigma)?, sigma));
        }
        let mut sigma = FIRST * half_width;
        let length = line.length();
        let winds = |left: f64| StraightenError::Winds { shape: D::SHAPE, length, left, half_width };
        loop {
            match fitted(&line, half_width, sigma) {
                Ok(curve) if curve.length() >= LEFT * length => return Ok(line.finished(curve, sigma)),
                Ok(curve) => return Err(winds(curve.length())),
                Err(e @ StraightenError::TooFine { .. }) => return Err(e),
                // By now the average is the straight line between the ends.
                Err(_) if sigma > 4.0 * length => return Err(winds(line.end().length())),
                Err(_) => sigma *= GROWTH,
            }
        }
    }
}

/// The line smoothed with standard deviation `sigma`, if there is room around it.
fn fitted<D: Dimension>(line: &Polyline<D>, half_width: f64, sigma: f64) -> Result<Curve<D>, StraightenError> {
    let curve = line.smoothed(sigma, half_width)?;
    let reach = overlap::reach(&curve, half_width)?;
    Ok(curve.with_reach(reach))
}

/// Distinct points in order.
struct Polyline<D: Dimension> {
    /// Relative to the first point.
    points: Vec<D::Vector>,
    origin: D::Vector,
    /// Length up to each point.
    along: Vec<f64>,
}

impl<D: Dimension> Polyline<D> {
    fn new(points: &[D::Vector]) -> Result<Self, StraightenError> {
        let shape = D::SHAPE;
        if let Some(index) = points.iter().position(|p| !(p.most() <= 1e9)) {
            return Err(StraightenError::NotFinite { shape, index, value: place::<D>(points[index]) });
        }
        let origin = points.first().copied().unwrap_or_default();
        let mut out = Self { points: Vec::new(), origin, along: Vec::new() };
        for p in points.iter().map(|p| *p - origin) {
            let step = out.points.last().map_or(0.0, |last| last.distance(p));
            if out.points.is_empty() || step > 0.0 {
                out.along.push(out.length() + step);
                out.points.push(p);
            }
        }
        if !(out.length() > 1e-6) {
            return Err(StraightenError::TooShort { shape, points: points.len(), length: out.length() });
        }
        Ok(out)
    }

    fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    fn end(&self) -> D::Vector {
        self.points.last().copied().unwrap_or_default()
    }

    /// `steps + 1` samples, evenly spaced along the length.
    fn resampled(&self, steps: usize) -> Vec<D::Vector> {
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
    fn smoothed(&self, sigma: f64, half_width: f64) -> Result<Curve<D>, StraightenError> {
        let shape = D::SHAPE;
        let (coarse, fine) = (sigma / SAMPLES, (sigma / SAMPLES).min(half_width / NODES));
        if !(self.length() / fine <= MOST_NODES) {
            return Err(StraightenError::TooFine { shape, length: self.length(), fine, most: MOST_NODES });
        }
        let steps = (self.length() / coarse).ceil().max(SAMPLES) as usize;
        let step = self.length() / steps as f64;
        let average = Average { samples: self.resampled(steps), end: self.end(), kernel: Kernel::new(sigma / step) };
        let places: Vec<[D::Vector; 3]> = (0..=steps).map(|i| average.at(i)).collect();
        let (bend, sharpest) = sharpest(&places);
        let radius = 1.0 / bend;
        if !(BEND_SHARE * radius >= half_width) {
            let at = place::<D>(self.origin + places[sharpest][0]);
            return Err(StraightenError::Radius { shape, at, radius, half_width, widest: BEND_SHARE * radius });
        }
        let turn = D::towards(places[0][1].unit_or(D::Vector::AXES[0]));
        let (curvature, spacing) = by_arc_length::<D>(&places, fine, turn);
        let curve = Curve::<D>::through(curvature, spacing, 0.0, (D::Vector::default(), turn));
        // Turns the curve back by the quadrature error in direction; both ends share the rest of the error.
        let reached = curve.at(curve.length()).p;
        let back = D::between(reached, self.end());
        let start = self.origin + (self.end() - D::turned(back, reached)) * 0.5;
        Ok(Curve::through(curve.curvature().to_vec(), spacing, 0.0, (start, D::then(back, turn))))
    }

    fn finished(&self, curve: Curve<D>, smoothing: f64) -> Smoothed<D> {
        let steps = (4.0 * self.length() / curve.spacing()).ceil().clamp(1.0, MOST_NODES) as usize;
        let off = |p: &D::Vector| {
            let p = self.origin + *p;
            (curve.at(curve.nearest(p)).p.distance(p), p)
        };
        let samples = self.resampled(steps);
        let farthest =
            samples.iter().chain(&self.points).map(off).fold((0.0, self.origin), |a, b| if b.0 > a.0 { b } else { a });
        Smoothed { curve, smoothing, off: farthest.0, off_at: farthest.1 }
    }
}

/// Largest curvature and its index: at the samples and, by the turn of the tangent, between them, where a hairpin may hide.
fn sharpest<V: Vector>(places: &[[V; 3]]) -> (f64, usize) {
    let speed = |i: usize| places[i][1].length();
    let between = |i: usize| {
        let [a, b] = [i, i + 1].map(|i| places[i][1] * (1.0 / speed(i)));
        let turn = 2.0 * (0.5 * a.distance(b)).clamp(0.0, 1.0).asin();
        if turn == 0.0 { 0.0 } else { turn / (0.5 * (speed(i) + speed(i + 1))) }
    };
    let all =
        (0..places.len()).map(|i| (bend(&places[i]).length(), i)).chain((0..places.len() - 1).map(|i| (between(i), i)));
    let known = all.map(|(k, i)| if k.is_finite() { (k, i) } else { (f64::INFINITY, i) });
    known.fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a })
}

/// Curvature vector from two derivatives; not finite where the speed is 0.
fn bend<V: Vector>([_, first, second]: &[V; 3]) -> V {
    let per_speed = 1.0 / first.length_squared();
    (*second - *first * (first.dot(*second) * per_speed)) * per_speed
}

/// Curvatures at evenly spaced arc lengths, about `fine` apart, and the spacing, of a curve given with two derivatives.
///
/// * `turn`: its frame at the start; the curvatures are those along the axes of the frame that goes on from there.
fn by_arc_length<D: Dimension>(places: &[[D::Vector; 3]], fine: f64, mut turn: D::Turn) -> (Vec<D::Across>, f64) {
    let speed: Vec<f64> = places.iter().map(|[_, d, _]| d.length()).collect();
    let mut along = vec![0.0; places.len()];
    for i in 1..places.len() {
        along[i] = along[i - 1] + 0.5 * (speed[i - 1] + speed[i]);
    }
    let (last, length) = (places.len() - 1, along[places.len() - 1]);
    let pieces = ((length / fine).ceil().min(MOST_NODES) as usize).max(last);
    let spacing = length / pieces as f64;
    let mut curvature = vec![D::Across::default(); pieces + 1];
    let mut k = 0;
    for i in 1..pieces {
        let at = spacing * i as f64;
        while k + 2 < along.len() && along[k + 1] < at {
            k += 1;
        }
        let t = ((at - along[k]) / (along[k + 1] - along[k])).clamp(0.0, 1.0);
        let (from, to) = (&places[k], &places[k + 1]);
        let (tangent, bend) = (from[1].lerp(to[1], t), bend(from).lerp(bend(to), t));
        // The frame at this node follows from the curvature there, and the curvature from the frame: two rounds leave nothing.
        let before = turn;
        curvature[i] = curvature[i - 1];
        for _ in 0..ROUNDS {
            turn = D::then(before, D::advance([curvature[i - 1], curvature[i]], spacing, spacing).1);
            let reached = D::vector(turn, 1.0, D::Across::default());
            curvature[i] = D::parts(turn, D::turned(D::between(tangent, reached), bend)).1;
        }
    }
    (curvature, spacing)
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
struct Average<V> {
    samples: Vec<V>,
    end: V,
    kernel: Kernel,
}

impl<V: Vector> Average<V> {
    fn sample(&self, i: isize) -> V {
        let n = self.samples.len() as isize - 1;
        // Mirrored through both ends, the line repeats, shifted by twice the vector from end to end.
        let (turns, rest) = (i.div_euclid(2 * n), i.rem_euclid(2 * n));
        let (start, end) = (self.samples[0], self.end);
        let shift = (end - start) * (2.0 * turns as f64);
        let here =
            if rest <= n { self.samples[rest as usize] } else { end * 2.0 - self.samples[(2 * n - rest) as usize] };
        here + shift
    }

    /// Averaged position and its first two derivatives with respect to the step.
    fn at(&self, i: usize) -> [V; 3] {
        let i = i as isize;
        let (mut out, here) = ([V::default(); 3], self.sample(i));
        for (k, w) in self.kernel.weights.iter().enumerate() {
            let (after, before) = (self.sample(i + k as isize), self.sample(i - k as isize));
            let (sum, difference) = (if k == 0 { after } else { after + before }, before - after);
            out[0] += sum * w[0];
            out[1] += difference * w[1];
            out[2] += (after + before - here * 2.0) * w[2];
        }
        out
    }
}
