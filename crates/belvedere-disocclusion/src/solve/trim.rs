//! Trims samples of a file: bumps that no grid of the solver holds, such as noise right in front of a point.
//!
//! Where ground rises a little over a line of sight, the samples around are lowered, each by as much as it helps, so that it no longer does
//! (Kaczmarz's method). Points on these samples sink with them and are judged again, until nothing is left to lower.

use super::super::metrics::Judge;
use super::super::points::{judged_points, required_features};
use super::super::{Field, ReferencePoint};
use super::memory::CHECK_CELLS;
use super::reporting::AGREES;
use super::sample_grid::SampleGrid;
use super::written::{SightOverFile, WrittenGround};
use super::{Solved, TerrainReport, TerrainSolver, at_every_node, ground};
use crate::DisocclusionError;
use belvedere_core::{DVec2, TerrainDisocclusion, View};
use belvedere_scene::{CellTriangle, Progress, Scene};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Most a sample is lowered: metres, or this share of the distance between samples if that is more.
const MOST_M: f64 = 5.0;
const MOST_SHARE: f64 = 0.25;
/// Room under lines of sight that trimmed ground leaves, metres.
const ROOM_M: f64 = 0.01;
/// Least height that a line of sight gains over ground per height by which the samples of that sink: the point may stand on them.
const LEAST_GAIN: f64 = 0.1;
/// Judgements at most.
const ROUNDS: usize = 60;

/// Samples that were lowered so that small bumps hide nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrimReport {
    /// Number of samples.
    pub samples: usize,
    /// Most that one was lowered, metres.
    pub most_m: f64,
}

/// One way in which the cells of the file are cut.
struct Cut<'a> {
    grid: SampleGrid<'a>,
    field: Field,
    sight: SightOverFile<'a>,
    /// Points in view.
    points: Vec<ReferencePoint>,
    /// Those to be judged in the next round.
    open: Vec<usize>,
    /// Points by the cells on which they stand.
    by_cell: BTreeMap<(i64, i64), Vec<usize>>,
}

/// Heights of samples that may be lowered.
struct Lowered<'a> {
    /// By sample of the file.
    by: BTreeMap<usize, f64>,
    is_fixed: &'a (dyn Fn(usize) -> bool + Sync),
    most: f64,
}

impl TerrainSolver {
    /// Samples of a file to be lowered, with by how much, scene units, so that small bumps hide nothing of what is in view.
    ///
    /// * `grids`: the same samples once or, for programs that cut cells otherwise too, twice; the second costs the first next to no sight; `height`: of a sample;
    /// * `is_fixed`: samples that must not move; `report`: of the solution that the heights hold.
    ///
    /// # Errors
    /// [`DisocclusionError::Field`], [`DisocclusionError::Cancelled`].
    pub fn trimmed(
        &self,
        (scene, view): (&Scene, &View),
        grids: &[SampleGrid<'_>],
        height: &(dyn Fn(usize) -> Option<f64> + Sync),
        is_fixed: &(dyn Fn(usize) -> bool + Sync),
        report: &TerrainReport,
        progress: &Progress,
    ) -> Result<BTreeMap<usize, f64>, DisocclusionError> {
        let features = required_features(scene);
        let given_up = |p: &ReferencePoint| {
            report.price.as_ref().is_some_and(|price| price.given_up.iter().any(|given| given.holds(p)))
        };
        let mut cuts = Vec::new();
        for &grid in grids {
            let field = WrittenGround { grid, height, solved_on: false }.field(view)?;
            let sight = SightOverFile::new(grid, view);
            let features: Vec<_> = features.iter().map(|f| f.mapped(&|line| grid.image_of(&field, line))).collect();
            let (all, _) = judged_points(&features, &field, &self.settings, CHECK_CELLS);
            let mut points = sight.in_view(&field, &all, view, &self.settings);
            points.retain(|p| !given_up(p));
            let mut by_cell = BTreeMap::<_, Vec<usize>>::new();
            for (k, p) in points.iter().enumerate() {
                by_cell.entry(cell(p.grid)).or_default().push(k);
            }
            cuts.push(Cut { grid, field, sight, open: (0..points.len()).collect(), points, by_cell });
        }
        let most = grids.iter().map(SampleGrid::most_trimmed).fold(0.0, f64::max);
        let mut lowered = Lowered { by: BTreeMap::new(), is_fixed, most };
        let all_of_them = cuts.len();
        lowered.trim(&mut cuts[..all_of_them], progress)?;
        let allowed = (1.0 - AGREES) * cuts[0].points.len() as f64;
        let hidden = cuts[0].hidden().len() as f64;
        if all_of_them == 1 || hidden <= allowed {
            return Ok(lowered.by);
        }
        // What the first grid shows comes first.
        let together = std::mem::take(&mut lowered.by);
        cuts[0].raise(&together);
        lowered.trim(&mut cuts[..1], progress)?;
        Ok(if hidden <= cuts[0].hidden().len() as f64 + allowed { together } else { lowered.by })
    }
}

impl Lowered<'_> {
    /// Lowers samples until no bump hides a point, or none can be lowered.
    fn trim(&mut self, cuts: &mut [Cut<'_>], progress: &Progress) -> Result<(), DisocclusionError> {
        for _ in 0..ROUNDS {
            progress.tick("trimming the heights to be written", 0.95)?;
            let mut moved = BTreeMap::new();
            for cut in &mut *cuts {
                cut.lower(self, &mut moved);
            }
            if moved.is_empty() || progress.should_end() {
                break;
            }
            cuts.iter_mut().for_each(|cut| cut.sink(&moved));
        }
        Ok(())
    }
}

impl Solved {
    /// Lowers nodes of the terrain, by row-major index, scene units: the samples of [`TerrainSolver::trimmed`], where the terrain is that
    /// which is written.
    ///
    /// # Errors
    /// [`DisocclusionError::NoTerrain`], [`DisocclusionError::Field`].
    pub fn lower(&mut self, scene: &Scene, lowered: &BTreeMap<usize, f64>) -> Result<(), DisocclusionError> {
        let field = Field::new(ground(scene).ok_or(DisocclusionError::NoTerrain)?, |_| 0.0)?;
        let moved = |i: usize| self.stage.delta_at(field.scene_from_grid(field.node(i)).extend(0.0));
        let moved = |i: usize| moved(i) - lowered.get(&i).copied().unwrap_or(0.0);
        let all: Vec<f64> = (0..field.heights().len()).map(moved).collect();
        self.stage = TerrainDisocclusion::new(at_every_node(&field, &all)?);
        Ok(())
    }
}

impl Cut<'_> {
    /// The open points that are hidden, with where ground hides them most, and its rise over the line of sight.
    fn hidden(&self) -> Vec<(usize, (DVec2, f64))> {
        let places: Vec<(DVec2, f64)> = self.open.iter().map(|&k| (self.points[k].grid, self.points[k].lift)).collect();
        let hiding = Judge::still(&self.field, &self.sight).hiding(&places, 0.0);
        self.open.iter().zip(hiding).filter_map(|(&k, hides)| Some((k, hides?))).collect()
    }

