//! Validity conditions of a turn, checked in order, each with its own error.

use super::form::{Forms, LinearForm, StraightPart};
use super::phi::{ViewpointValues, arcs_cross};
use super::spec::{CurvedRaysError, Pencil, Sharpness, TurnSpec};
use crate::Pinhole;
use glam::{DVec2, DVec3};

/// A turn narrower than this share of the distance to its bend point is a kink.
const KINK: f64 = 1e-6;
/// A plane nearer to the bend point than this share of the distance does not define a wedge.
const TOUCHING: f64 = 1e-8;
/// Largest coordinate of a parameter; products of a few of them stay far from overflow.
const LARGEST: f64 = 1e15;

/// Context of the check of a turn: the camera and the chain before it.
#[derive(Debug, Clone)]
pub(super) struct TurnContext<'a> {
    pub(super) root: &'a Pinhole,
    /// Corners of the part of the image that the chain draws. All conditions are affine in the pixel, so the corners decide
    /// for all of it.
    pub(super) corners: &'a [DVec2],
    /// Number of the turn, from 1.
    pub(super) turn: usize,
    /// The chain before the turn.
    pub(super) part: StraightPart,
    /// The turn before.
    pub(super) previous: Option<PreviousTurn>,
    /// Whether the error of a violated condition names the nearest valid value; that search costs a hundred times the check.
    pub(super) advise: bool,
}

/// The turn before the one that is checked.
#[derive(Debug, Clone)]
pub(super) struct PreviousTurn {
    pub(super) spec: TurnSpec,
    /// The chain before that turn.
    pub(super) part: StraightPart,
    /// Depth of its t2 on the rays of the corners.
    pub(super) ends: Vec<f64>,
}

/// A condition that does not hold, measured. The order of the variants is the order of the checks.
#[derive(Debug, Clone, Copy)]
pub(super) enum Violation {
    Order { depths: [f64; 3] },
    PreviousPastBend { past: f64 },
    ViewpointPastBend { past: f64 },
    PreviousPastStart { past: f64 },
    BendNotMet { pixel: DVec2, slope: f64 },
    LineInPicture { pixel: DVec2, beyond: f64 },
    EndNotReached { pixel: DVec2, sigma: f64, limit: f64 },
    TurnsOverlap { pixel: DVec2, end: f64, start: f64 },
    NearPastStart { pixel: DVec2, start: f64 },
}

/// Checks that all numbers are finite and not beyond 1e15, that directions are not zero and that m is in range.
pub(super) fn numbers(spec: &TurnSpec, turn: usize) -> Result<(), CurvedRaysError> {
    let (pencil_names, u, v) = match spec.pencil {
        Pencil::Line { point, dir } => (["line.point", "line.dir"], point, dir),
        Pencil::Parallel { normal } => (["normal", "normal"], normal, normal),
    };
    let named = [
        ("viewpoint", spec.viewpoint),
        ("t0", spec.t0),
        ("t1", spec.t1),
        ("t2", spec.t2),
        (pencil_names[0], u),
        (pencil_names[1], v),
    ];
    for (name, p) in named {
        if let Some(value) = p.to_array().into_iter().find(|c| !c.is_finite()) {
            return Err(CurvedRaysError::NotFinite { turn, name, value });
        }
        if let Some(value) = p.to_array().into_iter().find(|c| c.abs() > LARGEST) {
            return Err(CurvedRaysError::TooLarge { turn, name, value, limit: LARGEST });
        }
    }
    if v.normalize_or_zero() == DVec3::ZERO {
        return Err(CurvedRaysError::ZeroDirection { turn, name: pencil_names[1] });
    }
    match spec.m {
        Sharpness::Value(m) if !(0.2..=20.0).contains(&m) => Err(CurvedRaysError::Sharpness { turn, m }),
        _ => Ok(()),
    }
}

/// Unit normals of t0, t1, t2, either sign.
fn normals(spec: &TurnSpec, turn: usize) -> Result<[DVec3; 3], CurvedRaysError> {
    match spec.pencil {
        Pencil::Parallel { normal } => Ok([normal.normalize(); 3]),
        Pencil::Line { point, dir } => {
            let dir = dir.normalize();
            let arms = [spec.t0, spec.t1, spec.t2].map(|t| (t - point).cross(dir));
            let limit = 1e-9 * arms.iter().map(|a| a.length()).fold(0.0, f64::max);
            for (name, arm) in ["t0", "t1", "t2"].into_iter().zip(arms) {
                let distance = arm.length();
                if distance <= limit {
                    return Err(CurvedRaysError::PointOnLine { turn, name, distance, limit });
                }
            }
            Ok(arms.map(DVec3::normalize))
        }
    }
}

