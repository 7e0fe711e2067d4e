//! The hinge function phi(a, b) of one turn: 0 before plane t0, `a - b` after plane t2, smooth in between.
//!
//! `a` is the turn's form of t0 (0 there, growing along the rays), `b` that of t2 (0 there, falling); both are positive
//! in the wedge between the planes, and every function here is called for the wedge only.
//! A point X of the wedge is displaced by `phi (C - C')`, C' and C being the viewpoints before and after the turn.
//!
//! Source: Cui et al. 2010, section 4 (conic arcs by perspectivities). The closed form is ours: with
//! `psi = phi - (a - b)` and `q = sqrt(phi psi)`, a modified ray satisfies `a = phi + m q`, `b = psi + m q` with constant m.

/// Values of a pencil at the two viewpoints of a turn.
///
/// Scale: `a - b` is -1 at the viewpoint after the turn and `-k0` at the one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewpointValues {
    /// `(b - a)` at the viewpoint before the turn, > 0.
    pub k0: f64,
    /// `a` at the viewpoint before the turn, < 0.
    pub a0: f64,
    /// `b` at the viewpoint before the turn.
    pub b0: f64,
    /// `a` at the viewpoint after the turn.
    pub a1: f64,
    /// `b` at the viewpoint after the turn, > 0.
    pub b1: f64,
}

impl ViewpointValues {
    /// `b1 - a0` > 0: how much the wedge opens between the viewpoints.
    pub(super) fn p(&self) -> f64 {
        self.b1 - self.a0
    }

    /// Sharpness m at which the modified ray through a point of t1 with `a = b = sigma` is the paper's Bezier arc
    /// (conic weight 1); `None` if that ray does not reach t2.
    pub fn m_sigma(&self, sigma: f64) -> Option<f64> {
        let squared = 4.0 * (self.b1 - sigma) * (sigma - self.a0) / self.k0;
        (squared > 0.0 && squared.is_finite()).then(|| squared.sqrt())
    }
}

/// How rays bend in the wedge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hinge {
    /// Conic arcs of constant sharpness m.
    Conic { m: f64 },
    /// Quadratic Bezier arcs: m follows the ray. `sigma`: least and greatest sigma of the picture; rays outside that range
    /// use the m of its nearer end, so that no two cross.
    Bezier { sigma: [f64; 2] },
    /// Broken rays.
    Broken,
    /// Curvature-continuous rays.
    C2,
}

/// phi with its partial derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Phi {
    pub(super) phi: f64,
    pub(super) phi_a: f64,
    pub(super) phi_b: f64,
}

impl Hinge {
    /// phi and its derivatives at a point of the wedge; `None` where the ray model has no ray.
    pub(super) fn phi(self, pencil: &ViewpointValues, a: f64, b: f64) -> Option<Phi> {
        let out = match self {
            Self::Conic { m } => conic_phi(m, a, b),
            Self::Bezier { sigma } => bezier_phi(pencil, sigma, a, b)?,
            Self::Broken => {
                if a > b {
                    Phi { phi: a - b, phi_a: 1.0, phi_b: -1.0 }
                } else {
                    Phi { phi: 0.0, phi_a: 0.0, phi_b: 0.0 }
                }
            }
            Self::C2 => c2_phi(a, b),
        };
        out.phi.is_finite().then_some(out)
    }

    /// phi of the point that is displaced onto Y, given `alpha = a(Y)` > 0 and `b_far` > 0, which is b of the point that
    /// Y would come from if it lay after the turn.
    pub(super) fn phi_of_displaced(self, pencil: &ViewpointValues, alpha: f64, b_far: f64) -> Option<f64> {
        let phi = match self {
            Self::Conic { m } => conic_phi_of_displaced(m, pencil, alpha, b_far),
            Self::Bezier { sigma: [low, high] } => {
                // From b_far = alpha - (lambda - 1) p, the same on the whole ray of one S.
                let lambda = 1.0 + (alpha - b_far) / pencil.p();
                let sigma = (alpha + pencil.a0 * (lambda - 1.0)) / lambda;
                conic_phi_of_displaced(pencil.m_sigma(sigma.max(low).min(high))?, pencil, alpha, b_far)
            }
            Self::Broken => ((alpha - b_far) / pencil.p()).max(0.0),
            Self::C2 => c2_phi_of_displaced(pencil, alpha, b_far)?,
        };
        phi.is_finite().then_some(phi)
    }
}

