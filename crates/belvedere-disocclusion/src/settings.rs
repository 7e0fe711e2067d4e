//! The parameters of terrain disocclusion and their defaults.

use belvedere_core::DVec2;
use belvedere_scene::Heightfield;

/// Longest smoothing of mode qp where no `w` is stated, metres: about the width of a valley floor. On ground wider than 32 km
/// w = 0.3 would spread every displacement over the next ridge.
pub const LONGEST_SMOOTHING_M: f64 = 450.0;
/// Intervals between the 129 nodes for which smoothness weights are stated.
const STATED: f64 = 128.0;
/// Largest smoothness weight.
pub(super) const MOST_W: f64 = 1e4;

/// Which passes run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// Treatment of the detail of the ground that the solver's grid cannot hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// Scaled as the ground under it was.
    Scaled,
    /// Kept as it is.
    Plain,
}

/// Parameters of terrain disocclusion. "Cells" of lengths are spacings of the terrain's grid.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Smoothness weight, stated for a solver's grid of 129 nodes; `None` = 0.6 (paper, paper+qp) or 0.3 (qp). The default of mode qp
    /// is raised where the smoothing would be longer than [`LONGEST_SMOOTHING_M`].
    pub w: Option<f64>,
    /// Weight of the elevation rows, >= 0.
    pub rows_weight: f64,
    /// Time constant of temporal coherence, seconds; 0 = off.
    pub gamma_time_s: f64,
    /// Nodes of the solver's grid along the longer side, about, >= 2: its steps are whole ones of the terrain's grid.
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
    /// Whether the displaced ground is limited: at most a fifth of the relief below the lowest node, and at most twice as steep as
    /// the slope that 999 of 1000 triangles of the terrain stay below. Only in modes with a quadratic program.
    pub limits: bool,
    /// Whether spikes of the elevation model count as ground; if not, the solver replaces them by the median of their surroundings.
    pub spikes: bool,
    /// Ids of line layers along which the displaced ground rises downstream by no more than the elevation model does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rivers: Vec<String>,
    /// Share of the features in view that the ground makes way for at least, 0..=1: up to the rest of it, the dearest stretches, is given
    /// up; `None` = as much as [`Self::move_at_most_m`] allows or, without that, as much as leaves the landscape like itself
    /// ([`crate::report::LikenessReport`]; only with [`Self::limits`] and in mode qp). Stills alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub show: Option<f64>,
    /// Largest displacement of the solver's grid, metres, > 0: the dearest stretches of the features are given up until the ground
    /// moves no more, or `show` is reached; `None` = free. Stills alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub move_at_most_m: Option<f64>,
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
            limits: true,
            spikes: false,
            rivers: Vec::new(),
            show: None,
            move_at_most_m: None,
            slack_price: None,
        }
    }
}

impl TerrainSettings {
    /// Smoothness weight in force, for 129 nodes `stated_m` apart, see [`stated_spacing`].
    pub fn smoothness(&self, stated_m: f64) -> f64 {
        let usual = match self.mode {
            SolverMode::Qp => (stated_m / LONGEST_SMOOTHING_M).powi(2).clamp(0.3, MOST_W),
            SolverMode::Paper | SolverMode::PaperQp => 0.6,
        };
        self.w.unwrap_or(usual)
    }

    /// [`Self::smoothness`] on a terrain.
    pub fn smoothness_on(&self, terrain: &Heightfield) -> f64 {
        self.smoothness(stated_spacing(terrain.cols(), terrain.rows(), terrain.spacing()))
    }

    /// Cells to keep on a terrain: as stated, else one for 1600 nodes, at least one.
    pub fn cells_on(&self, terrain: &Heightfield) -> usize {
        self.cells.unwrap_or_else(|| default_cells(terrain.heights().len()))
    }

    /// Wavelength over 2 pi at which the smoothing halves a displacement, metres.
    pub fn smoothing_length(&self, stated_m: f64) -> f64 {
        stated_m / self.smoothness(stated_m).sqrt()
    }

    /// Treatment of detail in force.
    pub fn detail(&self) -> Detail {
        self.detail.unwrap_or(if self.mode == SolverMode::Qp { Detail::Plain } else { Detail::Scaled })
    }
}

/// Default number of cells on terrain with `nodes` nodes.
pub(super) fn default_cells(nodes: usize) -> usize {
    (nodes / 1600).max(1)
}

/// Spacing of 129 nodes along the longer side of terrain with `cols` x `rows` nodes `spacing` apart, scene units.
pub fn stated_spacing(cols: usize, rows: usize, spacing: DVec2) -> f64 {
    (cols.max(rows).max(2) - 1) as f64 * spacing.max_element() / STATED
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(mode: SolverMode, w: Option<f64>) -> TerrainSettings {
        TerrainSettings { mode, w, ..TerrainSettings::default() }
    }

    #[test]
    fn smoothing_is_capped_in_metres_unless_w_is_stated() {
        let usual = settings(SolverMode::Qp, None);
        assert_eq!(usual.smoothness(240.0), 0.3, "1025 nodes 30 m apart keep the stated default");
        assert!(usual.smoothing_length(240.0) < LONGEST_SMOOTHING_M);
        assert!(usual.smoothness(860.0) > 0.3, "1201 nodes 92 m apart do not");
        assert!((usual.smoothing_length(860.0) - LONGEST_SMOOTHING_M).abs() < 1e-9);
        for stated_m in [1.0, 240.0, 246.0, 247.0, 860.0, 20_000.0] {
            assert!(usual.smoothing_length(stated_m) <= LONGEST_SMOOTHING_M * (1.0 + 1e-12), "{stated_m}");
            for w in [0.05, 0.3, 7.0] {
                assert_eq!(settings(SolverMode::Qp, Some(w)).smoothness(stated_m), w, "a stated w is literal");
            }
            for mode in [SolverMode::Paper, SolverMode::PaperQp] {
                assert_eq!(settings(mode, None).smoothness(stated_m), 0.6, "the paper's is the paper's");
            }
        }
        assert_eq!(usual.smoothness(1e9), MOST_W);
    }

    #[test]
    fn the_stated_grid_lies_along_the_longer_side() {
        assert_eq!(stated_spacing(1025, 600, DVec2::splat(30.0)), 240.0);
        assert_eq!(stated_spacing(600, 1025, DVec2::splat(30.0)), 240.0);
        assert_eq!(stated_spacing(129, 2, DVec2::new(5.0, 4.0)), 5.0);
        assert!(stated_spacing(1, 1, DVec2::ONE) > 0.0);
    }
}
