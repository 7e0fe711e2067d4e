//! The smooth pass as a whole.

use belvedere_core::DVec2;

use super::conjugate::{ConjugateGradients, Convergence};
use super::elevation::{ElevationRows, row_weight};
use super::hierarchy::Hierarchy;
use super::smoother::{SmoothError, Smoother, grid_weight};
use super::temporal::temporal_weight;

/// Residual of the elevation system, relative.
const TOLERANCE: f64 = 1e-6;
/// Conjugate gradient iterations at most.
const ITERATIONS: usize = 60;

/// Result of the smooth pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Displacement at the coarse nodes.
    pub u: Vec<f64>,
    /// Convergence with elevation rows; `None` without rows, where the solution is direct.
    pub convergence: Option<Convergence>,
}

/// Equations (11)-(16) of Deng et al. 2013 for the displacement u = f' - f:
/// `(L^2 + (w^2 + g^2) I + W^T W) u = w^2 u0 + g^2 u_prev + W^T h`. Nothing to move means u = 0 to the last bit.
#[derive(Debug, Clone)]
pub struct SmoothPass {
    hierarchy: Hierarchy,
    smoother: Smoother,
    rows: ElevationRows,
    points: Vec<DVec2>,
    cg: ConjugateGradients,
}

impl SmoothPass {
    /// * `w`, `rows_weight`: smoothness weight and weight of elevation rows, stated for 129 nodes on the longer side.
    /// * `points`: fine grid coordinates of the elevation rows: all reference points and kept summits, in view or not.
    ///
    /// # Errors
    /// [`SmoothError`] if `w` is out of range.
    pub fn new(hierarchy: Hierarchy, w: f64, rows_weight: f64, points: &[DVec2]) -> Result<Self, SmoothError> {
        let intervals = hierarchy.intervals();
        let smoother = Smoother::new(hierarchy.cols(), hierarchy.rows(), grid_weight(w, intervals), 0.0)?;
        let points: Vec<DVec2> = points.iter().copied().filter(|p| p.is_finite() && rows_weight > 0.0).collect();
        let rows = ElevationRows::new(&hierarchy, points.iter().copied(), row_weight(rows_weight, intervals));
        Ok(Self { hierarchy, smoother, rows, points, cg: ConjugateGradients::default() })
    }

    /// The solver's grid.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// H of the last run.
    pub fn smoother(&mut self) -> &mut Smoother {
        &mut self.smoother
    }

    /// * `naive`: displacement of the naive terrain on the fine grid, row-major.
    /// * `frame`: seconds since the last frame and time constant of coherence; `None` for a still.
    /// * `previous`: final displacement of the last frame at the coarse nodes; also the first guess.
    ///
    /// # Panics
    /// If a size does not fit the grids.
    pub fn run(&mut self, naive: &[f64], frame: Option<[f64; 2]>, previous: Option<&[f64]>) -> Smoothed {
        let w = self.smoother.w();
        let g = frame.map_or(0.0, |[dt, time]| temporal_weight(w, dt, time));
        self.smoother.set_g(g);
        let mut rhs = self.hierarchy.restrict(naive);
        match previous {
            Some(last) if g > 0.0 => rhs.iter_mut().zip(last).for_each(|(b, u)| *b = w * w * *b + g * g * u),
            _ => rhs.iter_mut().for_each(|b| *b *= w * w + g * g),
        }
        if self.rows.is_empty() {
            self.smoother.solve(&mut rhs);
            return Smoothed { u: rhs, convergence: None };
        }
        let (hierarchy, points) = (&self.hierarchy, &self.points);
        self.rows.add_wanted(|i| hierarchy.fine_at(naive, points[i]), &mut rhs);
        let mut u = previous.map_or_else(|| vec![0.0; rhs.len()], <[f64]>::to_vec);
        let convergence = self.cg.solve(&mut self.smoother, &self.rows, &rhs, &mut u, TOLERANCE, ITERATIONS);
        Smoothed { u, convergence: Some(convergence) }
    }

    /// The displacement on the fine grid with detail kept as it is: B u.
    pub fn plain(&self, u: &[f64]) -> Vec<f64> {
        self.hierarchy.prolong(u)
    }

    /// The displacement on the fine grid with scaled detail: `B u + (B sigma) (f - B R f)`; sigma is the scaling of the
    /// greedy pass minus 1, smoothed with the same w.
    ///
    /// * `heights`: f on the fine grid. `scale`: S of the greedy pass there.
    ///
    /// # Panics
    /// If a size does not fit the grids.
    pub fn scaled(&mut self, u: &[f64], heights: &[f64], scale: &[f64]) -> Vec<f64> {
        let changes: Vec<f64> = scale.iter().map(|s| s - 1.0).collect();
        let mut sigma = self.hierarchy.restrict(&changes);
        let g = self.smoother.g();
        self.smoother.set_g(0.0);
        let shift = self.smoother.shift();
        sigma.iter_mut().for_each(|s| *s *= shift);
        self.smoother.solve(&mut sigma);
        self.smoother.set_g(g);
        let base = self.hierarchy.prolong(&self.hierarchy.restrict(heights));
        let mut out = self.hierarchy.prolong(u);
        let sigma = self.hierarchy.prolong(&sigma);
        for (((o, s), f), b) in out.iter_mut().zip(&sigma).zip(heights).zip(&base) {
            *o += s * (f - b);
        }
        out
    }
}
