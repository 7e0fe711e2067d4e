//! What is done when no displacement of the solver's grid shows everything: the ground between its nodes gives way.

use super::problem::{QpError, QpProblem, QpResult, Reason};
use super::seen::Seen;
use super::solver::QpSolver;
use super::walk::Touch;
use belvedere_core::DVec2;

/// Detail is taken away up to this distance from a candidate, cells of the solver's grid.
const REACH: f64 = 2.0;
/// Ground that is lowered for itself is lowered in full up to this distance, and not at all beyond twice of it, cells.
const CORE: f64 = 1.5;
/// Times that the ground is lowered for itself.
const ROUNDS: usize = 40;

/// A frame with everything that can be done for it.
#[derive(Debug, Clone, Default)]
pub struct Rescued {
    /// The solution; what is still unresolved is so for good.
    pub result: QpResult,
    /// Change of the ground at the nodes of the field besides the displacement, metres, <= 0; `None` = none.
    pub detail: Option<Vec<f64>>,
    /// Candidates around which the ground lost its detail.
    pub without_detail: usize,
    /// Candidates for which the ground was lowered at full resolution.
    pub at_full_resolution: usize,
}

impl QpSolver {
    /// As [`QpSolver::solve`]; where rows contradict each other (they got slack then), detail of the ground that stands
    /// out over the solver's grid is taken away around the candidates that are not seen, and what still hides them is
    /// lowered at full resolution.
    ///
    /// # Errors
    /// Every [`QpError`].
    pub fn solve_or_rescue(&mut self, problem: &QpProblem) -> Result<Rescued, QpError> {
        let result = self.solve(problem)?;
        let mut out = Rescued { result, ..Rescued::default() };
        let hidden = hidden(&out.result, problem);
        if hidden.is_empty() {
            return Ok(out);
        }
        let (ground, kept) = (self.surface.heights.clone(), self.kept.clone());
        out.without_detail = hidden.len();
        self.surface.set_heights(&self.without_detail(problem, &hidden));
        let found = self.solve(problem);
        if let Ok(second) = found {
            let (rounds, added) = (out.result.rounds + second.rounds, out.result.added + second.added);
            let milliseconds = out.result.milliseconds + second.milliseconds;
            out.result = QpResult { rounds, added, milliseconds, ..second };
            self.lower(problem, &mut out);
        }
        let change: Vec<f64> = self.surface.heights.iter().zip(&ground).map(|(now, before)| now - before).collect();
        out.detail = change.iter().any(|c| *c != 0.0).then_some(change);
        // The next frame begins with the ground as it was given.
        self.surface.set_heights(&ground);
        self.kept = kept;
        Ok(out)
    }

    /// The ground without what stands out over the solver's grid around some candidates; it is nowhere raised.
    fn without_detail(&self, problem: &QpProblem, hidden: &[usize]) -> Vec<f64> {
        let heights = &self.surface.heights;
        let smooth = self.hierarchy.prolong(&self.hierarchy.restrict(heights));
        let mut gain = vec![0.0f64; heights.len()];
        for &c in hidden {
            let middle = problem.candidates[c].grid;
            self.around(middle, REACH * self.surface.lattice.step, |i, p| {
                let away = ((p - middle) / self.surface.lattice.step).length() / REACH;
                gain[i] = gain[i].max((2.0 - 2.0 * away).clamp(0.0, 1.0));
            });
        }
        heights.iter().zip(&smooth).zip(&gain).map(|((h, s), g)| h - g * (h - s).max(0.0)).collect()
    }

    /// Lowers the ground itself where it still hides candidates, until it does no more.
    fn lower(&mut self, problem: &QpProblem, out: &mut Rescued) {
        let mut hidden = hidden(&out.result, problem);
        out.at_full_resolution = hidden.len();
        for _ in 0..ROUNDS {
            if hidden.is_empty() {
                break;
            }
            let mut heights = self.surface.heights.clone();
            for touch in self.touches(problem).iter().map(|(_, touch)| touch) {
                // Lowered ground may carry a candidate along: somewhat more each time.
                self.around(touch.at, DVec2::splat(2.0 * CORE), |i, p| {
                    let share = (2.0 - (p - touch.at).length() / CORE).clamp(0.0, 1.0);
                    heights[i] = heights[i].min(self.surface.heights[i] - share * (touch.excess + 0.01));
                });
            }
            self.surface.set_heights(&heights);
            self.surface.displace(&out.result.u);
            hidden = self.touches(problem).iter().map(|(k, _)| *k).collect();
            hidden.dedup();
        }
        let lacking = self.touches(problem);
        out.result.unresolved.retain_mut(|u| {
            let lacks = |index: usize| problem.candidates[index].id == u.id;
            match &mut u.reason {
                Reason::TooNear | Reason::NoLine => true,
                Reason::NotSettled { .. } | Reason::Infeasible(_) => lacking.iter().any(|(k, _)| lacks(*k)),
            }
        });
    }

    /// Where candidates (indices) miss the asked clearance now.
    fn touches(&self, problem: &QpProblem) -> Vec<(usize, Touch)> {
        let clearance = self.clearance();
        let (mut out, mut room) = (Vec::new(), f64::INFINITY);
        for s in Seen::all(problem, &self.surface) {
            if s.chords.is_empty() || s.distance() < 3.0 * clearance.guard {
                continue;
            }
            for chord in s.line(s.displacement(&self.surface.u)) {
                let Some(part) = chord.part(&self.surface, s.grid, clearance.guard) else { continue };
                out.extend(chord.ends_of(&self.surface, part, &clearance).into_iter().flatten().map(|t| (s.index, t)));
                chord.walk(&self.surface, part, &clearance, &mut room, &mut |t| out.push((s.index, t)));
            }
        }
        out
    }

    /// Calls `visit` with index and place of the nodes in a box around `middle`.
    fn around(&self, middle: DVec2, reach: DVec2, mut visit: impl FnMut(usize, DVec2)) {
        let last = DVec2::new((self.surface.cols - 1) as f64, (self.surface.rows - 1) as f64);
        let (low, high) = ((middle - reach).clamp(DVec2::ZERO, last).ceil(), (middle + reach).clamp(DVec2::ZERO, last));
        for row in low.y as usize..=high.y as usize {
            for col in low.x as usize..=high.x as usize {
                visit(row * self.surface.cols + col, DVec2::new(col as f64, row as f64));
            }
        }
    }
}

/// Indices of the candidates that a displacement of the solver's grid could not show.
fn hidden(result: &QpResult, problem: &QpProblem) -> Vec<usize> {
    let of = |id: u32| problem.candidates.iter().position(|c| c.id == id);
    let unseen = result.unresolved.iter();
    let unseen = unseen.filter(|u| matches!(u.reason, Reason::Infeasible(_) | Reason::NotSettled { .. }));
    unseen.filter_map(|u| of(u.id)).collect()
}