/// Unscaled geometry of a turn: all values are finite; the sides on which the viewpoints lie are not checked yet.
pub(super) struct UnscaledTurn {
    /// Forms of t0 and t2 that are 1 at the bend point; t1's unit form, positive beyond.
    a: LinearForm,
    b: LinearForm,
    t1: LinearForm,
    kink: bool,
}

impl UnscaledTurn {
    pub(super) fn new(spec: &TurnSpec, turn: usize, part: &StraightPart) -> Result<Self, CurvedRaysError> {
        let [n0, n1, n2] = normals(spec, turn)?;
        let bend = spec.t1;
        let reach = (bend - part.viewpoint).length().max((bend - spec.viewpoint).length());
        let form = |gradient: DVec3, through: DVec3| LinearForm {
            origin: bend,
            at_origin: gradient.dot(bend - through),
            gradient,
        };
        let (t0, t1, t2) = (form(n0, spec.t0), form(n1, bend), form(n2, spec.t2));
        for (viewpoint, p) in [(turn - 1, part.viewpoint), (turn, spec.viewpoint)] {
            let (distance, limit) = (t1.at(p).abs(), 1e-9 * (p - bend).length());
            if distance <= limit {
                return Err(CurvedRaysError::ViewpointOnBend { turn, viewpoint, distance, limit });
            }
        }
        let widths = [t0.at_origin.abs(), t2.at_origin.abs()];
        if widths.iter().all(|w| *w <= KINK * reach) {
            // No wedge: broken rays. The viewpoint after the turn decides the sign of t1's normal.
            let side = -t1.at(spec.viewpoint).signum();
            return Ok(Self { a: t1.scaled(side), b: t1.scaled(-side), t1: t1.scaled(side), kink: true });
        }
        let limit = TOUCHING * reach;
        for (name, distance) in ["t0", "t2"].into_iter().zip(widths) {
            if distance <= limit {
                return Err(CurvedRaysError::BendOnPlane { turn, name, distance, limit });
            }
        }
        let (a, b) = (t0.scaled(1.0 / t0.at_origin), t2.scaled(1.0 / t2.at_origin));
        let across = a.gradient - b.gradient;
        if across.length() <= 1e-9 * a.gradient.length().max(b.gradient.length()) {
            return Err(CurvedRaysError::SamePlanes { turn, distance: widths[0] });
        }
        let side = across.dot(n1).signum();
        Ok(Self { a, b, t1: t1.scaled(side), kink: false })
    }

    /// Checks the conditions in order and returns the scaled forms.
    pub(super) fn check(&self, spec: &TurnSpec, context: &TurnContext<'_>) -> Result<Forms, Violation> {
        let part = &context.part;
        let (past0, past1) = (self.t1.at(part.viewpoint), self.t1.at(spec.viewpoint));
        if past0 > 0.0 && past1 > 0.0 {
            return Err(Violation::Order { depths: self.depths(spec, context) });
        }
        if past0 >= 0.0 {
            return Err(Violation::PreviousPastBend { past: past0 });
        }
        if past1 >= 0.0 {
            return Err(Violation::ViewpointPastBend { past: past1 });
        }
        let forms = self.forms(part, spec.viewpoint);
        if !(forms.values.a0 < 0.0) {
            return Err(Violation::PreviousPastStart { past: forms.values.a0 / forms.a.gradient.length() });
        }
        let pixels = context.corners;
        for &pixel in pixels {
            forms.meets_bend(pixel, spec, context)?;
        }
        for &pixel in pixels {
            forms.reaches_end(pixel, context)?;
        }
        for (i, &pixel) in pixels.iter().enumerate() {
            let start = forms.start(corner_direction(pixel, context.root, part));
            match &context.previous {
                Some(PreviousTurn { ends, .. }) if !(start >= ends[i]) => {
                    return Err(Violation::TurnsOverlap { pixel, end: ends[i], start });
                }
                None if !(start > context.root.near) => return Err(Violation::NearPastStart { pixel, start }),
                _ => {}
            }
        }
        Ok(forms)
    }

