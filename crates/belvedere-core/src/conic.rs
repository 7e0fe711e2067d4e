//! Rational quadratic Bezier arcs and lengths of curves.

use glam::DVec3;

/// A conic arc with Bernstein weights (1, w, 1): starts at `t` towards `s`, ends at `q` coming from `s`.
///
/// w < 1 is an ellipse, 1 a parabola, > 1 a hyperbola. Source: the tangent construction of Cui et al. 2010, section 4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConicArc {
    /// Start.
    pub t: DVec3,
    /// Where the end tangents meet.
    pub s: DVec3,
    /// End.
    pub q: DVec3,
    /// Weight w > 0 of `s`.
    pub weight: f64,
}

impl ConicArc {
    /// Point at parameter `u` in 0..=1.
    pub fn point(&self, u: f64) -> DVec3 {
        let p = 1.0 - u;
        let (middle, end) = (2.0 * self.weight * u * p, u * u);
        // Relative to s, so that a small arc far from the origin keeps its digits.
        self.s + (p * p * (self.t - self.s) + end * (self.q - self.s)) / (p * p + middle + end)
    }

    /// Derivative by `u`, scene units.
    pub fn derivative(&self, u: f64) -> DVec3 {
        let (p, w) = (1.0 - u, self.weight);
        let weight = p * p + 2.0 * w * u * p + u * u;
        2.0 * (w * p * p * (self.s - self.t) + u * p * (self.q - self.t) + w * u * u * (self.q - self.s))
            / (weight * weight)
    }

    /// Parameters in 0..=1 where the arc meets a plane, ascending, given the plane's form at t, s and q.
    ///
    /// ```text
    /// p^2 f_t + 2 w u p f_s + u^2 f_q = 0,   p = 1 - u
    /// ```
    pub fn plane_hits(&self, [ft, fs, fq]: [f64; 3]) -> impl Iterator<Item = f64> + use<> {
        // In v = u / p: f_q v^2 + 2 w f_s v + f_t = 0, solved without cancellation as pairs v = x / y.
        let half = self.weight * fs;
        let square = half * half - ft * fq;
        let far = if half < 0.0 { -half + square.max(0.0).sqrt() } else { -half - square.max(0.0).sqrt() };
        let pairs = if square >= 0.0 { [(far, fq), (ft, far)] } else { [(f64::NAN, 1.0); 2] };
        let mut roots = pairs.map(|(x, y)| x / (x + y));
        if roots[0] > roots[1] || roots[0].is_nan() {
            roots.swap(0, 1);
        }
        let twice = roots[0] == roots[1];
        roots
            .into_iter()
            .enumerate()
            .filter(move |(i, u)| (0.0..=1.0).contains(u) && !(*i == 1 && twice))
            .map(|(_, u)| u)
    }
}

/// Length of a smooth curve with the given speed between two parameters, to about 1e-13 of itself.
pub fn arc_length(speed: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let whole = gauss8(speed, from, to);
    refine(speed, from, to, whole, 1e-13 * whole.abs(), 16)
}

fn refine(speed: &dyn Fn(f64) -> f64, from: f64, to: f64, whole: f64, tolerance: f64, levels: u32) -> f64 {
    let middle = 0.5 * (from + to);
    let (left, right) = (gauss8(speed, from, middle), gauss8(speed, middle, to));
    let error = (left + right - whole).abs();
    if levels == 0 || !(error > tolerance) {
        return left + right;
    }
    refine(speed, from, middle, left, 0.5 * tolerance, levels - 1)
        + refine(speed, middle, to, right, 0.5 * tolerance, levels - 1)
}

/// Gauss-Legendre quadrature with 8 nodes.
fn gauss8(f: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    half * NODES.iter().map(|&(x, w)| w * (f(middle - half * x) + f(middle + half * x))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a circle of radius 2: weight cos 45 degrees.
    fn quarter() -> ConicArc {
        let [t, s, q] = [[2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 1.0]].map(DVec3::from_array);
        ConicArc { t, s, q, weight: std::f64::consts::FRAC_1_SQRT_2 }
    }

    #[test]
    fn quarter_circle_is_round_and_pi_long() {
        let arc = quarter();
        for i in 0..=10 {
            let p = arc.point(f64::from(i) / 10.0);
            assert!((p.truncate().length() - 2.0).abs() < 1e-15 * 4.0);
        }
        let length = arc_length(&|u| arc.derivative(u).length(), 0.0, 1.0);
        assert!((length - std::f64::consts::PI).abs() < 1e-13, "{length}");
    }

    #[test]
    fn plane_hits_lie_on_the_plane() {
        let arc = quarter();
        for (normal, offset, count) in [
            (DVec3::X, 1.0, 1),
            (DVec3::Y, 1.3, 1),
            (DVec3::new(1.0, 1.0, 0.0), 2.5, 2),
            (DVec3::X, 3.0, 0),
            (DVec3::X, 0.0, 1),
        ] {
            let form = |p: DVec3| normal.dot(p) - offset;
            let hits: Vec<f64> = arc.plane_hits([form(arc.t), form(arc.s), form(arc.q)]).collect();
            assert_eq!(hits.len(), count, "{normal} {offset} {hits:?}");
            assert!(hits.iter().all(|&u| form(arc.point(u)).abs() < 1e-14), "{hits:?}");
            assert!(hits.is_sorted());
        }
    }
}