    /// Lowers the samples under the lines of sight of the open points, of which those that are hidden stay open; `moved` gets what
    /// each sample sank in this round.
    fn lower(&mut self, lowered: &mut Lowered<'_>, moved: &mut BTreeMap<usize, f64>) {
        let hidden = self.hidden();
        self.open = hidden.iter().map(|(k, _)| *k).collect();
        for (k, (at, over)) in hidden {
            if over > lowered.most {
                continue;
            }
            let rest = 1.0 - self.sight.share_of_way(self.points[k].grid, at);
            // What the line gains by each sample that sinks: the point may stand on it.
            let mut gains = BTreeMap::<usize, f64>::new();
            for (g, factor) in [(at, 1.0), (self.points[k].grid, -rest)] {
                let corners = CellTriangle::nodes_around(self.field.nodes(), g);
                corners.iter().for_each(|(i, w)| *gains.entry(*i).or_default() += factor * w);
            }
            let may_sink = |i: usize| !(lowered.is_fixed)(self.grid.sample(i)) && !self.field.void()[i];
            gains.retain(|i, gain| *gain > 0.0 && may_sink(*i));
            let square: f64 = gains.values().map(|gain| gain * gain).sum();
            if square < LEAST_GAIN * LEAST_GAIN {
                continue;
            }
            for (i, gain) in gains {
                let sample = self.grid.sample(i);
                let known = moved.get(&sample).copied().unwrap_or(0.0);
                let all = lowered.by.entry(sample).or_default();
                let by = ((over + ROOM_M) * gain / square - known).min(lowered.most - *all);
                if by > 0.0 {
                    *all += by;
                    moved.insert(sample, known + by);
                }
            }
        }
        lowered.by.retain(|_, by| *by > 0.0);
    }

    /// Raises samples again; all points are to be judged.
    fn raise(&mut self, lowered: &BTreeMap<usize, f64>) {
        for (&sample, &by) in lowered {
            self.field.lower(self.grid.sample(sample), -by);
        }
        self.open = (0..self.points.len()).collect();
    }

    /// Takes over what samples sank; the points on these samples are judged next as well.
    fn sink(&mut self, moved: &BTreeMap<usize, f64>) {
        let cols = self.grid.nodes[0];
        let mut open: BTreeSet<usize> = self.open.iter().copied().collect();
        for (&sample, &by) in moved {
            let i = self.grid.sample(sample);
            self.field.lower(i, by);
            let (x, y) = ((i % cols) as i64, (i / cols) as i64);
            for at in [(x - 1, y - 1), (x, y - 1), (x - 1, y), (x, y)] {
                open.extend(self.by_cell.get(&at).into_iter().flatten());
            }
        }
        self.open = open.into_iter().collect();
    }
}

impl SampleGrid<'_> {
    /// Most a sample is trimmed, scene units.
    pub fn most_trimmed(&self) -> f64 {
        MOST_M.max(MOST_SHARE * self.spacing.max_element())
    }
}

fn cell(g: DVec2) -> (i64, i64) {
    (g.x.floor() as i64, g.y.floor() as i64)
}
