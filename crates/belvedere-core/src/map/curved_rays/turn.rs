//! A turn with its derived forms and maps.

use super::form::{Forms, LinearForm, StraightPart};
use super::phi::{Hinge, Phi, ViewpointValues};
use super::spec::TurnSpec;
use crate::Miss;
use glam::{DMat3, DVec3};

/// A turn, resolved for renderers, rays and pictures of the camera itself.
///
/// With `A_j(X) = eye + after (X - viewpoint)` the straight continuation of the part after turn j and `A_0` the identity,
/// a point of the turn's cells is displaced to `A_{j-1}(X) + phi(a(X), b(X)) shift`.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Viewpoint `C'` before the turn, scene coordinates.
    pub viewpoint_before: DVec3,
    /// Viewpoint `C` after the turn, scene coordinates.
    pub viewpoint: DVec3,
    /// Form of plane t0: 0 on it, positive beyond.
    pub a: LinearForm,
    /// Form of plane t2: 0 on it, negative beyond; `a = b` on t1.
    pub b: LinearForm,
    /// `a - b`, 0 on t1, -1 at `viewpoint`.
    pub h: LinearForm,
    /// Values of the forms at the two viewpoints.
    pub values: ViewpointValues,
    /// Constant sharpness of the turn; `None` where the model has none (original, c0, c2, turns of width 0).
    pub m: Option<f64>,
    /// Linear part of `A_{j-1}`.
    pub before: DMat3,
    /// Linear part of `A_j`; its determinant is the product of the k0 so far.
    pub after: DMat3,
    /// Direction `d_j = before (C - C')` into which the turn shears displaced space, scene units; 0 if the viewpoints coincide.
    pub shift: DVec3,
    pub(super) hinge: Hinge,
    pub(super) before_inverse: DMat3,
    pub(super) after_inverse: DMat3,
}

/// Where a point lies in a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cell {
    /// Before t0.
    Before,
    /// Between t0 and t2.
    Wedge,
    /// Past t2.
    After,
}

/// `p q^T`.
pub(super) fn outer(p: DVec3, q: DVec3) -> DMat3 {
    DMat3::from_cols(p * q.x, p * q.y, p * q.z)
}

impl Turn {
    /// Assembles a turn from valid forms.
    pub(super) fn new(part: &StraightPart, spec: &TurnSpec, forms: &Forms, hinge: Hinge) -> Self {
        let baseline = spec.viewpoint - part.viewpoint;
        let shift = part.linear * baseline;
        let h = forms.h;
        // For broken rays only t1 matters: two half forms of it leave no wedge.
        let (a, b, values) = if hinge == Hinge::Broken {
            let k0 = forms.values.k0;
            let values = ViewpointValues { k0, a0: -0.5 * k0, b0: 0.5 * k0, a1: -0.5, b1: 0.5 };
            (h.scaled(0.5), h.scaled(-0.5), values)
        } else {
            (forms.a, forms.b, forms.values)
        };
        let m = if let Hinge::Conic { m } = hinge { Some(m) } else { None };
        let unshear = DMat3::IDENTITY - outer(baseline, h.gradient) * (1.0 / values.k0);
        Self {
            viewpoint_before: part.viewpoint,
            viewpoint: spec.viewpoint,
            a,
            b,
            h,
            values,
            m,
            before: part.linear,
            after: part.linear + outer(shift, h.gradient),
            shift,
            hinge,
            before_inverse: part.inverse,
            after_inverse: unshear * part.inverse,
        }
    }

    /// The paper's intermediate viewpoint R: from it the point of a bent ray in the plane of the pencil at `s` is seen where, from the
    /// viewpoint after the turn, the end of the bend on t2 is. It lies on the line of the two viewpoints, between them, and moves to the one
    /// after the turn while `s` rises.
    ///
    /// * `s`: `a / (a + b)`, 0 on t0, 1/2 on t1, 1 on t2.
    ///
    /// `None` outside 0..=1; for rays with a kink, which have none in between; for the original model, where it differs from ray to ray.
    ///
    /// Source: Cui et al. 2010, section 4; the closed form is ours.
    pub fn intermediate_viewpoint(&self, s: f64) -> Option<DVec3> {
        let single = matches!(self.hinge, Hinge::Conic { .. } | Hinge::C2);
        if !single || !(0.0..=1.0).contains(&s) {
            return None;
        }
        let psi = self.hinge.phi(&self.values, s, 1.0 - s)?.phi - (2.0 * s - 1.0);
        let ViewpointValues { k0, b0, b1, .. } = self.values;
        let rest = k0 * (1.0 - s);
        let share = if s < 1.0 { (rest - b0 * psi) / (rest + (b1 - b0) * psi) } else { 1.0 };
        Some(self.viewpoint_before.lerp(self.viewpoint, share))
    }