    /// Scaled forms; the viewpoints must not lie on t1.
    pub(super) fn forms(&self, part: &StraightPart, after: DVec3) -> Forms {
        let before = part.viewpoint;
        let h = self.t1.scaled(-1.0 / self.t1.at(after));
        let k0 = -h.at(before);
        let baseline = after - before;
        if self.kink {
            let (a, b) = (h.scaled(0.5), h.scaled(-0.5));
            let values = ViewpointValues { k0, a0: -0.5 * k0, b0: 0.5 * k0, a1: -0.5, b1: 0.5 };
            return Forms { a, b, h, values, sigma: 0.0, kink: true, baseline };
        }
        let sigma = 1.0 / (self.b.at(after) - self.a.at(after));
        let (a, b) = (self.a.scaled(sigma), self.b.scaled(sigma));
        let values = ViewpointValues { k0, a0: a.at(before), b0: b.at(before), a1: a.at(after), b1: b.at(after) };
        Forms { a, b, h, values, sigma, kink: false, baseline }
    }

    /// Signed distances of t0, t1 and t2 along the axis of the part before the turn, scene units.
    fn depths(&self, spec: &TurnSpec, context: &TurnContext<'_>) -> [f64; 3] {
        let (eye, axis) = (context.part.viewpoint, axis(context));
        [(&self.a, spec.t0), (&self.t1, spec.t1), (&self.b, spec.t2)].map(|(form, point)| {
            let depth = -form.at(eye) / form.along(axis);
            if depth.is_finite() { depth } else { (point - eye).dot(axis) }
        })
    }
}

impl Forms {
    /// Checks that the ray of a corner meets t1 ahead, on the picture's side of the common line.
    fn meets_bend(&self, pixel: DVec2, spec: &TurnSpec, context: &TurnContext<'_>) -> Result<(), Violation> {
        let direction = corner_direction(pixel, context.root, &context.part);
        let slope = self.h.along(direction) / (self.h.gradient.length() * direction.length());
        if !(slope > 0.0) {
            return Err(Violation::BendNotMet { pixel, slope });
        }
        if self.kink {
            return Ok(());
        }
        // sigma > 0, multiplied by the positive slope: affine in the pixel.
        let scaled = self.values.a0 * self.h.along(direction) + self.values.k0 * self.a.along(direction);
        if scaled > 0.0 {
            return Ok(());
        }
        let s = context.part.viewpoint + self.bend_depth(direction) * direction;
        let beyond = match spec.pencil {
            Pencil::Line { point, dir } => (s - point).reject_from(dir).length(),
            Pencil::Parallel { .. } => -self.a.at(s) / self.a.gradient.length(),
        };
        Err(Violation::LineInPicture { pixel, beyond })
    }

    /// Checks that the ray of a corner reaches t2.
    fn reaches_end(&self, pixel: DVec2, context: &TurnContext<'_>) -> Result<(), Violation> {
        let sigma = self.sigma_on(corner_direction(pixel, context.root, &context.part));
        let limit = self.values.b1;
        if sigma < limit { Ok(()) } else { Err(Violation::EndNotReached { pixel, sigma, limit }) }
    }
}

/// Steps over the range of sigma in the search for rays that cross.
const CROSSING_STEPS: usize = 64;

/// Least and greatest sigma of the corners; if rays of the original model cross, also the corner of greatest sigma and the least sampled
/// sigma at which they cross.
pub(super) fn crossing(forms: &Forms, context: &TurnContext<'_>) -> ([f64; 2], Option<(DVec2, f64)>) {
    let sigma = |px: DVec2| forms.sigma_on(corner_direction(px, context.root, &context.part));
    let corners = context.corners.iter().map(|&px| (px, sigma(px)));
    let by_sigma = |a: &(DVec2, f64), b: &(DVec2, f64)| a.1.total_cmp(&b.1);
    let (Some(low), Some(high)) = (corners.clone().min_by(by_sigma), corners.max_by(by_sigma)) else {
        return ([forms.sigma; 2], None);
    };
    let at = |k: usize| low.1 + (high.1 - low.1) * k as f64 / CROSSING_STEPS as f64;
    let crossed = (0..=CROSSING_STEPS).map(at).find(|&sigma| arcs_cross(&forms.values, sigma));
    ([low.1, high.1], crossed.map(|sigma| (high.0, sigma)))
}

/// Unit direction of the central ray of the part before a turn.
pub(super) fn axis(context: &TurnContext<'_>) -> DVec3 {
    (context.part.inverse * context.root.forward).normalize()
}

/// The four image corners.
pub(super) fn corner_pixels(root: &Pinhole) -> [DVec2; 4] {
    let [w, h] = root.image.map(f64::from);
    [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(0.0, h), DVec2::new(w, h)]
}

/// Direction of a pixel's ray in a part of the chain, per unit of depth.
pub(super) fn corner_direction(pixel: DVec2, root: &Pinhole, part: &StraightPart) -> DVec3 {
    part.inverse * (root.unproject(pixel, 1.0) - root.eye)
}