/// Modified model. Sums of positive terms only, so that nothing cancels near the planes.
fn conic_phi(m: f64, a: f64, b: f64) -> Phi {
    let c = a + b;
    let (a, b) = (a / c, b / c);
    let q = 2.0 * a * b / (m + (m * m * (a - b) * (a - b) + 4.0 * a * b).sqrt());
    let (phi, psi) = if a > b {
        let phi = a - m * q;
        (phi, q * q / phi)
    } else {
        let psi = b - m * q;
        (q * q / psi, psi)
    };
    let scale = 1.0 / (2.0 * q + m * (phi + psi));
    Phi { phi: c * phi, phi_a: (2.0 * q + m * phi) * scale, phi_b: -m * phi * scale }
}

/// Root of the ray's quadratic, in the positive pair x : y = sqrt(phi) : sqrt(psi).
fn conic_phi_of_displaced(m: f64, pencil: &ViewpointValues, alpha: f64, b_far: f64) -> f64 {
    let scale = 1.0 / (alpha + b_far);
    let (near, far) = (alpha * scale, pencil.k0 * b_far * scale);
    // far x^2 - middle x y - near y^2 = 0; middle = m eta, eta = a(Y) - b(Y).
    let half = 0.5 * m * pencil.k0 * (alpha - b_far) * scale / pencil.p();
    let root = (half * half + near * far).sqrt();
    let (x, y) = if half > 0.0 { (half + root, far) } else { (near, root - half) };
    alpha * x / (pencil.p() * x + m * y)
}

/// g(s) = 2 s^3 - s^4: phi = (a + b) g(a / (a + b)).
fn c2_phi(a: f64, b: f64) -> Phi {
    let c = a + b;
    let s = a / c;
    let (g, slope) = c2_profile(s);
    Phi { phi: c * g, phi_a: g + slope * (1.0 - s), phi_b: g - slope * s }
}

/// g and its slope.
pub(super) fn c2_profile(s: f64) -> (f64, f64) {
    (s * s * s * (2.0 - s), s * s * (6.0 - 4.0 * s))
}

fn c2_phi_of_displaced(pencil: &ViewpointValues, alpha: f64, b_far: f64) -> Option<f64> {
    let s = c2_parameter(pencil, alpha, b_far)?;
    let g = c2_profile(s).0;
    Some(alpha * g / (below_chord(s) + pencil.p() * g))
}

/// `s - g(s)` for g of the C2 model, factored so that it does not cancel at its zeros.
fn below_chord(s: f64) -> f64 {
    s * (1.0 - s) * (1.0 + s - s * s)
}

/// Pencil parameter `s = a / (a + b)` of the point that is displaced onto a point with `alpha` and `b_far`, C2 model.
pub(super) fn c2_parameter(pencil: &ViewpointValues, alpha: f64, b_far: f64) -> Option<f64> {
    let (k0, p) = (pencil.k0, pencil.p());
    let scale = 1.0 / (alpha + b_far);
    let (near, far) = (alpha * scale, k0 * b_far * scale);
    // g*(s) = g(s) - (2s - 1), factored likewise.
    let g_star = |s: f64| (1.0 - s).powi(3) * (1.0 + s);
    falling_root(0.0, 1.0, near / (near + far), |s| {
        let (g, slope) = c2_profile(s);
        let value = near * (p * g_star(s) + k0 * below_chord(s)) - far * (below_chord(s) + p * g);
        let slope = near * (p * (slope - 2.0) + k0 * (1.0 - slope)) - far * ((1.0 - slope) + p * slope);
        (value, slope)
    })
}

/// Original model: m depends on sigma of the ray, which depends on phi. Rays that do not cross ([`arcs_cross`]) meet the plane of a pencil
/// parameter at a `c = a + b` that grows with sigma: so there is one root, bracketed by the sigmas of the picture.
fn bezier_phi(pencil: &ViewpointValues, [low, high]: [f64; 2], a: f64, b: f64) -> Option<Phi> {
    let c = a + b;
    let s = a / c;
    // Negative where the ray of sigma meets the plane of s nearer to the common line than (a, b) lies.
    let short_of = |sigma: f64| {
        let g = conic_phi(pencil.m_sigma(sigma)?, s, b / c).phi;
        let g_star = g + (b - a) / c;
        let shift = s + g * pencil.a1 - g_star * pencil.a0 / pencil.k0;
        Some(sigma * (1.0 / c + (g - g_star / pencil.k0)) - shift)
    };
    let of = |sigma: f64| Some(conic_phi(pencil.m_sigma(sigma)?, a, b));
    let ends = [short_of(low)?, short_of(high)?];
    if !(ends[1] > 0.0) {
        return of(high);
    }
    if !(ends[0] < 0.0) {
        return of(low);
    }
    let sigma = rising_root([low, high], ends, short_of)?;
    let m = pencil.m_sigma(sigma)?;
    let phi = conic_phi(m, a, b).phi;
    let r = BezierResidual::new(pencil, a, b, phi);
    Some(Phi { phi, phi_a: -r.by_a / r.by_phi, phi_b: -r.by_b / r.by_phi })
}