    /// The part of the chain after this turn.
    pub(super) fn part_after(&self) -> StraightPart {
        StraightPart { viewpoint: self.viewpoint, linear: self.after, inverse: self.after_inverse }
    }

    /// Cell by which the record of the turn displaces a point. In the opposite wedge, beyond the common line, a ray may reach a point
    /// before the turn, after it, both times or never; there the record continues either straight part, with t1 as the border.
    pub(super) fn cell(&self, p: DVec3) -> Result<Cell, Miss> {
        let (a, b) = (self.a.at(p), self.b.at(p));
        if !(a.is_finite() && b.is_finite()) {
            return Err(Miss::OutsideDomain);
        }
        Ok(match (a > 0.0 && b > 0.0, a > b) {
            (true, _) => Cell::Wedge,
            (false, false) => Cell::Before,
            (false, true) => Cell::After,
        })
    }

    /// Whether a ray that reaches the point on the part before the turn has not yet met t0: on such a ray `a` is affine and changes its
    /// sign there, once, whatever `b` is.
    pub(super) fn is_before(&self, p: DVec3) -> bool {
        self.a.at(p) <= 0.0
    }

    /// Whether a ray that reaches the point on the part after the turn has met t2: on such a ray `b` is affine and changes its sign there,
    /// once, whatever `a` is. Where that happens `a` is positive; so the common line itself is before the turn.
    pub(super) fn is_after(&self, p: DVec3) -> bool {
        let b = self.b.at(p);
        b < 0.0 || (b == 0.0 && self.a.at(p) > 0.0)
    }

    /// Displaced point relative to the eye.
    pub(super) fn displaced(&self, p: DVec3, cell: Cell) -> Result<DVec3, Miss> {
        let phi = if cell == Cell::Wedge { self.phi(p, cell)?.phi } else { 0.0 };
        Ok(self.displaced_by(p, cell, phi))
    }

    /// The same with a known phi.
    pub(super) fn displaced_by(&self, p: DVec3, cell: Cell, phi: f64) -> DVec3 {
        match cell {
            Cell::Before => self.before * (p - self.viewpoint_before),
            Cell::After => self.after * (p - self.viewpoint),
            Cell::Wedge => self.before * (p - self.viewpoint_before) + phi * self.shift,
        }
    }

    /// phi and its derivatives by a and b.
    pub(super) fn phi(&self, p: DVec3, cell: Cell) -> Result<Phi, Miss> {
        match cell {
            Cell::Before => Ok(Phi { phi: 0.0, phi_a: 0.0, phi_b: 0.0 }),
            Cell::After => Ok(Phi { phi: self.h.at(p), phi_a: 1.0, phi_b: -1.0 }),
            Cell::Wedge => self.hinge.phi(&self.values, self.a.at(p), self.b.at(p)).ok_or(Miss::OutsideDomain),
        }
    }

    /// Derivative of the displacement.
    pub(super) fn jacobian(&self, p: DVec3, cell: Cell) -> Result<DMat3, Miss> {
        let phi = self.phi(p, cell)?;
        Ok(match cell {
            Cell::Before => self.before,
            Cell::After => self.after,
            Cell::Wedge => self.before + outer(self.shift, phi.phi_a * self.a.gradient + phi.phi_b * self.b.gradient),
        })
    }

    /// Undoes the displacement for a point `v` relative to the eye: the point and its cell, if it is one of this turn's.
    pub(super) fn undisplaced(&self, v: DVec3) -> Result<(DVec3, Cell), Miss> {
        let y = self.viewpoint_before + self.before_inverse * v;
        let far = self.viewpoint + self.after_inverse * v;
        let alpha = self.a.at(y);
        if !alpha.is_finite() {
            return Err(Miss::OutsideDomain);
        }
        if alpha <= 0.0 {
            return Ok((y, Cell::Before));
        }
        let b_far = self.b.at(far);
        if !b_far.is_finite() {
            return Err(Miss::OutsideDomain);
        }
        if b_far <= 0.0 || self.hinge == Hinge::Broken {
            return Ok((far, Cell::After));
        }
        let phi = self.hinge.phi_of_displaced(&self.values, alpha, b_far).ok_or(Miss::OutsideDomain)?;
        Ok((y - phi * (self.viewpoint - self.viewpoint_before), Cell::Wedge))
    }
}
