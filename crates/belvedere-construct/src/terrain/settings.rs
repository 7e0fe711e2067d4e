//! The parameters of terrain disocclusion and their defaults.

/// Which passes run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub enum SolverMode {
    /// Greedy and smooth pass, as published.
    #[serde(rename = "paper")]
    Paper,
    /// As published, then the quadratic program makes everything visible.
    #[serde(rename = "paper+qp")]
    PaperQp,
    /// The quadratic program alone.
    #[default]
    #[serde(rename = "qp")]
    Qp,
}

/// What happens to the detail of the ground that the solver's grid cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// Scaled as the ground under it was.
    Scaled,
    /// Kept as it is.
    Plain,
}

/// Parameters of terrain disocclusion. "Cells" of lengths are spacings of the terrain's grid.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct TerrainSettings {
    /// Which passes run.
    pub mode: SolverMode,
    /// Cells (mountains) to keep, > 0; `None` = nodes of the terrain / 1600, at least 1.
    pub cells: Option<usize>,
    /// Spacing of reference points along lines, cells.
    pub spacing: f64,
    /// Height over the ground at which features must be seen, metres; `None` = that of their layers.
    pub lift_m: Option<f64>,
    /// Ground nearer than this to a reference point cannot hide it, cells.
    pub guard: f64,
    /// Price of discontinuities between cells against change inside cells, >= 0.
    pub eta: f64,
    /// Weight of differing displacement in discontinuities, >= 0.
    pub mu: f64,
    /// Weight of displacement in the change inside a cell, >= 0.
    pub mu_dev: f64,
    /// Smoothness weight, stated for a solver's grid of 129 nodes; `None` = 0.6 (paper, paper+qp) or 0.3 (qp).
    pub w: Option<f64>,
    /// Weight of the elevation rows, >= 0.
    pub rows_weight: f64,
    /// Time constant of temporal coherence, seconds; 0 = off.
    pub gamma_time_s: f64,
    /// Nodes of the solver's grid along the longer side, >= 2; the terrain's own grid if that is coarser.
    pub solver_nodes: usize,
    /// `None` = scaled in modes paper and paper+qp, plain in mode qp.
    pub detail: Option<Detail>,
    /// Most the ground may rise in the quadratic program, metres, >= 0; infinite = free.
    pub rise_limit_m: f64,
    /// Clearance of the lines of sight that the quadratic program asks for, metres.
    pub margin_m: f64,
    /// Spacing of the dense points that the quadratic program makes visible, cells.
    pub candidates: f64,
    /// Only features up to this distance along the path from the eye, metres; `None` = all.
    pub ahead_m: Option<f64>,
    /// Price of a metre of occlusion squared, > 0: what costs more to clear stays covered; `None` = everything is cleared.
    pub slack_price: Option<f64>,
}

impl Default for TerrainSettings {
    fn default() -> Self {
        Self {
            mode: SolverMode::Qp,
            cells: None,
            spacing: 2.0,
            lift_m: None,
            guard: 1.5,
            eta: 5.0,
            mu: 10.0,
            mu_dev: 10.0,
            w: None,
            rows_weight: 1.0,
            gamma_time_s: 0.15,
            solver_nodes: 129,
            detail: None,
            rise_limit_m: 0.0,
            margin_m: 1.0,
            candidates: 0.25,
            ahead_m: None,
            slack_price: None,
        }
    }
}

impl TerrainSettings {
    /// Smoothness weight in force, for 129 nodes.
    pub fn smoothness(&self) -> f64 {
        self.w.unwrap_or(if self.mode == SolverMode::Qp { 0.3 } else { 0.6 })
    }

    /// Treatment of detail in force.
    pub fn detail(&self) -> Detail {
        self.detail.unwrap_or(if self.mode == SolverMode::Qp { Detail::Plain } else { Detail::Scaled })
    }
}