/// Zero between two arguments at which a function is negative and positive: false position with the Illinois rule.
fn rising_root(ends: [f64; 2], values: [f64; 2], f: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let ([mut low, mut high], [mut at_low, mut at_high]) = (ends, values);
    let mut last = 0.0;
    for step in 0..120 {
        // Every fourth step halves the bracket, for functions that are steep at one end.
        let x = if step % 4 == 3 { 0.5 * (low + high) } else { low - at_low * ((high - low) / (at_high - at_low)) };
        if !(x > low && x < high) || high - low <= f64::EPSILON * high {
            break;
        }
        let value = f(x)?;
        if value == 0.0 {
            return Some(x);
        }
        if value < 0.0 {
            (low, at_low) = (x, value);
            at_high *= if last < 0.0 { 0.5 } else { 1.0 };
        } else {
            (high, at_high) = (x, value);
            at_low *= if last > 0.0 { 0.5 } else { 1.0 };
        }
        last = value;
    }
    Some(if -at_low < at_high { low } else { high })
}

/// Whether Bezier rays cross those next to them at a sigma: they do not where the Jacobian of (sigma, u / (1 - u)) -> (a, b) keeps its sign,
/// a cubic with positive ends.
pub(super) fn arcs_cross(pencil: &ViewpointValues, sigma: f64) -> bool {
    let ViewpointValues { k0, a0, b0, a1, b1 } = *pencil;
    let (to_start, to_end) = (sigma - a0, b1 - sigma);
    let c0 = -a0 * k0 / (to_start * to_start);
    let c1 = k0 / to_start * (2.0 - a0 * (sigma - a1) / (to_start * to_end));
    let c2 = (2.0 + b1 * (b0 - sigma) / (to_end * to_start)) / to_end;
    let c3 = b1 / (to_end * to_end);
    let discriminant = c2 * c2 - 3.0 * c1 * c3;
    if c2 >= 0.0 || discriminant <= 0.0 {
        return false;
    }
    let r = (discriminant.sqrt() - c2) / (3.0 * c3);
    !(c0 + r * (c1 + r * (c2 + r * c3)) > 0.0)
}

/// Derivatives of `lambda^2 ((a - phi)^2 - m_sigma(sigma)^2 phi psi)`, which is 0; sigma is a rational function of phi.
struct BezierResidual {
    by_phi: f64,
    by_a: f64,
    by_b: f64,
}

impl BezierResidual {
    fn new(pencil: &ViewpointValues, a: f64, b: f64, phi: f64) -> Self {
        let (k0, p) = (pencil.k0, pencil.p());
        let stretch = (k0 - 1.0) / k0;
        let lambda = 1.0 + (a - b) / k0 + stretch * phi;
        // u = lambda (b1 - sigma), v = lambda (sigma - a0): both linear.
        let v = a + (p - 1.0) * phi - pencil.a0;
        let u = p * lambda - v;
        let (u_phi, v_phi) = (p * stretch - (p - 1.0), p - 1.0);
        let (rest, psi) = (a - phi, phi - a + b);
        let four = 4.0 / k0;
        let both = phi * psi;
        Self {
            by_phi: 2.0 * lambda * stretch * rest * rest
                - 2.0 * lambda * lambda * rest
                - four * ((u_phi * v + u * v_phi) * both + u * v * (psi + phi)),
            by_a: 2.0 * lambda / k0 * rest * rest + 2.0 * lambda * lambda * rest
                - four * (((p / k0 - 1.0) * v + u) * both - u * v * phi),
            by_b: -2.0 * lambda / k0 * rest * rest - four * (-p / k0 * v * both + u * v * phi),
        }
    }
}

/// Zero of a function that is positive at `low` and negative at `high`: Newton's method kept inside a shrinking bracket.
fn falling_root(low: f64, high: f64, start: f64, f: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
    let (mut low, mut high) = (low, high);
    let (at_low, at_high) = (f(low).0, f(high).0);
    if at_low.is_nan() || !(at_high <= 0.0) {
        return None;
    }
    if at_low <= 0.0 {
        return Some(low); // the root is at the end of the bracket, to rounding
    }
    let mut x = start.clamp(low, high);
    for _ in 0..200 {
        let (value, slope) = f(x);
        if value == 0.0 {
            return Some(x);
        }
        if value > 0.0 {
            low = x
        } else {
            high = x
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * 0.5 * x.abs() || next == x || high - low <= f64::EPSILON * low {
            return Some(next);
        }
        x = next;
    }
    x.is_finite().then_some(x)
}

#[cfg(test)]
mod tests;
