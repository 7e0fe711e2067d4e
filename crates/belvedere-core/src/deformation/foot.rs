//! Closest points of a curve.

use super::{Cell, DeformationCurve, SLOW, frame_in};
use glam::DVec2;

impl DeformationCurve {
    /// Arc length and signed distance of the closest foot of the perpendicular from `q`; extensions included.
    /// `None` if no foot lies before the centre of curvature, e.g. opposite a corner.
    pub fn foot(&self, q: DVec2) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        let mut offer = |l: f64, d: f64| {
            if best.is_none_or(|(_, b)| d.abs() < b.abs()) {
                best = Some((l, d));
            }
        };
        let near = &self.gates[0];
        let along = (q - near.point).dot(near.tangent);
        if along < 0.0 {
            offer(along, (q - near.point).dot(near.tangent.perp()));
        }
        let (far_point, far_tangent) = self.far;
        let along = (q - far_point).dot(far_tangent);
        if along > 0.0 {
            offer(self.length + along, (q - far_point).dot(far_tangent.perp()));
        }
        let mut before = f64::NEG_INFINITY;
        let mut cell = None;
        // A cell has a foot where the position lies ahead of its start and behind its end.
        for gate in &self.gates {
            let along = (q - gate.point).dot(gate.tangent);
            if before >= 0.0
                && along <= 0.0
                && let Some(cell) = cell
                && let Some((l, d)) = self.foot_in(&self.cells[cell], q, [before, along])
            {
                offer(l, d);
            }
            (before, cell) = (along, gate.cell);
        }
        best
    }

    /// The foot that Newton's method finds from arc length `near`, which should be close to it; that of [`DeformationCurve::foot`] where it
    /// finds none. `near` must be finite.
    pub fn foot_near(&self, q: DVec2, near: f64) -> Option<(f64, f64)> {
        let mut l = near;
        for _ in 0..6 {
            let frame = self.frame_at(l);
            let v = q - frame.point;
            let (along, d) = (v.dot(frame.tangent), v.dot(frame.normal()));
            let stretch = 1.0 - frame.kap * d;
            if !(stretch > 0.05) {
                break;
            }
            l += along / stretch;
            // Quadratic convergence: the next step would be below rounding, and d is least here.
            if (along / stretch).abs() <= 1e-8 * self.length {
                return Some((l, d));
            }
        }
        self.foot(q)
    }

    /// Root of `(q - P) . T` in a cell at whose ends it has the values `along`, + and -: by the span's own parameter where the curve is not slow,
    /// else by arc length.
    fn foot_in(&self, cell: &Cell, q: DVec2, along: [f64; 2]) -> Option<(f64, f64)> {
        self.foot_by_parameter(cell, q, along).or_else(|| self.foot_by_length(cell, q, along))
    }

    /// `None` where the steps do not get smaller soon, or close to a centre of curvature.
    fn foot_by_parameter(&self, cell: &Cell, q: DVec2, along: [f64; 2]) -> Option<(f64, f64)> {
        let span = &self.spans[cell.span];
        let slow = SLOW * self.scale;
        let (mut lo, mut hi) = (cell.x_mid - cell.x_half, cell.x_mid + cell.x_half);
        let share = along[0] / (along[0] - along[1]);
        let mut x = if share.is_finite() { lo + share * (hi - lo) } else { cell.x_mid };
        for _ in 0..12 {
            let (v, d1) = (q - span.point(x), span.d1(x));
            let speed2 = d1.length_squared();
            let (g, slope) = (v.dot(d1), speed2 - v.dot(span.d2(x)));
            if !(speed2 > slow * slow && slope > 0.05 * speed2) {
                return None;
            }
            if g > 0.0 {
                lo = x
            } else {
                hi = x
            }
            let next = x + g / slope;
            let step = (next - x).abs();
            // Quadratic convergence: the next step would be below rounding, and the distance is least here.
            if step <= 1e-8 * cell.x_half {
                return Some((cell.arc_length(next), d1.perp_dot(v) / speed2.sqrt()));
            }
            x = if next >= lo && next <= hi { next } else { 0.5 * (lo + hi) };
        }
        None
    }

    /// The same by arc length, with bisection where Newton's method fails.
    fn foot_by_length(&self, cell: &Cell, q: DVec2, along: [f64; 2]) -> Option<(f64, f64)> {
        let span = &self.spans[cell.span];
        // Along, across, and the derivative of -along.
        let offsets = |l: f64| {
            let x = cell.parameter(l);
            let (t, kap) = frame_in(span, x, cell.x_mid, self.scale);
            let v = q - span.point(x);
            let d = v.dot(t.perp());
            (v.dot(t), d, 1.0 - kap * d)
        };
        let (mut lo, mut hi) = (cell.l0, cell.l1);
        let share = along[0] / (along[0] - along[1]);
        let mut l = if share.is_finite() { lo + share * (hi - lo) } else { 0.5 * (lo + hi) };
        for _ in 0..80 {
            let (g, _, j) = offsets(l);
            if g > 0.0 {
                lo = l
            } else {
                hi = l
            }
            let newton = l + g / j;
            let smooth = j > 0.0 && newton >= lo && newton <= hi;
            let next = if smooth { newton } else { 0.5 * (lo + hi) };
            let step = (next - l).abs();
            l = next;
            if step <= if smooth { 1e-6 } else { 1e-8 } * self.length {
                break;
            }
        }
        // Quadratic convergence: one more step from here is exact.
        let (g, d, j) = offsets(l);
        (j > 1e-9).then(|| (l + g / j, d))
    }
}
